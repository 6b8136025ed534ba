use super::*;
use nalgebra::{DMatrix, DVector};

/// Numbers that repeat: a linear congruential generator [Knuth, TAOCP 2, section 3.3.4].
struct Random(u64);

impl Random {
    /// Uniform in −1…1.
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn below(&mut self, end: usize) -> usize {
        ((0.5 * (self.next() + 1.0) * end as f64) as usize).min(end - 1)
    }
}

type Runs = Vec<(Range<usize>, Range<usize>)>;

/// A symmetric matrix in compressed columns, dense within blocks of `sizes` and between neighbours.
struct Sample {
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
    dense: DMatrix<f64>,
    unknowns: Vec<usize>,
}

impl Sample {
    /// Diagonally dominant by `margin`; below 0 it is indefinite. `spread` leaves gaps in the numbers of the unknowns.
    fn new(random: &mut Random, sizes: &[usize], margin: f64, spread: bool) -> Self {
        let size = sizes.iter().sum();
        let block: Vec<usize> = (sizes.iter().enumerate())
            .flat_map(|(i, &size)| std::iter::repeat_n(i, size))
            .collect();
        let mut dense = DMatrix::zeros(size, size);
        for column in 0..size {
            for row in column + 1..size {
                if block[row] - block[column] <= 1 {
                    let value = random.next();
                    (dense[(row, column)], dense[(column, row)]) = (value, value);
                }
            }
        }
        for i in 0..size {
            dense[(i, i)] = dense.row(i).iter().map(|value: &f64| value.abs()).sum::<f64>() + margin;
        }
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for column in 0..size {
            for row in 0..size {
                if block[row].abs_diff(block[column]) <= 1 {
                    rows.push(row);
                    values.push(dense[(row, column)]);
                }
            }
            starts.push(rows.len());
        }
        let mut next = 0;
        let unknowns = (0..size)
            .map(|_| {
                next += 1 + if spread { random.below(4) / 3 } else { 0 };
                next - 1
            })
            .collect();
        Self {
            starts,
            rows,
            values,
            dense,
            unknowns,
        }
    }

    /// The same matrix with factors in single precision, whatever its size.
    fn factored_in_single_precision(&self) -> BlockTridiagonal {
        let arch = narrow();
        let (bounds, _) = structure::cut(&self.starts, &self.rows, lanes::<f32>(arch)).expect("small blocks");
        let pattern = (&self.unknowns[..], &self.starts[..], &self.rows[..]);
        let mut matrix = BlockTridiagonal::new(arch, &bounds, pattern, Factors::Single);
        assert!(matrix.factor(&self.values), "positive definite");
        matrix
    }

    fn factored(&self) -> BlockTridiagonal {
        let mut matrix = BlockTridiagonal::analyse(&self.unknowns, &self.starts, &self.rows, Precision::Double)
            .expect("small blocks");
        assert!(matrix.factor(&self.values), "positive definite");
        matrix
    }

    /// A vector of the whole system with `local` in the places of the unknowns.
    fn global(&self, local: &[f64]) -> Vec<f64> {
        let mut global = vec![0.0; self.unknowns.last().map_or(0, |last| last + 3)];
        for (&unknown, &value) in self.unknowns.iter().zip(local) {
            global[unknown] = value;
        }
        global
    }

    /// The solution, and the runs of unknowns that were solved, alone and with those they couple with.
    fn solve(&self, matrix: &mut BlockTridiagonal, local: &[f64], threshold: f64) -> (Vec<f64>, Runs) {
        let mut solution = self.global(&vec![0.0; local.len()]);
        let mut changed = Vec::new();
        matrix.load(&self.global(local));
        matrix.solve(threshold, &mut solution, &mut |inner, outer| {
            changed.push((inner, outer))
        });
        let solution = self.unknowns.iter().map(|&unknown| solution[unknown]).collect();
        (solution, changed)
    }
}

fn sizes(random: &mut Random, blocks: usize, largest: usize) -> Vec<usize> {
    (0..blocks).map(|_| 1 + random.below(largest)).collect()
}

#[test]
fn solutions_agree_with_dense_cholesky_for_blocks_of_any_size() {
    let mut random = Random(1);
    let random_sizes = [
        (1, 1),
        (1, 9),
        (2, 5),
        (3, 8),
        (7, 3),
        (12, 12),
        (9, 17),
        (5, 40),
        (40, 8),
    ];
    let mut cases: Vec<Vec<usize>> = (random_sizes.iter())
        .map(|&(blocks, largest)| sizes(&mut random, blocks, largest))
        .collect();
    // Blocks that fill the vectors of one processor or another, with others between them.
    for width in [4, 8, 16] {
        cases.push(vec![width; 13]);
        cases.push((0..24).map(|i| width + 2 * usize::from(i % 8 == 5)).collect());
    }
    for sizes in cases {
        for spread in [false, true] {
            let sample = Sample::new(&mut random, &sizes, 0.1, spread);
            let mut matrix = sample.factored();
            let b: Vec<f64> = (0..sample.unknowns.len()).map(|_| random.next()).collect();
            let exact = sample
                .dense
                .clone()
                .cholesky()
                .unwrap()
                .solve(&DVector::from_column_slice(&b));
            let (x, changed) = sample.solve(&mut matrix, &b, 0.0);
            assert_eq!(changed, vec![(0..b.len(), 0..b.len())]);
            for (x, exact) in x.iter().zip(&exact) {
                assert!(
                    (x - exact).abs() < 1e-12 * (1.0 + exact.abs()),
                    "{sizes:?}: {x} {exact}"
                );
            }
        }
    }
}

#[test]
fn the_lower_triangle_alone_counts() {
    let mut random = Random(2);
    let sample = Sample::new(&mut random, &[8; 6], 0.1, false);
    let mut matrix = sample.factored();
    let b: Vec<f64> = (0..48).map(|_| random.next()).collect();
    let (x, _) = sample.solve(&mut matrix, &b, 0.0);
    let mut upper_wrong = sample.values.clone();
    for column in 0..48 {
        let range = sample.starts[column]..sample.starts[column + 1];
        for (value, &row) in upper_wrong[range.clone()].iter_mut().zip(&sample.rows[range]) {
            if row < column {
                *value = 1e3;
            }
        }
    }
    assert!(matrix.factor(&upper_wrong));
    assert_eq!(sample.solve(&mut matrix, &b, 0.0).0, x);
}

#[test]
fn an_indefinite_matrix_is_refused_wherever_it_is_indefinite() {
    let mut random = Random(3);
    let mut sample = Sample::new(&mut random, &[5, 8, 8, 3, 9, 8], 0.1, false);
    let mut matrix = sample.factored();
    for unknown in 0..sample.unknowns.len() {
        let diagonal = (sample.starts[unknown]..sample.starts[unknown + 1])
            .find(|&k| sample.rows[k] == unknown)
            .unwrap();
        let right = std::mem::replace(&mut sample.values[diagonal], -1.0);
        assert!(!matrix.factor(&sample.values), "unknown {unknown}");
        sample.values[diagonal] = f64::NAN;
        assert!(!matrix.factor(&sample.values), "unknown {unknown} is not a number");
        sample.values[diagonal] = right;
    }
    assert!(matrix.factor(&sample.values), "and is as good as new after a refusal");
}

#[test]
fn a_second_factorisation_and_solution_repeat_bit_for_bit() {
    let mut random = Random(4);
    let sizes = sizes(&mut random, 30, 13);
    let sample = Sample::new(&mut random, &sizes, 0.1, true);
    let b: Vec<f64> = (0..sample.unknowns.len()).map(|_| random.next()).collect();
    let mut matrix = sample.factored();
    let (first, _) = sample.solve(&mut matrix, &b, 0.0);
    let mut column = LocalColumn::default();
    matrix.column(&[(7, 1.0)], 1e-12, &mut column);
    let (again, _) = sample.solve(&mut matrix, &b, 0.0);
    let (anew, _) = sample.solve(&mut sample.factored(), &b, 0.0);
    assert_eq!(first, again);
    assert_eq!(first, anew);
}

#[test]
fn a_solution_takes_the_place_of_the_last_one_and_one_that_is_not_finite_leaves_nothing_behind() {
    let mut random = Random(8);
    let sample = decaying(&mut random, 40);
    let size = sample.unknowns.len();
    let right_side = |places: Range<usize>| {
        let values = (0..size).map(|i| if places.contains(&i) { 1.0 } else { 0.0 });
        sample.global(&values.collect::<Vec<_>>())
    };
    let mut matrix = sample.factored();
    let mut solution = sample.global(&vec![0.0; size]);
    let mut spoilt = right_side(9..30);
    spoilt[sample.unknowns[20]] = f64::INFINITY;
    // Everywhere, nowhere, here, there, and here again after what is no number.
    let cases = [
        (right_side(0..size), true),
        (right_side(0..0), true),
        (right_side(20..24), true),
        (right_side(size - 30..size), true),
        (spoilt, false),
        (right_side(20..24), true),
    ];
    for (case, (b, finite)) in cases.into_iter().enumerate() {
        matrix.load(&b);
        assert_eq!(matrix.solve(1e-6, &mut solution, &mut |_, _| ()), finite, "case {case}");
        if finite {
            let mut fresh = sample.factored();
            fresh.load(&b);
            let mut alone = sample.global(&vec![0.0; size]);
            fresh.solve(1e-6, &mut alone, &mut |_, _| ());
            assert_eq!(solution, alone, "case {case}");
        }
    }
}

/// Strongly dominant, so that solutions decay within a few blocks.
fn decaying(random: &mut Random, blocks: usize) -> Sample {
    let sizes: Vec<usize> = (0..blocks).map(|i| [8, 8, 10, 8, 5][i % 5]).collect();
    Sample::new(random, &sizes, 20.0, true)
}

#[test]
fn a_local_column_is_the_solution_down_to_where_it_has_decayed() {
    let mut random = Random(5);
    let sample = decaying(&mut random, 120);
    let mut matrix = sample.factored();
    let size = sample.unknowns.len();
    let cholesky = sample.dense.clone().cholesky().unwrap();
    // Both halves, both ends, and on both sides of the middle.
    for at in [
        0,
        3,
        size / 5,
        size / 2 - 20,
        size / 2,
        size / 2 + 9,
        4 * size / 5,
        size - 1,
    ] {
        let entries = [(at, 1.0), ((at + 9).min(size - 1), -0.5), (at, 0.25)];
        let mut u = DVector::zeros(size);
        entries.iter().for_each(|&(i, value)| u[i] += value);
        let exact = cholesky.solve(&u);
        let mut column = LocalColumn::default();
        let mut lengths = Vec::new();
        for relative in [0.0, 1e-14, 1e-8, 1e-4] {
            matrix.column(&entries, relative, &mut column);
            let y = DVector::from_fn(size, |i, _| matrix.entry(&column, i));
            let left = (&u - &sample.dense * y).amax();
            assert!(left < 4.0 * relative + 1e-14, "{at}, {relative}: {left:e} is left");
            lengths.push(column.len());
        }
        assert!(lengths[0] >= size && lengths.is_sorted_by(|a, b| a > b), "{lengths:?}");
        assert!(lengths[1] < size / 2, "{lengths:?}");
        // The product of the column with a right side is that of the exact column.
        matrix.column(&entries, 1e-14, &mut column);
        let b: Vec<f64> = (0..size).map(|_| random.next()).collect();
        matrix.load(&sample.global(&b));
        let product = matrix.dot(&column);
        assert!((product - exact.dot(&DVector::from_column_slice(&b))).abs() < 1e-12);
        matrix.solve(0.0, &mut sample.global(&b), &mut |_, _| ());
    }
    let mut empty = LocalColumn::default();
    matrix.column(&[], 1e-14, &mut empty);
    assert_eq!((empty.len(), matrix.entry(&empty, 5)), (0, 0.0));
}

#[test]
fn what_a_solution_leaves_out_is_of_the_order_of_its_threshold() {
    let mut random = Random(6);
    let sample = decaying(&mut random, 90);
    let mut matrix = sample.factored();
    let size = sample.unknowns.len();
    // Two places far apart stand out of a background.
    for (background, threshold, runs) in [(1e-9, 1e-6, 2), (1e-5, 1e-6, 1), (0.0, 1e-12, 2), (0.0, 2.0, 0)] {
        let mut b: Vec<f64> = (0..size).map(|_| background * random.next()).collect();
        for (at, value) in [(size / 8, 1.0), (size / 8 + 11, -0.3), (7 * size / 8, 0.7)] {
            b[at] = value;
        }
        let (x, changed) = sample.solve(&mut matrix, &b, threshold);
        assert_eq!(changed.len(), runs, "{changed:?}");
        let inside = |i: usize| changed.iter().any(|(range, _)| range.contains(&i));
        assert!((0..size).all(|i| inside(i) == (x[i] != 0.0)));
        let left = (DVector::from_column_slice(&b) - &sample.dense * DVector::from_column_slice(&x)).amax();
        assert!(
            left <= 4.0 * threshold,
            "{left:e} is left at a threshold of {threshold:e}"
        );
        for (range, around) in &changed {
            let reached = |i: usize| (0..size).all(|row| around.contains(&row) || sample.dense[(row, i)] == 0.0);
            assert!(range.clone().all(reached), "{range:?}, {around:?}");
        }
    }
}

#[test]
fn a_chain_of_nodes_is_cut_into_its_nodes() {
    let mut random = Random(7);
    let sample = Sample::new(&mut random, &[8; 50], 0.1, false);
    assert_eq!(sample.factored().shape(), (50, 8));
    // A wide band is not worth blocks.
    let size = 400;
    let (mut starts, mut rows) = (vec![0], Vec::new());
    for column in 0..size {
        rows.extend((0..size).filter(|&row: &usize| row.abs_diff(column) <= 60));
        starts.push(rows.len());
    }
    let unknowns: Vec<usize> = (0..size).collect();
    assert!(BlockTridiagonal::analyse(&unknowns, &starts, &rows, Precision::Double).is_none());
}

#[test]
fn corrections_with_factors_in_single_precision_reach_double_precision() {
    let mut random = Random(9);
    let mut cases: Vec<Vec<usize>> = vec![vec![12; 30], vec![16; 13], vec![24; 7]];
    cases.push(sizes(&mut random, 25, 20));
    for sizes in cases {
        let sample = Sample::new(&mut random, &sizes, 0.1, true);
        let mut matrix = sample.factored_in_single_precision();
        let b = DVector::from_fn(sample.unknowns.len(), |_, _| random.next());
        let exact = sample.dense.clone().cholesky().unwrap().solve(&b);
        let mut x = DVector::zeros(b.len());
        let mut errors = Vec::new();
        for _ in 0..3 {
            let left = &b - &sample.dense * &x;
            x += DVector::from_vec(sample.solve(&mut matrix, left.as_slice(), 0.0).0);
            errors.push((&x - &exact).amax() / exact.amax());
        }
        assert!(errors[0] > 1e-10 && errors[0] < 1e-4, "{errors:?}");
        assert!(errors[1] < 1e-3 * errors[0] && errors[2] < 1e-13, "{errors:?}");
        // A column and its product with a right side.
        let entries = [(sizes[0], 1.0), (sizes[0] + 3, -0.5)];
        let mut column = matrix.new_column();
        matrix.column(&entries, 0.0, &mut column);
        let u = DVector::from_fn(b.len(), |i, _| {
            entries.iter().filter(|(at, _)| *at == i).map(|(_, value)| value).sum()
        });
        let y = sample.dense.clone().cholesky().unwrap().solve(&u);
        assert!((0..y.len()).all(|i| (matrix.entry(&column, i) - y[i]).abs() < 1e-4 * y.amax()));
        matrix.load(&sample.global(b.as_slice()));
        assert!((matrix.dot(&column) - y.dot(&b)).abs() < 1e-4 * y.amax() * b.amax() * b.len() as f64);
    }
}

#[test]
fn factors_that_a_cache_holds_stay_in_double_precision() {
    let single = |size: usize, blocks: usize, precision: Precision| {
        let count = size * blocks;
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for column in 0..count {
            let first = (column / size).saturating_sub(1) * size;
            rows.extend(first..(size * (column / size + 2)).min(count));
            starts.push(rows.len());
        }
        let unknowns: Vec<usize> = (0..count).collect();
        let matrix = BlockTridiagonal::analyse(&unknowns, &starts, &rows, precision).unwrap();
        matches!(matrix.factors, Factors::Single(_))
    };
    assert!(single(16, 800, Precision::Mixed));
    assert!(!single(16, 800, Precision::Double));
    assert!(!single(16, 100, Precision::Mixed));
}
