//! Amplitudes of one line in its modes, moved on from step to step together with those of other lines.
use super::modes::Modes;
use super::pass::Pass;
use super::slack::{Answers, Candidates};
use crate::{CurveColumns, WireCurve};
use dynamics::lockstep::Asked;
use dynamics::modal::kernels::{self, Parts, TOGETHER};
use dynamics::modal::{Aligned, StepFactors};
use pulp::Arch;
use std::ops::Range;
use std::sync::Arc;

/// Modes that are moved on at a time: rows of them that lines have in common stay in the fastest memory.
const BLOCK: usize = 1024;
/// Step factors kept: those of a step and of what is left of a communication step.
const KEPT: usize = 3;

/// Contact wires over the strips, one for each point.
pub(super) struct Wires {
    pub curves: Vec<Arc<dyn WireCurve>>,
    /// Zeros, one for each coordinate of the wires.
    pub rest: Arc<[f64]>,
    /// Phase speed of the waves of modes just left out, m/s.
    pub slowest: f64,
}

impl Wires {
    /// Place along the track at a parameter of the wire over a point, m.
    pub fn x(&self, point: usize, s: f64) -> f64 {
        self.curves[point].point(s, &self.rest, &self.rest).r.x
    }

    /// Columns there.
    pub fn columns(&self, point: usize, s: f64, columns: &mut CurveColumns) {
        self.curves[point].columns(s, columns);
    }
}

/// Half of a step that is asked for.
#[derive(Clone, Copy, Default, PartialEq)]
enum Half {
    /// From the places of the strips: answers at the end of the step without forces there, and to forces there.
    #[default]
    Begin,
    /// From the forces of strips and droppers: the motion at the end.
    End,
}

/// Forces along droppers and supports, N.
type Joints = Vec<(usize, f64)>;

/// One line.
pub(super) struct Lane {
    arch: Arch,
    pub modes: Arc<Modes>,
    wires: Arc<Wires>,
    factors: Vec<Arc<Answers>>,
    /// The present step; none before the first one.
    pass: Option<Arc<Pass>>,
    half: Half,
    /// Amplitudes, their rates and the forces on them at the end of the last step. Single precision halves the memory
    /// that a step reads, and that is its time; deflections are good to some ten nanometres.
    pub q: Aligned,
    pub v: Aligned,
    pub r: Aligned,
    /// Modal forces of `repaying`.
    repaid: Aligned,
    q_free: Aligned,
    v_free: Aligned,
    /// Room for modal forces.
    bend: Aligned,
    /// Parts of the sums of a half.
    parts: Vec<[Parts; 2]>,

    /// Length of the step, s.
    pub h: f64,
    /// Parameters of the strips on the wires at the ends of the step, m; not numbers beyond a wire.
    pub places: Vec<[f64; 2]>,
    /// Force of each strip one step before the begin and at the begin, N.
    pub known_forces: Vec<[f64; 2]>,
    /// At the end.
    pub forces: Vec<f64>,
    /// Forces at the end of the step that take back dampers which the modes have too much.
    pub repaying: Joints,
    /// Droppers that may be slack at the end of the step.
    pub candidates: Candidates,
    /// Deflection of the points without forces at the end, m.
    pub free: Vec<f64>,

    /// Forces that slack droppers lack at the end of the step, with the sign of a force that pulls.
    pub lacking: Joints,
    /// Second derivatives of the forces that droppers lack in the step, N/s².
    pub bends: Joints,
    /// Droppers and supports whose deflection at the end of the step is wanted.
    pub watched: Vec<usize>,
    /// Number of the first of these that are near a strip: their rates are wanted too.
    pub near: usize,
    /// Deflection, m, and rate, m/s, of each.
    pub motions: Vec<[f64; 2]>,
    /// Deflection of each point by the modes, m, its rate, m/s, and slope along the wire, –.
    pub reached: Vec<[f64; 3]>,
}

impl Lane {
    /// A line at rest under as many strips as there are `wires`.
    pub fn new(modes: Arc<Modes>, factors: Vec<Arc<Answers>>, wires: Wires) -> Self {
        let (room, points, joints) = (
            || Aligned::zeros(modes.count()),
            wires.curves.len(),
            modes.borrowed.len(),
        );
        Self {
            arch: Arch::new(),
            factors,
            pass: None,
            half: Half::default(),
            q: room(),
            v: room(),
            r: room(),
            repaid: room(),
            q_free: room(),
            v_free: room(),
            bend: room(),
            parts: Vec::with_capacity(2 * points + joints),
            h: 0.0,
            places: vec![[f64::NAN; 2]; points],
            known_forces: vec![[0.0; 2]; points],
            forces: vec![0.0; points],
            repaying: Vec::with_capacity(joints),
            candidates: Candidates::default(),
            free: vec![0.0; points],
            lacking: Vec::with_capacity(modes.droppers()),
            bends: Vec::with_capacity(modes.droppers()),
            watched: Vec::with_capacity(joints),
            near: 0,
            motions: Vec::with_capacity(joints),
            reached: vec![[0.0; 3]; points],
            wires: Arc::new(wires),
            modes,
        }
    }

    /// Asks for the first half of a step.
    pub fn begin(mut self: Box<Self>) -> Box<Self> {
        self.half = Half::Begin;
        self.ask()
    }

    /// Asks for the second half.
    pub fn end(mut self: Box<Self>) -> Box<Self> {
        self.half = Half::End;
        self.ask()
    }

    fn ask(mut self: Box<Self>) -> Box<Self> {
        if self.h > 0.0 {
            return dynamics::lockstep::ask(self);
        }
        // Steps to rest are made while a line is set up, when others may wait for what this one makes.
        Self::answer(&mut [&mut self]);
        self
    }

    /// The present step.
    pub fn pass(&self) -> Option<&Pass> {
        self.pass.as_deref()
    }

    /// Forces of the strips, from those by which the points would be held, N.
    pub fn solve(&mut self, forces: &mut [f64]) {
        if let Some(pass) = &self.pass {
            pass.factored.solve(forces);
        }
        self.candidates.settle(&self.modes, forces);
    }

    /// Deflection of a dropper or support by the modes, m, and its rate, m/s.
    pub fn motion_of(&self, joint: usize) -> [f64; 2] {
        kernels::dots(self.arch, self.modes.joint(joint), [&self.q, &self.v])
    }

    /// Sum over the first modes, which the values are of, at a coordinate of the linearised line.
    pub fn along(&self, coordinate: usize, values: &[f32]) -> f64 {
        let row = self.modes.at(coordinate);
        row.map_or(0.0, |row| {
            let [sum] = kernels::dots(self.arch, &row[..values.len()], [values]);
            sum
        })
    }

    /// True for lines whose halves have all but forces in common.
    fn goes_with(&self, other: &Self) -> bool {
        let bits = |place: &[f64; 2]| place.map(f64::to_bits);
        let same_places = || self.places.iter().map(bits).eq(other.places.iter().map(bits));
        let same_pass = || match (&self.pass, &other.pass) {
            (Some(pass), Some(other)) => Arc::ptr_eq(pass, other),
            _ => false,
        };
        self.half == other.half
            && Arc::ptr_eq(&self.modes, &other.modes)
            && self.h.to_bits() == other.h.to_bits()
            && match self.half {
                Half::Begin => same_places(),
                Half::End => same_pass(),
            }
    }

    /// Brings the step factors of the present length to the front.
    fn choose_factors(&mut self) {
        let h = self.h;
        let serves = |answers: &Arc<Answers>| (answers.step.h - h).abs() <= 1e-9 * h;
        match self.factors.iter().position(serves) {
            Some(at) => self.factors[..=at].rotate_right(1),
            None => {
                self.factors.insert(0, Arc::new(Answers::new(&self.modes, h)));
                self.factors.truncate(KEPT);
            }
        }
    }

    /// Motion without forces at the end of the step, of the modes `range`, and its parts of deflections and tensions.
    fn free(&mut self, factors: &StepFactors, pass: &Pass, range: Range<usize>) {
        let (arch, modes, factors) = (self.arch, &self.modes, factors.of(range.clone()));
        let repaid = &mut self.repaid[range.clone()];
        repaid.fill(0.0);
        add_joints((arch, modes, range.clone()), self.repaying.iter(), repaid);
        let motion = [&*self.q, &self.v, &self.r].map(|values| &values[range.clone()]);
        let (q, v) = (&mut self.q_free[range.clone()], &mut self.v_free[range.clone()]);
        kernels::free(arch, factors, motion, repaid, [q, v]);
        for (point, [before, begin]) in pass.points.iter().zip(&self.known_forces) {
            // `c₀ F₀` by the move, and of the second difference of the force the part that is known.
            if let Some(per_step) = point.per_step(self.h) {
                let known = (per_step * (2.0 * begin - before)) as f32;
                let bends = [(*begin as f32, &*point.bend), (known, point.shape())];
                let bends = bends.map(|(weight, row)| (weight, &row[range.clone()]));
                kernels::add_bend(arch, factors, bends, [q, v]);
            }
        }
        let ends = [&*q, &*v];
        let (points, droppers) = self.parts.split_at_mut(pass.points.len());
        for (point, [parts, _]) in pass.points.iter().zip(points) {
            let shape = &point.shape()[range.clone()];
            kernels::add_dots(arch, [shape], [ends[0]], [std::array::from_mut(parts)]);
        }
        if modes.law.damping == 0.0 {
            add_motions((arch, modes, range), self.candidates.droppers(), [ends[0]], droppers);
        } else {
            add_motions((arch, modes, range), self.candidates.droppers(), ends, droppers);
        }
    }

    /// Motion at the end of the step, of the modes `range`, and its parts of deflections.
    fn finish(&mut self, factors: &StepFactors, pass: &Pass, range: Range<usize>) {
        let (arch, modes) = (self.arch, &self.modes);
        let [q, v, r] = [&mut *self.q, &mut self.v, &mut self.r].map(|values| &mut values[range.clone()]);
        r.fill(0.0);
        add_joints((arch, modes, range.clone()), self.lacking.iter(), r);
        let known = [&*self.repaid, &self.q_free, &self.v_free].map(|values| &values[range.clone()]);
        let factors = factors.of(range.clone());
        kernels::finish(arch, factors, known, [r, q, v]);
        if !self.bends.is_empty() {
            let bend = &mut self.bend[range.clone()];
            bend.fill(0.0);
            add_joints((arch, modes, range.clone()), self.bends.iter(), bend);
            kernels::add_bend(arch, factors, [(1.0, bend)], [q, v]);
        }
        for (point, force) in pass.points.iter().zip(&self.forces).filter(|(point, _)| point.on) {
            let [by_q, by_v] = &point.by_force;
            let answer = [point.shape(), by_q, by_v].map(|values| &values[range.clone()]);
            kernels::add_answer(arch, *force as f32, answer, [r, q, v]);
        }
        let ends = [&*q, &*v];
        let (points, joints) = self.parts.split_at_mut(2 * pass.points.len());
        for (point, parts) in pass.points.iter().zip(points.chunks_exact_mut(2)) {
            let [shape, slope] = [point.shape(), point.slope()].map(|values| &values[range.clone()]);
            kernels::add_dots(arch, [shape], ends, [&mut parts[0]]);
            let [along, _] = &mut parts[1];
            kernels::add_dots(arch, [slope], [ends[0]], [std::array::from_mut(along)]);
        }
        let rated = if modes.law.damping == 0.0 {
            self.near
        } else {
            self.watched.len()
        };
        let (moving, resting) = self.watched.split_at(rated);
        let (of_moving, of_resting) = joints.split_at_mut(rated);
        add_motions((arch, modes, range.clone()), moving, ends, of_moving);
        add_motions((arch, modes, range), resting, [ends[0]], of_resting);
    }

    fn take_parts(&mut self, count: usize) {
        self.parts.clear();
        self.parts.resize(count, [[0.0; kernels::LANES]; 2]);
    }
}

/// Blocks of modes, one after the other.
fn blocks(modes: usize) -> impl Iterator<Item = Range<usize>> {
    (0..modes)
        .step_by(BLOCK)
        .map(move |from| from..(from + BLOCK).min(modes))
}

/// Adds the modal forces of forces along droppers and supports, N, of the modes `range`.
fn add_joints<'a>(
    (arch, modes, range): (Arch, &Modes, Range<usize>),
    joints: impl Iterator<Item = &'a (usize, f64)>,
    forces: &mut [f32],
) {
    let mut rows = [(0.0, &[][..]); TOGETHER];
    let mut count = 0;
    for &(joint, force) in joints {
        rows[count] = (force as f32, &modes.joint(joint)[range.clone()]);
        count += 1;
        if count == TOGETHER {
            kernels::add(arch, &rows, forces);
            count = 0;
        }
    }
    kernels::add(arch, &rows[..count], forces);
}

/// Adds the parts of the motions of droppers and supports that the modes `range` are: of deflections, or of these and
/// their rates.
fn add_motions<const N: usize>(
    (arch, modes, range): (Arch, &Modes, Range<usize>),
    joints: &[usize],
    ends: [&[f32]; N],
    parts: &mut [[Parts; 2]],
) {
    fn first<const N: usize>(parts: &mut [Parts; 2]) -> &mut [Parts; N] {
        parts.first_chunk_mut().expect("a motion is a deflection and a rate")
    }
    let row = |joint: usize| &modes.joint(joint)[range.clone()];
    let ((four, rest), (of_four, of_rest)) = (joints.as_chunks::<4>(), parts.as_chunks_mut::<4>());
    for (joints, parts) in four.iter().zip(of_four) {
        kernels::add_dots(arch, joints.map(row), ends, parts.each_mut().map(first));
    }
    for (&joint, parts) in rest.iter().zip(of_rest) {
        kernels::add_dots(arch, [row(joint)], ends, [first(parts)]);
    }
}

/// First half of a step of lines that go together.
fn begin(lanes: &mut [&mut Lane]) {
    // One that all had in common is free to be used again when nobody has it.
    let taken = lanes.iter_mut().filter_map(|lane| lane.pass.take());
    let pass = taken.fold(None, |_, taken| Some(taken));
    let first = &mut *lanes[0];
    let (arch, modes, wires) = (first.arch, Arc::clone(&first.modes), Arc::clone(&first.wires));
    let room = || Arc::new(Pass::new(&modes, wires.curves.len()));
    let mut pass = pass.unwrap_or_else(room);
    if Arc::get_mut(&mut pass).is_none() {
        pass = room();
    }
    let own = Arc::get_mut(&mut pass).expect("nobody else has it");
    first.choose_factors();
    let mut answers = first.factors.remove(0);
    own.go((arch, &modes, &wires), &answers.step, &first.places);
    for lane in lanes.iter_mut() {
        lane.take_parts(own.points.len() + lane.candidates.len());
    }
    for range in blocks(modes.count()) {
        for lane in lanes.iter_mut() {
            lane.free(&answers.step, own, range.clone());
        }
    }
    for lane in lanes.iter_mut() {
        for (free, [parts, _]) in lane.free.iter_mut().zip(&lane.parts) {
            *free = kernels::sum(parts);
        }
        let motions = lane.parts[own.points.len()..].iter();
        let motions = motions.map(|parts| parts.each_ref().map(kernels::sum));
        lane.candidates.take((arch, &modes, &mut answers), own, motions);
    }
    lanes[0].factors.insert(0, answers);
    for lane in lanes.iter_mut() {
        lane.pass = Some(Arc::clone(&pass));
    }
}

/// Second half.
fn end(lanes: &mut [&mut Lane]) {
    lanes[0].choose_factors();
    let answers = Arc::clone(&lanes[0].factors[0]);
    let Some(pass) = lanes[0].pass.clone() else { return };
    let points = pass.points.len();
    for lane in lanes.iter_mut() {
        lane.take_parts(2 * points + lane.watched.len());
    }
    for range in blocks(lanes[0].modes.count()) {
        for lane in lanes.iter_mut() {
            lane.finish(&answers.step, &pass, range.clone());
        }
    }
    for lane in lanes.iter_mut() {
        let (of_points, of_joints) = lane.parts.split_at(2 * points);
        for (reached, parts) in lane.reached.iter_mut().zip(of_points.chunks_exact(2)) {
            *reached = [&parts[0][0], &parts[0][1], &parts[1][0]].map(kernels::sum);
        }
        lane.motions.clear();
        let motions = of_joints.iter().map(|parts| parts.each_ref().map(kernels::sum));
        lane.motions.extend(motions);
    }
}

impl Asked for Lane {
    fn answer(mut all: &mut [&mut Self]) {
        while !all.is_empty() {
            let mut together = 1;
            for other in 1..all.len() {
                if all[0].goes_with(all[other]) {
                    all.swap(together, other);
                    together += 1;
                }
            }
            let (lanes, others) = all.split_at_mut(together);
            match lanes[0].half {
                Half::Begin => begin(lanes),
                Half::End => end(lanes),
            }
            all = others;
        }
    }
}
