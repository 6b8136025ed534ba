//! Ends of the wires under tensioning devices with friction and stops.
use super::EndReport;
use crate::line::{EndsOfWire, Equilibrium};
use crate::{Line, Topology, WireGeometry};
use dynamics::{Force, Layout, State};
use scene::{Catenary, Tensioning, WireEnds};

/// Holding of an end of a wire.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Hold {
    /// By the friction of its device.
    Friction,
    /// At a stop, on the outer side for `true`.
    Stop(bool),
    /// Sliding under the force of the weights and friction against the motion, which is outward for `true`.
    Sliding(bool),
}

/// One end of a wire under its device.
#[derive(Clone, Copy, Debug)]
struct End {
    wire: usize,
    node: usize,
    /// Coordinate along the track.
    index: usize,
    /// Sign of the way outward.
    sign: f64,
    /// Tension of the weights, N.
    weights: f64,
    /// x at the erection, m.
    erected: f64,
    hold: Hold,
    /// Way outward from the erection, m.
    travel: f64,
    /// Horizontal tension of the wire, N.
    tension: f64,
}

/// An end that slides, as a line sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct TensionedEnd {
    /// Coordinate along the track.
    pub index: usize,
    /// Force on the wire along the track, N.
    pub force: f64,
}

/// All ends under tensioning devices: dry friction and stops.
///
/// ```text
/// held:     |T − T₀| ≤ μ T₀
/// sliding:  T = T₀ (1 − μ) outward, T₀ (1 + μ) inward            T₀ force of the weights
/// ```
///
/// The hysteresis of Coulomb friction: warmed up from the erection, the tension falls to `T₀ (1 − μ)` before the
/// weights move; cooled down again, it rises to `T₀ (1 + μ)` first. At a stop the device carries any
/// difference that holds the end against it. Derived here.
pub(super) struct TensionedEnds {
    ends: Vec<End>,
    device: Tensioning,
    /// Label and tension length of each wire of the line.
    labels: Vec<(crate::WireName, usize)>,
}

/// Share of the tension that an end may be beyond its limit: that of the residual of statics.
const TOLERANCE: f64 = 1e-9;

impl TensionedEnds {
    /// The ends of the anchored wires of an erected line; none of one with fixed ends.
    pub fn of(catenary: &Catenary, topology: &Topology, erected: &Equilibrium) -> Self {
        let sliding = catenary.wire_ends == WireEnds::ConstantTension;
        let device = catenary.tensioning.unwrap_or(Tensioning {
            friction: 0.0,
            ratio: 1.0,
            travel: None,
        });
        let anchored = topology.wires().iter().enumerate();
        let anchored = anchored.filter(|(_, planned)| sliding && planned.ends == EndsOfWire::Anchored);
        let ends = anchored.flat_map(|(wire, planned)| {
            [(0, -1.0), (planned.last(), 1.0)].map(|(node, sign)| {
                let at = &erected.wires[wire].nodes()[node];
                End {
                    wire,
                    node,
                    index: at.map.position(0).expect("x exists in every node"),
                    sign,
                    weights: planned.parameters.tension,
                    erected: at.position.x,
                    hold: Hold::Friction,
                    travel: 0.0,
                    tension: planned.parameters.tension,
                }
            })
        });
        Self {
            ends: ends.collect(),
            device,
            labels: topology.wires().iter().map(|wire| (wire.name, wire.section)).collect(),
        }
    }

    /// Lets friction hold every end that slid, before the next change.
    pub fn hold(&mut self) {
        for end in &mut self.ends {
            end.hold = match end.hold {
                Hold::Stop(outer) => Hold::Stop(outer),
                _ if self.device.friction > 0.0 => Hold::Friction,
                // Nothing that could hold it.
                Hold::Friction => Hold::Sliding(true),
                sliding => sliding,
            };
        }
    }

    /// Fixes the held ends.
    pub fn fix(&self, layout: &mut Layout) {
        let held = self.ends.iter().filter(|end| !matches!(end.hold, Hold::Sliding(_)));
        held.for_each(|end| layout.fix(end.index));
    }

    /// The ends that slide, with the forces on them.
    pub fn sliding(&self) -> impl Iterator<Item = TensionedEnd> {
        self.ends.iter().filter_map(|end| match end.hold {
            Hold::Sliding(outward) => Some(TensionedEnd {
                index: end.index,
                force: end.sign * self.limit(end, outward),
            }),
            _ => None,
        })
    }

    /// Tension at which an end begins to slide, N.
    fn limit(&self, end: &End, outward: bool) -> f64 {
        let friction = if outward {
            -self.device.friction
        } else {
            self.device.friction
        };
        end.weights * (1.0 + friction)
    }

    /// Takes in places and tensions of a line at rest.
    pub fn see(&mut self, line: &Line, rest: &State) {
        let mut force = vec![0.0; rest.q.len()];
        let motion = rest.motion(&[]);
        // The devices themselves are left out.
        for wire in line.wires() {
            wire.clone().add_force(&motion, &mut force);
        }
        for end in &mut self.ends {
            let x = line.wires()[end.wire].geometry().nodes()[end.node].position.x;
            end.travel = end.sign * (x - end.erected);
            end.tension = -end.sign * force[end.index];
        }
    }

    /// Lets ends slide, stop, or leave a stop; false where all stay as they are.
    pub fn go_on(&mut self) -> bool {
        let way = self.device.way();
        let mut changed = false;
        for number in 0..self.ends.len() {
            let end = self.ends[number];
            let (low, high) = (self.limit(&end, true), self.limit(&end, false));
            let beyond = TOLERANCE * end.weights;
            let next = match end.hold {
                Hold::Friction if end.tension < low - beyond => Hold::Sliding(true),
                Hold::Friction if end.tension > high + beyond => Hold::Sliding(false),
                Hold::Stop(true) if end.tension > high + beyond => Hold::Sliding(false),
                Hold::Stop(false) if end.tension < low - beyond => Hold::Sliding(true),
                Hold::Sliding(_) if end.travel > way => Hold::Stop(true),
                Hold::Sliding(_) if end.travel < -way => Hold::Stop(false),
                same => same,
            };
            changed |= next != end.hold;
            self.ends[number].hold = next;
        }
        changed
    }

    /// Wires with the ends that came to a stop moved there.
    pub fn at_stops(&self, wires: &[WireGeometry]) -> Vec<WireGeometry> {
        let mut moved = wires.to_vec();
        for end in &self.ends {
            let Hold::Stop(outer) = end.hold else { continue };
            let target = if outer { self.device.way() } else { -self.device.way() };
            let wire = &wires[end.wire];
            let size = wire.nodes().iter().flat_map(|node| node.map.indices()).max();
            let mut q = vec![0.0; size.map_or(0, |last| last + 1)];
            let x = wire.nodes()[end.node].position.x;
            q[end.index] = end.erected + end.sign * target - x;
            moved[end.wire] = moved[end.wire].with_reference(&q);
        }
        moved
    }

    /// True where friction or a stop holds an end.
    pub fn are_held(&self) -> bool {
        let slides = |end: &End| matches!(end.hold, Hold::Sliding(_)) && self.device.friction == 0.0;
        !self.ends.iter().all(slides)
    }

    /// Places and tensions of the ends.
    pub fn reports(&self) -> Vec<EndReport> {
        let report = |end: &End| {
            let (wire, section) = self.labels[end.wire];
            let held_by = match end.hold {
                Hold::Friction => "friction",
                Hold::Stop(_) => "stop",
                Hold::Sliding(_) => "weights",
            };
            EndReport {
                tension_length: section + 1,
                wire,
                x: end.erected,
                travel: end.travel,
                weights: end.travel * self.device.ratio,
                tension: end.tension,
                held_by: held_by.to_owned(),
            }
        };
        self.ends.iter().map(report).collect()
    }
}
