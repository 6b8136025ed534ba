//! Values that cross the coupling, declared once: name, unit, meaning and order in the flat slices of a
//! `cosim::slave::Slave`.
//!
//! | side | inputs | outputs |
//! | --- | --- | --- |
//! | line | [`strip`] motion of each strip | [`contact`] of each strip, then [`support`] uplift of each support |
//! | pantograph | [`load`] | [`strip`] motion, work and wind |
//!
//! The names are those of the FMU variables.

/// Declares a group of signals: index, name, unit and meaning of each in the order of the flat slices. A signal without
/// unit is a Boolean.
macro_rules! group {
    (
        $(#[$doc:meta])*
        $module:ident: $group:literal {
            $($index:ident: $name:literal [$($unit:literal)?], $text:literal;)+
        }
        $($rest:item)*
    ) => {
        $(#[$doc])*
        pub mod $module {
            use crate::DeclaredSignal;

            #[allow(non_camel_case_types, clippy::upper_case_acronyms, reason = "names of the constants below")]
            enum Index {
                $($index),+
            }

            /// Name of the group in names of signals.
            pub const GROUP: &str = $group;
            /// Signals of a member, by index.
            pub const SIGNALS: [DeclaredSignal; [$($name),+].len()] = [
                $(DeclaredSignal { name: $name, kind: group!(@kind $($unit)?), description: $text }),+
            ];
            $(
                #[doc = concat!("Index: ", $text $(, ", ", $unit)?, ".")]
                pub const $index: usize = Index::$index as usize;
            )+
            $($rest)*
        }
    };
    (@kind $unit:literal) => { crate::SignalKind::Real($unit) };
    (@kind) => { crate::SignalKind::Boolean };
}

group! {
    /// Motion of a collector strip: inputs of the line, and with work and wind the outputs of a pantograph.
    ///
    /// The components x, y, z of position and velocity follow each other.
    strip: "strip" {
        X: "x" ["m"], "Position of the strip's middle along the track";
        Y: "y" ["m"], "Lateral position of the strip's middle, positive to the left";
        Z: "z" ["m"], "Height of the strip's middle above the top of rail";
        VX: "vx" ["m/s"], "Velocity of the strip along the track";
        VY: "vy" ["m/s"], "Lateral velocity of the strip";
        VZ: "vz" ["m/s"], "Vertical velocity of the strip";
        ROLL: "roll" ["rad"], "Roll angle of the strip about the direction of travel";
        WORK: "work" ["J"], "Work done by the contact on the strip since the start";
        WIND_DRAG: "wind.drag" ["N"], "Drag of the wind on the body of the strip, along the air that meets it";
        WIND_LIFT: "wind.lift" ["N"],
            "Lift of the wind on the body of the strip, across the air that meets it, positive upward";
        CONTROL: "control.force" ["N"],
            "Force of the controlled drive of the pantograph, of which each strip has an equal part";
    }

    /// Number of values of a motion.
    pub const MOTION: usize = WORK;
    /// Number of outputs of a pantograph.
    pub const OUTPUTS: usize = SIGNALS.len();
}

group! {
    /// Outputs of the line per strip. The first [`COUNT`](contact::COUNT) are exchanged; the others are variables of
    /// the FMU only.
    ///
    /// The components x, y, z of forces follow each other.
    contact: "contact" {
        FX: "fx" ["N"], "Force on the strip in x";
        FY: "fy" ["N"], "Force on the strip in y";
        FZ: "fz" ["N"], "Force on the strip in z";
        MEAN_FX: "mean_fx" ["N"], "Mean of the force on the strip in x over the last communication step";
        MEAN_FY: "mean_fy" ["N"], "Mean of the force on the strip in y over the last communication step";
        MEAN_FZ: "mean_fz" ["N"], "Mean of the force on the strip in z over the last communication step";
        Y: "y" ["m"], "Lateral position of the contact point";
        FORCE: "force" ["N"], "Normal contact force, compression positive";
        SAMPLES: "sample[1]" ["N"], "Normal contact force at 1/10 of the last communication step";
        SAMPLE_2: "sample[2]" ["N"], "Normal contact force at 2/10 of the last communication step";
        SAMPLE_3: "sample[3]" ["N"], "Normal contact force at 3/10 of the last communication step";
        SAMPLE_4: "sample[4]" ["N"], "Normal contact force at 4/10 of the last communication step";
        SAMPLE_5: "sample[5]" ["N"], "Normal contact force at 5/10 of the last communication step";
        SAMPLE_6: "sample[6]" ["N"], "Normal contact force at 6/10 of the last communication step";
        SAMPLE_7: "sample[7]" ["N"], "Normal contact force at 7/10 of the last communication step";
        SAMPLE_8: "sample[8]" ["N"], "Normal contact force at 8/10 of the last communication step";
        SAMPLE_9: "sample[9]" ["N"], "Normal contact force at 9/10 of the last communication step";
        SAMPLE_10: "sample[10]" ["N"], "Normal contact force at 10/10 of the last communication step";
        X: "x" ["m"], "Position of the contact point along the track";
        WIRE_Z: "wire.z" ["m"], "Height of the contact wire at the contact point";
        GAP: "gap" ["m"], "Gap between strip and wire, positive when open";
        WORK: "work" ["J"], "Work done by the strip on the line since the start";
        MEAN_FORCE: "mean_force" ["N"], "Mean of the normal contact force over the last communication step";
        WIRE_VZ: "wire.vz" ["m/s"], "Vertical velocity of the contact wire at the contact point";
        CLOSED: "closed" [], "Whether strip and wire touch";
    }

    /// Number of force samples in a communication step, from [`SAMPLES`] on.
    pub const SAMPLE_COUNT: usize = X - SAMPLES;
    /// Number of exchanged values per strip.
    pub const COUNT: usize = MEAN_FORCE;
}

group! {
    /// Outputs of the line per strip and contact wire, where the line has several; the values of [`contact`] are their
    /// sum. Variables of the FMU only.
    contact_of_wire: "contact" {
        FORCE: "force" ["N"], "Normal contact force with contact wire {}, compression positive";
        X: "x" ["m"], "Position of the contact point with contact wire {} along the track";
        Y: "y" ["m"], "Lateral position of the contact point with contact wire {}";
        Z: "z" ["m"], "Height of contact wire {} at the contact point";
        GAP: "gap" ["m"], "Gap between strip and contact wire {}, positive when open";
        CLOSED: "closed" [], "Whether strip and contact wire {} touch";
    }

    /// Name of a part of a contact.
    pub const PART: &str = "wire";
}

group! {
    /// Outputs of the line per recorded support.
    support: "support" {
        UPLIFT: "uplift" ["m"], "Rise of the contact wire at support {} above its height at the start";
    }
}

group! {
    /// Inputs of a pantograph per strip, from contact 1 on.
    ///
    /// The components x, y, z of the force follow each other.
    load: "contact" {
        FX: "fx" ["N"], "Force on the strip along the track";
        FY: "fy" ["N"], "Lateral force on the strip";
        FZ: "fz" ["N"], "Vertical force on the strip, negative when the wire presses it down";
        Y: "y" ["m"], "Lateral position of the contact";
    }

    /// Number of inputs.
    pub const COUNT: usize = SIGNALS.len();
}

group! {
    /// Outputs of a pantograph whose commands come from outside: what the instruments of its controller show at the
    /// next sample, with their noise. Exchanged with a controller, not with the line.
    instrument: "control" {
        FORCE: "control.measured.force" ["N"], "Contact force on the head as measured for the controller";
        DESIRED: "control.desired.force" ["N"], "Contact force that the controller is to aim at";
        VELOCITY: "control.measured.velocity" ["m/s"], "Vertical velocity of the driven point as measured";
        POSITION: "control.measured.position" ["m"],
            "Rise of the driven mass above its place of reference as measured; height of the driven point of a linkage";
        HEAD_HEIGHT: "control.measured.head_height" ["m"], "Height of the head above the top of rail as measured";
        HEAD_VELOCITY: "control.measured.head_velocity" ["m/s"], "Vertical velocity of the head as measured";
        HEAD_ACCELERATION: "control.measured.head_acceleration" ["m/s2"],
            "Vertical acceleration of the head as measured";
    }

    /// Number of instruments.
    pub const COUNT: usize = SIGNALS.len();
    /// Name of the input of the pantograph that takes the command, N.
    pub const COMMAND: &str = "control.force";
    /// The input.
    pub const INPUT: DeclaredSignal =
        DeclaredSignal::real(COMMAND, "N", "Force that the drive is to exert, taken at its next sample");
}

/// Signals of a drive that is a moment on a joint, in place of those of a force of the same names.
pub mod moment {
    use super::{instrument, strip};
    use crate::DeclaredSignal;

    const fn instead(of: DeclaredSignal, unit: &'static str, description: &'static str) -> DeclaredSignal {
        DeclaredSignal::real(of.name, unit, description)
    }

    /// In place of [`strip::CONTROL`].
    pub const CONTROL: DeclaredSignal = instead(
        strip::SIGNALS[strip::CONTROL],
        "N.m",
        "Moment of the controlled drive on the joint of the pantograph, of which each strip has an equal part",
    );
    /// In place of [`instrument::VELOCITY`].
    pub const VELOCITY: DeclaredSignal = instead(
        instrument::SIGNALS[instrument::VELOCITY],
        "rad/s",
        "Rate of the driven joint as measured, positive where the strip rises",
    );
    /// In place of [`instrument::POSITION`].
    pub const POSITION: DeclaredSignal = instead(
        instrument::SIGNALS[instrument::POSITION],
        "rad",
        "Turn of the driven joint from the tabulated position as measured, positive where the strip rises",
    );
    /// Command of the drive.
    pub const COMMAND: DeclaredSignal = DeclaredSignal::real(
        instrument::COMMAND,
        "N.m",
        "Moment that the drive is to exert, taken at its next sample",
    );
}

/// Number of outputs of a line with `strips` strips and `supports` recorded supports.
#[must_use]
pub fn line_output_count(strips: usize, supports: usize) -> usize {
    strips * contact::COUNT + supports
}

/// Names of the line's inputs.
#[must_use]
pub fn line_inputs(strips: usize) -> Vec<String> {
    (1..=strips)
        .flat_map(|i| {
            let motion = strip::SIGNALS[..strip::MOTION].iter();
            motion.map(move |signal| signal.of(strip::GROUP, i))
        })
        .collect()
}

/// Names of the line's outputs; `supports` are the numbers (from 1) of the recorded supports.
#[must_use]
pub fn line_outputs(strips: usize, supports: &[usize]) -> Vec<String> {
    let uplift = support::SIGNALS[support::UPLIFT];
    (1..=strips)
        .flat_map(|i| {
            let exchanged = contact::SIGNALS[..contact::COUNT].iter();
            exchanged.map(move |signal| signal.of(contact::GROUP, i))
        })
        .chain(supports.iter().map(|&k| uplift.of(support::GROUP, k)))
        .collect()
}

/// Names of the inputs of a pantograph with `strips` strips.
#[must_use]
pub fn pantograph_inputs(strips: usize) -> Vec<String> {
    let of_strip = |i| load::SIGNALS.iter().map(move |signal| signal.of(load::GROUP, i));
    (1..=strips).flat_map(of_strip).collect()
}

/// Names of the outputs of a pantograph with `strips` strips.
#[must_use]
pub fn pantograph_outputs(strips: usize) -> Vec<String> {
    let of_strip = |i| strip::SIGNALS.iter().map(move |signal| signal.of(strip::GROUP, i));
    (1..=strips).flat_map(of_strip).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_where_the_indices_say() {
        let line = line_outputs(2, &[5, 6]);
        assert_eq!(line.len(), line_output_count(2, 2));
        assert_eq!(line[contact::COUNT + contact::MEAN_FZ], "contact[2].mean_fz");
        assert_eq!(
            line[contact::SAMPLES + contact::SAMPLE_COUNT - 1],
            "contact[1].sample[10]"
        );
        assert_eq!(line[contact::WIRE_Z], "contact[1].wire.z");
        assert_eq!(line[contact::GAP], "contact[1].gap");
        assert_eq!(line[2 * contact::COUNT], "support[5].uplift");
        assert_eq!(line_inputs(2)[strip::MOTION + strip::VZ], "strip[2].vz");
        assert_eq!(pantograph_inputs(1)[load::FZ], "contact[1].fz");
        assert_eq!(pantograph_outputs(1)[strip::WORK], "strip[1].work");
        assert_eq!(
            pantograph_outputs(2)[strip::OUTPUTS + strip::WIND_LIFT],
            "strip[2].wind.lift"
        );
    }

    #[test]
    fn counts_and_components_follow_from_the_order_of_the_rows() {
        assert_eq!(
            (strip::MOTION, strip::OUTPUTS, contact::COUNT, load::COUNT),
            (7, 11, 22, 4)
        );
        assert_eq!(contact::SAMPLE_COUNT, 10);
        assert_eq!([strip::VX, strip::VY, strip::VZ], [3, 4, 5]);
        assert_eq!(
            [contact::FX, contact::FZ, contact::MEAN_FX, contact::MEAN_FZ],
            [0, 2, 3, 5]
        );
        let units = contact::SIGNALS[contact::COUNT..].iter().map(|signal| signal.unit());
        assert!(units.eq([Some("N"), Some("m/s"), None]));
    }
}
