//! Tables of current, arcs and wear.

use wear::{Arc, HeadFigures, WireFigures};

use super::format::{decimals, round_count, short};
use super::label::NamedRun;
use super::{PageColumn, cells, escape, heads, saved};
use crate::Summary;

/// Arcs that a page lists; the summary has them all.
const LISTED: usize = 200;

/// Passages that worn areas are given for.
const MANY: f64 = 1e6;

/// A row: name of run and pantograph as HTML, and an entry.
struct Row<'a, T> {
    name: String,
    entry: &'a T,
}

/// Column of the names.
const fn named<'a, T>() -> PageColumn<Row<'a, T>> {
    ("", "", "", |row| row.name.clone())
}

/// Area of one passage in mm² of [`MANY`].
fn area(area: f64) -> Option<f64> {
    Some(1e6 * MANY * area)
}

/// Current, arcs and wear of the runs; nothing where no scene gives a current.
pub(super) fn section(runs: &[NamedRun<'_>]) -> String {
    let mut of_heads: Vec<Row<'_, HeadFigures>> = Vec::new();
    let mut of_wires: Vec<Row<'_, WireFigures>> = Vec::new();
    let mut of_arcs: Vec<Row<'_, Arc>> = Vec::new();
    for run in runs {
        let Some(train) = &run.summary.wear else { continue };
        let label = if runs.len() > 1 {
            escape(&run.label)
        } else {
            String::new()
        };
        for (number, head) in (1..).zip(&train.pantographs) {
            let name = match label.is_empty() {
                true => format!("pantograph {number}"),
                false => format!("{label}, pantograph {number}"),
            };
            let row = |arc| Row {
                name: name.clone(),
                entry: arc,
            };
            of_arcs.extend(head.arcs.iter().map(row));
            of_heads.push(Row { name, entry: head });
        }
        of_wires.extend(train.wire.as_ref().map(|entry| Row { name: label, entry }));
    }
    if of_heads.is_empty() {
        return String::new();
    }
    let mut html = electrical(&of_heads) + &arcs(&of_arcs) + &wires(&of_wires) + &strips(&of_heads);
    html.push_str(
        "<p class=\"caption\">Over the evaluation range, with the law and the current of [wear]; the current is held, \
         during arcs too. Passages to the limit count on the same wear in each, master wear simulates the worn \
         line.</p>\n",
    );
    html
}

fn electrical(rows: &[Row<'_, HeadFigures>]) -> String {
    let columns: [PageColumn<Row<'_, HeadFigures>>; 9] = [
        named(),
        ("current", "[A]", "n", |row| short(Some(row.entry.current_a))),
        ("resistance", "[mΩ]", "n", |row| {
            decimals(row.entry.mean_resistance_ohm.map(|ohm| 1e3 * ohm), 3)
        }),
        ("largest", "[mΩ]", "n", |row| {
            decimals(row.entry.largest_resistance_ohm.map(|ohm| 1e3 * ohm), 3)
        }),
        ("drop", "[V]", "n", |row| decimals(row.entry.mean_drop_v, 3)),
        ("power", "[W]", "n", |row| decimals(row.entry.mean_power_w, 1)),
        ("arcs", "", "n", |row| row.entry.arcs.len().to_string()),
        ("time with an arc", "[%]", "n", |row| {
            decimals(Some(row.entry.arc_percent), 3)
        }),
        ("their energy", "[J]", "n", |row| {
            decimals(Some(row.entry.arc_energy_j), 1)
        }),
    ];
    let lines = rows.iter().map(|row| cells(&columns, row));
    format!("<h3>Current</h3>\n{}", saved("current", &heads(&columns), lines))
}

fn arcs(rows: &[Row<'_, Arc>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let columns: [PageColumn<Row<'_, Arc>>; 6] = [
        named(),
        ("begin after the first sample", "[s]", "n", |row| {
            format!("{:.3}", row.entry.begin_s)
        }),
        ("place", "[m]", "n", |row| format!("{:.2}", row.entry.x_m)),
        ("duration", "[ms]", "n", |row| {
            format!("{:.1}", 1e3 * row.entry.duration_s)
        }),
        ("voltage", "[V]", "n", |row| format!("{:.1}", row.entry.voltage_v)),
        ("energy", "[J]", "n", |row| format!("{:.2}", row.entry.energy_j)),
    ];
    let lines = rows.iter().take(LISTED).map(|row| cells(&columns, row));
    let more = match rows.len().saturating_sub(LISTED) {
        0 => String::new(),
        more => format!("<p class=\"caption\">{more} further arcs: summary.json has them all.</p>\n"),
    };
    format!("<h3>Arcs</h3>\n{}{more}", saved("arcs", &heads(&columns), lines))
}

fn wires(rows: &[Row<'_, WireFigures>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let columns: [PageColumn<Row<'_, WireFigures>>; 8] = [
        named(),
        ("friction", "[mm²/10⁶]", "n", |row| {
            short(area(row.entry.area_m2.mechanical))
        }),
        ("heat", "[mm²/10⁶]", "n", |row| short(area(row.entry.area_m2.joule))),
        ("arcs", "[mm²/10⁶]", "n", |row| short(area(row.entry.area_m2.arc))),
        ("all", "[mm²/10⁶]", "n", |row| short(area(row.entry.area_m2.sum()))),
        ("largest", "[mm²/10⁶]", "n", |row| {
            short(area(row.entry.largest_area_m2))
        }),
        ("at", "[m]", "n", |row| format!("{:.1}", row.entry.largest_x_m)),
        ("passages to the limit there", "", "n", |row| {
            round_count(row.entry.life_passages)
        }),
    ];
    let lines = rows.iter().map(|row| cells(&columns, row));
    format!(
        "<h3>Worn area of the contact wire by 10⁶ passages</h3>\n{}",
        saved("wire-wear", &heads(&columns), lines)
    )
}

fn strips(rows: &[Row<'_, HeadFigures>]) -> String {
    if rows.iter().all(|row| row.entry.strip.is_none()) {
        return String::new();
    }
    let columns: [PageColumn<Row<'_, HeadFigures>>; 5] = [
        named(),
        ("worn volume", "[mm³/km]", "n", |row| {
            short(row.entry.strip.map(|strip| 1e12 * strip.volume_m3_per_m.sum()))
        }),
        ("worn width", "[m]", "n", |row| {
            decimals(row.entry.strip.map(|strip| strip.worn_width_m), 2)
        }),
        ("height", "[mm/1000 km]", "n", |row| {
            short(row.entry.strip.map(|strip| 1e9 * strip.height_per_m))
        }),
        ("life", "[km]", "n", |row| {
            round_count(row.entry.strip.and_then(|strip| strip.life_m).map(|life| 1e-3 * life))
        }),
    ];
    let lines = rows.iter().map(|row| cells(&columns, row));
    format!(
        "<h3>Most worn strip of each head</h3>\n{}",
        saved("strip-wear", &heads(&columns), lines)
    )
}

/// Lines of the table on the terminal; none where the scene gives no current.
pub(super) fn lines(summary: &Summary) -> String {
    let Some(train) = &summary.wear else {
        return String::new();
    };
    let mut text = String::from("\n");
    for (number, head) in (1..).zip(&train.pantographs) {
        text.push_str(&format!(
            "  current {number}: {} A, contact {} mΩ, {} V, {} W; {} arcs, {:.3} % of the time, {:.1} J\n",
            head.current_a,
            decimals(head.mean_resistance_ohm.map(|ohm| 1e3 * ohm), 3),
            decimals(head.mean_drop_v, 3),
            decimals(head.mean_power_w, 1),
            head.arcs.len(),
            head.arc_percent,
            head.arc_energy_j,
        ));
        if let Some(strip) = head.strip {
            text.push_str(&format!(
                "  strip of pantograph {number}: {} mm in 1000 km, lasts {} km\n",
                short(Some(1e9 * strip.height_per_m)),
                round_count(strip.life_m.map(|life| 1e-3 * life)),
            ));
        }
    }
    if let Some(wire) = &train.wire {
        text.push_str(&format!(
            "  contact wire: {} mm² in 10⁶ passages, friction {}, heat {}, arcs {}; most {} at {:.1} m, {} passages to \
             the limit\n",
            short(area(wire.area_m2.sum())),
            short(area(wire.area_m2.mechanical)),
            short(area(wire.area_m2.joule)),
            short(area(wire.area_m2.arc)),
            short(area(wire.largest_area_m2)),
            wire.largest_x_m,
            round_count(wire.life_passages),
        ));
    }
    text
}
