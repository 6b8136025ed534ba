//! A line with constant matrices and unilateral droppers.
use super::AirOnLine;
use crate::{
    Attachment, DropperLaw, DropperSample, Line, StaticLine, UnilateralStart, UnilateralStep, Wire, WireCurve,
};
use dynamics::LinearForce;
use dynamics::unilateral::{restore_step, save_step};
use dynamics::{Blocks, Force, Layout, LowRank, Motion, PartVisitor, SparseMatrix, StepHistory, Updates, Weights};
use std::sync::Arc;

/// A dropper whose elongation is linear in the coordinates: `δ = δ₀ + g·q`, and whose force acts along `g`.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearDropper {
    /// `δ₀`, m: the elongation at `q = 0`; negative when slack there.
    pub elongation: f64,
    /// The non-zero entries of `g` (–), each with its coordinate.
    pub gradient: Vec<(usize, f64)>,
}

impl LinearDropper {
    fn along(&self, values: &[f64]) -> f64 {
        self.gradient.iter().map(|&(index, g)| g * values[index]).sum()
    }

    /// `δ` and `δ̇`, m and m/s.
    fn extension(&self, motion: &Motion<'_>) -> (f64, f64) {
        (self.elongation + self.along(motion.q), self.along(motion.v))
    }
}

/// Unilateral droppers of fixed direction, with the law of [`crate::Droppers`].
#[derive(Clone, Debug)]
pub struct LinearDroppers {
    law: DropperLaw,
    droppers: Vec<LinearDropper>,
    /// Slope in the assembled tangent, N/m; zero for a dropper that was slack.
    assembled: Vec<f64>,
    /// `δ⁺₀` of each dropper in the present step, m.
    start_closure: Vec<f64>,
    /// Half of the present step, or of the one that has just ended, s.
    half: f64,
    /// Branches of the law at the last evaluation of the forces, one per dropper.
    branches: Vec<u8>,
    /// `δ` at the end of the last step, m.
    elongations: Vec<f64>,
}

impl LinearDroppers {
    /// A batch of droppers with one law.
    #[must_use]
    pub fn new(law: DropperLaw, droppers: Vec<LinearDropper>) -> Self {
        Self {
            law,
            assembled: vec![0.0; droppers.len()],
            start_closure: vec![0.0; droppers.len()],
            half: 0.0,
            branches: vec![0; droppers.len()],
            elongations: vec![0.0; droppers.len()],
            droppers,
        }
    }

    /// The law of all droppers.
    #[must_use]
    pub fn law(&self) -> DropperLaw {
        self.law
    }

    /// The droppers.
    #[must_use]
    pub fn as_slice(&self) -> &[LinearDropper] {
        &self.droppers
    }

    /// Tension of dropper `index`, N.
    #[must_use]
    pub fn tension(&self, index: usize, motion: &Motion<'_>) -> f64 {
        let (elongation, rate) = self.droppers[index].extension(motion);
        self.law.force(self.step(index), elongation, rate)
    }

    /// The present step of dropper `index`.
    fn step(&self, index: usize) -> UnilateralStep {
        UnilateralStep::new(UnilateralStart::Known(self.start_closure[index]), self.half)
    }

    fn slope(&self, index: usize, motion: &Motion<'_>, weights: Weights) -> f64 {
        let (elongation, rate) = self.droppers[index].extension(motion);
        self.law.slope(self.step(index), elongation, rate, weights)
    }

    /// Elongations `δ` of all droppers at the end of the last step, m.
    #[must_use]
    pub fn elongations(&self) -> &[f64] {
        &self.elongations
    }

    /// Number of droppers that exert no force.
    #[must_use]
    pub fn slack_count(&self, motion: &Motion<'_>) -> usize {
        (0..self.droppers.len())
            .filter(|&index| self.tension(index, motion) == 0.0)
            .count()
    }
}

impl Force for LinearDroppers {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        for (index, dropper) in self.droppers.iter().enumerate() {
            let ((elongation, rate), step) = (dropper.extension(motion), self.step(index));
            let tension = self.law.force(step, elongation, rate);
            self.branches[index] = step.branch(step.ahead(elongation, rate), rate, tension);
            for &(coordinate, g) in &dropper.gradient {
                force[coordinate] -= tension * g;
            }
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        for index in 0..self.droppers.len() {
            let slope = self.slope(index, motion, weights);
            self.assembled[index] = slope;
            let gradient = &self.droppers[index].gradient;
            for &(row, g_row) in gradient {
                for &(column, g_column) in gradient {
                    blocks.add(&[row], &[column], &[slope * g_row * g_column]);
                }
            }
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let energies = self
            .droppers
            .iter()
            .map(|dropper| self.law.energy(dropper.extension(motion).0));
        energies.sum()
    }

    fn low_rank(&mut self) -> Option<&mut dyn LowRank> {
        Some(self)
    }

    fn step_history(&mut self) -> Option<&mut dyn StepHistory> {
        Some(self)
    }
}

impl LowRank for LinearDroppers {
    fn push_updates(&mut self, motion: &Motion<'_>, weights: Weights, updates: &mut Updates) {
        for (index, dropper) in self.droppers.iter().enumerate() {
            let coefficient = self.slope(index, motion, weights) - self.assembled[index];
            if coefficient == 0.0 {
                continue;
            }
            // The direction never changes, so one version is enough.
            updates.rank_one(index as u32, 0, coefficient, dropper.gradient.iter().copied());
        }
    }
}

impl StepHistory for LinearDroppers {
    fn begin_step(&mut self, _: &Motion<'_>, h: f64) {
        self.half = 0.5 * h;
    }

    fn continues_to(&mut self, motion: &Motion<'_>) -> bool {
        self.droppers.iter().enumerate().all(|(index, dropper)| {
            let (elongation, rate) = dropper.extension(motion);
            self.law.branch(self.step(index), elongation, rate) == self.branches[index]
        })
    }

    fn end_step(&mut self, motion: &Motion<'_>) {
        for index in 0..self.droppers.len() {
            let (elongation, rate) = self.droppers[index].extension(motion);
            self.start_closure[index] = self.step(index).ahead(elongation, rate);
            self.elongations[index] = elongation;
        }
    }

    fn save(&self, out: &mut Vec<f64>) {
        save_step(self.half, &self.start_closure, out);
    }

    fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        restore_step(&mut self.half, &mut self.start_closure, values);
    }
}

/// A line with constant matrices, unilateral droppers of fixed direction, and a contact wire linear in its coordinates.
///
/// Drop-in replacement for [`Line`]: integrator, contact and coupling cannot tell them apart. [`LinearLine::about`] is
/// a good approximation, because a line in operation moves by centimetres about its static state; matrices of other
/// origin make other linear lines.
#[derive(Clone)]
pub struct LinearLine {
    /// Wires that are linear by themselves; all else is in `force`.
    wires: Vec<Wire>,
    force: LinearForce,
    droppers: LinearDroppers,
    contact_wires: Vec<Arc<dyn WireCurve>>,
    /// Forces of the air, nonlinear as on [`Line`].
    air: AirOnLine,
    /// Line whose positions of wires, supports and droppers are drawn; its forces are not used.
    shape: Option<Line>,
}

impl LinearLine {
    /// A line of given matrices.
    #[must_use]
    pub fn new(force: LinearForce, droppers: LinearDroppers, contact_wires: Vec<Arc<dyn WireCurve>>) -> Self {
        Self {
            wires: Vec::new(),
            force,
            droppers,
            contact_wires,
            air: AirOnLine::default(),
            shape: None,
        }
    }

    /// Adds positions of wires, supports and droppers, taken from `shape`, a line in the same coordinates.
    #[must_use]
    pub fn with_shape(mut self, shape: Line) -> Self {
        self.shape = Some(shape);
        self
    }

    /// The linearisation of `line` about its static state, sag and longitudinal coordinates included, in the same
    /// coordinates of `layout`.
    ///
    /// The spring of a dropper stays unilateral along its static direction; the transverse stiffness `F/length` of a
    /// taut dropper is part of `K`. Wind on the wires acts as on the line itself.
    #[must_use]
    pub fn about(line: &mut Line, layout: &Layout) -> Self {
        let air = line.take_air();
        let mut linear = Linear::at_rest(line, layout);
        let rest = layout.state_at_rest();
        let motion = rest.motion(&[]);

        // Spring and damper of the taut droppers leave the matrices, because they are unilateral.
        let law = line.droppers().law();
        let mut droppers = Vec::new();
        for (index, dropper) in line.droppers().as_slice().iter().enumerate() {
            let length = dropper.length(&motion);
            let direction = (dropper.upper.reference - dropper.lower.reference) / length;
            let end = |node: &Attachment, sign: f64| -> Vec<(usize, f64)> {
                node.columns()
                    .map(|(coordinate, axis)| (coordinate, sign * direction[axis]))
                    .collect()
            };
            let gradient = [end(&dropper.upper, 1.0), end(&dropper.lower, -1.0)].concat();
            let tension = line.droppers().tension(index, &motion);
            if tension > 0.0 {
                for &(row, g_row) in &gradient {
                    linear.load[row] += tension * g_row;
                    for &(column, g_column) in &gradient {
                        linear
                            .stiffness
                            .push((row as u32, column as u32, -law.stiffness * g_row * g_column));
                        linear
                            .damping
                            .push((row as u32, column as u32, -law.damping * g_row * g_column));
                    }
                }
            }
            droppers.push(LinearDropper {
                elongation: length - dropper.unstressed_length,
                gradient,
            });
        }
        let linear = linear
            .with(LinearDroppers::new(law, droppers), curves(line), layout)
            .with_shape(line.clone());
        Self { air, ..linear }
    }

    /// Flat model of two-dimensional programs: straight wires of constant tension with small slopes that move only
    /// vertically, on the static state of a line. Adds coordinates to `layout` and holds those along the track.
    ///
    /// ```text
    /// Q = −K q − D v,   K = Σ ∫ T s,ₓ s,ₓᵀ + EI s,ₓₓ s,ₓₓᵀ dx + springs of supports and arms,   q = 0 at rest
    /// ```
    ///
    /// Droppers are vertical and carry their static forces at `q = 0`; contact sees the static heights of the contact
    /// wire. The sag of the messenger wire, which couples lift and tension, is left out, so the flat model is not the
    /// linearisation of the line.
    #[must_use]
    pub fn flat(statics: &StaticLine, layout: &mut Layout) -> Self {
        let first = layout.coordinates();
        let line = statics.line_in(layout);
        let held = layout.fixed().to_vec();
        for wire in line.wires() {
            for node in wire.geometry().nodes() {
                for index in [node.map.position(0), node.map.slope(0)].into_iter().flatten() {
                    if !held.contains(&index) {
                        layout.fix(index);
                    }
                }
            }
        }
        let mut linear = Linear::at_rest(&mut statics.straight_line(first), layout);
        // The static state is at rest by definition, whatever the forces of straight wires.
        linear.load.fill(0.0);
        let rest = layout.state_at_rest();
        let motion = rest.motion(&[]);
        let law = line.droppers().law();
        let mut droppers = Vec::new();
        for (index, dropper) in line.droppers().as_slice().iter().enumerate() {
            let end = |node: &Attachment, sign: f64| node.coordinate(2).map(|index| (index, sign));
            let ends = [end(&dropper.upper, 1.0), end(&dropper.lower, -1.0)];
            let gradient: Vec<(usize, f64)> = ends.into_iter().flatten().collect();
            let tension = line.droppers().tension(index, &motion);
            for &(row, g) in &gradient {
                linear.load[row] += tension * g;
            }
            droppers.push(LinearDropper {
                elongation: dropper.length(&motion) - dropper.unstressed_length,
                gradient,
            });
        }
        linear
            .with(LinearDroppers::new(law, droppers), curves(&line), layout)
            .with_shape(line)
    }

    /// Line whose positions of wires, supports and droppers are drawn; its forces are not used.
    #[must_use]
    pub fn shape(&self) -> Option<&Line> {
        self.shape.as_ref()
    }

    /// See [`LinearLine::shape`].
    pub fn shape_mut(&mut self) -> Option<&mut Line> {
        self.shape.as_mut()
    }

    /// Ends and tension of every dropper; none without a shape.
    #[must_use]
    pub fn dropper_samples(&self, motion: &Motion<'_>) -> Vec<DropperSample> {
        let ends = self.shape.iter().flat_map(|shape| shape.dropper_samples(motion));
        ends.enumerate()
            .map(|(index, ends)| DropperSample {
                force: self.droppers.tension(index, motion),
                ..ends
            })
            .collect()
    }

    /// Visits every contribution with the name of its part, always in the same order.
    pub fn parts(&mut self, visit: &mut PartVisitor<'_>) {
        for wire in &mut self.wires {
            visit("wires", wire);
        }
        visit("wires", &mut self.force);
        visit("droppers", &mut self.droppers);
        self.air.parts(visit);
    }

    /// Visits every contribution, in the order of [`LinearLine::parts`].
    pub fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.parts(&mut |_, force| visit(force));
    }

    /// Number of contact wires.
    #[must_use]
    pub fn contact_wires(&self) -> usize {
        self.contact_wires.len()
    }

    /// Contact wire `wire` (from 0) as contact sees it.
    #[must_use]
    pub fn contact_curve(&self, wire: usize) -> Arc<dyn WireCurve> {
        Arc::clone(&self.contact_wires[wire])
    }

    /// The droppers.
    #[must_use]
    pub fn droppers(&self) -> &LinearDroppers {
        &self.droppers
    }

    /// Potential energy, J; zero at rest but for the droppers' strain.
    #[must_use]
    pub fn energy(&self, motion: &Motion<'_>) -> f64 {
        let wires: f64 = self.wires.iter().map(|wire| wire.energy(motion)).sum();
        wires + self.force.energy(motion) + self.droppers.energy(motion)
    }
}

/// The contact wires of a line as contact sees them.
fn curves(line: &Line) -> Vec<Arc<dyn WireCurve>> {
    (0..line.contact_wires()).map(|wire| line.contact_curve(wire)).collect()
}

/// A line to first order without its droppers' springs: its wires, as far as they can be linear by themselves, and the
/// matrices of all else as entries (row, column, value) that may repeat.
struct Linear {
    wires: Vec<Wire>,
    /// Force of the whole line at rest, N.
    load: Vec<f64>,
    stiffness: Vec<(u32, u32, f64)>,
    damping: Vec<(u32, u32, f64)>,
    mass: Vec<(u32, u32, f64)>,
}

impl Linear {
    fn at_rest(line: &mut Line, layout: &Layout) -> Self {
        let rest = layout.state_at_rest();
        let motion = rest.motion(&[]);
        let mut load = vec![0.0; layout.coordinates()];
        line.forces(&mut |part| part.add_force(&motion, &mut load));
        let wires: Option<Vec<Wire>> = line.wires().iter().map(Wire::linearised).collect();
        let mut in_matrices = |visit: &mut dyn FnMut(&mut dyn Force)| match &wires {
            Some(_) => line.attachments(&mut |_, force| visit(force)),
            None => line.forces(visit),
        };
        let mut tangent = |weights: Weights| {
            Blocks::collect(|blocks| in_matrices(&mut |part| part.add_tangent(&motion, weights, blocks)))
        };
        let stiffness = tangent(Weights { q: 1.0, v: 0.0 });
        let damping = tangent(Weights { q: 0.0, v: 1.0 });
        let mass = Blocks::collect(|blocks| in_matrices(&mut |part| part.add_mass(blocks)));
        Self {
            wires: wires.unwrap_or_default(),
            load,
            stiffness,
            damping,
            mass,
        }
    }

    /// The line with these droppers.
    fn with(mut self, droppers: LinearDroppers, contact_wires: Vec<Arc<dyn WireCurve>>, layout: &Layout) -> LinearLine {
        let rest = layout.state_at_rest();
        let motion = rest.motion(&[]);
        let mut of_wires = vec![0.0; self.load.len()];
        for wire in &mut self.wires {
            wire.add_force(&motion, &mut of_wires);
        }
        for (load, of_wires) in self.load.iter_mut().zip(&of_wires) {
            *load -= of_wires;
        }
        let matrix = |entries| SparseMatrix::from_entries(of_wires.len(), entries);
        let force = LinearForce::new(
            self.load,
            matrix(self.stiffness),
            matrix(self.damping),
            matrix(self.mass),
        );
        LinearLine {
            wires: self.wires,
            ..LinearLine::new(force, droppers, contact_wires)
        }
    }
}
