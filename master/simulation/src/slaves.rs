//! Line and pantographs as slaves of a coupled run.

use super::{FmuSource, Prepared, SetupError};
use component::exchange::{self, instrument, load, strip};
use component::of_pantograph;
use cosim::fmu_slave::{FmuSlave, Role};
use cosim::inprocess::{self, InProcess};
use cosim::package::{self, Libraries};
use cosim::slave::Slave;
use suppliers::{Commanded, SuppliedController, SuppliedLine, SuppliedPantograph};

/// Slaves of a coupled run.
type Slaves = (Box<dyn Slave>, Vec<Box<dyn Slave>>);

impl Prepared {
    /// Line and pantographs of the core.
    pub(super) fn core_slaves(
        &self,
        supports: &[usize],
        line: Option<SuppliedLine>,
        supplied: Vec<Option<SuppliedPantograph>>,
        mut controllers: Vec<Option<SuppliedController>>,
    ) -> Result<Slaves, SetupError> {
        let line: Box<dyn Slave> = match line {
            Some(line) => Box::new(line),
            None => Box::new(InProcess::line(&self.scene, supports)?),
        };
        let mut pantographs: Vec<Box<dyn Slave>> = Vec::new();
        for (index, supplied) in supplied.into_iter().enumerate() {
            pantographs.push(match supplied {
                Some(pantograph) => Box::new(pantograph),
                None => {
                    let refused = |source| SetupError::Pantograph {
                        pantograph: index + 1,
                        source,
                    };
                    let slave = Box::new(InProcess::pantograph(&self.scene, index).map_err(refused)?);
                    self.commanded(slave, index, &mut controllers)
                }
            });
        }
        Ok((line, pantographs))
    }

    /// Line and pantographs from FMUs, packaged where they are missing or stale.
    pub(super) fn fmu_slaves(
        &self,
        supports: &[usize],
        line: Option<SuppliedLine>,
        supplied: Vec<Option<SuppliedPantograph>>,
        mut controllers: Vec<Option<SuppliedController>>,
        source: &FmuSource,
    ) -> Result<Slaves, SetupError> {
        let fmus = if line.is_some() && supplied.iter().all(Option::is_some) {
            Vec::new()
        } else {
            let libraries = Libraries::find()?;
            package::ensure(&self.scene, &libraries, &source.folder)?
        };
        let fmu = |file: &str| {
            let found = fmus.iter().find(|(name, _)| name == file);
            &found
                .expect("every side of the scene that is modelled here is packaged")
                .1
        };
        let strips = self.scene.strip_count();
        let role = |name: String, inputs: Vec<String>, outputs: Vec<String>| Role {
            name,
            inputs,
            outputs,
            parameters: Vec::new(),
            initial: Vec::new(),
            duration: self.scene.run.duration,
            input_derivatives: dynamics::MAX_ORDER,
            logging: source.logging,
            isolation: None,
        };
        let line: Box<dyn Slave> = match line {
            Some(line) => Box::new(line),
            None => {
                let role = role(
                    "line".to_owned(),
                    exchange::line_inputs(strips),
                    exchange::line_outputs(strips, supports),
                );
                let slave = FmuSlave::start(fmu("Catenary.fmu"), role)?;
                Box::new(slave.drawn_by(self.scene.clone(), inprocess::draw_line))
            }
        };
        let mut pantographs: Vec<Box<dyn Slave>> = Vec::new();
        for (index, supplied) in supplied.into_iter().enumerate() {
            pantographs.push(match supplied {
                Some(pantograph) => Box::new(pantograph),
                None => {
                    let name = format!("pantograph {}", index + 1);
                    let strips = self.scene.strips_of(index).len();
                    let (mut inputs, mut outputs) = (
                        exchange::pantograph_inputs(strips),
                        exchange::pantograph_outputs(strips),
                    );
                    if self.scene.controller_of(index).is_some() {
                        inputs.push(instrument::COMMAND.to_owned());
                        outputs.extend(instrument::SIGNALS.iter().map(|signal| signal.name.to_owned()));
                    }
                    let role = role(name, inputs, outputs);
                    let slave = FmuSlave::start(fmu(&package::pantograph_file(index)), role)?;
                    let slave = slave.drawn_by(of_pantograph(&self.scene, index), inprocess::draw_pantograph);
                    self.commanded(Box::new(slave), index, &mut controllers)
                }
            });
        }
        Ok((line, pantographs))
    }

    /// Pantograph `index` (from 0) with the controller that the scene has for it.
    fn commanded(
        &self,
        slave: Box<dyn Slave>,
        index: usize,
        controllers: &mut [Option<SuppliedController>],
    ) -> Box<dyn Slave> {
        let Some(controller) = controllers.get_mut(index).and_then(Option::take) else {
            return slave;
        };
        let strips = self.scene.strips_of(index).len();
        let counts = (strips * load::COUNT, strips * strip::OUTPUTS);
        Box::new(Commanded::new(slave, controller, &self.scene, counts))
    }
}
