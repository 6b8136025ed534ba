//! Published figures of the thesis.

use serde::Serialize;

/// A printed number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Its value.
    pub value: f64,
    /// Decimals that are printed.
    decimals: usize,
}

impl Figure {
    const fn new(value: f64, decimals: usize) -> Self {
        Self { value, decimals }
    }

    /// As it is printed.
    pub(super) fn printed(&self) -> String {
        format!("{:.*}", self.decimals, self.value)
    }
}

/// One of the published cases.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Case {
    /// Name of the scene that computes it.
    pub scene: &'static str,
    /// Title.
    pub title: &'static str,
    /// Mean contact force, N, positive in compression: the thesis prints the force on the pan-head as negative.
    pub mean: Figure,
    /// Standard deviation, N.
    pub std: Figure,
    /// Place in the thesis.
    pub source: &'static str,
}

/// The published cases; the first is the one that the others are changes of.
pub const CASES: [Case; 4] = [
    Case {
        scene: "thesis-own-mesh",
        title: "penalty contact, no wind",
        mean: Figure::new(107.79, 2),
        std: Figure::new(36.73, 2),
        source: "Thesis, Table 6",
    },
    Case {
        scene: "thesis-sliding-joint",
        title: "sliding joint, no wind",
        mean: Figure::new(110.427, 3),
        std: Figure::new(37.3033, 4),
        source: "Thesis, 5.1",
    },
    Case {
        scene: "thesis-wind-pantograph",
        title: "wind on the pantograph",
        mean: Figure::new(120.22, 2),
        std: Figure::new(35.70, 2),
        source: "Thesis, Table 6",
    },
    Case {
        scene: "thesis-wind-both",
        title: "wind on pantograph and wires",
        mean: Figure::new(120.21, 2),
        std: Figure::new(35.66, 2),
        source: "Thesis, Table 6",
    },
];
