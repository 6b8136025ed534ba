//! `validation.html`.

use results::report::{Page, cell, escape, head_cells, saved};

use crate::record::{Record, Run};

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.digits$}").replace('-', "−"))
}

fn table(run: &Run, index: usize) -> String {
    let modes = run.figures.first().map_or(&[][..], |found| &found.values);
    let head = [("figure", false), ("", false), ("from", true), ("to", true)].into_iter();
    let head = head
        .chain(modes.iter().map(|value| (value.mode, true)))
        .chain([("unit", false)]);
    let head = head_cells(head.map(|(name, is_number)| (name, "", is_number)));
    let lines = run.figures.iter().map(|found| {
        let (class, word) = if found.pass { ("good", "pass") } else { ("bad", "FAIL") };
        let values: String = found
            .values
            .iter()
            .map(|value| cell("n", &number(value.value, 2)))
            .collect();
        cell("", found.figure.name())
            + &cell("s", &format!("<b class=\"{class}\">{word}</b>"))
            + &cell("n", &number(Some(found.low), 1))
            + &cell("n", &number(Some(found.high), 1))
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
        let (class, verdict) = match self.pass {
            true => ("good", "every figure lies in its range, in every mode"),
            false => ("bad", "figures lie outside of their ranges"),
        };
        page.lead(&format!(
            "<p>{} · Pantoline {} · {}</p>\n<p class=\"verdict {class}\">Verdict: {verdict}</p>\n",
            escape(&self.standard),
            escape(&self.version),
            escape(&self.date)
        ));
        for (index, run) in self.cases.iter().enumerate() {
            page.section(&run.name, &(table(run, index) + &evidence(run)));
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
