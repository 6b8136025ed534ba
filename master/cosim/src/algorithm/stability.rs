//! Stability of an algorithm, found from the algorithm itself.
//!
//! On a free head and a massless spring a coupled step maps what the exchange remembers (heights, velocities, forces,
//! means of the last points, defects) linearly to the same a step later. The columns of that matrix are found by
//! stepping from unit vectors; its spectral radius is the growth of the contact's oscillation per macro step.

use scene::Coupling;

use crate::slave::Slave;
use component::exchange::line_output_count;

use super::{CouplingError, Exchange, Sides, build, oscillator};

/// Size of the matrix.
const SIZE: usize = Exchange::MEMORY;

/// Squarings of the matrix: its power 2³⁰.
const SQUARINGS: usize = 30;

/// Growth per step that counts as none.
const NEUTRAL: f64 = 1e-5;

/// Force at rest, N: the contact stays closed whatever value is moved.
const PRELOAD: f64 = 1e3;

type Matrix = Vec<[f64; SIZE]>;

/// Growth per macro step of the undamped contact oscillation with circular frequency times macro step `number` (–), for
/// slaves that can do everything.
///
/// # Errors
/// Region in which the algorithm does not settle.
pub fn spectral_radius(coupling: &Coupling, number: f64) -> Result<f64, CouplingError> {
    spectral_radius_known_as(coupling, number, 1.0)
}

/// The same for an algorithm that takes the contact's frequency for `factor` times what it is (–).
///
/// # Errors
/// Region in which the algorithm does not settle.
pub fn spectral_radius_known_as(coupling: &Coupling, number: f64, factor: f64) -> Result<f64, CouplingError> {
    // Unit mass and stiffness: the step is ωh. Rows are columns here: the radius is that of the transpose.
    let mut coupling = coupling.clone();
    coupling.force_tolerance = 1e-9;
    coupling.max_iterations = if coupling.max_iterations == 1 { 1 } else { 200 };
    let rest = step_from(&coupling, number, factor, None)?;
    let mut columns: Matrix = Vec::with_capacity(SIZE);
    for j in 0..SIZE {
        let moved = step_from(&coupling, number, factor, Some(j))?;
        columns.push(std::array::from_fn(|i| moved[i] - rest[i]));
    }
    Ok(radius(columns))
}

/// Memory after a step of `h` s from rest under a preload, with value `moved` of the memory moved by one.
fn step_from(coupling: &Coupling, h: f64, frequency: f64, moved: Option<usize>) -> Result<[f64; SIZE], CouplingError> {
    let mut memory = [0.0; SIZE];
    for point in memory[..SIZE - 2].chunks_exact_mut(4) {
        // Unit stiffness: height and force are the same number.
        point.copy_from_slice(&[PRELOAD, 0.0, -PRELOAD, -PRELOAD]);
    }
    if let Some(j) = moved {
        memory[j] += 1.0;
    }
    let (mut line, mut head) = oscillator::closed(memory[0] - PRELOAD, PRELOAD);
    head.v = memory[1];
    let mut pantographs: Vec<Box<dyn Slave>> = vec![Box::new(head)];
    let mut sides = Sides {
        line: &mut line,
        pantographs: &mut pantographs,
    };
    let (mut algorithm, _) = build(coupling, &sides);
    algorithm.know(frequency);
    let mut exchange = Exchange::start(&mut sides, 0.0, line_output_count(1, 0))?;
    exchange.set_memory(&memory, h);
    algorithm.step(&mut sides, &mut exchange, h)?;
    exchange.accept(h);
    Ok(exchange.memory())
}

/// Largest `ωh` (–), by steps of 0.01 up to `limit`, up to which the oscillation does not grow.
#[must_use]
pub fn stability_limit(coupling: &Coupling, limit: f64) -> f64 {
    let steps = (limit / 0.01).round() as usize;
    let stable = |n: &usize| {
        let number = 0.01 * *n as f64;
        spectral_radius(coupling, number).is_ok_and(|radius| radius <= 1.0 + NEUTRAL)
    };
    (1..=steps).take_while(stable).last().map_or(0.0, |n| 0.01 * n as f64)
}

/// Spectral radius as the limit of `|Aⁿ|^(1/n)`, by squaring.
fn radius(mut matrix: Matrix) -> f64 {
    let mut logarithm = 0.0;
    let mut weight = 1.0;
    for _ in 0..SQUARINGS {
        let norm = matrix.iter().flatten().fold(0.0_f64, |max, value| max.max(value.abs()));
        if norm == 0.0 || !norm.is_finite() {
            return if norm == 0.0 { 0.0 } else { f64::INFINITY };
        }
        logarithm += weight * norm.ln();
        weight *= 0.5;
        let scaled: Matrix = matrix.iter().map(|row| row.map(|value| value / norm)).collect();
        matrix = scaled
            .iter()
            .map(|row| std::array::from_fn(|j| row.iter().zip(&scaled).map(|(a, other)| a * other[j]).sum()))
            .collect();
    }
    logarithm.exp()
}
