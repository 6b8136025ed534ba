//! `wear.html`.

use results::report::format::round_count;
use results::report::plots::{axis, colour, curve, figure, layout, rounded};
use results::report::{Page, PageColumn, cells, escape, heads, remarks, saved};

use crate::record::{Block, ForceEffect, Record};
use crate::table::{area, mean, std, strip_life};

/// Curves of worn profiles drawn beside each other.
const DRAWN: usize = 6;

/// Height of a figure, CSS pixels.
const HEIGHT: u32 = 360;

/// Steps per mm that a drawn depth is rounded to.
const FINE: f64 = 1e5;

impl Record {
    /// The record as a page that needs nothing beside it.
    #[must_use]
    pub fn page(&self) -> String {
        let mut page = Page::new(&format!("Wear of {}", self.scene));
        let life = self
            .blocks
            .last()
            .map(|last| strip_life(&last.figures))
            .unwrap_or_default();
        page.lead(&format!(
            "<p>{} · {} passages · the wire reaches its limit of {:.1} mm² after {} passages, a strip after {life} \
             km</p>\n",
            escape(&self.mode),
            self.passages(),
            1e6 * self.limit_area_m2,
            round_count(self.wire_life_passages),
        ));
        page.section("Map of wear", &self.map());
        page.section("Passages", &(self.depths() + &self.table_of_blocks()));
        page.section("Static force", &self.table_of_forces());
        page.section("Remarks", &remarks(&self.notes));
        page.finish()
    }

    /// Blocks that are drawn: the last one and some before it.
    fn drawn(&self) -> Vec<&Block> {
        let every = self.blocks.len().div_ceil(DRAWN).max(1);
        let mut drawn: Vec<&Block> = self.blocks.iter().rev().skip(1).step_by(every).collect();
        drawn.reverse();
        drawn
    }

    fn map(&self) -> String {
        let x: Vec<f64> = (0..self.lost.area.len()).map(|index| self.lost.x(index)).collect();
        let curves = self.drawn().into_iter().enumerate().map(|(number, block)| {
            let depths: Vec<f64> = block
                .area_m2
                .iter()
                .map(|area| 1e3 * self.section().depth(*area))
                .collect();
            let name = format!("{} passages", block.passages + block.added);
            curve(rounded(&x, 1e3), rounded(&depths, FINE), &name, colour(number), 1.5)
        });
        let place = match self.applied.as_str() {
            "span" => "x from the left support of every span [m]",
            _ => "x [m]",
        };
        figure(
            curves.collect(),
            layout(axis(place), axis("worn depth [mm]")),
            ("map", HEIGHT),
            "Worn depth of the contact wire, as it is fed back into its running surface.",
        )
    }

    fn depths(&self) -> String {
        let passages: Vec<f64> = self
            .blocks
            .iter()
            .map(|block| (block.passages + block.added) as f64)
            .collect();
        let depth = |name: &str, of: fn(&Block) -> f64, number: usize| {
            let depths: Vec<f64> = self.blocks.iter().map(|block| 1e3 * of(block)).collect();
            curve(passages.clone(), rounded(&depths, FINE), name, colour(number), 1.5)
        };
        let curves = vec![
            depth("mean", |block| block.mean_depth_m, 0),
            depth("largest", |block| block.largest_depth_m, 1),
            depth("smallest", |block| block.smallest_depth_m, 2),
        ];
        let drawn = figure(
            curves,
            layout(axis("passages"), axis("worn depth [mm]")),
            ("depths", HEIGHT),
            "Depth against passages.",
        );
        let before = self.blocks.iter().map(|block| block.passages as f64).collect();
        let sigma = self.blocks.iter().filter_map(|block| *block.figures.std_n.first()?);
        let curves = vec![curve(before, sigma.collect(), "σ", colour(0), 1.5)];
        drawn
            + &figure(
                curves,
                layout(axis("passages"), axis("σ of the contact force [N]")),
                ("sigma", HEIGHT),
                "Standard deviation of the filtered contact force of the leading pantograph on the worn line.",
            )
    }

    fn table_of_blocks(&self) -> String {
        let columns: [PageColumn<Block>; 9] = [
            ("passages", "", "n", |block| block.passages.to_string()),
            ("mean", "[N]", "n", |block| mean(&block.figures)),
            ("σ", "[N]", "n", |block| std(&block.figures)),
            ("friction", "[mm²/10⁶]", "n", |block| {
                area(block.figures.area_m2.mechanical)
            }),
            ("heat", "[mm²/10⁶]", "n", |block| area(block.figures.area_m2.joule)),
            ("arcs", "[mm²/10⁶]", "n", |block| area(block.figures.area_m2.arc)),
            ("further passages", "", "n", |block| block.added.to_string()),
            ("mean depth", "[mm]", "n", |block| {
                format!("{:.4}", 1e3 * block.mean_depth_m)
            }),
            ("largest depth", "[mm]", "n", |block| {
                format!("{:.4}", 1e3 * block.largest_depth_m)
            }),
        ];
        let lines = self.blocks.iter().map(|block| cells(&columns, block));
        saved("passages", &heads(&columns), lines)
    }

    fn table_of_forces(&self) -> String {
        if self.forces.is_empty() {
            return String::new();
        }
        let columns: [PageColumn<ForceEffect>; 8] = [
            ("static force", "[%]", "n", |effect| effect.percent.to_string()),
            ("mean", "[N]", "n", |effect| mean(&effect.figures)),
            ("σ", "[N]", "n", |effect| std(&effect.figures)),
            ("friction", "[mm²/10⁶]", "n", |effect| {
                area(effect.figures.area_m2.mechanical)
            }),
            ("heat", "[mm²/10⁶]", "n", |effect| area(effect.figures.area_m2.joule)),
            ("arcs", "[mm²/10⁶]", "n", |effect| area(effect.figures.area_m2.arc)),
            ("wire lasts", "[passages]", "n", |effect| {
                round_count(effect.wire_life_passages)
            }),
            ("strip lasts", "[km]", "n", |effect| strip_life(&effect.figures)),
        ];
        let lines = self.forces.iter().map(|effect| cells(&columns, effect));
        format!(
            "{}<p class=\"caption\">Runs with other static forces on the line as it is at the beginning; lives count \
             on the same wear in each passage.</p>\n",
            saved("forces", &heads(&columns), lines)
        )
    }
}
