//! Changes between cases, published and computed.

use serde::{Serialize, Serializer};

use super::judge::Line;
use super::plan::Mesh;
use super::published::{CASES, Case};
use super::verdict::{Verdict, judge};

/// A change from one case to another on one mesh, %.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Relation {
    /// From which case.
    #[serde(serialize_with = "title")]
    pub from: &'static Case,
    /// To which case.
    #[serde(serialize_with = "title")]
    pub to: &'static Case,
    /// On which mesh.
    #[serde(serialize_with = "mesh_name")]
    pub mesh: Mesh,
    /// `mean` or `std`.
    pub of: &'static str,
    /// Published change, %.
    pub published: f64,
    /// Computed change, %; nothing where a case has no figures.
    pub computed: Option<f64>,
    /// Verdict of the computed change on the published one.
    pub verdict: Verdict,
    /// Reason of the verdict, with its figures.
    pub why: String,
}

pub(super) fn title<S: Serializer>(case: &&'static Case, serializer: S) -> Result<S::Ok, S::Error> {
    case.title.serialize(serializer)
}

pub(super) fn mesh_name<S: Serializer>(mesh: &Mesh, serializer: S) -> Result<S::Ok, S::Error> {
    mesh.name().serialize(serializer)
}

/// Pairs of cases whose difference the thesis discusses.
pub(super) const PAIRS: [(usize, usize); 3] = [(0, 1), (0, 2), (2, 3)];

/// The changes on every mesh on which the cases were run.
pub(super) fn relations(lines: &[Line]) -> Vec<Relation> {
    let mut found = Vec::new();
    for mesh in Mesh::ALL {
        for (from, to) in PAIRS.map(|(from, to)| (&CASES[from], &CASES[to])) {
            let (Some(first), Some(second)) = (Line::of(lines, from, mesh), Line::of(lines, to, mesh)) else {
                continue;
            };
            let change = |from: f64, to: f64| 100.0 * (to / from - 1.0);
            let (was, is) = (&first.row, &second.row);
            for (of, [published_was, published_is], computed) in [
                ("mean", [from.mean, to.mean], was.mean.zip(is.mean)),
                ("std", [from.std, to.std], was.std.zip(is.std)),
            ] {
                let published = change(published_was.value, published_is.value);
                let computed = computed.map(|(was, is)| change(was, is));
                let (verdict, why) = judge(published, computed);
                found.push(Relation {
                    from,
                    to,
                    mesh,
                    of,
                    published,
                    computed,
                    verdict,
                    why,
                });
            }
        }
    }
    found
}
