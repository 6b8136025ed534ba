//! Droppers that may be slack at the end of a step.
use super::modes::Modes;
use super::pass::Pass;
use dynamics::modal::{Aligned, StepFactors, kernels};
use pulp::Arch;
use std::sync::Arc;

/// Difference of forces between sweeps over slack droppers at which these end, N.
const SETTLED: f64 = 1e-9;
/// Most sweeps over slack droppers.
const SWEEPS: usize = 500;

/// Answers of the line to forces at the end of a step of one length.
#[derive(Clone)]
pub(crate) struct Answers {
    pub(super) step: StepFactors,
    /// Answer of the tension of each dropper to the force of each other one, –; not a number where not yet needed.
    between_droppers: Vec<f64>,
    /// Amplitudes and their rates by a unit force of one dropper.
    products: [Aligned; 2],
}

impl Answers {
    pub fn new(modes: &Modes, h: f64) -> Self {
        Self {
            step: StepFactors::new(&modes.stiffness, &modes.damping, h),
            between_droppers: vec![f64::NAN; modes.droppers().pow(2)],
            products: [Aligned::zeros(modes.count()), Aligned::zeros(modes.count())],
        }
    }

    /// Answers between all droppers in a step of 0 s, which leads to rest.
    pub fn at_rest(modes: &Modes) -> Self {
        let (mut answers, arch) = (Self::new(modes, 0.0), Arch::new());
        for a in 0..modes.droppers() {
            (a..modes.droppers()).for_each(|b| answers.need((arch, modes), [a, b]));
        }
        answers
    }

    /// Answer of the tension of dropper `a` to the force of dropper `b`, –; not a number where not yet needed.
    fn between(&self, modes: &Modes, [a, b]: [usize; 2]) -> f64 {
        self.between_droppers[a * modes.droppers() + b]
    }

    /// Finds the answer of dropper `a` to the force of dropper `b`.
    fn need(&mut self, (arch, modes): (Arch, &Modes), [a, b]: [usize; 2]) {
        for (product, factor) in self.products.iter_mut().zip([&self.step.q1, &self.step.v1]) {
            kernels::products(arch, modes.joint(a), factor, product);
        }
        let [elongation, rate] =
            kernels::dots(arch, modes.joint(b), self.products.each_ref().map(|product| &**product));
        let elongation = elongation + modes.residual_between(a, b);
        let answer = modes.law.stiffness * elongation + modes.law.damping * rate;
        // Both ways the same, as the modes are.
        self.between_droppers[a * modes.droppers() + b] = answer;
        self.between_droppers[b * modes.droppers() + a] = answer;
    }
}

/// Droppers that may be slack at the end of the present step, with their part in it.
#[derive(Default)]
pub(super) struct Candidates {
    droppers: Vec<usize>,
    /// Tension of each at the end of the step without forces there, N.
    free: Vec<f64>,
    /// Deflection of each point by a unit lacking force, m/N; candidate after candidate.
    deflections: Vec<f64>,
    /// Tension by a unit force of each strip, –; candidate after candidate.
    tensions: Vec<f64>,
    /// Force on each strip that a unit lacking force leaves with the points held, –; candidate after candidate.
    held: Vec<f64>,
    /// Tension by a unit force of each other one, –; candidate after candidate.
    between: Vec<f64>,
    /// Lacking force of each beyond that at rest at the last solution, N.
    lacking: Vec<f64>,
}

impl Candidates {
    /// Number of candidates.
    pub fn len(&self) -> usize {
        self.droppers.len()
    }

    /// The candidates.
    pub fn droppers(&self) -> &[usize] {
        &self.droppers
    }

    /// The candidates and their last lacking forces, N.
    pub fn lacking(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.droppers.iter().copied().zip(self.lacking.iter().copied())
    }

    /// Chooses the droppers that are candidates, with what they lacked at the end of the last step, N.
    pub fn choose(&mut self, droppers: impl Iterator<Item = (usize, f64)>) {
        self.droppers.clear();
        self.lacking.clear();
        for (dropper, lacking) in droppers {
            self.droppers.push(dropper);
            self.lacking.push(lacking);
        }
    }

    /// Takes the part of each in the step: its elongation, m, and the rate, m/s, without forces at the end, and its
    /// answers to forces there.
    pub fn take(
        &mut self,
        (arch, modes, answers): (Arch, &Modes, &mut Arc<Answers>),
        pass: &mut Pass,
        motions: impl Iterator<Item = [f64; 2]>,
    ) {
        let law = &modes.law;
        let values = [
            &mut self.free,
            &mut self.deflections,
            &mut self.tensions,
            &mut self.held,
            &mut self.between,
        ];
        values.into_iter().for_each(Vec::clear);
        for (&dropper, [elongation, rate]) in self.droppers.iter().zip(motions) {
            let spring = modes.at_rest[dropper] + law.stiffness * elongation;
            self.free.push(spring + law.damping * rate);
            pass.need((arch, modes), dropper);
            for [deflection, tension] in pass.by_dropper(dropper) {
                self.deflections.push(*deflection);
                self.tensions.push(*tension);
            }
            let first = self.held.len();
            self.held.extend_from_slice(&self.deflections[first..]);
            pass.factored.solve(&mut self.held[first..]);
        }
        for &a in &self.droppers {
            for &b in &self.droppers {
                let mut answer = answers.between(modes, [a, b]);
                if answer.is_nan() {
                    Arc::make_mut(answers).need((arch, modes), [a, b]);
                    answer = answers.between(modes, [a, b]);
                }
                self.between.push(answer);
            }
        }
    }

    /// Deflection of a point of `points` by all lacking forces, m, taken away from that without them.
    pub fn deflection(&self, point: usize, points: usize) -> f64 {
        let by_each = self.deflections.chunks_exact(points).zip(&self.lacking);
        by_each.map(|(deflections, lacking)| deflections[point] * lacking).sum()
    }

    /// Lacking forces `p ≥ 0` with `s + p ≥ 0`, `p (s + p) = 0`, `s` the tension of a spring that may push; `forces`
    /// are those of the strips with the points held, and change with `p`.
    pub fn settle(&mut self, modes: &Modes, forces: &mut [f64]) {
        let (contacts, count) = (forces.len(), self.len());
        for _ in 0..SWEEPS {
            let mut largest = 0.0_f64;
            for (c, &dropper) in self.droppers.iter().enumerate() {
                let own = c * contacts..(c + 1) * contacts;
                let (tensions, held) = (&self.tensions[own.clone()], &self.held[own]);
                let along = |values: &[f64]| -> f64 { tensions.iter().zip(values).map(|(a, b)| a * b).sum() };
                let between = &self.between[c * count..][..count];
                let by_droppers: f64 = between.iter().zip(&self.lacking).map(|(a, b)| a * b).sum();
                let spring = self.free[c] + along(forces) - by_droppers;
                let slope = 1.0 - between[c] + along(held);
                let of_rest = modes.lacks_at_rest(dropper);
                let lacks = self.lacking[c] + of_rest;
                let next = (lacks - (spring + lacks) / slope).max(0.0);
                let change = next - lacks;
                for (force, held) in forces.iter_mut().zip(held) {
                    *force += held * change;
                }
                self.lacking[c] = next - of_rest;
                largest = largest.max(change.abs());
            }
            if largest <= SETTLED {
                break;
            }
        }
    }
}
