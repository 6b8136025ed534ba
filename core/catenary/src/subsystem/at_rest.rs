//! The line at rest over strips of given heights.
use crate::{
    CatenaryError, ContactTangent, OverheadLine, PrescribedStrip, SlidingJoint, StaticLine, StripStart, Subsystem,
    scene_line,
};
use contact::STRIP_VALUES;
use dynamics::{Constraint, Force, Layout, State, StaticOptions, System, solve_static};
use scene::{ContactLaw, Scene};

/// The line of a scene in the static equilibrium under its strips, with the contact law of the scene.
pub struct LineAtRest(Law);

enum Law {
    Penalty(Box<Subsystem>),
    SlidingJoint(Box<Joined>),
}

/// A line on strips that are held on its contact wire.
struct Joined {
    layout: Layout,
    line: Box<dyn OverheadLine>,
    joints: Vec<SlidingJoint>,
    state: State,
}

impl System for Joined {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.line.forces(visit);
        for joint in &mut self.joints {
            visit(joint);
        }
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        for joint in &mut self.joints {
            visit(joint);
        }
    }
}

impl LineAtRest {
    /// The line of a solved static state with the strips of the scene; [`LineAtRest::start`] must follow.
    ///
    /// # Errors
    /// See [`CatenaryError`].
    pub fn new(scene: &Scene, statics: &StaticLine) -> Result<Self, CatenaryError> {
        let (_, contact) = scene.modelled_line().ok_or(CatenaryError::SuppliedLine)?;
        if contact.law == ContactLaw::Penalty {
            return Ok(Self(Law::Penalty(Box::new(Subsystem::new(scene, statics)?))));
        }
        let mut layout = Layout::new();
        let line = scene_line(scene, statics, &mut layout)?;
        let joints = (0..scene.strip_count()).map(|strip| {
            let first = strip * STRIP_VALUES;
            SlidingJoint::new(
                line.contact_curve((strip, 0)),
                Box::new(PrescribedStrip { first }),
                layout.add_constraints(1),
                ContactTangent::Exact,
            )
        });
        let joints = joints.collect();
        let state = layout.state_at_rest();
        Ok(Self(Law::SlidingJoint(Box::new(Joined {
            layout,
            line,
            joints,
            state,
        }))))
    }

    /// Puts the strips at rest at these places, and lets the line settle over them.
    pub fn start(&mut self, strips: &[StripStart]) -> Result<(), CatenaryError> {
        match &mut self.0 {
            Law::Penalty(line) => {
                let standing: Vec<StripStart> =
                    strips.iter().map(|&strip| StripStart { speed: 0.0, ..strip }).collect();
                line.start(&standing)
            }
            Law::SlidingJoint(joined) => {
                let mut u = vec![0.0; strips.len() * STRIP_VALUES];
                for (values, strip) in u.chunks_exact_mut(STRIP_VALUES).zip(strips) {
                    values[..3].copy_from_slice(&[strip.x, strip.y, strip.height]);
                }
                let mut state = std::mem::take(&mut joined.state);
                let found = solve_static(&mut **joined, &mut state, &u, &StaticOptions::default());
                joined.state = state;
                found?;
                Ok(())
            }
        }
    }

    /// Contact force that a strip (from 0) bears, N; see [`crate::ContactState::borne`].
    pub fn force(&mut self, strip: usize) -> f64 {
        match &mut self.0 {
            Law::Penalty(line) => line.borne(strip),
            Law::SlidingJoint(joined) => joined.state.lambda[strip],
        }
    }

    /// State beyond the coordinates, see [`OverheadLine::settled`].
    pub fn settled(&mut self) -> Vec<f64> {
        match &mut self.0 {
            Law::Penalty(line) => line.line().0.settled(),
            Law::SlidingJoint(joined) => joined.line.settled(),
        }
    }

    /// Coordinates of the line.
    pub fn q(&mut self) -> &[f64] {
        match &mut self.0 {
            Law::Penalty(line) => line.line().1.q,
            Law::SlidingJoint(joined) => &joined.state.q,
        }
    }
}
