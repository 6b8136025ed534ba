//! What contact and coupling need of a line, whatever it is made of.
use crate::{DropperSample, Line, LinearLine, OnWire, WireCurve, WireName};
use dynamics::{Continuity, Force, Layout, Motion, State};
use nalgebra::Vector3;
use std::ops::Range;
use std::sync::Arc;

/// A line as the strips' side sees it: the nonlinear [`Line`] in any of its dimensions, or a [`LinearLine`]. The line of
/// a scene is made by [`crate::scene_line`].
pub trait OverheadLine: Send {
    /// Visits every contribution, always in the same order.
    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force));

    /// The contact wire as contact sees it.
    fn contact_curve(&self) -> Arc<dyn WireCurve>;

    /// Number of droppers that exert no force.
    fn slack_count(&self, motion: &Motion<'_>) -> usize;

    /// Elongations of all droppers that can go slack, m, always in the same order: at the end of the last step, or where
    /// [`OverheadLine::follow`] has put the state since.
    fn elongations(&self) -> &[f64];

    /// Potential energy, J.
    fn energy(&self, motion: &Motion<'_>) -> f64;

    /// Both ends and the tension of every dropper, for pictures.
    fn dropper_samples(&self, motion: &Motion<'_>) -> Vec<DropperSample>;

    /// The wires, supports and droppers behind, where the line has them: for uplift and pictures.
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
    fn uplift_rate(&self, support: usize, v: &[f64]) -> f64 {
        self.shape().map_or(0.0, |shape| shape.uplift_rate(support, v))
    }

    /// Points along a wire, m, not many more than `most`: what a picture shows.
    fn polyline(&self, name: WireName, q: &[f64], most: usize) -> Vec<Vector3<f64>> {
        let Some(shape) = self.shape() else {
            return Vec::new();
        };
        let count = shape.wire(name).geometry().nodes().len();
        let stride = count.div_ceil(most);
        let points = shape.polyline(name, q).enumerate();
        points
            .filter(|(i, _)| i % stride == 0 || i + 1 == count)
            .map(|(_, r)| r)
            .collect()
    }

    /// Follows strips between the positions `strips` (m along the track) with what is modelled around them, at the end of a
    /// step; see [`dynamics::System::follow`].
    fn follow(&mut self, strips: (f64, f64), state: &mut State) -> Continuity {
        let _ = (strips, state);
        Continuity::Kept
    }

    /// See [`dynamics::System::adopt`].
    fn adopt(&mut self, state: &State) -> Continuity {
        let _ = state;
        Continuity::Kept
    }

    /// The line's own coordinates and those of them that are held, where that changes from time to time.
    fn held(&self) -> Option<(Range<usize>, &[usize])> {
        None
    }
}

/// What [`dynamics::System::follow`] has to do for a system with a line and strips on it.
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

/// What [`dynamics::System::adopt`] has to do for a system with a line and strips on it.
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
    for contact in contacts {
        contact.set_curve(line.contact_curve());
    }
}

impl OverheadLine for Line {
    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.forces(visit);
    }

    fn contact_curve(&self) -> Arc<dyn WireCurve> {
        self.contact_curve()
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
    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.forces(visit);
    }

    fn contact_curve(&self) -> Arc<dyn WireCurve> {
        self.contact_curve()
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
