//! Strips and forces over a step that has not been taken yet.

use scene::Force;

use component::exchange::{contact, load, strip};

use component::Point;

use super::{Exchange, Polynomial};

/// Motion of all strips, extrapolated with degree `order` (0 to 2); roll with degree 1 at most.
///
/// The acceleration of degree 2 is that at the end of the cubic through the last two positions and velocities:
///
/// ```text
/// a = (4 vₙ + 2 vₙ₋₁ − 6 (zₙ − zₙ₋₁)/h)/h        (derived here)
/// ```
///
/// Exact where the force on the strip was constant or linear over the last step.
pub fn strips(exchange: &Exchange, order: usize, polynomial: &mut Polynomial) {
    // Degree 0 is sent with a first derivative of zero: without any, the line would follow the velocity.
    polynomial.clear(order.max(1));
    let (now, before) = (exchange.point(0), exchange.point(1));
    for i in 0..exchange.strip_count() {
        let motion = now.strip(i);
        let at = i * strip::MOTION;
        polynomial.value[at..at + strip::MOTION].copy_from_slice(&motion[..strip::MOTION]);
        let [first, second, _] = &mut polynomial.derivatives;
        for axis in 0..3 {
            let velocity = motion[strip::VX + axis];
            if order >= 1 {
                first[at + strip::X + axis] = velocity;
            }
            if order >= 2 && exchange.known() > 1 {
                let (h, old) = (now.t - before.t, before.strip(i));
                let mean = (motion[strip::X + axis] - old[strip::X + axis]) / h;
                let acceleration = (4.0 * velocity + 2.0 * old[strip::VX + axis] - 6.0 * mean) / h;
                second[at + strip::X + axis] = acceleration;
                first[at + strip::VX + axis] = acceleration;
            }
        }
        if order >= 1 && exchange.known() > 1 {
            // No output is its rate.
            let change = motion[strip::ROLL] - before.strip(i)[strip::ROLL];
            first[at + strip::ROLL] = change / (now.t - before.t);
        }
    }
}

/// Motion of all strips from the present point to `end` (in [`Exchange`]'s order of outputs): the cubic through both
/// positions and velocities, and its derivative as velocity.
///
/// ```text
/// p = z₀ + v₀ τ + a τ²/2 + b τ³/6,   Δ = (z₁ − z₀)/h                                            (derived here)
/// a = (6 Δ − 4 v₀ − 2 v₁)/h,   b = (6 v₀ + 6 v₁ − 12 Δ)/h²
/// ```
///
/// Roll is a straight line.
pub fn hermite(start: &Point, end: &[f64], h: f64, polynomial: &mut Polynomial) {
    polynomial.clear(3);
    for i in 0..start.strip_count() {
        let (from, to) = (start.strip(i), &end[i * strip::OUTPUTS..(i + 1) * strip::OUTPUTS]);
        let at = i * strip::MOTION;
        polynomial.value[at..at + strip::MOTION].copy_from_slice(&from[..strip::MOTION]);
        let [first, second, third] = &mut polynomial.derivatives;
        for axis in 0..3 {
            let (position, velocity) = (at + strip::X + axis, at + strip::VX + axis);
            let (v0, v1) = (from[strip::VX + axis], to[strip::VX + axis]);
            let mean = (to[strip::X + axis] - from[strip::X + axis]) / h;
            let a = (6.0 * mean - 4.0 * v0 - 2.0 * v1) / h;
            let b = (6.0 * v0 + 6.0 * v1 - 12.0 * mean) / (h * h);
            first[position] = v0;
            second[position] = a;
            third[position] = b;
            first[velocity] = a;
            second[velocity] = b;
        }
        first[at + strip::ROLL] = (to[strip::ROLL] - from[strip::ROLL]) / h;
    }
}

/// Output of the line that stands for load component `component`.
fn source(component: usize, force: Force) -> usize {
    match (component, force) {
        (load::Y, _) => contact::Y,
        (_, Force::Mean) => contact::MEAN_FX + component,
        _ => contact::FX + component,
    }
}

/// Load on pantograph `i` over a step whose forces the line does not know yet, for a step of `h` s.
pub fn load(exchange: &Exchange, i: usize, force: Force, order: usize, h: f64, polynomial: &mut Polynomial) {
    let closed = (0..exchange.known())
        .take_while(|&back| exchange.point(back).contact(i)[contact::FORCE] > 0.0)
        .count();
    let order = order.min(closed.saturating_sub(1));
    polynomial.clear(if force == Force::Interpolated { order } else { 0 });
    for component in 0..load::COUNT {
        let index = source(component, force);
        let value = |back: usize| exchange.point(back).contact(i)[index];
        // Means belong to the middle of their step, all else to its end.
        let time = |back: usize| {
            let point = exchange.point(back);
            if index == contact::Y || force != Force::Mean {
                point.t
            } else {
                0.5 * (point.from + point.t)
            }
        };
        let first = |back: usize| (value(back) - value(back + 1)) / (time(back) - time(back + 1));
        let mut rate = 0.0;
        let mut curvature = 0.0; // second divided difference
        if order >= 1 {
            rate = first(0);
        }
        if order >= 2 {
            curvature = (first(0) - first(1)) / (time(0) - time(2));
            rate += curvature * (time(0) - time(1));
        }
        let now = value(0);
        match force {
            Force::Interpolated => {
                polynomial.value[component] = now;
                polynomial.derivatives[0][component] = rate;
                polynomial.derivatives[1][component] = 2.0 * curvature;
            }
            Force::Mean => {
                let tau = exchange.point(0).t + 0.5 * h - time(0);
                polynomial.value[component] = now + tau * (rate + tau * curvature);
            }
            Force::End => polynomial.value[component] = now,
        }
    }
}

/// Load on pantograph `i` over a step that the line has just completed.
pub fn known_load(exchange: &Exchange, i: usize, force: Force, h: f64, polynomial: &mut Polynomial) {
    let (start, end) = (exchange.point(0).contact(i), exchange.reached.contact(i));
    polynomial.clear(usize::from(force == Force::Interpolated));
    for component in 0..load::COUNT {
        let index = source(component, force);
        polynomial.value[component] = match force {
            Force::Mean if component == load::Y => 0.5 * (start[index] + end[index]),
            Force::Mean | Force::End => end[index],
            Force::Interpolated => {
                polynomial.derivatives[0][component] = (end[index] - start[index]) / h;
                start[index]
            }
        };
    }
}
