//! The scene: one self-contained TOML file that says everything a run needs, typed and checked.
//!
//! [`Scene::from_toml`] turns the text of a file, and the `--set key.path=value` overrides given on the
//! command line, into a [`Scene`] whose every value is present, finite and physically possible, or into a
//! [`SceneError`] that lists every problem found with its file, line, key, value, unit and remedy.
//! [`Scene::to_toml`] writes the resolved scene with every default written out; reading that text again
//! gives an equal scene, every number bit for bit.
//!
//! Each key is declared once: the function that reads a table also writes it (`keys::Keys`).
//! Everything inside is SI: m, kg, s, N, rad. A key that is not carries its unit in its name
//! (`run.speed_kmh`) and is converted in that one function. x runs along the track from the first
//! support, y to the left, z up from the top of rail. Spans are numbered from 1 in the file.
//!
//! ```
//! let text = include_str!("../../../scenes/en50318-250.toml");
//! let scene = scene::Scene::from_toml(text, "en50318-250.toml", &["run.speed_kmh=200".into()])?;
//! assert_eq!(scene.run.speed, 200.0 / 3.6);
//! assert_eq!(scene::Scene::from_toml(&scene.to_toml(), "again", &[])?, scene);
//!
//! let error = scene::Scene::from_toml(text, "x.toml", &["run.speed_kmh=-250".into()]).unwrap_err();
//! assert_eq!(
//!     error.to_string(),
//!     "x.toml: --set run.speed_kmh=-250: run.speed_kmh = -250 km/h: must be positive and finite"
//! );
//! # Ok::<(), scene::SceneError>(())
//! ```
//!
//! # Sources
//!
//! - `Thesis`: S. Kulkarni, *ANCF Analysis of Multibody Pantograph/Catenary Systems*, MSc thesis,
//!   University of Illinois at Chicago, 2016.
#![forbid(unsafe_code)]

mod accuracy;
mod assessment;
mod catenary;
mod check;
mod check_line;
mod check_linkage;
mod check_overlap;
mod check_vehicle;
mod choice;
mod contact;
mod control;
mod controller;
mod coupling;
mod csv;
mod curve;
mod division;
mod error;
mod expand;
mod files;
mod head;
mod horns;
mod ice;
mod keys;
mod line_changes;
mod linkage;
mod measurement;
mod mesh;
mod model;
mod one_motion;
mod overrides;
mod pantograph;
mod plausible;
mod ranges;
mod reference;
mod renames;
mod run;
mod scene;
mod section;
mod solver;
mod stitch_wires;
mod strips;
mod supplied;
mod table_file;
mod tension_length;
mod tensioning;
mod track;
mod tree;
mod vehicle;
mod wear;
mod wind;
mod write;

pub use accuracy::{Accuracy, Open};
pub use assessment::{Assessment, EDITIONS, LimitBound, LimitRow, LimitedQuantity, SystemGroup};
pub use catenary::{Beam, Catenary, Damping, Droppers, RegistrationArms, Statics, Supports, Wire, WireEnds, WireKind};
pub use check::Found;
pub use contact::{Contact, ContactLaw};
pub use control::{Actuator, Control, ControlLaw, Sensors};
pub use controller::ControllerFmu;
pub use coupling::{Algorithm, Coupling, Force, Order, Parallel, StepControl};
pub use curve::{Curve, Direction, millimetres_up};
pub use division::Division;
pub use error::{Place, Problem, SceneError, What};
pub use files::Files;
pub use head::{HeadPitch, HeadStrip, StripSpring};
pub use horns::Horns;
pub use ice::Ice;
pub use keys::nearest;
pub use line_changes::{Change, DropperChange, MassOn, PointMass, Surface};
pub use linkage::{Body, CollectorSuspension, Joint, JointKind, Linkage, LinkageStrip, Uplift};
pub use measurement::Measurement;
pub use mesh::{AxialStrain, Correction, Element, Mesh, MeshChoice};
pub use model::{Model, Reduction};
pub use pantograph::{Lumped, Pantograph, PantographModel, Start, Strip};
pub use ranges::{Mark, Range, Shape};
pub use reference::{KeyText, keys as described_keys, reference};
pub use run::{Electrification, Evaluate, ForceFilter, Initialise, Run, kmh};
pub use scene::{Line, Scene, SceneFile};
pub use section::Section;
pub use solver::{Formulation, Jacobian, Solver};
pub use stitch_wires::StitchWires;
pub use supplied::{CONTROLLER, Connection, Offset, ParameterValue, Supplied};
pub use tension_length::{MAX_SPANS, TensionLength};
pub use tensioning::Tensioning;
pub use track::{Irregularities, Points, RailSection, Spectrum, Track};
pub use tree::{Step as KeyStep, steps as key_steps, without_entries};
pub use vehicle::{
    Axis, BearingEntry, BushingEntry, Creep, GivenMotion, Pivot, Stop, Train, Vehicle, VehicleBody, WheelContact,
    Wheels,
};
pub use wear::{StripWear, Wear, WearApplied, WearLaw, WireWear};
pub use wind::{
    AerodynamicMarker, GustExtent, Wind, WindGust, WindOnPantograph, WindOnWires, WindSpectrum, WindSurface,
    WindTableError, WindTurbulence, WirePolar,
};
pub use write::shown_number;
