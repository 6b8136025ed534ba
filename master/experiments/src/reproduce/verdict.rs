//! Verdict on a published change: the computed one compared in direction and in size.

use serde::Serialize;

/// A change below this is none, %.
///
/// Table 6 prints −2.80 % and −2.91 % without and with wind on the wires, and the thesis calls their effect negligible:
/// 35.66 N over 35.70 N is −0.11 %, and the rounding of both adds up to 0.03 %; rounded up. The smallest change that
/// stands against it is 1.6 %, of the standard deviation with the sliding joint.
pub const VISIBLE: f64 = 0.2;

/// A computed change of the same direction has the size of the published one between these shares of it.
pub const SAME_SIZE: [f64; 2] = [0.5, 2.0];

/// The bounds in words.
pub const VERDICT_RULE: &str = "A change below 0.2 % is none: the thesis calls one of -0.11 % (35.70 N to 35.66 N, \
    both rounded) negligible. A published change holds where the computed one has its direction and half to twice its \
    size; with another size it is the direction only that holds; with the other direction, or without a change, it is \
    refuted. Where no change is published, one of 0.2 % or more refutes that.";

/// Verdict on a published change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Direction and size, or none in both.
    Holds,
    /// Direction, not the size.
    DirectionOnly,
    /// Neither.
    Refuted,
    /// A case has no figures.
    NotComputed,
}

impl Verdict {
    /// As the table names it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::DirectionOnly => "direction only",
            Self::Refuted => "refuted",
            Self::NotComputed => "not computed",
        }
    }
}

/// Verdict of a computed change on a published one, both in %, and the reason with its figures.
pub(super) fn judge(published: f64, computed: Option<f64>) -> (Verdict, String) {
    let Some(computed) = computed.filter(|computed| computed.is_finite()) else {
        return (Verdict::NotComputed, "a case has no figures".to_owned());
    };
    let refuted = |why: &str| {
        let why = format!("{why}: {computed:+.2} % where {published:+.2} % is published");
        (Verdict::Refuted, why)
    };
    let share = computed / published;
    let [least, most] = SAME_SIZE;
    match [published, computed].map(|change| change.abs() >= VISIBLE) {
        [false, false] => (
            Verdict::Holds,
            format!("no visible change: {computed:+.2} %, below {VISIBLE} %"),
        ),
        [false, true] => refuted("a visible change"),
        [true, false] => refuted("no visible change"),
        [true, true] if share < 0.0 => refuted("other direction"),
        [true, true] if (least..=most).contains(&share) => {
            (Verdict::Holds, format!("{share:.2} of the published change"))
        }
        [true, true] => {
            let words = format!("same direction, {share:.2} of the published change");
            (Verdict::DirectionOnly, words)
        }
    }
}
