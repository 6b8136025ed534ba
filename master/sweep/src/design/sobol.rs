//! Sobol sequence with the direction numbers of Joe and Kuo.
//!
//! `[JoeKuo]` S. Joe, F. Y. Kuo, *Constructing Sobol sequences with better two-dimensional projections*, SIAM J. Sci.
//! Comput. 30 (2008) 2635–2654. The table is the head of their file `new-joe-kuo-6.21201` (BSD licence): dimension d,
//! degree s and coefficients a of its primitive polynomial, initial numbers m. Crates for it are given up, or limited
//! to single precision and 2¹⁶ points.

use dynamics::SplitMix64;

/// Direction numbers.
const TABLE: &str = include_str!("joe-kuo-6.64.txt");

/// Dimensions that the table has.
pub const MOST_DIMENSIONS: usize = 64;

/// Bits of a coordinate.
const BITS: usize = 32;

/// Points of the sequence in order.
pub struct Sobol {
    /// Direction numbers v of each dimension.
    directions: Vec<[u32; BITS]>,
    shifts: Vec<u32>,
    point: Vec<u32>,
    next: u32,
}

impl Sobol {
    /// The sequence as published, in at most [`MOST_DIMENSIONS`] dimensions.
    ///
    /// # Panics
    /// More dimensions than the table has.
    #[must_use]
    pub fn new(dimensions: usize) -> Self {
        let first: [u32; BITS] = std::array::from_fn(|bit| 1 << (BITS - 1 - bit));
        let rows = TABLE.lines().skip(1).map(directions);
        let directions: Vec<_> = std::iter::once(first).chain(rows).take(dimensions).collect();
        assert_eq!(directions.len(), dimensions, "the table has too few dimensions");
        Self {
            directions,
            shifts: vec![0; dimensions],
            point: vec![0; dimensions],
            next: 0,
        }
    }

    /// The sequence with the digits of each dimension shifted by numbers of the seed, which keeps its evenness; as
    /// published for seed 0.
    ///
    /// # Panics
    /// See [`Sobol::new`].
    #[must_use]
    pub fn shifted(dimensions: usize, seed: u64) -> Self {
        let mut sobol = Self::new(dimensions);
        if seed != 0 {
            let mut random = SplitMix64::new(seed);
            sobol.shifts.fill_with(|| (random.next() >> 32) as u32);
        }
        sobol
    }

    /// Digits of the next point.
    fn digits(&mut self) -> Option<Vec<u32>> {
        if self.next == u32::MAX {
            return None;
        }
        if self.next > 0 {
            // Gray code order [JoeKuo, Eq. (2)]: one direction number per point.
            let bit = (self.next - 1).trailing_ones() as usize;
            for (digits, directions) in self.point.iter_mut().zip(&self.directions) {
                *digits ^= directions[bit];
            }
        }
        self.next += 1;
        Some(
            self.point
                .iter()
                .zip(&self.shifts)
                .map(|(digits, shift)| digits ^ shift)
                .collect(),
        )
    }
}

impl Iterator for Sobol {
    type Item = Vec<f64>;

    /// The next point, each coordinate in the middle of its cell of 2⁻³², so that none is 0.
    fn next(&mut self) -> Option<Vec<f64>> {
        let cell = |digits: u32| (f64::from(digits) + 0.5) / (1_u64 << BITS) as f64;
        Some(self.digits()?.into_iter().map(cell).collect())
    }
}

/// Direction numbers of a row of the table [JoeKuo, Eq. (1)], scaled by 2³².
fn directions(row: &str) -> [u32; BITS] {
    let mut numbers = row
        .split_whitespace()
        .skip(1)
        .map(|word| word.parse::<u32>().expect("a number of the table"));
    let (s, a) = (numbers.next().unwrap_or(0) as usize, numbers.next().unwrap_or(0));
    let mut v = [0; BITS];
    for (bit, m) in numbers.enumerate() {
        v[bit] = m << (BITS - 1 - bit);
    }
    for bit in s..BITS {
        v[bit] = v[bit - s] ^ (v[bit - s] >> s);
        for k in 1..s {
            v[bit] ^= ((a >> (s - 1 - k)) & 1) * v[bit - k];
        }
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points without the half cell.
    fn points(dimensions: usize, count: usize) -> Vec<Vec<f64>> {
        let mut sobol = Sobol::new(dimensions);
        let scale = (1_u64 << BITS) as f64;
        let point = |digits: Vec<u32>| digits.into_iter().map(|digits| f64::from(digits) / scale).collect();
        (0..count).map(|_| sobol.digits().map(point).unwrap()).collect()
    }

    #[test]
    fn the_first_points_are_the_published_ones() {
        // Output of the authors' program sobol.cc for 10 points in 3 dimensions, as printed on their page.
        let published = [
            [0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25],
            [0.25, 0.75, 0.75],
            [0.375, 0.375, 0.625],
            [0.875, 0.875, 0.125],
            [0.625, 0.125, 0.875],
            [0.125, 0.625, 0.375],
            [0.1875, 0.3125, 0.9375],
            [0.6875, 0.8125, 0.4375],
        ];
        assert_eq!(points(3, 10), published);
    }

    #[test]
    fn every_dimension_is_stratified_by_powers_of_two() {
        let points = points(MOST_DIMENSIONS, 256);
        for dimension in 0..MOST_DIMENSIONS {
            let mut cells: Vec<u32> = points.iter().map(|point| (point[dimension] * 256.0) as u32).collect();
            cells.sort_unstable();
            assert_eq!(cells, (0..256).collect::<Vec<_>>(), "dimension {dimension}");
        }
    }
}
