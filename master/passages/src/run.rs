//! Blocks of passages, kept after each.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use results::report::Progress;
use results::{OutputDirectory, Summary};
use scene::{PantographModel, Scene};
use simulation::identity::{by_content, digest, program};
use simulation::{FmuSource, Mode, SetupError, prepare};
use system::run::Watch;
use wear::{Profile, Terms};

use crate::jump::{Worn, passages_within};
use crate::record::{Block, ForceEffect, Record, RunFigures};
use crate::{JSON, PassagesError, WornLine};

/// Least number of blocks: a line that wears evenly is simulated so often, too.
const BLOCKS: u64 = 8;

/// Blocks beyond which a step of the depth is a slip of the unit.
const MOST_BLOCKS: f64 = 2000.0;

/// Demands of the command line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wishes {
    /// Passages.
    pub passages: u64,
    /// Passages in each block; chosen by `wear.depth_step` without.
    pub every: Option<u64>,
    /// Static forces that are compared, % of those of the scene.
    pub forces: Vec<f64>,
}

/// Static forces as they are typed, in a type of their own for readers of command lines.
#[derive(Clone, Debug)]
pub struct Forces(pub Vec<f64>);

impl Forces {
    /// Percentages separated by commas, or `none`.
    ///
    /// # Errors
    /// Which percentage is none, and what would be right.
    pub fn typed(text: &str) -> Result<Self, String> {
        if text == "none" {
            return Ok(Self(Vec::new()));
        }
        let one = |part: &str| {
            let percent = part.trim().parse::<f64>().ok();
            let percent = percent.filter(|percent| *percent > 0.0 && *percent <= 1000.0);
            percent.ok_or_else(|| format!("{part:?}: must be percentages above 0, at most 1000, or none"))
        };
        text.split(',').map(one).collect::<Result<_, _>>().map(Self)
    }
}

/// Surroundings of the runs.
pub struct Surroundings<'a> {
    /// Name of the scene in results.
    pub name: &'a str,
    /// Folder that paths in the scene are relative to.
    pub base: &'a Path,
    /// Mode of the runs.
    pub mode: Mode,
    /// `true` where FMUs log debug messages.
    pub logging: bool,
    /// Folder for packages of FMUs.
    pub fmus: PathBuf,
    /// Set where the user wants an end.
    pub interrupted: &'a AtomicBool,
    /// Bar.
    pub progress: &'a Progress,
}

/// Lets a train pass `wishes.passages` times and keeps the record in `output` after every run; goes on from the record
/// there where it has the same identity. The record is not complete where `interrupted` is set meanwhile.
///
/// # Errors
/// [`PassagesError`].
pub fn run(
    scene: &Scene,
    wishes: &Wishes,
    around: &Surroundings<'_>,
    output: &OutputDirectory,
) -> Result<Record, PassagesError> {
    let line = WornLine::new(scene)?;
    let identity = identity(scene, wishes, around);
    let mut record = kept(output.path(), &identity).unwrap_or_else(|| Record {
        identity,
        scene: around.name.to_owned(),
        mode: around.mode.name().to_owned(),
        asked: wishes.passages,
        applied: scene
            .wear
            .as_ref()
            .map_or_else(String::new, |wear| wear.applied.to_string()),
        diameter_m: line.section().diameter,
        limit_area_m2: line.limit(),
        lost: line.begin(),
        notes: simulation::wearing::remarks(scene),
        ..Record::default()
    });
    let passages = Passages {
        scene,
        line,
        wishes,
        around,
    };
    around.progress.done_earlier(passages.share(&record));
    while !record.complete && !around.interrupted.load(Ordering::Relaxed) {
        let more = if record.forces.len() < wishes.forces.len() {
            passages.compare_force(&mut record)?
        } else {
            passages.add_block(&mut record)?
        };
        if !more {
            break;
        }
        output.write_json(JSON, &record)?;
    }
    Ok(record)
}

/// Hash of what the record follows from.
fn identity(scene: &Scene, wishes: &Wishes, around: &Surroundings<'_>) -> String {
    let wishes = format!("{wishes:?} {}", around.mode.name());
    let scene = by_content(scene, around.base).to_toml();
    digest(&[scene.as_bytes(), wishes.as_bytes(), program().as_bytes()])
}

/// The record of the same passages in a folder.
fn kept(folder: &Path, identity: &str) -> Option<Record> {
    let text = std::fs::read_to_string(folder.join(JSON)).ok()?;
    let record: Record = serde_json::from_str(&text).ok()?;
    (record.identity == identity).then_some(record)
}

struct Passages<'a> {
    scene: &'a Scene,
    line: WornLine,
    wishes: &'a Wishes,
    around: &'a Surroundings<'a>,
}

/// A run with the wear of one passage.
struct Passed {
    figures: RunFigures,
    by_passage: Profile,
}

impl Passages<'_> {
    /// Share of the work that a record holds, 0 to 1.
    fn share(&self, record: &Record) -> f64 {
        let forces = self.wishes.forces.len() as f64;
        let blocks = BLOCKS as f64 + 1.0;
        let passed = record.passages() as f64 / self.wishes.passages.max(1) as f64;
        (record.forces.len() as f64 + blocks * passed) / (forces + blocks)
    }

    /// Runs a scene after `passages` passages; nothing where it was interrupted.
    fn pass(&self, scene: Scene, passages: u64) -> Result<Option<Passed>, PassagesError> {
        let around = self.around;
        let failed = |source: SetupError| PassagesError::Setup {
            passages,
            source: Box::new(source),
        };
        let mut prepared = prepare(scene, around.name, around.base, around.logging).map_err(failed)?;
        prepared.pictures = false;
        let source = FmuSource {
            folder: around.fmus.clone(),
            logging: around.logging,
        };
        let bar = around.progress.beside(0.0, prepared.scene.run.duration);
        let watch = Watch::new(around.interrupted, &bar);
        let finished = prepared.run(around.mode, &source, &watch, |_| Ok(())).map_err(failed)?;
        if finished.failure.is_some() {
            if around.interrupted.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let reason = finished.info.incomplete_reason;
            return Err(PassagesError::Incomplete { passages, reason });
        }
        let (by_passage, area_m2) = self.line.lost(&finished.info.evaluation, &finished.record)?;
        let summary = Summary::without_detail(&finished.info, &finished.record);
        Ok(Some(Passed {
            figures: figures(summary, area_m2, by_passage.largest().1),
            by_passage,
        }))
    }

    /// Runs the next static force; `false` where it was interrupted.
    fn compare_force(&self, record: &mut Record) -> Result<bool, PassagesError> {
        let percent = self.wishes.forces[record.forces.len()];
        let mut scene = self.line.scene(self.scene, &self.line.begin());
        let mut forces = Vec::new();
        for pantograph in &mut scene.pantographs {
            if let PantographModel::Lumped(lumped) = &mut pantograph.model {
                lumped.static_force *= 0.01 * percent;
                forces.push(lumped.static_force);
            }
        }
        if forces.len() < scene.pantographs.len() {
            let what = "--forces: only lumped pantographs have a static force that can be varied; must be left out, \
                        --forces none";
            return Err(PassagesError::Scene(what.to_owned()));
        }
        let Some(passed) = self.pass(scene, 0)? else {
            return Ok(false);
        };
        let begin = self.line.begin();
        let worn = Worn {
            section: self.line.section(),
            lost: &begin,
            by_passage: &passed.by_passage,
        };
        record.forces.push(ForceEffect {
            percent,
            static_force_n: forces,
            wire_life_passages: worn.passages_to(self.line.limit()),
            figures: passed.figures,
        });
        self.advance(record, &format!("static force {percent} %"));
        Ok(true)
    }

    /// Runs the worn line and wears it by a block of passages; `false` where it was interrupted.
    fn add_block(&self, record: &mut Record) -> Result<bool, PassagesError> {
        let done = record.passages();
        let scene = self.line.scene(self.scene, &record.lost);
        let Some(passed) = self.pass(scene, done)? else {
            return Ok(false);
        };
        let worn = Worn {
            section: self.line.section(),
            lost: &record.lost,
            by_passage: &passed.by_passage,
        };
        let to_limit = worn.passages_to(self.line.limit());
        let added = self.added(&worn, done, to_limit)?;
        record.wire_life_passages = to_limit.map(|more| done as f64 + more);
        for (lost, rate) in record.lost.area.iter_mut().zip(&passed.by_passage.area) {
            *lost += added as f64 * rate;
        }
        record.complete = added == 0;
        if record.complete && done < self.wishes.passages {
            record.notes.push(format!(
                "the most worn place has lost its {:.1} mm² after {done} passages: the wire is to be replaced",
                1e6 * record.limit_area_m2
            ));
        }
        record
            .blocks
            .push(self.block(done, added, passed.figures, &record.lost));
        self.advance(record, &format!("{} passages", record.passages()));
        Ok(true)
    }

    /// Passages of the next block; none at the end or at the limit of the wire.
    fn added(&self, worn: &Worn<'_>, done: u64, to_limit: Option<f64>) -> Result<u64, PassagesError> {
        let rest = self.wishes.passages - done;
        let most = match self.wishes.every {
            Some(every) => every.min(rest),
            None => self.wishes.passages.div_ceil(BLOCKS).min(rest),
        };
        let most = to_limit.map_or(most, |limit| most.min(limit.ceil() as u64));
        if most == 0 || self.wishes.every.is_some() {
            return Ok(most);
        }
        let step = self.line.depth_step();
        let added = passages_within(worn, step, most);
        if rest as f64 / added as f64 > MOST_BLOCKS {
            return Err(PassagesError::Scene(format!(
                "wear.depth_step = {step} m: {added} passages change the unevenness of the wire by it, and the {rest} \
                 to come would take {:.0} runs; must be larger, or --every be given",
                rest as f64 / added as f64
            )));
        }
        Ok(added)
    }

    fn block(&self, passages: u64, added: u64, figures: RunFigures, lost: &Profile) -> Block {
        let depths = self.line.depths(lost);
        let place = depths.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        Block {
            passages,
            added,
            figures,
            mean_depth_m: depths.iter().sum::<f64>() / depths.len() as f64,
            largest_depth_m: place.map_or(0.0, |(_, depth)| *depth),
            largest_x_m: place.map_or(0.0, |(index, _)| lost.x(index)),
            smallest_depth_m: depths.iter().copied().fold(f64::INFINITY, f64::min),
            area_m2: lost.area.clone(),
        }
    }

    fn advance(&self, record: &Record, message: &str) {
        self.around.progress.set(self.share(record));
        self.around.progress.message(message);
    }
}

fn figures(summary: Summary, area_m2: Terms, largest_area_m2: f64) -> RunFigures {
    let forces = summary.pantographs.iter().map(|head| head.contact_force.filtered);
    let forces: Vec<_> = forces.collect();
    RunFigures {
        mean_n: forces.iter().map(|force| force.map(|force| force.mean)).collect(),
        std_n: forces.iter().map(|force| force.map(|force| force.std)).collect(),
        area_m2,
        largest_area_m2,
        train: summary.wear.unwrap_or_default(),
    }
}
