//! Standard deviation over the plausible range of a quantity that the thesis leaves open.

use serde::Serialize;

use super::judge::Line;
use super::plan::{Mesh, RunGroup};
use super::published::Case;
use super::relation::{mesh_name, title};

/// One end of a range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct End {
    /// Standard deviation, N.
    #[serde(rename = "std_N")]
    pub std: f64,
    /// Value of the quantity that has it.
    pub at: String,
}

/// The standard deviations over the range of one quantity, on one mesh; the scene's own value is one of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Name.
    pub quantity: &'static str,
    /// The published case that it was changed in.
    #[serde(serialize_with = "title")]
    pub case: &'static Case,
    /// Mesh of the line.
    #[serde(serialize_with = "mesh_name")]
    pub mesh: Mesh,
    /// Its values, without the scene's own.
    pub values: Vec<String>,
    /// Smallest and largest standard deviation; nothing where no value has one.
    pub ends: Option<[End; 2]>,
    /// Number of values that have one.
    pub computed: usize,
}

/// Name of the scene's own value.
const OWN: &str = "the scene's own";

impl Spread {
    /// Spread of the runs that change one quantity on one mesh, and of the run of their case there.
    fn of(lines: &[&Line], own: Option<&Line>) -> Option<Self> {
        let first = lines.first()?;
        let end = |line: &&Line| {
            let std = line.row.std.filter(|std| std.is_finite())?;
            let at = if line.group == RunGroup::Open { &line.value } else { OWN };
            Some(End { std, at: at.to_owned() })
        };
        let mut ends: Vec<End> = lines.iter().filter_map(end).collect();
        let computed = ends.len();
        ends.extend(own.as_ref().and_then(end));
        ends.sort_by(|a, b| a.std.total_cmp(&b.std));
        // The scene's own value alone is no range.
        let ends = ends.first().cloned().zip(ends.last().cloned());
        Some(Self {
            quantity: first.quantity,
            case: first.case,
            mesh: first.mesh,
            values: lines.iter().map(|line| line.value.clone()).collect(),
            ends: ends.filter(|_| computed > 0).map(Into::into),
            computed,
        })
    }

    /// Smallest (0) or largest (1) standard deviation.
    pub(super) fn end(&self, which: usize) -> Option<&End> {
        Some(&self.ends.as_ref()?[which])
    }

    /// Smallest and largest standard deviation, N.
    pub(super) fn std(&self) -> Option<[f64; 2]> {
        let [low, high] = self.ends.as_ref()?;
        Some([low.std, high.std])
    }

    /// `true` where the published standard deviation of its case lies inside; nothing where no value has one.
    pub(super) fn holds_published(&self) -> Option<bool> {
        let [low, high] = self.std()?;
        Some((low..=high).contains(&self.case.std.value))
    }

    /// The verdict as the table names it.
    pub(super) fn verdict(&self) -> &'static str {
        match self.holds_published() {
            Some(true) => "inside",
            Some(false) => "outside",
            None => "not computed",
        }
    }

    /// Reason of the verdict, with its figures.
    pub(super) fn why(&self) -> String {
        let of = format!("{} of {} values computed", self.computed, self.values.len());
        let Some([low, high]) = &self.ends else {
            return of;
        };
        let [low, high] = [low, high].map(|end| format!("{:.2} N (at {})", end.std, end.at));
        let (published, verdict) = (self.case.std.printed(), self.verdict());
        format!("published {published} N is {verdict} {low} to {high}; {of}")
    }
}

/// All ranges, of every quantity on every mesh that it was changed on.
pub(super) fn spreads(lines: &[Line]) -> Vec<Spread> {
    let of_mesh = |mesh: Mesh| {
        let of = |line: &&Line| line.mesh == mesh && line.group == RunGroup::Open;
        let open: Vec<&Line> = lines.iter().filter(of).collect();
        let own = |open: &[&Line]| Line::of(lines, open.first()?.case, mesh);
        let of_quantity = open.chunk_by(|a, b| a.quantity == b.quantity);
        let spreads: Vec<Spread> = of_quantity.filter_map(|open| Spread::of(open, own(open))).collect();
        spreads
    };
    Mesh::ALL.into_iter().flat_map(of_mesh).collect()
}
