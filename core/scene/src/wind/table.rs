//! Rows of numbers in text files: markers and records of wind.

/// One row of a marker file [Thesis, section 4.3]: thirteen numbers.
///
/// ```text
/// x, y, z                    position relative to the centre of mass, axes of the body, m
/// a11, a12, a13, a21 … a33   direction cosines, row by row: from the marker's axes to those of the body
/// area                       m²; 1 where coefficients are those times area
/// ```
///
/// The thesis names the numbers and not the order of the cosines; row by row is chosen. The first axis of a marker
/// points ahead along the chord, the third one to the side of positive lift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AerodynamicMarker {
    /// m, 3 entries.
    pub position: [f64; 3],
    /// Rows of the matrix whose columns are the marker's axes in those of the body.
    pub axes: [[f64; 3]; 3],
    /// m².
    pub area: f64,
}

/// Why a text holds no such table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WindTableError {
    /// Something that is no number.
    #[error("line {line}: {word:?} is no number")]
    NotANumber {
        /// From 1.
        line: usize,
        /// As it stands there.
        word: String,
    },
    /// A row of another length.
    #[error("row {row} has {found} numbers: must have 13: x, y, z, nine direction cosines row by row, area")]
    Width {
        /// From 1.
        row: usize,
        /// Numbers in it.
        found: usize,
    },
    /// Cosines that are none of three perpendicular axes.
    #[error(
        "row {row}: the nine direction cosines must be those of three right-handed perpendicular axes; they miss it \
         by {error:.1e}"
    )]
    NotAxes {
        /// From 1.
        row: usize,
        /// Largest entry of `A Aᵀ − 1`, or 2 where the axes are left-handed.
        error: f64,
    },
    /// An area that is none.
    #[error("row {row}: area = {area} m²: must be positive and finite")]
    Area {
        /// From 1.
        row: usize,
        /// m².
        area: f64,
    },
    /// No row.
    #[error("holds no rows")]
    Empty,
}

/// Rows of numbers separated by commas, semicolons or blanks; a first line that is a heading, empty lines and what
/// follows a `#` are passed over.
///
/// # Errors
/// [`WindTableError::NotANumber`], [`WindTableError::Empty`].
pub(crate) fn rows_of(text: &str) -> Result<Vec<Vec<f64>>, WindTableError> {
    let mut rows = Vec::new();
    let mut heading_allowed = true;
    for (index, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        let words = line.split([',', ';', ' ', '\t']).filter(|word| !word.is_empty());
        let numbers: Result<Vec<f64>, &str> = words.map(|word| word.trim().parse().map_err(|_| word)).collect();
        match numbers {
            Ok(row) if row.is_empty() => continue,
            Ok(row) => rows.push(row),
            Err(_) if heading_allowed => {}
            Err(word) => {
                return Err(WindTableError::NotANumber {
                    line: index + 1,
                    word: word.to_owned(),
                });
            }
        }
        heading_allowed = false;
    }
    if rows.is_empty() {
        Err(WindTableError::Empty)
    } else {
        Ok(rows)
    }
}

impl AerodynamicMarker {
    /// Heading of a marker file.
    const HEADING: &str = "x,y,z,a11,a12,a13,a21,a22,a23,a31,a32,a33,area";

    /// The thirteen numbers.
    #[must_use]
    pub fn row(&self) -> [f64; 13] {
        let [x, y, z] = self.position;
        let [[a11, a12, a13], [a21, a22, a23], [a31, a32, a33]] = self.axes;
        [x, y, z, a11, a12, a13, a21, a22, a23, a31, a32, a33, self.area]
    }

    /// Markers of rows of thirteen numbers.
    ///
    /// # Errors
    /// See [`WindTableError`].
    pub fn from_rows(rows: &[Vec<f64>]) -> Result<Vec<Self>, WindTableError> {
        /// Cosines printed with eight digits.
        const PRINTED: f64 = 1e-7;
        let marker = |(index, row): (usize, &Vec<f64>)| {
            let number = index + 1;
            let &[x, y, z, a11, a12, a13, a21, a22, a23, a31, a32, a33, area] = row.as_slice() else {
                return Err(WindTableError::Width {
                    row: number,
                    found: row.len(),
                });
            };
            let axes = [[a11, a12, a13], [a21, a22, a23], [a31, a32, a33]];
            let error = misfit(&axes);
            if error.is_nan() || error > PRINTED {
                return Err(WindTableError::NotAxes { row: number, error });
            }
            if !(area > 0.0 && area.is_finite()) {
                return Err(WindTableError::Area { row: number, area });
            }
            Ok(Self {
                position: [x, y, z],
                axes,
                area,
            })
        };
        rows.iter().enumerate().map(marker).collect()
    }

    /// Reads a marker file.
    ///
    /// # Errors
    /// See [`WindTableError`].
    pub fn read(text: &str) -> Result<Vec<Self>, WindTableError> {
        Self::from_rows(&rows_of(text)?)
    }

    /// Writes a marker file; every number reads again bit for bit.
    #[must_use]
    pub fn write(markers: &[Self]) -> String {
        let mut text = format!("{}\n", Self::HEADING);
        for marker in markers {
            let numbers = marker.row().map(|number| format!("{number:?}"));
            text.push_str(&numbers.join(","));
            text.push('\n');
        }
        text
    }
}

/// How far rows are from those of a rotation.
fn misfit(a: &[[f64; 3]; 3]) -> f64 {
    let dot = |i: usize, j: usize| -> f64 { (0..3).map(|k| a[i][k] * a[j][k]).sum() };
    // A number that is none is no small error.
    let larger = |error: f64, entry: f64| if error.is_nan() || entry <= error { error } else { entry };
    let entries = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
    let error = entries
        .map(|(i, j)| (dot(i, j) - f64::from(i == j)).abs())
        .fold(0.0, larger);
    let [[a11, a12, a13], [a21, a22, a23], [a31, a32, a33]] = *a;
    let determinant = a11 * (a22 * a33 - a23 * a32) - a12 * (a21 * a33 - a23 * a31) + a13 * (a21 * a32 - a22 * a31);
    if determinant < 0.0 { 2.0 } else { error }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marker() -> AerodynamicMarker {
        let (s, c) = 0.3_f64.sin_cos();
        AerodynamicMarker {
            position: [0.1, -0.2, 1.0 / 3.0],
            axes: [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]],
            area: 0.25,
        }
    }

    #[test]
    fn a_marker_file_reads_again_bit_for_bit() {
        let markers = vec![marker(), AerodynamicMarker { area: 1.0, ..marker() }];
        assert_eq!(
            AerodynamicMarker::read(&AerodynamicMarker::write(&markers)).unwrap(),
            markers
        );
        // As a spreadsheet might write it, without a heading and with blanks.
        let text = "# pan-head\n\n0 0 0; 1 0 0; 0 1 0; 0 0 1; 1 # one\n";
        let read = AerodynamicMarker::read(text).unwrap();
        assert_eq!(read[0].axes, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    }

    #[test]
    fn rows_that_are_no_markers_are_refused_with_their_number() {
        let good = marker().row().to_vec();
        let with = |index: usize, value: f64| {
            let mut row = good.clone();
            row[index] = value;
            AerodynamicMarker::from_rows(&[good.clone(), row])
        };
        let left_handed = with(7, -1.0);
        assert!(matches!(left_handed, Err(WindTableError::NotAxes { row: 2, error }) if error == 2.0));
        assert!(matches!(with(3, 0.9), Err(WindTableError::NotAxes { row: 2, .. })));
        assert!(matches!(with(3, f64::NAN), Err(WindTableError::NotAxes { row: 2, .. })));
        assert!(matches!(with(12, 0.0), Err(WindTableError::Area { row: 2, .. })));
        let short = AerodynamicMarker::from_rows(&[good[..12].to_vec()]);
        assert!(matches!(short, Err(WindTableError::Width { row: 1, found: 12 })));
        let word = AerodynamicMarker::read("x,y\n1,two\n");
        assert!(matches!(word, Err(WindTableError::NotANumber { line: 2, .. })));
        assert!(matches!(AerodynamicMarker::read("x,y,z\n"), Err(WindTableError::Empty)));
    }
}
