use super::*;
use dynamics::State;

/// Numbers between −1 and 1 without a pattern.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Two chains of four nodes, interleaved, with one further coordinate between the second and the third pair.
fn chains<const B: usize>(map: fn(usize) -> NodeMap) -> (Vec<Vec<NodeMap>>, usize) {
    let start = |node: usize, chain: usize| (2 * node + chain) * B + usize::from(node > 1);
    let chains = [0, 1].map(|chain| (0..4).map(|node| map(start(node, chain))).collect());
    (chains.to_vec(), 8 * B + 1)
}

/// Matrices like those of a line: couplings of neighbours, the same in all components for damping and mass, a tie between
/// the chains, one component that differs, and the further coordinate.
fn force<const B: usize>(chains: &[Vec<NodeMap>], size: usize) -> LinearForce {
    let mut numbers = Numbers(7);
    let mut entries = [Vec::new(), Vec::new(), Vec::new()];
    for chain in chains {
        for pair in chain.windows(2) {
            let at: Vec<u32> = pair.iter().flat_map(|node| node.indices()).map(|i| i as u32).collect();
            for &row in &at {
                for &column in &at {
                    entries[0].push((row, column, numbers.next()));
                }
            }
            for entries in &mut entries[1..] {
                for i in 0..4 {
                    for j in 0..4 {
                        let value = numbers.next();
                        let half = B / 2;
                        entries.extend((0..half).map(|c| (at[i * half + c], at[j * half + c], value)));
                    }
                }
            }
        }
    }
    let further = 4 * B as u32;
    for entries in &mut entries {
        entries.extend([
            (1, B as u32 + 1, numbers.next()),
            (0, 0, numbers.next()),
            (further, further, numbers.next()),
            (further, 3, numbers.next()),
            (3, further, numbers.next()),
        ]);
    }
    let [k, d, m] = entries.map(|entries| SparseMatrix::from_entries(size, entries));
    LinearForce::new((0..size).map(|_| numbers.next()).collect(), k, d, m)
}

fn arranged_products_are_those_of_the_matrices<const B: usize>(map: fn(usize) -> NodeMap) {
    let (chains, size) = chains::<B>(map);
    let plain = force::<B>(&chains, size);
    let arranged = plain.clone().with_chains(&chains);
    assert!(!matches!(arranged.rows, NodeRows::None));
    for rest in &arranged.rest {
        assert!((1..=8).contains(&rest.rows.len()), "few rows are left: {:?}", rest.rows);
    }
    let mut numbers = Numbers(11);
    let mut state = State::at_rest(size, 0, Vec::new());
    for vector in [&mut state.q, &mut state.v, &mut state.v_dot] {
        vector.iter_mut().for_each(|x| *x = numbers.next());
    }
    let motion = state.motion(&[]);
    let product = |mut force: LinearForce, range: Option<Range<usize>>| {
        let mut result = vec![0.0; size];
        match range {
            Some(range) => force.add_dynamic_force_within(range, &motion, &state.v_dot, &mut result),
            None => force.add_dynamic_force(&motion, &state.v_dot, &mut result),
        }
        result
    };
    let whole = product(plain.clone(), None);
    for (i, (a, b)) in product(arranged.clone(), None).iter().zip(&whole).enumerate() {
        assert!((a - b).abs() < 1e-13 * size as f64, "{i}: {a} {b}");
    }
    for range in [0..1, B - 1..2 * B + 1, 4 * B..4 * B + 1, 5 * B..size] {
        let part = product(arranged.clone(), Some(range.clone()));
        for i in range {
            assert!((part[i] - whole[i]).abs() < 1e-13 * size as f64, "{i}");
        }
    }
    let mut expected = plain.load().to_vec();
    let mut force = vec![0.0; size];
    for (matrix, vector) in [(plain.stiffness(), &state.q), (plain.damping(), &state.v)] {
        for (row, expected) in expected.iter_mut().enumerate() {
            *expected -= matrix
                .row(row)
                .map(|(column, value)| value * vector[column])
                .sum::<f64>();
        }
    }
    arranged.clone().add_force(&motion, &mut force);
    for (a, b) in force.iter().zip(&expected) {
        assert!((a - b).abs() < 1e-13 * size as f64, "{a} {b}");
    }
}

#[test]
fn products_along_planar_wires_are_those_of_the_matrices() {
    arranged_products_are_those_of_the_matrices::<4>(NodeMap::planar);
}

#[test]
fn products_along_spatial_wires_are_those_of_the_matrices() {
    arranged_products_are_those_of_the_matrices::<6>(NodeMap::spatial);
}

#[test]
fn nodes_of_scattered_coordinates_are_multiplied_entry_by_entry() {
    let size = 8;
    let scattered = |first: usize| {
        NodeMap::new([
            Some(first),
            None,
            Some(first + 2),
            Some(first + 4),
            None,
            Some(first + 6),
        ])
    };
    let one = || SparseMatrix::from_entries(size, (0..8).map(|i| (i, i, 2.0)).collect());
    let chains = [vec![scattered(0), scattered(1)]];
    let mut force = LinearForce::new(vec![0.0; size], one(), one(), one()).with_chains(&chains);
    assert!(matches!(force.rows, NodeRows::None));
    let mut state = State::at_rest(size, 0, Vec::new());
    state.q[3] = 1.0;
    let mut result = vec![0.0; size];
    force.add_force(&state.motion(&[]), &mut result);
    assert_eq!(result, [0.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0]);
}
