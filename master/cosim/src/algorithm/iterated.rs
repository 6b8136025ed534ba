//! Gauss-Seidel, repeated until the force stays the same.

use scene::{Coupling, Force, Order};

use component::exchange::{contact, load, strip};

use super::gauss_seidel::{step_line, step_pantographs, step_pantographs_ahead};
use super::{Algorithm, CouplingError, Exchange, Polynomial, Sides, predict};

/// Bounds of the relaxation factor: below, the step would stand still; above, it would run away.
const RELAXATION: (f64, f64) = (0.05, 2.0);

/// The line first, with the strips' motion of the last pass; both sides are taken back before each further pass.
///
/// The end motion of the strips is the fixed point sought, relaxed after Aitken:
///
/// ```text
/// ωₖ = −ωₖ₋₁ rₖ₋₁·(rₖ − rₖ₋₁)/|rₖ − rₖ₋₁|²,   r = G(w) − w      [Irons & Tuck 1969, doi 10.1002/nme.1620010306]
/// ```
///
/// with velocities scaled by the step. It ends when the force handed over changes by no more than the tolerance.
///
/// With `order = "pantograph_first"` the first motion that the line is given is that of the pantographs under the
/// predicted force, with `catenary_first` it is extrapolated.
pub struct Iterated {
    order: Order,
    force: Force,
    extrapolation: usize,
    max_iterations: usize,
    tolerance: f64,
    strips: Polynomial,
    load: Polynomial,
    /// End motion that the line was given, with the work (unused), in the order of outputs.
    guess: Vec<f64>,
    residual: Vec<f64>,
    last_residual: Vec<f64>,
    forces: Vec<f64>,
}

impl Iterated {
    /// For `strips` pantographs.
    #[must_use]
    pub fn new(coupling: &Coupling, strips: usize) -> Self {
        let outputs = || vec![0.0; strips * strip::OUTPUTS];
        Self {
            order: coupling.order,
            force: coupling.force,
            extrapolation: coupling.extrapolation,
            max_iterations: coupling.max_iterations,
            tolerance: coupling.force_tolerance,
            strips: Polynomial::zeros(strips * strip::MOTION),
            load: Polynomial::zeros(load::COUNT),
            guess: outputs(),
            residual: outputs(),
            last_residual: outputs(),
            forces: vec![0.0; 3 * strips],
        }
    }

    /// Keeps the forces handed over and returns their largest change, N.
    fn force_change(&mut self, exchange: &Exchange) -> f64 {
        let first = if self.force == Force::Mean {
            contact::MEAN_FX
        } else {
            contact::FX
        };
        let mut change = 0.0_f64;
        for (i, kept) in self.forces.chunks_exact_mut(3).enumerate() {
            for (kept, &now) in kept.iter_mut().zip(&exchange.reached.contact(i)[first..first + 3]) {
                change = change.max((now - *kept).abs());
                *kept = now;
            }
        }
        change
    }

    /// End motion of the predicted strips.
    fn predicted_end(&mut self, h: f64) {
        for (i, guess) in self.guess.chunks_exact_mut(strip::OUTPUTS).enumerate() {
            for (value, guess) in guess[..strip::MOTION].iter_mut().enumerate() {
                *guess = self.strips.at(i * strip::MOTION + value, h);
            }
        }
    }

    /// `r = G(w) − w`, velocities in units of the step's displacement.
    fn update_residual(&mut self, reached: &[f64], h: f64) {
        std::mem::swap(&mut self.residual, &mut self.last_residual);
        for (index, residual) in self.residual.iter_mut().enumerate() {
            let scale = match index % strip::OUTPUTS {
                strip::VX..=strip::VZ => h,
                strip::WORK.. => 0.0,
                _ => 1.0,
            };
            *residual = scale * (reached[index] - self.guess[index]);
        }
    }

    /// The next relaxation factor.
    fn relaxation(&self, last: f64) -> f64 {
        let (mut along, mut length) = (0.0, 0.0);
        for (now, before) in self.residual.iter().zip(&self.last_residual) {
            let difference = now - before;
            along += before * difference;
            length += difference * difference;
        }
        if length > 0.0 {
            (-last * along / length).clamp(RELAXATION.0, RELAXATION.1)
        } else {
            1.0
        }
    }
}

impl Algorithm for Iterated {
    fn step(&mut self, sides: &mut Sides<'_>, exchange: &mut Exchange, h: f64) -> Result<u64, CouplingError> {
        let t = exchange.point(0).t;
        sides.save()?;
        let mut taken_back = 0;
        if self.order == Order::PantographFirst {
            let degree = self.extrapolation;
            step_pantographs_ahead(sides, exchange, self.force, degree, &mut self.load, h)?;
            predict::hermite(exchange.point(0), &exchange.reached.strips, h, &mut self.strips);
            sides.restore()?;
            taken_back = 1;
        } else {
            predict::strips(exchange, self.extrapolation, &mut self.strips);
        }
        self.predicted_end(h);
        let (mut change, mut omega) = (f64::INFINITY, 1.0);
        for pass in 0..self.max_iterations {
            if pass > 0 {
                sides.restore()?;
                predict::hermite(exchange.point(0), &self.guess, h, &mut self.strips);
            }
            step_line(sides, exchange, &mut self.strips, h)?;
            step_pantographs(sides, exchange, self.force, &mut self.load, h)?;

            let difference = self.force_change(exchange);
            if pass > 0 {
                change = difference;
                if change <= self.tolerance {
                    return Ok(taken_back + pass as u64);
                }
            }
            self.update_residual(&exchange.reached.strips, h);
            // The first pass had another polynomial than those after it: it says nothing on their contraction.
            omega = if pass > 1 { self.relaxation(omega) } else { 1.0 };
            for (guess, reached) in self.guess.iter_mut().zip(&exchange.reached.strips) {
                *guess += omega * (reached - *guess);
            }
        }
        let (iterations, residual, tolerance) = (self.max_iterations, change, self.tolerance);
        Err(CouplingError::NotConverged {
            t,
            h,
            iterations,
            residual,
            tolerance,
        })
    }

    fn saves(&self) -> bool {
        true
    }
}
