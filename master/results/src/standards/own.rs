//! Limits that the user enters, in place of those that the program knows, and the editions that count.

use scene::{Assessment, Electrification, LimitBound, LimitRow, Mark};

use super::{Bound, Certainty, Limit, system_unknown};

/// Power supply, speed in km/h, and number of pantographs.
pub(super) type Case = (Option<Electrification>, f64, usize);

/// The limits of the editions that count, those of `assessment` in the places of `known` ones, each decided.
///
/// A known limit stays where no row is for the case.
pub(super) fn assessed(known: Vec<Limit>, assessment: &Assessment, case: Case) -> Vec<Limit> {
    let counts = |edition: &str| assessment.editions.is_empty() || assessment.editions.iter().any(|own| own == edition);
    let mut all: Vec<Limit> = known
        .iter()
        .filter(|limit| counts(&limit.edition_name()))
        .cloned()
        .collect();
    let rows = assessment.limits.iter().filter(|row| counts(&row.standard));
    for rows in by_limit(rows) {
        let (standard, quantity) = (rows[0].name(), rows[0].quantity.name());
        let mut entered: Vec<Limit> = Vec::new();
        for of in known.iter().filter(|limit| limit.quantity == quantity) {
            if entered.iter().all(|limit| limit.pantograph != of.pantograph) {
                entered.push(limit(&rows, of, &known, (assessment, case)));
            }
        }
        let holds = rows.iter().any(|row| beside(row, case).is_none());
        for limit in entered {
            let same = |other: &Limit| {
                other.standard == standard && other.quantity == quantity && other.pantograph == limit.pantograph
            };
            match all.iter().position(same) {
                Some(place) if holds => all[place] = limit,
                Some(_) => {}
                None => all.push(limit),
            }
        }
    }
    all.iter_mut().for_each(Limit::decide);
    all
}

/// Rows of the same standard and quantity together, in the order in which they stand.
fn by_limit<'a>(rows: impl Iterator<Item = &'a LimitRow>) -> Vec<Vec<&'a LimitRow>> {
    let mut groups: Vec<Vec<&LimitRow>> = Vec::new();
    for row in rows {
        let same = |group: &&mut Vec<&LimitRow>| group[0].name() == row.name() && group[0].quantity == row.quantity;
        match groups.iter_mut().find(same) {
            Some(group) => group.push(row),
            None => groups.push(vec![row]),
        }
    }
    groups
}

/// Why a row does not hold for a case; nothing where it does.
fn beside(row: &LimitRow, (system, speed, pantographs): Case) -> Option<String> {
    match (row.system, system) {
        (Some(_), None) => return Some(system_unknown()),
        (Some(of), Some(system)) if !of.holds(system) => return Some(format!("is for {of}")),
        _ => {}
    }
    let up_to = row.up_to_kmh.unwrap_or(f64::INFINITY);
    if speed <= row.above_kmh && row.above_kmh > 0.0 || speed > up_to {
        return Some("is for other speeds".to_owned());
    }
    let [fewest, most] = row.pantographs.unwrap_or([0, usize::MAX]);
    (pantographs < fewest || pantographs > most).then(|| "is for another number of pantographs".to_owned())
}

/// The limit of the first row that holds, for the quantity and pantograph of `of`.
fn limit(rows: &[&LimitRow], of: &Limit, known: &[Limit], (assessment, case): (&Assessment, Case)) -> Limit {
    let source = assessment.source.as_deref().unwrap_or("[assessment] of the scene");
    let row = rows.iter().find(|row| beside(row, case).is_none()).unwrap_or(&rows[0]);
    let edition = row.standard.rsplit_once(':').map_or("", |(_, edition)| edition);
    let mut limit = Limit::new((row.name(), edition, &row.clause), &of.quantity, of.value, &of.unit);
    limit.pantograph = of.pantograph;
    limit.certainty = certainty(row.mark);
    limit.source = Some(source.to_owned());
    limit.bound = bound(row.bound.unwrap_or_else(|| row.quantity.bound()));
    if let Some(why) = beside(row, case) {
        let why = match rows.len() {
            1 => format!("the row of {source} {why}"),
            count => format!("none of the {count} rows of {source} is for this power supply, speed and number"),
        };
        return limit.not_applicable(why);
    }
    if !of.applicable && of.value.is_none() {
        return limit.not_applicable(of.reason.clone());
    }
    let (_, speed, _) = case;
    let constant = row.value.unwrap_or(0.0) + row.speed_squared * speed * speed;
    let reference = match row.factor {
        None => Some(0.0),
        Some(factor) => reference(&of.quantity, of.pantograph, known).map(|value| factor * value),
    };
    limit.limit = reference.map(|part| constant + part);
    let parts = [
        (row.speed_squared != 0.0).then(|| format!("{} v²", row.speed_squared)),
        row.value
            .filter(|value| *value != 0.0)
            .map(|value| format!("{value} {}", of.unit)),
        row.factor
            .zip(row.quantity.reference())
            .map(|(factor, name)| format!("{factor} times {name}")),
    ];
    // A number alone stands in its column.
    if row.speed_squared != 0.0 || row.factor.is_some() {
        limit.formula = parts.into_iter().flatten().collect::<Vec<_>>().join(" + ");
    }
    let formula = match (limit.formula.as_str(), row.speed_squared != 0.0) {
        ("", _) => None,
        (formula, false) => Some(formula.to_owned()),
        (formula, true) => Some(format!("{formula} at v = {speed:.1} km/h")),
    };
    let said = row.text.clone().into_iter().chain(formula).collect::<Vec<_>>();
    limit.because(source).remark(said.join("; "))
}

/// Value that a factor multiplies: mean force for the standard deviation, uplift for the space that it needs.
fn reference(quantity: &str, pantograph: Option<usize>, known: &[Limit]) -> Option<f64> {
    let (of, pantograph) = match quantity {
        "std" => ("mean", pantograph),
        _ => ("uplift", None),
    };
    let limit = known
        .iter()
        .find(|limit| limit.quantity == of && limit.pantograph == pantograph);
    let value = limit.and_then(|limit| limit.value);
    // A wire that only sinks needs no space.
    value.map(|value| value.max(0.0))
}

fn certainty(mark: Mark) -> Certainty {
    match mark {
        Mark::Standard => Certainty::Standard,
        Mark::Cited => Certainty::Cited,
        Mark::Remembered => Certainty::Remembered,
        Mark::Measured | Mark::Chosen | Mark::Calibrated => Certainty::Chosen,
    }
}

fn bound(bound: LimitBound) -> Bound {
    match bound {
        LimitBound::AtMost => Bound::AtMost,
        LimitBound::Below => Bound::Below,
        LimitBound::AtLeast => Bound::AtLeast,
        LimitBound::Above => Bound::Above,
        LimitBound::Equal => Bound::Equal,
    }
}
