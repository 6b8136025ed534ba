//! Blocks of passages and their figures, as they are kept.

use serde::{Deserialize, Serialize};
use wear::{Profile, RoundSection, Terms, Train};

/// Passages over a line that wears.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Hash of scene, wishes and program: a record with the same one is continued.
    pub identity: String,
    /// Name of the scene.
    pub scene: String,
    /// Mode of the runs.
    pub mode: String,
    /// Passages asked for.
    pub asked: u64,
    /// `true` where all are done, or the wire has reached its limit.
    pub complete: bool,
    /// Places that the wear of a passage is applied to, `span` or `place`.
    pub applied: String,
    /// Diameter of the wire, m.
    pub diameter_m: f64,
    /// Lost area at which the wire is replaced, m².
    pub limit_area_m2: f64,
    /// Passages after which the most worn place is at the limit, counted on with the wear of the last run.
    pub wire_life_passages: Option<f64>,
    /// Blocks; the last one has no passages of its own, its run shows the worn line.
    pub blocks: Vec<Block>,
    /// Lost area after all blocks, m².
    pub lost: Profile,
    /// Runs with other static forces on the line as it was.
    pub forces: Vec<ForceEffect>,
    /// Remarks.
    pub notes: Vec<String>,
}

/// A run, and the passages that wear the line as it has found them to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Block {
    /// Passages before the run.
    pub passages: u64,
    /// Passages that wear as this run does.
    pub added: u64,
    /// Figures of the run.
    pub figures: RunFigures,
    /// Mean worn depth after the block, m.
    pub mean_depth_m: f64,
    /// Largest worn depth after the block, m.
    pub largest_depth_m: f64,
    /// Place of it, from the left support where it holds for every span, m.
    pub largest_x_m: f64,
    /// Smallest worn depth after the block, m.
    pub smallest_depth_m: f64,
    /// Lost area of each cell after the block, m².
    pub area_m2: Vec<f64>,
}

/// Figures of one run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RunFigures {
    /// Mean of the filtered force of each pantograph, N.
    pub mean_n: Vec<Option<f64>>,
    /// Its standard deviation, N.
    pub std_n: Vec<Option<f64>>,
    /// Mean area lost by one passage, m².
    pub area_m2: Terms,
    /// Largest area lost by one passage, m².
    pub largest_area_m2: f64,
    /// Electrical figures, arcs and strips.
    pub train: Train,
}

/// A run with another static force.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ForceEffect {
    /// Static force, % of that of the scene.
    pub percent: f64,
    /// Static force of each pantograph, N.
    pub static_force_n: Vec<f64>,
    /// Figures of the run.
    pub figures: RunFigures,
    /// Passages after which the most worn place is at the limit, the same wear in each.
    pub wire_life_passages: Option<f64>,
}

impl RunFigures {
    /// Shortest life of a strip of the train, m.
    #[must_use]
    pub fn strip_life(&self) -> Option<f64> {
        let heads = self.train.pantographs.iter();
        let lives = heads.filter_map(|head| head.strip?.life_m);
        lives.reduce(f64::min)
    }

    /// Share of the time with an arc, the largest of all pantographs, %.
    #[must_use]
    pub fn arc_percent(&self) -> f64 {
        let heads = self.train.pantographs.iter();
        heads.map(|head| head.arc_percent).fold(0.0, f64::max)
    }
}

impl Record {
    /// Section of the wire.
    #[must_use]
    pub fn section(&self) -> RoundSection {
        RoundSection {
            diameter: self.diameter_m,
        }
    }

    /// Passages done.
    #[must_use]
    pub fn passages(&self) -> u64 {
        self.blocks.last().map_or(0, |block| block.passages + block.added)
    }
}
