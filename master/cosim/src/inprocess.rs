//! Slaves made of the core components, in this process and without any protocol.

use scene::Scene;

use crate::slave::{Abilities, Slave, SlaveError, finite};
use component::Frame;
use component::Work;
use component::exchange::{contact, instrument, load, strip, support};
use component::{Component, positions};
use system::picture;

/// A component as a slave.
pub struct InProcess<C: Component> {
    name: String,
    component: C,
    /// Positions of the exchanged values among the component's signals.
    inputs: Vec<usize>,
    outputs: Vec<usize>,
    output_names: Vec<String>,
    kept: C::Checkpoint,
    t: f64,
    draw: fn(&mut C, &mut Frame),
}

impl InProcess<catenary::Subsystem> {
    /// The line of a scene, with the supports of these numbers (from 1) recorded.
    ///
    /// # Errors
    /// A line without static equilibrium.
    pub fn line(scene: &Scene, supports: &[usize]) -> Result<Self, catenary::CatenaryError> {
        let component = catenary::Subsystem::build(scene)?;
        let groups = component.groups();
        let strips = 0..scene.strip_count();
        let inputs = positions(&groups, strip::GROUP, strips.clone(), &strip::SIGNALS[..strip::MOTION]);
        let mut outputs = positions(&groups, contact::GROUP, strips, &contact::SIGNALS[..contact::COUNT]);
        let recorded = supports.iter().map(|number| number - 1);
        outputs.extend(positions(&groups, support::GROUP, recorded, &support::SIGNALS));
        Ok(Self::new("line", component, scene, [inputs, outputs], draw_line))
    }
}

impl InProcess<vehicle::Subsystem> {
    /// Pantograph `index` (from 0) of a scene; with the command as its last input and the readings of its instruments
    /// as last outputs, where an FMU of the scene commands its drive.
    ///
    /// # Errors
    /// A pantograph without equilibrium at its start.
    pub fn pantograph(scene: &Scene, index: usize) -> Result<Self, vehicle::VehicleError> {
        let own = component::of_pantograph(scene, index);
        let component = vehicle::Subsystem::build(&own)?;
        let strips = component.strips();
        let groups = component.groups();
        let mut inputs = positions(&groups, load::GROUP, 0..strips, &load::SIGNALS);
        let mut outputs = positions(&groups, strip::GROUP, 0..strips, &strip::SIGNALS);
        if scene.controller_of(index).is_some() {
            let signals = vehicle::Subsystem::signals(&own);
            let place = |name: &str| signals.iter().position(|signal| signal.name == name);
            inputs.extend(place(instrument::COMMAND));
            outputs.extend(instrument::SIGNALS.iter().filter_map(|signal| place(signal.name)));
        }
        let name = format!("pantograph {}", index + 1);
        Ok(Self::new(&name, component, &own, [inputs, outputs], draw_pantograph))
    }
}

impl<C: Component> InProcess<C> {
    fn new(
        name: &str,
        component: C,
        scene: &Scene,
        [inputs, outputs]: [Vec<usize>; 2],
        draw: fn(&mut C, &mut Frame),
    ) -> Self {
        let signals = C::signals(scene);
        let output_names = outputs.iter().map(|&position| signals[position].name.clone());
        Self {
            name: name.to_owned(),
            component,
            output_names: output_names.collect(),
            inputs,
            outputs,
            kept: C::Checkpoint::default(),
            t: 0.0,
            draw,
        }
    }
}

impl<C: Component> Slave for InProcess<C> {
    fn name(&self) -> &str {
        &self.name
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            rollback: true,
            input_derivatives: dynamics::MAX_ORDER,
            variable_step: true,
        }
    }

    fn set_inputs(&mut self, values: &[f64]) -> Result<(), SlaveError> {
        for (&signal, &value) in self.inputs.iter().zip(values) {
            self.component.set_input(signal, value);
        }
        Ok(())
    }

    fn set_input_derivatives(&mut self, order: usize, values: &[f64]) -> Result<(), SlaveError> {
        for (&signal, &value) in self.inputs.iter().zip(values) {
            self.component.set_input_derivative(signal, order, value);
        }
        Ok(())
    }

    fn do_step(&mut self, t: f64, h: f64) -> Result<(), SlaveError> {
        self.component.do_step(t, h).map_err(|failure| SlaveError::Step {
            slave: self.name.clone(),
            t,
            h,
            retryable: failure.retryable,
            source: Box::new(failure),
        })?;
        self.t = t + h;
        Ok(())
    }

    fn outputs(&mut self, values: &mut [f64]) -> Result<(), SlaveError> {
        for (&signal, value) in self.outputs.iter().zip(values.iter_mut()) {
            *value = self.component.output(signal);
        }
        finite(&self.name, &self.output_names, values, self.t)
    }

    fn save(&mut self) -> Result<(), SlaveError> {
        self.component.save(&mut self.kept);
        Ok(())
    }

    fn restore(&mut self) -> Result<(), SlaveError> {
        self.component.restore(&self.kept).map_err(|failure| SlaveError::Call {
            slave: self.name.clone(),
            action: "go back to its saved state",
            source: Box::new(failure),
        })
    }

    fn work(&mut self) -> Work {
        self.component.work()
    }

    fn draw(&mut self, frame: &mut Frame) {
        (self.draw)(&mut self.component, frame);
    }
}

/// Adds the wires and droppers of a line component to a picture.
pub fn draw_line(line: &mut catenary::Subsystem, frame: &mut Frame) {
    let (line, motion) = line.line();
    picture::draw_wires(line, &motion, frame);
}

/// Adds the outline of a pantograph component to a picture.
pub fn draw_pantograph(pantograph: &mut vehicle::Subsystem, frame: &mut Frame) {
    let (pantograph, motion) = pantograph.pantograph();
    picture::draw_outline(pantograph, &motion, frame);
}
