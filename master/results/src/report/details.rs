//! Tables of the contact force in detail: by band, by stretch of track, loss by loss, and of heights and uplift.

use super::format::{decimals, or_dash};
use super::label::NamedRun;
use super::{PageColumn, cells, escape, heads, saved};
use crate::detail::QUANTILES;
use crate::statistics::{Band, ForceStatistics, Loss, LossClass, Stretch};
use crate::{DropperRow, PantographSummary, Summary, SupportUplift};

/// Losses of contact that a page lists; the summary has them all.
const LISTED: usize = 200;

/// Droppers that a page lists.
const LISTED_DROPPERS: usize = 1000;

/// A pantograph of one of the runs.
struct Head<'a> {
    /// Run and pantograph, where there are several, as HTML.
    name: String,
    summary: &'a Summary,
    pantograph: &'a PantographSummary,
}

fn all<'a>(runs: &'a [NamedRun<'_>]) -> Vec<Head<'a>> {
    let mut found = Vec::new();
    for run in runs {
        let summary = &run.summary;
        for (number, pantograph) in (1..).zip(&summary.pantographs) {
            let mut parts = Vec::new();
            if runs.len() > 1 {
                parts.push(escape(&run.label));
            }
            if summary.pantographs.len() > 1 {
                parts.push(format!("pantograph {number}"));
            }
            let name = parts.join(", ");
            found.push(Head {
                name,
                summary,
                pantograph,
            });
        }
    }
    found
}

/// A row: name of run and pantograph as HTML, and an entry.
struct Row<T> {
    name: String,
    entry: T,
}

/// Column of the names.
const fn named<T>() -> PageColumn<Row<T>> {
    ("", "", "", |row| row.name.clone())
}

/// Rows as a table that is saved as `file`; nothing where there is none. The first column holds the names, and is left
/// out where there are none.
fn table_of<T>((title, file): (&str, &str), rows: &[Row<T>], columns: &[PageColumn<Row<T>>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let first = usize::from(rows.iter().all(|row| row.name.is_empty()));
    let columns = &columns[first..];
    let lines = rows.iter().map(|row| cells(columns, row));
    format!("<h3>{title}</h3>\n{}", saved(file, &heads(columns), lines))
}

/// [`table_of`] the entries of each pantograph.
fn table<'a, T>(
    title: (&str, &str),
    of: &'a [Head<'a>],
    entries: impl Fn(&'a Head<'a>) -> Vec<T>,
    columns: &[PageColumn<Row<T>>],
) -> String {
    let rows = of.iter().flat_map(|head| {
        let named = |entry| Row {
            name: head.name.clone(),
            entry,
        };
        entries(head).into_iter().map(named).collect::<Vec<_>>()
    });
    table_of(title, &rows.collect::<Vec<_>>(), columns)
}

fn millimetres(value: Option<f64>) -> String {
    decimals(value.map(|value| 1e3 * value), 1)
}

fn force<T>(of: Option<ForceStatistics>, figure: fn(&ForceStatistics) -> T) -> Option<T> {
    of.as_ref().map(figure)
}

/// Bands, quantiles and the other filter.
pub(super) fn bands(runs: &[NamedRun<'_>]) -> String {
    let heads = all(runs);
    type Entry = (Band, Option<f64>);
    let columns: [PageColumn<Row<Entry>>; 4] = [
        named(),
        ("band", "[Hz]", "s", |row| {
            format!("{} to {}", row.entry.0.from_hz, row.entry.0.to_hz)
        }),
        ("σ", "[N]", "n", |row| decimals(row.entry.0.std, 2)),
        ("share of σ²", "[%]", "n", |row| {
            decimals(
                row.entry
                    .0
                    .std
                    .zip(row.entry.1)
                    .map(|(band, all)| 100.0 * (band / all).powi(2)),
                1,
            )
        }),
    ];
    let entries = |head: &Head<'_>| {
        let std = force(head.pantograph.contact_force.filtered, |force| force.std);
        let bands = head.pantograph.detail.bands.iter();
        bands.map(|band| (*band, std.filter(|std| *std > 0.0))).collect()
    };
    let mut html = table(
        ("Standard deviation by frequency band", "bands"),
        &heads,
        entries,
        &columns,
    );
    if !html.is_empty() {
        html.push_str(
            "<p class=\"caption\">Filters without delay, of order 4 each way; a band is what the filter of its upper \
             end leaves, less what the filter of its lower end leaves of that. Neighbouring bands add up to the whole; \
             their variances up to the share that both pass around the end in common. Shares are of the variance of \
             the filtered force.</p>\n",
        );
    }
    html + &quantiles(&heads) + &filters(&heads)
}

fn quantiles(of_heads: &[Head<'_>]) -> String {
    type Entry = [Option<f64>; QUANTILES.len()];
    const fn column(name: &'static str, of: fn(&Row<Entry>) -> String) -> PageColumn<Row<Entry>> {
        (name, "[N]", "n", of)
    }
    let columns: [PageColumn<Row<Entry>>; 8] = [
        named(),
        column("1 %", |row| decimals(row.entry[0], 1)),
        column("5 %", |row| decimals(row.entry[1], 1)),
        column("25 %", |row| decimals(row.entry[2], 1)),
        column("50 %", |row| decimals(row.entry[3], 1)),
        column("75 %", |row| decimals(row.entry[4], 1)),
        column("95 %", |row| decimals(row.entry[5], 1)),
        column("99 %", |row| decimals(row.entry[6], 1)),
    ];
    let entries = |head: &Head<'_>| {
        let quantiles = &head.pantograph.detail.quantiles;
        let of = |percent: f64| quantiles.iter().find(|quantile| quantile.percent == percent);
        let values = QUANTILES.map(|percent| of(percent).map(|quantile| quantile.value));
        if quantiles.is_empty() { Vec::new() } else { vec![values] }
    };
    let title = "Filtered force that a share of the time lies below";
    table((title, "quantiles"), of_heads, entries, &columns)
}

/// Statistics of one of several forces, and its error in % of the standard deviation of another one.
type Compared = (&'static str, ForceStatistics, Option<f64>);

/// Columns of forces beside each other, which are named under `what`; the error stands last.
fn compared(what: &'static str) -> [PageColumn<Row<Compared>>; 7] {
    [
        named(),
        (what, "", "", |row| row.entry.0.to_owned()),
        ("mean", "[N]", "n", |row| format!("{:.2}", row.entry.1.mean)),
        ("σ", "[N]", "n", |row| format!("{:.2}", row.entry.1.std)),
        ("max", "[N]", "n", |row| format!("{:.2}", row.entry.1.max)),
        ("min", "[N]", "n", |row| format!("{:.2}", row.entry.1.min)),
        ("rms error", "[% of σ]", "n", |row| decimals(row.entry.2, 2)),
    ]
}

/// Contact force as instruments measure it beside the true one.
pub(super) fn measured(runs: &[NamedRun<'_>]) -> String {
    let of_heads = all(runs);
    let entries = |head: &Head<'_>| -> Vec<Compared> {
        let both = head
            .pantograph
            .measured
            .as_ref()
            .zip(head.pantograph.contact_force.filtered);
        both.map_or_else(Vec::new, |(measured, force)| {
            vec![
                ("contact force", force, None),
                ("measured", measured.filtered, measured.error_percent_of_std),
            ]
        })
    };
    let title = (
        "Contact force, and as load cells and accelerometers measure it",
        "measured",
    );
    let mut html = table(title, &of_heads, entries, &compared("force"));
    let mut said: Vec<(String, String)> = Vec::new();
    for head in &of_heads {
        let Some(measured) = &head.pantograph.measured else {
            continue;
        };
        let gains = measured
            .gains
            .iter()
            .map(|gain| format!("{:.3} at {} Hz", gain.gain, gain.frequency_hz));
        let gains = gains.collect::<Vec<_>>().join(", ");
        if said.iter().all(|(_, other)| *other != gains) {
            said.push((head.name.clone(), gains));
        }
    }
    if !said.is_empty() {
        html.push_str(
            "<p class=\"caption\">F = Σ F<sub>cell</sub> + Σ m a, with the instruments of [measurement]. Measured over \
             true force of a head held still:</p>\n",
        );
    }
    let several = said.len() > 1;
    for (name, gains) in said {
        let name = if several { format!("{name}: ") } else { String::new() };
        html.push_str(&format!("<p class=\"caption\">{name}{gains}.</p>\n"));
    }
    html
}

/// Droppers at rest, folded: lengths and forces for the workshop.
pub(super) fn droppers(runs: &[NamedRun<'_>]) -> String {
    const COLUMNS: [PageColumn<DropperRow>; 6] = [
        ("tension length", "", "n", |row| row.tension_length.to_string()),
        ("span", "", "n", |row| row.span.to_string()),
        ("dropper", "", "n", |row| row.number.to_string()),
        ("place", "[m]", "n", |row| format!("{:.3}", row.x_m)),
        ("length", "[m]", "n", |row| format!("{:.4}", row.length_m)),
        ("force at rest", "[N]", "n", |row| format!("{:.1}", row.force_n)),
    ];
    // Runs over one page mostly share their line.
    let Some(run) = runs.iter().find(|run| !run.record.line.droppers.is_empty()) else {
        return String::new();
    };
    let rows = &run.record.line.droppers;
    let first = usize::from(rows.iter().all(|row| row.tension_length == 1));
    let lines = rows
        .iter()
        .take(LISTED_DROPPERS)
        .map(|row| cells(&COLUMNS[first..], row));
    let more = match rows.len().saturating_sub(LISTED_DROPPERS) {
        0 => String::new(),
        more => format!("<p class=\"caption\">{more} further droppers: master check writes them all.</p>\n"),
    };
    let of = if runs.len() > 1 {
        format!(" of {}", escape(&run.label))
    } else {
        String::new()
    };
    format!(
        "<details><summary>{} droppers{of}: unstressed lengths and forces at rest</summary>\n{}{more}</details>\n",
        rows.len(),
        saved("droppers", &heads(&COLUMNS[first..]), lines)
    )
}

/// Figures by both filters.
fn filters(of_heads: &[Head<'_>]) -> String {
    let entries = |head: &Head<'_>| -> Vec<Compared> {
        let own =
            (head.pantograph.contact_force.filtered).map(|force| (head.summary.evaluation.filter.text(), force, None));
        let other = head.pantograph.detail.other_filter;
        let other = other.map(|other| (other.filter.text(), other.filtered, None));
        // One line alone compares nothing.
        own.zip(other).map_or_else(Vec::new, |(own, other)| vec![own, other])
    };
    table(
        ("Filtered by run.filter, and by the other filter", "filters"),
        of_heads,
        entries,
        &compared("filter")[..6],
    )
}

const STRETCH: [PageColumn<Row<Stretch>>; 9] = [
    named(),
    ("number", "", "n", |row| row.entry.number.to_string()),
    ("from", "[m]", "n", |row| format!("{:.1}", row.entry.from_m)),
    ("to", "[m]", "n", |row| format!("{:.1}", row.entry.to_m)),
    ("mean", "[N]", "n", |row| {
        decimals(force(row.entry.filtered, |force| force.mean), 1)
    }),
    ("σ", "[N]", "n", |row| {
        decimals(force(row.entry.filtered, |force| force.std), 1)
    }),
    ("max", "[N]", "n", |row| {
        decimals(force(row.entry.filtered, |force| force.max), 1)
    }),
    ("min", "[N]", "n", |row| {
        decimals(force(row.entry.filtered, |force| force.min), 1)
    }),
    ("loss", "[%]", "n", |row| decimals(row.entry.loss_of_contact_percent, 2)),
];

/// Figures by span, tension length and pantograph.
pub(super) fn stretches(runs: &[NamedRun<'_>]) -> String {
    let heads = all(runs);
    let spans = |head: &Head<'_>| head.pantograph.detail.spans.clone();
    let lengths = |head: &Head<'_>| head.pantograph.detail.tension_lengths.clone();
    [
        table(("Span", "spans"), &heads, spans, &STRETCH),
        table(("Tension length", "tension-lengths"), &heads, lengths, &STRETCH),
        followers(runs),
    ]
    .concat()
}

/// Difference of each following pantograph from the leading one.
fn followers(runs: &[NamedRun<'_>]) -> String {
    let heads = all(runs);
    type Entry = [Option<f64>; 4];
    let columns: [PageColumn<Row<Entry>>; 5] = [
        named(),
        ("mean", "[N]", "n", |row| signed(row.entry[0], 1)),
        ("σ", "[%]", "n", |row| signed(row.entry[1], 1)),
        ("max", "[N]", "n", |row| signed(row.entry[2], 1)),
        ("loss", "[%]", "n", |row| signed(row.entry[3], 2)),
    ];
    let entries = |head: &Head<'_>| -> Vec<Entry> {
        let [leading, following @ ..] = head.summary.pantographs.as_slice() else {
            return Vec::new();
        };
        if !following.iter().any(|other| std::ptr::eq(other, head.pantograph)) {
            return Vec::new();
        }
        let [first, own] = [leading, head.pantograph].map(|head| &head.contact_force);
        let both = first.filtered.zip(own.filtered);
        vec![[
            both.map(|(first, own)| own.mean - first.mean),
            both.map(|(first, own)| 100.0 * (own.std / first.std - 1.0)),
            both.map(|(first, own)| own.max - first.max),
            first
                .loss_of_contact_percent
                .zip(own.loss_of_contact_percent)
                .map(|(first, own)| own - first),
        ]]
    };
    table(
        ("Following pantographs less the leading one", "following"),
        &heads,
        entries,
        &columns,
    )
}

/// Number with its sign.
fn signed(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(
        || "–".to_owned(),
        |value| format!("{value:+.digits$}").replace('-', "−"),
    )
}

/// Losses of contact: by duration, and one by one.
pub(super) fn losses(runs: &[NamedRun<'_>]) -> String {
    let heads = all(runs);
    if heads.iter().all(|head| head.pantograph.detail.losses.is_empty()) {
        return String::new();
    }
    let classes: [PageColumn<Row<LossClass>>; 4] = [
        named(),
        ("duration", "[ms]", "s", |row| {
            let from = 1e3 * row.entry.from_s;
            row.entry.below_s.map_or_else(
                || format!("{from:.0} and longer"),
                |to| format!("{from:.0} to {:.0}", 1e3 * to),
            )
        }),
        ("losses", "", "n", |row| row.entry.count.to_string()),
        ("share of the time", "[%]", "n", |row| {
            format!("{:.3}", row.entry.percent)
        }),
    ];
    let list: [PageColumn<Row<Loss>>; 5] = [
        named(),
        ("begins", "[s]", "n", |row| format!("{:.3}", row.entry.start)),
        ("lasts", "[ms]", "n", |row| format!("{:.1}", 1e3 * row.entry.duration)),
        ("place", "[m]", "n", |row| format!("{:.2}", row.entry.x)),
        ("span", "", "n", |row| or_dash(row.entry.span)),
    ];
    let listed = |head: &Head<'_>| head.pantograph.detail.losses.iter().take(LISTED).copied().collect();
    let mut html = table(
        ("By duration", "losses-by-duration"),
        &heads,
        |head| head.pantograph.detail.loss_classes.clone(),
        &classes,
    ) + &table(("One by one", "losses"), &heads, listed, &list);
    html.push_str(&format!(
        "<p class=\"caption\">Samples without force, between two with force: an arc would burn there. Arcing NQ counts \
         those of 5 ms and longer. At most {LISTED} are listed here for each pantograph, all of them in \
         summary.json.</p>\n"
    ));
    html
}

/// Uplift at the supports, and height of the contact.
pub(super) fn heights(runs: &[NamedRun<'_>]) -> String {
    let supports: [PageColumn<Row<SupportUplift>>; 5] = [
        named(),
        ("support", "", "n", |row| row.entry.number.to_string()),
        ("place", "[m]", "n", |row| decimals(row.entry.x_m, 1)),
        ("largest uplift", "[mm]", "n", |row| millimetres(row.entry.max_m)),
        ("at", "[s]", "n", |row| decimals(row.entry.time_s, 3)),
    ];
    let rows = runs.iter().flat_map(|run| {
        let name = if runs.len() > 1 {
            escape(&run.label)
        } else {
            String::new()
        };
        let supports = run.summary.uplift.supports.iter();
        supports.map(move |support| Row {
            name: name.clone(),
            entry: *support,
        })
    });
    let html = table_of(("Uplift", "uplift"), &rows.collect::<Vec<_>>(), &supports);
    let heads = all(runs);
    let columns: [PageColumn<Row<crate::ContactHeight>>; 5] = [
        named(),
        ("mean", "[m]", "n", |row| format!("{:.4}", row.entry.mean_m)),
        ("highest", "[m]", "n", |row| format!("{:.4}", row.entry.max_m)),
        ("lowest", "[m]", "n", |row| format!("{:.4}", row.entry.min_m)),
        ("largest gradient", "[‰]", "n", |row| {
            decimals(row.entry.gradient_permille, 2)
        }),
    ];
    let entries = |head: &Head<'_>| head.pantograph.detail.contact_height.into_iter().collect();
    html + &table(
        (
            "Height of the contact wire where it is touched, filtered",
            "contact-height",
        ),
        &heads,
        entries,
        &columns,
    )
}
