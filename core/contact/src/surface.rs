//! Running surface of a contact wire.
use dynamics::RestingSpline;
use wire::{CurvePoint, WireGeometry};

/// Height of the running surface of a wire above an even one, along the parameter of the wire: a smooth curve through
/// given places, constant beyond.
#[derive(Clone, Debug, PartialEq)]
pub struct RunningSurface(RestingSpline);

impl RunningSurface {
    /// Surface of the wire `geometry`, given at places along the track.
    #[must_use]
    pub fn new(surface: &scene::Surface, geometry: &WireGeometry) -> Self {
        let nodes = geometry.nodes();
        let along = |x: &f64| {
            let right = nodes
                .partition_point(|node| node.position.x < *x)
                .clamp(1, nodes.len() - 1);
            let (a, b) = (nodes[right - 1].position.x, nodes[right].position.x);
            let (from, to) = (geometry.node_s(right - 1), geometry.node_s(right));
            from + (to - from) * (x - a) / (b - a)
        };
        Self(RestingSpline::new(
            surface.x.iter().map(along).collect(),
            surface.height.clone(),
        ))
    }

    /// Raises a point of the wire's axis at `s` (m) to the running surface.
    pub(super) fn raise(&self, s: f64, point: &mut CurvePoint) {
        let [height, slope, bend] = self.0.at(s);
        point.r.z += height;
        point.r_s.z += slope;
        point.r_ss.z += bend;
    }
}
