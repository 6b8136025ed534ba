//! The table on the terminal.

use super::Comparison;
use crate::engine::Table as _;
use crate::engine::export::{TextColumn, fixed, heading, status_word, text_cells, wrapped};
use crate::engine::table::{RunRow, Status, milliseconds, short};
use results::report::aligned;

/// Columns of the table.
const COLUMNS: &[TextColumn<RunRow, 2>] = &[
    (["", ""], |row| format!("  {}", row.algorithm)),
    (["macro", "ms"], |row| milliseconds(row.macro_step)),
    (["micro", "ms"], |row| milliseconds(row.micro_step)),
    (["", "status"], |row| status_word(row.status).to_owned()),
    (["filtered", "rms % σ"], |row| short(row.filtered_error)),
    (["", "order"], |row| fixed(row.order, 1)),
    (["raw", "rms % σ"], |row| short(row.raw_error)),
    (["σ", "%"], |row| short(row.std_error)),
    (["loss", "%"], |row| {
        row.loss.map_or_else(|| "–".to_owned(), |loss| format!("{loss:.2}"))
    }),
    (["energy", "J"], |row| short(row.energy_residual)),
    (["wall", "s"], |row| {
        row.wall.map_or_else(|| "–".to_owned(), |wall| format!("{wall:.2}"))
    }),
    (["roll-", "backs"], |row| {
        row.rollbacks.map_or_else(|| "–".to_owned(), |count| count.to_string())
    }),
];

/// The table of a comparison, no wider than 120 columns.
#[must_use]
pub fn text(comparison: &Comparison) -> String {
    let mut text = comparison.scene.clone();
    if !comparison.title.is_empty() {
        text.push_str(&format!(": {}", comparison.title));
    }
    text.push('\n');
    if !comparison.complete {
        let (made, _) = comparison.made();
        text.push_str(&format!("INCOMPLETE: {made} of {} runs\n", comparison.rows.len()));
    }
    let mut rows = heading(COLUMNS);
    let mut mode = "";
    for row in &comparison.rows {
        if row.mode != mode {
            mode = &row.mode;
            rows.push(vec![format!("{mode}:")]);
        }
        rows.push(text_cells(COLUMNS, row));
    }
    text.push('\n');
    text.push_str(&aligned(&rows));
    text.push_str(
        "\n  Errors: rms of force against position over the evaluation range, in percent of the reference's σ \
         (filtered); the\n  \
         reference is the monolithic run at the same micro step. Order: between a macro step and the next smaller \
         one.\n  \
         Energy: what the coupling added.\n",
    );
    for note in &comparison.notes {
        text.push_str(&format!("  {note}\n"));
    }
    for row in &comparison.rows {
        let said = matches!(row.status, Some(Status::Limit | Status::Diverged | Status::Refused));
        if said {
            let step = row.macro_step.map(|step| format!(" {} ms", milliseconds(Some(step))));
            let step = step.unwrap_or_default();
            let algorithm = if row.algorithm.is_empty() { "" } else { " " };
            text.push_str(&wrapped(&format!(
                "{}{algorithm}{}{step}: {}",
                row.mode, row.algorithm, row.reason
            )));
        }
    }
    text
}
