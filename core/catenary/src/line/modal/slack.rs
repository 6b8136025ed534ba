//! Droppers that may be slack at the end of a step.
use super::modes::Modes;
use super::pass::Pass;
use super::stretch::taking_back;
use dynamics::Lu;
use dynamics::modal::{Aligned, StepFactors, bend, kernels};
use pulp::Arch;
use std::ops::Range;
use std::sync::Arc;

/// Difference of forces between sweeps over slack droppers at which these end, N.
const SETTLED: f64 = 1e-9;
/// Most corrections of one dropper in a sweep.
const NEWTON: usize = 20;
/// Correction that is the last one, N: what is left after it goes with its square.
const LAST: f64 = 1e-6;
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
    /// Factors of the matrix that gives forces which take dampers along wires back at the end of the step from the
    /// rates without these, m/(N s).
    pub(super) stretching: Lu,
    /// Amplitudes and their rates by a unit force of one dropper and by a unit bend.
    products: [Aligned; 4],
}

impl Answers {
    pub fn new(modes: &Modes, h: f64) -> Self {
        let step = StepFactors::new(&modes.stiffness, &modes.damping, h);
        Self {
            stretching: taking_back(modes, &step),
            step,
            between_droppers: vec![[f64::NAN; 2]; modes.droppers().pow(2)],
            products: std::array::from_fn(|_| Aligned::zeros(modes.count())),
        }
    }

    /// Answers between all droppers in a step of 0 s, which leads to rest.
    pub fn at_rest(modes: &Modes) -> Self {
        let (mut answers, arch, droppers) = (Self::new(modes, 0.0), Arch::new(), modes.droppers());
        (0..droppers).for_each(|dropper| answers.need((arch, modes), dropper, dropper..droppers));
        answers
    }

    /// Tension of a dropper by each newton that it lacks, with its spring in the modes, –.
    pub fn by_own(&mut self, modes: &Modes, dropper: usize) -> f64 {
        self.need((Arch::new(), modes), dropper, dropper..dropper + 1);
        let [answer, _] = self.between(modes, [dropper; 2]);
        1.0 - answer
    }

    /// Answer of the tension of dropper `a` to the force of dropper `b`, –, and to its bend, s²; not numbers where not
    /// yet needed.
    fn between(&self, modes: &Modes, [a, b]: [usize; 2]) -> [f64; 2] {
        self.between_droppers[a * modes.droppers() + b]
    }

    /// Finds the answers of a dropper to the forces of `others`.
    fn need(&mut self, (arch, modes): (Arch, &Modes), dropper: usize, others: Range<usize>) {
        let step = &self.step;
        for (product, factor) in self.products.iter_mut().zip([&step.q1, &step.v1, &step.qb, &step.vb]) {
            kernels::products(arch, modes.joint(dropper), factor, product);
        }
        let products = self.products.each_ref().map(|product| &**product);
        let tension = |elongation: f64, rate: f64| modes.law.stiffness * elongation + modes.law.damping * rate;
        let row = |at| modes.joint(others.start + at);
        kernels::dots_of_many(arch, (others.len(), row), [products], |at, [sums]| {
            let other = others.start + at;
            let [elongation, rate, by_bend, rate_by_bend] = sums;
            let elongation = elongation + modes.residual_between(dropper, other);
            let answer = [tension(elongation, rate), tension(by_bend, rate_by_bend)];
            // Both ways the same, as the modes are.
            self.between_droppers[dropper * modes.droppers() + other] = answer;
            self.between_droppers[other * modes.droppers() + dropper] = answer;
        });
    }
}

/// Change of the known force that pushes a dropper apart: less tension than expected, less push.
#[derive(Clone, Copy, Default)]
pub(super) struct Yielding {
    /// Force for each newton of tension less, –.
    pub by_tension: f64,
    /// Tension that the known force expects, N.
    pub expected: f64,
}

impl Yielding {
    /// Force that pulls at a tension of a spring, N, negative for a slack dropper.
    pub fn force(self, tension: f64) -> f64 {
        self.by_tension * (self.expected - tension.max(0.0))
    }
}

/// Answers to a unit of something that each candidate lacks, candidate after candidate.
#[derive(Default)]
struct Response {
    /// Deflection of each point, m.
    deflections: Vec<f64>,
    /// Force on each strip that is left with the points held, N.
    held: Vec<f64>,
    /// Tension of each candidate, N.
    between: Vec<f64>,
}

impl Response {
    fn clear(&mut self) {
        let all = [&mut self.deflections, &mut self.held, &mut self.between];
        all.into_iter().for_each(Vec::clear);
    }

    /// Finds the forces on the strips of the last candidate.
    fn hold(&mut self, pass: &Pass) {
        let first = self.held.len();
        self.held.extend_from_slice(&self.deflections[first..]);
        pass.factored.solve(&mut self.held[first..]);
    }

    /// Deflection of a point of `points` by the `values` of all candidates, m.
    fn deflection(&self, point: usize, points: usize, values: &[f64]) -> f64 {
        let by_each = self.deflections.chunks_exact(points).zip(values);
        by_each.map(|(deflections, value)| deflections[point] * value).sum()
    }
}

/// Droppers that may be slack at the end of the present step, with their part in it.
#[derive(Default)]
pub(super) struct Candidates {
    droppers: Vec<usize>,
    /// Tension of each at the end of the step without forces there, N.
    free: Vec<f64>,
    /// Tension by a unit force of each strip, –; candidate after candidate.
    tensions: Vec<f64>,
    /// Answers to a lacking force of 1 N, and to a bend of it of 1 N.
    by_force: Response,
    by_bend: Response,
    /// Lacking force of each beyond that at rest at the last solution, N.
    lacking: Vec<f64>,
    /// Tensions of each one step before the begin of the step and at the begin, N, see [`bend`].
    courses: Vec<[f64; 2]>,
    /// Force of each that pushes it apart at the end of the step, N, which is known.
    pushes: Vec<f64>,
    /// Change of that with the tension there.
    yielding: Vec<Yielding>,
    /// Bend of the lacking force of each at the last solution, N.
    bends: Vec<f64>,
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

    /// The candidates and their last lacking forces beyond what they yield, N.
    pub fn lacking(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let yielded = self.yielded().map(|(_, yielded)| yielded);
        let all = self.droppers.iter().zip(&self.lacking).zip(yielded);
        all.map(|((dropper, lacking), yielded)| (*dropper, lacking - yielded))
    }

    /// The candidates and what they yielded last, N.
    pub fn yielded(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let all = self.ends().zip(&self.yielding);
        all.map(|((dropper, end), yielding)| (dropper, yielding.force(end)))
    }

    /// The candidates and their last tensions, N, negative for what slack ones lack.
    pub fn ends(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.droppers.iter().copied().zip(self.ends.iter().copied())
    }

    /// The candidates and the second derivatives of their lacking forces in a step of `h` s, N/s².
    pub fn bends(&self, h: f64) -> impl Iterator<Item = (usize, f64)> + '_ {
        let all = self.droppers.iter().copied().zip(&self.bends);
        all.filter(|(_, bend)| **bend != 0.0)
            .map(move |(dropper, bend)| (dropper, bend / (h * h)))
    }

    /// Chooses the droppers that are candidates, with what they lacked at the end of the last step, N,
    /// their courses, and the forces that push them apart, N, with the change of these.
    pub fn choose(&mut self, droppers: impl Iterator<Item = (usize, f64, [f64; 2], (f64, Yielding))>) {
        self.droppers.clear();
        self.lacking.clear();
        self.courses.clear();
        self.pushes.clear();
        self.yielding.clear();
        self.ends.clear();
        self.bends.clear();
        for (dropper, lacking, course, (push, yielding)) in droppers {
            self.droppers.push(dropper);
            self.lacking.push(lacking);
            self.courses.push(course);
            self.pushes.push(push);
            self.yielding.push(yielding);
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
        motions: &[[f64; 2]],
    ) {
        let law = &modes.law;
        let h = answers.step.h;
        self.bent = h > 0.0;
        let per_step = if self.bent { 1.0 / (h * h) } else { 0.0 };
        self.free.clear();
        self.tensions.clear();
        self.by_own.clear();
        let (by_force, by_bend) = (&mut self.by_force, &mut self.by_bend);
        by_force.clear();
        by_bend.clear();
        let droppers = self.droppers.iter().zip(&self.pushes);
        for ((&dropper, push), &[elongation, rate]) in droppers.zip(motions) {
            let spring = modes.at_rest[dropper] + law.stiffness * elongation;
            self.free.push(spring + law.damping * rate - push);
            pass.need((arch, modes, &answers.step), dropper);
            for answer in pass.by_dropper(dropper) {
                by_force.deflections.push(answer.deflection);
                by_bend.deflections.push(answer.by_bend * per_step);
                self.tensions.push(answer.tension);
            }
            by_force.hold(pass);
            by_bend.hold(pass);
        }
        for &a in &self.droppers {
            for &b in &self.droppers {
                let mut answer = answers.between(modes, [a, b]);
                if answer[0].is_nan() {
                    Arc::make_mut(answers).need((arch, modes), a, b..b + 1);
                    answer = answers.between(modes, [a, b]);
                }
                by_force.between.push(answer[0]);
                by_bend.between.push(answer[1] * per_step);
            }
        }
        let (count, points) = (self.droppers.len(), pass.points.len());
        for c in 0..count {
            let (own, along) = (c * (count + 1), c * points..(c + 1) * points);
            let tensions = &self.tensions[along.clone()];
            self.by_own.push([
                1.0 - by_force.between[own] + dot(tensions, &by_force.held[along.clone()]),
                by_bend.between[own] - dot(tensions, &by_bend.held[along]),
            ]);
        }
    }

    /// Deflection of a point of `points` by all lacking forces, m, taken away from that without them.
    pub fn deflection(&self, point: usize, points: usize) -> f64 {
        self.by_force.deflection(point, points, &self.lacking) - self.by_bend.deflection(point, points, &self.bends)
    }

    /// Lacking forces `p ≥ 0` with `s + p ≥ 0`, `p (s + p) = 0`, `s` the tension of a spring that may push, and beside
    /// these what droppers yield; `forces` are those of the strips with the points held, and change with both.
    pub fn settle(&mut self, modes: &Modes, forces: &mut [f64]) {
        let (contacts, count) = (forces.len(), self.len());
        for _ in 0..SWEEPS {
            let mut largest = 0.0_f64;
            for (c, &dropper) in self.droppers.iter().enumerate() {
                let own = c * contacts..(c + 1) * contacts;
                let held = self.by_force.held[own.clone()]
                    .iter()
                    .zip(&self.by_bend.held[own.clone()]);
                let [by_force, by_bend] = [&self.by_force, &self.by_bend].map(|by| &by.between[c * count..][..count]);
                let by_droppers = dot(by_force, &self.lacking) - dot(by_bend, &self.bends);
                let spring = self.free[c] + dot(&self.tensions[own], forces) - by_droppers;
                let of_rest = modes.lacks_at_rest(dropper);
                let lacks = self.lacking[c] + of_rest;
                let [by_end, by_bend] = self.by_own[c];
                let base = spring - (by_end - 1.0) * lacks - by_bend * self.bends[c];
                let yielding = self.yielding[c];
                let [end, bend] = if self.bent {
                    let [before, begin] = self.courses[c];
                    let bend = |end| bend([before, begin, end]);
                    end_of((base, self.by_own[c]), yielding, bend, self.ends[c])
                } else {
                    end_of((base, [by_end, 0.0]), yielding, |_| [0.0; 2], self.ends[c])
                };
                let lacks_now = (-end).max(0.0) + yielding.force(end);
                let (change, bent) = (lacks_now - lacks, bend - self.bends[c]);
                for (force, (held, by_bend)) in forces.iter_mut().zip(held) {
                    *force += held * change - by_bend * bent;
                }
                self.ends[c] = end;
                self.lacking[c] = lacks_now - of_rest;
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
/// The tension `s` solves `g s = base + b bend(s) + g r` where it is negative, `g` the answer to a force of the
/// dropper, `b` that to a bend and `r` what a slack dropper yields, and else `(1 + g y) s = base + b bend(s) + g r`,
/// `y` the change of what it yields. Both sides together rise with `s`: Newton's method finds the root.
fn end_of(
    (base, [by_end, by_bend]): (f64, [f64; 2]),
    yielding: Yielding,
    bend: impl Fn(f64) -> [f64; 2],
    start: f64,
) -> [f64; 2] {
    let base = base + by_end * yielding.force(0.0);
    let taut = 1.0 + by_end * yielding.by_tension;
    // Most stay taut.
    let mut end = if base > 0.0 { base / taut } else { start };
    let mut of_end = bend(end);
    for _ in 0..NEWTON {
        let own = if end < 0.0 { by_end } else { taut };
        let rise = (own - by_bend * of_end[1]).max(FLATTEST * own);
        let change = (base + by_bend * of_end[0] - own * end) / rise;
        end += change;
        of_end = bend(end);
        if change.abs() <= LAST {
            break;
        }
    }
    [end, of_end[0]]
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tension `s + p` with the force `p` that a dropper yields is that of a spring which gives way by `g`.
    #[test]
    fn a_dropper_that_yields_has_the_tension_of_both_laws() {
        let yielding = Yielding {
            by_tension: 4.0,
            expected: 50.0,
        };
        let own = 0.2;
        for base in [80.0, 12.0, -39.0, -60.0] {
            let [end, bend] = end_of((base, [own, 0.0]), yielding, |_| [0.0; 2], 1.0);
            let lacking = (-end).max(0.0) + yielding.force(end);
            let tension = base + own * lacking;
            assert!(
                (tension - end.max(0.0)).abs() < 1e-9,
                "{base} N: {tension} N and {end} N"
            );
            assert_eq!((end < 0.0, bend), (base < -40.0, 0.0));
        }
    }
}
