//! The record of a run.

use component::exchange::{contact, strip, support};
use serde::{Deserialize, Serialize};

use super::{Animation, ResultsError, head};

/// Everything a run recorded; all series have the length of `time`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Times, s, at a constant output step.
    pub time: Vec<f64>,
    /// One record per pantograph; the first one leads.
    pub pantographs: Vec<StripRecord>,
    /// Supports that bound the evaluated spans.
    pub supports: Vec<SupportRecord>,
    /// Places of supports and droppers, for plots.
    pub line: LineGeometry,
    /// Coarse pictures of line and pantograph.
    pub animation: Animation,
}

/// Contact of one collector strip, or of a head with several: the force is their sum, places and heights are means, the
/// gap is the smallest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StripRecord {
    /// Contact force, N, not negative.
    pub force: Vec<f64>,
    /// Contact point along the track, m.
    pub contact_x: Vec<f64>,
    /// Contact point, lateral, m.
    pub contact_y: Vec<f64>,
    /// Height of the wire at the contact point, m.
    pub wire_z: Vec<f64>,
    /// Height of the strip, m.
    pub strip_z: Vec<f64>,
    /// Vertical velocity of the strip, m/s.
    pub strip_vz: Vec<f64>,
    /// Gap between strip and wire, m, positive when open.
    pub gap: Vec<f64>,
    /// The wind on the body of the strip; nothing where no wind acts on the pantograph.
    pub wind: Option<WindRecord>,
    /// Force of the controlled drive of the pantograph, N; nothing where nothing is controlled.
    pub control: Option<Vec<f64>>,
    /// Contact point along the strip from its middle, m; not in the file, notes say it where it matters.
    pub aside: Vec<f64>,
    /// Strips of a head with several; empty for one.
    pub strips: Vec<StripRecord>,
}

/// The wind on the body that carries a strip.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WindRecord {
    /// Drag, along the air that meets it, N.
    pub drag: Vec<f64>,
    /// Lift, across the air that meets it, N, positive upward.
    pub lift: Vec<f64>,
}

/// Uplift at one support.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SupportRecord {
    /// Number of the support, from 1.
    pub number: usize,
    /// Rise of the contact wire above its height at t = 0, m.
    pub uplift: Vec<f64>,
}

/// Positions along the track, m, rising.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LineGeometry {
    /// Supports, the first one is number 1, m.
    pub support_x: Vec<f64>,
    /// Droppers, m.
    pub dropper_x: Vec<f64>,
    /// First and last support of each tension length, m, where there are several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tension_lengths: Vec<(f64, f64)>,
    /// Droppers at rest; empty where the line is not modelled.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub droppers: Vec<DropperRow>,
}

/// A dropper at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DropperRow {
    /// Tension length, from 1.
    pub tension_length: usize,
    /// Span of it, from 1.
    pub span: usize,
    /// Number within the span, from 1.
    pub number: usize,
    /// Place along the track, m.
    pub x_m: f64,
    /// Unstressed length, m.
    pub length_m: f64,
    /// Tension, N.
    #[serde(rename = "force_N")]
    pub force_n: f64,
}

impl LineGeometry {
    /// Span (from 1) at place `x`, m; `None` beyond the line.
    #[must_use]
    pub fn span_at(&self, x: f64) -> Option<usize> {
        let passed = self.support_x.partition_point(|support| *support <= x);
        let end = *self.support_x.last()?;
        let span = if x == end { passed - 1 } else { passed };
        (1..self.support_x.len()).contains(&span).then_some(span)
    }

    /// Length of the longest span of which places `x` (m) cover more than a hundredth, m; `None` where there is none.
    #[must_use]
    pub fn longest_span(&self, x: &[f64]) -> Option<f64> {
        let (from, to) = (x.iter().copied().reduce(f64::min)?, x.iter().copied().reduce(f64::max)?);
        let spans = self.support_x.windows(2).filter(|ends| {
            let covered = to.min(ends[1]) - from.max(ends[0]);
            covered > 0.01 * (ends[1] - ends[0])
        });
        spans.map(|ends| ends[1] - ends[0]).reduce(f64::max)
    }
}

impl StripRecord {
    /// Series in the order of the time series file.
    pub(super) fn columns(&self) -> [&Vec<f64>; COLUMNS] {
        [
            &self.force,
            &self.contact_x,
            &self.contact_y,
            &self.wire_z,
            &self.strip_z,
            &self.strip_vz,
            &self.gap,
        ]
    }

    /// Series in the order of the time series file, to be changed.
    pub(super) fn columns_mut(&mut self) -> [&mut Vec<f64>; COLUMNS] {
        [
            &mut self.force,
            &mut self.contact_x,
            &mut self.contact_y,
            &mut self.wire_z,
            &mut self.strip_z,
            &mut self.strip_vz,
            &mut self.gap,
        ]
    }

    /// The strips of the head: the record itself where it is of one strip.
    #[must_use]
    pub fn each_strip(&self) -> &[StripRecord] {
        if self.strips.is_empty() {
            std::slice::from_ref(self)
        } else {
            &self.strips
        }
    }

    /// Builds a record from its seven series in the order of the time series file.
    pub(super) fn from_columns(columns: [Vec<f64>; COLUMNS]) -> Self {
        let [force, contact_x, contact_y, wire_z, strip_z, strip_vz, gap] = columns;
        Self {
            force,
            contact_x,
            contact_y,
            wire_z,
            strip_z,
            strip_vz,
            gap,
            wind: None,
            control: None,
            aside: Vec::new(),
            strips: Vec::new(),
        }
    }
}

/// One series of a record, as the time series file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedSeries<'a> {
    /// Name, such as `contact[1].force`.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// One sentence.
    pub description: String,
    /// Values, one for each time.
    pub values: &'a [f64],
}

/// Unit and description of a series by its name.
fn declared(name: &str) -> (&'static str, String) {
    let (member, rest) = name.split_once("].").unwrap_or_default();
    let (_, number) = member.split_once('[').unwrap_or_default();
    let groups = [&contact::SIGNALS[..], &strip::SIGNALS[..], &support::SIGNALS[..]];
    // A head has signals of a contact and of a strip; of names that both have, its are those of the contact.
    let groups = match member.starts_with(strip::GROUP) {
        true => [groups[1], groups[0], groups[2]],
        false => groups,
    };
    let found = groups.into_iter().flatten().find(|signal| signal.name == rest);
    found.map_or_else(Default::default, |signal| {
        let description = signal.description.replace("{}", number);
        (signal.unit().unwrap_or_default(), description)
    })
}

/// Number of series of a pantograph besides the wind and its drive.
pub(super) const COLUMNS: usize = 7;

/// Names of the series of strip `i` (from 1, over all heads) in the order of the time series file.
pub(super) fn strip_names(i: usize) -> [String; COLUMNS] {
    let of_contact = |index: usize| contact::SIGNALS[index].of(contact::GROUP, i);
    let of_strip = |index: usize| strip::SIGNALS[index].of(strip::GROUP, i);
    [
        of_contact(contact::FORCE),
        of_contact(contact::X),
        of_contact(contact::Y),
        of_contact(contact::WIRE_Z),
        of_strip(strip::Z),
        of_strip(strip::VZ),
        of_contact(contact::GAP),
    ]
}

/// Names of the series of the wind on the head of pantograph `i` (from 1), which is that of its one strip.
pub(super) fn wind_names(i: usize) -> [String; 2] {
    [strip::WIND_DRAG, strip::WIND_LIFT].map(|index| strip::SIGNALS[index].of(strip::GROUP, i))
}

/// Name of the series of the drive of pantograph `i` (from 1).
pub(super) fn control_name(i: usize) -> String {
    strip::SIGNALS[strip::CONTROL].of("pantograph", i)
}

/// Name of the series of support `number` (from 1).
pub(super) fn support_name(number: usize) -> String {
    support::SIGNALS[support::UPLIFT].of(support::GROUP, number)
}

impl Record {
    /// All series but the time with their names, in the order of the time series file.
    pub(super) fn columns(&self) -> Vec<(String, &Vec<f64>)> {
        let mut columns = Vec::new();
        let several = self.pantographs.iter().any(|pantograph| !pantograph.strips.is_empty());
        let mut number = 0;
        for (i, pantograph) in self.pantographs.iter().enumerate() {
            if several {
                columns.extend(head::names(i + 1).into_iter().zip(pantograph.columns()));
            }
            for strip in pantograph.each_strip() {
                number += 1;
                columns.extend(strip_names(number).into_iter().zip(strip.columns()));
            }
        }
        for support in &self.supports {
            columns.push((support_name(support.number), &support.uplift));
        }
        for (i, pantograph) in self.pantographs.iter().enumerate() {
            if let Some(wind) = &pantograph.wind {
                let [drag, lift] = wind_names(i + 1);
                columns.extend([(drag, &wind.drag), (lift, &wind.lift)]);
            }
        }
        for (i, pantograph) in self.pantographs.iter().enumerate() {
            columns.extend(pantograph.control.as_ref().map(|force| (control_name(i + 1), force)));
        }
        columns
    }

    /// All series but the time with names and units, in the order of the time series file.
    #[must_use]
    pub fn series(&self) -> Vec<NamedSeries<'_>> {
        let columns = self.columns().into_iter();
        let series = columns.map(|(name, values)| {
            let (unit, description) = declared(&name);
            NamedSeries {
                name,
                unit,
                description,
                values,
            }
        });
        series.collect()
    }

    /// Checks that all series have the length of the time.
    ///
    /// # Errors
    ///
    /// [`ResultsError::Length`] names the first series that does not.
    pub fn check(&self) -> Result<(), ResultsError> {
        let expected = self.time.len();
        for (column, values) in self.columns() {
            if values.len() != expected {
                return Err(ResultsError::Length {
                    column,
                    found: values.len(),
                    expected,
                });
            }
        }
        Ok(())
    }
}
