//! Line and pantographs as one [`System`].

use catenary::{ContactTotal, OnWire, OverheadLine, Slackening, StripContact, adopt_state, follow_strips};
use dynamics::{Constraint, Continuity, Force, Layout, Motion, PartVisitor, Stage, State, System};
use vehicle::PantographModel;

use control::Reading;

use component::Point;
use component::exchange::{contact, strip};

use crate::time_shares::Profile;

/// Line, pantographs and the contacts between them.
pub(super) struct Whole {
    pub layout: Layout,
    pub line: Box<dyn OverheadLine>,
    pub pantographs: Vec<PantographModel>,
    /// Pantograph (from 0) of each strip, and the number of strips on it.
    pub heads: Vec<(usize, usize)>,
    /// Contacts of each strip in turn with each contact wire in turn.
    pub contacts: Vec<StripContact>,
    pub slackening: Slackening,
    /// Here except while contributions are visited for it.
    pub profile: Option<Box<Profile>>,
}

impl System for Whole {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        let Some(mut profile) = self.profile.take_if(|profile| profile.looks()) else {
            return self.parts(&mut |_, force| visit(force));
        };
        self.parts(&mut |part, force| {
            profile.turn_to(part);
            visit(force);
        });
        profile.enter(Stage::Integration);
        self.profile = Some(profile);
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        let Some(mut profile) = self.profile.take_if(|profile| profile.looks()) else {
            return self.constraints_of_parts(&mut |_, constraint| visit(constraint));
        };
        self.constraints_of_parts(&mut |part, constraint| {
            profile.turn_to(part);
            visit(constraint);
        });
        profile.enter(Stage::Integration);
        self.profile = Some(profile);
    }

    fn enter(&mut self, stage: Stage) {
        if let Some(profile) = &mut self.profile {
            profile.enter(stage);
        }
    }

    fn follow(&mut self, state: &mut State, u: &[f64]) -> Continuity {
        let continuity = follow_strips(&mut *self.line, &mut self.contacts, &mut self.layout, state, u);
        if continuity != Continuity::Kept {
            self.slackening.restart(self.line.elongations());
            if let Some(profile) = &mut self.profile {
                profile.leave_out();
            }
        }
        continuity
    }

    fn adopt(&mut self, state: &State) -> Continuity {
        let continuity = adopt_state(&mut *self.line, &mut self.contacts, &mut self.layout, state);
        if continuity != Continuity::Kept {
            self.slackening.forget();
        }
        continuity
    }
}

impl Whole {
    /// Visits every force with the name of its part in the summary.
    fn parts(&mut self, visit: &mut PartVisitor<'_>) {
        self.line.parts(visit);
        for pantograph in &mut self.pantographs {
            pantograph.parts(visit);
        }
        for contact in &mut self.contacts {
            visit("contact", contact.force());
        }
    }

    /// Visits every constraint with the name of its part in the summary.
    fn constraints_of_parts(&mut self, visit: &mut dyn FnMut(&'static str, &mut dyn Constraint)) {
        for pantograph in &mut self.pantographs {
            pantograph.vehicle_constraints(&mut |constraint| visit("vehicle", constraint));
            pantograph.pantograph_constraints(&mut |constraint| visit("pantograph", constraint));
        }
        for constraint in self.contacts.iter_mut().filter_map(StripContact::constraint) {
            visit("contact", constraint);
        }
    }

    /// From here on time goes to `part`.
    pub fn turn_to(&mut self, part: &'static str) {
        if let Some(profile) = &mut self.profile {
            profile.turn_to(part);
        }
    }

    /// A step has ended, with whatever is done after it.
    pub fn step_done(&mut self) {
        if let Some(profile) = &mut self.profile {
            profile.step_done();
        }
    }

    /// Reads the instruments of pantograph `head` (from 0).
    pub fn read_instruments(&self, motion: &Motion<'_>, state: &State, head: usize, reading: &mut Reading) {
        self.pantographs[head].read(motion, &state.v_dot, reading);
        let contacts = self.contacts.chunks_exact(self.line.contact_wires());
        let on_head = contacts.zip(&self.heads).filter(|(_, (of, _))| *of == head);
        let pressed = on_head.filter_map(|(contacts, _)| {
            ContactTotal::of(
                contacts
                    .iter()
                    .filter_map(|contact| contact.state(motion, &state.lambda)),
            )
        });
        reading.force = pressed.map(|total| -total.on_strip.z).sum();
    }

    /// Writes what is exchanged between the two sides; the supports of these numbers (from 1) are read out.
    pub fn read(&self, (motion, lambda): (&Motion<'_>, &[f64]), supports: &[usize], point: &mut Point) {
        let contacts = self.contacts.chunks_exact(self.line.contact_wires());
        for (i, contacts) in contacts.enumerate() {
            let frame = contacts[0].strip(motion);
            let values = &mut point.strips[i * strip::OUTPUTS..(i + 1) * strip::OUTPUTS];
            for axis in 0..3 {
                values[strip::X + axis] = frame.position[axis];
                values[strip::VX + axis] = frame.velocity[axis];
            }
            values[strip::ROLL] = frame.axes[(2, 1)].atan2(frame.axes[(1, 1)]);
            let (head, strips) = self.heads[i];
            [values[strip::WIND_DRAG], values[strip::WIND_LIFT]] = self.pantographs[head]
                .wind_on_head(motion)
                .map(|force| force / strips as f64);
            values[strip::CONTROL] = self.pantographs[head].drive_force(motion) / strips as f64;
            let states = contacts.iter().filter_map(|contact| contact.state(motion, lambda));
            let total = ContactTotal::of(states);
            let on_strip = total.map(|total| total.on_strip);
            let position = total.map_or(frame.position, |total| total.position);
            let force = total.map_or(0.0, |total| total.force);
            let values = &mut point.line[i * contact::COUNT..(i + 1) * contact::COUNT];
            for axis in 0..3 {
                values[contact::FX + axis] = on_strip.map_or(0.0, |force| force[axis]);
                values[contact::MEAN_FX + axis] = values[contact::FX + axis];
            }
            values[contact::FORCE] = force;
            values[contact::X] = position.x;
            values[contact::Y] = position.y;
            values[contact::WIRE_Z] = position.z;
            values[contact::GAP] = total.map_or(f64::MAX, |total| total.gap);
        }
        let first = self.heads.len() * contact::COUNT;
        for (k, &support) in supports.iter().enumerate() {
            point.line[first + k] = self.line.uplift(support - 1, motion.q);
        }
    }
}
