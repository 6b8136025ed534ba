//! Changes between cases, published and computed.

use serde::Serialize;

use super::execute::Line;
use super::plan::Mesh;
use super::published::{CASES, Case};
use crate::simulation::Mode;

/// A change from one case to another on one mesh, %.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Relation {
    /// From which case.
    pub from: &'static str,
    /// To which case.
    pub to: &'static str,
    /// On which mesh.
    pub mesh: String,
    /// `mean` or `std`.
    pub of: &'static str,
    /// Published change, %.
    pub published: f64,
    /// Computed change, %; nothing where a case has no figures.
    pub computed: Option<f64>,
}

/// A change below this is none, %: the thesis calls one of 0.11 % negligible.
const VISIBLE: f64 = 0.2;

impl Relation {
    /// Whether the computed change has the direction of the published one, in words.
    #[must_use]
    pub fn verdict(&self) -> &'static str {
        let Some(computed) = self.computed else {
            return "not computed";
        };
        match (self.published.abs() >= VISIBLE, computed.abs() >= VISIBLE) {
            (false, false) => "holds: no visible change",
            (true, true) if computed.signum() == self.published.signum() => "holds: same direction",
            (true, true) => "refuted: other direction",
            (true, false) => "refuted: no visible change",
            (false, true) => "refuted: a visible change",
        }
    }
}

/// Pairs of cases whose difference the thesis discusses.
const PAIRS: [(usize, usize); 3] = [(0, 1), (0, 2), (2, 3)];

/// The changes on every mesh on which the cases were run.
#[must_use]
pub fn relations(lines: &[Line]) -> Vec<Relation> {
    let mut found = Vec::new();
    for mesh in Mesh::ALL {
        for (from, to) in PAIRS.map(|(from, to)| (&CASES[from], &CASES[to])) {
            let line = |case: &Case| lines.iter().find(|line| line.is(case, mesh));
            let (Some(first), Some(second)) = (line(from), line(to)) else {
                continue;
            };
            let change = |from: f64, to: f64| 100.0 * (to / from - 1.0);
            let computed = |from: Option<f64>, to: Option<f64>| Some(change(from?, to?));
            let relation = |of, published, computed| Relation {
                from: from.title,
                to: to.title,
                mesh: mesh.name(),
                of,
                published,
                computed,
            };
            let (was, is) = (&first.row, &second.row);
            found.push(relation(
                "mean",
                change(from.mean.value, to.mean.value),
                computed(was.mean, is.mean),
            ));
            found.push(relation(
                "std",
                change(from.std.value, to.std.value),
                computed(was.std, is.std),
            ));
        }
    }
    found
}

impl Line {
    /// Whether it is a published case on a mesh, in one system.
    pub(super) fn is(&self, case: &Case, mesh: Mesh) -> bool {
        self.group.is_case()
            && self.case.scene == case.scene
            && self.mesh == mesh
            && self.row.mode == Mode::Monolithic.name()
    }
}
