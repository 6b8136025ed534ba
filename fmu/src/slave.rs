//! The slave behind an FMU: parameters and inputs as set by the importer, the component built on demand.
use crate::table::{WORK, variables};
use component::{Causality, Component, Parameter, Signal};
use fmi2::model_description::Variable;
use fmi2::slave::{Model, ModelError, ModelResult};
use scene::{Evaluate, MeshChoice, PantographModel, Scene, Start};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// File among the resources that holds the packaged scene.
pub const SCENE_RESOURCE: &str = "scene.toml";

/// Choices of the importer.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
struct Choices {
    /// Path of another scene, empty for the packaged one.
    scene_path: String,
    /// Text of the scene in use.
    scene_text: String,
    /// Values of all parameters.
    parameters: Vec<f64>,
    /// Settings by signal position; unused entries are zero.
    settings: Vec<f64>,
    /// Inputs set before the component was built, by signal position.
    early_inputs: Vec<Option<f64>>,
    /// Derivatives of orders 1 to 3 of these inputs, set since the values.
    early_derivatives: Vec<[f64; ORDERS]>,
}

impl Clone for Choices {
    fn clone(&self) -> Self {
        let mut choices = Self::default();
        choices.clone_from(self);
        choices
    }

    /// A state that is saved again and again keeps its memory.
    fn clone_from(&mut self, other: &Self) {
        let Self {
            scene_path,
            scene_text,
            parameters,
            settings,
            early_inputs,
            early_derivatives,
        } = other;
        self.scene_path.clone_from(scene_path);
        self.scene_text.clone_from(scene_text);
        self.parameters.clone_from(parameters);
        self.settings.clone_from(settings);
        self.early_inputs.clone_from(early_inputs);
        self.early_derivatives.clone_from(early_derivatives);
    }
}

/// Orders of input derivatives that are followed.
const ORDERS: usize = 3;

/// State that decides how a slave goes on.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SlaveState<K> {
    choices: Choices,
    component: Option<K>,
}

/// Component checkpoint in a state serialised by an FMU of this component; `None` if there is none.
#[must_use]
pub fn checkpoint<C: Component>(bytes: &[u8]) -> Option<C::Checkpoint> {
    let part = fmi2::slave::model_part(bytes)?;
    postcard::from_bytes::<SlaveState<C::Checkpoint>>(part).ok()?.component
}

/// A component driven by an FMI importer.
pub struct SceneSlave<C: Component> {
    packaged: Scene,
    packaged_text: String,
    signals: Vec<Signal>,
    parameters: Vec<Parameter>,
    choices: Choices,
    component: Option<C>,
}

impl<C: Component> SceneSlave<C> {
    fn with_scene(text: String, origin: &str) -> ModelResult<Self> {
        let packaged = load::<C>(&text, origin)?;
        let mut slave = Self {
            signals: C::signals(&packaged),
            parameters: C::parameters(&packaged),
            packaged_text: text,
            packaged,
            choices: Choices::default(),
            component: None,
        };
        slave.choices = slave.first_choices();
        Ok(slave)
    }

    fn first_choices(&self) -> Choices {
        Choices {
            scene_path: String::new(),
            scene_text: self.packaged_text.clone(),
            parameters: self.parameters.iter().map(|p| p.value(&self.packaged)).collect(),
            settings: self.signals.iter().map(|signal| signal.start).collect(),
            early_inputs: vec![None; self.signals.len()],
            early_derivatives: vec![[0.0; ORDERS]; self.signals.len()],
        }
    }

    /// The scene in use with the parameters that differ from their start values.
    fn scene(&self) -> ModelResult<Scene> {
        let origin = match self.choices.scene_path.as_str() {
            "" => SCENE_RESOURCE,
            path => path,
        };
        let mut scene = load::<C>(&self.choices.scene_text, origin)?;
        fill_start(&mut scene, &self.packaged);
        let own = C::parameters(&scene);
        for (parameter, &value) in self.parameters.iter().zip(&self.choices.parameters) {
            if value != parameter.value(&self.packaged) {
                if !own.iter().any(|own| own.name == parameter.name) {
                    return Err(ModelError::unusable(format!(
                        "{} = {value} {}: the scene {origin:?} has nothing of that name",
                        parameter.name, parameter.unit
                    )));
                }
                parameter.set(&mut scene, value);
            }
        }
        check::<C>(&scene)?;
        Ok(scene)
    }

    /// The component, built from the choices so far.
    fn built(&mut self) -> ModelResult<&mut C> {
        if self.component.is_none() {
            let mut component = C::build(&self.scene()?).map_err(ModelError::unusable)?;
            for (position, signal) in self.signals.iter().enumerate() {
                match (signal.causality, self.choices.early_inputs[position]) {
                    (Causality::Parameter, _) => component.set_input(position, self.choices.settings[position]),
                    (Causality::Input, Some(value)) => component.set_input(position, value),
                    _ => {}
                }
                for (order, value) in (1..).zip(self.choices.early_derivatives[position]) {
                    if value != 0.0 && signal.causality == Causality::Input {
                        component.set_input_derivative(position, order, value);
                    }
                }
            }
            self.component = Some(component);
        }
        Ok(self.component.as_mut().expect("built above"))
    }

    /// Drops the component after a change of the scene or its parameters.
    fn rebuild(&mut self) {
        self.component = None;
    }

    fn value(&mut self, position: usize) -> ModelResult<f64> {
        let count = self.signals.len();
        if position >= count {
            return Ok(self.choices.parameters[position - count]);
        }
        match self.signals[position].causality {
            Causality::Parameter => Ok(self.choices.settings[position]),
            Causality::Input => Ok(self.built()?.input(position)),
            Causality::Output => Ok(self.built()?.output(position)),
        }
    }

    /// Refuses choices that no instance of this FMU has made, as in the bytes of a state that were changed.
    fn fits(&self, choices: &Choices) -> ModelResult<()> {
        for (what, found, expected) in [
            ("parameters", choices.parameters.len(), self.choices.parameters.len()),
            ("settings", choices.settings.len(), self.choices.settings.len()),
            ("inputs", choices.early_inputs.len(), self.choices.early_inputs.len()),
            (
                "input derivatives",
                choices.early_derivatives.len(),
                self.choices.early_derivatives.len(),
            ),
        ] {
            if found != expected {
                return Err(ModelError::unusable(format!(
                    "the saved state is not of this FMU: it has {found} {what}, must have {expected}"
                )));
            }
        }
        if choices.scene_text == self.choices.scene_text {
            return Ok(());
        }
        let path = &choices.scene_path;
        self.takes(&load::<C>(&choices.scene_text, path)?, path)
    }

    /// Refuses another scene than one with the variables of this FMU.
    fn takes(&self, scene: &Scene, path: &str) -> ModelResult<()> {
        let (mine, other) = (size(&self.packaged), size(scene));
        if mine != other {
            return Err(ModelError::unusable(format!(
                "scene = {path:?}: has {} strips and {} supports, this FMU was packaged for {} and {}",
                other.0, other.1, mine.0, mine.1
            )));
        }
        let other = C::signals(scene);
        let lacks = |signals: &[Signal], name: &str| !signals.iter().any(|signal| signal.name == name);
        let missing = self.signals.iter().find(|signal| lacks(&other, &signal.name));
        let more = other.iter().find(|signal| lacks(&self.signals, &signal.name));
        if let Some((has, name)) =
            (missing.map(|signal| ("no", &signal.name))).or(more.map(|signal| ("a", &signal.name)))
        {
            return Err(ModelError::unusable(format!(
                "scene = {path:?}: has {has} variable {name}, unlike the scene that this FMU was packaged from"
            )));
        }
        Ok(())
    }

    fn read_scene(&mut self, path: &str) -> ModelResult<()> {
        let text = if path.is_empty() {
            self.packaged_text.clone()
        } else {
            if !Path::new(path).is_absolute() {
                return Err(ModelError::unusable(format!(
                    "scene = {path:?}: must be an absolute path"
                )));
            }
            std::fs::read_to_string(path).map_err(|error| ModelError::unusable(format!("scene = {path:?}: {error}")))?
        };
        let scene = load::<C>(&text, path)?;
        self.takes(&scene, path)?;
        self.choices.scene_path = path.into();
        self.choices.scene_text = text;
        self.rebuild();
        Ok(())
    }
}

/// Completes the start of another scene: values left open are those of the packaged scene, moved with the height of the
/// contact wire.
fn fill_start(scene: &mut Scene, packaged: &Scene) {
    let height = |scene: &Scene| scene.modelled_line().map_or(0.0, |(line, _)| line.first().height_at(0));
    let rise = height(scene) - height(packaged);
    for (own, other) in scene.pantographs.iter_mut().zip(&packaged.pantographs) {
        if own.start.is_none() {
            let risen = |start: Start| Start {
                height: start.height + rise,
                ..start
            };
            own.start = other.start.map(risen);
            if own.strips().len() == other.strip_starts.len() {
                own.strip_starts = other.strip_starts.iter().copied().map(risen).collect();
            }
        }
        if let (PantographModel::Lumped(own), PantographModel::Lumped(other)) = (&mut own.model, &other.model)
            && own.reference_height.is_none()
        {
            own.reference_height = other.reference_height.map(|height| height + rise);
        }
    }
}

/// Checks a scene changed by parameters as strictly as a scene from a file. Length and end of the run are the
/// importer's, so the run of the scene is fitted to them; a strip may also stand still.
fn check<C: Component>(scene: &Scene) -> ModelResult<()> {
    const SLOW: f64 = 1.0; // m/s
    let mut alone = scene.clone();
    if let Some((key, file)) = alone.unread_files_mut().first() {
        return Err(ModelError::unusable(format!(
            "{key} = {file:?}: an FMU reads no file but its scene: must be left out and its rows be given in the \
             scene, as in the scene.toml that a run writes"
        )));
    }
    if alone.run.speed == 0.0 {
        alone.run.speed = SLOW;
    }
    let room = alone.modelled_line().map_or(f64::INFINITY, |(line, _)| {
        let starts = (0..alone.strip_count()).map(|strip| alone.strip_start_x(strip));
        (line.length() - starts.fold(f64::NEG_INFINITY, f64::max)) / alone.run.speed
    });
    if room > 0.0 {
        alone.run.duration = alone.run.duration.min(room);
    }
    alone.run.evaluate = Evaluate::Time {
        from: 0.0,
        to: alone.run.duration,
    };
    C::check(&alone, "parameters of the FMU").map_err(ModelError::unusable)
}

/// Reads a scene for a component. Its micro step must be known: both sides take the same one.
fn load<C: Component>(text: &str, origin: &str) -> ModelResult<Scene> {
    let scene = C::load(text, origin).map_err(ModelError::unusable)?;
    let mesh = scene.modelled_line().map(|(line, _)| line.mesh.choice);
    if let Some(MeshChoice::Error {
        choose_micro_step: true,
        ..
    }) = mesh
    {
        return Err(ModelError::unusable(format!(
            "{origin}: catenary.mesh leaves the micro step to be chosen, which this FMU cannot: give \
             solver.micro_step, or the scene.toml that a run writes"
        )));
    }
    Ok(scene)
}

/// Number of strips and of supports.
fn size(scene: &Scene) -> (usize, usize) {
    let supports = scene.modelled_line().map_or(0, |(line, _)| line.spans() + 1);
    (scene.strip_count(), supports)
}

impl<C: Component> Model for SceneSlave<C> {
    type State = SlaveState<C::Checkpoint>;

    fn instantiate(resources: Option<&Path>) -> ModelResult<Self> {
        let folder = resources.ok_or_else(|| ModelError::unusable("no resource folder with the scene was given"))?;
        let path: PathBuf = folder.join(SCENE_RESOURCE);
        let text = std::fs::read_to_string(&path)
            .map_err(|error| ModelError::unusable(format!("{}: {error}", path.display())))?;
        Self::with_scene(text, SCENE_RESOURCE)
    }

    fn variables(&self) -> Vec<Variable> {
        variables::<C>(&self.packaged)
    }

    fn reset(&mut self) -> ModelResult<()> {
        self.choices = self.first_choices();
        self.rebuild();
        Ok(())
    }

    fn exit_initialization(&mut self) -> ModelResult<()> {
        self.built().map(|_| ())
    }

    fn real(&mut self, position: usize) -> ModelResult<f64> {
        self.value(position)
    }

    fn integer(&mut self, position: usize) -> ModelResult<i32> {
        // Index after the signals, the parameters and the path of the scene.
        let first = self.signals.len() + self.parameters.len() + 1;
        if (first..first + WORK.len()).contains(&position) {
            let work = self.component.as_ref().map(Component::work).unwrap_or_default();
            let counts = [
                work.micro_steps,
                work.newton_iterations,
                work.factorizations,
                work.above_tolerance,
            ];
            let count = counts[position - first];
            return Ok(i32::try_from(count).unwrap_or(i32::MAX));
        }
        Ok(self.value(position)? as i32)
    }

    fn boolean(&mut self, position: usize) -> ModelResult<bool> {
        Ok(self.value(position)? != 0.0)
    }

    fn string(&mut self, _position: usize) -> ModelResult<String> {
        Ok(self.choices.scene_path.clone())
    }

    fn set_real(&mut self, position: usize, value: f64) -> ModelResult<()> {
        let count = self.signals.len();
        if position >= count {
            // Importers set the same values several times: the component is built once for each set of values.
            let parameter = &mut self.choices.parameters[position - count];
            if *parameter != value {
                *parameter = value;
                self.rebuild();
            }
            return Ok(());
        }
        self.choices.early_inputs[position] = Some(value);
        self.choices.early_derivatives[position] = [0.0; ORDERS];
        if let Some(component) = &mut self.component {
            component.set_input(position, value);
        }
        Ok(())
    }

    fn set_boolean(&mut self, position: usize, value: bool) -> ModelResult<()> {
        let value = f64::from(u8::from(value));
        self.choices.settings[position] = value;
        if let Some(component) = &mut self.component {
            component.set_input(position, value);
        }
        Ok(())
    }

    fn set_string(&mut self, _position: usize, value: &str) -> ModelResult<()> {
        if value == self.choices.scene_path {
            return Ok(());
        }
        self.read_scene(value)
    }

    fn set_input_derivative(&mut self, position: usize, order: u32, value: f64) -> ModelResult<()> {
        let order = order as usize;
        // Orders beyond the third are more than any follower uses: the standard lets a slave ignore them.
        if (1..=ORDERS).contains(&order) {
            self.built()?.set_input_derivative(position, order, value);
            self.choices.early_derivatives[position][order - 1] = value;
        }
        Ok(())
    }

    fn output_derivative(&mut self, position: usize, order: u32) -> ModelResult<f64> {
        match order {
            1 => Ok(self.built()?.output_rate(position)),
            _ => Ok(0.0),
        }
    }

    fn directional_derivative(&mut self, output: usize, input: usize) -> ModelResult<f64> {
        Ok(self.built()?.sensitivity(output, input))
    }

    fn do_step(&mut self, time: f64, step: f64) -> ModelResult<()> {
        self.built()?.do_step(time, step).map_err(|failure| {
            if failure.retryable {
                ModelError::retryable(failure)
            } else {
                ModelError::unusable(failure)
            }
        })
    }

    fn save(&mut self) -> SlaveState<C::Checkpoint> {
        let mut state = SlaveState {
            choices: Choices::default(),
            component: None,
        };
        self.save_into(&mut state);
        state
    }

    fn save_into(&mut self, state: &mut SlaveState<C::Checkpoint>) {
        state.choices.clone_from(&self.choices);
        match &mut self.component {
            Some(component) => component.save(state.component.get_or_insert_with(C::Checkpoint::default)),
            None => state.component = None,
        }
    }

    fn restore(&mut self, state: &SlaveState<C::Checkpoint>) -> ModelResult<()> {
        self.fits(&state.choices)?;
        let same =
            self.choices.scene_text == state.choices.scene_text && self.choices.parameters == state.choices.parameters;
        self.choices.clone_from(&state.choices);
        if !same {
            self.rebuild();
        }
        match &state.component {
            Some(checkpoint) => self.built()?.restore(checkpoint).map_err(ModelError::unusable),
            None => {
                self.rebuild();
                Ok(())
            }
        }
    }

    fn serialize(state: &SlaveState<C::Checkpoint>) -> ModelResult<Vec<u8>> {
        postcard::to_stdvec(state).map_err(ModelError::unusable)
    }

    fn deserialize(bytes: &[u8]) -> ModelResult<SlaveState<C::Checkpoint>> {
        postcard::from_bytes(bytes).map_err(ModelError::unusable)
    }
}
