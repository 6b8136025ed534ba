//! Strips under the wire in one step: all that lines with strips at the same places have in common.
use super::lane::Wires;
use super::modes::Modes;
use crate::CurveColumns;
use dynamics::Lu;
use dynamics::modal::kernels::{self, Passing};
use dynamics::modal::{Aligned, StepFactors};
use pulp::Arch;

/// Stiffness that holds a point under a strip beyond the wire, N/m.
pub(super) const HELD: f64 = 1e5;

/// Largest speed of a strip, in phase speeds of waves left out, by which these answer: at one there would be no bound.
const FASTEST: f64 = 0.9;

/// Least compliance of a point under a strip, m/N: a wire does not yield at all where its end is held.
const STIFFEST: f64 = 1e-8;

/// Modes at a place of the wire: `φₖ` and `∂φₖ/∂s`.
struct Shapes {
    /// Parameter on the wire, m; not a number where none is known.
    s: f64,
    at: Aligned,
    slope: Aligned,
}

/// A point under a strip.
pub(super) struct Point {
    /// Columns of the wire at the point.
    columns: CurveColumns,
    /// True for a strip under the wire.
    pub on: bool,
    /// Place along the track, m, where the strip is under the wire.
    pub x: f64,
    /// Way along the wire in the step, m; not a number where the strip was not under the wire at both ends.
    pub moved: f64,
    /// Answer of modes left out to the force of the strip in units of that at rest, –. A force that moves with `v`
    /// shakes a wave of wave number `k` with `k v`: it answers by `1/(ω² − k² v²)`.
    moving: f64,
    /// Modes at the ends of the step.
    shapes: [Shapes; 2],
    /// Amplitudes at the end of the step and their rates by a unit force there, with the move of the point.
    by_force: [Aligned; 2],
    /// Amplitudes at the end of the step by a unit force there that does not move, those that it feels of others; and
    /// by a unit bend of such a force.
    fixed: [Aligned; 2],
    /// True where these are found.
    fixed_found: bool,
    /// Bend of the modal force by a unit force at the begin of the step, and its second derivative by one at the end.
    pub bends: [Aligned; 2],
}

impl Point {
    fn new(modes: usize) -> Self {
        let room = || Aligned::zeros(modes);
        let shapes = || Shapes {
            s: f64::NAN,
            at: room(),
            slope: room(),
        };
        Self {
            columns: CurveColumns::default(),
            on: false,
            x: f64::NAN,
            moved: f64::NAN,
            moving: 1.0,
            shapes: [shapes(), shapes()],
            by_force: [room(), room()],
            fixed: [room(), room()],
            fixed_found: false,
            bends: [room(), room()],
        }
    }

    /// Elongation of a dropper by a unit force of the strip, as far as modes left out make it, m/N.
    pub fn residual_of_dropper(&self, modes: &Modes, dropper: usize) -> f64 {
        self.moving * modes.residual_by_dropper(&self.columns, dropper)
    }

    /// `φₖ` of all modes at the end of the step.
    pub fn shape(&self) -> &[f32] {
        &self.shapes[1].at
    }

    /// One over the square of a step of `h` s, 1/s²; none for a strip that was not under the wire at both ends, or in a
    /// step to rest.
    pub fn per_step(&self, h: f64) -> Option<f64> {
        (self.moved.is_finite() && h > 0.0).then(|| 1.0 / (h * h))
    }

    /// `∂φₖ/∂s` there.
    pub fn slope(&self) -> &[f32] {
        &self.shapes[1].slope
    }

    /// Goes on from a place to the one at the end of the step.
    fn go(&mut self, (arch, modes, wires): (Arch, &Modes, &Wires), wire: usize, [before, now]: [f64; 2]) {
        self.moved = now - before;
        self.on = now.is_finite();
        self.shapes.swap(0, 1);
        if before.is_finite() && self.shapes[0].s.to_bits() != before.to_bits() {
            self.find(0, before, (arch, modes, wires), wire);
        }
        self.find(1, now, (arch, modes, wires), wire);
        if self.on {
            self.x = wires.x(wire, now);
        }
    }

    /// Modes at `s`, of the begin (0) or the end (1) of the step.
    fn find(&mut self, end: usize, s: f64, (arch, modes, wires): (Arch, &Modes, &Wires), wire: usize) {
        self.columns.clear();
        if s.is_finite() {
            wires.columns(wire, s, &mut self.columns);
        }
        let columns = self.columns.as_slice().iter();
        let rows = columns.filter_map(|column| Some((modes.at(column.index)?, [column.n.z, column.n_s.z])));
        let shapes = &mut self.shapes[end];
        shapes.s = s;
        kernels::weigh(arch, rows, [&mut shapes.at, &mut shapes.slope]);
    }

    /// Answers of all modes to a unit force at the end of the step, and the bend by one at its begin; waves of modes
    /// left out go with the `slowest` phase speed, m/s.
    fn answer(&mut self, arch: Arch, factors: &StepFactors, slowest: f64) {
        let [before, now] = &self.shapes;
        // A point that comes to the wire in the step, or a step to rest, is without a move.
        let (before, along, per_step) = match self.per_step(factors.h) {
            Some(per_step) => (before, self.moved * per_step, per_step),
            None => (now, 0.0, 0.0),
        };
        let part = (along * factors.h / slowest).abs().min(FASTEST);
        self.moving = 1.0 / (1.0 - part * part);
        self.fixed_found = false;
        let passing = Passing {
            shapes: [&before.at, &before.slope, &now.at, &now.slope],
            rates: [along, per_step].map(|rate| rate as f32),
        };
        let [bends, by_force] = [&mut self.bends, &mut self.by_force].map(|rows| rows.each_mut().map(|row| &mut **row));
        kernels::pass(arch, factors.of(0..now.at.len()), passing, bends, by_force);
    }

    /// Finds the amplitudes by a force that does not move, which few steps need.
    fn find_fixed(&mut self, arch: Arch, factors: &StepFactors) {
        if self.fixed_found {
            return;
        }
        for (fixed, factor) in self.fixed.iter_mut().zip([&factors.q1, &factors.qb]) {
            kernels::products(arch, &self.shapes[1].at, factor, fixed);
        }
        self.fixed_found = true;
    }
}

/// Answers between a point and a dropper at the end of a step.
#[derive(Clone, Copy, Default)]
pub(super) struct ByDropper {
    /// Deflection of the point by a unit force of the dropper, m/N.
    pub deflection: f64,
    /// Deflection of the point by a unit bend of that force, m s²/N.
    pub by_bend: f64,
    /// Tension of the dropper by a unit force at the point, –.
    pub tension: f64,
}

impl ByDropper {
    const UNKNOWN: Self = Self {
        deflection: f64::NAN,
        by_bend: f64::NAN,
        tension: f64::NAN,
    };
}

/// The strips in one step.
pub(super) struct Pass {
    pub points: Vec<Point>,
    /// Compliance of the points at the end of the step, m/N, row by row, and its factors.
    pub compliance: Vec<f64>,
    pub factored: Lu,
    /// Answers between points and droppers, dropper after dropper; not numbers where not yet needed.
    by_droppers: Vec<ByDropper>,
}

impl Pass {
    /// Room for `points` strips and wires.
    pub fn new(modes: &Modes, points: usize) -> Self {
        Self {
            points: (0..points).map(|_| Point::new(modes.count())).collect(),
            compliance: vec![0.0; points * points],
            factored: Lu::default(),
            by_droppers: vec![ByDropper::UNKNOWN; points * modes.droppers()],
        }
    }

    /// Goes on by a step to the `places` of the strips: parameters on the wires at its ends, m.
    pub fn go(&mut self, (arch, modes, wires): (Arch, &Modes, &Wires), factors: &StepFactors, places: &[[f64; 2]]) {
        for (number, (point, place)) in self.points.iter_mut().zip(places).enumerate() {
            point.go((arch, modes, wires), number, *place);
            if point.on {
                point.answer(arch, factors, wires.slowest);
            }
        }
        let count = self.points.len();
        for (i, point) in self.points.iter().enumerate() {
            for (j, other) in self.points.iter().enumerate() {
                self.compliance[i * count + j] = if point.on && other.on {
                    let [of_modes] = kernels::dots(arch, point.shape(), [&other.by_force[0]]);
                    let residual = modes.residual_between_points(&point.columns, &other.columns);
                    let sum = of_modes + other.moving * residual;
                    if i == j { sum.max(STIFFEST) } else { sum }
                } else if i == j {
                    1.0 / HELD
                } else {
                    0.0
                };
            }
        }
        self.factored.matrix(count).copy_from_slice(&self.compliance);
        self.factored
            .factor()
            .expect("strips apart have independent deflections");
        self.by_droppers.fill(ByDropper::UNKNOWN);
    }

    /// Finds the answers between the points and a dropper where they are not yet known.
    pub fn need(&mut self, (arch, modes, factors): (Arch, &Modes, &StepFactors), dropper: usize) {
        let count = self.points.len();
        let answers = &mut self.by_droppers[dropper * count..][..count];
        let row = modes.joint(dropper);
        for (answer, point) in answers.iter_mut().zip(&mut self.points) {
            if !answer.deflection.is_nan() {
                continue;
            }
            *answer = ByDropper::default();
            if point.on {
                point.find_fixed(arch, factors);
                let ([fixed, bent], [q, v]) = (&point.fixed, &point.by_force);
                let [deflection, by_bend, elongation, rate] = kernels::dots(arch, row, [fixed, bent, q, v]);
                let deflection = deflection + modes.residual_by_dropper(&point.columns, dropper);
                let elongation = elongation + point.residual_of_dropper(modes, dropper);
                let law = &modes.law;
                *answer = ByDropper {
                    deflection,
                    by_bend,
                    tension: law.stiffness * elongation + law.damping * rate,
                };
            }
        }
    }

    /// Answers between the points and a dropper, see [`Pass::need`].
    pub fn by_dropper(&self, dropper: usize) -> &[ByDropper] {
        &self.by_droppers[dropper * self.points.len()..][..self.points.len()]
    }
}
