//! Run of a study: everything that a sweep may change.

use scene::{Catenary, Division, Scene};

use super::vehicle::{VehicleVariant, VehicleVariantName, VehicleVariants, own_name, vehicle_variants};
use crate::engine::table::{AUTO, Keys};
use crate::engine::{Variant, words};
use simulation::{Mode, Prepared};
use system::one_system::OneSystem;

/// Corrections of the mesh that a scene may name, best set first; the first one that the scene takes is called
/// corrected here. Those without the contact's compliance are for strips that are held on the wire or as fast as its
/// waves.
const CORRECTION_SETS: [&[&str]; 7] = [
    &["contact_compliance", "bending_layers", "mass_correction"],
    &["contact_compliance", "mass_correction"],
    &["contact_compliance", "bending_layers"],
    &["contact_compliance"],
    &["bending_layers", "mass_correction"],
    &["mass_correction"],
    &["bending_layers"],
];

/// Sets of corrections that go together, best first.
pub(super) fn correction_sets() -> impl Iterator<Item = Vec<String>> {
    let names = |corrections: &&[&str]| corrections.iter().map(|correction| (*correction).to_owned()).collect();
    CORRECTION_SETS.iter().map(names)
}

/// Reductions that change the model: they are judged, and no reference has them.
const APPROXIMATE: [&str; 4] = ["linearised", "flat", "window", "modal"];

words! {
    /// The model that a run is an approximation of, which says what its error is taken against.
    pub enum Family {
        /// The line as it is.
        Nonlinear = "nonlinear",
        /// Linearised about its static state.
        Linearised = "linearised",
        /// Straight wires with small slopes.
        Flat = "flat",
    }
}

impl Family {
    /// Value for a set of reductions, joined by `+`.
    pub(super) fn of(reductions: &str) -> Self {
        let has = |name: &str| reductions.split('+').any(|reduction| reduction == name);
        if has(Self::Flat.name()) {
            Self::Flat
        } else if has(Self::Linearised.name()) || has("modal") {
            Self::Linearised
        } else {
            Self::Nonlinear
        }
    }
}

/// Rows that compete with each other: the same model, the whole line or a window of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Class {
    /// Model.
    pub family: Family,
    /// `true` where only the spans around the pantographs are there.
    pub window: bool,
}

impl Class {
    /// Value for a set of reductions, joined by `+`.
    pub(super) fn of(reductions: &str) -> Self {
        Self {
            family: Family::of(reductions),
            window: reductions.split('+').any(|reduction| reduction == "window"),
        }
    }

    /// Its name for reading.
    pub(super) fn name(self) -> String {
        let window = if self.window { ", window" } else { ", whole line" };
        format!("{}{window}", self.family.name())
    }
}

/// Exchange of values between the sides of a coupled run.
#[derive(Clone, Debug, PartialEq)]
pub enum Exchange {
    /// One system: nothing is exchanged.
    None,
    /// As the scene says.
    Scene,
    /// Coupled in process.
    Of {
        /// Algorithm.
        algorithm: String,
        /// Degree of the extrapolation; the algorithm's own where nothing is said.
        extrapolation: Option<usize>,
        /// Communication step, s.
        macro_step: f64,
    },
}

/// Elements and what helps them.
#[derive(Clone, Debug, PartialEq)]
pub enum Mesh {
    /// As the scene says; also where the line is supplied.
    Scene,
    /// Given.
    Of {
        /// Elements between neighbouring droppers or supports.
        division: Division,
        /// Corrections by name; none is the plain mesh.
        corrections: Vec<String>,
    },
}

/// A run of a study: everything that a sweep may change.
#[derive(Clone, Debug, PartialEq)]
pub struct RunSpec {
    /// Mesh.
    pub mesh: Mesh,
    /// Step of the time integration, s.
    pub micro_step: f64,
    /// Spectral radius at infinite frequency, –.
    pub rho_inf: f64,
    /// Residual that ends Newton's method, N.
    pub newton_tolerance: f64,
    /// Reductions by name.
    pub reductions: Vec<String>,
    /// Coupling.
    pub exchange: Exchange,
    /// Spans of a line that is longer or shorter than the scene's.
    pub spans: Option<usize>,
    /// A vehicle or a track other than the scene's.
    pub vehicle_variant: Option<VehicleVariant>,
}

/// Simulated time of runs on lines of other lengths, s.
pub const GROWTH_DURATION: f64 = 1.0;

/// Scene of a study, and the values that it allows.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Name of the scene.
    pub name: String,
    /// The scene as read, shortened to what is evaluated.
    pub scene: Scene,
    /// The scene as text.
    pub text: String,
    /// `true` where there is a mesh to be refined: the line is modelled here.
    pub meshed: bool,
    /// `true` where line and pantographs can be one system.
    pub one_system: bool,
    /// Corrections that the scene takes, all together; `None` where it knows no such key.
    pub corrections: Option<Vec<String>>,
    /// Reductions that the scene has and that belong to every run: those that do not change the model.
    pub reductions: Vec<String>,
    /// The scene's own coupling.
    pub keys: Keys,
    /// Elements per dropper interval that resolve the waves ahead of the pantograph.
    pub elements: usize,
    /// Intervals between droppers and supports in a span.
    pub intervals: usize,
    /// Step that resolves the low-pass filter's band, s.
    pub micro_step: f64,
    /// Other vehicles below the pantograph.
    pub vehicles: VehicleVariants,
}

impl Subject {
    /// Subject of a scene which `master check` accepts, as read with these overrides and as prepared; with other
    /// vehicles that the pantograph may stand on, which takes runs of the vehicle, where `vehicles` is true.
    pub(super) fn of(scene: Scene, prepared: &Prepared, overrides: &[String], vehicles: bool) -> Self {
        let text = scene.to_toml();
        let line = scene.modelled_line().map(|(line, _)| line);
        let reductions = scene.model.reductions.iter().map(|reduction| reduction.name());
        let exact = reductions.filter(|name| !APPROXIMATE.contains(name));
        let mut subject = Self {
            name: prepared.name.clone(),
            meshed: line.is_some(),
            one_system: OneSystem::can(&scene),
            corrections: None,
            reductions: exact.map(str::to_owned).collect(),
            keys: Keys::of(&scene, overrides),
            elements: catenary::mesh::resolving_elements(&scene),
            intervals: line.map_or(1, Catenary::intervals_per_span),
            micro_step: 0.02 / scene.run.low_pass_hz,
            vehicles: VehicleVariants::default(),
            scene,
            text,
        };
        if vehicles {
            subject.vehicles = vehicle_variants(&subject.scene, subject.micro_step);
        }
        subject.corrections = subject.accepted_corrections();
        subject
    }

    /// Text of the scene that the keys of a run change.
    pub(super) fn text_of<'a>(&'a self, spec: &'a RunSpec) -> &'a str {
        let other = spec.vehicle_variant.as_ref();
        other.map_or(&self.text, |variant| &variant.text)
    }

    /// Vehicle below the pantograph of a run.
    pub(super) fn vehicle_of(&self, spec: &RunSpec) -> VehicleVariantName {
        let other = spec.vehicle_variant.as_ref().map(|variant| variant.name);
        other.unwrap_or_else(|| own_name(&self.scene))
    }

    fn accepted_corrections(&self) -> Option<Vec<String>> {
        if !self.meshed {
            return None;
        }
        // Beside the mesh and the step of the base case, which the scene's own may not go with.
        let mesh = division_key(Division::PerInterval(self.elements));
        let micro_step = format!("solver.micro_step={:?}", self.micro_step);
        let goes =
            |corrections: &Vec<String>| self.takes(&[mesh.clone(), micro_step.clone(), corrections_key(corrections)]);
        correction_sets().chain([Vec::new()]).find(goes)
    }

    /// Corrections that the scene takes, all together; none where it takes none.
    pub(super) fn best_corrections(&self) -> &[String] {
        self.corrections.as_deref().unwrap_or_default()
    }

    /// `true` where the scene can be read with these keys too.
    pub(super) fn takes(&self, overrides: &[String]) -> bool {
        system::load(&self.text, &self.name, overrides).is_ok()
    }

    /// The scene's reductions and one more.
    pub(super) fn with(&self, names: &[&str]) -> Vec<String> {
        let mut all = self.reductions.clone();
        for name in names {
            if !all.iter().any(|had| had == name) {
                all.push((*name).to_owned());
            }
        }
        all
    }

    /// Reductions that change nothing at all.
    pub(super) fn exact(&self) -> Vec<String> {
        let planar = self.meshed && self.scene.leaves_its_plane().is_none();
        if planar { vec!["planar".to_owned()] } else { Vec::new() }
    }

    /// The mesh with all corrections that the scene takes.
    pub(super) fn corrected(&self, elements: usize) -> Mesh {
        self.mesh(elements, self.best_corrections().to_vec())
    }

    /// A mesh with as many elements in each dropper interval, and some corrections.
    pub(super) fn mesh(&self, elements: usize, corrections: Vec<String>) -> Mesh {
        if self.meshed {
            let division = Division::PerInterval(elements);
            Mesh::Of { division, corrections }
        } else {
            Mesh::Scene
        }
    }

    /// A mesh with the fewest elements that are as short as those of so many in the longest dropper interval, and some
    /// corrections.
    pub(super) fn even_mesh(&self, elements: usize, corrections: Vec<String>) -> Mesh {
        self.scene.modelled_line().map_or(Mesh::Scene, |(line, _)| Mesh::Of {
            division: catenary::mesh::evenly_divided(line, elements),
            corrections,
        })
    }

    /// Coupling of runs that are one system where that can be.
    pub(super) fn plain_exchange(&self, micro_step: f64) -> Exchange {
        if self.one_system {
            return Exchange::None;
        }
        Exchange::Of {
            algorithm: AUTO.to_owned(),
            extrapolation: None,
            macro_step: micro_step,
        }
    }

    /// Variant of the scene for a run.
    pub(super) fn variant(&self, spec: &RunSpec) -> Variant {
        let mut keys = Vec::new();
        if let (Mesh::Of { division, corrections }, true) = (&spec.mesh, self.meshed) {
            keys.push(division_key(*division));
            if self.corrections.is_some() || !corrections.is_empty() {
                keys.push(corrections_key(corrections));
            }
        }
        if self.meshed {
            keys.push(reduce_key(&spec.reductions));
        }
        let algorithm = match &spec.exchange {
            Exchange::None => {
                keys.extend(self.keys.overrides("", spec.micro_step, spec.micro_step));
                String::new()
            }
            Exchange::Scene => {
                keys.push(format!("solver.micro_step={:?}", spec.micro_step));
                self.keys.named.clone()
            }
            Exchange::Of {
                algorithm,
                extrapolation,
                macro_step,
            } => {
                keys.extend(self.keys.overrides(algorithm, *macro_step, spec.micro_step));
                if let Some(degree) = extrapolation {
                    keys.push(format!("coupling.extrapolation={degree}"));
                }
                algorithm.clone()
            }
        };
        keys.push(format!("solver.rho_inf={:?}", spec.rho_inf));
        keys.push(format!("solver.newton_tolerance={:?}", spec.newton_tolerance));
        if let Some(spans) = spec.spans {
            keys.push(format!("catenary.spans={spans}"));
            keys.push(format!("run.duration={GROWTH_DURATION:?}"));
            let from = 0.5 * GROWTH_DURATION;
            keys.push(format!("run.evaluate={{ time = [{from:?}, {GROWTH_DURATION:?}] }}"));
        }
        Variant {
            mode: match spec.exchange {
                Exchange::None => Mode::Monolithic,
                _ => Mode::Inprocess,
            },
            algorithm,
            overrides: keys,
        }
    }

    /// Work of a run: coordinates times micro steps, roughly; repeated steps and constant matrices taken into profile.
    pub(super) fn work(&self, spec: &RunSpec) -> f64 {
        let has = |name: &str| spec.reductions.iter().any(|reduction| reduction == name);
        let line = self.scene.modelled_line().map(|(line, _)| line);
        let division = |line: &Catenary| match spec.mesh {
            Mesh::Of { division, .. } => division,
            Mesh::Scene => line.mesh.division,
        };
        let elements = line.map_or(1, |line| line.elements_per_span(division(line)));
        let spans = spec.spans.or(line.map(scene::Catenary::spans)).unwrap_or(1);
        /// Spans of a window, roughly.
        const WINDOW: usize = 10;
        let spans = if has("window") { spans.min(WINDOW) } else { spans };
        let per_node = if has("planar") { 4 } else { 6 };
        let coordinates = (2 * per_node * elements * spans) as f64;
        let duration = spec.spans.map_or(self.scene.run.duration, |_| GROWTH_DURATION);
        let linear = if has("linearised") || has("flat") { 0.3 } else { 1.0 };
        let repeated = match &spec.exchange {
            // Repeated steps cost about three passes.
            Exchange::Of { algorithm, .. } if algorithm == "iterated" => 3.0,
            _ => 1.0,
        };
        linear * repeated * coordinates * duration / spec.micro_step
    }
}

fn division_key(division: Division) -> String {
    match division {
        Division::PerInterval(count) => format!("catenary.mesh.elements_per_interval={count}"),
        Division::UpTo(length) => format!("catenary.mesh.element_length={length:?}"),
    }
}

/// A key whose value is a list of names.
fn list_key(key: &str, names: &[String]) -> String {
    match names {
        [] => format!("{key}=none"),
        [auto] if auto == AUTO => format!("{key}={AUTO}"),
        names => format!("{key}={names:?}"),
    }
}

fn corrections_key(corrections: &[String]) -> String {
    list_key("catenary.mesh.corrections", corrections)
}

pub(super) fn reduce_key(reductions: &[String]) -> String {
    list_key("model.reduce", reductions)
}
