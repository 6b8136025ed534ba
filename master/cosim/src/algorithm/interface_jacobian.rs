//! Newton on the force over the macro step, with the step's own Jacobian; its first pass alone is a scheme of its own.

use scene::{Coupling, Force};

use component::exchange::{contact, load, strip};

use component::Point;

use super::exchange::Defect;
use super::gauss_seidel::step_line;
use super::waveform::{self, Shape, Waveform};
use super::{Algorithm, CouplingError, Exchange, Frequency, Polynomial, Sides, predict};

/// Force components of a load.
const AXES: usize = 3;

/// Change of the mean force with which the Jacobian is sounded, N: small against the static force of any pantograph.
const SOUNDING: f64 = 1.0;

/// A secant over a smaller change of the mean force is noise, N.
const SMALLEST_SECANT: f64 = 1e-3;

/// Factors by which the prediction of the curvature and the correction of the position give way as `ωh` grows:
/// `1/(1 + c (ωh)²)` (–).
///
/// The curvature that a parabola carries on is too large for an oscillation, and the correction of a position error
/// acts as a spring of its own. Without both factors the oscillation grows at small `ωh` already; with both the
/// spectral radius ([`super::stability`]) stays below 1 up to `ωh` = 1.2, also with a wrong `ω`. Both are of second
/// order in `h` beside 1, so that the order of convergence stays.
const GIVES_WAY: (f64, f64) = (2.0, 0.3);

/// Values that a secant may have: positive ones come from the contact's opening and closing only, and 1 has no
/// solution.
const SECANTS: std::ops::RangeInclusive<f64> = -100.0..=0.0;

/// Part of the Jacobian that a head on a spring has, `(ωh)²/6`, which the one that steps are accepted by does not go
/// below (–).
///
/// Secants of later passes, where the moment changes with the mean, come out near zero now and then. Such a one would
/// accept every first pass from then on, however far off, and with no further pass nothing would ever correct it.
const LEAST_GAIN: f64 = 0.05;

/// `ωh`, or `√(6 |J|)`, that `coupling.force_tolerance` is meant for, –: that of usual heads in steps of 5 ms. A force
/// that is left over acts for one step, until the next one makes up for it: in a shorter step the same impulse is that
/// of a larger force.
const STEP_OF_TOLERANCE: f64 = 0.4;

/// The pantographs first, under the predicted force; the line follows the cubic of their motion; then both again from
/// the start of the step, with the force that Newton's method gives, until nothing is left to gain.
///
/// The load over a step has a mean and a moment (see [`Waveform`]), and so has the force that the line answers with.
/// The difference between the two at the accepted step is not lost: it is a *defect* of the head's momentum and
/// position,
///
/// ```text
/// p′ = p + h (mean − mean given),   q′ = q + h p + h² (moment − moment given)
/// ```
///
/// and the load of the next step gets the straight line `c₀ + c₁ τ` that takes both to zero at its end,
///
/// ```text
/// h c₀ + h²/2 c₁ = p,   h²/2 c₀ + h³/6 c₁ = q + h p        (derived here)
/// ```
///
/// so that errors of the prediction act for one step only. One pass with this needs no rollback.
///
/// Unknown of Newton's method is the mean over the step, `r = mean answered − mean given`, and the Jacobian `J = d(mean
/// answered)/d(mean given)` of the whole loop over the step, `−(ωh)²/6` for a head on a spring, is sounded once by a
/// rollback difference, updated by secants and kept from step to step (scaled by h²). The step is accepted when a
/// further pass would change the force by no more than the tolerance, `|J r| ≤ tolerance`, or its impulse by no more
/// than that in a step of `ωh` = 0.4.
pub struct InterfaceJacobian {
    force: Force,
    degree: usize,
    carries: bool,
    extrapolation: usize,
    passes: usize,
    tolerance: f64,
    strips: Polynomial,
    load: Polynomial,
    /// Load given in the pass under way, per strip and component.
    given: Vec<[Shape; AXES]>,
    /// Part of it that makes up for the defects.
    correction: Vec<[Shape; AXES]>,
    /// `J` per strip for steps of `jacobian_step` s; `None` until it is known.
    jacobian: Vec<Option<f64>>,
    jacobian_step: f64,
    /// Mean given and answered in the last pass, vertical, per strip, N.
    last: Vec<Option<(f64, f64)>>,
    frequency: Frequency,
}

impl InterfaceJacobian {
    /// For `strips` pantographs; one pass per step only where `rollback` is false.
    #[must_use]
    pub fn new(coupling: &Coupling, strips: usize, rollback: bool) -> Self {
        Self {
            force: coupling.force,
            degree: match coupling.force {
                Force::Mean => 0,
                Force::End => 1,
                Force::Interpolated => 2,
            },
            carries: coupling.force != Force::End,
            extrapolation: coupling.extrapolation,
            passes: if rollback { coupling.max_iterations } else { 1 },
            tolerance: coupling.force_tolerance,
            strips: Polynomial::zeros(strips * strip::MOTION),
            load: Polynomial::zeros(load::COUNT),
            given: vec![Default::default(); strips],
            correction: vec![Default::default(); strips],
            jacobian: vec![None; strips],
            jacobian_step: 0.0,
            last: vec![None; strips],
            frequency: Frequency::new(strips),
        }
    }

    /// `ωh` of the stiffest contact for a step of `h` s, where it is known.
    #[must_use]
    pub fn stiffness(&self, h: f64) -> Option<f64> {
        (0..self.given.len())
            .filter_map(|i| self.strip_stiffness(i, h))
            .reduce(f64::max)
    }

    /// `ωh` of strip `i`. The Jacobian of later passes is no measure of it: there the moment changes with the mean.
    fn strip_stiffness(&self, i: usize, h: f64) -> Option<f64> {
        self.frequency.of(i).map(|frequency| h * frequency)
    }

    /// Takes in what the last steps say on the contact's frequency.
    pub(super) fn observe(&mut self, exchange: &Exchange) {
        self.frequency.observe(exchange);
    }

    /// Loads from what is known at the present point, and what the defects add to them.
    fn predict(&mut self, sides: &Sides<'_>, exchange: &Exchange, h: f64) {
        let [now, before, old] = [0, 1, 2].map(|back| exchange.point(back));
        for i in 0..self.given.len() {
            // A step that is repeated where it must be is stable with all of it.
            let number = self.strip_stiffness(i, h).filter(|_| self.passes == 1);
            let square = number.map_or(0.0, |number| number * number);
            let (curvature, position) = (1.0 / (1.0 + GIVES_WAY.0 * square), 1.0 / (1.0 + GIVES_WAY.1 * square));
            let (given, correction) = (&mut self.given[i], &mut self.correction[i]);
            let degree = self.degree.min(sides.pantographs[i].abilities().input_derivatives);
            // An opening or a closing in the last step says nothing on the next one.
            let smooth = exchange.known() > 1 && waveform::closed(before, now, i);
            let order = if smooth { self.extrapolation } else { 0 };
            // One internal step has no curvature of its own.
            let of_two = order > 1 && self.passes > 1 && exchange.known() > 2 && waveform::closed(old, before, i);
            for axis in 0..AXES {
                let last = answer(before, now, i, axis, self.force);
                correction[axis] = exchange.defect(i, axis).correction(h, degree, position);
                let steps = [before.t - old.t, now.t - before.t];
                given[axis] = if of_two && last.is_straight() {
                    let ends = [old.contact(i)[contact::FX + axis], last.start, last.end];
                    Shape::straight_on(ends, steps, h).truncated(degree)
                } else {
                    Shape::carried_on(&last, steps[1], h, order, curvature).truncated(degree)
                };
                given[axis].add(&correction[axis]);
            }
        }
    }

    /// One pass from the start of the step.
    fn pass(&mut self, sides: &mut Sides<'_>, exchange: &mut Exchange, h: f64) -> Result<(), CouplingError> {
        let t = exchange.point(0).t;
        let known = exchange.known() > 1;
        for (i, pantograph) in sides.pantographs.iter_mut().enumerate() {
            let degree = self.degree.min(pantograph.abilities().input_derivatives);
            self.load.clear(degree);
            waveform::lateral(exchange.point(1), exchange.point(0), i, known, &mut self.load);
            for (axis, shape) in self.given[i].iter().enumerate() {
                shape.write(load::FX + axis, h, &mut self.load);
            }
            self.load.send(&mut **pantograph, h)?;
            pantograph.do_step(t, h)?;
        }
        exchange.read_pantographs(sides)?;
        predict::hermite(exchange.point(0), &exchange.reached.strips, h, &mut self.strips);
        step_line(sides, exchange, &mut self.strips, h)
    }

    /// The force that the line has answered with.
    fn answer(&self, exchange: &Exchange, i: usize, axis: usize) -> Waveform {
        answer(exchange.point(0), &exchange.reached, i, axis, self.force)
    }

    /// Sounds the Jacobians that are not known yet, all strips at once: how one answers to another is small.
    ///
    /// Both slaves stand after a pass, and do so again.
    fn sound(&mut self, sides: &mut Sides<'_>, exchange: &mut Exchange, h: f64) -> Result<u64, CouplingError> {
        let unknown = |jacobian: &Option<f64>| jacobian.is_none();
        if !self.jacobian.iter().any(unknown) {
            return Ok(0);
        }
        for i in 0..self.given.len() {
            self.last[i] = Some((self.given[i][load::FZ].mean(), self.answer(exchange, i, load::FZ).mean));
            self.given[i][load::FZ].0[0] += SOUNDING;
        }
        sides.restore()?;
        self.pass(sides, exchange, h)?;
        self.secants(exchange, h);
        for i in 0..self.given.len() {
            self.given[i][load::FZ].0[0] -= SOUNDING;
            if let Some(jacobian) = self.jacobian[i] {
                self.frequency.sounded(i, (-6.0 * jacobian).max(0.0).sqrt() / h);
            }
        }
        sides.restore()?;
        self.pass(sides, exchange, h)?;
        Ok(2)
    }

    /// Updates the Jacobians by the last two passes.
    fn secants(&mut self, exchange: &Exchange, h: f64) {
        for i in 0..self.jacobian.len() {
            let given = self.given[i][load::FZ].mean();
            let answered = self.answer(exchange, i, load::FZ).mean;
            if let Some((last_given, last_answered)) = self.last[i]
                && (given - last_given).abs() > SMALLEST_SECANT
                && waveform::closed(exchange.point(0), &exchange.reached, i)
            {
                let secant = (answered - last_answered) / (given - last_given);
                if SECANTS.contains(&secant) {
                    self.jacobian[i] = Some(secant);
                }
            }
            self.last[i] = Some((given, answered));
        }
        self.jacobian_step = h;
    }

    /// Change by a further pass, N; without known Jacobian, residual of the last pass.
    fn to_gain(&self, sides: &Sides<'_>, exchange: &Exchange, h: f64) -> f64 {
        let mut gain = 0.0_f64;
        for (i, given) in self.given.iter().enumerate() {
            let held = self.degree.min(sides.pantographs[i].abilities().input_derivatives) == 0;
            // What is not made up for in the next step must itself be small, and the Jacobian is that of a closed
            // contact.
            let known = self.carries && waveform::closed(exchange.point(0), &exchange.reached, i);
            let floor = self
                .strip_stiffness(i, h)
                .map_or(0.0, |number| LEAST_GAIN * number * number / 6.0);
            let factor = self.jacobian[i]
                .filter(|_| known)
                .map_or(1.0, |jacobian| jacobian.abs().max(floor));
            for (axis, given) in given.iter().enumerate() {
                let answer = self.answer(exchange, i, axis);
                let correction = &self.correction[i][axis];
                let mean = answer.mean - (given.mean() - correction.mean());
                let moment = answer.moment - (given.moment() - correction.moment());
                gain = gain.max(factor * mean.abs());
                if !held {
                    gain = gain.max(factor * 2.0 * moment.abs());
                }
            }
        }
        gain
    }

    /// Largest change by a further pass that is not worth it in steps of `h` s, N.
    fn tolerance(&self, h: f64) -> f64 {
        // With a damper in the contact the Jacobian is larger than that of its spring.
        let of_loop = self
            .jacobian
            .iter()
            .flatten()
            .map(|jacobian| (6.0 * jacobian.abs()).sqrt());
        let number = self.stiffness(h).filter(|_| self.carries);
        let number = number.map(|number| of_loop.fold(number, f64::max));
        let shorter = number.map_or(1.0, |number| STEP_OF_TOLERANCE / number);
        self.tolerance * shorter.max(1.0)
    }

    /// Loads of the next pass: those answered, moved by Newton's step.
    fn improve(&mut self, sides: &Sides<'_>, exchange: &Exchange) {
        for i in 0..self.given.len() {
            let degree = self.degree.min(sides.pantographs[i].abilities().input_derivatives);
            let jacobian = self.jacobian[i].unwrap_or(0.0);
            for axis in 0..AXES {
                let answer = self.answer(exchange, i, axis);
                let correction = self.correction[i][axis];
                let residual = answer.mean - (self.given[i][axis].mean() - correction.mean());
                let mut next = Shape::of(&answer).truncated(degree);
                next.0[0] += jacobian / (1.0 - jacobian) * residual;
                next.add(&correction);
                self.given[i][axis] = next;
            }
        }
    }

    /// Residual between the loads given and the forces answered.
    fn keep_defects(&self, sides: &Sides<'_>, exchange: &mut Exchange, h: f64) {
        if !self.carries {
            return;
        }
        for (i, given) in self.given.iter().enumerate() {
            let degree = self.degree.min(sides.pantographs[i].abilities().input_derivatives);
            for (axis, given) in given.iter().enumerate() {
                let answer = self.answer(exchange, i, axis);
                let left = exchange.defect(i, axis);
                let defect = Defect {
                    momentum: left.momentum + h * (answer.mean - given.mean()),
                    // A load that is held cannot make up for a wrong position.
                    position: if degree == 0 {
                        0.0
                    } else {
                        left.position + h * left.momentum + h * h * (answer.moment - given.moment())
                    },
                };
                exchange.set_reached_defect(i, axis, defect);
            }
        }
    }
}

/// Course of a force over the step between two points: by its moments, or with [`Force::End`] the straight line from
/// end to end.
fn answer(from: &Point, to: &Point, i: usize, axis: usize, force: Force) -> Waveform {
    if force == Force::End {
        let [start, end] = [from, to].map(|point| point.contact(i)[contact::FX + axis]);
        return Waveform::line(start, end);
    }
    Waveform::of(from, to, i, axis)
}

impl Algorithm for InterfaceJacobian {
    fn step(&mut self, sides: &mut Sides<'_>, exchange: &mut Exchange, h: f64) -> Result<u64, CouplingError> {
        self.observe(exchange);
        let mut taken_back = 0;
        let repeats = self.passes > 1;
        if repeats {
            sides.save()?;
        }
        if self.jacobian_step > 0.0 && self.jacobian_step != h {
            let scale = (h / self.jacobian_step).powi(2);
            self.jacobian
                .iter_mut()
                .flatten()
                .for_each(|jacobian| *jacobian *= scale);
            self.jacobian_step = h;
        }
        self.last.fill(None);
        self.predict(sides, exchange, h);
        self.pass(sides, exchange, h)?;
        if repeats {
            taken_back += self.sound(sides, exchange, h)?;
            self.last.fill(None);
            self.secants(exchange, h);
            let (mut gain, tolerance) = (self.to_gain(sides, exchange, h), self.tolerance(h));
            for pass in 1.. {
                if gain <= tolerance {
                    break;
                }
                if pass >= self.passes {
                    return Err(CouplingError::NotConverged {
                        t: exchange.point(0).t,
                        h,
                        iterations: pass,
                        residual: gain,
                        tolerance,
                    });
                }
                self.improve(sides, exchange);
                sides.restore()?;
                taken_back += 1;
                self.pass(sides, exchange, h)?;
                self.secants(exchange, h);
                gain = self.to_gain(sides, exchange, h);
            }
        }
        self.keep_defects(sides, exchange, h);
        Ok(taken_back)
    }

    fn saves(&self) -> bool {
        self.passes > 1
    }

    fn know(&mut self, frequency: f64) {
        self.frequency.know(frequency);
    }
}

#[cfg(test)]
mod tests {
    use super::super::oscillator;
    use super::*;
    use crate::slave::Slave;
    use component::exchange::line_output_count;

    /// The bare oscillator, ω = 1, with the Jacobian of every first pass taken for nearly nothing. A first pass alone
    /// makes it grow or fall at this `ωh`.
    #[test]
    fn a_secant_near_zero_does_not_accept_first_passes_that_are_far_off() {
        let (h, preload) = (0.9, 10.0);
        let asked = Coupling {
            algorithm: scene::Algorithm::InterfaceJacobian,
            order: scene::Order::PantographFirst,
            force: Force::Interpolated,
            extrapolation: 2,
            macro_step: h,
            step_control: None,
            parallel: scene::Parallel::Never,
            max_iterations: 50,
            force_tolerance: 1e-4,
        };
        let (mut line, head) = oscillator::closed(1.0, preload);
        let mut pantographs: Vec<Box<dyn Slave>> = vec![Box::new(head)];
        let mut sides = Sides {
            line: &mut line,
            pantographs: &mut pantographs,
        };
        let mut algorithm = InterfaceJacobian::new(&asked, 1, true);
        let mut exchange = Exchange::start(&mut sides, 0.0, line_output_count(1, 0)).unwrap();
        for n in 1..=200 {
            if n > 10 {
                algorithm.jacobian[0] = Some(-1e-9);
            }
            algorithm.step(&mut sides, &mut exchange, h).unwrap();
            exchange.accept(h * f64::from(n));
            let state = exchange.point(0).strip(0);
            let amplitude = (state[strip::Z] - preload).hypot(state[strip::VZ]);
            assert!((amplitude - 1.0).abs() < 0.1, "step {n}: {amplitude}");
        }
    }
}
