use super::*;

/// String of `n` inner points under tension: `K = tridiag(−1, 2, −1)`, `M = 1`.
fn chain(n: usize, parts: usize) -> (BandedMatrix, BandedMatrix) {
    let mut stiffness = Vec::new();
    let mut mass = Vec::new();
    for part in 0..parts {
        for i in 0..n {
            let row = (part * n + i) as u32;
            stiffness.push((row, row, 2.0));
            if i > 0 {
                stiffness.push((row, row - 1, -1.0));
            }
            mass.push((row, row, 1.0));
        }
    }
    let size = n * parts;
    (
        BandedMatrix::from_entries(size, 0, &stiffness),
        BandedMatrix::from_entries(size, 1, &mass),
    )
}

fn expected(n: usize, k: usize) -> f64 {
    let half = std::f64::consts::PI * k as f64 / (2.0 * (n + 1) as f64);
    4.0 * half.sin().powi(2)
}

#[test]
fn eigenvalues_of_a_chain_are_those_of_the_closed_form() {
    let n = 300;
    let (stiffness, mass) = chain(n, 1);
    let found = eigenpairs_below(&stiffness, &mass, 2.0).unwrap();
    let count = (1..=n).filter(|&k| expected(n, k) <= 2.0).count();
    assert_eq!(found.values.len(), count);
    let stiffness = SparseMatrix::from(&stiffness);
    for (k, (value, vector)) in found.values.iter().zip(&found.vectors).enumerate() {
        assert!((value / expected(n, k + 1) - 1.0).abs() < 1e-10, "{k}: {value}");
        let product = stiffness.multiply_columns(vector);
        let left = product
            .iter()
            .zip(vector)
            .map(|(a, v)| (a - value * v).powi(2))
            .sum::<f64>();
        assert!(left.sqrt() < 1e-8, "{k}: {left}");
    }
    let across: f64 = found.vectors[3]
        .iter()
        .zip(&found.vectors[90])
        .map(|(a, b)| a * b)
        .sum();
    assert!(
        across.abs() < 1e-9,
        "vectors of different slices are orthogonal: {across}"
    );
}

#[test]
fn equal_parts_have_every_eigenvalue_as_often_as_there_are_parts() {
    let (n, parts) = (60, 3);
    let (stiffness, mass) = chain(n, parts);
    let found = eigenpairs_below(&stiffness, &mass, 4.0).unwrap();
    assert_eq!(found.values.len(), n * parts);
    for (k, value) in found.values.iter().enumerate() {
        let expected = expected(n, k / parts + 1);
        assert!((value / expected - 1.0).abs() < 1e-9, "{k}: {value} and {expected}");
    }
    let same: f64 = found.vectors[0].iter().zip(&found.vectors[1]).map(|(a, b)| a * b).sum();
    assert!(same.abs() < 1e-9, "vectors of one eigenvalue are orthogonal: {same}");
}

#[test]
fn a_mass_that_is_not_positive_is_refused() {
    let (stiffness, _) = chain(3, 1);
    let mass = BandedMatrix::from_entries(3, 1, &[(0, 0, 1.0), (1, 1, -1.0), (2, 2, 1.0)]);
    let error = eigenpairs_below(&stiffness, &mass, 1.0).unwrap_err();
    assert_eq!(error, EigenError::Mass { negative: 1 });
}
