//! Ends of droppers among the coordinates.
use super::Dropper;
use super::lanes::{Array, LANES};
use crate::Attachment;
use dynamics::simd::Transpose;
use pulp::Simd;

/// Positions of the coordinates of the upper and lower ends of some droppers among those of the system.
#[derive(Clone, Debug)]
pub(super) enum Ends {
    /// First coordinate of each end, whose coordinates are consecutive. A lane without a dropper repeats one end.
    Runs([[u32; LANES]; 2]),
    /// Coordinates by axis; `usize::MAX` marks a missing one, because no vector is as long.
    Anywhere(Box<[[[usize; LANES]; 3]; 2]>),
}

impl Ends {
    /// Ends of up to [`LANES`] droppers; no end moves along other axes than `axes`.
    pub fn new(droppers: &[Dropper], axes: &[usize]) -> Self {
        let run = |end: &Attachment| {
            let first = u32::try_from(end.coordinate(axes[0])?).ok()?;
            let coordinates = axes.iter().map(|&axis| end.coordinate(axis));
            coordinates
                .eq((first as usize..).take(axes.len()).map(Some))
                .then_some(first)
        };
        let runs = droppers
            .iter()
            .map(|dropper| Some([run(&dropper.upper)?, run(&dropper.lower)?]));
        if let Some(runs) = runs.collect::<Option<Vec<_>>>() {
            let side =
                |side: usize| std::array::from_fn(|lane| runs.get(lane).map_or(runs[0][0], |starts| starts[side]));
            return Self::Runs([side(0), side(1)]);
        }
        let place = |lane: usize, end: fn(&Dropper) -> &Attachment, axis: usize| {
            let coordinate = droppers.get(lane).and_then(|dropper| end(dropper).coordinate(axis));
            coordinate.unwrap_or(usize::MAX)
        };
        let side = |end| std::array::from_fn(|axis| std::array::from_fn(|lane| place(lane, end, axis)));
        Self::Anywhere(Box::new([
            side(|dropper| &dropper.upper),
            side(|dropper| &dropper.lower),
        ]))
    }

    /// Differences of the entries of `values` at the upper ends from those at the lower ends.
    #[inline(always)]
    pub fn differences<S: Simd, const D: usize>(
        &self,
        transpose: Transpose<S>,
        axes: &[usize; D],
        values: &[f64],
    ) -> [Array; D] {
        match self {
            Self::Runs([upper, lower]) if D == 2 => {
                let found = transpose.differences::<2, 2>([upper, lower], values);
                std::array::from_fn(|k| found[k])
            }
            Self::Runs([upper, lower]) => {
                let found = transpose.differences::<3, 4>([upper, lower], values);
                std::array::from_fn(|k| found[k])
            }
            Self::Anywhere(places) => axes.map(|axis| {
                let [upper, lower] = &**places;
                let at = |index: usize| values.get(index).copied().unwrap_or(0.0);
                std::array::from_fn(|lane| at(upper[axis][lane]) - at(lower[axis][lane]))
            }),
        }
    }

    /// Subtracts the lanes from the entries of `values` at the upper ends and adds them to those at the lower ends.
    #[inline(always)]
    pub fn transfer<S: Simd, const D: usize>(
        &self,
        transpose: Transpose<S>,
        axes: &[usize; D],
        lanes: &[Array; D],
        values: &mut [f64],
    ) {
        let columns = |k: usize| lanes.get(k).copied().unwrap_or_default();
        match self {
            Self::Runs([upper, lower]) if D == 2 => {
                transpose.transfer::<2, 2>(std::array::from_fn(columns), [upper, lower], values);
            }
            Self::Runs([upper, lower]) => {
                transpose.transfer::<3, 4>(std::array::from_fn(columns), [upper, lower], values);
            }
            Self::Anywhere(places) => {
                let [upper, lower] = &**places;
                for (&axis, lanes) in axes.iter().zip(lanes) {
                    for lane in 0..LANES {
                        if let Some(value) = values.get_mut(upper[axis][lane]) {
                            *value -= lanes[lane];
                        }
                        if let Some(value) = values.get_mut(lower[axis][lane]) {
                            *value += lanes[lane];
                        }
                    }
                }
            }
        }
    }
}
