//! Moves of lines that go together: rows of factors and of droppers are read once for two of them.
use super::lane::{Half, Lane};
use super::modes::Modes;
use super::pass::{Pass, Point};
use super::slack::Answers;
use dynamics::modal::Aligned;
use dynamics::modal::kernels::{self, Ending, Motions};
use pulp::Arch;

/// Modal forces of each of two lines, and their bends.
#[derive(Default)]
pub(super) struct Room {
    forces: [Aligned; 2],
    bends: [Aligned; 2],
    /// Rates of lengths of wires, m/s, and then forces along these, N.
    lengths: [Vec<f64>; 2],
}

impl Room {
    pub fn new(modes: &Modes) -> Self {
        let two = || [(); 2].map(|()| Aligned::zeros(modes.count()));
        Self {
            forces: two(),
            bends: two(),
            lengths: [(); 2].map(|()| Vec::with_capacity(modes.stretch_dampers.len())),
        }
    }
}

/// The first `L` of two.
fn of_lines<T, const L: usize>(two: &mut [T; 2]) -> [&mut T; L] {
    two.first_chunk_mut().expect("at most two lines").each_mut()
}

/// The first `L` rows.
fn first<const L: usize>(rows: &mut [Aligned; 2]) -> [&mut [f32]; L] {
    of_lines(rows).map(|row| &mut **row)
}

/// Parts that lines have in common in a half of a step.
pub(super) struct Together<'a> {
    pub arch: Arch,
    pub modes: &'a Modes,
    pub answers: &'a Answers,
    pub pass: &'a Pass,
}

impl Together<'_> {
    /// Moves lines on by a half of a step.
    pub fn move_on(&self, half: Half, lanes: &mut [&mut Lane]) {
        let [lane, ..] = lanes else { return };
        let mut room = std::mem::take(&mut lane.room);
        for lanes in lanes.chunks_mut(2) {
            match (half, lanes) {
                (Half::Begin, [one, other]) => self.free([one, other], &mut room),
                (Half::Begin, lanes) => lanes.iter_mut().for_each(|lane| self.free([lane], &mut room)),
                (Half::End, [one, other]) => self.finish([one, other], &mut room),
                (Half::End, lanes) => lanes.iter_mut().for_each(|lane| self.finish([lane], &mut room)),
            }
        }
        lanes[0].room = room;
    }

    /// Motion without forces at the end of the step: of all modes, the points, and the droppers that may be slack.
    fn free<const L: usize>(&self, mut lanes: [&mut Lane; L], room: &mut Room) {
        let (arch, modes) = (self.arch, self.modes);
        let points = self.pass.points.iter().enumerate();
        let by_points = points.filter_map(|(number, point)| {
            // `c₀ F₀` by the move, and of the second difference of the force the part that is known.
            let per_step = point.per_step(self.answers.step.h)?;
            let forces = lanes.each_ref().map(|lane| lane.known_forces[number]);
            let known = |[before, begin]: [f64; 2]| per_step * (2.0 * begin - before);
            let by_move = (&*point.bends[0], forces.map(|[_, begin]| begin));
            Some([by_move, (point.shape(), forces.map(known))])
        });
        kernels::weigh(arch, by_points.flatten(), first(&mut room.bends));
        let lines = lanes.each_mut().map(|lane| (&*lane.repaying, &mut *lane.next[2]));
        let repaying = lines.each_ref().map(|(joints, _)| *joints);
        let joints = repaying.first().map_or(&[][..], |joints| joints).iter().enumerate();
        let by_joints = joints.map(|(at, (joint, _))| (modes.joint(*joint), repaying.map(|joints| joints[at].1)));
        kernels::weigh(arch, by_joints, lines.map(|(_, forces)| forces));
        for lane in &mut lanes {
            let Lane {
                next: [.., known],
                slow_forces: [slow, _],
                ..
            } = &mut **lane;
            known.iter_mut().zip(&**slow).for_each(|(known, slow)| *known += slow);
        }
        let mut bends = first::<L>(&mut room.bends).into_iter();
        let motions = lanes.each_mut().map(|lane| {
            let [q, v, known] = lane.next.each_mut().map(|values| &mut **values);
            Motions {
                begin: [&lane.q, &lane.v, &lane.r],
                forces: [known, bends.next().expect("one for each line")],
                end: [q, v],
            }
        });
        kernels::free(arch, self.answers.step.of(0..modes.count()), motions);
        drop(bends);
        self.take_back_stretching(&mut lanes, room);
        let points = &self.pass.points;
        for lane in lanes {
            let mut motions = std::mem::take(&mut lane.motions);
            motions.clear();
            let (droppers, damped) = (lane.candidates.droppers(), modes.law.damping != 0.0);
            self.add_motions((points, droppers), [lane], damped, [&mut motions]);
            for (free, [deflection, _]) in lane.free.iter_mut().zip(&motions) {
                *free = *deflection;
            }
            lane.motions = motions;
        }
    }

    /// Adds forces that take dampers along wires back, at the end of the step as the rates there without the forces of
    /// strips and slack droppers: these hardly stretch wires within a step.
    fn take_back_stretching<const L: usize>(&self, lanes: &mut [&mut Lane; L], room: &mut Room) {
        let (arch, modes, slow) = (self.arch, self.modes, self.modes.slow);
        let count = modes.stretch_dampers.len();
        if count == 0 {
            return;
        }
        let mut lengths = of_lines::<_, L>(&mut room.lengths);
        lengths.iter_mut().for_each(|rates| rates.clear());
        let ends = lanes.each_ref().map(|lane| [&lane.next[1][..slow]]);
        let rates = lengths.each_mut().map(|rates| &mut **rates);
        self.add_sums((count, |length| modes.stretch(length)), ends, rates, |[rate]| rate);
        lengths
            .iter_mut()
            .for_each(|lengths| self.answers.stretching.solve(lengths));
        let mut rows = first::<L>(&mut room.forces).map(|row| &mut row[..slow]);
        let along = (0..count).map(|length| (modes.stretch(length), lengths.each_ref().map(|forces| forces[length])));
        kernels::weigh(arch, along, rows.each_mut().map(|row| &mut **row));
        room.bends[0][..slow].fill(0.0);
        let (mut rows, straight) = (rows.into_iter(), &room.bends[0][..slow]);
        let lines = lanes.each_mut().map(|lane| Ending {
            forces: [rows.next().expect("one for each line"), straight],
            end: lane.next.each_mut().map(|values| &mut values[..slow]),
        });
        kernels::finish(arch, self.answers.step.of(0..slow), lines);
    }

    /// Motion at the end of the step: of all modes, of the points, and of the droppers and supports that are watched.
    fn finish<const L: usize>(&self, mut lanes: [&mut Lane; L], room: &mut Room) {
        let (arch, points) = (self.arch, &self.pass.points);
        let rows = first::<L>(&mut room.forces)
            .into_iter()
            .zip(first::<L>(&mut room.bends));
        for (lane, (force, bend)) in lanes.iter().zip(rows) {
            let on = || points.iter().zip(&lane.forces).filter(|(point, _)| point.on);
            let by_points = on().map(|(point, force)| (point.shape(), [*force]));
            let bent = on().map(|(point, force)| (&*point.bends[1], [-force]));
            let of_joint = |&(joint, force): &(usize, f64)| (self.modes.joint(joint), [force]);
            kernels::weigh(arch, by_points.chain(lane.lacking.iter().map(of_joint)), [force]);
            kernels::weigh(arch, bent.chain(lane.bends.iter().map(of_joint)), [bend]);
        }
        let mut rows = [first::<L>(&mut room.forces), first(&mut room.bends)].map(IntoIterator::into_iter);
        let lines = lanes.each_mut().map(|lane| Ending {
            forces: rows.each_mut().map(|rows| &*rows.next().expect("one for each line")),
            end: lane.next.each_mut().map(|values| &mut **values),
        });
        kernels::finish(arch, self.answers.step.of(0..self.modes.count()), lines);
        for lane in &mut lanes {
            let [q, v, _] = &lane.next;
            for (reached, point) in lane.reached.iter_mut().zip(points) {
                let rows = [point.shape(), point.slope()];
                let [[[deflection, rate]], [[slope, _]]] = kernels::dots_of_rows(arch, rows, [[q, v]]);
                *reached = [deflection, rate, slope];
            }
        }
        self.watch(&mut lanes);
    }

    /// Finds the motions of droppers and supports that are watched.
    fn watch<const L: usize>(&self, lanes: &mut [&mut Lane; L]) {
        let damped = self.modes.law.damping != 0.0;
        let mut motions = lanes.each_mut().map(|lane| std::mem::take(&mut lane.motions));
        motions.iter_mut().for_each(Vec::clear);
        let lines = lanes.each_ref().map(|lane| &**lane);
        if let [one, ..] = &lines[..] {
            let (near, in_turn) = one.watched[..one.in_turn].split_at(one.near);
            self.add_motions((&[], near), lines, true, motions.each_mut());
            // A damper is worth half a newton there, and what is asked is whether a dropper comes loose.
            self.add_motions((&[], in_turn), lines, false, motions.each_mut());
        }
        for (lane, motions) in lines.into_iter().zip(&mut motions) {
            self.add_motions((&[], &lane.watched[lane.in_turn..]), [lane], damped, [motions]);
        }
        for (lane, motions) in lanes.iter_mut().zip(motions) {
            lane.motions = motions;
        }
    }

    /// Adds the motions of points and of droppers and supports to those of each line: deflections, or these and their
    /// `rates`.
    fn add_motions<const L: usize>(
        &self,
        places: (&[Point], &[usize]),
        lanes: [&Lane; L],
        rates: bool,
        motions: [&mut Vec<[f64; 2]>; L],
    ) {
        let (points, joints) = places;
        let row = |at: usize| match points.get(at) {
            Some(point) => point.shape(),
            None => self.modes.joint(joints[at - points.len()]),
        };
        let rows = (points.len() + joints.len(), row);
        if rates {
            let ends = lanes.map(|lane| [&*lane.next[0], &lane.next[1]]);
            self.add_sums(rows, ends, motions, |motion| motion);
        } else {
            let ends = lanes.map(|lane| [&*lane.next[0]]);
            self.add_sums(rows, ends, motions, |[deflection]| [deflection, 0.0]);
        }
    }

    /// Adds what follows from `N` sums over each of `count` rows.
    fn add_sums<'a, const L: usize, const N: usize, T>(
        &self,
        rows: (usize, impl Fn(usize) -> &'a [f32]),
        ends: [[&[f32]; N]; L],
        mut found: [&mut Vec<T>; L],
        of_sums: impl Fn([f64; N]) -> T,
    ) {
        kernels::dots_of_many(self.arch, rows, ends, |_, sums| {
            for (found, sums) in found.iter_mut().zip(sums) {
                found.push(of_sums(sums));
            }
        });
    }
}
