//! The nonlinear overhead line as a list of contributions.

use super::beam::contact_wire_directors;
use super::{AirOnLine, EndsOfWire, PlannedWire, Uplift, WireCoordinates, curve_pull};
use crate::{
    Anchor, Attachment, AxialLaw, BendingLaw, CorrectedWire, DeadLoad, Directors, Dropper, DropperLaw, Droppers,
    Enrichment, LineEnd, LineEnds, LoadCorrection, MassCorrection, NodeMap, NodeOfWire, PointMasses, Rayleigh,
    RegistrationArms, ResidualCompliance, RunningSurface, Supports, Topology, WindOnLine, Wire, WireCurve,
    WireDirectors, WireGeometry, WireName, WireNode, WireSection,
};
use dynamics::{Force, Motion, PartVisitor, period_error};
use nalgebra::Vector3;
use scene::{AxialStrain, Catenary, WireEnds};
use std::sync::Arc;

/// Static state of a line: all values that follow from statics and not from the scene.
#[derive(Clone, Debug)]
pub(crate) struct Equilibrium {
    /// The wires, in the order of [`Topology::wires`].
    pub wires: Vec<WireGeometry>,
    /// Directors of a contact wire of beam elements, else empty.
    pub directors: Vec<Directors>,
    /// Unstressed length of each dropper, m.
    pub dropper_lengths: Vec<f64>,
    /// Force of each inner support on the messenger wire, N.
    pub support_reactions: Vec<Vector3<f64>>,
    /// Force of each inner registration arm on the contact wire, its own weight not deducted, N.
    pub arm_reactions: Vec<Vector3<f64>>,
}

impl Equilibrium {
    /// Renumbers all coordinates from `first` on.
    fn shifted(&self, first: usize) -> Self {
        Self {
            wires: self.wires.iter().map(|wire| shifted(wire, first)).collect(),
            directors: (self.directors.iter())
                .map(|directors| Directors {
                    first: directors.first + first,
                    ..*directors
                })
                .collect(),
            ..self.clone()
        }
    }
}

fn shifted(geometry: &WireGeometry, first: usize) -> WireGeometry {
    let shift = |index: Option<usize>| index.map(|index| index + first);
    let nodes = geometry.nodes().iter().map(|node| WireNode {
        map: NodeMap::new(std::array::from_fn(|i| {
            shift(if i < 3 {
                node.map.position(i)
            } else {
                node.map.slope(i - 3)
            })
        })),
        ..*node
    });
    let enrichments = geometry.enrichments().iter().map(|enrichment| Enrichment {
        index: enrichment.index + first,
        ..*enrichment
    });
    WireGeometry::new(nodes.collect(), geometry.lengths().to_vec(), enrichments.collect())
        .with_tension_shares(geometry.tension_shares().to_vec())
}

/// A dropper in a picture of the line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DropperSample {
    /// Position on the messenger wire, m.
    pub top: Vector3<f64>,
    /// Position on the contact wire, m.
    pub bottom: Vector3<f64>,
    /// Tension, N.
    pub force: f64,
}

/// Wires, droppers, supports, registration arms and sliding ends: an overhead line whose reference (all coordinates
/// zero) is its static state.
#[derive(Clone, Debug)]
pub struct Line {
    topology: Arc<Topology>,
    /// The wires, in the order of [`Topology::wires`].
    wires: Vec<Wire>,
    /// Directors of a contact wire of beam elements.
    directors: Option<WireDirectors>,
    droppers: Droppers,
    supports: Supports,
    arms: RegistrationArms,
    masses: PointMasses,
    /// Pull of curved track.
    pull: DeadLoad,
    ends: LineEnds,
    uplift: Uplift,
    /// Residual compliance of each contact wire; empty without.
    compliance: Vec<Option<Arc<ResidualCompliance>>>,
    /// Numbers of the contact wires among the wires.
    contact_wires: Vec<usize>,
    /// Running surface of each contact wire; empty where they are even.
    surfaces: Vec<Arc<RunningSurface>>,
    /// Correction of the forces of strips that belongs to the corrected inertia of the contact wire.
    load: Option<LoadCorrection>,
    /// Forces of the air; none without wind.
    air: AirOnLine,
}

impl Line {
    /// A line in the coordinates of `equilibrium`, shifted by `first`.
    pub(crate) fn new(catenary: &Catenary, topology: &Arc<Topology>, equilibrium: &Equilibrium, first: usize) -> Self {
        let equilibrium = equilibrium.shifted(first);
        let planned = topology.wires().iter().zip(equilibrium.wires);
        let mut wires: Vec<Wire> = planned
            .map(|(planned, geometry)| wire(catenary, planned, Arc::new(geometry)))
            .collect();
        let beam = catenary.contact_wire.beam.filter(|_| !equilibrium.directors.is_empty());
        let directors = beam.map(|beam| {
            wires[0] = wires[0].without_bending();
            contact_wire_directors(catenary, &beam, wires[0].geometry(), &equilibrium.directors)
        });
        let node = |at: NodeOfWire| Attachment::node(&wires[at.wire].geometry().nodes()[at.node]);

        let droppers = topology.droppers().iter().zip(&equilibrium.dropper_lengths);
        let droppers = droppers.map(|(place, &unstressed_length)| Dropper {
            upper: node(place.upper),
            lower: node(place.lower),
            unstressed_length,
            mass: catenary.droppers.mass,
        });
        let law = DropperLaw {
            stiffness: catenary.droppers.stiffness,
            damping: catenary.droppers.damping,
        };
        let springs = &catenary.supports;
        let supports = topology.held_by_supports().zip(&equilibrium.support_reactions);
        let supports = supports.map(|(upper, &reaction)| Anchor {
            node: node(upper),
            reaction,
            stiffness: Vector3::new(
                springs.messenger_longitudinal_stiffness,
                springs.messenger_lateral_stiffness,
                springs.messenger_vertical_stiffness,
            ),
        });
        let arm = &catenary.registration_arms;
        let arms = topology.held_by_arms().zip(&equilibrium.arm_reactions);
        let arms = arms.map(|(lower, &reaction)| Anchor {
            node: node(lower),
            reaction,
            stiffness: Vector3::new(0.0, arm.lateral_stiffness, arm.vertical_stiffness),
        });
        let surface = |wire: usize| {
            let surface = catenary.surface.as_ref()?;
            Some(Arc::new(RunningSurface::new(surface, wires[wire].geometry())))
        };
        let surfaces = topology.contact_wires().filter_map(surface).collect();
        let masses = topology.masses().iter().map(|&(at, mass)| (node(at), mass));
        let masses = PointMasses::new(masses.collect(), catenary.gravity);
        let pull = curve_pull(catenary, topology, |at| &wires[at.wire].geometry().nodes()[at.node].map);
        let sliding = catenary.wire_ends == WireEnds::ConstantTension;
        let anchored = topology.wires().iter().zip(&wires);
        let anchored = anchored.filter(|(planned, _)| sliding && planned.ends == EndsOfWire::Anchored);
        let ends = anchored.flat_map(|(planned, wire)| {
            let tension = planned.parameters.tension;
            [(0, -tension), (planned.last(), tension)]
                .into_iter()
                .filter_map(|(node, force)| {
                    let index = wire.geometry().nodes()[node].map.position(0)?;
                    Some(LineEnd { index, force })
                })
        });
        Self {
            droppers: Droppers::new(law, droppers.collect(), catenary.gravity),
            supports: Supports::new(supports.collect()),
            arms: RegistrationArms::new(arms.collect(), arm.mass, catenary.gravity),
            masses,
            pull,
            ends: LineEnds::new(ends.collect()),
            uplift: Uplift::counted_from(topology, |_| 0.0),
            compliance: Vec::new(),
            contact_wires: topology.contact_wires().collect(),
            surfaces,
            load: None,
            air: AirOnLine::default(),
            topology: Arc::clone(topology),
            directors,
            wires,
        }
    }

    /// Uses the mass matrix that cancels the leading dispersion error of the integrator's steps, see
    /// [`Wire::with_mass_correction`].
    ///
    /// Generalised-α of step `h` has the periods of the trapezoidal rule with the step `h √p`, `p` its
    /// [`period_error`]: the correction is that of the rule with this step. The forces of strips that move along the
    /// contact wire are corrected accordingly, see [`LoadCorrection`].
    #[must_use]
    pub fn with_mass_correction(mut self, correction: MassCorrection) -> Self {
        let of_trapezoid = period_error(correction.rho_inf);
        self.load = Some(LoadCorrection {
            step: correction.steps.contact_wire,
            kappa: of_trapezoid / 6.0,
        });
        let corrected = |(wire, planned): (Wire, &PlannedWire)| {
            wire.with_mass_correction(correction.step_of(planned.name) * of_trapezoid.sqrt())
        };
        self.wires = self
            .wires
            .into_iter()
            .zip(self.topology.wires())
            .map(corrected)
            .collect();
        self
    }

    /// Gives each contact wire its residual compliance under strips, see [`ResidualCompliance`].
    #[must_use]
    pub fn with_contact_compliance(mut self, compliance: Vec<Option<Arc<ResidualCompliance>>>) -> Self {
        self.compliance = compliance;
        self
    }

    /// Lets the wind act on wires, droppers and arms, or nothing.
    #[must_use]
    pub fn in_wind(mut self, wind: Option<&WindOnLine>) -> Self {
        self.air = wind.map_or_else(AirOnLine::default, |wind| wind.on(&self));
        self
    }

    /// Pulls at a sliding end with the coordinate `index` along the track by `force`, N.
    pub(crate) fn pull_end(&mut self, index: usize, force: f64) {
        self.ends.pull(index, force);
    }

    /// Removes the forces of the air.
    pub(crate) fn take_air(&mut self) -> AirOnLine {
        std::mem::take(&mut self.air)
    }

    /// Visits every contribution with the name of its part, always in the same order.
    pub fn parts(&mut self, visit: &mut PartVisitor<'_>) {
        for wire in &mut self.wires {
            visit("wires", wire);
        }
        if let Some(directors) = &mut self.directors {
            visit("wires", directors);
        }
        self.attachments(visit);
        self.air.parts(visit);
    }

    /// Visits every contribution, in the order of [`Line::parts`].
    pub fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.parts(&mut |_, force| visit(force));
    }

    /// Visits all contributions except the wires and the wind on them.
    pub(crate) fn attachments(&mut self, visit: &mut PartVisitor<'_>) {
        visit("droppers", &mut self.droppers);
        visit("supports", &mut self.supports);
        visit("registration_arms", &mut self.arms);
        if !self.masses.is_empty() {
            visit("supports", &mut self.masses);
        }
        if !self.pull.entries.is_empty() {
            visit("supports", &mut self.pull);
        }
        visit("supports", &mut self.ends);
    }

    /// Number of contact wires.
    #[must_use]
    pub fn contact_wires(&self) -> usize {
        self.contact_wires.len()
    }

    /// Contact wire `wire` (from 0).
    #[must_use]
    pub fn contact_wire(&self, wire: usize) -> &Wire {
        &self.wires[self.contact_wires[wire]]
    }

    /// Contact wire `wire` (from 0) as contact sees it.
    #[must_use]
    pub fn contact_curve(&self, wire: usize) -> Arc<dyn WireCurve> {
        let geometry = Arc::clone(self.contact_wire(wire).geometry());
        let compliance = self.compliance_of(wire).cloned();
        let surface = self.surfaces.get(wire).cloned();
        if compliance.is_none() && self.load.is_none() && surface.is_none() {
            return geometry;
        }
        Arc::new(CorrectedWire {
            geometry,
            compliance,
            load: self.load,
            surface,
        })
    }

    /// Residual compliance of the contact wires under strips, see [`ResidualCompliance`]; empty without.
    #[must_use]
    pub fn compliance(&self) -> &[Option<Arc<ResidualCompliance>>] {
        &self.compliance
    }

    /// Residual compliance of contact wire `wire` (from 0).
    pub(crate) fn compliance_of(&self, wire: usize) -> Option<&Arc<ResidualCompliance>> {
        self.compliance.get(wire)?.as_ref()
    }

    /// The wires, in the order of [`Topology::wires`].
    #[must_use]
    pub fn wires(&self) -> &[Wire] {
        &self.wires
    }

    /// The first wire of this name.
    ///
    /// # Panics
    /// When there is none.
    #[must_use]
    pub fn wire(&self, name: WireName) -> &Wire {
        let mut all = self.topology.wires().iter().zip(&self.wires);
        let found = all.find(|(planned, _)| planned.name == name);
        found.expect("the line has a wire of this name").1
    }

    /// Nodes, supports and droppers.
    #[must_use]
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// The droppers.
    #[must_use]
    pub fn droppers(&self) -> &Droppers {
        &self.droppers
    }

    /// The inner supports, from the second support to the last but one.
    #[must_use]
    pub fn supports(&self) -> &Supports {
        &self.supports
    }

    /// The inner registration arms, as [`Line::supports`].
    #[must_use]
    pub fn registration_arms(&self) -> &RegistrationArms {
        &self.arms
    }

    /// Number of masts, the ends included.
    #[must_use]
    pub fn support_count(&self) -> usize {
        self.topology.masts().len()
    }

    /// Part of `values` of a node that is vertical.
    fn vertical(&self, at: NodeOfWire, values: &[f64]) -> f64 {
        let node = &self.wires[at.wire].geometry().nodes()[at.node];
        node.map.position(2).map_or(0.0, |index| values[index])
    }

    /// Counts uplift from the state `q` on.
    pub fn set_uplift_reference(&mut self, q: &[f64]) {
        self.uplift = Uplift::counted_from(&self.topology, |at| self.vertical(at, q));
    }

    /// Rise of the contact wire at mast `mast` (from 0) above its height in the reference state, m; of several wires
    /// the largest.
    #[must_use]
    pub fn uplift(&self, mast: usize, q: &[f64]) -> f64 {
        self.most_lifted(mast, q).map_or(0.0, |(rise, _)| rise)
    }

    /// Rate of [`Line::uplift`], m/s.
    #[must_use]
    pub fn uplift_rate(&self, mast: usize, q: &[f64], v: &[f64]) -> f64 {
        self.most_lifted(mast, q).map_or(0.0, |(_, at)| self.vertical(at, v))
    }

    fn most_lifted(&self, mast: usize, q: &[f64]) -> Option<(f64, NodeOfWire)> {
        self.uplift.most_lifted(&self.topology, mast, |at| self.vertical(at, q))
    }

    /// Points along the wires of a name for pictures, m, a polyline for each, not many more than `most` points in all.
    pub(crate) fn polylines_of(
        &self,
        name: WireName,
        most: usize,
        position: impl Fn(&WireNode) -> Vector3<f64>,
    ) -> Vec<Vec<Vector3<f64>>> {
        let wires = self.topology.wires().iter().zip(&self.wires);
        let wires = wires.filter(|(planned, _)| planned.name == name);
        let all: usize = wires.clone().map(|(planned, _)| planned.x.len()).sum();
        let stride = all.div_ceil(most).max(1);
        let points = wires.map(|(planned, wire)| {
            let nodes = wire.geometry().nodes().iter().enumerate();
            let drawn = nodes.filter(|(i, _)| i % stride == 0 || *i == planned.last());
            drawn.map(|(_, node)| position(node)).collect()
        });
        points.collect()
    }

    /// Number of droppers without tension.
    #[must_use]
    pub fn slack_count(&self, motion: &Motion<'_>) -> usize {
        self.droppers.slack_count(motion)
    }

    /// Potential energy, J, of strain, weight and preloads.
    #[must_use]
    pub fn energy(&self, motion: &Motion<'_>) -> f64 {
        let wires = self.wires.iter().map(|wire| wire as &dyn Force);
        let others: [&dyn Force; 6] = [
            &self.droppers,
            &self.supports,
            &self.arms,
            &self.masses,
            &self.pull,
            &self.ends,
        ];
        let directors = self
            .directors
            .as_ref()
            .map_or(0.0, |directors| directors.energy(motion));
        wires.chain(others).map(|part| part.energy(motion)).sum::<f64>() + directors
    }

    /// Ends and tension of every dropper.
    pub fn dropper_samples<'a>(&'a self, motion: &'a Motion<'a>) -> impl Iterator<Item = DropperSample> + 'a {
        self.droppers
            .as_slice()
            .iter()
            .enumerate()
            .map(move |(index, dropper)| DropperSample {
                top: dropper.upper.position(motion),
                bottom: dropper.lower.position(motion),
                force: self.droppers.tension(index, motion),
            })
    }

    /// Parameter `s` of contact wire `wire` (from 0) at the position `x` along the track, m, for coordinates `q`;
    /// clamped to the ends of the wire.
    #[must_use]
    pub fn contact_wire_s(&self, wire: usize, x: f64, q: &[f64]) -> f64 {
        let geometry = self.contact_wire(wire).geometry();
        let v = vec![0.0; q.len()];
        let at = |s: f64| geometry.point(s, q, &v);
        let (mut low, mut high) = (0.0, geometry.length());
        let mut s = (x - geometry.nodes()[0].position.x).clamp(low, high);
        // Newton's method inside a shrinking bracket; x grows with s.
        for _ in 0..100 {
            let point = at(s);
            let error = point.r.x - x;
            if error > 0.0 {
                high = s;
            } else {
                low = s;
            }
            let next = s - error / point.r_s.x;
            let next = if next > low && next < high {
                next
            } else {
                0.5 * (low + high)
            };
            if (next - s).abs() <= 1e-13 * geometry.length() {
                return next;
            }
            s = next;
        }
        s
    }
}

/// Wire of the scene along `geometry`.
pub(crate) fn wire(catenary: &Catenary, planned: &PlannedWire, geometry: Arc<WireGeometry>) -> Wire {
    let parameters = &planned.parameters;
    let section = WireSection {
        axial_stiffness: parameters.axial_stiffness,
        bending_stiffness: parameters.bending_stiffness,
        mass_per_length: parameters.mass_per_length,
        tension: parameters.tension,
    };
    let damping = Rayleigh {
        alpha: catenary.damping.alpha,
        beta: catenary.damping.beta,
    };
    let axial = match catenary.mesh.axial_strain {
        AxialStrain::Mean => AxialLaw::Mean,
        AxialStrain::Full => AxialLaw::Full,
    };
    Wire::new(
        section,
        damping,
        (axial, BendingLaw::Constant),
        catenary.gravity,
        geometry,
    )
}

/// The bending layers of one wire, at rest; none in a string.
pub(crate) fn layers(parameters: &scene::Wire, coordinates: &WireCoordinates) -> Vec<Enrichment> {
    let layers = coordinates.layers.iter().map(|layer| Enrichment {
        node: layer.node,
        index: layer.index,
        direction: layer.direction,
        bending_length: (parameters.bending_stiffness / parameters.tension).sqrt(),
        reference: 0.0,
    });
    layers.collect()
}
