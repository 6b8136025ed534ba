//! Expected error of a run, cause by cause.

use crate::Mode;
use results::{Accuracy, ErrorShare};
use scene::Scene;

/// Expected error of a run with internal steps of `step` s.
#[must_use]
pub fn of(scene: &Scene, mode: Mode, step: f64) -> Accuracy {
    let asked_percent = scene.run.accuracy.map(|wish| wish.percent);
    let cost_of_whole_line = catenary::mesh::cost_of_whole_line(scene);
    match catenary::mesh::error_shares(scene, step) {
        Ok(mut shares) => {
            // One system exchanges nothing.
            shares.retain(|share| share.cause != "coupling" || mode != Mode::Monolithic);
            Accuracy {
                asked_percent,
                expected_percent: Some(catenary::mesh::sum(&shares)),
                shares: (shares.into_iter())
                    .map(|share| ErrorShare {
                        cause: share.cause.to_owned(),
                        percent: share.percent,
                    })
                    .collect(),
                without_rule: String::new(),
                cost_of_whole_line,
            }
        }
        Err(without_rule) => Accuracy {
            asked_percent,
            expected_percent: None,
            shares: Vec::new(),
            without_rule,
            cost_of_whole_line,
        },
    }
}

/// Remark on a wish that given keys exceed.
#[must_use]
pub fn remark(scene: &Scene) -> Option<String> {
    let wish = scene.run.accuracy?;
    let shares = catenary::mesh::error_shares(scene, scene.internal_step()).ok()?;
    let sum = catenary::mesh::sum(&shares);
    let largest = shares.iter().max_by(|a, b| a.percent.total_cmp(&b.percent))?;
    (sum > wish.percent * (1.0 + 1e-6)).then(|| {
        format!(
            "accuracy: errors of {sum:.2} % are expected, above run.accuracy_percent = {}, most of it ({:.2} %) by {}: \
             keys that are given win; leave out catenary.mesh, steps and model.reduce to have them chosen",
            wish.percent, largest.percent, largest.cause
        )
    })
}
