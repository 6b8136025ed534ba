//! The coordinates of a system and its constraint equations.
use crate::State;
use nalgebra::UnitQuaternion;
use std::ops::Range;

/// The coordinates of a system, built up part by part: a line and a pantograph may share one layout.
#[derive(Clone, Debug, Default)]
pub struct Layout {
    coordinates: usize,
    constraints: usize,
    fixed: Vec<usize>,
    rotations: Vec<usize>,
    orientations: Vec<UnitQuaternion<f64>>,
    names: Vec<(usize, String)>,
}

impl Layout {
    /// An empty layout.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds `count` translational coordinates under one name ("contact_wire, node 12"); returns the first index.
    pub fn add_coordinates(&mut self, count: usize, name: impl Into<String>) -> usize {
        let first = self.coordinates;
        self.names.push((first, name.into()));
        self.coordinates += count;
        first
    }

    /// Adds a rigid body's three rotational coordinates (body-frame angular velocity) with its start orientation;
    /// returns the first index and the index into [`crate::Motion::rotation`].
    pub fn add_rotation(&mut self, orientation: UnitQuaternion<f64>, name: impl Into<String>) -> (usize, usize) {
        let first = self.add_coordinates(3, name);
        self.rotations.push(first);
        self.orientations.push(orientation);
        (first, self.rotations.len() - 1)
    }

    /// Adds `count` constraint equations; returns the first index of their multipliers.
    pub fn add_constraints(&mut self, count: usize) -> usize {
        let first = self.constraints;
        self.constraints += count;
        first
    }

    /// Holds a coordinate at its value in the start state.
    pub fn fix(&mut self, index: usize) {
        self.fixed.push(index);
    }

    /// Holds exactly the coordinates `fixed` within `range`; earlier ones there are released.
    pub fn fix_within(&mut self, range: Range<usize>, fixed: &[usize]) {
        self.fixed.retain(|index| !range.contains(index));
        self.fixed.extend_from_slice(fixed);
    }

    /// Number of generalised velocities.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        self.coordinates
    }

    /// Number of constraint equations.
    #[must_use]
    pub fn constraints(&self) -> usize {
        self.constraints
    }

    /// Coordinates held fixed.
    #[must_use]
    pub fn fixed(&self) -> &[usize] {
        &self.fixed
    }

    /// First velocity index of each rotation.
    #[must_use]
    pub fn rotations(&self) -> &[usize] {
        &self.rotations
    }

    /// Name of the part that coordinate `index` belongs to, with its number within that part.
    #[must_use]
    pub fn name(&self, index: usize) -> String {
        match self.names.iter().rev().find(|(first, _)| *first <= index) {
            Some((first, name)) => format!("{name}, coordinate {}", index - first + 1),
            None => format!("coordinate {index}"),
        }
    }

    /// The state at rest with all coordinates zero and the start orientations.
    #[must_use]
    pub fn state_at_rest(&self) -> State {
        State::at_rest(self.coordinates, self.constraints, self.orientations.clone())
    }
}
