//! Amplitudes of one line in its modes, moved on from step to step together with those of other lines.
use super::modes::Modes;
use super::pass::Pass;
use super::slack::{Answers, Candidates};
use super::together::{Room, Together};
use crate::{CurveColumns, WireCurve};
use dynamics::lockstep::Asked;
use dynamics::modal::Aligned;
use dynamics::modal::kernels;
use pulp::Arch;
use std::ops::Range;
use std::sync::Arc;

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
pub(super) enum Half {
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
    /// The same at the end of the present step, as far as it is known.
    pub next: [Aligned; 3],
    /// Forces on slow modes by the creep of droppers far from strips, and room for the next ones.
    pub slow_forces: [Aligned; 2],
    /// Room for the moves of lines that go together with this one.
    pub room: Room,

    /// Length of the step, s.
    pub h: f64,
    /// Parameters of the strips on the wires at the ends of the step, m; not numbers beyond a wire.
    pub places: Vec<[f64; 2]>,
    /// Force of each strip one step before the begin and at the begin, N.
    pub known_forces: Vec<[f64; 2]>,
    /// At the end.
    pub forces: Vec<f64>,
    /// Forces at the end of the step that take back dampers which the modes have too much, or push rods apart, of all
    /// droppers and supports near strips.
    pub repaying: Joints,
    /// Droppers that may be slack at the end of the step.
    pub candidates: Candidates,
    /// Deflection of the points without forces at the end, m.
    pub free: Vec<f64>,

    /// Forces that slack droppers lack at the end of the step, and that others yield, with the sign of a force that
    /// pulls.
    pub lacking: Joints,
    /// Second derivatives of the forces that droppers lack in the step, N/s².
    pub bends: Joints,
    /// Droppers and supports whose motion at the end of the step is wanted: those near a strip, droppers whose turn it
    /// is, and loose ones.
    pub watched: Vec<usize>,
    /// Number of those near a strip.
    pub near: usize,
    /// Number of these and of those whose turn it is: lines that go together watch them all.
    pub in_turn: usize,
    /// Deflection, m, and rate, m/s, of each; rates of zero for those whose turn it is.
    pub motions: Vec<[f64; 2]>,
    /// See [`Lane::find_elongations`], m.
    pub elongations: Vec<f64>,
    /// Deflection of each point by the modes, m, its rate, m/s, and slope along the wire, –.
    pub reached: Vec<[f64; 3]>,
}

impl Lane {
    /// A line at rest under as many strips as there are `wires`.
    pub fn new(modes: Arc<Modes>, factors: Vec<Arc<Answers>>, wires: Wires) -> Self {
        let (points, joints) = (wires.curves.len(), modes.borrowed.len());
        let room = || Aligned::zeros(modes.count());
        Self {
            arch: Arch::new(),
            factors,
            pass: None,
            half: Half::default(),
            q: room(),
            v: room(),
            r: room(),
            next: [room(), room(), room()],
            slow_forces: [(); 2].map(|()| Aligned::zeros(modes.creeping_modes)),
            room: Room::new(&modes),
            h: 0.0,
            places: vec![[f64::NAN; 2]; points],
            known_forces: vec![[0.0; 2]; points],
            forces: vec![0.0; points],
            repaying: Vec::with_capacity(joints),
            candidates: Candidates::default(),
            free: vec![0.0; points],
            lacking: Vec::with_capacity(2 * modes.droppers()),
            bends: Vec::with_capacity(modes.droppers()),
            watched: Vec::with_capacity(joints),
            near: 0,
            in_turn: 0,
            motions: Vec::with_capacity(joints),
            elongations: Vec::with_capacity(modes.droppers()),
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

    /// Finds the elongations of droppers by the slow modes that feel these creep far from strips.
    pub fn find_elongations(&mut self, droppers: Range<usize>) {
        let Self { modes, elongations, .. } = self;
        let rows = (droppers.len(), |at| modes.creeping_row(droppers.start + at));
        elongations.clear();
        kernels::dots_of_many(self.arch, rows, [[&self.q[..modes.creeping_modes]]], |_, [[sum]]| {
            elongations.push(sum);
        });
    }

    /// Adds changes of forces that push droppers apart to the forces on those modes.
    pub fn push_slow_modes(&mut self, changes: &[(usize, f64)]) {
        let [forces, next] = &mut self.slow_forces;
        let changes = changes.iter();
        let changes = changes.map(|&(dropper, change)| (self.modes.creeping_row(dropper), [change]));
        let rows = std::iter::once((&**forces, [1.0])).chain(changes);
        kernels::weigh(self.arch, rows, [next]);
        self.slow_forces.swap(0, 1);
    }

    /// Way from a place along the track to the closest strip under a wire, m.
    pub fn way(&self, x: f64) -> f64 {
        let points = self.pass().map_or(&[][..], |pass| &pass.points);
        let ways = points.iter().filter(|point| point.on).map(|point| (point.x - x).abs());
        ways.fold(f64::INFINITY, f64::min)
    }

    /// Sum over the first modes, which the values are of, at a coordinate of the linearised line.
    pub fn along(&self, coordinate: usize, values: &[f32]) -> f64 {
        let row = self.modes.at(coordinate);
        row.map_or(0.0, |row| {
            let [sum] = kernels::dots(self.arch, &row[..values.len()], [values]);
            sum
        })
    }

    /// Droppers and supports that lines which go together watch all, and how many of them are near a strip.
    fn watched_alike(&self) -> (&[usize], usize) {
        (&self.watched[..self.in_turn], self.near)
    }

    /// True for lines whose halves have all but forces in common.
    fn goes_with(&self, other: &Self) -> bool {
        let bits = |place: &[f64; 2]| place.map(f64::to_bits);
        let same_places = || self.places.iter().map(bits).eq(other.places.iter().map(bits));
        let same_pass = || match (&self.pass, &other.pass) {
            (Some(pass), Some(other)) => Arc::ptr_eq(pass, other),
            _ => false,
        };
        let same_repaying = || {
            let [own, others] = [&self.repaying, &other.repaying].map(|all| all.iter().map(|(joint, _)| joint));
            own.eq(others)
        };
        self.half == other.half
            && Arc::ptr_eq(&self.modes, &other.modes)
            && self.h.to_bits() == other.h.to_bits()
            && match self.half {
                Half::Begin => same_places() && same_repaying(),
                Half::End => same_pass() && self.watched_alike() == other.watched_alike(),
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
    let together = Together {
        arch,
        modes: &modes,
        answers: &answers,
        pass: own,
    };
    together.move_on(Half::Begin, lanes);
    for lane in lanes.iter_mut() {
        let motions = &lane.motions[own.points.len()..];
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
    let (arch, modes) = (lanes[0].arch, Arc::clone(&lanes[0].modes));
    let together = Together {
        arch,
        modes: &modes,
        answers: &answers,
        pass: &pass,
    };
    together.move_on(Half::End, lanes);
    for lane in lanes.iter_mut() {
        let Lane { q, v, r, next, .. } = &mut **lane;
        for (now, next) in [q, v, r].into_iter().zip(next) {
            std::mem::swap(now, next);
        }
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
