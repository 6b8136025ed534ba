//! A line at rest, and the page of it.

use super::{panels, tables};
use crate::Model;
use crate::report::{Page, escape, remarks};
use crate::standards::Limit;

/// Style of the page, beyond that of all pages.
const STYLE: &str = include_str!("line.css");
/// Zoom, values under the pointer, labels.
const SCRIPT: &str = include_str!("line.js");

/// A line at rest, to be drawn and tabled.
#[derive(Clone, Debug, Default)]
pub struct LinePage {
    /// Title of the scene.
    pub title: String,
    /// Name of the scene.
    pub scene: String,
    /// Running speed, km/h.
    pub speed_kmh: f64,
    /// x of all masts, m.
    pub masts: Vec<f64>,
    /// Evaluated spans.
    pub evaluated: PageRange,
    /// Spans that the page shows; the CSV files have all.
    pub shown: PageRange,
    /// Wires.
    pub wires: Vec<PageWire>,
    /// Droppers.
    pub droppers: Vec<PageDropper>,
    /// Supports of each tension length in turn.
    pub supports: Vec<PageSupport>,
    /// Point masses.
    pub masses: Vec<PageMass>,
    /// Curvature of the track for each tension length: places along the track in m, values in 1/m, positive to the
    /// left; empty on straight track.
    pub curvature: Vec<Vec<(f64, f64)>>,
    /// Elasticity: place along the track in m, rise in m/N.
    pub elasticity: Vec<(f64, f64)>,
    /// Spans with elasticity.
    pub spans: Vec<PageSpan>,
    /// Half the width of the strips, m.
    pub half_widths: Vec<f64>,
    /// Tensions of the wires.
    pub tensions: Vec<PageTension>,
    /// Limits that the line at rest is held against.
    pub limits: Vec<Limit>,
    /// The model.
    pub model: Model,
    /// Remarks.
    pub notes: Vec<String>,
}

/// Spans of the line, from 1, and their places along the track.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PageRange {
    /// First span.
    pub first: usize,
    /// Last span.
    pub last: usize,
    /// Start of the first one, m.
    pub from: f64,
    /// End of the last one, m.
    pub to: f64,
}

impl PageRange {
    /// True where `x` (m) lies within.
    #[must_use]
    pub fn contains(&self, x: f64) -> bool {
        (self.from - 1e-3..=self.to + 1e-3).contains(&x)
    }
}

/// Kind of a wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PageWireKind {
    /// Touched by strips.
    Contact,
    /// Carries the contact wire.
    Messenger,
    /// About a support, below the messenger wire.
    Stitch,
}

/// A wire at rest.
#[derive(Clone, Debug)]
pub struct PageWire {
    /// Kind of the wire.
    pub kind: PageWireKind,
    /// Short name; stitch wires of one tension length have the same.
    pub name: String,
    /// Tension length, from 1.
    pub tension_length: usize,
    /// Points along the wire, m.
    pub points: Vec<[f64; 3]>,
    /// Height of each point above the chord between the nominal heights of its supports, m.
    pub above_chord: Vec<f64>,
}

/// A dropper at rest.
#[derive(Clone, Debug)]
pub struct PageDropper {
    /// Tension length, from 1.
    pub tension_length: usize,
    /// Span of the tension length, from 1.
    pub span: usize,
    /// Number within the span, from 1.
    pub number: usize,
    /// Distance from the left support, m.
    pub position: f64,
    /// Wire from which the dropper hangs, as in files.
    pub hangs_from: &'static str,
    /// Short names of the wires above and below.
    pub wires: [String; 2],
    /// Upper end, m.
    pub top: [f64; 3],
    /// Lower end, m.
    pub bottom: [f64; 3],
    /// Unstressed length, m.
    pub length: f64,
    /// Tension, N; a slack dropper has none.
    pub force: f64,
}

impl PageDropper {
    /// True for a dropper that carries nothing.
    #[must_use]
    pub fn is_slack(&self) -> bool {
        self.force <= 0.0
    }
}

/// A support of a tension length.
#[derive(Clone, Debug)]
pub struct PageSupport {
    /// Tension length, from 1.
    pub tension_length: usize,
    /// Number within the tension length, from 1.
    pub number: usize,
    /// m.
    pub x: f64,
    /// Height of the contact wire, m.
    pub height: f64,
    /// Height of the messenger wire above it, m; none of a single wire.
    pub encumbrance: Option<f64>,
    /// Lateral position of the contact wire, m.
    pub stagger: f64,
    /// Radius of the track, m, positive with the middle to the left; none where it is straight.
    pub radius: Option<f64>,
    /// Force on the messenger wire, N, upwards.
    pub messenger_reaction: f64,
    /// Force on the contact wire, N, upwards.
    pub arm_force: f64,
    /// Lateral force of the arm on the contact wire, N, to the left; none of a planar line.
    pub arm_lateral: Option<f64>,
    /// Slope of the chord to the next support, –; none at the last one, and where no strip is on the wire.
    pub gradient: Option<f64>,
    /// Change of that slope at this support, –.
    pub change: Option<f64>,
}

/// A point mass on a wire.
#[derive(Clone, Copy, Debug)]
pub struct PageMass {
    /// Place, m.
    pub at: [f64; 3],
    /// kg.
    pub mass: f64,
}

/// Elasticity of a span.
#[derive(Clone, Copy, Debug)]
pub struct PageSpan {
    /// Number, from 1.
    pub number: usize,
    /// Start and end, m.
    pub ends: [f64; 2],
    /// Smallest rise, m/N.
    pub least: f64,
    /// Largest rise, m/N.
    pub most: f64,
    /// Non-uniformity, –.
    pub non_uniformity: f64,
}

/// Tension of a wire, or of all stitch wires of a tension length.
#[derive(Clone, Debug)]
pub struct PageTension {
    /// Name of the wire.
    pub name: String,
    /// Tension of the scene, N.
    pub nominal: f64,
    /// Least axial tension at rest, N.
    pub least: f64,
    /// Largest axial tension at rest, N.
    pub most: f64,
}

impl LinePage {
    /// The page.
    #[must_use]
    pub fn render(&self) -> String {
        let mut page = Page::new(&self.title).with_style(STYLE);
        page.lead(&format!(
            "<p><b>{}</b> · line at rest · {:.0} km/h · {} spans, {:.0} m</p>\n{}",
            escape(&self.scene),
            self.speed_kmh,
            self.masts.len().saturating_sub(1),
            self.masts.last().copied().unwrap_or(0.0) - self.masts.first().copied().unwrap_or(0.0),
            self.part_of_the_line()
        ));
        page.section("Limits", &tables::limits(self));
        page.section("Line", &panels::section(self));
        page.section("Supports", &tables::supports(self));
        page.section("Droppers", &tables::droppers(self));
        page.section("Wires", &tables::tensions(self));
        page.section("Elasticity", &tables::spans(self));
        page.section("Model", &tables::model(self));
        page.section("Notes", &remarks(&self.notes));
        page.finish_with_script(SCRIPT)
    }

    /// Sentence on the part that is shown; nothing for a whole line.
    fn part_of_the_line(&self) -> String {
        let spans = self.masts.len().saturating_sub(1);
        if self.shown.first <= 1 && self.shown.last >= spans {
            return String::new();
        }
        format!(
            "<p class=\"notes\">Spans {} to {} of {spans} are shown, those around the evaluated spans. \
             droppers.csv and supports.csv have all.</p>\n",
            self.shown.first, self.shown.last
        )
    }
}
