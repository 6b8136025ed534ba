//! Both sides at once, from predicted values.

use scene::{Coupling, Force};

use component::exchange::{load, strip};

use super::{Algorithm, CouplingError, Exchange, Polynomial, Sides, predict};

/// Sides step from the values of the last communication points; neither waits for the other.
pub struct Jacobi {
    force: Force,
    extrapolation: usize,
    strips: Polynomial,
    load: Polynomial,
}

impl Jacobi {
    /// For `strips` pantographs.
    #[must_use]
    pub fn new(coupling: &Coupling, strips: usize) -> Self {
        Self {
            force: coupling.force,
            extrapolation: coupling.extrapolation,
            strips: Polynomial::zeros(strips * strip::MOTION),
            load: Polynomial::zeros(load::COUNT),
        }
    }
}

impl Algorithm for Jacobi {
    fn step(&mut self, sides: &mut Sides<'_>, exchange: &mut Exchange, h: f64) -> Result<u64, CouplingError> {
        let t = exchange.point(0).t;
        predict::strips(exchange, self.extrapolation, &mut self.strips);
        self.strips.send(sides.line, h)?;
        for (i, pantograph) in sides.pantographs.iter_mut().enumerate() {
            predict::load(exchange, i, self.force, self.extrapolation, h, &mut self.load);
            self.load.send(&mut **pantograph, h)?;
        }
        // The line last: a pantograph with a thread of its own steps meanwhile.
        for pantograph in sides.pantographs.iter_mut() {
            pantograph.do_step(t, h)?;
        }
        sides.line.do_step(t, h)?;
        exchange.read_line(sides)?;
        exchange.read_pantographs(sides)?;
        Ok(0)
    }
}
