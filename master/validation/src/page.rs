//! `validation.html`.

use results::report::format::{decimals, or_dash};
use results::report::{Page, cell, escape, head_cells, saved, verdict_class, verdict_word};

use crate::measured::Measured;
use crate::record::{Record, Run};

fn number(value: Option<f64>, digits: usize) -> String {
    decimals(value, digits).replace('-', "−")
}

/// Measured figures beside those of the run as one system, and spectra of both.
fn measured(measured: &Measured, number_of_case: usize) -> String {
    let head = [
        ("figure", "", false),
        ("", "", false),
        ("measured", "", true),
        ("computed", "", true),
        ("unit", "", false),
        ("difference", "[%]", true),
        ("bound", "[%]", true),
    ];
    let lines = measured.figures.iter().map(|compared| {
        let (class, word) = (verdict_class(compared.pass), verdict_word(compared.pass));
        let mark = if compared.remembered { " [R]" } else { "" };
        let bound = or_dash(compared.bound_percent.map(|bound| format!("± {bound}{mark}")));
        cell("", compared.quantity.name())
            + &cell("s", &format!("<b class=\"{class}\">{word}</b>"))
            + &cell("n", &number(Some(compared.measured), 2))
            + &cell("n", &number(Some(compared.computed), 2))
            + &cell("", compared.unit)
            + &cell("n", &number(compared.difference_percent, 1))
            + &cell("n", &bound)
    });
    format!(
        "<h3>Measured</h3>\n{}<p class=\"caption\">Measurement: {}. Both forces filtered alike; of the measurement the \
         whole file, of the run the evaluation range. [R]: remembered, not verified.</p>\n{}",
        saved(&format!("measured-{number_of_case}"), &head_cells(head), lines),
        escape(&measured.source),
        measured.figure(number_of_case)
    )
}

fn table(run: &Run, index: usize) -> String {
    let modes = run.figures.first().map_or(&[][..], |found| &found.values);
    let head = [("figure", false), ("", false), ("from", true), ("to", true)].into_iter();
    let head = head
        .chain(modes.iter().map(|value| (value.mode, true)))
        .chain([("unit", false)]);
    let head = head_cells(head.map(|(name, is_number)| (name, "", is_number)));
    let lines = run.figures.iter().map(|found| {
        let (class, word) = (verdict_class(found.pass), verdict_word(found.pass));
        let values: String = found
            .values
            .iter()
            .map(|value| cell("n", &number(value.value, 2)))
            .collect();
        cell("", found.figure.name())
            + &cell("s", &format!("<b class=\"{class}\">{word}</b>"))
            + &cell("n", &number(found.low, 1))
            + &cell("n", &number(found.high, 1))
            + &values
            + &cell("", found.unit)
    });
    saved(&format!("case-{}", index + 1), &head, lines)
}

fn evidence(run: &Run) -> String {
    let mut html = String::new();
    if let Some(percent) = run.expected_error_percent {
        let shares = run
            .error_shares
            .iter()
            .map(|share| format!("{} {:.2}", share.cause.replace('_', " "), share.percent));
        html.push_str(&format!(
            "<p>Expected numerical error of the filtered force: <b>{percent:.2} %</b> of its standard deviation. <span \
             class=\"soft\">By cause, in %: {}.</span></p>\n",
            escape(&shares.collect::<Vec<_>>().join(", "))
        ));
    }
    for other in &run.coupling {
        html.push_str(&format!(
            "<p>{} against one system: {} % of the standard deviation, root mean square of the filtered forces.</p>\n",
            other.mode,
            number(other.filtered_percent, 4)
        ));
    }
    html + &format!(
        "<p class=\"caption\">Scene {}, SHA-256 of its resolved form <code>{}</code>.</p>\n",
        escape(&run.scene),
        run.scene_hash
    )
}

impl Record {
    /// The page.
    #[must_use]
    pub fn page(&self) -> String {
        let mut page = Page::new(&format!("Validation: {}", self.standard));
        let class = verdict_class(self.pass);
        page.lead(&format!(
            "<p>{} · Pantoline {} · {}</p>\n<p class=\"verdict {class}\">Verdict: {}</p>\n",
            escape(&self.standard),
            escape(&self.version),
            escape(&self.date),
            self.verdict()
        ));
        for (index, run) in self.cases.iter().enumerate() {
            let measured = run
                .measured
                .as_ref()
                .map_or_else(String::new, |of| measured(of, index + 1));
            let figures = if run.figures.is_empty() {
                String::new()
            } else {
                table(run, index)
            };
            page.section(&run.name, &(figures + &measured + &evidence(run)));
        }
        page.section(
            "Record",
            &format!(
                "<p>Ranges: {}.</p>\n<p class=\"caption\">Program, SHA-256 <code>{}</code>. File of the ranges, \
                 SHA-256 <code>{}</code>. Machine: {}. Date: {}.</p>\n",
                escape(&self.source),
                self.program,
                self.model,
                escape(&self.machine.name()),
                escape(&self.date)
            ),
        );
        page.finish()
    }
}
