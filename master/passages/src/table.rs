//! The record on the terminal and as `wear.csv`.

use results::report::format::{decimals, round_count, short};
use results::report::{TextColumn, aligned, text_table};
use results::{OutputDirectory, ResultsError};

use crate::record::{Block, ForceEffect, Record, RunFigures};
use crate::{CSV, JSON, PAGE};

/// Passages that worn areas are given for.
pub(crate) const MANY: f64 = 1e6;

/// First pantograph's figure of a list.
fn leading(values: &[Option<f64>]) -> Option<f64> {
    values.first().copied().flatten()
}

/// Area of one passage in mm² of [`MANY`].
pub(crate) fn area(area: f64) -> String {
    short(Some(1e6 * MANY * area))
}

fn mm(depth: f64) -> String {
    format!("{:.4}", 1e3 * depth)
}

pub(crate) fn mean(figures: &RunFigures) -> String {
    decimals(leading(&figures.mean_n), 2)
}

pub(crate) fn std(figures: &RunFigures) -> String {
    decimals(leading(&figures.std_n), 2)
}

pub(crate) fn strip_life(figures: &RunFigures) -> String {
    round_count(figures.strip_life().map(|life| 1e-3 * life))
}

const BLOCKS: &[TextColumn<Block, 2>] = &[
    (["passages", ""], |block| block.passages.to_string()),
    (["mean", "[N]"], |block| mean(&block.figures)),
    (["σ", "[N]"], |block| std(&block.figures)),
    (["arcs", "[%]"], |block| format!("{:.3}", block.figures.arc_percent())),
    (["area", "[mm²/10⁶]"], |block| area(block.figures.area_m2.sum())),
    (["further", "passages"], |block| block.added.to_string()),
    (["depth", "[mm]"], |block| mm(block.mean_depth_m)),
    (["largest", "[mm]"], |block| mm(block.largest_depth_m)),
    (["at", "[m]"], |block| format!("{:.2}", block.largest_x_m)),
    (["smallest", "[mm]"], |block| mm(block.smallest_depth_m)),
];

const FORCES: &[TextColumn<ForceEffect, 2>] = &[
    (["static force", "[%]"], |effect| effect.percent.to_string()),
    (["mean", "[N]"], |effect| mean(&effect.figures)),
    (["σ", "[N]"], |effect| std(&effect.figures)),
    (["arcs", "[%]"], |effect| format!("{:.3}", effect.figures.arc_percent())),
    (["friction", "[mm²/10⁶]"], |effect| {
        area(effect.figures.area_m2.mechanical)
    }),
    (["heat", "[mm²/10⁶]"], |effect| area(effect.figures.area_m2.joule)),
    (["arcs", "[mm²/10⁶]"], |effect| area(effect.figures.area_m2.arc)),
    (["wire lasts", "[passages]"], |effect| {
        round_count(effect.wire_life_passages)
    }),
    (["strip lasts", "[km]"], |effect| strip_life(&effect.figures)),
];

impl Record {
    /// Figures of the record as text.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!("{}, {}: {} passages\n", self.scene, self.mode, self.passages());
        text.push_str(&aligned(&text_table(BLOCKS, &self.blocks)));
        if let Some(last) = self.blocks.last() {
            text.push_str(&format!(
                "  the wire reaches its limit of {:.1} mm² after {} passages, a strip after {} km\n",
                1e6 * self.limit_area_m2,
                round_count(self.wire_life_passages),
                strip_life(&last.figures),
            ));
        }
        if !self.forces.is_empty() {
            text.push('\n');
            text.push_str(&aligned(&text_table(FORCES, &self.forces)));
        }
        for note in &self.notes {
            text.push_str(&format!("  note: {note}\n"));
        }
        text
    }

    /// Writes record, profiles and page.
    ///
    /// # Errors
    /// Reports of the operating system.
    pub fn write(&self, output: &OutputDirectory) -> Result<(), ResultsError> {
        output.write_json(JSON, self)?;
        output.replace(CSV, |out, path| {
            let failed = |source: csv::Error| ResultsError::Io {
                path: path.to_owned(),
                action: "write",
                source: source.into(),
            };
            let mut rows = csv::Writer::from_writer(out);
            let head = ["passages", "x_m", "lost_area_mm2", "depth_mm"];
            rows.write_record(head).map_err(failed)?;
            for block in &self.blocks {
                let passages = (block.passages + block.added).to_string();
                for (index, area) in block.area_m2.iter().enumerate() {
                    let depth = self.section().depth(*area);
                    let numbers = [self.lost.x(index), 1e6 * area, 1e3 * depth];
                    let [x, area, depth] = numbers.map(|number| number.to_string());
                    rows.write_record([passages.clone(), x, area, depth]).map_err(failed)?;
                }
            }
            rows.flush().map_err(results::io(path, "write"))
        })?;
        output.write_page(PAGE, &self.page())
    }
}
