//! Designs: which combinations of values are cases.
//!
//! | file | subject |
//! | --- | --- |
//! | `mod` | [`Design`]: all combinations, or samples of a method and a seed |
//! | `sobol` | Sobol sequence |

mod sobol;

use dynamics::SplitMix64;
use serde::{Deserialize, Serialize};

pub use sobol::{MOST_DIMENSIONS, Sobol};

/// Way in which samples are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Latin hypercube: each key has one sample in each of as many equally likely parts as there are samples.
    Latin,
    /// Sobol sequence with a shift of its digits by the seed; without shift for seed 0.
    Sobol,
    /// Independent samples.
    Random,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Latin, Self::Sobol, Self::Random];

    /// The word of the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Latin => "latin",
            Self::Sobol => "sobol",
            Self::Random => "random",
        }
    }
}

/// Samples of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Method.
    pub method: Method,
    /// Number of samples.
    pub count: u64,
    /// Seed: the same seed gives the same samples everywhere.
    pub seed: u64,
}

/// Choice of combinations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Design {
    /// All combinations of listed values, the last key changing first.
    Factorial,
    /// The first listed value of every key, then each further value of one key beside the first ones of all others.
    OneAtATime,
    /// The first listed value of every key, then the second one of every key, and so on: the rows of a table.
    Rows,
    /// Samples.
    Sample(Sample),
}

/// Most samples of one sweep.
pub const MOST_SAMPLES: u64 = 10_000_000;

/// Points of samples in the unit cube, in order, each coordinate inside 0 to 1.
pub struct UnitPoints {
    sample: Sample,
    dimensions: usize,
    next: u64,
    /// Order of the parts of each key; latin only.
    parts: Vec<Vec<u32>>,
    sobol: Option<Sobol>,
}

impl UnitPoints {
    /// The first point is next.
    #[must_use]
    pub fn new(sample: Sample, dimensions: usize) -> Self {
        let is = |method| sample.method == method;
        let part = |dimension| shuffled(sample.count, SplitMix64::stream(sample.seed, dimension as u64));
        Self {
            parts: if is(Method::Latin) {
                (0..dimensions).map(part).collect()
            } else {
                Vec::new()
            },
            sobol: is(Method::Sobol).then(|| Sobol::shifted(dimensions, sample.seed)),
            sample,
            dimensions,
            next: 0,
        }
    }
}

/// Numbers from 0 to `count` in an order of chance [Durstenfeld, Algorithm 235, CACM 7 (1964)].
fn shuffled(count: u64, mut random: SplitMix64) -> Vec<u32> {
    let mut order: Vec<u32> = (0..count.min(MOST_SAMPLES) as u32).collect();
    for last in (1..order.len()).rev() {
        let other = (random.unit() * (last + 1) as f64) as usize;
        order.swap(last, other.min(last));
    }
    order
}

impl Iterator for UnitPoints {
    type Item = Vec<f64>;

    fn next(&mut self) -> Option<Vec<f64>> {
        if self.next >= self.sample.count {
            return None;
        }
        let n = self.next;
        self.next += 1;
        if let Some(sobol) = &mut self.sobol {
            return sobol.next();
        }
        // A stream of its own for each point: independent of the number of keys before it.
        let mut random = SplitMix64::stream(!self.sample.seed, n);
        let mut unit = || (random.unit() + f64::EPSILON / 4.0).min(1.0 - f64::EPSILON / 2.0);
        let count = self.sample.count as f64;
        Some(match self.sample.method {
            Method::Latin => self
                .parts
                .iter()
                .map(|parts| (f64::from(parts[n as usize]) + unit()) / count)
                .collect(),
            _ => (0..self.dimensions).map(|_| unit()).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(method: Method, count: u64, seed: u64) -> Vec<Vec<f64>> {
        UnitPoints::new(Sample { method, count, seed }, 3).collect()
    }

    #[test]
    fn a_latin_hypercube_has_one_sample_in_each_part_of_each_key() {
        for count in [1, 2, 17, 100] {
            let points = points(Method::Latin, count, 5);
            for key in 0..3 {
                let mut parts: Vec<u64> = points.iter().map(|point| (point[key] * count as f64) as u64).collect();
                parts.sort_unstable();
                assert_eq!(parts, (0..count).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn samples_lie_inside_and_are_those_of_their_seed() {
        for method in Method::ALL {
            let first = points(method, 257, 3);
            assert_eq!(first.len(), 257);
            assert!(first.iter().flatten().all(|u| *u > 0.0 && *u < 1.0), "{method:?}");
            assert_eq!(first, points(method, 257, 3));
            assert_ne!(first, points(method, 257, 4));
        }
        // Longer sequences begin with shorter ones, where samples do not depend on their number.
        for method in [Method::Sobol, Method::Random] {
            assert_eq!(points(method, 20, 9)[..8], points(method, 8, 9)[..]);
        }
    }
}
