//! Air on a pantograph: the points exposed to the wind, and the effect on the state of rest.
use super::{HeadMarker, ReducedPoint, ReducedStrip};
use crate::multibody::BodyMarker;
use crate::{Base, Travelling};
use dynamics::{AerodynamicForce, AerodynamicLaw, Columns, Flow, Force, Frame, Marker, Motion};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use scene::{AerodynamicMarker, Scene, WindSurface};
use std::sync::Arc;

/// Part of a scene's wind that acts on one pantograph.
#[derive(Clone, Debug)]
pub struct Air {
    /// Flow of the air.
    pub flow: Flow,
    /// Quasi-steady uplift of the strip, N/(m/s)².
    pub uplift: Option<f64>,
    /// Bodies with drag and lift.
    pub surfaces: Vec<WindSurface>,
}

impl Air {
    /// Air on pantograph `index` (from 0) of a scene; `None` if the scene lets no wind act on pantographs.
    #[must_use]
    pub fn of_scene(scene: &Scene, index: usize) -> Option<Self> {
        let table = scene.wind.as_ref()?;
        let acts = table.pantograph.as_ref()?;
        // One uplift for all pantographs, or one for each.
        let uplift = acts.uplift.get(index).or(acts.uplift.first()).copied();
        Some(Self {
            flow: Flow {
                wind: Arc::new(scene.wind_field()?),
                density: table.air_density,
                input: None,
            },
            uplift,
            surfaces: acts.surfaces.clone(),
        })
    }

    /// The force on a point of a surface, or of the uplift on the strip.
    pub(crate) fn force(&self, marker: AirMarker, base: Base, law: AerodynamicLaw) -> AirForce {
        AerodynamicForce {
            marker: Travelling { marker, base },
            law,
            flow: self.flow.clone(),
        }
    }
}

/// The force of the air on a point of a pantograph.
pub(crate) type AirForce = AerodynamicForce<Travelling<AirMarker>>;

/// The forces of the air on a pantograph.
#[derive(Clone, Debug, Default)]
pub(crate) struct AirForces {
    forces: Vec<AirForce>,
    /// True for forces on the body of the strip.
    on_head: Vec<bool>,
}

impl AirForces {
    pub(super) fn push(&mut self, force: AirForce, on_head: bool) {
        self.forces.push(force);
        self.on_head.push(on_head);
    }

    pub(super) fn as_slice(&self) -> &[AirForce] {
        &self.forces
    }

    pub(crate) fn as_mut_slice(&mut self) -> &mut [AirForce] {
        &mut self.forces
    }

    /// Lets the points travel with another base.
    pub(crate) fn travel_with(&mut self, base: Base) {
        for force in &mut self.forces {
            force.marker.base = base;
        }
    }

    /// Adds three inputs of the system, from index `first` on, to the wind, m/s.
    pub(crate) fn add_input(&mut self, first: usize) {
        for force in &mut self.forces {
            force.flow.input = Some(first);
        }
    }

    /// Drag and lift on the body of the strip, N: sums over the points.
    pub(crate) fn on_head(&self, motion: &Motion<'_>) -> [f64; 2] {
        let on_head = self.forces.iter().zip(&self.on_head).filter(|(_, on_head)| **on_head);
        on_head.fold([0.0; 2], |[drag, lift], (force, _)| {
            let [more_drag, more_lift] = force.drag_and_lift(motion);
            [drag + more_drag, lift + more_lift]
        })
    }
}

/// Points of a surface: offset from the body's centre of mass (m) and axes in body axes, and area in m².
pub(crate) fn points_of(
    surface: &WindSurface,
    orientation: &UnitQuaternion<f64>,
) -> Vec<(Vector3<f64>, Matrix3<f64>, f64)> {
    if surface.markers.is_empty() {
        let track = orientation.to_rotation_matrix().transpose().into_inner();
        return vec![(Vector3::zeros(), track, 1.0)];
    }
    let point = |marker: &AerodynamicMarker| {
        let [x, y, z] = marker.axes;
        let axes = Matrix3::from_rows(&[x.into(), y.into(), z.into()]);
        (marker.position.into(), axes, marker.area)
    };
    surface.markers.iter().map(point).collect()
}

/// A point of a pantograph in the frame of its base.
#[derive(Clone, Debug)]
pub enum AirMarker {
    /// The strip of a lumped pantograph.
    Head(HeadMarker),
    /// A point of a body of a linkage.
    Body(BodyMarker),
    /// The strip of a reduced linkage.
    Strip(ReducedStrip),
    /// A point of a body of a reduced linkage.
    Reduced(ReducedPoint),
}

impl Marker for AirMarker {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        match self {
            Self::Head(marker) => marker.frame(motion),
            Self::Body(marker) => marker.frame(motion),
            Self::Strip(marker) => marker.frame(motion),
            Self::Reduced(marker) => marker.frame(motion),
        }
    }

    fn columns(&self, motion: &Motion<'_>, columns: &mut Columns) {
        match self {
            Self::Head(marker) => marker.columns(motion, columns),
            Self::Body(marker) => marker.columns(motion, columns),
            Self::Strip(marker) => marker.columns(motion, columns),
            Self::Reduced(marker) => marker.columns(motion, columns),
        }
    }
}

/// Adds the generalised forces of the air at rest to `force`, which has one entry per coordinate known to the markers.
pub(super) fn add_at_rest(air: &mut [AirForce], q: &[f64], force: &mut [f64]) {
    let v = vec![0.0; q.len()];
    let motion = Motion {
        t: 0.0,
        q,
        v: &v,
        rotation: &[],
        u: &[],
    };
    for part in air {
        part.add_force(&motion, force);
    }
}
