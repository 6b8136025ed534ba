//! What both sides have put out at the last communication points.

use crate::interface::{contact, strip};
use crate::slave::SlaveError;

use super::Sides;
use super::waveform::Shape;

/// Communication points that predictions can look back to.
const DEPTH: usize = 3;

/// Force components of a defect.
const AXES: usize = 3;

/// What the load on a strip has left undone so far: the force of the line less that of the load, integrated once and twice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Defect {
    /// Momentum that the strip still has to get, N s.
    pub momentum: f64,
    /// The same for mass times position, N s² (kg m).
    pub position: f64,
}

impl Defect {
    /// The straight line that, added to the load of the next `h` s, takes both to zero; only the momentum with `degree` 0.
    ///
    /// In terms of [`Shape`]: mean `p/h`, moment `(q + h p)/h²`.
    #[must_use]
    pub fn correction(&self, h: f64, degree: usize) -> Shape {
        let mean = self.momentum / h;
        let moment = (self.position + h * self.momentum) / (h * h);
        let slope = if degree == 0 { 0.0 } else { 6.0 * (0.5 * mean - moment) };
        Shape([mean, slope, 0.0])
    }
}

/// All outputs at one communication point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// Time, s.
    pub t: f64,
    /// Start of the step that led here, s; `t` itself at the first point.
    pub from: f64,
    /// Outputs of the line.
    pub line: Vec<f64>,
    /// Outputs of the pantographs, one after the other.
    pub strips: Vec<f64>,
}

impl Point {
    fn new(t: f64, strips: usize, line_outputs: usize) -> Self {
        Self {
            t,
            from: t,
            line: vec![0.0; line_outputs],
            strips: vec![0.0; strips * strip::OUTPUTS],
        }
    }

    /// Outputs of the line that belong to strip `i`.
    #[must_use]
    pub fn contact(&self, i: usize) -> &[f64] {
        &self.line[i * contact::COUNT..(i + 1) * contact::COUNT]
    }

    /// Outputs of pantograph `i`.
    #[must_use]
    pub fn strip(&self, i: usize) -> &[f64] {
        &self.strips[i * strip::OUTPUTS..(i + 1) * strip::OUTPUTS]
    }

    /// Number of strips.
    #[must_use]
    pub fn strip_count(&self) -> usize {
        self.strips.len() / strip::OUTPUTS
    }

    /// Work of the strips on the line and of the contact on the strips, J.
    #[must_use]
    pub fn work(&self) -> f64 {
        (0..self.strip_count())
            .map(|i| self.contact(i)[contact::WORK] + self.strip(i)[strip::WORK])
            .sum()
    }
}

/// The last communication points, newest first, and the one being computed.
#[derive(Clone, Debug)]
pub struct Exchange {
    points: [Point; DEPTH],
    known: usize,
    /// What the step under way has reached; becomes the present point by [`Exchange::accept`].
    pub reached: Point,
    start_work: f64,
    /// Defects at the present point and at the one reached, per strip and component.
    defects: Vec<[Defect; AXES]>,
    reached_defects: Vec<[Defect; AXES]>,
}

impl Exchange {
    /// Reads the outputs of both sides at the start, `t` in s.
    ///
    /// # Errors
    /// What a slave reports.
    pub fn start(sides: &mut Sides<'_>, t: f64, line_outputs: usize) -> Result<Self, SlaveError> {
        let point = Point::new(t, sides.pantographs.len(), line_outputs);
        let mut exchange = Self {
            points: std::array::from_fn(|_| point.clone()),
            known: 1,
            reached: point,
            start_work: 0.0,
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

    /// How many points can be looked at.
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

    /// Reads the outputs of the line into [`Exchange::reached`].
    ///
    /// # Errors
    /// What the line reports.
    pub fn read_line(&mut self, sides: &mut Sides<'_>) -> Result<(), SlaveError> {
        sides.line.outputs(&mut self.reached.line)
    }

    /// Reads the outputs of all pantographs into [`Exchange::reached`].
    ///
    /// # Errors
    /// What a pantograph reports.
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
        self.reached.from = self.points[0].t;
        self.reached.t = t;
        self.points.rotate_right(1);
        std::mem::swap(&mut self.points[0], &mut self.reached);
        std::mem::swap(&mut self.defects, &mut self.reached_defects);
        self.reached_defects.fill(Default::default());
        self.known = (self.known + 1).min(DEPTH);
    }
}
