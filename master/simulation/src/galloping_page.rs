//! `galloping.html`.

use results::report::plots::{Trace, axis, colour, curve, decades_of, figure, layout};
use results::report::{Page, PageColumn, cells, heads, remarks, saved};
use results::{OutputDirectory, ResultsError};
use system::galloping::{Criterion, Motion};

use crate::galloping::GallopingReport;

/// Height of a figure, CSS pixels.
const HEIGHT: u32 = 360;

/// A number with some decimals, or that there is none.
fn some(value: Option<f64>) -> String {
    value.map_or_else(|| "never".to_owned(), |value| format!("{value:.2}"))
}

/// Name of a motion in a figure.
fn name(motion: &Motion) -> String {
    format!("{:.2} m/s: {}", motion.speed, motion.ends.words())
}

impl GallopingReport {
    /// Writes `galloping.csv` and `galloping.html`.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, folder: &OutputDirectory) -> Result<(), ResultsError> {
        folder.write_page("galloping.csv", &self.csv())?;
        folder.write_page("galloping.html", &self.page())
    }

    /// The report as a page that needs nothing beside it.
    #[must_use]
    pub fn page(&self) -> String {
        let mut page = Page::new(&format!("Galloping of {}", self.scene));
        page.lead("<p>the line without pantographs in steady winds</p>\n");
        page.section("Growth", &(self.envelopes() + &self.table_of_motions()));
        page.section("Path", &self.paths());
        page.section("Criteria", &self.table_of_criteria());
        page.section("Remarks", &remarks(&self.notes));
        page.finish()
    }

    /// A curve for each motion.
    fn curves(&self, points: impl Fn(&Motion) -> &[[f64; 2]]) -> Vec<Trace> {
        let of = |(number, motion): (usize, &Motion)| {
            let (across, upward) = points(motion).iter().map(|[x, y]| (*x, *y)).unzip();
            curve(across, upward, &name(motion), colour(number), 1.5)
        };
        self.motions.iter().enumerate().map(of).collect()
    }

    fn envelopes(&self) -> String {
        let all = self.motions.iter().flat_map(|motion| &motion.envelope);
        let amplitudes = decades_of("vertical amplitude [m]", all.map(|[_, amplitude]| *amplitude));
        figure(
            self.curves(|motion| &motion.envelope),
            layout(axis("time [s]"), amplitudes),
            ("growth", HEIGHT),
            "Vertical amplitude at the mid-span that moves most at the end, in windows of four periods; a small motion \
             that grows or dies out by the linear law is a straight line.",
        )
    }

    fn paths(&self) -> String {
        figure(
            self.curves(|motion| &motion.path),
            layout(axis("lateral, to the left [m]"), axis("upward [m]")),
            ("path", HEIGHT),
            "Path of the same point over the last four periods, from its place of rest in the \
             wind; a limit cycle is one closed curve.",
        )
    }

    fn table_of_motions(&self) -> String {
        let columns: [PageColumn<Motion>; 7] = [
            ("wind", "[m/s]", "n", |motion| format!("{:.3}", motion.speed)),
            ("growth", "[1/s]", "n", |motion| format!("{:.5}", motion.growth)),
            ("vertical", "[m]", "n", |motion| format!("{:.5}", motion.amplitude)),
            ("lateral", "[m]", "n", |motion| {
                format!("{:.5}", motion.lateral_amplitude)
            }),
            ("frequency", "[Hz]", "n", |motion| format!("{:.4}", motion.frequency)),
            ("motion", "", "", |motion| motion.ends.words().to_owned()),
            ("angles of attack", "[°]", "n", |motion| match motion.angles {
                [low, high] if low <= high => format!("{low:.1} to {high:.1}"),
                _ => String::new(),
            }),
        ];
        let lines = self.motions.iter().map(|motion| cells(&columns, motion));
        saved("galloping", &heads(&columns), lines)
    }

    fn table_of_criteria(&self) -> String {
        if self.criteria.is_empty() {
            return String::new();
        }
        let columns: [PageColumn<Criterion>; 6] = [
            ("wire", "", "", |one| one.wire.kind().words().to_owned()),
            ("C_D + dC_L/dα", "", "n", |one| format!("{:.3}", one.slope)),
            ("span", "[Hz]", "n", |one| format!("{:.3}", one.frequency)),
            ("damping", "[%]", "n", |one| format!("{:.2}", 100.0 * one.damping_ratio)),
            ("gallops vertically from", "[m/s]", "n", |one| some(one.critical_speed)),
            ("in any direction from", "[m/s]", "n", |one| some(one.of_all_directions)),
        ];
        let lines = self.criteria.iter().map(|one| cells(&columns, one));
        format!(
            "{}<p class=\"caption\">Den Hartog's sum and the critical winds of each wire as a string over the longest \
             span.</p>\n",
            saved("criteria", &heads(&columns), lines)
        )
    }
}
