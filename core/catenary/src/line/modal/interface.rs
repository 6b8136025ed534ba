//! The line as strips see it: a contribution of forces on massless points under the strips.
use super::lacking::Lacking;
use super::modes::Modes;
use super::point::ContactPoint;
use super::slack::{Answers, Candidates};
use dynamics::modal::kernels::{self, LANES, TOGETHER};
use dynamics::unilateral::next_of;
use dynamics::{Blocks, Force, LowRank, Lu, Motion, State, StepHistory, Updates, Weights};
use pulp::Arch;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Droppers up to this far from a strip are watched in every step, m: a strip makes droppers slack within a span.
const REACH: f64 = 30.0;
/// Number of steps in which each dropper further away is watched once.
const IN_TURN: usize = 16;
/// Tension above which a watched dropper stays taut within a step, N: a step changes tensions by a few newtons.
const TAUT: f64 = 30.0;
/// Mass of a point under a strip, kg: next to none, so that accelerations at the start exist.
const MASS: f64 = 1e-6;
/// Stiffness that holds a point under a strip beyond the wire, N/m.
const HELD: f64 = 1e5;
/// Change of a deflection for slopes of forces, m.
const SLIGHT: f64 = 1e-5;
/// Frequency up to which modes are drawn, Hz: those above move wires by less than a line's width.
const DRAWN: f64 = 30.0;
/// Step factors kept: those of a step and of what is left of a communication step.
const KEPT: usize = 3;

/// The line in its modes as strips see it.
pub(super) struct Interface {
    modes: Arc<Modes>,
    arch: Arch,
    points: Vec<ContactPoint>,
    /// Amplitudes, their rates and the forces on them at the end of the last step. Single precision halves the memory
    /// that a step reads, and that is its time; deflections are good to some ten nanometres.
    q: Vec<f32>,
    v: Vec<f32>,
    r: Vec<f32>,
    /// Modal forces at the end of the next step that take back the dampers of [`Modes::borrowed`] near the strips.
    repaid: Vec<f32>,
    /// Droppers and supports whose dampers are taken back, and the forces there, N.
    repaying: Vec<(usize, f64)>,
    /// Rates of droppers and supports when last looked at, m/s; not a number where a step was left out.
    joint_rates: Vec<f64>,
    /// Force of each strip at the end of the last step, N.
    forces: Vec<f64>,
    lacking: Lacking,
    /// Deflection of the points at the end of the last step, m, and their rates, m/s.
    reached: Vec<f64>,
    rates: Vec<f64>,
    /// Deflections of modes left out at the end of the last step, m.
    residual: Vec<f64>,
    /// Tension of each dropper when last looked at, N; negative for what a slack one lacks.
    tensions: Vec<f64>,
    steps: usize,
    /// Modes up to [`DRAWN`].
    drawn: usize,
    /// Change of the forces with the deflections of the points, N/m, row by row; and what the factored matrix has.
    slope: Vec<f64>,
    assembled: Vec<f64>,
    /// Coordinates of the points, and room for a matrix between them.
    coordinates: Vec<usize>,
    scaled: Vec<f64>,
    factors: Vec<Answers>,
    step: Step,
}

/// The present step.
#[derive(Default)]
struct Step {
    h: f64,
    /// A step has begun and not ended.
    open: bool,
    /// The values below are those of the step.
    begun: bool,
    q_free: Vec<f32>,
    v_free: Vec<f32>,
    /// Room for modal forces.
    bend: Vec<f32>,
    /// Deflection of the points without forces at the end, m.
    free: Vec<f64>,
    /// Compliance of the points, m/N, row by row, and its factors.
    compliance: Vec<f64>,
    factored: Lu,
    candidates: Candidates,
    forces: Vec<f64>,
    work: Vec<f64>,
}

impl Interface {
    /// The line under `points`, with answers at the end of steps known before.
    pub fn new(modes: Arc<Modes>, factors: Vec<Answers>, points: Vec<ContactPoint>) -> Self {
        let (count, droppers, contacts) = (modes.count(), modes.droppers(), points.len());
        let mut slope = vec![0.0; contacts * contacts];
        (0..contacts).for_each(|point| slope[point * (contacts + 1)] = HELD);
        let drawn = modes
            .stiffness
            .iter()
            .take_while(|stiffness| **stiffness < (TAU * DRAWN).powi(2))
            .count();
        let mut points = points;
        for point in &mut points {
            point.take_room(count);
        }
        Self {
            arch: Arch::new(),
            q: vec![0.0; count],
            v: vec![0.0; count],
            r: vec![0.0; count],
            repaid: vec![0.0; count],
            repaying: Vec::with_capacity(modes.borrowed.len()),
            joint_rates: vec![f64::NAN; modes.borrowed.len()],
            forces: vec![0.0; contacts],
            lacking: Lacking::new(droppers),
            reached: vec![0.0; contacts],
            rates: vec![0.0; contacts],
            residual: vec![0.0; contacts],
            tensions: modes.at_rest.clone(),
            steps: 0,
            drawn: drawn.next_multiple_of(LANES).min(count),
            assembled: slope.clone(),
            coordinates: points.iter().map(|point| point.coordinate).collect(),
            scaled: slope.clone(),
            slope,
            factors,
            step: Step {
                q_free: vec![0.0; count],
                v_free: vec![0.0; count],
                bend: vec![0.0; count],
                free: vec![0.0; contacts],
                compliance: vec![0.0; contacts * contacts],
                forces: vec![0.0; contacts],
                ..Step::default()
            },
            modes,
            points,
        }
    }

    /// A coordinate of the linearised line that has a row, m.
    pub fn deflection_of(&self, coordinate: usize) -> f64 {
        self.along(coordinate, &self.q)
    }

    /// As [`Interface::deflection_of`], by modes up to [`DRAWN`]: good enough for a picture.
    pub fn drawn_deflection_of(&self, coordinate: usize) -> f64 {
        self.along(coordinate, &self.q[..self.drawn])
    }

    /// Rate of [`Interface::deflection_of`], m/s.
    pub fn rate_of(&self, coordinate: usize) -> f64 {
        self.along(coordinate, &self.v)
    }

    /// Sum at a coordinate over the first modes, which the values are of.
    fn along(&self, coordinate: usize, values: &[f32]) -> f64 {
        let row = self.modes.at(coordinate);
        row.map_or(0.0, |row| dot(self.arch, &row[..values.len()], values))
    }

    /// Kinetic and potential energy of the modes, J.
    pub fn energy_of_modes(&self) -> f64 {
        let modes = self.q.iter().zip(&self.v).zip(&self.modes.stiffness);
        let energies = modes.map(|((q, v), stiffness)| f64::from(*v).powi(2) + stiffness * f64::from(*q).powi(2));
        0.5 * energies.sum::<f64>()
    }

    /// Force that a dropper lacks, N: that of a spring that pushes.
    fn lacks(&self, dropper: usize) -> f64 {
        self.lacking.beyond_rest()[dropper] + self.modes.lacks_at_rest(dropper)
    }

    /// Number of slack droppers.
    pub fn slack_count(&self) -> usize {
        (0..self.modes.droppers())
            .filter(|&dropper| self.lacks(dropper) > 0.0)
            .count()
    }

    /// Tension of a dropper at the end of the last step, N.
    pub fn tension(&self, dropper: usize) -> f64 {
        let damper = self.modes.law.damping - self.modes.borrowed[dropper];
        (self.spring(dropper, self.motion_of(dropper), damper) + self.lacks(dropper)).max(0.0)
    }

    /// Deflection of a dropper or support by the modes, m, and its rate, m/s.
    fn motion_of(&self, joint: usize) -> [f64; 2] {
        kernels::dots(self.arch, self.modes.joint(joint), [&self.q, &self.v])
    }

    /// Force of a dropper that may push and has a damper of `damper` N·s/m, N.
    fn spring(&self, dropper: usize, [deflection, rate]: [f64; 2], damper: f64) -> f64 {
        let elongation = deflection + self.residual_elongation(dropper);
        self.modes.at_rest[dropper] + self.modes.law.stiffness * elongation + damper * rate
    }

    /// Looks at the droppers near the strips, at slack ones, and in turn at the others. Prepares the forces that take
    /// back the dampers of [`Modes::borrowed`] near the strips at the end of the next step, with rates continued in a
    /// straight line.
    fn look_at_droppers(&mut self) {
        let droppers = self.modes.droppers();
        self.repaying.clear();
        for joint in 0..self.modes.borrowed.len() {
            let own = (joint < droppers).then_some(joint);
            let x = match own {
                Some(dropper) => self.modes.dropper_x[dropper],
                None => self.modes.support_x[joint - droppers],
            };
            let near = self.points.iter().any(|point| point.on && (point.x - x).abs() < REACH);
            let in_turn = |dropper: usize| {
                self.lacks(dropper) > 0.0
                    || self.tensions[dropper] < TAUT
                    || (dropper + self.steps).is_multiple_of(IN_TURN)
                    || self.step.h == 0.0
            };
            if !near && !own.is_some_and(in_turn) {
                self.joint_rates[joint] = f64::NAN;
                continue;
            }
            let motion = self.motion_of(joint);
            if let Some(dropper) = own {
                let now = self.spring(dropper, motion, self.modes.law.damping);
                let before = std::mem::replace(&mut self.tensions[dropper], now);
                self.lacking.cross(dropper, [before, now]);
            }
            let [_, rate] = motion;
            let before = std::mem::replace(&mut self.joint_rates[joint], rate);
            let taut = own.is_none_or(|dropper| self.lacks(dropper) == 0.0);
            if near && taut && self.step.h > 0.0 {
                let ahead = if before.is_nan() { rate } else { 2.0 * rate - before };
                self.repaying.push((joint, self.modes.borrowed[joint] * ahead));
            }
        }
        self.repaid.fill(0.0);
        add_joints(self.arch, &self.modes, self.repaying.iter().copied(), &mut self.repaid);
    }

    /// Elongation of a dropper by modes left out at the end of the last step, m.
    fn residual_elongation(&self, dropper: usize) -> f64 {
        let strips = self.points.iter().zip(&self.forces).filter(|(point, _)| point.on);
        let by_strips: f64 = strips
            .map(|(point, force)| force * self.modes.residual_by_dropper(&point.columns, dropper))
            .sum();
        let by_droppers: f64 = (self.lacking.all())
            .map(|(other, lacking)| lacking * self.modes.residual_between(dropper, other))
            .sum();
        by_strips - by_droppers
    }

    /// Rates and accelerations of the points at the end of a step are those of the modes.
    pub fn follow(&self, state: &mut State) {
        for (point, rate) in self.points.iter().zip(&self.rates) {
            state.v[point.coordinate] = *rate;
            state.v_dot[point.coordinate] = 0.0;
            state.a[point.coordinate] = 0.0;
        }
    }

    /// Brings the factors of a step of `h` s to the front.
    fn choose_factors(&mut self) {
        let h = self.step.h;
        let serves = |answers: &Answers| (answers.step.h - h).abs() <= 1e-9 * h;
        match self.factors.iter().position(serves) {
            Some(at) => self.factors[..=at].rotate_right(1),
            None => {
                self.factors.insert(0, Answers::new(&self.modes, h));
                self.factors.truncate(KEPT);
            }
        }
    }

    /// Answers of the line at the end of the step without forces there, and to forces there.
    fn begin(&mut self) {
        self.step.begun = true;
        self.choose_factors();
        let arch = self.arch;
        for point in &mut self.points {
            point.expect((arch, &self.modes));
        }
        let factors = &self.factors[0].step;
        let step = &mut self.step;
        let motion = [&self.q[..], &self.v, &self.r];
        let ends = [&mut step.q_free[..], &mut step.v_free];
        kernels::free(arch, factors, motion, &self.repaid, ends);
        let (h, bend) = (step.h, &mut step.bend);
        let bends = || self.lacking.bends(&self.modes, h);
        if bends().next().is_some() {
            bend.fill(0.0);
            add_joints(arch, &self.modes, bends(), bend);
            kernels::add_bend(arch, factors, bend, [&mut step.q_free, &mut step.v_free]);
        }
        for (point, force) in self.points.iter_mut().zip(&self.forces).filter(|(point, _)| point.on) {
            point.answer((arch, factors), *force, [&mut step.q_free, &mut step.v_free]);
        }
        let contacts = self.points.len();
        for (i, point) in self.points.iter().enumerate() {
            step.free[i] = dot(arch, point.shape(), &step.q_free);
            for (j, other) in self.points.iter().enumerate() {
                let both = point.on && other.on;
                step.compliance[i * contacts + j] = if both {
                    dot(arch, point.shape(), &other.by_force[0])
                        + self.modes.residual_between_points(&point.columns, &other.columns)
                } else if i == j {
                    1.0 / HELD
                } else {
                    0.0
                };
            }
        }
        step.factored.matrix(contacts).copy_from_slice(&step.compliance);
        step.factored
            .factor()
            .expect("strips apart have independent deflections");
        let may_be_slack = |dropper: &usize| step.h == 0.0 || self.tensions[*dropper] < TAUT;
        let droppers = (0..self.modes.droppers()).filter(may_be_slack);
        step.candidates.take(
            (arch, &self.modes, &mut self.factors[0]),
            (&self.points, &step.factored),
            [&step.q_free, &step.v_free],
            droppers.map(|dropper| (dropper, self.lacking.beyond_rest()[dropper])),
        );
        self.find_slope();
    }

    /// Slope of the forces where these are as at the beginning of the step.
    fn find_slope(&mut self) {
        let contacts = self.points.len();
        let mut work = std::mem::take(&mut self.step.work);
        work.resize(3 * contacts, 0.0);
        let (base, rest) = work.split_at_mut(contacts);
        let (there, middle) = rest.split_at_mut(contacts);
        for (i, base) in base.iter_mut().enumerate() {
            let row = &self.step.compliance[i * contacts..][..contacts];
            let by_forces: f64 = row.iter().zip(&self.forces).map(|(row, force)| row * force).sum();
            *base = self.step.free[i] + by_forces - self.step.candidates.deflection(i, contacts);
        }
        self.solve(base);
        middle.copy_from_slice(&self.step.forces);
        for j in 0..contacts {
            there.copy_from_slice(base);
            there[j] += SLIGHT;
            self.solve(there);
            for (i, (force, middle)) in self.step.forces.iter().zip(&*middle).enumerate() {
                self.slope[i * contacts + j] = (force - middle) / SLIGHT;
            }
        }
        self.step.work = work;
    }

    /// Forces of the strips on the line for deflections `w` of the points at the end of the step.
    fn solve(&mut self, w: &[f64]) {
        let (step, contacts) = (&mut self.step, self.points.len());
        for (i, (force, w)) in step.forces.iter_mut().zip(w).enumerate() {
            *force = w - step.free[i] + step.candidates.deflection(i, contacts);
        }
        step.factored.solve(&mut step.forces);
        step.candidates.settle(&self.modes, &self.factors[0], &mut step.forces);
    }

    /// Forces of the strips at a motion: `true` within a step, where they are solved for; else those of the last step
    /// with their slope.
    fn find(&mut self, motion: &Motion<'_>) -> bool {
        if self.step.open && !self.step.begun {
            self.begin();
        }
        let contacts = self.points.len();
        let mut w = std::mem::take(&mut self.step.work);
        w.clear();
        w.extend(self.points.iter().map(|point| motion.q[point.coordinate]));
        let open = self.step.open;
        if open {
            self.solve(&w);
        } else {
            for i in 0..contacts {
                let change: f64 = (0..contacts)
                    .map(|j| self.slope[i * contacts + j] * (w[j] - self.reached[j]))
                    .sum();
                self.step.forces[i] = self.forces[i] + change;
            }
        }
        self.step.work = w;
        open
    }

    /// `weight` times a matrix between the points, and their coordinates.
    fn weighted(&mut self, weight: f64, matrix: impl Fn(&Self, usize) -> f64) -> (&[usize], &[f64]) {
        for entry in 0..self.slope.len() {
            self.scaled[entry] = weight * matrix(self, entry);
        }
        (&self.coordinates, &self.scaled)
    }
}

/// `Σ a b`.
fn dot(arch: Arch, a: &[f32], b: &[f32]) -> f64 {
    let [sum] = kernels::dots(arch, a, [b]);
    sum
}

/// Adds the modal forces of forces along droppers and supports, N.
fn add_joints(arch: Arch, modes: &Modes, joints: impl Iterator<Item = (usize, f64)>, forces: &mut [f32]) {
    let mut rows = [(0.0, &[][..]); TOGETHER];
    let mut count = 0;
    for (joint, force) in joints {
        rows[count] = (force as f32, modes.joint(joint));
        count += 1;
        if count == TOGETHER {
            kernels::add(arch, &rows, forces);
            count = 0;
        }
    }
    kernels::add(arch, &rows[..count], forces);
}

impl Force for Interface {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.find(motion);
        for (point, value) in self.points.iter().zip(&self.step.forces) {
            force[point.coordinate] -= value;
        }
    }

    fn add_tangent(&mut self, _: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        self.assembled.clone_from(&self.slope);
        let (indices, values) = self.weighted(weights.q, |own, entry| own.slope[entry]);
        blocks.add(indices, indices, values);
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        for point in &self.points {
            blocks.add(&[point.coordinate], &[point.coordinate], &[MASS]);
        }
    }

    fn low_rank(&mut self) -> Option<&mut dyn LowRank> {
        Some(self)
    }

    fn step_history(&mut self) -> Option<&mut dyn StepHistory> {
        Some(self)
    }
}

impl LowRank for Interface {
    fn push_updates(&mut self, _: &Motion<'_>, weights: Weights, updates: &mut Updates) {
        if self.slope != self.assembled {
            let (indices, values) = self.weighted(weights.q, |own, entry| own.slope[entry] - own.assembled[entry]);
            updates.dense(0, indices, values);
        }
    }
}

impl StepHistory for Interface {
    fn begin_step(&mut self, _: &Motion<'_>, h: f64) {
        self.step.h = h;
        self.step.open = true;
        self.step.begun = false;
    }

    fn end_step(&mut self, motion: &Motion<'_>) {
        if !self.find(motion) {
            return;
        }
        let (arch, h) = (self.arch, self.step.h);
        self.forces.copy_from_slice(&self.step.forces);
        self.lacking.end_step(h, self.step.candidates.lacking());
        self.r.fill(0.0);
        let lacking = self.lacking.all().map(|(dropper, lacking)| (dropper, -lacking));
        add_joints(arch, &self.modes, lacking, &mut self.r);
        let known = [&self.repaid[..], &self.step.q_free, &self.step.v_free];
        let ends = [&mut self.r[..], &mut self.q, &mut self.v];
        kernels::finish(arch, &self.factors[0].step, known, ends);
        for (point, force) in self.points.iter().zip(&self.forces).filter(|(point, _)| point.on) {
            let [by_q, by_v] = &point.by_force;
            let ends = [&mut self.r[..], &mut self.q, &mut self.v];
            kernels::add_answer(arch, *force as f32, [point.shape(), by_q, by_v], ends);
        }
        for (i, point) in self.points.iter_mut().enumerate() {
            self.reached[i] = motion.q[point.coordinate];
            let [of_modes, rate] = kernels::dots(arch, point.shape(), [&self.q, &self.v]);
            let residual = if point.on { self.reached[i] - of_modes } else { 0.0 };
            let moved = point.moved();
            self.rates[i] = if h > 0.0 && moved.is_finite() {
                let along = dot(arch, point.slope(), &self.q) * moved;
                rate + (along + residual - self.residual[i]) / h
            } else {
                0.0
            };
            self.residual[i] = residual;
            point.s[0] = point.s[1];
        }
        self.steps += usize::from(h > 0.0);
        self.step.open = false;
        self.look_at_droppers();
    }

    /// The slope is all that a step changes before its end.
    fn save_for_step(&self, out: &mut Vec<f64>) {
        out.extend_from_slice(&self.slope);
    }

    fn restore_after_step(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        for slope in &mut self.slope {
            *slope = next_of(values);
        }
        self.step.open = false;
    }

    fn save(&self, out: &mut Vec<f64>) {
        out.push(self.steps as f64);
        out.extend(self.points.iter().map(|point| point.s[0]));
        let all = [
            &self.forces,
            &self.tensions,
            &self.reached,
            &self.rates,
            &self.residual,
            &self.slope,
            &self.joint_rates,
        ];
        all.iter().for_each(|values| out.extend_from_slice(values));
        self.lacking.save(out);
        let modes = [&self.q, &self.v, &self.r, &self.repaid];
        out.extend(modes.into_iter().flatten().copied().map(f64::from));
    }

    fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        let mut next = || next_of(values);
        self.steps = next() as usize;
        self.points.iter_mut().for_each(|point| point.s[0] = next());
        let all = [
            &mut self.forces,
            &mut self.tensions,
            &mut self.reached,
            &mut self.rates,
            &mut self.residual,
            &mut self.slope,
            &mut self.joint_rates,
        ];
        for values in all {
            values.iter_mut().for_each(|value| *value = next());
        }
        self.lacking.restore(values);
        let modes = [&mut self.q, &mut self.v, &mut self.r, &mut self.repaid];
        modes
            .into_iter()
            .flatten()
            .for_each(|value| *value = next_of(values) as f32);
        self.step.open = false;
    }
}
