//! The whole scene.

use crate::accuracy::{left_open, open_steps_to_mesh};
use crate::check::Found;
use crate::error::{SceneError, What};
use crate::expand::{FILE_KEYS, apply_rules, take_files};
use crate::files::Files;
use crate::keys::{Entry, Keys, Sentences, read, write};
use crate::overrides::{last_key, override_with};
use crate::ranges::{Range, take_ranges};
use crate::tree::{At, Sources, Table, parse};
use crate::{
    Assessment, Catenary, Contact, ControllerFmu, Coupling, Evaluate, Measurement, MeshChoice, Model, Pantograph, Run,
    Solver, Supplied, Track, Vehicle, Wear, Wind,
};
use std::sync::Arc;

/// A scene: every value present, checked and in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// One line that says what the scene is.
    pub title: String,
    /// Source of the values.
    pub source: Option<String>,
    /// `[run]`.
    pub run: Run,
    /// `[catenary]`.
    pub catenary: Line,
    /// `[contact]`; absent only where a supplied line computes the contact force itself.
    pub contact: Option<Contact>,
    /// `[[pantograph]]`, at least one, the first one leads.
    pub pantographs: Vec<Pantograph>,
    /// `[[controller]]`: FMUs that command drives of pantographs.
    pub controllers: Vec<ControllerFmu>,
    /// `[vehicle]`: what each pantograph stands on; shared, as it is never changed.
    pub vehicle: Option<Arc<Vehicle>>,
    /// `[track]`: what the wheels of the vehicle run on.
    pub track: Option<Arc<Track>>,
    /// `[wind]`; `None`: no air.
    pub wind: Option<Wind>,
    /// `[model]`.
    pub model: Model,
    /// `[coupling]`.
    pub coupling: Coupling,
    /// `[solver]`.
    pub solver: Solver,
    /// `[measurement]`; `None`: nothing is measured.
    pub measurement: Option<Measurement>,
    /// `[wear]`; `None`: no current flows and nothing wears.
    pub wear: Option<Wear>,
    /// `[assessment]`.
    pub assessment: Assessment,
}

/// `[catenary]`: this program's line, or a supplied one.
#[derive(Clone, Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "one per scene")]
pub enum Line {
    /// Described by the scene.
    Modelled(Catenary),
    /// `fmu = "…"`.
    Supplied(Supplied),
}

/// A scene as read from a file: its values, and where each was typed.
pub struct SceneFile<'a> {
    /// Every key read; not yet checked across keys, and with what it leaves to be chosen.
    pub scene: Scene,
    /// Ranges that numbers of it may have.
    pub ranges: Vec<Range>,
    root: Table,
    sources: Sources<'a>,
}

impl<'a> SceneFile<'a> {
    /// Reads every key, see [`Scene::from_toml`]; tables and library files that the scene names are taken from `files`.
    ///
    /// # Errors
    ///
    /// Text that is not TOML; keys that are unknown, missing, of the wrong type or out of range.
    pub fn read(
        text: &str,
        origin: &'a str,
        overrides: &'a [String],
        files: &'a Files<'a>,
    ) -> Result<Self, SceneError> {
        let sources = Sources {
            origin,
            overrides,
            files,
        };
        let mut root = parse(text).map_err(|(at, what)| sources.refuse(vec![(at, String::new(), what)]))?;
        let agree = |wrong: Vec<_>| match wrong.is_empty() {
            true => Ok(()),
            false => Err(sources.refuse(wrong)),
        };
        // An override holds for what a file gave; files themselves and rules follow overrides.
        let of_files = |text: &str| last_key(text).is_some_and(|key| FILE_KEYS.contains(&key.as_str()));
        agree(override_with(&mut root, overrides, of_files))?;
        agree(take_files(&mut root, files))?;
        let (ranges, wrong) = take_ranges(&mut root);
        agree(wrong)?;
        agree(override_with(&mut root, overrides, |text| !of_files(text)))?;
        agree(apply_rules(&mut root))?;
        let macro_step_follows = open_steps_to_mesh(&mut root);
        let open = left_open(&mut root);
        let mut scene: Scene = read(&root, sources)?;
        if let Some(accuracy) = &mut scene.run.accuracy {
            accuracy.open = open;
        }
        if let Some(MeshChoice::Error { choose_macro_step, .. }) = scene.mesh_mut().map(|mesh| &mut mesh.choice) {
            *choose_macro_step = macro_step_follows;
        }
        Ok(Self {
            scene,
            ranges,
            root,
            sources,
        })
    }

    /// True where the key with this path was typed.
    #[must_use]
    pub fn says(&self, path: &str) -> bool {
        self.root.has(path)
    }

    /// Problems found with the scene, at their places.
    ///
    /// # Errors
    ///
    /// All of them, where there are any.
    pub fn refuse(&self, found: Found) -> Result<(), SceneError> {
        if found.is_empty() {
            return Ok(());
        }
        let found = found.into_iter();
        let found = found.map(|(key, what)| (self.root.place_of(&key), key, what));
        Err(self.sources.refuse(found.collect()))
    }

    /// Checks across keys, see [`Scene::check_with`].
    ///
    /// # Errors
    ///
    /// Every contradiction found.
    pub fn check(&self, further: &dyn Fn(&Scene) -> Found) -> Result<(), SceneError> {
        self.refuse(self.scene.contradictions(further))
    }
}

impl Scene {
    /// A scene of a modelled line under pantographs, the first one leading, on straight and even track in still air;
    /// coupling, solver and model as where they are left out in a file. Nothing is checked yet ([`Scene::checked`]).
    #[must_use]
    pub fn new(
        title: impl Into<String>,
        run: Run,
        (line, contact): (Catenary, Contact),
        pantographs: Vec<Pantograph>,
    ) -> Self {
        let mut scene = Self {
            title: title.into(),
            source: None,
            run,
            catenary: Line::Modelled(line),
            contact: Some(contact),
            pantographs,
            controllers: Vec::new(),
            vehicle: None,
            track: None,
            wind: None,
            model: Model::default(),
            coupling: Coupling::default(),
            solver: Solver::default(),
            measurement: None,
            wear: None,
            assessment: Assessment::default(),
        };
        scene.keep_contact_speed();
        scene
    }

    /// The scene with the reductions that change nothing, checked; its title is its name in messages. A mesh that is to
    /// be chosen is chosen before, by `catenary::mesh::resolve`.
    ///
    /// # Errors
    ///
    /// Every problem found, the same as of a scene from a file.
    pub fn checked(mut self) -> Result<Self, SceneError> {
        self.check(&self.title)?;
        self.choose_reductions();
        self.check(&self.title)?;
        Ok(self)
    }

    /// Reads a scene from the text of a file, with overrides in the form `key.path=value` applied in turn. A mesh that
    /// the file leaves to be chosen is not chosen yet ([`MeshChoice`]): `catenary::load` does both.
    ///
    /// `origin` is the name of the file in messages. A path is written `coupling.macro_step`,
    /// `pantograph[1].static_force` (counted from 1) or `pantograph.0.static_force` (counted from 0); a value is any
    /// TOML value, or a bare word as a string.
    ///
    /// # Errors
    ///
    /// Every problem found: text that is not TOML; keys that are unknown, missing, of the wrong type or out of range;
    /// and, where there is none of these, values that contradict each other ([`Scene::check`]).
    pub fn from_toml(text: &str, origin: &str, overrides: &[String]) -> Result<Self, SceneError> {
        let files = Files::none();
        let file = SceneFile::read(text, origin, overrides, &files)?;
        file.check(&|_| Found::new())?;
        Ok(file.scene)
    }

    /// The scene as TOML text with every default written out.
    ///
    /// Reading it again gives an equal scene, every number bit for bit.
    #[must_use]
    pub fn to_toml(&self) -> String {
        crate::write::file(&write(self))
    }

    /// Checks that every value is in its range and that the values are physically possible together, as
    /// [`Scene::from_toml`] has done; `origin` is the name of the scene in messages. For a scene that was built or
    /// changed since.
    ///
    /// # Errors
    ///
    /// Every contradiction found.
    pub fn check(&self, origin: &str) -> Result<(), SceneError> {
        self.check_with(origin, &|_| Found::new())
    }

    /// The same with contradictions that `further` finds beyond those of the scene alone, where values may be
    /// multiplied.
    ///
    /// # Errors
    ///
    /// Every contradiction found.
    pub fn check_with(&self, origin: &str, further: &dyn Fn(&Self) -> Found) -> Result<(), SceneError> {
        let files = Files::none();
        let sources = Sources {
            origin,
            overrides: &[],
            files: &files,
        };
        if let Line::Modelled(line) = &self.catenary
            && line.tension_lengths.is_empty()
        {
            // No file can say this: one without tension_length has the keys of a single one.
            let expected = "at least one tension length".to_owned();
            let key = "catenary.tension_length".to_owned();
            return Err(sources.refuse(vec![(At::File, key, What::Missing { expected })]));
        }
        // Values of single keys are those of a file that holds them.
        read::<Self>(&write(self), sources)?;
        let found = self.contradictions(further);
        if found.is_empty() {
            return Ok(());
        }
        let found = found.into_iter();
        let found = found.map(|(key, what)| (At::File, key, what));
        Err(sources.refuse(found.collect()))
    }

    /// The line and the contact law that this program models, unless the line is a supplied FMU.
    #[must_use]
    pub fn modelled_line(&self) -> Option<(&Catenary, &Contact)> {
        match (&self.catenary, &self.contact) {
            (Line::Modelled(catenary), Some(contact)) => Some((catenary, contact)),
            _ => None,
        }
    }

    /// Sides that are FMUs of others: the line, then pantographs, then controllers.
    pub fn supplied_sides(&self) -> impl Iterator<Item = &Supplied> {
        let line = match &self.catenary {
            Line::Supplied(side) => Some(side),
            Line::Modelled(_) => None,
        };
        let pantographs = self.pantographs.iter();
        line.into_iter()
            .chain(pantographs.filter_map(|pantograph| match &pantograph.model {
                crate::PantographModel::Supplied(side) => Some(side),
                _ => None,
            }))
            .chain(self.controllers.iter().map(|controller| &controller.side))
    }

    /// The supplied FMUs: that of the line, then those of pantographs, then controllers.
    pub fn supplied_sides_mut(&mut self) -> impl Iterator<Item = &mut Supplied> {
        let line = match &mut self.catenary {
            Line::Supplied(side) => Some(side),
            Line::Modelled(_) => None,
        };
        let pantographs = self.pantographs.iter_mut();
        line.into_iter()
            .chain(pantographs.filter_map(|pantograph| match &mut pantograph.model {
                crate::PantographModel::Supplied(side) => Some(side),
                _ => None,
            }))
            .chain(self.controllers.iter_mut().map(|controller| &mut controller.side))
    }

    /// Gravitational acceleration, m/s²; 9.81 where no modelled line says it.
    #[must_use]
    pub fn gravity(&self) -> f64 {
        self.modelled_line().map_or(9.81, |(line, _)| line.gravity)
    }

    /// Internal time step of both sides, s: the macro step evenly divided into steps of at most `solver.micro_step`;
    /// where the macro step is controlled, that of all macro steps that are not shorter than it, or the longest of
    /// those that there are.
    #[must_use]
    pub fn internal_step(&self) -> f64 {
        match self.coupling.step_control {
            Some(control) => control.longest_part(self.solver.micro_step),
            None => self.internal_step_of(self.coupling.macro_step),
        }
    }

    /// Internal time step of both sides in a macro step of `macro_step` s, s.
    #[must_use]
    pub fn internal_step_of(&self, macro_step: f64) -> f64 {
        // A rest of rounding makes no extra step.
        macro_step / (macro_step / self.solver.micro_step - 1e-9).ceil().max(1.0)
    }

    /// y of the strips at t = 0, m: that of the base on a vehicle, or the nearest sample before of a given motion.
    #[must_use]
    pub fn strip_start_y(&self) -> f64 {
        if let Some(Vehicle::RigidMotion(motion)) = self.vehicle.as_deref() {
            let sample = motion.time.partition_point(|&time| time <= 0.0).saturating_sub(1);
            return motion.y.get(sample).copied().unwrap_or(0.0);
        }
        self.base_aside()
    }

    /// How far the bases of pantographs stand beside the middle of the track on a vehicle of bodies, m; 0 on others.
    pub(crate) fn base_aside(&self) -> f64 {
        let train = self.vehicle.as_deref().and_then(Vehicle::train);
        train.map_or(0.0, |train| train.pantograph_base[1])
    }

    /// Evaluation range in time of pantograph `index` (from 0), (from, to) in s.
    #[must_use]
    pub fn evaluation_time(&self, index: usize) -> (f64, f64) {
        match (self.run.evaluate, &self.catenary) {
            (Evaluate::Spans { first, last }, Line::Modelled(catenary)) => {
                let time = |x: f64| (x - self.head_start_x(index)) / self.run.speed;
                (time(catenary.support_x(first - 1)), time(catenary.support_x(last)))
            }
            (Evaluate::Time { from, to }, _) => (from, to),
            // Refused by `from_toml`: the spans of a supplied line are not known.
            (Evaluate::Spans { .. }, Line::Supplied(_)) => (0.0, self.run.duration),
        }
    }

    /// Evaluation range in x of pantograph `index` (from 0), (from, to) in m.
    #[must_use]
    pub fn evaluation_x(&self, index: usize) -> (f64, f64) {
        match (self.run.evaluate, &self.catenary) {
            (Evaluate::Spans { first, last }, Line::Modelled(catenary)) => {
                (catenary.support_x(first - 1), catenary.support_x(last))
            }
            _ => {
                let (from, to) = self.evaluation_time(index);
                (self.head_x(index, from), self.head_x(index, to))
            }
        }
    }
}

impl Entry for Scene {
    const SENTENCES: Sentences = &[
        ("title", "One line that says what the scene is."),
        ("source", "One line that says where the values come from."),
        ("run", "Train, time and what is evaluated."),
        ("catenary", "The overhead line."),
        (
            "contact",
            "Law between contact wire and collector strip; left out where the line is a supplied FMU, which has its \
             own.",
        ),
        ("pantograph", "Pantographs, the leading one first."),
        ("controller", "Controllers of pantographs that are FMUs."),
        (
            "vehicle",
            "Vehicle under each pantograph; without it the base travels straight ahead.",
        ),
        (
            "track",
            "Track under the wheels of the vehicle; without it straight and even.",
        ),
        ("wind", "Air; without this table no force of the air is modelled."),
        ("model", "Reductions that make a run faster."),
        ("coupling", "Exchange between line and pantographs."),
        ("solver", "Time integration of each side."),
        (
            "measurement",
            "Instruments of the heads, as on a measuring train; without it nothing is measured.",
        ),
        (
            "wear",
            "Current of the pantographs, wear of contact wire and strips; without it no current flows.",
        ),
        (
            "assessment",
            "Limits that the run is held against, beside those that the program knows.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let title = keys.text(
            "title",
            was.map(|scene| scene.title.as_str()),
            "one line that says what the scene is",
        );
        let source = keys.optional_text(
            "source",
            was.map(|scene| scene.source.as_deref()),
            "one line that says where the values come from",
        );
        let run = keys.table("run", was.map(|scene| &scene.run));
        let catenary = keys.table("catenary", was.map(|scene| &scene.catenary));
        let modelled = matches!(catenary, Line::Modelled(_));
        let contact = was.map(|scene| scene.contact.as_ref());
        let contact_is_there = !keys.describes() && keys.has("contact", contact.flatten().is_some());
        if contact_is_there && !modelled {
            let because = "an FMU given as catenary has its own contact law".to_string();
            keys.report("contact", What::LeaveOut { because });
        }
        let contact_is_needed = contact_is_there || (modelled && was.is_none());
        let contact = contact_is_needed.then(|| keys.table("contact", contact.flatten()));
        let mut scene = Self {
            title,
            source,
            run,
            catenary,
            contact,
            pantographs: keys.tables("pantograph", was.map(|scene| scene.pantographs.as_slice())),
            controllers: keys.any_tables("controller", was.map(|scene| scene.controllers.as_slice())),
            vehicle: keys
                .optional_table("vehicle", was.map(|scene| scene.vehicle.as_deref()))
                .map(Arc::new),
            track: keys
                .optional_table("track", was.map(|scene| scene.track.as_deref()))
                .map(Arc::new),
            wind: keys.optional_table("wind", was.map(|scene| scene.wind.as_ref())),
            model: keys.table_or_empty("model", was.map(|scene| &scene.model)),
            coupling: keys.table_or_empty("coupling", was.map(|scene| &scene.coupling)),
            solver: keys.table_or_empty("solver", was.map(|scene| &scene.solver)),
            measurement: keys.optional_table("measurement", was.map(|scene| scene.measurement.as_ref())),
            wear: keys.optional_table("wear", was.map(|scene| scene.wear.as_ref())),
            assessment: keys.table_or_empty(
                "assessment",
                was.map(|scene| &scene.assessment)
                    .filter(|own| **own != Assessment::default()),
            ),
        };
        let step_is_given = keys.is_given("solver.micro_step");
        if let Some(MeshChoice::Error {
            choose_micro_step,
            choose_macro_step,
            ..
        }) = scene.mesh_mut().map(|mesh| &mut mesh.choice)
        {
            if was.is_none() {
                *choose_micro_step = !step_is_given;
            } else if *choose_micro_step {
                keys.leave_unwritten("solver.micro_step");
            }
            if *choose_macro_step {
                keys.leave_unwritten("coupling.macro_step");
            }
        }
        if let Some(open) = was.and_then(|scene| scene.run.accuracy).map(|wish| wish.open) {
            for (is_open, path) in [
                (open.mesh, "catenary.mesh.error_percent"),
                (open.micro_step, "solver.micro_step"),
                (open.macro_step, "coupling.macro_step"),
                (open.newton_tolerance, "solver.newton_tolerance"),
                (open.reductions, "model.reduce"),
            ] {
                if is_open {
                    keys.leave_unwritten(path);
                }
            }
        }
        scene.choose_reductions();
        scene.keep_contact_speed();
        scene
    }
}

impl Entry for Line {
    const SENTENCES: Sentences = &[];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        match was {
            Some(Self::Modelled(catenary)) => Self::Modelled(keys.part(Some(catenary))),
            Some(Self::Supplied(side)) => Self::Supplied(Supplied::line(keys, Some(side))),
            None if keys.describes() => {
                let line = keys.part(None);
                keys.only("`fmu`", |keys| Supplied::line(keys, None));
                Self::Modelled(line)
            }
            None if keys.has("fmu", false) => {
                let side = Supplied::line(keys, None);
                keys.leave_out::<Catenary>("fmu is given, which describes the whole line");
                Self::Supplied(side)
            }
            None => Self::Modelled(keys.part(None)),
        }
    }
}
