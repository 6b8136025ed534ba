//! Factorisation, solution, local column and step of a synthetic line: 800 blocks of 8 unknowns, as many as the EN
//! 50318 line has in its plane with 8 elements per dropper interval.
use criterion::{Criterion, criterion_group, criterion_main};
use dynamics::{
    BlockTridiagonal, Blocks, Force, GeneralizedAlpha, Layout, LowRank, Motion, NewtonOptions, Precision, SparseMatrix,
    StepHistory, System, Updates, Weights,
};
use std::hint::black_box;
use std::ops::Range;

const NODES: usize = 800;
const WIDTH: usize = 8;
const SIZE: usize = NODES * WIDTH;
const H: f64 = 1e-3;

/// Two stretched strings on a foundation, each coordinate a string of its own: mass 1 kg and spring 1e4 N/m per node
/// and coordinate, 3e5 N/m from node to node, and as much as a tenth of that across within a node pair.
struct Chain {
    stiffness: SparseMatrix,
    mass: SparseMatrix,
    contact: usize,
    version: u64,
}

fn links() -> impl Iterator<Item = (usize, usize, f64)> {
    let along = (0..SIZE - WIDTH).map(|i| (i, i + WIDTH, 3e5));
    let across = (0..SIZE).flat_map(|i| (i + 1..(i / WIDTH + 1) * WIDTH).map(move |j| (i, j, 3e4)));
    let diagonal = (0..SIZE - WIDTH).flat_map(|i| {
        let next = (i / WIDTH + 1) * WIDTH;
        (next..next + WIDTH).map(move |j| (i, j, 1e4))
    });
    along.chain(across).chain(diagonal)
}

fn entries() -> Vec<(u32, u32, f64)> {
    let springs = links().flat_map(|(i, j, k)| {
        let (i, j) = (i as u32, j as u32);
        [(i, i, k), (j, j, k), (i, j, -k), (j, i, -k)]
    });
    springs.chain((0..SIZE as u32).map(|i| (i, i, 1e4))).collect()
}

impl Chain {
    fn new() -> Self {
        Self {
            stiffness: SparseMatrix::from_entries(SIZE, entries()),
            mass: SparseMatrix::from_entries(SIZE, (0..SIZE as u32).map(|i| (i, i, 1.0)).collect()),
            contact: SIZE / 4,
            version: 0,
        }
    }

    fn add(matrix: &SparseMatrix, weight: f64, blocks: &mut Blocks<'_>) {
        for row in 0..SIZE {
            for (column, value) in matrix.row(row) {
                blocks.add(&[row], &[column], &[weight * value]);
            }
        }
    }
}

impl Force for Chain {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        self.stiffness.multiply_subtract(motion.q, force);
        let gap = motion.q[self.contact] + motion.q[self.contact + WIDTH] - 1e-3 * (20.0 * motion.t).sin();
        force[self.contact] -= 5e4 * gap;
        force[self.contact + WIDTH] -= 5e4 * gap;
    }

    fn add_tangent(&mut self, _: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        Self::add(&self.stiffness, weights.q, blocks);
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        Self::add(&self.mass, 1.0, blocks);
    }

    fn low_rank(&mut self) -> Option<&mut dyn LowRank> {
        Some(self)
    }

    fn step_history(&mut self) -> Option<&mut dyn StepHistory> {
        Some(self)
    }
}

impl LowRank for Chain {
    fn push_updates(&mut self, _: &Motion<'_>, weights: Weights, updates: &mut Updates) {
        let entries = [(self.contact, 1.0), (self.contact + WIDTH, 1.0)];
        updates.rank_one(0, self.version, 5e4 * weights.q, entries.into_iter());
    }
}

impl StepHistory for Chain {
    fn begin_step(&mut self, _: &Motion<'_>, _: f64) {
        self.version += 1;
        self.contact = SIZE / 4 + (self.version as usize % 1000) / 10 * WIDTH;
    }
}

struct Line {
    layout: Layout,
    chain: Chain,
}

impl System for Line {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        visit(&mut self.chain);
    }
}

fn matrix(criterion: &mut Criterion) {
    let chain = Chain::new();
    let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
    for column in 0..SIZE {
        for (row, value) in chain.stiffness.row(column) {
            rows.push(row);
            values.push(value + if row == column { 4.0 / (H * H) } else { 0.0 });
        }
        starts.push(rows.len());
    }
    let unknowns: Vec<usize> = (0..SIZE).collect();
    let mut matrix = BlockTridiagonal::analyse(&unknowns, &starts, &rows, Precision::Double).expect("blocks of 8");
    let mut group = criterion.benchmark_group("800 blocks of 8");
    group.bench_function("factor", |bencher| {
        bencher.iter(|| assert!(matrix.factor(black_box(&values))));
    });
    let right_side: Vec<f64> = (0..SIZE).map(|i| ((i * 7 % 11) as f64) - 5.0).collect();
    let local: Vec<f64> = (0..SIZE)
        .map(|i| {
            if (SIZE / 3..SIZE / 3 + 160).contains(&i) {
                right_side[i]
            } else {
                0.0
            }
        })
        .collect();
    let mut solution = vec![0.0; SIZE];
    let mut ignore = |_: Range<usize>, _: Range<usize>| ();
    for (name, right_side, threshold) in [
        ("solve", &right_side, 0.0),
        ("solve, 20 blocks above the threshold", &local, 1e-4),
    ] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                matrix.load(black_box(right_side));
                matrix.solve(threshold, black_box(&mut solution), &mut ignore);
            });
        });
    }
    let mut column = matrix.new_column();
    group.bench_function("local column", |bencher| {
        bencher.iter(|| matrix.column(&[(SIZE / 3, 1.0), (SIZE / 3 + 8, 1.0)], 1e-9, black_box(&mut column)));
    });
    group.finish();
}

fn step(criterion: &mut Criterion) {
    let mut layout = Layout::new();
    layout.add_coordinates(SIZE, "line");
    let mut line = Line {
        layout,
        chain: Chain::new(),
    };
    let options = NewtonOptions {
        tolerance: 1e-3,
        ..NewtonOptions::default()
    };
    let mut integrator = GeneralizedAlpha::new(0.9, options);
    let mut state = line.layout.state_at_rest();
    let mut steps = 0.0;
    criterion.bench_function("step of 800 blocks of 8, sparse products included", |bencher| {
        bencher.iter(|| {
            steps += 1.0;
            integrator
                .step(&mut line, &mut state, &[], steps * H, H)
                .expect("a linear system")
        });
    });
    println!("{:?}", integrator.counters());
}

criterion_group!(benches, matrix, step);
criterion_main!(benches);
