//! A linkage as a linear pantograph about its start.
use super::{PantographModel, Placement};
use crate::{AppliedForce, VehicleError};
use control::LinearParts;
use dynamics::{Columns, Force, Layout, Motion, Weights, dense};
use nalgebra::DVector;
use scene::Scene;

impl PantographModel {
    /// Pantograph `index` (from 0) of a scene, a linkage in its one motion and that of the head, linear about its start
    /// on a base that stands still, with the drive of its controller; none without a controller.
    ///
    /// # Errors
    /// See [`VehicleError`]: a linkage with other motions than one among them.
    pub fn linearised(scene: &Scene, index: usize) -> Result<Option<LinearParts>, VehicleError> {
        let Some(control) = &scene.pantographs[index].control else {
            return Ok(None);
        };
        let placement = Placement {
            one_motion: true,
            vehicle: None,
            track: None,
            ..Placement::of_scene(scene, index)
        };
        let mut layout = Layout::new();
        let (mut model, rest) = Self::started_on(scene, index, placement, &mut layout)?;
        let strips = model.strips();
        let drive = strips * AppliedForce::INPUTS;
        model.pantograph.drive_by(&control.actuator, drive)?;
        let mut state = layout.state_at_rest();
        model.set_initial(&rest, &mut state);
        let mut u = vec![0.0; drive + 1];
        let n = state.q.len();
        let mut head = DVector::zeros(n);
        let mut contacts: Vec<AppliedForce> = Vec::new();
        for (strip, force) in rest.strip_forces.iter().enumerate() {
            let contact = model.applied_force_at(strip, strip * AppliedForce::INPUTS);
            let motion = state.motion(&[]);
            u[contact.first + 2] = -force;
            u[contact.first + 3] = contact.marker.frame(&motion).position.y;
            let mut columns = Columns::default();
            contact.marker.columns(&motion, &mut columns);
            for column in columns.as_slice() {
                head[column.index] += column.translation.z / strips as f64;
            }
            contacts.push(contact);
        }
        let mut forces = |visit: &mut dyn FnMut(&mut dyn Force)| {
            model.forces(visit);
            for contact in &mut contacts {
                visit(contact);
            }
        };
        let stiffness = dense(n, &mut |blocks| {
            forces(&mut |force| force.add_tangent(&state.motion(&u), Weights { q: 1.0, v: 0.0 }, blocks));
        });
        let damping = dense(n, &mut |blocks| {
            forces(&mut |force| force.add_tangent(&state.motion(&u), Weights { q: 0.0, v: 1.0 }, blocks));
        });
        let mass = dense(n, &mut |blocks| forces(&mut |force| force.add_mass(blocks)));
        let mut pressed = |motion: &Motion<'_>| {
            let mut sum = DVector::zeros(n);
            forces(&mut |force| force.add_force(motion, sum.as_mut_slice()));
            sum
        };
        let without = pressed(&state.motion(&u));
        u[drive] = 1.0;
        let drive = pressed(&state.motion(&u)) - without;
        Ok(Some(LinearParts {
            mass,
            damping,
            stiffness,
            head,
            drive,
        }))
    }
}
