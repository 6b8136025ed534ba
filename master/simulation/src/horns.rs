//! A contact wire on the horns of a head, and one that is under the head.

use scene::{Pantograph, Scene};

use results::{Record, StripRecord};

/// Depth of a wire below the top of a head without contact force that no opening contact reaches, m.
const UNDER: f64 = 1e-3;

/// Parts of a span at whose ends the wire at rest is looked at.
const PARTS: u32 = 16;

/// Samples of a strip that were of one kind.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stretch {
    /// First time, s.
    from: f64,
    /// Number of samples.
    count: usize,
    /// Largest distance of the wire from the middle of the head, m.
    largest: f64,
    /// Time of the largest distance, s.
    at: f64,
}

/// Samples (time in s, distance of the wire from the middle of the head in m) among all that are wanted.
fn stretch(samples: impl Iterator<Item = (f64, f64)>) -> Option<Stretch> {
    samples.fold(None, |found, (time, aside)| {
        let known = found.unwrap_or(Stretch {
            from: time,
            count: 0,
            largest: 0.0,
            at: time,
        });
        let further = aside.abs() > known.largest;
        Some(Stretch {
            from: known.from,
            count: known.count + 1,
            largest: known.largest.max(aside.abs()),
            at: if further { time } else { known.at },
        })
    })
}

/// Pantographs (from 0) on whose horns a wire may rest, with half the width of the strip and half the length of the
/// head, m.
fn horned(scene: &Scene) -> impl Iterator<Item = (usize, f64, f64)> + '_ {
    let half = |pantograph: &Pantograph| {
        pantograph.horns()?;
        Some((0.5 * pantograph.strip_width()?, pantograph.half_length()?))
    };
    let all = scene
        .pantographs
        .iter()
        .enumerate()
        .filter(|_| scene.modelled_line().is_some());
    all.filter_map(move |(index, pantograph)| half(pantograph).map(|(strip, head)| (index, strip, head)))
}

/// Notes of a run on wires on horns and under heads, for each strip.
#[must_use]
pub fn remarks(scene: &Scene, record: &Record) -> Vec<String> {
    let mut notes = Vec::new();
    for (index, strip, head) in horned(scene) {
        let Some(pantograph) = record.pantographs.get(index) else {
            continue;
        };
        let several = pantograph.each_strip().len() > 1;
        for (own, strips) in pantograph.each_strip().iter().enumerate() {
            let name = if several {
                format!("pantograph {}, strip {}", index + 1, own + 1)
            } else {
                format!("pantograph {}", index + 1)
            };
            let x = |time: f64| scene.head_x(index, time);
            notes.extend(on_horn(&name, record, strips, (strip, head), x));
            notes.extend(under(&name, record, strips, head, x));
        }
    }
    notes
}

/// Samples of a strip as (time in s, distance of the wire in m, contact force in N, gap in m).
fn samples<'a>(record: &'a Record, strip: &'a StripRecord) -> impl Iterator<Item = (f64, f64, f64, f64)> + 'a {
    let values = record.time.iter().zip(&strip.aside).zip(&strip.force).zip(&strip.gap);
    values.map(|(((&time, &aside), &force), &gap)| (time, aside, force, gap))
}

fn on_horn(
    name: &str,
    record: &Record,
    strip: &StripRecord,
    (half, head): (f64, f64),
    x: impl Fn(f64) -> f64,
) -> Option<String> {
    let touching = || samples(record, strip).filter(|(.., force, _)| *force > 0.0);
    let outside = touching().filter(|(_, aside, ..)| aside.abs() > half);
    let found = stretch(outside.map(|(time, aside, ..)| (time, aside)))?;
    Some(format!(
        "{name}: the wire was on a horn of the head for {:.1} % of the time of contact, beyond the straight strip of \
         ±{half} m, first at t = {:.3} s (x = {:.1} m): up to {:.3} m from the middle of the head, at t = {:.3} s, of \
         {head} m to its end",
        100.0 * found.count as f64 / touching().count() as f64,
        found.from,
        x(found.from),
        found.largest,
        found.at
    ))
}

fn under(name: &str, record: &Record, strip: &StripRecord, head: f64, x: impl Fn(f64) -> f64) -> Option<String> {
    let below =
        samples(record, strip).filter(|&(_, aside, force, gap)| aside.abs() <= head && force == 0.0 && gap < -UNDER);
    let found = stretch(below.map(|(time, aside, ..)| (time, aside)))?;
    Some(format!(
        "{name}: the wire came back under the head after it had passed the end of a horn, from t = {:.3} s (x = {:.1} \
         m) on: there is no contact force there, where a real wire would break the head, and results from then on mean \
         nothing",
        found.from,
        x(found.from)
    ))
}

/// Spans in which the wire at rest is on a horn.
#[must_use]
pub fn foreseen(scene: &Scene) -> Vec<String> {
    let Some((line, _)) = scene.modelled_line() else {
        return Vec::new();
    };
    let seen = horned(scene).filter_map(|(index, strip, head)| {
        // Within a span the wire of a curve lies further inside than at the supports.
        let spans = (0..line.spans()).filter_map(|span| {
            let [left, right] = [span, span + 1].map(|support| line.support_x(support));
            let places = (0..=PARTS).map(|part| left + (right - left) * f64::from(part) / f64::from(PARTS));
            let asides = places.map(|x| (x, line.lateral(x) - scene.strip_start_y()));
            asides.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))
        });
        let found = stretch(spans.filter(|(_, aside)| aside.abs() > strip))?;
        Some(format!(
            "pantograph {}: at rest the wire is beyond the straight strip of ±{strip} m in {} spans, up to {:.3} m \
             from the middle of the head, at x = {:.1} m: it comes onto the horns there, of {head} m to their end",
            index + 1,
            found.count,
            found.largest,
            found.at
        ))
    });
    seen.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "pantograph[1].strip={ width = 0.3, horns = { y = [0.2, 0.4], z = [-0.02, -0.2] } }";

    fn scene() -> Scene {
        let text = include_str!("../../../scenes/en50318-250.toml");
        system::load(text, "scene.toml", &[HEAD.to_owned()]).unwrap()
    }

    fn record(aside: &[f64], force: &[f64], gap: &[f64]) -> Record {
        Record {
            time: (0..aside.len()).map(|row| row as f64).collect(),
            pantographs: vec![StripRecord {
                aside: aside.to_vec(),
                force: force.to_vec(),
                gap: gap.to_vec(),
                ..StripRecord::default()
            }],
            ..Record::default()
        }
    }

    #[test]
    fn time_on_a_horn_and_a_wire_under_the_head_are_told() {
        let told = |aside: &[f64], force: &[f64], gap: &[f64]| remarks(&scene(), &record(aside, force, gap));
        assert_eq!(told(&[0.0, 0.15, -0.1], &[9.0; 3], &[0.0; 3]), Vec::<String>::new());
        let horn = told(&[0.0, 0.16, -0.18, 0.1, 0.9], &[9.0, 9.0, 9.0, 9.0, 0.0], &[0.0; 5]);
        assert_eq!(horn.len(), 1);
        assert!(horn[0].contains("for 50.0 % of the time of contact"), "{}", horn[0]);
        assert!(
            horn[0].contains("up to 0.180 m") && horn[0].contains("at t = 2.000 s"),
            "{}",
            horn[0]
        );
        let lost = told(&[0.0, 0.5, 0.3], &[9.0, 0.0, 0.0], &[0.0, -0.1, -0.1]);
        assert_eq!(lost.len(), 1);
        assert!(
            lost[0].contains("came back under the head") && lost[0].contains("t = 2.000 s"),
            "{}",
            lost[0]
        );
    }

    #[test]
    fn a_wire_in_a_curve_that_comes_onto_a_horn_between_supports_is_foreseen() {
        let text = include_str!("../../../scenes/en50318-250.toml");
        // 60²/(8 · 1500) = 0.3 m from the chord in the middle of a span.
        let keys = [HEAD, "catenary.curve_radius=1500", "catenary.stagger=[-0.1]"];
        let said = foreseen(&system::load(text, "scene.toml", &keys.map(str::to_owned)).unwrap());
        assert!(
            said.len() == 1 && said[0].contains("in 10 spans, up to 0.200 m"),
            "{said:?}"
        );
        assert!(said[0].contains("at x = 30.0 m"), "{said:?}");
    }

    #[test]
    fn supports_that_put_the_wire_on_a_horn_are_foreseen() {
        assert_eq!(foreseen(&scene()), Vec::<String>::new());
        let text = include_str!("../../../scenes/en50318-250.toml");
        let keys = [HEAD.to_owned(), "catenary.stagger=[0.1, -0.25]".to_owned()];
        let said = foreseen(&system::load(text, "scene.toml", &keys).unwrap());
        assert!(said.len() == 1 && said[0].contains("up to 0.250 m"), "{said:?}");
    }
}
