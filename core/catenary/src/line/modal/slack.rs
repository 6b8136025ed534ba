//! Droppers that may be slack at the end of a step.
use super::lacking::bend;
use super::modes::Modes;
use super::pass::Pass;
use dynamics::modal::{Aligned, StepFactors, kernels};
use pulp::Arch;
use std::sync::Arc;

/// Difference of forces between sweeps over slack droppers at which these end, N.
const SETTLED: f64 = 1e-9;
/// Most corrections of one dropper in a sweep.
const NEWTON: usize = 20;
/// Least part of the own answer of a dropper by which corrections go.
const FLATTEST: f64 = 0.25;
/// Most sweeps over slack droppers.
const SWEEPS: usize = 500;

/// Answers of the line to forces at the end of a step of one length.
#[derive(Clone)]
pub(crate) struct Answers {
    pub(super) step: StepFactors,
    /// Answer of the tension of each dropper to the force of each other one, –, and to its bend, s²; not numbers where
    /// not yet needed.
    between_droppers: Vec<[f64; 2]>,
    /// Amplitudes and their rates by a unit force of one dropper and by a unit bend.
    products: [Aligned; 4],
}

impl Answers {
    pub fn new(modes: &Modes, h: f64) -> Self {
        Self {
            step: StepFactors::new(&modes.stiffness, &modes.damping, h),
            between_droppers: vec![[f64::NAN; 2]; modes.droppers().pow(2)],
            products: std::array::from_fn(|_| Aligned::zeros(modes.count())),
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

    /// Answer of the tension of dropper `a` to the force of dropper `b`, –, and to its bend, s²; not numbers where not
    /// yet needed.
    fn between(&self, modes: &Modes, [a, b]: [usize; 2]) -> [f64; 2] {
        self.between_droppers[a * modes.droppers() + b]
    }

    /// Finds the answer of dropper `a` to the force of dropper `b`.
    fn need(&mut self, (arch, modes): (Arch, &Modes), [a, b]: [usize; 2]) {
        let step = &self.step;
        for (product, factor) in self.products.iter_mut().zip([&step.q1, &step.v1, &step.qb, &step.vb]) {
            kernels::products(arch, modes.joint(a), factor, product);
        }
        let products = self.products.each_ref().map(|product| &**product);
        let [elongation, rate, by_bend, rate_by_bend] = kernels::dots(arch, modes.joint(b), products);
        let elongation = elongation + modes.residual_between(a, b);
        let tension = |elongation: f64, rate: f64| modes.law.stiffness * elongation + modes.law.damping * rate;
        let answer = [tension(elongation, rate), tension(by_bend, rate_by_bend)];
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
    /// Tensions of each one step before the begin of the step and at the begin, N, see [`bend`].
    courses: Vec<[f64; 2]>,
    /// Bend of the lacking force of each at the last solution, N; and the answers to it as to `lacking`.
    bends: Vec<f64>,
    deflections_by_bend: Vec<f64>,
    held_by_bend: Vec<f64>,
    between_by_bend: Vec<f64>,
    /// Tension of each at the end of the step at the last solution, N, negative for what a slack one lacks.
    ends: Vec<f64>,
    /// Change of that with the own lacking force, –, and with its bend, –.
    by_own: Vec<[f64; 2]>,
    /// True in steps that take time.
    bent: bool,
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

    /// The candidates and the second derivatives of their lacking forces in a step of `h` s, N/s².
    pub fn bends(&self, h: f64) -> impl Iterator<Item = (usize, f64)> + '_ {
        let all = self.droppers.iter().copied().zip(&self.bends);
        all.filter(|(_, bend)| **bend != 0.0)
            .map(move |(dropper, bend)| (dropper, bend / (h * h)))
    }

    /// Chooses the droppers that are candidates, with what they lacked at the end of the last step, N, and
    /// their courses.
    pub fn choose(&mut self, droppers: impl Iterator<Item = (usize, f64, [f64; 2])>) {
        self.droppers.clear();
        self.lacking.clear();
        self.courses.clear();
        self.ends.clear();
        self.bends.clear();
        for (dropper, lacking, course) in droppers {
            self.droppers.push(dropper);
            self.lacking.push(lacking);
            self.courses.push(course);
            self.ends.push(course[1]);
            self.bends.push(0.0);
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
        let h = answers.step.h;
        self.bent = h > 0.0;
        let per_step = if self.bent { 1.0 / (h * h) } else { 0.0 };
        let values = [
            &mut self.free,
            &mut self.deflections,
            &mut self.tensions,
            &mut self.held,
            &mut self.between,
            &mut self.deflections_by_bend,
            &mut self.held_by_bend,
            &mut self.between_by_bend,
        ];
        values.into_iter().for_each(Vec::clear);
        self.by_own.clear();
        for (&dropper, [elongation, rate]) in self.droppers.iter().zip(motions) {
            let spring = modes.at_rest[dropper] + law.stiffness * elongation;
            self.free.push(spring + law.damping * rate);
            pass.need((arch, modes), dropper);
            for answer in pass.by_dropper(dropper) {
                self.deflections.push(answer.deflection);
                self.deflections_by_bend.push(answer.by_bend * per_step);
                self.tensions.push(answer.tension);
            }
            let first = self.held.len();
            self.held.extend_from_slice(&self.deflections[first..]);
            pass.factored.solve(&mut self.held[first..]);
            self.held_by_bend.extend_from_slice(&self.deflections_by_bend[first..]);
            pass.factored.solve(&mut self.held_by_bend[first..]);
        }
        for &a in &self.droppers {
            for &b in &self.droppers {
                let mut answer = answers.between(modes, [a, b]);
                if answer[0].is_nan() {
                    Arc::make_mut(answers).need((arch, modes), [a, b]);
                    answer = answers.between(modes, [a, b]);
                }
                self.between.push(answer[0]);
                self.between_by_bend.push(answer[1] * per_step);
            }
        }
        for c in 0..self.droppers.len() {
            let (count, points) = (self.droppers.len(), pass.points.len());
            let (own, along) = (c * (count + 1), c * points..(c + 1) * points);
            let tensions = &self.tensions[along.clone()];
            let by_end = 1.0 - self.between[own] + dot(tensions, &self.held[along.clone()]);
            let by_bend = self.between_by_bend[own] - dot(tensions, &self.held_by_bend[along]);
            self.by_own.push([by_end, by_bend]);
        }
    }

    /// Deflection of a point of `points` by all lacking forces, m, taken away from that without them.
    pub fn deflection(&self, point: usize, points: usize) -> f64 {
        let of = |deflections: &[f64], values: &[f64]| -> f64 {
            let by_each = deflections.iter().skip(point).step_by(points).zip(values);
            by_each.map(|(deflection, value)| deflection * value).sum()
        };
        of(&self.deflections, &self.lacking) - of(&self.deflections_by_bend, &self.bends)
    }

    /// Lacking forces `p ≥ 0` with `s + p ≥ 0`, `p (s + p) = 0`, `s` the tension of a spring that may push; `forces`
    /// are those of the strips with the points held, and change with `p`.
    pub fn settle(&mut self, modes: &Modes, forces: &mut [f64]) {
        let (contacts, count) = (forces.len(), self.len());
        for _ in 0..SWEEPS {
            let mut largest = 0.0_f64;
            for (c, &dropper) in self.droppers.iter().enumerate() {
                let own = c * contacts..(c + 1) * contacts;
                let (tensions, held) = (&self.tensions[own.clone()], &self.held[own.clone()]);
                let held_by_bend = &self.held_by_bend[own];
                let of_others = c * count..(c + 1) * count;
                let between = &self.between[of_others.clone()];
                let between_by_bend = &self.between_by_bend[of_others];
                let by_droppers = dot(between, &self.lacking) - dot(between_by_bend, &self.bends);
                let spring = self.free[c] + dot(tensions, forces) - by_droppers;
                let of_rest = modes.lacks_at_rest(dropper);
                let lacks = self.lacking[c] + of_rest;
                let [by_end, by_bend] = self.by_own[c];
                let base = spring - (by_end - 1.0) * lacks - by_bend * self.bends[c];
                let [end, bend] = if self.bent {
                    let [before, begin] = self.courses[c];
                    end_of(base, self.by_own[c], |end| bend([before, begin, end]), self.ends[c])
                } else {
                    [if base < 0.0 { base / by_end } else { base }, 0.0]
                };
                let (change, bent) = ((-end).max(0.0) - lacks, bend - self.bends[c]);
                for (force, (held, by_bend)) in forces.iter_mut().zip(held.iter().zip(held_by_bend)) {
                    *force += held * change - by_bend * bent;
                }
                self.ends[c] = end;
                self.lacking[c] = (-end).max(0.0) - of_rest;
                self.bends[c] = bend;
                largest = largest.max(change.abs()).max(bent.abs());
            }
            if largest <= SETTLED {
                break;
            }
        }
    }
}

/// Tension at the end of a step, N, negative for what a slack dropper lacks, and the bend of the lacking force, N.
///
/// The tension `s` solves `g s = base + b bend(s)`, `g` the answer to a lacking force where it is negative, else 1, and
/// `b` the answer to a bend. Both sides together rise with `s`: Newton's method finds the root.
fn end_of(base: f64, [by_end, by_bend]: [f64; 2], bend: impl Fn(f64) -> [f64; 2], start: f64) -> [f64; 2] {
    let mut end = start;
    let mut of_end = bend(end);
    for _ in 0..NEWTON {
        let own = if end < 0.0 { by_end } else { 1.0 };
        let rise = (own - by_bend * of_end[1]).max(FLATTEST * own);
        let change = (base + by_bend * of_end[0] - own * end) / rise;
        end += change;
        of_end = bend(end);
        if change.abs() <= SETTLED {
            break;
        }
    }
    [end, of_end[0]]
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
