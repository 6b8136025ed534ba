//! Disturbances put on a run to test its stability: moved strips, discarded and repeated steps, a start out of
//! equilibrium.
use catenary::{Line, WireName};

/// One smooth ramp of a [`Lift`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    /// Begin, s.
    pub start: f64,
    /// Length, s.
    pub duration: f64,
    /// By what it raises the strip, m; negative lowers it.
    pub rise: f64,
}

/// A motion of every strip relative to its pantograph: lowering and raising, or, the other way round, steps in the
/// height of the wire.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lift(pub Vec<Ramp>);

impl Lift {
    /// Height (m) and its rate (m/s) at `t` s: the sum of the ramps, each `3 τ² − 2 τ³`.
    #[must_use]
    pub fn at(&self, t: f64) -> (f64, f64) {
        self.0.iter().fold((0.0, 0.0), |(height, rate), ramp| {
            let part = ((t - ramp.start) / ramp.duration).clamp(0.0, 1.0);
            (
                height + ramp.rise * part * part * (3.0 - 2.0 * part),
                rate + ramp.rise / ramp.duration * 6.0 * part * (1.0 - part),
            )
        })
    }
}

/// Steps that slaves discard as if they had not converged, at pseudo-random times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Discards {
    /// Start of the sequence.
    pub seed: u64,
    /// One in so many calls, in the mean; at least 2.
    pub one_in: u64,
}

/// A start of the line at rest out of its equilibrium: half a sine in each span, neighbours against each other, both
/// wires alike. That is nearly the first mode of a line of equal spans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deflection {
    /// m.
    pub amplitude: f64,
}

impl Deflection {
    /// Writes the shape into the vertical coordinates of a line.
    pub fn write(&self, line: &Line, q: &mut [f64]) {
        let contact_wire = line.wire(WireName::ContactWire).geometry().nodes();
        let supports = line.topology().supports().into_iter();
        let supports: Vec<f64> = supports.map(|node| contact_wire[node].position.x).collect();
        for node in line.wires().iter().flat_map(|wire| wire.geometry().nodes()) {
            let x = node.position.x;
            let span = supports
                .partition_point(|support| *support <= x)
                .clamp(1, supports.len() - 1);
            let (from, to) = (supports[span - 1], supports[span]);
            let sign = if span % 2 == 1 { self.amplitude } else { -self.amplitude };
            let wave = std::f64::consts::PI / (to - from);
            if let Some(index) = node.map.position(2) {
                q[index] = sign * (wave * (x - from)).sin();
            }
            if let Some(index) = node.map.slope(2) {
                q[index] = sign * wave * (wave * (x - from)).cos();
            }
        }
    }
}

/// Kind of disturbance of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Disturbance {
    /// Moves the strips.
    pub lift: Option<Lift>,
    /// Steps that fail.
    pub discards: Option<Discards>,
    /// Every step is made, taken back and made again, and must come out the same bit for bit.
    pub repeated: bool,
    /// Starts the line of one system out of its equilibrium.
    pub deflection: Option<Deflection>,
    /// True to follow the energy of the one system; its macro step is then its micro step.
    pub audited: bool,
}

/// A strip moved by a [`Lift`].
pub(crate) struct Lifted {
    /// The strip on its pantograph.
    pub marker: Box<dyn dynamics::Marker>,
    /// Motion.
    pub lift: Lift,
}

impl dynamics::Marker for Lifted {
    fn frame(&self, motion: &dynamics::Motion<'_>) -> dynamics::Frame {
        let mut frame = self.marker.frame(motion);
        let (height, rate) = self.lift.at(motion.t);
        frame.position.z += height;
        frame.velocity.z += rate;
        frame
    }

    fn columns(&self, motion: &dynamics::Motion<'_>, columns: &mut dynamics::Columns) {
        self.marker.columns(motion, columns);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lift_ends_where_its_ramps_lead_and_its_rate_is_its_derivative() {
        let lift = Lift(vec![
            Ramp {
                start: 0.1,
                duration: 0.2,
                rise: -0.05,
            },
            Ramp {
                start: 0.5,
                duration: 0.1,
                rise: 0.05,
            },
        ]);
        assert_eq!(lift.at(0.0), (0.0, 0.0));
        assert!((lift.at(0.4).0 + 0.05).abs() < 1e-15 && lift.at(0.7).0.abs() < 1e-15);
        for t in [0.15, 0.25, 0.55] {
            let h = 1e-6;
            let slope = (lift.at(t + h).0 - lift.at(t - h).0) / (2.0 * h);
            assert!((slope - lift.at(t).1).abs() < 1e-8, "{t}: {slope} {}", lift.at(t).1);
        }
    }
}
