//! The algorithm that chooses by what the slaves can do and by the contact's frequency times the step.

use scene::{Coupling, Force, Order};

use super::{Algorithm, CouplingError, Exchange, GaussSeidel, InterfaceJacobian, Sides};

/// `ωh` (–) above which a single pass is Gauss-Seidel with the mean force, and below which it is the predicted parabola
/// again.
///
/// With the standard line and its lumped pantograph (83 rad/s) the parabola has a third of the other's error at 5 ms,
/// twice as much at 10 ms.
const ONE_PASS: Switch = Switch { up: 0.7, down: 0.6 };

/// `ωh` (–) of a part above which a step is done in more parts, and that fewer parts must keep below. Gauss-Seidel with
/// the mean force is neutral up to 2, Newton's repeated pass up to 2.9.
const PARTS: [Switch; 2] = [Switch { up: 1.8, down: 1.4 }, Switch { up: 2.5, down: 2.0 }];

/// Most parts of a step.
const MOST_PARTS: usize = 1000;

/// Two bounds, so that a figure near one of them does not switch to and fro.
struct Switch {
    up: f64,
    down: f64,
}

/// Newton with the interface Jacobian where the pantographs follow a force inside the step; where the step cannot be
/// repeated and `ωh` is too large for a prediction, Gauss-Seidel with the mean force; where it is too large for that,
/// the step in parts.
///
/// `ω` is that of the interface Jacobian where the step is repeated, else that of [`Frequency`](super::Frequency).
pub struct Auto {
    newton: InterfaceJacobian,
    neutral: GaussSeidel,
    /// True where every pantograph follows a force inside the step.
    follows: bool,
    repeats: bool,
    /// The slave that takes steps of one length only.
    fixed: Option<String>,
    /// True where the last step was Gauss-Seidel.
    is_neutral: bool,
    parts: usize,
    /// Steps by Newton and by Gauss-Seidel.
    done: [u64; 2],
    most_parts: usize,
    /// Smallest and largest `ωh` of a step, parts by themselves.
    numbers: Option<(f64, f64)>,
    /// Largest `ωh` at which the step could not be parted, and its length, s.
    too_long: Option<(f64, f64)>,
}

impl Auto {
    /// For these slaves.
    #[must_use]
    pub fn new(coupling: &Coupling, sides: &Sides<'_>) -> Self {
        let strips = sides.pantographs.len();
        let (rollback, follows) = (sides.can_roll_back(), follows(sides));
        let mean = Coupling {
            order: Order::CatenaryFirst,
            force: Force::Mean,
            extrapolation: 1,
            ..coupling.clone()
        };
        Self {
            newton: InterfaceJacobian::new(coupling, strips, rollback),
            neutral: GaussSeidel::new(&mean, strips),
            follows,
            repeats: follows && rollback && coupling.max_iterations > 1,
            fixed: sides.with_fixed_step().map(str::to_owned),
            is_neutral: !follows,
            parts: 1,
            done: [0; 2],
            most_parts: 1,
            numbers: None,
            too_long: None,
        }
    }

    fn part_switch(&self) -> &'static Switch {
        &PARTS[usize::from(self.repeats)]
    }
}

/// True where every pantograph follows a force inside the step.
pub(super) fn follows(sides: &Sides<'_>) -> bool {
    let mut pantographs = sides.pantographs.iter();
    pantographs.all(|slave| slave.abilities().input_derivatives > 0)
}

impl Algorithm for Auto {
    fn step(&mut self, sides: &mut Sides<'_>, exchange: &mut Exchange, h: f64) -> Result<u64, CouplingError> {
        self.newton.observe(exchange);
        let number = self.newton.stiffness(h);
        if self.follows && !self.repeats {
            self.is_neutral = number.map_or(self.is_neutral, |number| {
                number > if self.is_neutral { ONE_PASS.down } else { ONE_PASS.up }
            });
        }
        let taken_back = if self.is_neutral {
            self.neutral.step(sides, exchange, h)?
        } else {
            self.newton.step(sides, exchange, h)?
        };
        self.done[usize::from(self.is_neutral)] += 1;
        if let Some(number) = number {
            let (low, high) = self.numbers.unwrap_or((number, number));
            self.numbers = Some((low.min(number), high.max(number)));
            let longest = self.too_long.map_or(0.0, |(worst, _)| worst);
            if self.fixed.is_some() && number > self.part_switch().up.max(longest) {
                self.too_long = Some((number, h));
            }
        }
        Ok(taken_back)
    }

    fn saves(&self) -> bool {
        self.repeats
    }

    fn parts(&mut self, exchange: &Exchange, h: f64) -> usize {
        self.newton.observe(exchange);
        if self.fixed.is_some() {
            return 1;
        }
        if let Some(number) = self.newton.stiffness(h) {
            let switch = self.part_switch();
            let parts = |bound: f64| ((number / bound).ceil().max(1.0) as usize).min(MOST_PARTS);
            if number > switch.up * self.parts as f64 || parts(switch.down) < self.parts {
                self.parts = parts(switch.down);
            }
        }
        self.most_parts = self.most_parts.max(self.parts);
        self.parts
    }

    fn know(&mut self, frequency: f64) {
        self.newton.know(frequency);
    }

    fn report(&self) -> Option<String> {
        let [newton, neutral] = self.done;
        let mut text = match (newton, neutral) {
            (_, 0) => format!("interface_jacobian in all {newton} steps"),
            (0, _) => format!("gauss_seidel in all {neutral} steps"),
            _ => format!("interface_jacobian in {newton} steps, gauss_seidel in {neutral}"),
        };
        match self.numbers {
            Some((low, high)) => text.push_str(&format!("; omega h {low:.2} to {high:.2}")),
            None => text.push_str("; omega h not seen in the run"),
        }
        if self.most_parts > 1 {
            text.push_str(&format!("; macro steps done in up to {} equal parts", self.most_parts));
        }
        Some(text)
    }

    fn warning(&self) -> Option<String> {
        let (number, h) = self.too_long?;
        let slave = self.fixed.as_deref().unwrap_or_default();
        let bound = self.part_switch().up;
        Some(format!(
            "omega h reached {number:.2} with the macro step of {h} s, beyond {bound}, and {slave} takes steps of one \
             length only: coupling.macro_step should be at most {:.1e} s",
            bound * h / number
        ))
    }
}
