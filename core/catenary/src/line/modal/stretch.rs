//! Lengths of wires that modes stretch.
use super::modes::Modes;
use crate::line::topology::Fastening;
use crate::{LinearLine, WireNode};
use dynamics::Lu;
use dynamics::modal::{Aligned, StepFactors, kernels};
use pulp::Arch;

/// A wire from support to support, as a spring along it: waves along wires are so long that it stretches evenly.
///
/// Wires have no dampers along them, but those of beam elements. Their sag makes modes of a span stretch them, and
/// modes that are damped in proportion to their stiffness have such dampers.
pub(super) struct Stretch {
    /// Its elongation by each coordinate that is not held.
    pub gradient: Vec<(usize, f64)>,
    /// `EA/l`, N/m.
    pub stiffness: f64,
}

/// The lengths of all wires without such dampers that can stretch; `free` are the numbers of the coordinates that are
/// not held.
pub(super) fn stretches(linear: &LinearLine, free: &[Option<usize>]) -> Vec<Stretch> {
    let Some(line) = linear.shape() else {
        return Vec::new();
    };
    let moves_along = |node: &WireNode| node.map.position(0).is_some_and(|at| free[at].is_some());
    let mut found = Vec::new();
    let wires = line.topology().wires().iter().zip(line.wires());
    for (planned, wire) in wires.filter(|(planned, _)| !planned.beam) {
        let nodes = wire.geometry().nodes();
        let is_end =
            |node: &usize| [0, nodes.len() - 1].contains(node) || planned.fastenings[*node] == Fastening::Support;
        let ends: Vec<usize> = (0..nodes.len()).filter(is_end).collect();
        for ends in ends.windows(2) {
            let nodes = &nodes[ends[0]..=ends[1]];
            if nodes.iter().any(moves_along) {
                found.push(Stretch::of(nodes, wire.section().axial_stiffness, free));
            }
        }
    }
    found
}

impl Stretch {
    /// A wire through these nodes of the axial stiffness `EA`, N.
    fn of(nodes: &[WireNode], axial_stiffness: f64, free: &[Option<usize>]) -> Self {
        let (mut length, mut gradient) = (0.0, Vec::new());
        for pair in nodes.windows(2) {
            let chord = pair[1].position - pair[0].position;
            let along = chord.normalize();
            length += chord.norm();
            for (node, pull) in pair.iter().zip([-along, along]) {
                let free = |axis: usize| free[node.map.position(axis)?];
                gradient.extend((0..3).filter_map(|axis| Some((free(axis)?, pull[axis]))));
            }
        }
        Self {
            gradient,
            stiffness: axial_stiffness / length,
        }
    }
}

/// `B⁻¹ − G`: forces `f = B s` for rates `s = s₀ + G f`, with the dampers `B` and the answers `G` at the end of a step.
pub(super) fn taking_back(modes: &Modes, step: &StepFactors) -> Lu {
    let (arch, count) = (Arch::new(), modes.stretch_dampers.len());
    let mut factored = Lu::default();
    let matrix = factored.matrix(count);
    let mut by_force = Aligned::zeros(modes.slow);
    for (other, damper) in modes.stretch_dampers.iter().enumerate() {
        kernels::products(arch, modes.stretch(other), &step.v1[..modes.slow], &mut by_force);
        for length in 0..count {
            let [answer] = kernels::dots(arch, modes.stretch(length), [&by_force]);
            matrix[length * count + other] = f64::from(u8::from(length == other)) / damper - answer;
        }
    }
    factored.factor().expect("dampers that brake modes slowly");
    factored
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NodeMap;
    use nalgebra::Vector3;

    /// `Σ g q` of a hanging wire is the change of the length of the polygon through its nodes.
    #[test]
    fn a_stretch_is_the_change_of_length_to_first_order() {
        let count = 7;
        let at = |k: usize| Vector3::new(5.0 * k as f64, 0.0, 0.04 * (k as f64 - 3.0).powi(2));
        let node = |k: usize| WireNode {
            position: at(k),
            slope: Vector3::x(),
            map: NodeMap::planar(4 * k),
        };
        let nodes: Vec<WireNode> = (0..count).map(node).collect();
        // The first node is held along the track.
        let free: Vec<Option<usize>> = (0..4 * count).map(|at| at.checked_sub(1)).collect();
        let stretch = Stretch::of(&nodes, 1.0e7, &free);
        let displacement = |k: usize| {
            let (x, z) = ((1.7 * k as f64).sin(), (0.9 * k as f64).cos());
            1e-5 * Vector3::new(if k == 0 { 0.0 } else { x }, 0.0, z)
        };
        let length = |moved: f64| -> f64 {
            let place = |k: usize| at(k) + moved * displacement(k);
            (1..count).map(|k| (place(k) - place(k - 1)).norm()).sum()
        };
        let of_coordinate = |at: usize| {
            let (node, component) = ((at + 1) / 4, (at + 1) % 4);
            [displacement(node).x, displacement(node).z, 0.0, 0.0][component]
        };
        let change: f64 = stretch.gradient.iter().map(|&(at, g)| g * of_coordinate(at)).sum();
        let exact = 0.5 * (length(1.0) - length(-1.0));
        assert!((change - exact).abs() < 1e-9 * 1e-5, "{change} {exact}");
        assert!((stretch.stiffness * length(0.0) / 1.0e7 - 1.0).abs() < 1e-12);
    }
}
