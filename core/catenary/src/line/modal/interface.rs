//! The line as strips see it: a contribution of forces on massless points under the strips.
use super::creep::{Creep, Creeping};
use super::curve::Place;
use super::lacking::Lacking;
use super::lane::Lane;
use super::modes::Modes;
use super::pass::HELD;
use super::slack::Yielding;
use dynamics::unilateral::next_of;
use dynamics::{Blocks, Force, LowRank, Motion, State, StepHistory, Updates, Weights};
use std::sync::Arc;

/// Droppers up to this far from a strip are watched in every step, m.
const REACH: f64 = 30.0;
/// Part of it within which the creep of a dropper goes over from all modes to slow ones, m.
const FADING: f64 = 15.0;
/// Way from a strip within which wires swing so far that droppers go slack, m: two spans behind it.
const SWING: f64 = 100.0;
/// Time in which a dropper there is watched once, s: it goes slack in some ten milliseconds.
const OFTEN: f64 = 8e-3;
/// Number of steps in which each dropper further away is watched once.
const IN_TURN: usize = 32;
/// Tension below which any dropper is watched in every step, N.
const LOOSE: f64 = 40.0;
/// Tension above which a dropper that was watched stays taut within a step, N: a millisecond takes up to ten newtons.
const TAUT: f64 = 30.0;
/// Largest ratio of a step to the last one over which a force goes on as in that one: the change over a much shorter
/// step is rounding.
const LONGER: f64 = 2.0;
/// Mass of a point under a strip, kg: next to none, so that accelerations at the start exist.
const MASS: f64 = 1e-6;
/// Change of a deflection for slopes of forces, m.
const SLIGHT: f64 = 1e-6;
/// Time in which the creep of a dropper far from strips goes on once, s: four times in a period of the fastest mode
/// that feels it.
const TURN: f64 = 0.016;
/// Reason why the lane is there.
const HERE: &str = "amplitudes are away only while they are moved on";

/// A point under a strip.
pub(super) struct Contact {
    /// Coordinate of its deflection.
    coordinate: usize,
    place: Place,
    /// Parameter on the wire at the end of the last step, m.
    s: f64,
}

impl Contact {
    /// A point with its coordinate.
    pub fn new(coordinate: usize, place: Place) -> Self {
        Self {
            coordinate,
            place,
            s: f64::NAN,
        }
    }
}

/// The line in its modes as strips see it.
pub(super) struct Interface {
    modes: Arc<Modes>,
    /// The amplitudes; away only while they are moved on.
    lane: Option<Box<Lane>>,
    points: Vec<Contact>,
    /// Rates of droppers and supports near the strips at the end of the last step, m/s; else not numbers.
    joint_rates: Vec<f64>,
    /// Force of each strip at the end of the last step, N, and at the end of the one before.
    forces: Vec<f64>,
    forces_before: Vec<f64>,
    /// Length of the last step, s; infinite after a step to rest.
    last_h: f64,
    lacking: Lacking,
    creep: Option<Creep>,
    /// Deflection of the points at the end of the last step, m, and their rates, m/s.
    reached: Vec<f64>,
    rates: Vec<f64>,
    /// Deflections of modes left out at the end of the last step, m.
    residual: Vec<f64>,
    steps: usize,
    /// Droppers that are not near a strip: those whose turn it is, and loose ones.
    in_turn: Vec<usize>,
    loose: Vec<usize>,
    /// Change of the forces with the deflections of the points, N/m, row by row; and what the factored matrix has.
    slope: Vec<f64>,
    assembled: Vec<f64>,
    /// Coordinates of the points, and room for a matrix between them.
    coordinates: Vec<usize>,
    scaled: Vec<f64>,
    step: Step,
}

/// The present step.
#[derive(Default)]
struct Step {
    h: f64,
    /// A step has begun and not ended.
    open: bool,
    /// The lane has made its first half.
    begun: bool,
    forces: Vec<f64>,
    /// The forces and what droppers lack are solved for the deflections `at` of the points, m.
    solved: bool,
    at: Vec<f64>,
    work: Vec<f64>,
}

impl Interface {
    /// The line under `points`.
    pub fn new(lane: Lane, points: Vec<Contact>, creeping: Option<Creeping>) -> Self {
        let (modes, contacts) = (Arc::clone(&lane.modes), points.len());
        let mut slope = vec![0.0; contacts * contacts];
        (0..contacts).for_each(|point| slope[point * (contacts + 1)] = HELD);
        Self {
            joint_rates: vec![f64::NAN; modes.borrowed.len()],
            forces: vec![0.0; contacts],
            forces_before: vec![0.0; contacts],
            last_h: f64::INFINITY,
            lacking: Lacking::new(&modes.at_rest),
            creep: creeping.and_then(|creeping| Creep::new(&modes, creeping)),
            reached: vec![0.0; contacts],
            rates: vec![0.0; contacts],
            residual: vec![0.0; contacts],
            steps: 0,
            in_turn: Vec::with_capacity(modes.droppers()),
            loose: Vec::with_capacity(modes.droppers()),
            assembled: slope.clone(),
            coordinates: points.iter().map(|point| point.coordinate).collect(),
            scaled: slope.clone(),
            slope,
            step: Step {
                forces: vec![0.0; contacts],
                ..Step::default()
            },
            lane: Some(Box::new(lane)),
            modes,
            points,
        }
    }

    fn lane(&self) -> &Lane {
        self.lane.as_deref().expect(HERE)
    }

    fn lane_mut(&mut self) -> &mut Lane {
        self.lane.as_deref_mut().expect(HERE)
    }

    /// Moves the lane on by a half of a step.
    fn move_on(&mut self, half: impl FnOnce(Box<Lane>) -> Box<Lane>) {
        self.lane = self.lane.take().map(half);
    }

    /// Coordinate of the linearised line that has a row at a place along the track, m: by slow modes far from strips,
    /// where others move wires by a tenth of a millimetre at most.
    pub fn deflection_of(&self, coordinate: usize, x: f64) -> f64 {
        if self.lane().way(x) < SWING {
            return self.lane().along(coordinate, &self.lane().q);
        }
        self.drawn_deflection_of(coordinate)
    }

    /// The same by slow modes: good enough for a picture.
    pub fn drawn_deflection_of(&self, coordinate: usize) -> f64 {
        self.lane().along(coordinate, &self.lane().q[..self.modes.slow])
    }

    /// Rate of [`Interface::deflection_of`], m/s.
    pub fn rate_of(&self, coordinate: usize) -> f64 {
        self.lane().along(coordinate, &self.lane().v)
    }

    /// Kinetic and potential energy of the modes, J.
    pub fn energy_of_modes(&self) -> f64 {
        let modes = self.lane().q.iter().zip(&*self.lane().v).zip(&self.modes.stiffness);
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
        if let Some(tension) = self.creep.as_ref().and_then(|creep| creep.tension(dropper)) {
            return tension;
        }
        let damper = self.modes.law.damping - self.modes.borrowed[dropper];
        (self.spring(dropper, self.lane().motion_of(dropper), damper) + self.lacks(dropper)).max(0.0)
    }

    /// Force of a dropper that may push and has a damper of `damper` N·s/m, N.
    fn spring(&self, dropper: usize, [deflection, rate]: [f64; 2], damper: f64) -> f64 {
        let elongation = deflection + self.residual_elongation(dropper);
        self.modes.at_rest[dropper] + self.modes.law.stiffness * elongation + damper * rate
    }

    /// Chooses what to look at: droppers and supports near the strips, droppers whose turn it is, and loose ones.
    fn choose_watched(&mut self) {
        let lane = self.lane.as_deref_mut().expect(HERE);
        let mut watched = std::mem::take(&mut lane.watched);
        let way = |x: f64| lane.way(x);
        let often = (OFTEN / self.step.h).clamp(1.0, IN_TURN as f64) as usize;
        let all = self.step.h == 0.0;
        // Turns of the coming dropper, counted on.
        let mut turns = [often, IN_TURN].map(|every| self.steps % every);
        watched.clear();
        self.in_turn.clear();
        self.loose.clear();
        for (dropper, x) in self.modes.dropper_x.iter().enumerate() {
            let [is_often, is_seldom] = turns.map(|turn| turn == 0);
            turns = [
                if turns[0] + 1 == often { 0 } else { turns[0] + 1 },
                (turns[1] + 1) % IN_TURN,
            ];
            let way = way(*x);
            if let Some(creep) = &mut self.creep {
                creep.share(dropper, ((REACH - way) / FADING).clamp(0.0, 1.0));
            }
            if way < REACH {
                watched.push(dropper);
                continue;
            }
            self.joint_rates[dropper] = f64::NAN;
            // Those that creep far away are looked at by slow modes.
            let in_turn = all
                || if way < SWING {
                    is_often
                } else {
                    is_seldom && self.creep.is_none()
                };
            if in_turn {
                self.in_turn.push(dropper);
            }
            if self.lacking.tension(dropper) < LOOSE {
                self.loose.push(dropper);
            } else if !in_turn {
                self.lacking.leave_out(dropper);
            }
        }
        for (joint, x) in (self.modes.droppers()..).zip(&self.modes.support_x) {
            if way(*x) < REACH {
                watched.push(joint);
            } else {
                self.joint_rates[joint] = f64::NAN;
            }
        }
        let near = watched.len();
        watched.extend_from_slice(&self.in_turn);
        let in_turn = watched.len();
        watched.extend_from_slice(&self.loose);
        let lane = self.lane_mut();
        (lane.watched, lane.near, lane.in_turn) = (watched, near, in_turn);
    }

    /// Looks at the chosen droppers and supports. Prepares the forces near the strips at the end of the next step:
    /// those that take back the dampers of [`Modes::borrowed`], with rates continued in a straight line, and those that
    /// push rods apart.
    fn look_at_watched(&mut self) {
        let mut repaying = std::mem::take(&mut self.lane_mut().repaying);
        repaying.clear();
        if let Some(creep) = &mut self.creep {
            creep.begin(self.step.h);
            if self.step.h == 0.0 {
                let lane = self.lane.as_deref().expect(HERE);
                lane.candidates
                    .ends()
                    .for_each(|(dropper, end)| creep.settle(dropper, end.max(0.0)));
            }
        }
        for at in 0..self.lane().watched.len() {
            let (joint, motion) = (self.lane().watched[at], self.lane().motions[at]);
            let own = (joint < self.modes.droppers()).then_some(joint);
            // Loose droppers whose turn it is are there twice, the second time with their rates.
            let again = at >= self.lane().near && at < self.lane().in_turn && self.loose.binary_search(&joint).is_ok();
            if let Some(dropper) = own.filter(|_| !again) {
                let push = self.creep.as_ref();
                let push = push.map_or(0.0, |creep| creep.push(dropper) + creep.lost(dropper));
                let tension = self.spring(dropper, motion, self.modes.law.damping) - push;
                self.lacking.look_at(dropper, tension);
            }
            if at >= self.lane().near {
                continue;
            }
            if let (Some(dropper), Some(creep)) = (own, &mut self.creep) {
                if self.step.h > 0.0 {
                    let own = self.lacking.tension(dropper);
                    let spring = own + creep.push(dropper) - self.modes.law.damping * motion[1];
                    creep.near(dropper, [own, spring], self.step.h);
                }
                repaying.push((joint, creep.push(dropper)));
                continue;
            }
            let [_, rate] = motion;
            let before = std::mem::replace(&mut self.joint_rates[joint], rate);
            let taut = own.is_none_or(|dropper| self.lacks(dropper) == 0.0);
            if self.step.h > 0.0 {
                let ahead = if before.is_nan() { rate } else { 2.0 * rate - before };
                let damper = if taut { self.modes.borrowed[joint] } else { 0.0 };
                repaying.push((joint, damper * ahead));
            }
        }
        self.lane_mut().repaying = repaying;
        self.creep_far_away();
    }

    /// Goes on with droppers far from strips whose turn it is, and tells slow modes what has changed.
    fn creep_far_away(&mut self) {
        let Some(creep) = &mut self.creep else { return };
        let lane = self.lane.as_deref_mut().expect(HERE);
        if self.step.h > 0.0 {
            let every = (TURN / self.step.h).clamp(1.0, IN_TURN as f64) as usize;
            let each = self.modes.droppers().div_ceil(every);
            let first = (self.steps % every * each).min(self.modes.droppers());
            lane.find_elongations(first..(first + each).min(self.modes.droppers()));
            let near = &lane.watched[..lane.near];
            for (dropper, elongation) in (first..).zip(&lane.elongations) {
                if near.binary_search(&dropper).is_ok() {
                    continue;
                }
                let tension = creep.far(dropper, *elongation);
                if self.lacking.is_left_out(dropper) {
                    self.lacking.look_at(dropper, tension);
                }
            }
        }
        lane.push_slow_modes(creep.changes());
    }

    /// Elongation of a dropper by modes left out at the end of the last step, m.
    fn residual_elongation(&self, dropper: usize) -> f64 {
        let points = self.lane().pass().map_or(&[][..], |pass| &pass.points);
        let strips = points.iter().zip(&self.forces).filter(|(point, _)| point.on);
        let by_strips: f64 = strips
            .map(|(point, force)| force * point.residual_of_dropper(&self.modes, dropper))
            .sum();
        let by_droppers =
            (self.lane().lacking.iter()).map(|(other, force)| force * self.modes.residual_between(dropper, *other));
        by_strips + by_droppers.sum::<f64>()
    }

    /// Rates and accelerations of the points at the end of a step are those of the modes.
    pub fn follow(&self, state: &mut State) {
        for (point, rate) in self.points.iter().zip(&self.rates) {
            state.v[point.coordinate] = *rate;
            state.v_dot[point.coordinate] = 0.0;
            state.a[point.coordinate] = 0.0;
        }
    }

    /// Answers of the line at the end of the step without forces there, and to forces there.
    fn begin(&mut self) {
        self.step.begun = true;
        self.step.solved = false;
        let (h, modes) = (self.step.h, &self.modes);
        let lane = self.lane.as_deref_mut().expect(HERE);
        lane.h = h;
        for (place, point) in lane.places.iter_mut().zip(&self.points) {
            *place = [point.s, point.place.get()];
        }
        let (ratio, as_long) = ((h / self.last_h).min(LONGER), (h - self.last_h).abs() <= 1e-9 * h);
        let forces = self.forces.iter().zip(&self.forces_before);
        for (known, (force, before)) in lane.known_forces.iter_mut().zip(forces) {
            *known = [force - ratio * (force - before), *force];
        }
        if let Some(creep) = self.creep.as_mut().filter(|_| h == 0.0) {
            creep.begin_anew();
            lane.repaying.clear();
            lane.slow_forces[0].fill(0.0);
        }
        if let Some(creep) = self.creep.as_mut().filter(|_| h > 0.0 && !as_long) {
            let droppers = lane.repaying.iter_mut().filter(|(joint, _)| *joint < modes.droppers());
            for (dropper, push) in droppers {
                creep.expect_other(*dropper, h);
                *push = creep.push(*dropper);
            }
        }
        let lacking = &self.lacking;
        let creep = self.creep.as_ref();
        let push = |dropper: usize| creep.map_or(0.0, |creep| creep.push(dropper));
        let yielding = |dropper: usize| creep.map_or_else(Yielding::default, |creep| creep.yielding(dropper, h));
        let candidate = |dropper: usize| {
            let yielding = yielding(dropper);
            let may_be_slack = h == 0.0 || lacking.tension(dropper) < TAUT;
            (may_be_slack || yielding.by_tension != 0.0).then(|| {
                let (course, push) = (lacking.course(dropper, as_long), (push(dropper), yielding));
                (dropper, lacking.beyond_rest()[dropper], course, push)
            })
        };
        lane.candidates.choose((0..modes.droppers()).filter_map(candidate));
        self.move_on(Lane::begin);
    }

    /// Finds the slope of the forces at a motion within a step: a dropper that goes slack or taut changes it.
    fn find_slope(&mut self, motion: &Motion<'_>) {
        if !self.find(motion) {
            return;
        }
        let contacts = self.points.len();
        let mut work = std::mem::take(&mut self.step.work);
        work.resize(3 * contacts, 0.0);
        let (here, rest) = work.split_at_mut(contacts);
        let (there, forces) = rest.split_at_mut(contacts);
        forces.copy_from_slice(&self.step.forces);
        for j in 0..contacts {
            there.copy_from_slice(here);
            there[j] += SLIGHT;
            self.solve(there);
            for (i, (force, here)) in self.step.forces.iter().zip(&*forces).enumerate() {
                self.slope[i * contacts + j] = (force - here) / SLIGHT;
            }
        }
        self.step.forces.copy_from_slice(forces);
        self.step.solved = false;
        self.step.work = work;
    }

    /// Forces of the strips on the line for deflections `w` of the points at the end of the step.
    fn solve(&mut self, w: &[f64]) {
        let lane = self.lane.as_deref_mut().expect(HERE);
        let (forces, contacts) = (&mut self.step.forces, self.points.len());
        for (i, (force, w)) in forces.iter_mut().zip(w).enumerate() {
            *force = w - lane.free[i] + lane.candidates.deflection(i, contacts);
        }
        lane.solve(forces);
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
            if !self.step.solved || self.step.at != w {
                self.solve(&w);
                self.step.solved = true;
                self.step.at.clone_from(&w);
            }
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

/// Writes the forces that slack droppers lack with the sign of forces that pull.
fn pull(forces: &mut Vec<(usize, f64)>, lacking: &Lacking) {
    forces.clear();
    forces.extend(lacking.all().map(|(dropper, lacking)| (dropper, -lacking)));
}

impl Force for Interface {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.find(motion);
        for (point, value) in self.points.iter().zip(&self.step.forces) {
            force[point.coordinate] -= value;
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        self.find_slope(motion);
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
    fn push_updates(&mut self, motion: &Motion<'_>, weights: Weights, updates: &mut Updates) {
        self.find_slope(motion);
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
        let h = self.step.h;
        self.forces_before.copy_from_slice(&self.forces);
        self.forces.copy_from_slice(&self.step.forces);
        self.last_h = if h > 0.0 { h } else { f64::INFINITY };
        let lane = self.lane.as_deref_mut().expect(HERE);
        self.lacking.end_step(lane.candidates.lacking());
        lane.bends.clear();
        lane.bends.extend(lane.candidates.bends(h));
        lane.forces.copy_from_slice(&self.forces);
        pull(&mut lane.lacking, &self.lacking);
        for (dropper, force) in lane.candidates.yielded().filter(|(_, force)| *force != 0.0) {
            lane.lacking.push((dropper, -force));
            if let Some(creep) = self.creep.as_mut().filter(|_| h > 0.0) {
                creep.yield_by(dropper, force);
            }
        }
        self.steps += usize::from(h > 0.0);
        self.choose_watched();
        self.move_on(Lane::end);
        let lane = self.lane.as_deref().expect(HERE);
        let points = lane.pass().map_or(&[][..], |pass| &pass.points);
        for (i, (contact, point)) in self.points.iter_mut().zip(points).enumerate() {
            self.reached[i] = motion.q[contact.coordinate];
            let [of_modes, rate, slope] = lane.reached[i];
            let residual = if point.on { self.reached[i] - of_modes } else { 0.0 };
            self.rates[i] = if h > 0.0 && point.moved.is_finite() {
                rate + (slope * point.moved + residual - self.residual[i]) / h
            } else {
                0.0
            };
            self.residual[i] = residual;
            contact.s = lane.places[i][1];
        }
        self.step.open = false;
        self.look_at_watched();
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
        out.extend([self.steps as f64, self.last_h]);
        out.extend(self.points.iter().map(|point| point.s));
        let all = [
            &self.forces,
            &self.forces_before,
            &self.reached,
            &self.rates,
            &self.residual,
            &self.slope,
            &self.joint_rates,
        ];
        all.iter().for_each(|values| out.extend_from_slice(values));
        self.lacking.save(out);
        if let Some(creep) = &self.creep {
            creep.save(out);
        }
        let lane = self.lane();
        let mut repaying = lane.repaying.iter().peekable();
        out.extend((0..self.modes.borrowed.len()).map(|joint| {
            let own = repaying.next_if(|(repaying, _)| *repaying == joint);
            own.map_or(f64::NAN, |(_, force)| *force)
        }));
        // One after another: a single iterator over all would be asked for each number.
        for values in [&lane.q, &lane.v, &lane.r, &lane.slow_forces[0]] {
            out.extend(values.iter().map(|&value| f64::from(value)));
        }
    }

    fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        let mut next = || next_of(values);
        self.steps = next() as usize;
        self.last_h = next();
        self.points.iter_mut().for_each(|point| point.s = next());
        let all = [
            &mut self.forces,
            &mut self.forces_before,
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
        if let Some(creep) = &mut self.creep {
            creep.restore(values);
        }
        let lane = self.lane.as_deref_mut().expect(HERE);
        pull(&mut lane.lacking, &self.lacking);
        lane.repaying.clear();
        let forces = (0..self.modes.borrowed.len()).map(|joint| (joint, next_of(values)));
        lane.repaying.extend(forces.filter(|(_, force)| !force.is_nan()));
        let modes = [&mut lane.q, &mut lane.v, &mut lane.r, &mut lane.slow_forces[0]];
        let all = modes.into_iter().flat_map(|values| values.iter_mut());
        all.for_each(|value| *value = next_of(values) as f32);
        self.step.open = false;
    }
}
