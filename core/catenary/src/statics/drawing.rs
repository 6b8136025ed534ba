//! Places of wires, droppers and point masses at rest, for drawings and tables.
use super::StaticLine;
use crate::{WireCurve, WireName};
use scene::{MassOn, Section};

/// Longest piece between two points of a drawn wire, m.
const PIECE: f64 = 2.0;

/// A wire at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct WireAtRest {
    /// Kind of the wire.
    pub name: WireName,
    /// Name in messages.
    pub label: String,
    /// Tension length, from 1.
    pub tension_length: usize,
    /// Points along the wire, m.
    pub points: Vec<[f64; 3]>,
    /// Height of each point above the chord between the nominal contact wire heights of its supports, m.
    pub above_chord: Vec<f64>,
    /// Tension that the scene gives, N.
    pub nominal_tension: f64,
    /// Least and largest axial tension along the wire, N.
    pub tension: [f64; 2],
}

/// A dropper at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DropperAtRest {
    /// Upper and lower end, m.
    pub ends: [[f64; 3]; 2],
    /// Wires at the upper and the lower end, in the order of [`StaticLine::wires_at_rest`].
    pub wires: [usize; 2],
}

/// A place moved along the track, m.
fn moved([x, y, z]: [f64; 3], way: f64) -> [f64; 3] {
    [x + way, y, z]
}

/// As [`Section::chord_height`], with the supports listed once: a long line has many points.
fn chords(section: Section<'_>) -> impl Fn(f64) -> f64 {
    let supports = (0..=section.spans()).map(|support| (section.support_x(support), section.height_at(support)));
    let supports: Vec<(f64, f64)> = supports.collect();
    move |x| {
        let next = supports
            .partition_point(|support| support.0 < x)
            .clamp(1, supports.len() - 1);
        let ((left, a), (right, b)) = (supports[next - 1], supports[next]);
        a + (b - a) * ((x - left) / (right - left)).clamp(0.0, 1.0)
    }
}

impl StaticLine {
    /// The wires of the whole line, in the order of [`crate::Topology::wires`].
    #[must_use]
    pub fn wires_at_rest(&self) -> Vec<WireAtRest> {
        let line = &self.system.line;
        let (rest, supports) = (self.system.layout.state_at_rest(), self.topology.supports());
        let all = self.topology.wires().iter().zip(line.wires()).map(|(planned, wire)| {
            let geometry = wire.geometry();
            let between = |first: usize, last: usize| {
                let of_element = |element: usize| {
                    let length = geometry.lengths()[element];
                    let pieces = (length / PIECE).ceil().max(1.0);
                    let s = move |piece: usize| geometry.node_s(element) + length * piece as f64 / pieces;
                    (0..pieces as usize).map(s)
                };
                let s = (first..last).flat_map(of_element).chain([geometry.node_s(last)]);
                s.map(|s| <[f64; 3]>::from(geometry.point(s, &rest.q, &rest.v).r))
                    .collect::<Vec<_>>()
            };
            let points: Vec<_> = match self.spans_of_short_line() {
                None => between(0, planned.last()),
                Some(spans) => spans
                    .flat_map(|(span, way)| {
                        let own = between(supports[span], supports[span + 1]);
                        own.into_iter().map(move |point| moved(point, way))
                    })
                    .collect(),
            };
            let chord = chords(self.whole.section(planned.section));
            let tensions = (0..planned.last()).map(|element| wire.tension(element, &rest.q));
            WireAtRest {
                name: planned.name,
                label: planned.label.clone(),
                tension_length: planned.section + 1,
                above_chord: points.iter().map(|[x, _, z]| z - chord(*x)).collect(),
                points,
                nominal_tension: planned.parameters.tension,
                tension: tensions.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], tension| {
                    [least.min(tension), most.max(tension)]
                }),
            }
        });
        all.collect()
    }

    /// The droppers of the whole line, in the order of [`super::StaticsReport::droppers`].
    #[must_use]
    pub fn droppers_at_rest(&self) -> Vec<DropperAtRest> {
        let (places, solved) = (self.topology.droppers(), self.line().droppers().as_slice());
        let drawn = |number: usize, way: f64| {
            let (place, dropper) = (&places[number], &solved[number]);
            let ends = [&dropper.upper, &dropper.lower];
            DropperAtRest {
                ends: ends.map(|end| moved(end.reference.into(), way)),
                wires: [place.upper.wire, place.lower.wire],
            }
        };
        match self.spans_of_short_line() {
            None => (0..places.len()).map(|number| drawn(number, 0.0)).collect(),
            Some(spans) => spans
                .flat_map(|(span, way)| {
                    let own = (0..places.len()).filter(move |&number| places[number].span == span + 1);
                    own.map(move |number| drawn(number, way))
                })
                .collect(),
        }
    }

    /// Place (m) and mass (kg) of each point mass of the scene.
    #[must_use]
    pub fn point_masses_at_rest(&self) -> Vec<([f64; 3], f64)> {
        let wires = self.topology.wires().iter().zip(self.line().wires());
        let placed = |mass: &scene::PointMass| {
            let name = match mass.wire {
                MassOn::ContactWire => WireName::ContactWire,
                MassOn::MessengerWire => WireName::MessengerWire,
            };
            let mut own = wires.clone();
            let (_, wire) =
                own.find(|(planned, _)| planned.name == name && planned.section + 1 == mass.tension_length)?;
            let places = wire.geometry().nodes().iter().map(|node| node.position);
            let place = places.min_by(|a, b| (a.x - mass.x).abs().total_cmp(&(b.x - mass.x).abs()))?;
            Some((place.into(), mass.mass))
        };
        self.catenary.point_masses.iter().filter_map(placed).collect()
    }
}
