use super::*;
use crate::Base;
use crate::track::{Reach, TrackShape};
use dynamics::{JacobianRows, Layout, System};
use nalgebra::{DMatrix, SymmetricEigen};
use scene::Scene;

mod beside;
mod carried;
mod creep_laws;
mod curve;
mod equilibrium;
mod full;
mod turned_bushings;
mod vertical;

const THESIS: &str = include_str!("../../../../scenes/thesis-own-mesh.toml");

fn scene(overrides: &[&str]) -> Scene {
    let mut overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    overrides.push("vehicle.model=vertical".to_owned());
    Scene::from_toml(THESIS, "thesis-own-mesh.toml", &overrides).unwrap()
}

/// A vehicle alone.
struct Alone {
    layout: Layout,
    vehicle: Vehicle,
}

impl System for Alone {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.vehicle.forces(visit);
    }

    fn constraints(&mut self, visit: &mut dyn FnMut(&mut dyn Constraint)) {
        self.vehicle.constraints(visit);
    }
}

const BASE: Base = Base {
    start_x: 50.0,
    speed: 200.0 / 3.6,
};

/// Directions left free by joints and held coordinates at a state, as columns.
fn free_motions(alone: &Alone, state: &State) -> DMatrix<f64> {
    let (n, motion) = (state.q.len(), state.motion(&[]));
    let m = state.lambda.len();
    let mut held = DMatrix::zeros(m + alone.layout.fixed().len(), n);
    let mut first = 0;
    for joint in &alone.vehicle.joints {
        let mut sink = |row: usize, columns: &[usize], values: &[f64]| {
            for (&column, &value) in columns.iter().zip(values) {
                held[(first + row, column)] += value;
            }
        };
        joint.jacobian(&motion, &mut JacobianRows::new(&mut sink));
        first += joint.dimension();
    }
    for (row, &index) in alone.layout.fixed().iter().enumerate() {
        held[(m + row, index)] = 1.0;
    }
    // Null space of the held directions: eigenvectors of HᵀH at zero.
    let eigen = SymmetricEigen::new(held.transpose() * &held);
    let free: Vec<usize> = (0..n).filter(|&i| eigen.eigenvalues[i] < 1e-9).collect();
    DMatrix::from_columns(&free.iter().map(|&i| eigen.eigenvectors.column(i)).collect::<Vec<_>>())
}

/// Irregularities of a main line, and a position at which they are fully grown.
const ROUGH: &str = "track.irregularities={ model = \"spectrum\", seed = 7, wavelengths = [3.0, 80.0], \
    vertical_roughness = 4.032e-7, \
                     lateral_roughness = 2.119e-7, corners = [0.0206, 0.8246, 0.4380], fade = 20.0 }";

fn rough() -> Option<TrackShape> {
    let reach = Reach {
        start: 60.0,
        end: 400.0,
        rail_distance: 1.5,
    };
    TrackShape::new(scene(&[ROUGH]).track.as_deref().unwrap(), reach)
}

/// The unchanged scene: every wheel rolls on its rail.
fn full_scene(overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    Scene::from_toml(THESIS, "thesis-own-mesh.toml", &overrides).unwrap()
}
