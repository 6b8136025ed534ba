//! Explanations of words: keys of a scene, and figures, limits and notes of a result.
//!
//! | file | subject |
//! | --- | --- |
//! | `glossary` | figures, causes of an error, parts of a note |
//! | `keys` | keys of a scene file |
//! | `limits` | clause, figure and certainty of each limit, over systems and speeds |

mod glossary;
mod keys;
mod limits;

use scene::Assessment;
use serde::Serialize;

pub use glossary::{Word, glossary, named};
pub use keys::{Key, keys};
pub use limits::{LimitText, limits};

/// Everything that is known of a word.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Explanation {
    /// Keys of that path or name, or in that table.
    pub keys: Vec<Key>,
    /// Figures and notes of that name.
    pub words: Vec<Word>,
    /// Limits of that standard or quantity.
    pub limits: Vec<LimitText>,
}

impl Explanation {
    /// Explanation of `typed`: a key, the name of a figure or cause, a note or its name, a quantity that is limited, a
    /// standard, or both as in `EN 50367 std`; limits with those of `assessment` in their places.
    #[must_use]
    pub fn of(typed: &str, assessment: &Assessment) -> Self {
        // A note begins with its subject.
        let typed = typed.trim().trim_start_matches("note: ");
        let typed = typed.split(": ").next().unwrap_or(typed).trim();
        let words = named(typed).copied().into_iter().collect();
        let limits = limits(assessment)
            .into_iter()
            .filter(|limit| limit.is_called(typed))
            .collect();
        Self {
            keys: keys(typed),
            words,
            limits,
        }
    }

    /// True where nothing is known.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty() && self.words.is_empty() && self.limits.is_empty()
    }

    /// Names that are explained.
    #[must_use]
    pub fn names() -> Vec<String> {
        let words = glossary()
            .iter()
            .flat_map(|word| word.names)
            .map(|name| (*name).to_owned());
        let limits = limits(&Assessment::default())
            .into_iter()
            .flat_map(|limit| [limit.standard, limit.quantity]);
        let mut names: Vec<String> = words.chain(limits).collect();
        names.sort();
        names.dedup();
        names
    }

    /// The explanation as text.
    #[must_use]
    pub fn text(&self) -> String {
        let keys = self.keys.iter().map(Key::text);
        let words = self.words.iter().map(Word::text);
        let limits = self.limits.iter().map(LimitText::text);
        keys.chain(words).chain(limits).collect::<Vec<_>>().join("\n")
    }
}

/// A unit behind a name; nothing where there is none.
fn bracketed(unit: &str) -> String {
    match unit {
        "" => String::new(),
        unit => format!(" [{unit}]"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Summary;
    use crate::tests::run;

    #[test]
    fn every_limit_of_a_run_and_every_cause_of_an_error_is_explained() {
        let (info, record) = run(true);
        for limit in Summary::new(&info, &record).limits {
            let typed = format!("{} {}", limit.standard, limit.quantity);
            let found = Explanation::of(&typed, &Assessment::default());
            assert_eq!(found.limits.len(), 1, "{typed}");
            assert!(
                !Explanation::of(&limit.quantity, &Assessment::default())
                    .words
                    .is_empty(),
                "{}",
                limit.quantity
            );
        }
        let causes = scene::Reduction::ALL.iter().map(|reduction| reduction.name());
        for cause in causes.chain(["mesh", "step", "newton_tolerance", "coupling"]) {
            assert!(
                !Explanation::of(cause, &Assessment::default()).words.is_empty(),
                "{cause}"
            );
        }
        assert!(Explanation::of("nothing", &Assessment::default()).is_empty());
    }

    #[test]
    fn a_limit_tells_its_figure_for_each_system_and_speed_with_clause_and_certainty() {
        let text = Explanation::of("EN 50367 mean", &Assessment::default()).text();
        for part in [
            "2012, Table 6",
            "0.00097 v² + 70 N",
            "0.00228 v² + 90 N",
            "[R]",
            "[C]",
            "ac_25kv",
            "dc_1_5kv",
            "remedy",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        // One standard: all of its limits.
        assert!(Explanation::of("en 50119", &Assessment::default()).limits.len() >= 5);
    }

    #[test]
    fn rows_of_the_user_are_told_as_formula_or_number() {
        let row = |keys: &str| format!("[[assessment.limit]]\nstandard = \"Manual:1\"\nclause = \"2\"\n{keys}\n");
        let rows = [
            row("quantity = \"control_section\"\nvalue = 1000"),
            row("quantity = \"std\"\nfactor = 0.25\nvalue = 5\ntext = \"in words\"\npantographs = [2, 4]"),
        ];
        let assessment = crate::standards::typed(&rows.concat());
        let text = Explanation::of("Manual", &assessment).text();
        assert!(text.contains("≥ 1000 m [S]"), "{text}");
        assert!(
            text.contains("≤ 5 N + 0.25 times the mean force of the run [S]"),
            "{text}"
        );
    }

    #[test]
    fn a_figure_is_found_by_each_of_its_names() {
        for name in ["std", "σ", "Standard deviation"] {
            let found = Explanation::of(name, &Assessment::default());
            assert_eq!(found.words.len(), 1, "{name}");
            assert!(found.text().contains("1/n Σ (Fᵢ − mean)²"), "{}", found.text());
        }
        let mut names: Vec<String> = glossary()
            .iter()
            .flat_map(|word| word.names)
            .map(|name| name.to_lowercase())
            .collect();
        let all = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), all, "a name stands for one thing");
    }

    #[test]
    fn a_key_is_found_by_path_by_name_with_numbers_and_by_its_table() {
        let found = |typed: &str| Explanation::of(typed, &Assessment::default());
        for typed in [
            "run.low_pass_hz",
            "low_pass_hz",
            "pantograph[2].static_force",
            "catenary.contact_wire",
        ] {
            assert!(!found(typed).keys.is_empty(), "{typed}");
        }
        let key = &found("run.speed_kmh").keys[0];
        assert!(
            key.text().contains("run.speed_kmh [km/h]\n  Speed of the train."),
            "{}",
            key.text()
        );
        assert!(found("catenary.contact_wire").keys.len() > 3);
    }
}
