//! Tables that a scene leaves to files.

use std::sync::Arc;

use crate::wind::rows_of;
use crate::write::shown_entries;
use crate::{AerodynamicMarker, GivenMotion, Irregularities, Points, Scene, Vehicle, Wind};

/// Most rows of a record of the wind: what a scene can still hold as text.
const MOST_ROWS: usize = 200_000;

const WIND_KEY: &str = "wind.file";
const MOTION_KEY: &str = "vehicle.motion.file";
const POINTS_KEY: &str = "track.irregularities.file";

fn marker_file_key(surface: usize) -> String {
    format!("wind.pantograph.surfaces[{}].marker_file", surface + 1)
}

/// Gives the text of a file, or why it cannot.
type Open<'a> = &'a dyn Fn(&str) -> Result<String, String>;

/// The columns `names` of comma-separated text whose first line names them; a column that is not there is zero, but for
/// the first.
///
/// Lines that begin with `#` and empty lines are left out.
fn columns(text: &str, names: &[&str]) -> Result<Vec<Vec<f64>>, String> {
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(number, line)| (number + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let (_, header) = lines
        .next()
        .ok_or("is empty: must begin with the names of its columns")?;
    let header: Vec<&str> = header.split(',').map(str::trim).collect();
    if let Some(unknown) = header.iter().find(|name| !names.contains(name)) {
        return Err(format!(
            "column {unknown:?}: unknown; known columns: {}",
            names.join(", ")
        ));
    }
    if !header.contains(&names[0]) {
        return Err(format!("must have a column {:?}", names[0]));
    }
    let mut found = vec![Vec::new(); names.len()];
    for (number, line) in lines {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        if cells.len() != header.len() {
            return Err(format!(
                "line {number} has {}, must have {}, one per column",
                shown_entries(cells.len()),
                header.len()
            ));
        }
        for (column, name) in found.iter_mut().zip(names) {
            let cell = header.iter().position(|entry| entry == name).map(|place| cells[place]);
            let value = cell.map_or(Ok(0.0), |cell| {
                let value = cell.parse::<f64>().ok().filter(|value| value.is_finite());
                value.ok_or_else(|| format!("line {number}, {name}: {cell:?} must be a finite number"))
            });
            column.push(value?);
        }
    }
    if found[0].is_empty() {
        return Err("has no rows".to_owned());
    }
    Ok(found)
}

fn refused(key: &str, path: &str, reason: &str) -> String {
    format!("{key} = {path:?}: {reason}")
}

impl Wind {
    fn fill_tables(&mut self, open: Open<'_>) -> Result<(), String> {
        if let Some(file) = self.file.take() {
            let refused = |reason: String| refused(WIND_KEY, &file, &reason);
            let rows = rows_of(&open(&file).map_err(refused)?).map_err(|error| refused(error.to_string()))?;
            if rows.len() > MOST_ROWS {
                return Err(refused(format!(
                    "has {} rows, must have at most {MOST_ROWS}",
                    rows.len()
                )));
            }
            dynamics::WindRecord::from_rows(&rows).map_err(|error| refused(error.to_string()))?;
            self.record = rows;
        }
        let surfaces = self
            .pantograph
            .iter_mut()
            .flat_map(|pantograph| &mut pantograph.surfaces);
        for (index, surface) in surfaces.enumerate() {
            let Some(file) = surface.marker_file.take() else {
                continue;
            };
            let key = marker_file_key(index);
            let refused = |reason: String| refused(&key, &file, &reason);
            let markers = AerodynamicMarker::read(&open(&file).map_err(refused)?);
            surface.markers = markers.map_err(|error| refused(error.to_string()))?;
        }
        Ok(())
    }
}

impl Scene {
    /// Files that tables are left to and that were not read yet: their keys, and their paths as the scene has them.
    pub fn unread_files_mut(&mut self) -> Vec<(String, &mut String)> {
        let mut found = Vec::new();
        if let Some(wind) = &mut self.wind {
            found.extend(wind.file.as_mut().map(|file| (WIND_KEY.to_owned(), file)));
            let surfaces = wind.pantograph.iter_mut().flat_map(|wind| &mut wind.surfaces);
            found.extend(surfaces.enumerate().filter_map(|(index, surface)| {
                let file = surface.marker_file.as_mut();
                file.map(|file| (marker_file_key(index), file))
            }));
        }
        if let Some(vehicle) = &mut self.vehicle
            && let Vehicle::RigidMotion(motion) = Arc::make_mut(vehicle)
        {
            found.extend(motion.file.as_mut().map(|file| (MOTION_KEY.to_owned(), file)));
        }
        if let Some(track) = &mut self.track
            && let Irregularities::Points(points) = &mut Arc::make_mut(track).irregularities
        {
            found.extend(points.file.as_mut().map(|file| (POINTS_KEY.to_owned(), file)));
        }
        found
    }

    /// Reads the files that tables are left to and writes their content into the scene in their place; `open` gives the
    /// text of a file, whose path is as the scene has it. What is read has still to be checked ([`Scene::check`]).
    ///
    /// # Errors
    /// The key, the file and what is wrong with it.
    pub fn fill_tables(&mut self, open: Open<'_>) -> Result<(), String> {
        if let Some(wind) = &mut self.wind {
            wind.fill_tables(open)?;
        }
        let read = |key: &str, path: &str, names: &[&str]| {
            let found = open(path).and_then(|text| columns(&text, names));
            found.map_err(|reason| refused(key, path, &reason))
        };
        if let Some(vehicle) = &mut self.vehicle
            && let Vehicle::RigidMotion(GivenMotion { file: Some(path), .. }) = vehicle.as_ref()
        {
            let found = read(MOTION_KEY, path, &GivenMotion::COLUMNS)?;
            let columns = <[Vec<f64>; 7]>::try_from(found).unwrap_or_default();
            *Arc::make_mut(vehicle) = Vehicle::RigidMotion(GivenMotion::of_columns(columns));
        }
        if let Some(track) = &mut self.track
            && let Irregularities::Points(Points { file: Some(path), .. }) = &track.irregularities
        {
            let names = ["x", "z_left", "z_right", "y_left", "y_right"];
            let found = read(POINTS_KEY, path, &names)?;
            let [x, z_left, z_right, y_left, y_right] = <[Vec<f64>; 5]>::try_from(found).unwrap_or_default();
            Arc::make_mut(track).irregularities = Irregularities::Points(Points {
                x,
                z_left,
                z_right,
                y_left,
                y_right,
                file: None,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_by_name_and_missing_ones_are_zero() {
        let text = "# measured\nz, time\n0.1, 0\n\n-0.2, 1.5\n";
        let found = columns(text, &["time", "y", "z"]).unwrap();
        assert_eq!(found, [vec![0.0, 1.5], vec![0.0, 0.0], vec![0.1, -0.2]]);
    }

    #[test]
    fn refusals_name_line_and_column() {
        let refusal = |text: &str| columns(text, &["time", "z"]).unwrap_err();
        assert!(refusal("").contains("is empty"));
        assert!(refusal("z\n1\n").contains("\"time\""));
        assert!(refusal("time,zz\n").contains("\"zz\""));
        assert!(refusal("time,z\n1\n").contains("line 2 has 1 entry"));
        assert!(refusal("time,z\n1,up\n").contains("line 2, z: \"up\""));
        assert!(refusal("time,z\n").contains("no rows"));
    }
}
