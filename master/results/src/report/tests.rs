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
    // plotly.js once, and nothing that is as large as it.
    assert!(page.len() < 6_000_000, "{} bytes", page.len());
}

#[test]
fn the_wind_is_drawn_where_it_was_recorded_only() {
    let mut bundle = bundle(true);
    assert!(!render(std::slice::from_ref(&bundle)).contains("plot-wind"));
    bundle.record.pantographs[0].wind = Some(crate::WindRecord {
        drag: vec![172.53; bundle.record.time.len()],
        lift: vec![69.01; bundle.record.time.len()],
    });
    let page = render(&[bundle]);
    assert!(page.contains("plot-wind") && page.contains("172.53") && page.contains("69.01"));
}

#[test]
fn text_of_the_scene_cannot_become_markup() {
    let page = render(&[bundle(true)]);
    assert!(page.contains("A &lt;sample&gt; &amp; more"));
    assert!(!page.contains("<sample>"));
    assert!(page.contains("a = &quot;&lt;b&gt;&quot;"));
    assert_eq!(escape("<a href='x'>&\""), "&lt;a href=&#39;x&#39;&gt;&amp;&quot;");
}

#[test]
fn several_runs_are_overlaid_under_their_names() {
    let mut other = bundle(true);
    other.summary.mode = "cosimulation".to_owned();
    let page = render(&[bundle(true), other]);
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
