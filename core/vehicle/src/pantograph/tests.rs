mod chain_in_curve;
mod four_bar;
mod linkage;
mod lumped;
mod reduced;
mod several_strips;
mod thesis;

use super::{Equilibrium, Pantograph, Target};
use crate::{PantographModel, VehicleError};
use dynamics::{Constraint, Force, Layout, System};

const GRAVITY: f64 = 9.81;

/// Rest on a base in the reference position.
trait AtRest: Pantograph {
    fn equilibrium_at_force(&self, force: f64) -> Result<Equilibrium, VehicleError> {
        self.equilibrium(None, Target::Force(force))
    }

    fn equilibrium_at_height(&self, height: f64) -> Result<Equilibrium, VehicleError> {
        self.equilibrium(None, Target::Height(height))
    }
}

impl<P: Pantograph> AtRest for P {}

/// A pantograph alone, with other forces on it.
struct Alone {
    layout: Layout,
    model: PantographModel,
    loads: Vec<Box<dyn Force>>,
}

impl System for Alone {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.model.forces(visit);
        for load in &mut self.loads {
            visit(load.as_mut());
        }
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        self.model.constraints(visit);
    }
}
