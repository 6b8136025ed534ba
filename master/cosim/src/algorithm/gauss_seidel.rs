//! One side after the other, the second with what the first has just put out.

use scene::{Coupling, Force, Order};

use component::exchange::{load, strip};

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
        match self.order {
            Order::CatenaryFirst => {
                predict::strips(exchange, self.extrapolation, &mut self.strips);
                step_line(sides, exchange, &mut self.strips, h)?;
                step_pantographs(sides, exchange, self.force, &mut self.load, h)?;
            }
            Order::PantographFirst => {
                let degree = self.extrapolation;
                step_pantographs_ahead(sides, exchange, self.force, degree, &mut self.load, h)?;
                predict::hermite(exchange.point(0), &exchange.reached.strips, h, &mut self.strips);
                step_line(sides, exchange, &mut self.strips, h)?;
            }
        }
        Ok(0)
    }
}

/// Steps the line with the strips on these courses.
pub(super) fn step_line(
    sides: &mut Sides<'_>,
    exchange: &mut Exchange,
    strips: &mut Polynomial,
    h: f64,
) -> Result<(), CouplingError> {
    strips.send(sides.line, h)?;
    sides.line.do_step(exchange.point(0).t, h)?;
    exchange.read_line(sides)?;
    Ok(())
}

/// Steps all pantographs, each under the course that `course` writes for it.
fn step_each(
    sides: &mut Sides<'_>,
    exchange: &mut Exchange,
    load: &mut Polynomial,
    h: f64,
    course: impl Fn(&Exchange, usize, &mut Polynomial),
) -> Result<(), CouplingError> {
    let t = exchange.point(0).t;
    for (i, pantograph) in sides.pantographs.iter_mut().enumerate() {
        course(exchange, i, load);
        load.send(&mut **pantograph, h)?;
        pantograph.do_step(t, h)?;
    }
    exchange.read_pantographs(sides)?;
    Ok(())
}

/// Steps all pantographs under the forces that the line has just put out.
pub(super) fn step_pantographs(
    sides: &mut Sides<'_>,
    exchange: &mut Exchange,
    force: Force,
    load: &mut Polynomial,
    h: f64,
) -> Result<(), CouplingError> {
    step_each(sides, exchange, load, h, |exchange, i, load| {
        predict::known_load(exchange, i, force, h, load);
    })
}

/// Steps all pantographs under forces extrapolated with `degree`.
pub(super) fn step_pantographs_ahead(
    sides: &mut Sides<'_>,
    exchange: &mut Exchange,
    force: Force,
    degree: usize,
    load: &mut Polynomial,
    h: f64,
) -> Result<(), CouplingError> {
    step_each(sides, exchange, load, h, |exchange, i, load| {
        predict::load(exchange, i, force, degree, h, load);
    })
}
