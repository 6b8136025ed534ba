//! Measured times beside what is attainable.
// Each bench uses a part of this module.
#![allow(dead_code)]

use criterion::Criterion;
use std::time::{Duration, Instant};

/// Floors of the time of prototypes on one core with AVX-512, AVX2 and neither, for the line of the thesis: 360
/// elements, 2172 coordinates. Floors are proportional to the number of elements or coordinates.
pub struct Floors {
    /// Internal force of one element, s.
    pub force: f64,
    /// Internal force and tangent of one element, s.
    pub force_and_tangent: f64,
    /// Block-tridiagonal Cholesky factorisation, s per coordinate.
    pub factor: f64,
    /// Solution with inverted blocks, s per coordinate.
    pub solve: f64,
}

impl Floors {
    /// Times of this processor.
    pub fn here() -> Self {
        let elements = 360.0;
        let coordinates = 2172.0;
        #[cfg(target_arch = "x86_64")]
        let (force, force_and_tangent) = if std::is_x86_feature_detected!("avx512f") {
            (2.9e-6, 23e-6)
        } else if std::is_x86_feature_detected!("avx2") {
            (5.5e-6, 23e-6)
        } else {
            (22e-6, 195e-6)
        };
        #[cfg(not(target_arch = "x86_64"))]
        let (force, force_and_tangent) = (22e-6, 195e-6);
        Self {
            force: force / elements,
            force_and_tangent: force_and_tangent / elements,
            factor: 45e-6 / coordinates,
            solve: 6e-6 / coordinates,
        }
    }
}

/// Measures with criterion, and prints the fastest sample beside its floor in s.
pub fn measure(criterion: &mut Criterion, name: &str, floor: Option<f64>, mut routine: impl FnMut()) {
    let mut best = f64::INFINITY;
    criterion.bench_function(name, |bencher| {
        bencher.iter_custom(|count| {
            let start = Instant::now();
            for _ in 0..count {
                routine();
            }
            let wall = start.elapsed();
            best = best.min(wall.as_secs_f64() / count as f64);
            wall
        });
    });
    if best.is_finite() {
        print(name, best, floor);
    }
}

/// Prints a time in s beside its floor. No output under `cargo test`, which runs benches without the flag of `cargo
/// bench`.
pub fn print(name: &str, time: f64, floor: Option<f64>) {
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    let ratio = floor.map_or_else(
        || "no floor".to_owned(),
        |floor| format!("{:.2} x the floor of {:.3} µs", time / floor, 1e6 * floor),
    );
    println!("{name}: {:.3} µs, {ratio}\n", 1e6 * time);
}

/// Short enough that all benches together take minutes.
pub fn settings() -> Criterion {
    Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
}
