//! Curves in whole units.

use std::fmt::Write as _;

/// Corners of a curve in whole units, in the order of their first coordinate: points that lie within `tolerance`
/// (units) of the straight line between the corners are left out.
pub(super) fn corners(points: impl IntoIterator<Item = (f64, f64)>, tolerance: f64) -> Vec<(i64, i64)> {
    let mut found: Vec<(f64, f64)> = Vec::new();
    // The last point that can be reached, and the slopes that pass all points since the last corner.
    let mut reached: Option<(f64, f64)> = None;
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for (x, y) in points {
        let Some(&(x0, y0)) = found.last() else {
            found.push((x, y));
            continue;
        };
        let slope = (y - y0) / (x - x0);
        match reached {
            Some(corner) if x <= corner.0 => continue,
            Some(corner) if !(low..=high).contains(&slope) => {
                found.push(corner);
                (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
            }
            _ => {}
        }
        let &(x0, y0) = found.last().expect("the first point is a corner");
        if x > x0 {
            low = low.max((y - tolerance - y0) / (x - x0));
            high = high.min((y + tolerance - y0) / (x - x0));
            reached = Some((x, y));
        }
    }
    found.extend(reached);
    found
        .iter()
        .map(|(x, y)| (x.round() as i64, y.round() as i64))
        .collect()
}

/// Corners as the data of an SVG path, from the first on relative to the one before; empty for fewer than two.
pub(super) fn path(corners: &[(i64, i64)]) -> String {
    let [first, rest @ ..] = corners else {
        return String::new();
    };
    if rest.is_empty() {
        return String::new();
    }
    let mut data = format!("M{} {}l", first.0, first.1);
    let mut last = *first;
    for (number, corner) in rest.iter().enumerate() {
        let (x, y) = (corner.0 - last.0, corner.1 - last.1);
        let before = if number == 0 { "" } else { " " };
        let between = if y < 0 { "" } else { " " };
        let _ = write!(data, "{before}{x}{between}{y}");
        last = *corner;
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_a_line_are_left_out_and_others_are_kept_to_the_tolerance() {
        let line = (0..=10).map(|i| (f64::from(i), 2.0 * f64::from(i)));
        assert_eq!(corners(line, 0.1), [(0, 0), (10, 20)]);
        let bent = |x: f64| if x < 50.0 { 0.0 } else { x - 50.0 };
        let points: Vec<(f64, f64)> = (0..=100).map(|i| (f64::from(i), bent(f64::from(i)))).collect();
        assert_eq!(corners(points, 0.1), [(0, 0), (50, 0), (100, 50)]);
        let arc = |x: f64| 100.0 * (x / 100.0).sin();
        let points: Vec<(f64, f64)> = (0..=300).map(|i| (f64::from(i), arc(f64::from(i)))).collect();
        let found = corners(points.clone(), 1.0);
        assert!(found.len() < 20, "{}", found.len());
        for (x, y) in points {
            let pair = found.windows(2).find(|pair| x <= pair[1].0 as f64).unwrap();
            let [(x0, y0), (x1, y1)] = [pair[0], pair[1]].map(|(x, y)| (x as f64, y as f64));
            // The tolerance and the rounding of both ends.
            assert!((y0 + (y1 - y0) * (x - x0) / (x1 - x0) - y).abs() < 2.0);
        }
    }

    #[test]
    fn a_path_goes_from_corner_to_corner() {
        assert_eq!(path(&[(3, 4), (10, 2), (20, 2)]), "M3 4l7-2 10 0");
        assert_eq!(path(&[(3, 4)]), "");
    }
}
