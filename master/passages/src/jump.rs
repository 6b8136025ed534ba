//! Passages that change a profile little.

use wear::{Profile, RoundSection};

/// A worn profile and the area that each further passage takes away.
#[derive(Clone, Copy, Debug)]
pub struct Worn<'a> {
    /// Section of the wire.
    pub section: RoundSection,
    /// Lost area, m².
    pub lost: &'a Profile,
    /// Area lost by one passage, m².
    pub by_passage: &'a Profile,
}

impl Worn<'_> {
    /// Largest change of the unevenness of the depth by so many passages, m: the wear of the mean lifts the strip
    /// alone.
    #[must_use]
    pub fn unevenness(&self, passages: u64) -> f64 {
        let cells = self.lost.area.iter().zip(&self.by_passage.area);
        let changes = cells.map(|(lost, rate)| {
            let after = self.section.depth(lost + passages as f64 * rate);
            after - self.section.depth(*lost)
        });
        let changes: Vec<f64> = changes.collect();
        let mean = changes.iter().sum::<f64>() / changes.len().max(1) as f64;
        changes.iter().map(|change| (change - mean).abs()).fold(0.0, f64::max)
    }

    /// Passages until a cell has lost `limit` (m²); `None` where none ever does.
    #[must_use]
    pub fn passages_to(&self, limit: f64) -> Option<f64> {
        let cells = self.lost.area.iter().zip(&self.by_passage.area);
        let left = cells.filter(|(_, rate)| **rate > 0.0);
        left.map(|(lost, rate)| ((limit - lost) / rate).max(0.0))
            .reduce(f64::min)
    }
}

/// Passages, at least one and at most `most`, that change the unevenness of the depth by at most `step` (m).
#[must_use]
pub fn passages_within(worn: &Worn<'_>, step: f64, most: u64) -> u64 {
    if most <= 1 || worn.unevenness(most) <= step {
        return most.max(1);
    }
    let (mut few, mut many) = (1, most);
    while many - few > 1 {
        let middle = few + (many - few) / 2;
        match worn.unevenness(middle) <= step {
            true => few = middle,
            false => many = middle,
        }
    }
    few
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_ends_where_the_unevenness_has_changed_by_its_step() {
        let section = RoundSection { diameter: 0.012 };
        let lost = Profile {
            from: 0.0,
            cell: 1.0,
            area: vec![section.lost(1e-3); 4],
        };
        let mut by_passage = lost.clone();
        by_passage.area = vec![1e-11, 2e-11, 1e-11, 2e-11];
        let worn = Worn {
            section,
            lost: &lost,
            by_passage: &by_passage,
        };
        let width = section.width(1e-3);
        let expected = 1e-6 * width / 0.5e-11;
        let found = passages_within(&worn, 1e-6, 100_000) as f64;
        // The flat grows wider by some thousandth on the way.
        assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
        assert_eq!(passages_within(&worn, 1e-6, 10), 10);
        assert_eq!(passages_within(&worn, 0.0, 10), 1);
        let limit = section.lost(1e-3) + 4e-9;
        assert!((worn.passages_to(limit).unwrap() - 200.0).abs() < 1e-6);
        by_passage.area.fill(0.0);
        let still = Worn {
            section,
            lost: &lost,
            by_passage: &by_passage,
        };
        assert_eq!(still.passages_to(limit), None);
        assert_eq!(passages_within(&still, 1e-9, 1_000_000), 1_000_000);
    }
}
