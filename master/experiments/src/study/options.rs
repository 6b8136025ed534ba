//! Options of a study, and its sweeps.

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
    /// Elements per dropper interval when nothing is said.
    pub const ELEMENTS: [usize; 5] = [1, 2, 4, 8, 16];
    /// Micro steps when nothing is said, s.
    pub const MICRO_STEPS: [f64; 4] = [2.5e-4, 5e-4, 1e-3, 2e-3];
    /// Macro steps when nothing is said, s.
    pub const MACRO_STEPS: [f64; 3] = [1e-3, 2e-3, 5e-3];
    /// Elements of a reduced study.
    pub const QUICK_ELEMENTS: [usize; 3] = [2, 4, 8];
    /// Micro steps of a reduced study, s.
    pub const QUICK_MICRO_STEPS: [f64; 3] = [5e-4, 1e-3, 2e-3];
    /// Spectral radii when nothing is said, –.
    pub const RHO_INF: [f64; 4] = [0.5, 0.8, 0.9, 1.0];
    /// Tolerance of the reference when nothing is said, % of the standard deviation.
    pub const TOLERANCE: f64 = 0.2;
    /// Most work of a run of the reference when nothing is said: 64 elements per interval of the line of EN 50318 at
    /// 0.125 ms are 2e9.
    pub const WORK: f64 = 4e9;
}

impl Options {
    /// `true` where a sweep is asked for; all are where none is named.
    pub(super) fn sweeps_over(&self, sweep: Sweep) -> bool {
        self.sweeps.is_empty() || self.sweeps.contains(&sweep)
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            elements: Self::ELEMENTS.to_vec(),
            micro_steps: Self::MICRO_STEPS.to_vec(),
            macro_steps: Self::MACRO_STEPS.to_vec(),
            rho_inf: Self::RHO_INF.to_vec(),
            reductions: Vec::new(),
            repeats: 3,
            quick: false,
            tolerance: Self::TOLERANCE,
            work: Self::WORK,
            spans: Vec::new(),
            window_spans: Vec::new(),
            sweeps: Vec::new(),
        }
    }
}

/// Sweeps that a run is part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sweep {
    /// Levels of a reference.
    Reference,
    /// The scene as it is.
    Scene,
    /// Elements per dropper interval and corrections.
    Mesh,
    /// Micro step.
    MicroStep,
    /// Macro step, algorithm and extrapolation.
    Coupling,
    /// Spectral radius at infinite frequency.
    RhoInf,
    /// Reductions.
    Reductions,
    /// Mesh and micro step changed together, for each class of reductions.
    Ladder,
    /// Number of spans.
    Spans,
    /// Vehicle below the pantograph.
    Vehicle,
}

impl Sweep {
    /// Sweeps that can be asked for: every study has its references.
    pub const CHOICE: [Self; 9] = [
        Self::Scene,
        Self::Mesh,
        Self::MicroStep,
        Self::Coupling,
        Self::RhoInf,
        Self::Reductions,
        Self::Vehicle,
        Self::Ladder,
        Self::Spans,
    ];

    /// `true` where its runs are judged by the reference of their family.
    pub(super) fn is_judged_by_reference(self) -> bool {
        !matches!(self, Self::Spans | Self::Vehicle)
    }

    /// The word of the table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Reference => "reference",
            Self::Scene => "scene",
            Self::Mesh => "mesh",
            Self::MicroStep => "micro_step",
            Self::Coupling => "coupling",
            Self::RhoInf => "rho_inf",
            Self::Reductions => "reductions",
            Self::Ladder => "ladder",
            Self::Spans => "spans",
            Self::Vehicle => "vehicle",
        }
    }
}
