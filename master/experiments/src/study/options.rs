//! Options of a study, and its sweeps.

use crate::engine::words;

/// Options of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Elements per dropper interval.
    pub elements: Vec<usize>,
    /// Micro steps, s.
    pub micro_steps: Vec<f64>,
    /// Macro steps, s.
    pub macro_steps: Vec<f64>,
    /// Spectral radii, –.
    pub rho_inf: Vec<f64>,
    /// Sets of reductions, each joined by `+`; empty is the usual ones.
    pub reductions: Vec<String>,
    /// Times that a run is timed.
    pub repeats: usize,
    /// Fewer runs.
    pub quick: bool,
    /// Difference of two successive levels at which a reference counts as converged, % of the standard deviation.
    pub tolerance: f64,
    /// Most work that one run of a reference may be, coordinates times micro steps.
    pub work: f64,
    /// Numbers of spans of the whole line that its cost is measured at.
    pub spans: Vec<usize>,
    /// Numbers of spans that the cost of a window is measured at.
    pub window_spans: Vec<usize>,
    /// Sweeps that are made; empty is all.
    pub sweeps: Vec<Sweep>,
}

impl Options {
    /// Tolerance of the reference when nothing is said, % of the standard deviation.
    pub const TOLERANCE: f64 = 0.2;
    /// Most work of a run of the reference when nothing is said: 64 elements per interval of the line of EN 50318 at
    /// 0.125 ms are 2e9.
    pub const WORK: f64 = 4e9;

    /// Options when nothing is said.
    #[must_use]
    pub fn usual(quick: bool) -> Self {
        let (elements, micro_steps, rho_inf): (&[_], &[_], &[_]) = if quick {
            (&[2, 4, 8], &[5e-4, 1e-3, 2e-3], &[])
        } else {
            let micro_steps = &[2.5e-4, 5e-4, 1e-3, 2e-3];
            (&[1, 2, 4, 8, 16], micro_steps, &[0.5, 0.8, 0.9, 1.0])
        };
        Self {
            elements: elements.to_vec(),
            micro_steps: micro_steps.to_vec(),
            macro_steps: vec![1e-3, 2e-3, 5e-3],
            rho_inf: rho_inf.to_vec(),
            reductions: Vec::new(),
            repeats: 3,
            quick,
            tolerance: Self::TOLERANCE,
            work: Self::WORK,
            spans: Vec::new(),
            window_spans: Vec::new(),
            sweeps: Vec::new(),
        }
    }

    /// `true` where a sweep is asked for; all are where none is named.
    pub(super) fn sweeps_over(&self, sweep: Sweep) -> bool {
        self.sweeps.is_empty() || self.sweeps.contains(&sweep)
    }
}

words! {
    /// Sweeps that a run is part of.
    pub enum Sweep {
        /// Levels of a reference.
        Reference = "reference",
        /// The scene as it is.
        Scene = "scene",
        /// Elements per dropper interval and corrections.
        Mesh = "mesh",
        /// Micro step.
        MicroStep = "micro_step",
        /// Macro step, algorithm and extrapolation.
        Coupling = "coupling",
        /// Spectral radius at infinite frequency.
        RhoInf = "rho_inf",
        /// Reductions.
        Reductions = "reductions",
        /// Vehicle below the pantograph.
        Vehicle = "vehicle",
        /// Mesh and micro step changed together, for each class of reductions.
        Ladder = "ladder",
        /// Number of spans.
        Spans = "spans",
    }
}

impl Sweep {
    /// Sweeps that can be asked for: every study has its references.
    pub const CHOICE: &[Self] = Self::ALL.split_at(1).1;

    /// `true` where its runs are judged by the reference of their family.
    pub(super) fn is_judged_by_reference(self) -> bool {
        !matches!(self, Self::Spans | Self::Vehicle)
    }
}
