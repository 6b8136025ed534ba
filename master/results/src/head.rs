//! Series of a head from those of its strips.

use component::exchange::{contact, strip};

use crate::StripRecord;
use crate::record::COLUMNS;

/// Name of the group of a head's series in the time series file.
const GROUP: &str = "head";

/// Names of the series of head `i` (from 1) in the order of the time series file.
pub(super) fn names(i: usize) -> [String; COLUMNS] {
    let contact = |index: usize| contact::SIGNALS[index].of(GROUP, i);
    let strip = |index: usize| strip::SIGNALS[index].of(GROUP, i);
    [
        contact(contact::FORCE),
        contact(contact::X),
        contact(contact::Y),
        contact(contact::WIRE_Z),
        strip(strip::Z),
        strip(strip::VZ),
        contact(contact::GAP),
    ]
}

impl StripRecord {
    /// Adds a row from the last rows of the strips of a head with several: force and wind are sums, places and heights
    /// means, the gap is the smallest. The place of the resultant would jump between the strips, and forces against
    /// places with it.
    pub(super) fn push_head(&mut self) {
        let last = |series: &Vec<f64>| series.last().copied().unwrap_or_default();
        let strips = &self.strips;
        let count = strips.len() as f64;
        let sum = |of: fn(&Self) -> &Vec<f64>| strips.iter().map(|strip| last(of(strip))).sum::<f64>();
        let row = [
            sum(|strip| &strip.force),
            sum(|strip| &strip.contact_x) / count,
            sum(|strip| &strip.contact_y) / count,
            sum(|strip| &strip.wire_z) / count,
            sum(|strip| &strip.strip_z) / count,
            sum(|strip| &strip.strip_vz) / count,
            strips.iter().map(|strip| last(&strip.gap)).fold(f64::MAX, f64::min),
        ];
        if let Some(wind) = &mut self.wind {
            let sum = |of: fn(&crate::WindRecord) -> &Vec<f64>| {
                let winds = strips.iter().filter_map(|strip| strip.wind.as_ref());
                winds.map(|wind| last(of(wind))).sum()
            };
            wind.drag.push(sum(|wind| &wind.drag));
            wind.lift.push(sum(|wind| &wind.lift));
        }
        for (series, value) in self.columns_mut().into_iter().zip(row) {
            series.push(value);
        }
    }
}

#[cfg(test)]
mod tests {
    use component::exchange::{contact, strip};
    use component::{Observer, Point};

    use crate::recorder::Recorder;
    use crate::tests::run;
    use crate::{LineGeometry, OutputDirectory, Record, RunBundle};

    /// Record of three strips, two on the first head, from force, place, height and gap of each.
    fn recorded(rows: [[f64; 4]; 3]) -> Record {
        let mut point = Point::new(0.0, 3, 3 * contact::COUNT);
        for (i, [force, x, z, gap]) in rows.into_iter().enumerate() {
            point.line[i * contact::COUNT + contact::FORCE] = force;
            point.line[i * contact::COUNT + contact::X] = x;
            point.line[i * contact::COUNT + contact::GAP] = gap;
            point.strips[i * strip::OUTPUTS + strip::Z] = z;
            point.strips[i * strip::OUTPUTS + strip::WIND_DRAG] = 85.0;
        }
        let recorder = Recorder::new(0.0, 0.001, 2, &[], LineGeometry::default());
        let mut recorder = recorder.with_heads(&[2, 1]).with_wind([0]);
        recorder.start(&point);
        recorder.finish()
    }

    #[test]
    fn a_head_has_the_sum_of_its_strips_in_their_middle() {
        let record = recorded([
            [30.0, 20.3, 5.30, -6e-4],
            [90.0, 19.7, 5.32, -18e-4],
            [110.0, 5.0, 5.31, -22e-4],
        ]);
        let [first, second] = &record.pantographs[..] else {
            panic!("two heads");
        };
        assert_eq!((first.force[0], first.contact_x[0]), (120.0, 20.0));
        // Rounding of a mean.
        assert!((first.strip_z[0] - 5.31).abs() < 1e-12);
        assert_eq!(first.gap, [-18e-4]);
        assert_eq!(first.wind.as_ref().unwrap().drag, [170.0]);
        let forces: Vec<f64> = first.strips.iter().map(|strip| strip.force[0]).collect();
        assert_eq!((forces, second.force.as_slice()), (vec![30.0, 90.0], &[110.0][..]));
        assert!(second.strips.is_empty());
    }

    #[test]
    fn heads_are_written_and_read_back_bit_for_bit_and_their_strips_are_summarised() {
        const MORE: f64 = 20.0 + 1.0 / 3.0;
        let folder = tempfile::tempdir().unwrap();
        let (info, mut record) = run(true);
        let strip = record.pantographs[0].clone();
        let mut other = strip.clone();
        other.force.fill(MORE);
        record.pantographs[0].force.iter_mut().for_each(|force| *force += MORE);
        record.pantographs[0].strips = vec![strip, other];
        record.animation = record.animation.rounded();
        let directory = OutputDirectory::open(folder.path()).unwrap();
        directory.begin("").unwrap();
        let written = directory.finish(&info, record.clone(), "").unwrap();
        let read = RunBundle::read(folder.path()).unwrap();
        assert_eq!(read.record, record);
        let summary = &read.summary.pantographs;
        assert_eq!(summary, &written.summary.pantographs);
        let means: Vec<f64> = summary[0].strips.iter().map(|strip| strip.raw.unwrap().mean).collect();
        // Rounding of a mean over 2000 samples.
        assert!((means[0] - 100.0).abs() < 1e-9 && (means[1] - MORE).abs() < 1e-9);
        assert!((summary[0].contact_force.raw.unwrap().mean - 100.0 - MORE).abs() < 1e-9);
        assert!(summary[1].strips.is_empty());
        let text = std::fs::read_to_string(folder.path().join("timeseries.csv")).unwrap();
        let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
        let begins = [1, 8, 15, 22, 29].map(|column| names[column]);
        let expected = [
            "head[1].force",
            "contact[1].force",
            "contact[2].force",
            "head[2].force",
            "contact[3].force",
        ];
        assert_eq!(begins, expected);
        assert!(crate::report::render(&[read]).contains("strip 2, filtered"));
    }
}
