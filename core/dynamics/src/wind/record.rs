//! A wind given as numbers over time, at one or several places.
use nalgebra::Vector3;

/// Velocities at given times and stations, with straight lines between them; outside it is that of the nearest time and
/// station.
#[derive(Clone, Debug, PartialEq)]
pub struct WindRecord {
    /// Stations by ascending x.
    stations: Vec<Station>,
}

#[derive(Clone, Debug, PartialEq)]
struct Station {
    x: f64,
    times: Vec<f64>,
    velocities: Vec<Vector3<f64>>,
}

/// Reasons why rows are no record.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WindRecordError {
    /// There is no row.
    #[error("has no rows")]
    Empty,
    /// A row has neither four nor five numbers, or not as many as the first.
    #[error("row {row} has {found} numbers: must have {expected}")]
    Width {
        /// From 1.
        row: usize,
        /// Numbers in it.
        found: usize,
        /// Required numbers.
        expected: &'static str,
    },
    /// A number that is none.
    #[error("row {row}: must be finite numbers")]
    NotFinite {
        /// From 1.
        row: usize,
    },
    /// Times that do not ascend.
    #[error("row {row}: time = {time} s: must be after {before} s, the time before it at the same place")]
    Order {
        /// From 1.
        row: usize,
        /// s.
        time: f64,
        /// s.
        before: f64,
    },
}

impl WindRecord {
    /// A record of rows (time in s, velocity in m/s, x in m if there are several stations): four numbers each, or five
    /// each. The times ascend at each station; the stations may come in any order.
    ///
    /// # Errors
    /// See [`WindRecordError`].
    pub fn from_rows(rows: &[Vec<f64>]) -> Result<Self, WindRecordError> {
        let width = rows.first().ok_or(WindRecordError::Empty)?.len();
        let expected = match width {
            4 => "4: time, vx, vy, vz, as the first row",
            5 => "5: time, vx, vy, vz, x, as the first row",
            _ => "4: time, vx, vy, vz; or 5: and x",
        };
        let mut stations: Vec<Station> = Vec::new();
        for (index, row) in rows.iter().enumerate() {
            let number = index + 1;
            if row.len() != width || !(4..=5).contains(&width) {
                let found = row.len();
                return Err(WindRecordError::Width {
                    row: number,
                    found,
                    expected,
                });
            }
            if !row.iter().all(|value| value.is_finite()) {
                return Err(WindRecordError::NotFinite { row: number });
            }
            let x = row.get(4).copied().unwrap_or(0.0);
            let place = stations.partition_point(|station| station.x < x);
            if stations.get(place).is_none_or(|station| station.x != x) {
                let station = Station {
                    x,
                    times: Vec::new(),
                    velocities: Vec::new(),
                };
                stations.insert(place, station);
            }
            let station = &mut stations[place];
            if let Some(&before) = station.times.last()
                && row[0] <= before
            {
                return Err(WindRecordError::Order {
                    row: number,
                    time: row[0],
                    before,
                });
            }
            station.times.push(row[0]);
            station.velocities.push(Vector3::new(row[1], row[2], row[3]));
        }
        Ok(Self { stations })
    }

    /// Velocity at time `t` (s) over `x` (m), m/s.
    #[must_use]
    pub fn velocity(&self, t: f64, x: f64) -> Vector3<f64> {
        let after = self.stations.partition_point(|station| station.x <= x);
        let last = self.stations.len() - 1;
        let (low, high) = (after.saturating_sub(1), after.min(last));
        let (low, high) = (&self.stations[low], &self.stations[high]);
        if low.x >= high.x {
            return low.velocity(t);
        }
        let share = (x - low.x) / (high.x - low.x);
        low.velocity(t) * (1.0 - share) + high.velocity(t) * share
    }

    pub(super) fn is_the_same_everywhere(&self) -> bool {
        self.stations.len() == 1
    }
}

impl Station {
    fn velocity(&self, t: f64) -> Vector3<f64> {
        let after = self.times.partition_point(|time| *time <= t);
        let last = self.times.len() - 1;
        let (low, high) = (after.saturating_sub(1), after.min(last));
        if low == high {
            return self.velocities[low];
        }
        let share = ((t - self.times[low]) / (self.times[high] - self.times[low])).clamp(0.0, 1.0);
        self.velocities[low] * (1.0 - share) + self.velocities[high] * share
    }
}
