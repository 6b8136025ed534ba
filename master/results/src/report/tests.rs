use std::io::Read as _;

use base64::Engine as _;

use super::*;
use crate::{RunBundle, Summary, tests::run};

fn bundle(complete: bool) -> RunBundle {
    let (info, record) = run(complete);
    RunBundle {
        summary: Summary::new(&info, &record),
        record,
        scene: "a = \"<b>\"".to_owned(),
    }
}

/// The page, with the data that it has packed behind it.
fn unpacked(page: &str) -> String {
    let mut text = page.to_owned();
    for script in page.split("<script type=\"text/plain\" class=\"figure\"").skip(1) {
        let packed = script.split(['>', '<']).nth(1).unwrap();
        let bytes = base64::engine::general_purpose::STANDARD.decode(packed).unwrap();
        flate2::read::GzDecoder::new(&bytes[..])
            .read_to_string(&mut text)
            .unwrap();
    }
    text
}

#[test]
fn the_page_holds_every_section_and_loads_nothing() {
    let page = render(&[bundle(true)]);
    for id in [
        "plot-force",
        "plot-uplift",
        "plot-spectrum",
        "plot-histogram",
        "id=\"player\"",
    ] {
        assert!(page.contains(id), "{id}");
    }
    for heading in ["Limits", "What was modelled", "Cost", "Animation"] {
        assert!(page.contains(&format!("<h2>{heading}</h2>")), "{heading}");
    }
    assert!(!page.contains("<script src") && !page.contains("<link"));
    // plotly.js once, packed, and nothing that is as large as it.
    assert!(page.len() < 700_000, "{} bytes", page.len());
}

#[test]
fn the_wind_is_drawn_where_it_was_recorded_only() {
    let mut bundle = bundle(true);
    assert!(!render(std::slice::from_ref(&bundle)).contains("plot-wind"));
    bundle.record.pantographs[0].wind = Some(crate::WindRecord {
        drag: vec![172.53; bundle.record.time.len()],
        lift: vec![69.01; bundle.record.time.len()],
    });
    let page = unpacked(&render(&[bundle]));
    assert!(page.contains("plot-wind") && page.contains("172.53") && page.contains("69.01"));
}

#[test]
fn the_page_tells_where_and_when_contact_was_lost_and_how_spans_and_bands_compare() {
    let page = render(&[bundle(true)]);
    for part in [
        "spans",
        "losses",
        "losses-by-duration",
        "following",
        "bands",
        "quantiles",
        "filters",
        "uplift",
    ] {
        assert!(page.contains(&format!("data-csv=\"{part}\"")), "{part}");
    }
    // Half of the samples of the second pantograph have no force: more losses than a page lists.
    assert!(page.contains("At most 200 are listed"));
    assert_eq!(page.matches("<td class=\"n\">1.0</td>").count(), 200);
}

#[test]
fn a_limit_that_fails_says_why_and_what_helps_at_the_top_of_the_page() {
    let page = render(&[failing()]);
    let top = &page[..page.find("<h2>Key figures</h2>").unwrap()];
    for part in [
        "FAILS",
        "0.3 of the mean",
        "remedy: a lower speed",
        "limits hold</summary>",
    ] {
        assert!(top.contains(part), "{part}");
    }
}

#[test]
fn the_packed_library_is_the_one_that_its_note_names() {
    let mut text = String::new();
    let mut packed = flate2::read::GzDecoder::new(&include_bytes!("assets/plotly-basic.min.js.gz")[..]);
    packed.read_to_string(&mut text).unwrap();
    let version = "3.0.1";
    assert!(text.contains(&format!("plotly.js (basic - minified) v{version}")));
    assert!(include_str!("assets/README.md").contains(version));
    assert!(plotly::Plot::offline_js_sources().contains(&format!("plotly.js v{version}")));
}

#[test]
fn text_of_the_scene_cannot_become_markup() {
    let page = render(&[bundle(true)]);
    assert!(page.contains("A &lt;sample&gt; &amp; more"));
    assert!(!page.contains("<sample>"));
    assert!(page.contains("a = &quot;&lt;b&gt;&quot;"));
    assert_eq!(escape("<a href='x'>&\""), "&lt;a href=&#39;x&#39;&gt;&amp;&quot;");
    assert_eq!(escape("a\u{1b}[1m\u{7}\tb\n"), "a\\u{1b}[1m\\u{7}\tb\n");
}

#[test]
fn several_runs_are_overlaid_under_their_names() {
    let mut other = bundle(true);
    other.summary.mode = "cosimulation".to_owned();
    let page = unpacked(&render(&[bundle(true), other]));
    assert!(page.contains("filtered 20 Hz, sample (monolithic), pantograph 1"));
    assert!(page.contains("filtered 20 Hz, sample (cosimulation), pantograph 2"));
    assert_eq!(page.matches("id=\"plot-force\"").count(), 1);
}

#[test]
fn an_incomplete_run_says_so_on_the_page_and_in_the_table() {
    let bundle = bundle(false);
    let page = render(std::slice::from_ref(&bundle));
    assert!(page.contains("did not reach its end: diverged at t = 0.5 s"));
    assert!(table(&bundle.summary).contains("INCOMPLETE: diverged at t = 0.5 s"));
}

#[test]
fn an_empty_record_still_gives_a_page() {
    let mut empty = bundle(false);
    empty.record = crate::Record::default();
    assert!(render(&[empty]).contains("incomplete"));
    assert!(render(&[]).contains("No run"));
}

#[test]
fn the_columns_of_the_table_are_aligned() {
    let text = table(&bundle(true).summary);
    let ends: Vec<usize> = text
        .lines()
        .filter(|line| line.contains("pantograph 1, 20 Hz") || line.contains("pantograph 2, 20 Hz"))
        .map(|line| line.chars().count())
        .collect();
    assert_eq!(ends.len(), 2);
    assert_eq!(ends[0], ends[1]);
    assert!(text.contains("real-time factor 0.500"));
    assert!(text.contains("note: coarse mesh"));
}

#[test]
fn table_and_page_say_what_the_time_loop_was_spent_on_the_largest_share_first() {
    let bundle = bundle(true);
    let line = "pantograph[1] 79.5 %, catenary 20.0 %, master 0.5 %";
    assert!(table(&bundle.summary).contains(&format!("  time loop: {line}\n")));
    assert!(render(std::slice::from_ref(&bundle)).contains(line));
    let mut unmeasured = bundle;
    unmeasured.summary.cost.shares.clear();
    assert!(!table(&unmeasured.summary).contains("time loop:"));
}

#[test]
fn table_and_page_say_which_limits_do_not_apply_and_what_to_set() {
    let bundle = bundle(true);
    let text = table(&bundle.summary);
    // Mean force from above and from below and the maximum, of both pantographs, share one reason.
    assert_eq!(text.matches("set run.electrification to one of").count(), 1);
    assert!(text.contains("not applicable: the space at the steady arm is not given"));
    let page = render(std::slice::from_ref(&bundle));
    for part in [
        "2012, Table 6 (TSI ENE 4.2.11)",
        "set run.electrification to one of",
        "[R] remembered and not verified",
        "&lt; 30.00",
        "≤ 120.00",
    ] {
        assert!(page.contains(part), "{part}");
    }
}

/// A run whose pantographs have too large a standard deviation.
fn failing() -> RunBundle {
    let mut bundle = bundle(true);
    for limit in bundle.summary.limits.iter_mut().filter(|limit| limit.quantity == "std") {
        (limit.value, limit.pass) = (Some(40.0), Some(false));
    }
    bundle
}

/// A summary is a file that anybody may have written.
#[test]
fn regress_35_a_unit_of_any_length_makes_neither_table_nor_page_panic() {
    for unit in [
        "é".repeat(100_000),
        "\u{1f682}".repeat(70_000),
        "m".repeat(1 << 20),
        String::new(),
    ] {
        let mut bundle = failing();
        for limit in &mut bundle.summary.limits {
            limit.unit.clone_from(&unit);
        }
        assert!(!table(&bundle.summary).is_empty());
        assert!(render(std::slice::from_ref(&bundle)).starts_with("<!DOCTYPE html>"));
    }
}

#[test]
fn table_and_page_open_with_the_verdict_and_the_failed_limits_first() {
    let bundle = failing();
    let text = table(&bundle.summary);
    let lines: Vec<&str> = text.lines().collect();
    let of = |wanted: Option<bool>| {
        bundle
            .summary
            .limits
            .iter()
            .filter(|limit| limit.pass == wanted)
            .count()
    };
    let (failed, held) = (of(Some(false)), of(Some(true)));
    assert!(failed > 1 && held > 1, "{text}");
    assert!(
        lines[1].starts_with(&format!("Verdict: {failed} limits fail, {held} hold, ")),
        "{text}"
    );
    // Remembered figures are told before the table.
    let head = lines
        .iter()
        .position(|line| line.trim_start().starts_with("limit "))
        .unwrap();
    assert!(
        lines[2..head]
            .iter()
            .any(|line| line.contains("remembered, not verified")),
        "{text}"
    );
    let verdicts: Vec<&str> = lines[head + 1..head + 1 + failed + held]
        .iter()
        .map(|line| if line.contains("FAIL") { "FAIL" } else { "pass" })
        .collect();
    assert!(verdicts[..failed].iter().all(|verdict| *verdict == "FAIL"), "{text}");
    assert!(verdicts[failed..].iter().all(|verdict| *verdict == "pass"), "{text}");
    let at = |word: &str| text.find(word).unwrap_or_else(|| panic!("no {word} in\n{text}"));
    assert!(at("Verdict") < at("contact force [N]") && at("contact force [N]") < at("modelled: 120 coordinates"));
    assert!(text.contains("not modelled: wind wires"), "{text}");

    let page = render(std::slice::from_ref(&bundle));
    let at = |word: &str| page.find(word).unwrap_or_else(|| panic!("no {word}"));
    let headings = ["Verdict", "Key figures", "Contact force", "Limits", "What was modelled"];
    let places = headings.map(|heading| at(&format!("<h2>{heading}</h2>")));
    assert!(places.is_sorted(), "{places:?}");
    assert!(at("FAILS</b>") < at(">holds</b>"));
    assert!(page.contains("<title>A &lt;sample&gt; &amp; more – Pantoline</title>"));
}

#[test]
fn the_margin_is_the_room_left_in_percent_of_the_limit() {
    let mut limits = bundle(true).summary.limits;
    let mut said = |value: f64, bound: crate::standards::Bound, limit: f64, pass: bool| {
        let one = &mut limits[0];
        (one.value, one.limit, one.bound, one.pass) = (Some(value), Some(limit), bound, Some(pass));
        one.unit = "N".to_owned();
        verdict::margin(one)
    };
    use crate::standards::Bound::{Above, AtLeast, AtMost, Below, Equal};
    assert_eq!(said(75.0, AtMost, 100.0, true), "+25.0 %");
    assert_eq!(said(120.0, Below, 100.0, false), "−20.0 %");
    assert_eq!(said(150.0, AtLeast, 100.0, true), "+50.0 %");
    assert_eq!(said(-7.5, Above, 0.0, false), "−7.50 N");
    assert_eq!(said(20.0, Equal, 20.0, true), "–");
    assert_eq!(said(25.0, Equal, 20.0, false), "−25.0 %");
}

#[test]
fn failed_limits_are_said_with_value_unit_and_limit() {
    let mut summary = failing().summary;
    let failed = failed_limits(&summary);
    assert!(failed.iter().any(|said| said.ends_with("N (< 30.00)")), "{failed:?}");
    // A dash behind a number would read as a minus.
    summary.limits.iter_mut().for_each(|limit| limit.unit = "–".to_owned());
    let failed = failed_limits(&summary);
    assert!(
        !failed.is_empty() && failed.iter().all(|said| !said.contains('–')),
        "{failed:?}"
    );
    summary.limits.iter_mut().for_each(|limit| limit.pass = None);
    assert!(failed_limits(&summary).is_empty());
    assert!(table(&summary).contains("Verdict: no limit is decided"));
}

/// Runs of one scene with these texts.
fn of_scenes(texts: [&str; 2]) -> Vec<RunBundle> {
    texts
        .map(|scene| RunBundle {
            scene: scene.to_owned(),
            ..bundle(true)
        })
        .to_vec()
}

#[test]
fn runs_on_one_page_are_named_by_what_differs() {
    let usual = "[run]\nspeed_kmh = 180\n[[pantograph]]\nstatic_force = 70\nstart = { height = 5.1 }\n";
    let mut runs = of_scenes([usual, usual]);
    assert_eq!(labels(&runs), ["sample, run 1", "sample, run 2"]);
    assert_eq!(labels(&runs[..1]), ["sample (monolithic)"]);

    runs[1].summary.evaluation.speed = 200.0 / 3.6;
    runs[1].scene = usual.replace("180", "200").replace("5.1", "5.2");
    assert_eq!(labels(&runs), ["sample (180 km/h)", "sample (200 km/h)"]);

    runs[1].summary.mode = "inprocess".to_owned();
    runs[1].summary.coupling.algorithm = "jacobi".to_owned();
    assert_eq!(labels(&runs)[1], "sample (inprocess, jacobi, 200 km/h)");

    let runs = of_scenes([usual, &usual.replace("static_force = 70", "static_force = 90")]);
    let key = "pantograph[1].static_force";
    assert_eq!(
        labels(&runs),
        [format!("sample ({key} = 70)"), format!("sample ({key} = 90)")]
    );

    let other = "a = 1\nb = 2\nc = 3\nd = 4\n";
    let runs = of_scenes([usual, other]);
    assert_eq!(labels(&runs)[0], "sample (5 keys differ), run 1");
    let mut runs = of_scenes([usual, other]);
    runs[1].summary.scene = "other".to_owned();
    assert_eq!(labels(&runs), ["sample", "other"]);
}
