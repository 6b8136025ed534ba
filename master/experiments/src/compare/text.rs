//! The table on the terminal.

use super::Comparison;
use crate::engine::export::{grouped, scene_head, status_word};
use crate::engine::table::RunRow;
use results::report::format::{decimals, fixed, milliseconds, or_dash, short, wrapped};
use results::report::{TextColumn, aligned, grouped_table};

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
    (["loss", "%"], |row| decimals(row.loss, 2)),
    (["energy", "J"], |row| short(row.energy_residual)),
    (["wall", "s"], |row| decimals(row.wall, 2)),
    (["roll-", "backs"], |row| or_dash(row.rollbacks)),
];

/// The table of a comparison, no wider than 120 columns.
pub(super) fn text(comparison: &Comparison) -> String {
    let mut text = scene_head(&comparison.scene, &comparison.title, comparison);
    let modes = grouped(comparison.rows.iter().map(|row| (row.mode.clone(), row)));
    text.push('\n');
    text.push_str(&aligned(&grouped_table(COLUMNS, modes)));
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
    for row in comparison.rows.iter().filter(|row| row.trouble().is_some()) {
        let step = row.macro_step.map(|step| format!("{} ms", milliseconds(Some(step))));
        let run = [row.mode.as_str(), &row.algorithm, step.as_deref().unwrap_or_default()];
        let run: Vec<&str> = run.into_iter().filter(|word| !word.is_empty()).collect();
        text.push_str(&wrapped(&format!("{}: {}", run.join(" "), row.reason)));
    }
    text
}
