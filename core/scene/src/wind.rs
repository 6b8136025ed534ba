//! `[wind]`: motion of the air, and what the air acts on.
//!
//! A scene without this table has no air: no force of it is modelled. With it pantographs and wires feel the air
//! relative to themselves, the train's own travel included; `speed = 0` is still air.
mod check;
mod entry;
mod field;
mod table;

pub(crate) use table::rows_of;
pub use table::{AerodynamicMarker, WindTableError};

use crate::choice::choice;

/// `[wind]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Wind {
    /// Speed of the mean wind over the ground, m/s.
    pub speed: f64,
    /// Direction that the mean wind comes from, degrees from the direction of travel (+x): 0 is a head wind, 90 comes
    /// from the left (+y) and blows to the right, ±180 is a tail wind. The velocity over the ground is `−speed (cos
    /// yaw, sin yaw, 0)`; no part of it depends on the speed of the train.
    pub yaw_deg: f64,
    /// `ρ`, kg/m³.
    pub air_density: f64,
    /// A gust on top of the mean wind.
    pub gust: Option<WindGust>,
    /// Seeded turbulence on top of the mean wind.
    pub turbulence: Option<WindTurbulence>,
    /// A CSV file of wind (time, vx, vy, vz and, where there are several places, x), relative to the scene file, that
    /// is added to the mean wind. In a resolved scene its rows stand in [`Wind::record`].
    pub file: Option<String>,
    /// Rows of such a file.
    pub record: Vec<Vec<f64>>,
    /// Action of the air on pantographs; `None`: nothing.
    pub pantograph: Option<WindOnPantograph>,
    /// Action of the air on contact and messenger wire; `None`: nothing.
    pub wires: Option<WindOnWires>,
}

/// `wind.gust`: a velocity that rises and falls as `(1 − cos)/2`, either everywhere during a time or standing over a
/// stretch.
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
    /// Quasi-steady uplift of the strip by the square of the air's speed along the track relative to it, N/(m/s)²: one
    /// for all pantographs or one for each. Empty where there are surfaces.
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
    /// The points that the force is spread over by their areas: rows of 13 numbers, see [`AerodynamicMarker`]. Where
    /// there are none, the body's centre of mass with the axes of the track in the tabulated position and the area 1.
    pub markers: Vec<AerodynamicMarker>,
    /// A CSV file of such rows, relative to the scene file; in a resolved scene they stand in `markers`.
    pub marker_file: Option<String>,
}

/// `wind.wires`: drag across the wires, the droppers and the registration arms.
#[derive(Clone, Debug, PartialEq)]
pub struct WindOnWires {
    /// `C_D` by the diameter, –.
    pub drag_coefficient: f64,
    /// m; none where the wire has its diameter itself.
    pub contact_wire_diameter: Option<f64>,
    /// m; none where the wire has its diameter itself.
    pub messenger_wire_diameter: Option<f64>,
    /// m; none where the wire has its diameter itself or is as thick as the messenger wire.
    pub stitch_wire_diameter: Option<f64>,
    /// m; none: the droppers feel no wind.
    pub dropper_diameter: Option<f64>,
    /// `C_D A` of a registration arm, m².
    pub registration_arm_drag_area: f64,
    /// Drag and lift of the contact wire by angle of attack, in place of the drag coefficient.
    pub contact_wire_polar: Option<WirePolar>,
    /// The same of the messenger wire.
    pub messenger_wire_polar: Option<WirePolar>,
}

/// `wind.wires.contact_wire_polar` or `messenger_wire_polar`: coefficients of a worn or iced wire, by its
/// diameter with the ice.
#[derive(Clone, Debug, PartialEq)]
pub struct WirePolar {
    /// Angles of attack, degrees, ascending: 0 from the side, positive from below.
    pub angles_deg: Vec<f64>,
    /// `C_D` at each angle.
    pub drag: Vec<f64>,
    /// `C_L` at each angle, positive upwards.
    pub lift: Vec<f64>,
}
