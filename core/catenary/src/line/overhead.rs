//! Interface of any line for contact and coupling.
use crate::{DropperSample, Line, LinearLine, OnWire, WireCurve, WireName};
use dynamics::{Continuity, Force, Layout, Motion, PartVisitor, State};
use nalgebra::Vector3;
use std::ops::Range;
use std::sync::Arc;

/// A line as contact and coupling see it: the nonlinear [`Line`] in any of its dimensions, a [`LinearLine`] or a
/// [`crate::WindowedLine`]. [`crate::scene_line`] makes the line of a scene.
pub trait OverheadLine: Send {
    /// Visits every contribution with the name of its part, always in the same order.
    fn parts(&mut self, visit: &mut PartVisitor<'_>);

    /// Visits every contribution, in the order of [`OverheadLine::parts`].
    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.parts(&mut |_, force| visit(force));
    }

    /// Number of contact wires.
    fn contact_wires(&self) -> usize {
        1
    }

    /// A contact wire as a strip sees it; `pair` is the number of the strip and that of the wire, from 0.
    fn contact_curve(&self, pair: (usize, usize)) -> Arc<dyn WireCurve>;

    /// Number of droppers that exert no force.
    fn slack_count(&self, motion: &Motion<'_>) -> usize;

    /// Elongations of all droppers that can go slack, m, always in the same order: at the end of the last step, or
    /// after a later [`OverheadLine::follow`].
    fn elongations(&self) -> &[f64];

    /// Potential energy, J.
    fn energy(&self, motion: &Motion<'_>) -> f64;

    /// Positions of both ends and tension of every dropper, for pictures.
    fn dropper_samples(&self, motion: &Motion<'_>) -> Vec<DropperSample>;

    /// Wires, supports and droppers of the line, for uplift and pictures; none for a line given by matrices alone.
    fn shape(&self) -> Option<&Line>;

    /// See [`OverheadLine::shape`].
    fn shape_mut(&mut self) -> Option<&mut Line>;

    /// Number of supports, the ends included; 0 for a line without supports of its own.
    fn support_count(&self) -> usize {
        self.shape().map_or(0, Line::support_count)
    }

    /// Counts uplift from the state `q` on.
    fn set_uplift_reference(&mut self, q: &[f64]) {
        if let Some(shape) = self.shape_mut() {
            shape.set_uplift_reference(q);
        }
    }

    /// Rise of the contact wire at support `support` (from 0) above its height in the reference state, m.
    fn uplift(&self, support: usize, q: &[f64]) -> f64 {
        self.shape().map_or(0.0, |shape| shape.uplift(support, q))
    }

    /// Rate of [`OverheadLine::uplift`], m/s.
    fn uplift_rate(&self, support: usize, q: &[f64], v: &[f64]) -> f64 {
        self.shape().map_or(0.0, |shape| shape.uplift_rate(support, q, v))
    }

    /// Points along the wires of a name for pictures, m, a polyline for each, not many more than `most` points in all.
    fn polylines(&self, name: WireName, q: &[f64], most: usize) -> Vec<Vec<Vector3<f64>>> {
        self.shape()
            .map_or_else(Vec::new, |shape| shape.polylines_of(name, most, |node| node.at(q).0))
    }

    /// Moves the detailed part of the model along with strips between the positions `strips` (m along the track), at
    /// the end of a step; see [`dynamics::System::follow`].
    fn follow(&mut self, strips: (f64, f64), state: &mut State) -> Continuity {
        let _ = (strips, state);
        Continuity::Kept
    }

    /// See [`dynamics::System::adopt`].
    fn adopt(&mut self, state: &State) -> Continuity {
        let _ = state;
        Continuity::Kept
    }

    /// State of the line at rest under its strips beyond its coordinates, see [`OverheadLine::continue_from`].
    fn settled(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Continues from the [`OverheadLine::settled`] state of another such line.
    fn continue_from(&mut self, settled: &[f64]) {
        let _ = settled;
    }

    /// Coordinates of the line, and which of them are held; none for a line that never changes these.
    fn held(&self) -> Option<(Range<usize>, &[usize])> {
        None
    }
}

/// [`dynamics::System::follow`] for a system of a line and strips on it; `contacts` are those of each strip in turn
/// with each contact wire in turn.
pub fn follow_strips<C: OnWire>(
    line: &mut dyn OverheadLine,
    contacts: &mut [C],
    layout: &mut Layout,
    state: &mut State,
    u: &[f64],
) -> Continuity {
    let motion = state.motion(u);
    let positions = contacts.iter().map(|contact| contact.strip(&motion).position.x);
    let strips = positions.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
        (low.min(x), high.max(x))
    });
    let continuity = line.follow(strips, state);
    take_over(continuity, line, contacts, layout);
    continuity
}

/// [`dynamics::System::adopt`] for a system of a line and strips on it.
pub fn adopt_state<C: OnWire>(
    line: &mut dyn OverheadLine,
    contacts: &mut [C],
    layout: &mut Layout,
    state: &State,
) -> Continuity {
    let continuity = line.adopt(state);
    take_over(continuity, line, contacts, layout);
    continuity
}

fn take_over<C: OnWire>(continuity: Continuity, line: &dyn OverheadLine, contacts: &mut [C], layout: &mut Layout) {
    if continuity != Continuity::Replaced {
        return;
    }
    if let Some((range, held)) = line.held() {
        layout.fix_within(range, held);
    }
    let wires = line.contact_wires();
    for (index, contact) in contacts.iter_mut().enumerate() {
        contact.set_curve(line.contact_curve((index / wires, index % wires)));
    }
}

impl OverheadLine for Line {
    fn parts(&mut self, visit: &mut PartVisitor<'_>) {
        self.parts(visit);
    }

    fn contact_wires(&self) -> usize {
        self.contact_wires()
    }

    fn contact_curve(&self, (_, wire): (usize, usize)) -> Arc<dyn WireCurve> {
        self.contact_curve(wire)
    }

    fn slack_count(&self, motion: &Motion<'_>) -> usize {
        self.slack_count(motion)
    }

    fn elongations(&self) -> &[f64] {
        self.droppers().elongations()
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        self.energy(motion)
    }

    fn dropper_samples(&self, motion: &Motion<'_>) -> Vec<DropperSample> {
        self.dropper_samples(motion).collect()
    }

    fn shape(&self) -> Option<&Line> {
        Some(self)
    }

    fn shape_mut(&mut self) -> Option<&mut Line> {
        Some(self)
    }
}

impl OverheadLine for LinearLine {
    fn parts(&mut self, visit: &mut PartVisitor<'_>) {
        self.parts(visit);
    }

    fn contact_wires(&self) -> usize {
        self.contact_wires()
    }

    fn contact_curve(&self, (_, wire): (usize, usize)) -> Arc<dyn WireCurve> {
        self.contact_curve(wire)
    }

    fn slack_count(&self, motion: &Motion<'_>) -> usize {
        self.droppers().slack_count(motion)
    }

    fn elongations(&self) -> &[f64] {
        self.droppers().elongations()
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        self.energy(motion)
    }

    fn dropper_samples(&self, motion: &Motion<'_>) -> Vec<DropperSample> {
        self.dropper_samples(motion)
    }

    fn shape(&self) -> Option<&Line> {
        self.shape()
    }

    fn shape_mut(&mut self) -> Option<&mut Line> {
        self.shape_mut()
    }
}
