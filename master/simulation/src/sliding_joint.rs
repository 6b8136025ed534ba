//! Consequences of a sliding joint between strips and contact wire for a run: it needs one system, and it cannot lose
//! contact.

use catenary::CatenaryError;
use scene::{ContactLaw, Scene};

use crate::SetupError;
use results::Record;

/// Spells of pull that a remark names one by one.
const NAMED: usize = 8;

/// True where the strips of a scene are held on its line.
#[must_use]
pub fn holds(scene: &Scene) -> bool {
    let contact = scene.contact.as_ref();
    contact.is_some_and(|contact| contact.law == ContactLaw::SlidingJoint)
}

/// Refuses a scene whose strips are held on its line for something that takes line and pantographs apart, named by
/// `what`.
///
/// # Errors
/// [`SetupError::NotAvailable`].
pub fn refuse(scene: &Scene, what: &str) -> Result<(), SetupError> {
    if !holds(scene) {
        return Ok(());
    }
    let reason = format!(
        "{what}: {}, or `master run --mode monolithic`",
        CatenaryError::SlidingJoint
    );
    Err(SetupError::NotAvailable(reason))
}

/// A time in which a joint pulls.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Spell {
    /// s.
    from: f64,
    /// s.
    to: f64,
    /// N.
    largest: f64,
}

/// The times with a negative force, their ends interpolated between the samples.
fn spells(time: &[f64], force: &[f64]) -> Vec<Spell> {
    let mut spells: Vec<Spell> = Vec::new();
    for i in 0..time.len().min(force.len()) {
        if force[i] >= 0.0 {
            continue;
        }
        // Where the straight line from sample j to this one changes its sign.
        let zero = |j: usize| time[i] + (time[j] - time[i]) * force[i] / (force[i] - force[j]);
        let to = match force.get(i + 1) {
            Some(next) if *next >= 0.0 => zero(i + 1),
            Some(_) => time[i + 1],
            None => time[i],
        };
        if i > 0 && force[i - 1] < 0.0 {
            if let Some(spell) = spells.last_mut() {
                spell.to = to;
                spell.largest = spell.largest.max(-force[i]);
            }
        } else {
            let from = if i > 0 { zero(i - 1) } else { time[i] };
            let largest = -force[i];
            spells.push(Spell { from, to, largest });
        }
    }
    spells
}

/// When and how long the joints of a run have pulled; nothing under another law.
#[must_use]
pub fn remarks(scene: &Scene, record: &Record) -> Vec<String> {
    if !holds(scene) {
        return Vec::new();
    }
    let strips = record.pantographs.iter().enumerate();
    strips
        .map(|(index, strip)| remark(index + 1, &record.time, &spells(&record.time, &strip.force)))
        .collect()
}

fn remark(pantograph: usize, time: &[f64], spells: &[Spell]) -> String {
    let name = format!(
        "pantograph {pantograph}: its strip is held on the wire by a sliding joint, which cannot lose contact: what \
         counts as its loss \
         is when it pulls; "
    );
    let Some(worst) = spells.iter().max_by(|a, b| a.largest.total_cmp(&b.largest)) else {
        return name + "its force was never negative";
    };
    let length = |spell: &Spell| spell.to - spell.from;
    let all: f64 = spells.iter().map(length).sum();
    let whole = time.last().unwrap_or(&0.0) - time.first().unwrap_or(&0.0);
    let mut places: Vec<String> = (spells.iter().take(NAMED))
        .map(|spell| format!("{:.3} s for {:.1} ms", spell.from, 1e3 * length(spell)))
        .collect();
    if spells.len() > NAMED {
        places.push(format!("{} more", spells.len() - NAMED));
    }
    format!(
        "{name}it pulled, where a strip that is free to leave would have left or pressed otherwise, {} times in \
         {all:.3} s of {whole:.3} \
         s, with up to {:.1} N at t = {:.3} s; from t = {}",
        spells.len(),
        worst.largest,
        worst.from,
        places.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spell_of_pull_lasts_from_zero_to_zero() {
        let time: Vec<f64> = (0..8).map(|i| 0.1 * f64::from(i)).collect();
        let force = [-1.0, 1.0, 30.0, -10.0, -20.0, 20.0, 1.0, -2.0];
        let found = spells(&time, &force);
        let expected = [(0.0, 0.05, 1.0), (0.275, 0.45, 20.0), (0.6 + 0.1 / 3.0, 0.7, 2.0)];
        assert_eq!(found.len(), 3);
        for (spell, (from, to, largest)) in found.iter().zip(expected) {
            // Rounding.
            assert!(
                (spell.from - from).abs() < 1e-12 && (spell.to - to).abs() < 1e-12,
                "{found:?}"
            );
            assert_eq!(spell.largest, largest);
        }
        let text = remark(1, &time, &found);
        assert!(
            text.contains("3 times in 0.292 s of 0.700 s") && text.contains("up to 20.0 N at t = 0.275 s"),
            "{text}"
        );
    }

    #[test]
    fn a_joint_that_never_pulls_says_so() {
        let found = spells(&[0.0, 1.0], &[0.0, 3.0]);
        assert!(found.is_empty());
        assert!(remark(2, &[0.0, 1.0], &found).ends_with("never negative"));
    }
}
