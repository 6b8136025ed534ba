//! Values that cross the coupling: names and order of the values in the flat slices of a slave of the master.
//!
//! | side | inputs | outputs |
//! | --- | --- | --- |
//! | line | [`strip`] motion of each strip | [`contact`] of each strip, then the uplift of each recorded support |
//! | pantograph | [`load`] | [`strip`] motion, work and wind |
//!
//! The names are those of the FMU variables.

/// Motion of a collector strip: inputs of the line, and with work and wind the outputs of a pantograph.
pub mod strip {
    /// Position along the track, m.
    pub const X: usize = 0;
    /// Lateral position, m.
    pub const Y: usize = 1;
    /// Height above the top of rail, m.
    pub const Z: usize = 2;
    /// Velocity along the track, m/s; `VX + i` is the rate of `X + i`.
    pub const VX: usize = 3;
    /// Lateral velocity, m/s.
    pub const VY: usize = 4;
    /// Vertical velocity, m/s.
    pub const VZ: usize = 5;
    /// Roll angle, rad.
    pub const ROLL: usize = 6;
    /// Values of a motion.
    pub const MOTION: usize = 7;
    /// Work done by the contact on the strip since the start, J; an output only.
    pub const WORK: usize = 7;
    /// Drag of the wind on the body of the strip, N; an output only.
    pub const WIND_DRAG: usize = 8;
    /// Lift of the wind on the body of the strip, N, positive upward; an output only.
    pub const WIND_LIFT: usize = 9;
    /// Outputs of a pantograph.
    pub const OUTPUTS: usize = 10;
    /// Names, in order.
    pub const NAMES: [&str; OUTPUTS] = [
        "x",
        "y",
        "z",
        "vx",
        "vy",
        "vz",
        "roll",
        "work",
        "wind.drag",
        "wind.lift",
    ];
}

/// Outputs of the line per strip.
pub mod contact {
    /// Force on the strip along the track, N; `FX`, `FX + 1`, `FX + 2` are x, y, z.
    pub const FX: usize = 0;
    /// Vertical force on the strip, N, not positive on a level strip.
    pub const FZ: usize = 2;
    /// Mean over the last communication step of the force on the strip, N; three components.
    pub const MEAN_FX: usize = 3;
    /// Vertical component of the mean, N.
    pub const MEAN_FZ: usize = 5;
    /// Lateral position of the contact point, m.
    pub const Y: usize = 6;
    /// Contact force, N, not negative.
    pub const FORCE: usize = 7;
    /// Contact force at j/10 of the last communication step, j = 1…10, N.
    pub const SAMPLES: usize = 8;
    /// Number of samples.
    pub const SAMPLE_COUNT: usize = 10;
    /// Contact point along the track, m.
    pub const X: usize = 18;
    /// Height of the wire at the contact point, m.
    pub const WIRE_Z: usize = 19;
    /// Gap between strip and wire, m, positive when open.
    pub const GAP: usize = 20;
    /// Work done by the strip on the line since the start, J.
    pub const WORK: usize = 21;
    /// Outputs per strip.
    pub const COUNT: usize = 22;
    /// Names, in order.
    pub const NAMES: [&str; COUNT] = [
        "fx",
        "fy",
        "fz",
        "mean_fx",
        "mean_fy",
        "mean_fz",
        "y",
        "force",
        "sample[1]",
        "sample[2]",
        "sample[3]",
        "sample[4]",
        "sample[5]",
        "sample[6]",
        "sample[7]",
        "sample[8]",
        "sample[9]",
        "sample[10]",
        "x",
        "wire.z",
        "gap",
        "work",
    ];
}

/// Inputs of a pantograph.
pub mod load {
    /// Force on the strip along the track, N; `FX`, `FX + 1`, `FX + 2` are x, y, z.
    pub const FX: usize = 0;
    /// Vertical force on the strip, N.
    pub const FZ: usize = 2;
    /// Lateral position of the contact point, m.
    pub const Y: usize = 3;
    /// Inputs.
    pub const COUNT: usize = 4;
    /// Names, in order.
    pub const NAMES: [&str; COUNT] = ["fx", "fy", "fz", "y"];
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
            strip::NAMES[..strip::MOTION]
                .iter()
                .map(move |name| format!("strip[{i}].{name}"))
        })
        .collect()
}

/// Names of the line's outputs; `supports` are the numbers (from 1) of the recorded supports.
#[must_use]
pub fn line_outputs(strips: usize, supports: &[usize]) -> Vec<String> {
    (1..=strips)
        .flat_map(|i| contact::NAMES.iter().map(move |name| format!("contact[{i}].{name}")))
        .chain(supports.iter().map(|k| format!("support[{k}].uplift")))
        .collect()
}

/// Names of a pantograph's inputs.
#[must_use]
pub fn pantograph_inputs() -> Vec<String> {
    load::NAMES.iter().map(|name| format!("contact[1].{name}")).collect()
}

/// Names of a pantograph's outputs.
#[must_use]
pub fn pantograph_outputs() -> Vec<String> {
    strip::NAMES.iter().map(|name| format!("strip[1].{name}")).collect()
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
        assert_eq!(pantograph_inputs()[load::FZ], "contact[1].fz");
        assert_eq!(pantograph_outputs()[strip::WORK], "strip[1].work");
        assert_eq!(pantograph_outputs()[strip::WIND_LIFT], "strip[1].wind.lift");
    }
}
