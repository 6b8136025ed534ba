//! Outputs of both sides at the last communication points.

use crate::slave::SlaveError;
use component::exchange::{contact, strip};

use component::Point;
use system::ENERGY_SHARE;

use super::Sides;
use super::waveform::Shape;

/// Communication points that predictions can look back to.
const DEPTH: usize = 3;

/// Force components of a defect.
const AXES: usize = 3;

/// Defect of the load on a strip so far: the force of the line less that of the load, integrated once and twice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Defect {
    /// Momentum that the strip still has to get, N s.
    pub momentum: f64,
    /// The same for mass times position, N s² (kg m).
    pub position: f64,
}

impl Defect {
    /// The straight line that, added to the load of the next `h` s, takes the momentum to zero and the share `position`
    /// of the position defect at its end; only the momentum with `degree` 0.
    ///
    /// In terms of [`Shape`]: mean `p/h`, moment `(q + h p)/h²`.
    #[must_use]
    pub fn correction(&self, h: f64, degree: usize, position: f64) -> Shape {
        let mean = self.momentum / h;
        let moment = position * (self.position + h * self.momentum) / (h * h);
        let slope = if degree == 0 { 0.0 } else { 6.0 * (0.5 * mean - moment) };
        Shape([mean, slope, 0.0])
    }
}

/// The last communication points, newest first, and the one being computed.
#[derive(Clone, Debug)]
pub struct Exchange {
    points: [Point; DEPTH],
    known: usize,
    /// Point reached by the step under way; becomes the present point by [`Exchange::accept`].
    pub reached: Point,
    start_work: f64,
    /// Sum of the amounts of work that crossed the contact, step by step, J.
    crossed: f64,
    /// Defects at the present point and at the one reached, per strip and component.
    defects: Vec<[Defect; AXES]>,
    reached_defects: Vec<[Defect; AXES]>,
}

impl Exchange {
    /// Reads the outputs of both sides at the start, `t` in s.
    ///
    /// # Errors
    /// Error reported by a slave.
    pub fn start(sides: &mut Sides<'_>, t: f64, line_outputs: usize) -> Result<Self, SlaveError> {
        let point = Point::new(t, sides.pantographs.len(), line_outputs);
        let mut exchange = Self {
            points: std::array::from_fn(|_| point.clone()),
            known: 1,
            reached: point,
            start_work: 0.0,
            crossed: 0.0,
            defects: vec![Default::default(); sides.pantographs.len()],
            reached_defects: vec![Default::default(); sides.pantographs.len()],
        };
        exchange.read_line(sides)?;
        exchange.read_pantographs(sides)?;
        exchange.points[0] = exchange.reached.clone();
        exchange.start_work = exchange.points[0].work();
        Ok(exchange)
    }

    /// Number of strips.
    #[must_use]
    pub fn strip_count(&self) -> usize {
        self.reached.strip_count()
    }

    /// The point `back` steps before the present one, 0 being the present one.
    #[must_use]
    pub fn point(&self, back: usize) -> &Point {
        &self.points[back]
    }

    /// Number of points that can be looked at.
    #[must_use]
    pub fn known(&self) -> usize {
        self.known
    }

    /// Defect of component `axis` of the load on strip `i` at the present point.
    #[must_use]
    pub fn defect(&self, i: usize, axis: usize) -> Defect {
        self.defects[i][axis]
    }

    /// Sets the defect at the point reached.
    pub fn set_reached_defect(&mut self, i: usize, axis: usize, defect: Defect) {
        self.reached_defects[i][axis] = defect;
    }

    /// Energy that the coupling has added since the start, J.
    #[must_use]
    pub fn energy_residual(&self) -> f64 {
        self.points[0].work() - self.start_work
    }

    /// The energy that the coupling added, as a share of the work that crossed the contact (–).
    #[must_use]
    pub fn energy_share(&self) -> f64 {
        if self.crossed > 0.0 {
            self.energy_residual() / self.crossed
        } else {
            0.0
        }
    }

    /// Note for the reader on the energy that the coupling added; nothing where the energy is a small share
    /// of the work that crossed the contact.
    #[must_use]
    pub fn energy_note(&self) -> Option<String> {
        let added = self.energy_residual();
        let share = self.energy_share().abs();
        (share > ENERGY_SHARE).then(|| {
            format!(
                "the coupling {} {:.3} J ({:.1} % of the {:.1} J of work that crossed the contact): a shorter \
                 coupling.macro_step or another coupling.algorithm leaves less",
                if added > 0.0 { "added" } else { "took" },
                added.abs(),
                100.0 * share,
                self.crossed
            )
        })
    }

    /// Reads the outputs of the line into [`Exchange::reached`].
    ///
    /// # Errors
    /// Error reported by the line.
    pub fn read_line(&mut self, sides: &mut Sides<'_>) -> Result<(), SlaveError> {
        sides.line.outputs(&mut self.reached.line)
    }

    /// Reads the outputs of all pantographs into [`Exchange::reached`].
    ///
    /// # Errors
    /// Error reported by a pantograph.
    pub fn read_pantographs(&mut self, sides: &mut Sides<'_>) -> Result<(), SlaveError> {
        let outputs = self.reached.strips.chunks_exact_mut(strip::OUTPUTS);
        sides
            .pantographs
            .iter_mut()
            .zip(outputs)
            .try_for_each(|(slave, values)| slave.outputs(values))
    }

    /// Makes what was reached the present point, at `t` in s.
    pub fn accept(&mut self, t: f64) {
        for i in 0..self.strip_count() {
            // A line under a held strip sees no work.
            let (to, from) = (&self.reached, &self.points[0]);
            let line = to.contact(i)[contact::WORK] - from.contact(i)[contact::WORK];
            let strip = to.strip(i)[strip::WORK] - from.strip(i)[strip::WORK];
            self.crossed += line.abs().max(strip.abs());
        }
        self.reached.from = self.points[0].t;
        self.reached.t = t;
        self.points.rotate_right(1);
        std::mem::swap(&mut self.points[0], &mut self.reached);
        std::mem::swap(&mut self.defects, &mut self.reached_defects);
        self.reached_defects.fill(Default::default());
        self.known = (self.known + 1).min(DEPTH);
    }
}

/// The values that predictions see, one strip and its vertical motion only: what the recurrence of a coupled step maps.
impl Exchange {
    /// Number of these values.
    pub(super) const MEMORY: usize = 4 * DEPTH + 2;

    /// Sets them; all points count as known, `h` s apart, the last one at t = 0, with the contact closed and no
    /// samples: the predictions do not look at them.
    pub(super) fn set_memory(&mut self, memory: &[f64; Self::MEMORY], h: f64) {
        self.known = DEPTH;
        for (back, (point, values)) in self.points.iter_mut().zip(memory.chunks_exact(4)).enumerate() {
            point.t = -(back as f64) * h;
            point.from = point.t - h;
            point.strips[strip::Z] = values[0];
            point.strips[strip::VZ] = values[1];
            point.line[contact::FZ] = values[2];
            point.line[contact::MEAN_FZ] = values[3];
            point.line[contact::FORCE] = -values[2];
            point.line[contact::SAMPLES..contact::SAMPLES + contact::SAMPLE_COUNT].fill(0.0);
        }
        self.defects[0] = Default::default();
        self.defects[0][2] = Defect {
            momentum: memory[4 * DEPTH],
            position: memory[4 * DEPTH + 1],
        };
    }

    /// Reads them.
    pub(super) fn memory(&self) -> [f64; Self::MEMORY] {
        let mut memory = [0.0; Self::MEMORY];
        for (point, values) in self.points.iter().zip(memory.chunks_exact_mut(4)) {
            values[0] = point.strips[strip::Z];
            values[1] = point.strips[strip::VZ];
            values[2] = point.line[contact::FZ];
            values[3] = point.line[contact::MEAN_FZ];
        }
        memory[4 * DEPTH] = self.defects[0][2].momentum;
        memory[4 * DEPTH + 1] = self.defects[0][2].position;
        memory
    }
}
