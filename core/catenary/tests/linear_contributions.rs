//! Matrices of contributions: the same in one pass as apart; a contribution that is declared linear changes by exactly
//! these.
use catenary::{scene_line, static_line};
use dynamics::{Blocks, Force, Layout, Motion, SparseMatrix, Weights};

const SCENE: &str = include_str!("../../../scenes/en50318-300.toml");

/// Numbers in -1…1 that repeat in every run.
fn noise(n: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1 << 30) - 1.0
    };
    (0..n).map(|_| next()).collect()
}

/// The matrix that `add` puts into blocks; it is called twice.
fn matrix(size: usize, add: impl FnMut(&mut Blocks<'_>)) -> SparseMatrix {
    SparseMatrix::from_entries(size, Blocks::collect(add))
}

/// The weighed sum of tangent and mass is what a contribution adds in one pass.
fn check_sum(force: &mut dyn Force, n: usize, motion: &Motion<'_>) {
    let (weights, mass_weight) = (Weights { q: 0.7, v: 300.0 }, 2e4);
    let tangent = matrix(n, |blocks| force.add_tangent(motion, weights, blocks));
    let mass = matrix(n, |blocks| force.add_mass(blocks));
    let Some(force) = force.one_pass() else {
        return;
    };
    let both = matrix(n, |blocks| {
        force.add_dynamic_tangent(motion, weights, mass_weight, blocks)
    });
    let x = noise(n, 4);
    for row in 0..n {
        let expected = tangent.row_product(row, &x) + mass_weight * mass.row_product(row, &x);
        let size = |matrix: &SparseMatrix| matrix.row(row).map(|(_, value)| value.abs()).sum::<f64>();
        let scale = size(&tangent) + mass_weight * size(&mass);
        let error = (both.row_product(row, &x) - expected).abs();
        assert!(error <= 1e-13 * scale, "{row}: {error:e} of {scale:e}");
    }
}

/// Checks the contributions of a line that call themselves linear, and counts them.
fn check(overrides: &[&str]) -> usize {
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    let scene = catenary::load(SCENE, "en50318-300.toml", &overrides).expect("the shipped scene is good");
    let statics = static_line(&scene).expect("the shipped line has an equilibrium");
    let mut layout = Layout::new();
    let mut line = scene_line(&scene, &statics, &mut layout).expect("the reductions are possible");
    let n = layout.coordinates();
    let [q, v, a] = [(1e-3, 1), (0.1, 2), (10.0, 3)]
        .map(|(size, seed)| noise(n, seed).iter().map(|x| size * x).collect::<Vec<f64>>());
    let zeros = vec![0.0; n];
    let [moved, rest] = [(&q, &v), (&zeros, &zeros)].map(|(q, v)| Motion {
        t: 0.0,
        q,
        v,
        rotation: &[],
        u: &[],
    });
    let mut checked = 0;
    line.forces(&mut |force| {
        check_sum(force, n, &moved);
        let Some(force) = force.one_pass().and_then(|one_pass| one_pass.by_range()) else {
            return;
        };
        if !force.is_linear() {
            return;
        }
        checked += 1;
        let mut change = vec![0.0; n];
        force.add_dynamic_force(&rest, &zeros, &mut change);
        change.iter_mut().for_each(|value| *value = -*value);
        force.add_dynamic_force(&moved, &a, &mut change);
        let mut tangent = |weights| matrix(n, |blocks| force.add_tangent(&moved, weights, blocks));
        let stiffness = tangent(Weights { q: 1.0, v: 0.0 });
        let damping = tangent(Weights { q: 0.0, v: 1.0 });
        let mass = matrix(n, |blocks| force.add_mass(blocks));
        // Sums of absolute values: what rounding is relative to.
        let mut largest = 0.0_f64;
        for (row, change) in change.iter_mut().enumerate() {
            for (matrix, x) in [(&stiffness, &q), (&damping, &v), (&mass, &a)] {
                for (column, value) in matrix.row(row) {
                    *change += value * x[column];
                    largest = largest.max((value * x[column]).abs());
                }
            }
        }
        assert!(largest > 1.0, "there is something to compare");
        for (row, left) in change.iter().enumerate() {
            // Some hundred terms, each rounded to 1e-16 of the largest.
            assert!(left.abs() < 1e-13 * largest, "{row}: {left:e} N of {largest:e} N");
        }
    });
    checked
}

#[test]
fn contributions_that_call_themselves_linear_change_by_their_tangent() {
    // Two wires and their attachments; the window adds the spans beyond it, with damping where they end.
    assert_eq!(check(&[r#"model.reduce=["planar","linearised"]"#]), 3);
    assert_eq!(check(&[r#"model.reduce=["planar","linearised","window"]"#]), 4);
    assert_eq!(
        check(&[
            r#"model.reduce=["linearised","window"]"#,
            "catenary.mesh.elements_per_interval=2"
        ]),
        4
    );
    let long = ["catenary.spans=60", "catenary.mesh.elements_per_interval=2"];
    assert_eq!(check(&[r#"model.reduce=["planar","window"]"#, long[0], long[1]]), 1);
}
