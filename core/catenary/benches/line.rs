//! The lines of the shipped scenes: force, assembly, factorisation, solution, contact search and statics.
mod floor;

use catenary::{Line, Model, STRIP_VALUES, StaticLine, static_line};
use criterion::{Criterion, criterion_group, criterion_main};
use dynamics::{Blocks, FactoredMatrix, Force, Layout, Motion, StepHistory, Weights};
use floor::{Floors, measure, settings};
use scene::Scene;
use std::hint::black_box;

const SCENES: [(&str, &str); 2] = [
    ("thesis line", include_str!("../../../scenes/thesis-pantograph.toml")),
    ("EN 50318 line", include_str!("../../../scenes/en50318-300.toml")),
];
/// Names of what [`Line::forces`] visits.
const PARTS: [&str; 6] = ["contact wire", "messenger wire", "droppers", "supports", "arms", "ends"];

fn statics(text: &str) -> (Scene, StaticLine) {
    let scene = catenary::load(text, "bench.toml", &[]).expect("the shipped scene is good");
    let line = static_line(&scene).expect("the shipped line has an equilibrium");
    (scene, line)
}

/// Places of the entries of the iteration matrix, as an assembly into compressed columns has them.
fn places(line: &mut Line, motion: &Motion<'_>, weights: Weights) -> (Vec<u32>, usize) {
    let mut entries = Vec::new();
    let mut blocks = Blocks::record(&mut entries);
    line.forces(&mut |force| force.add_tangent(motion, weights, &mut blocks));
    let column_first = |&(row, column): &(u32, u32)| (column, row);
    let mut distinct = entries.clone();
    distinct.sort_by_key(column_first);
    distinct.dedup();
    let place = |entry: &(u32, u32)| distinct.binary_search_by_key(&column_first(entry), column_first);
    let places = entries.iter().map(|entry| place(entry).expect("recorded above") as u32);
    (places.collect(), distinct.len())
}

fn lines(criterion: &mut Criterion) {
    let floors = Floors::here();
    for (name, text) in SCENES {
        let (scene, statics) = statics(text);
        let mut layout = Layout::new();
        let mut line = statics.line_in(&mut layout);
        let n = layout.coordinates();
        let elements = line.topology().elements();
        let name = format!("{name} ({elements} elements, {n} coordinates)");
        let floor = elements as f64 * floors.force;
        let wave = |size: f64, phase: f64| -> Vec<f64> { (0..n).map(|i| size * (i as f64 + phase).sin()).collect() };
        let (q, v, v_dot) = (wave(1e-4, 0.0), wave(1e-2, 1.0), wave(1.0, 2.0));
        let motion = Motion {
            t: 0.0,
            q: &q,
            v: &v,
            rotation: &[],
            u: &[],
        };
        let mut force = vec![0.0; n];
        measure(criterion, &format!("{name}: force"), Some(floor), || {
            line.forces(&mut |part| part.add_force(black_box(&motion), black_box(&mut force)));
        });
        measure(criterion, &format!("{name}: force and inertia"), Some(floor), || {
            line.forces(&mut |part| match part.one_pass() {
                Some(part) => part.add_dynamic_force(black_box(&motion), black_box(&v_dot), black_box(&mut force)),
                None => part.add_force(black_box(&motion), black_box(&mut force)),
            });
        });
        for (number, part) in PARTS.iter().enumerate() {
            measure(criterion, &format!("{name}: force of the {part}"), None, || {
                let mut index = 0;
                line.forces(&mut |force_of_part| {
                    if index == number {
                        force_of_part.add_force(black_box(&motion), black_box(&mut force));
                    }
                    index += 1;
                });
            });
        }
        let weights = Weights { q: 1.0, v: 2e3 };
        let (places, entries) = places(&mut line, &motion, weights);
        let mut values = vec![0.0; entries];
        let floor = elements as f64 * (floors.force_and_tangent - floors.force);
        measure(criterion, &format!("{name}: assembly"), Some(floor), || {
            values.fill(0.0);
            let mut blocks = Blocks::add_to(&places, black_box(&mut values));
            line.forces(&mut |part| part.add_tangent(black_box(&motion), weights, &mut blocks));
        });
        let mut model = Model::with_prescribed_strips(&scene, layout, Box::new(line)).expect("a line of our own");
        let mut u = vec![0.0; STRIP_VALUES * scene.pantographs.len()];
        (u[0], u[2], u[3]) = (scene.strip_start_x(0), 5.0, scene.run.speed);
        let motion = Motion { u: &u, ..motion };
        let mut matrix = FactoredMatrix::analyse(&mut model, &motion);
        let assembly_and_factor = floor + n as f64 * floors.factor;
        let mass_weight = 4e6;
        measure(
            criterion,
            &format!("{name}: assembly and factor"),
            Some(assembly_and_factor),
            || {
                let factored = matrix.factor(&mut model, black_box(&motion), mass_weight, weights);
                factored.expect("a line that is held");
            },
        );
        let mut solution = vec![0.0; n];
        measure(
            criterion,
            &format!("{name}: solve"),
            Some(n as f64 * floors.solve),
            || {
                matrix.solve(black_box(&v_dot), black_box(&mut solution));
            },
        );
        let contact = &mut model.contacts[0];
        measure(criterion, &format!("{name}: contact search and force"), None, || {
            contact.begin_step(black_box(&motion), 1e-3);
            contact.add_force(black_box(&motion), black_box(&mut force));
        });
        measure(criterion, &format!("{name}: statics"), None, || {
            black_box(static_line(black_box(&scene))).expect("the shipped line has an equilibrium");
        });
    }
}

criterion_group! {
    name = benches;
    config = settings();
    targets = lines
}
criterion_main!(benches);
