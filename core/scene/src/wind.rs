//! `[wind]`: how the air moves, and what it acts on.
//!
//! A scene without this table has no air: no force of it is modelled. With it pantographs and wires feel the air relative to
//! themselves, the train's own travel included; `speed = 0` is still air.
mod field;
mod table;

pub use table::{AerodynamicMarker, WindTableError, rows_of};

use crate::check::{Found, refuse};
use crate::choice::choice;
use crate::error::What;
use crate::keys::{Entry, Keys, Length, Number};
use crate::write::shown_number;
use crate::{Line, PantographModel, Reduction, Scene};

/// `[wind]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Wind {
    /// Speed of the mean wind over the ground, m/s.
    pub speed: f64,
    /// Where the mean wind comes from, degrees from the direction of travel (+x): 0 is a head wind, 90 comes from the left (+y) and
    /// blows to the right, ±180 is a tail wind. The velocity over the ground is `−speed (cos yaw, sin yaw, 0)`; no part of it
    /// depends on the speed of the train.
    pub yaw_deg: f64,
    /// `ρ`, kg/m³.
    pub air_density: f64,
    /// A gust on top of the mean wind.
    pub gust: Option<WindGust>,
    /// Seeded turbulence on top of the mean wind.
    pub turbulence: Option<WindTurbulence>,
    /// A CSV file of wind (time, vx, vy, vz and, where there are several places, x), relative to the scene file, that is added to
    /// the mean wind. In a resolved scene its rows stand in [`Wind::record`].
    pub file: Option<String>,
    /// Rows of such a file.
    pub record: Vec<Vec<f64>>,
    /// What the air does to pantographs; `None`: nothing.
    pub pantograph: Option<WindOnPantograph>,
    /// What the air does to contact and messenger wire; `None`: nothing.
    pub wires: Option<WindOnWires>,
}

/// `wind.gust`: a velocity that rises and falls as `(1 − cos)/2`, either everywhere during a time or standing over a stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindGust {
    /// Velocity that it adds at its peak, m/s, 3 entries (x, y, z).
    pub velocity: [f64; 3],
    /// When or where.
    pub extent: GustExtent,
}

/// `start` and `duration`, or `start_x` and `length`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GustExtent {
    /// Everywhere at once.
    Time {
        /// s.
        start: f64,
        /// s.
        duration: f64,
    },
    /// Standing over the track.
    Place {
        /// m.
        start_x: f64,
        /// m.
        length: f64,
    },
}

choice! {
    /// `wind.turbulence.spectrum`, see [`dynamics::TurbulenceSpectrum`].
    pub enum WindSpectrum {
        /// Von Kármán.
        VonKarman = "von_karman",
        /// Kaimal.
        Kaimal = "kaimal",
    }
    unavailable: []
}

/// `wind.turbulence`, see [`dynamics::Turbulence`]; lists have 3 entries: along the mean wind, across it, vertical.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindTurbulence {
    /// Shape of the spectra.
    pub spectrum: WindSpectrum,
    /// Standard deviation by the mean speed, –.
    pub intensities: [f64; 3],
    /// m.
    pub length_scales: [f64; 3],
    /// `C` of the coherence `exp(−C f |Δx| / speed)`, –.
    pub coherence_decays: [f64; 3],
    /// Which of all fields.
    pub seed: usize,
    /// Step of the field in time, s; 0.05 s by default: frequencies up to 10 Hz.
    pub time_step: f64,
    /// Steps until the field repeats itself, a power of two; 1024 by default.
    pub steps: usize,
    /// Distance of the places between which the field is interpolated, m; 2 m by default.
    pub spacing: f64,
}

/// `wind.pantograph`.
#[derive(Clone, Debug, PartialEq)]
pub struct WindOnPantograph {
    /// Quasi-steady uplift of the strip by the square of the air's speed along the track relative to it, N/(m/s)²: one for all
    /// pantographs or one for each. Empty where there are surfaces.
    pub uplift: Vec<f64>,
    /// `[[wind.pantograph.surfaces]]`: bodies of a linkage that the air acts on.
    pub surfaces: Vec<WindSurface>,
}

/// `[[wind.pantograph.surfaces]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct WindSurface {
    /// Name of the body.
    pub body: String,
    /// Angles of attack that the coefficients belong to, degrees, ascending; empty where they hold at all angles.
    pub angles_deg: Vec<f64>,
    /// `C_D` by the area of the markers, or `C_D A` in m² where their areas are 1; one per angle.
    pub drag: Vec<f64>,
    /// `C_L` likewise.
    pub lift: Vec<f64>,
    /// The points that the force is spread over by their areas: rows of 13 numbers, see [`AerodynamicMarker`]. Where there are
    /// none, the body's centre of mass with the axes of the track in the tabulated position and the area 1.
    pub markers: Vec<AerodynamicMarker>,
    /// A CSV file of such rows, relative to the scene file; in a resolved scene they stand in `markers`.
    pub marker_file: Option<String>,
}

/// `wind.wires`: drag across the wires. Droppers and registration arms feel no wind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindOnWires {
    /// `C_D` by the diameter, –.
    pub drag_coefficient: f64,
    /// m.
    pub contact_wire_diameter: f64,
    /// m.
    pub messenger_wire_diameter: f64,
}

/// Faster than any wind that was measured at the ground, m/s.
const FASTEST: f64 = 120.0;

/// Most numbers that a field of turbulence is tabulated in, steps times places.
const LARGEST_TABLE: usize = 4_000_000;

impl Entry for Wind {
    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let speed = keys.number("speed", was.map(|wind| wind.speed), Number::not_negative("m/s"));
        if speed > FASTEST {
            keys.refuse("speed", format!("must be a speed in m/s, at most {FASTEST} m/s"));
        }
        Self {
            speed,
            yaw_deg: keys.number("yaw_deg", was.map(|wind| wind.yaw_deg), Number::between(-180.0, 180.0)),
            air_density: keys.number(
                "air_density",
                was.map(|wind| wind.air_density),
                Number::positive("kg/m³"),
            ),
            gust: keys.optional_inline_table("gust", was.map(|wind| wind.gust.as_ref())),
            turbulence: keys.optional_inline_table("turbulence", was.map(|wind| wind.turbulence.as_ref())),
            file: keys.optional_text("file", was.map(|wind| wind.file.as_deref()), "the path of a CSV file"),
            record: keys.optional_rows("record", was.map(|wind| wind.record.as_slice())),
            pantograph: keys.optional_table("pantograph", was.map(|wind| wind.pantograph.as_ref())),
            wires: keys.optional_inline_table("wires", was.map(|wind| wind.wires.as_ref())),
        }
    }
}

impl Entry for WindGust {
    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let velocity = keys.vector("velocity", was.map(|gust| gust.velocity), Number::any("m/s"));
        let extent = was.map(|gust| gust.extent);
        let (time, place) = match extent {
            Some(GustExtent::Time { start, duration }) => (Some((start, duration)), None),
            Some(GustExtent::Place { start_x, length }) => (None, Some((start_x, length))),
            None => (None, None),
        };
        let extent = if keys.has("start_x", place.is_some()) {
            if keys.has("start", false) {
                let because = "start_x is given, where the gust stands".to_owned();
                keys.report("start", What::LeaveOut { because });
            }
            GustExtent::Place {
                start_x: keys.number("start_x", place.map(|place| place.0), Number::any("m")),
                length: keys.number("length", place.map(|place| place.1), Number::positive("m")),
            }
        } else {
            GustExtent::Time {
                start: keys.number("start", time.map(|time| time.0), Number::any("s")),
                duration: keys.number("duration", time.map(|time| time.1), Number::positive("s")),
            }
        };
        Self { velocity, extent }
    }
}

impl Entry for WindTurbulence {
    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let steps = keys.count("steps", was.map(|wind| wind.steps), 2..=1 << 20, Some(1024));
        if !steps.is_power_of_two() {
            keys.refuse(
                "steps",
                format!("must be a power of two, such as {}", steps.next_power_of_two()),
            );
        }
        Self {
            spectrum: keys.word("spectrum", was.map(|wind| wind.spectrum), None),
            intensities: keys.vector(
                "intensities",
                was.map(|wind| wind.intensities),
                Number::not_negative(""),
            ),
            length_scales: keys.vector(
                "length_scales",
                was.map(|wind| wind.length_scales),
                Number::positive("m"),
            ),
            coherence_decays: keys.vector(
                "coherence_decays",
                was.map(|wind| wind.coherence_decays),
                Number::not_negative(""),
            ),
            seed: keys.count("seed", was.map(|wind| wind.seed), 0..=i64::MAX as usize, None),
            time_step: keys.number(
                "time_step",
                was.map(|wind| wind.time_step),
                Number::positive("s").default(0.05),
            ),
            steps,
            spacing: keys.number(
                "spacing",
                was.map(|wind| wind.spacing),
                Number::positive("m").default(2.0),
            ),
        }
    }
}

impl Entry for WindOnPantograph {
    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let uplift = was.map(|wind| wind.uplift.as_slice());
        let surfaces = was.map(|wind| wind.surfaces.as_slice());
        let there = |values: Option<bool>| values == Some(false);
        let with_uplift = keys.has("uplift", there(uplift.map(<[f64]>::is_empty)));
        let with_surfaces = keys.has("surfaces", there(surfaces.map(<[WindSurface]>::is_empty)));
        if with_uplift && with_surfaces {
            let because = "surfaces are given, whose lift it would count again".to_owned();
            keys.report("uplift", What::LeaveOut { because });
        } else if !with_uplift && !with_surfaces && was.is_none() {
            let expected =
                "a number in N/(m/s)², or else surfaces: [[wind.pantograph.surfaces]], bodies that the air acts on";
            keys.report(
                "uplift",
                What::Missing {
                    expected: expected.to_owned(),
                },
            );
        }
        Self {
            uplift: if with_uplift {
                keys.one_or_more("uplift", uplift, Number::not_negative("N/(m/s)²"))
            } else {
                Vec::new()
            },
            surfaces: if with_surfaces {
                keys.tables("surfaces", surfaces)
            } else {
                Vec::new()
            },
        }
    }
}

impl Entry for WindSurface {
    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let body = keys.text("body", was.map(|surface| surface.body.as_str()), "the name of a body");
        let angles = was.map(|surface| surface.angles_deg.as_slice());
        let angles_deg = if keys.has("angles_deg", angles.is_some_and(|angles| !angles.is_empty())) {
            keys.numbers("angles_deg", angles, Number::between(-180.0, 180.0), Length::NotEmpty)
        } else {
            Vec::new()
        };
        let drag = keys.one_or_more(
            "drag",
            was.map(|surface| surface.drag.as_slice()),
            Number::not_negative(""),
        );
        let lift = keys.one_or_more("lift", was.map(|surface| surface.lift.as_slice()), Number::any(""));
        let rows = was.map(|surface| {
            surface
                .markers
                .iter()
                .map(|marker| marker.row().to_vec())
                .collect::<Vec<_>>()
        });
        let rows = keys.optional_rows("markers", rows.as_deref());
        let markers = AerodynamicMarker::from_rows(&rows).unwrap_or_else(|error| {
            keys.refuse("markers", error.to_string());
            Vec::new()
        });
        let marker_file = keys.optional_text(
            "marker_file",
            was.map(|surface| surface.marker_file.as_deref()),
            "the path of a CSV file",
        );
        if marker_file.is_some() && !markers.is_empty() {
            let because = "markers are given".to_owned();
            keys.report("marker_file", What::LeaveOut { because });
        }
        if !angles_deg.windows(2).all(|pair| pair[0] < pair[1]) {
            keys.refuse("angles_deg", "must ascend");
        }
        let expected = angles_deg.len().max(1);
        for (name, values) in [("drag", &drag), ("lift", &lift)] {
            if values.len() != expected && !values.is_empty() {
                let of_what = if angles_deg.is_empty() {
                    "one number, or angles_deg be given".to_owned()
                } else {
                    format!("{expected} numbers, one per angle of angles_deg")
                };
                keys.refuse(name, format!("has {} entries, must be {of_what}", values.len()));
            }
        }
        Self {
            body,
            angles_deg,
            drag,
            lift,
            markers,
            marker_file,
        }
    }
}

impl Entry for WindOnWires {
    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            drag_coefficient: keys.number(
                "drag_coefficient",
                was.map(|wires| wires.drag_coefficient),
                Number::not_negative(""),
            ),
            contact_wire_diameter: keys.number(
                "contact_wire_diameter",
                was.map(|wires| wires.contact_wire_diameter),
                Number::positive("m"),
            ),
            messenger_wire_diameter: keys.number(
                "messenger_wire_diameter",
                was.map(|wires| wires.messenger_wire_diameter),
                Number::positive("m"),
            ),
        }
    }
}

impl Scene {
    /// What of the wind pushes the wires sideways; `None` where nothing does.
    pub(crate) fn wind_pushes_sideways(&self) -> Option<String> {
        let wind = self.wind.as_ref()?;
        wind.wires?;
        let mean = wind.mean_velocity();
        // A wind of ±180° misses the track's line by rounding.
        if mean[1].abs() > 1e-12 * wind.speed {
            return Some(format!("wind.yaw_deg = {} pushes the wires sideways", wind.yaw_deg));
        }
        let gust = wind.gust.is_some_and(|gust| gust.velocity[1] != 0.0);
        let parts = [
            (gust, "gust"),
            (wind.turbulence.is_some(), "turbulence"),
            (wind.file.is_some(), "file"),
            (!wind.record.is_empty(), "record"),
        ];
        let part = parts.iter().find(|(there, _)| *there);
        part.map(|(_, part)| format!("wind.{part} pushes the wires sideways"))
    }

    /// What a wind asks of the rest of the scene.
    pub(crate) fn check_wind(&self, found: &mut Found) {
        let Some(wind) = &self.wind else { return };
        if let Some(turbulence) = &wind.turbulence {
            self.check_turbulence(wind, turbulence, found);
        }
        if let (Some(file), false) = (&wind.file, wind.record.is_empty()) {
            let expected = "must be left out: wind.record is given";
            refuse(found, "wind.file", format!("{file:?}"), expected);
        }
        if !wind.record.is_empty()
            && let Err(error) = dynamics::WindRecord::from_rows(&wind.record)
        {
            let rows = format!("[{} rows]", wind.record.len());
            refuse(found, "wind.record", rows, error.to_string());
        }
        if wind.wires.is_some() && matches!(self.catenary, Line::ThirdParty(_)) {
            let expected = "must be left out: the line is an FMU of somebody else";
            refuse(found, "wind.wires", "{ … }", expected);
        }
        if let Some(on_pantograph) = &wind.pantograph {
            self.check_wind_on_pantograph(on_pantograph, found);
        }
    }

    fn check_turbulence(&self, wind: &Wind, turbulence: &WindTurbulence, found: &mut Found) {
        if wind.speed <= 0.0 {
            let expected = "must be positive with wind.turbulence, which is measured by it";
            refuse(found, "wind.speed", shown_number(wind.speed, "m/s"), expected);
        }
        let period = turbulence.steps as f64 * turbulence.time_step;
        if period < self.run.duration {
            let steps = (self.run.duration / turbulence.time_step).ceil().min(1e9) as usize;
            refuse(
                found,
                "wind.turbulence.steps",
                turbulence.steps.to_string(),
                format!(
                    "must be at least {}: the field would repeat itself after {period} s, within run.duration = {} s",
                    steps.next_power_of_two(),
                    self.run.duration
                ),
            );
        }
        let places = self.wind_stations(turbulence);
        if turbulence.steps.saturating_mul(places) > LARGEST_TABLE {
            let expected = format!(
                "must be longer: wind.turbulence.steps = {} times {places} places along the line are more than {LARGEST_TABLE}",
                turbulence.steps
            );
            refuse(
                found,
                "wind.turbulence.spacing",
                shown_number(turbulence.spacing, "m"),
                expected,
            );
        }
    }

    fn check_wind_on_pantograph(&self, wind: &WindOnPantograph, found: &mut Found) {
        let count = self.pantographs.len();
        if !wind.uplift.is_empty() && wind.uplift.len() != 1 && wind.uplift.len() != count {
            let expected = format!("must be one number, or {count} of them, one per pantograph");
            refuse(
                found,
                "wind.pantograph.uplift",
                format!("{:?} N/(m/s)²", wind.uplift),
                expected,
            );
        }
        let mut modelled = false;
        for (index, pantograph) in self.pantographs.iter().enumerate() {
            match &pantograph.model {
                PantographModel::ThirdParty(_) => {}
                PantographModel::Lumped(_) => {
                    modelled = true;
                    if !wind.surfaces.is_empty() {
                        let expected = format!(
                            "must be left out, and uplift given: pantograph[{}] is lumped and has no bodies",
                            index + 1
                        );
                        refuse(found, "wind.pantograph.surfaces", "[…]", expected);
                    }
                }
                PantographModel::Linkage(linkage) => {
                    modelled = true;
                    for (i, surface) in wind.surfaces.iter().enumerate() {
                        if linkage.body(&surface.body).is_none() {
                            let names: Vec<String> =
                                linkage.bodies.iter().map(|body| format!("{:?}", body.name)).collect();
                            let key = format!("wind.pantograph.surfaces[{}].body", i + 1);
                            let expected = format!("no such body: must be one of {}", names.join(", "));
                            refuse(found, key, format!("{:?}", surface.body), expected);
                        }
                    }
                }
            }
        }
        if !modelled {
            let expected = "must be left out: every pantograph is an FMU of somebody else";
            refuse(found, "wind.pantograph", "{ … }", expected);
        }
    }

    /// Why a reduction cannot be had with the wind on the wires.
    pub(crate) fn wind_forbids(&self, reduction: Reduction) -> Option<String> {
        self.wind.as_ref()?.wires?;
        match reduction {
            Reduction::Window => Some(
                "wind.wires acts on every span, and those beyond the window are known without wind only".to_owned(),
            ),
            Reduction::Flat => Some("wind.wires acts on wires as they hang, which \"flat\" leaves out".to_owned()),
            _ => None,
        }
    }
}
