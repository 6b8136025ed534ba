//! Worn area along a wire.

use serde::{Deserialize, Serialize};

/// Mean area lost in cells of equal length, m²; cell `i` begins at `from + i · cell`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// Begin of the first cell, m.
    pub from: f64,
    /// Length of a cell, m.
    pub cell: f64,
    /// Area of each cell, m².
    pub area: Vec<f64>,
}

impl Profile {
    /// Unworn profile from `from` to `to` (m) in equal cells of at most `longest` m.
    #[must_use]
    pub fn new(from: f64, to: f64, longest: f64) -> Self {
        let cells = ((to - from) / longest - 1e-9).ceil().max(1.0);
        Self {
            from,
            cell: (to - from) / cells,
            area: vec![0.0; cells as usize],
        }
    }

    /// End of the last cell, m.
    #[must_use]
    pub fn to(&self) -> f64 {
        self.from + self.cell * self.area.len() as f64
    }

    /// Middle of cell `index`, m.
    #[must_use]
    pub fn x(&self, index: usize) -> f64 {
        self.from + self.cell * (index as f64 + 0.5)
    }

    /// Lost volume, m³.
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.cell * self.area.iter().sum::<f64>()
    }

    /// Mean area, m².
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.area.iter().sum::<f64>() / self.area.len().max(1) as f64
    }

    /// Place (m) and value of the largest area, m².
    #[must_use]
    pub fn largest(&self) -> (f64, f64) {
        let all = self.area.iter().copied().enumerate();
        let (index, area) = all.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default();
        (self.x(index), area)
    }

    /// Takes `volume` (m³) evenly away between two places (m), `a < b`; the part beyond the ends is left out, and all
    /// of it where the places are no such numbers.
    pub fn deposit(&mut self, (a, b): (f64, f64), volume: f64) {
        if !(b > a && b - a < f64::INFINITY) {
            return;
        }
        let density = volume / (b - a);
        let last = self.area.len() as f64;
        let begin = ((a - self.from) / self.cell).floor().clamp(0.0, last) as usize;
        let end = ((b - self.from) / self.cell).ceil().clamp(0.0, last) as usize;
        for index in begin..end {
            let left = self.from + self.cell * index as f64;
            let overlap = (b.min(left + self.cell) - a.max(left)).max(0.0);
            self.area[index] += density * overlap / self.cell;
        }
    }

    /// [`Profile::deposit`] on a profile that repeats itself: the volume is kept.
    pub fn deposit_periodic(&mut self, (mut a, b): (f64, f64), volume: f64) {
        if !(b > a && b - a < f64::INFINITY) {
            return;
        }
        let (length, density) = (self.to() - self.from, volume / (b - a));
        let mut turn = ((a - self.from) / length).floor();
        loop {
            let end = b.min(self.from + (turn + 1.0) * length);
            if end > a {
                self.deposit((a - turn * length, end - turn * length), density * (end - a));
            }
            if end >= b {
                break;
            }
            (a, turn) = (end.max(a), turn + 1.0);
        }
    }

    /// The mean over `length` (m) around each cell; the volume is kept, by mirrors at the ends or, where the profile
    /// repeats itself, by its other end.
    #[must_use]
    pub fn averaged(&self, length: f64, periodic: bool) -> Self {
        let cells = self.area.len() as i64;
        let half = ((0.5 * length / self.cell).floor() as i64).min((cells - 1) / 2);
        let mut area = vec![0.0; self.area.len()];
        let share = 1.0 / (2 * half + 1) as f64;
        for (index, own) in (0..cells).zip(&self.area) {
            for place in index - half..=index + half {
                let target = if periodic {
                    place.rem_euclid(cells)
                } else if place < 0 {
                    -1 - place
                } else if place >= cells {
                    2 * cells - 1 - place
                } else {
                    place
                };
                area[target as usize] += share * own;
            }
        }
        Self {
            area,
            from: self.from,
            cell: self.cell,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deposits_and_means_keep_the_volume() {
        for periodic in [true, false] {
            let mut profile = Profile::new(3.0, 13.0, 0.3);
            assert_eq!(profile.area.len(), 34);
            let mut given = 0.0;
            for (place, length, volume) in [(3.1, 0.01, 1.0), (4.0, 2.7, 2.0), (12.5, 0.45, 4.0)] {
                given += volume;
                match periodic {
                    true => profile.deposit_periodic((place - 20.0, place - 20.0 + length), volume),
                    false => profile.deposit((place, place + length), volume),
                }
            }
            if periodic {
                // Over the end, and longer than the profile.
                profile.deposit_periodic((12.9, 13.2), 8.0);
                profile.deposit_periodic((1.0, 29.0), 16.0);
                given += 24.0;
            }
            assert!((profile.volume() / given - 1.0).abs() < 1e-14);
            for length in [0.1, 0.9, 5.0, 100.0] {
                let mean = profile.averaged(length, periodic);
                assert!((mean.volume() / given - 1.0).abs() < 1e-14, "{length} {periodic}");
                let unevenness = |profile: &Profile| profile.largest().1 / profile.mean();
                assert!(unevenness(&mean) <= unevenness(&profile) + 1e-12);
            }
        }
    }

    #[test]
    fn an_even_deposit_in_pieces_is_even() {
        let mut profile = Profile::new(0.0, 60.0, 0.1);
        let step = 0.0694;
        let mut x = 0.0;
        while x < 120.0 {
            let end = f64::min(x + step, 120.0);
            profile.deposit_periodic((x, end), 3e-6 * (end - x));
            x = end;
        }
        let even = profile.averaged(0.5, true);
        for area in profile.area.iter().chain(&even.area) {
            assert!((area / 6e-6 - 1.0).abs() < 1e-10, "{area}");
        }
    }

    #[test]
    fn a_place_that_is_no_number_wears_nothing() {
        let mut profile = Profile::new(0.0, 1.0, 0.1);
        profile.deposit_periodic((f64::NAN, 1.0), 1.0);
        profile.deposit_periodic((0.0, f64::NAN), 1.0);
        profile.deposit_periodic((0.0, f64::INFINITY), 1.0);
        profile.deposit((f64::NAN, f64::NAN), 1.0);
        assert_eq!(profile.volume(), 0.0);
    }
}
