//! One side after the other, the second with what the first has just put out.

use scene::{Coupling, Force, Order};

use crate::interface::{load, strip};

use super::{Algorithm, CouplingError, Exchange, Polynomial, Sides, predict};

/// Each side steps once, in turn.
pub struct GaussSeidel {
    order: Order,
    force: Force,
    extrapolation: usize,
    strips: Polynomial,
    load: Polynomial,
}

impl GaussSeidel {
    /// For `strips` pantographs.
    #[must_use]
    pub fn new(coupling: &Coupling, strips: usize) -> Self {
        Self {
            order: coupling.order,
            force: coupling.force,
            extrapolation: coupling.extrapolation,
            strips: Polynomial::zeros(strips * strip::MOTION),
            load: Polynomial::zeros(load::COUNT),
        }
    }
}

impl Algorithm for GaussSeidel {
    fn step(&mut self, sides: &mut Sides<'_>, exchange: &mut Exchange, h: f64) -> Result<u64, CouplingError> {
        let t = exchange.point(0).t;
        match self.order {
            Order::CatenaryFirst => {
                predict::strips(exchange, self.extrapolation, &mut self.strips);
                self.strips.send(sides.line, h)?;
                sides.line.do_step(t, h)?;
                exchange.read_line(sides)?;
                step_pantographs(sides, exchange, self.force, &mut self.load, h)?;
            }
            Order::PantographFirst => {
                for (i, pantograph) in sides.pantographs.iter_mut().enumerate() {
                    predict::load(exchange, i, self.force, self.extrapolation, h, &mut self.load);
                    self.load.send(&mut **pantograph, h)?;
                    pantograph.do_step(t, h)?;
                }
                exchange.read_pantographs(sides)?;
                predict::hermite(exchange.point(0), &exchange.reached.strips, h, &mut self.strips);
                self.strips.send(sides.line, h)?;
                sides.line.do_step(t, h)?;
                exchange.read_line(sides)?;
            }
        }
        Ok(0)
    }
}

/// Steps all pantographs under the forces that the line has just put out.
pub(super) fn step_pantographs(
    sides: &mut Sides<'_>,
    exchange: &mut Exchange,
    force: Force,
    load: &mut Polynomial,
    h: f64,
) -> Result<(), CouplingError> {
    let t = exchange.point(0).t;
    for (i, pantograph) in sides.pantographs.iter_mut().enumerate() {
        predict::known_load(exchange, i, force, h, load);
        load.send(&mut **pantograph, h)?;
        pantograph.do_step(t, h)?;
    }
    exchange.read_pantographs(sides)?;
    Ok(())
}
