//! Droppers that may be slack at the end of a step.
use super::modes::Modes;
use super::point::ContactPoint;
use dynamics::Lu;
use dynamics::modal::{StepFactors, kernels};
use pulp::Arch;

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
    products: [Vec<f32>; 2],
}

impl Answers {
    pub fn new(modes: &Modes, h: f64) -> Self {
        Self {
            step: StepFactors::new(&modes.stiffness, &modes.damping, h),
            between_droppers: vec![f64::NAN; modes.droppers().pow(2)],
            products: [vec![0.0; modes.count()], vec![0.0; modes.count()]],
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

    /// Finds the answer of dropper `a` to the force of dropper `b` where it is not yet known.
    fn need(&mut self, (arch, modes): (Arch, &Modes), [a, b]: [usize; 2]) {
        if !self.between_droppers[a * modes.droppers() + b].is_nan() {
            return;
        }
        for (product, factor) in self.products.iter_mut().zip([&self.step.q1, &self.step.v1]) {
            kernels::products(arch, modes.joint(a), factor, product);
        }
        let [elongation, rate] = kernels::dots(arch, modes.joint(b), self.products.each_ref().map(Vec::as_slice));
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
    /// Lacking force of each beyond that at rest at the last solution, N.
    lacking: Vec<f64>,
}

impl Candidates {
    /// The candidates and their last lacking forces, N.
    pub fn lacking(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.droppers.iter().copied().zip(self.lacking.iter().copied())
    }

    /// Takes the droppers that are candidates, with what they lacked at the end of the last step, N; `compliance` has
    /// the factors of the compliance of the points.
    pub fn take(
        &mut self,
        (arch, modes, answers): (Arch, &Modes, &mut Answers),
        (points, compliance): (&[ContactPoint], &Lu),
        [q_free, v_free]: [&[f32]; 2],
        droppers: impl Iterator<Item = (usize, f64)>,
    ) {
        let law = &modes.law;
        for values in [
            &mut self.free,
            &mut self.deflections,
            &mut self.tensions,
            &mut self.held,
            &mut self.lacking,
        ] {
            values.clear();
        }
        self.droppers.clear();
        for (dropper, lacking) in droppers {
            let row = modes.joint(dropper);
            let [elongation, rate] = kernels::dots(arch, row, [q_free, v_free]);
            let spring = modes.at_rest[dropper] + law.stiffness * elongation;
            self.free.push(spring + law.damping * rate);
            for point in points {
                let [mut deflection, mut elongation, mut rate] = [0.0; 3];
                if point.on {
                    let [q, v] = &point.by_force;
                    [deflection, elongation, rate] = kernels::dots(arch, row, [&point.fixed, q, v]);
                    let residual = modes.residual_by_dropper(&point.columns, dropper);
                    deflection += residual;
                    elongation += residual;
                }
                self.deflections.push(deflection);
                self.tensions.push(law.stiffness * elongation + law.damping * rate);
            }
            let first = self.held.len();
            self.held.extend_from_slice(&self.deflections[first..]);
            compliance.solve(&mut self.held[first..]);
            self.lacking.push(lacking);
            self.droppers.push(dropper);
        }
        for &a in &self.droppers {
            for &b in &self.droppers {
                answers.need((arch, modes), [a, b]);
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
    pub fn settle(&mut self, modes: &Modes, answers: &Answers, forces: &mut [f64]) {
        let contacts = forces.len();
        for _ in 0..SWEEPS {
            let mut largest = 0.0_f64;
            for (c, &dropper) in self.droppers.iter().enumerate() {
                let own = c * contacts..(c + 1) * contacts;
                let (tensions, held) = (&self.tensions[own.clone()], &self.held[own]);
                let along = |values: &[f64]| -> f64 { tensions.iter().zip(values).map(|(a, b)| a * b).sum() };
                let between = &answers.between_droppers[dropper * modes.droppers()..][..modes.droppers()];
                let by_droppers: f64 = self.lacking().map(|(other, lacking)| between[other] * lacking).sum();
                let spring = self.free[c] + along(forces) - by_droppers;
                let slope = 1.0 - between[dropper] + along(held);
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
