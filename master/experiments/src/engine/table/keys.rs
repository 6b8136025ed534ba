//! Keys of the runs of a table.

/// Name of the automatic choice among the algorithms.
pub const AUTO: &str = scene::Algorithm::Auto.name();

/// Keys of `[coupling]` that all runs share, and those of the algorithm that the scene names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Keys {
    /// Algorithm that the scene names.
    pub named: String,
    /// End of the repetition, whatever the algorithm: entries of the table.
    pub shared: String,
    /// Keys of the table that were typed on the command line: they hold for all algorithms.
    pub typed: Vec<String>,
}

impl Keys {
    /// Keys of a scene that was read with these overrides.
    #[must_use]
    pub fn of(scene: &scene::Scene, overrides: &[String]) -> Self {
        let coupling = &scene.coupling;
        let typed = overrides.iter().filter(|text| {
            let key = text.split('=').next().unwrap_or("").trim();
            key.starts_with("coupling.") && !["coupling.algorithm", "coupling.macro_step"].contains(&key)
        });
        Self {
            named: coupling.algorithm.name().to_owned(),
            shared: format!(
                "max_iterations = {}, force_tolerance = {:?}",
                coupling.max_iterations, coupling.force_tolerance
            ),
            typed: typed.cloned().collect(),
        }
    }

    /// The overrides of a run. What a scene says of order, force and extrapolation belongs to the algorithm that it
    /// names; the others are run with what suits them best when nothing is said.
    #[must_use]
    pub fn overrides(&self, algorithm: &str, macro_step: f64, micro_step: f64) -> Vec<String> {
        let mut keys = vec![format!("solver.micro_step={micro_step:?}")];
        if algorithm.is_empty() || algorithm == self.named && algorithm != AUTO {
            keys.push(format!("coupling.macro_step={macro_step:?}"));
        } else {
            keys.push(format!(
                "coupling={{ algorithm = \"{algorithm}\", macro_step = {macro_step:?}, {} }}",
                self.shared
            ));
        }
        keys.extend(self.typed.iter().cloned());
        keys
    }
}
