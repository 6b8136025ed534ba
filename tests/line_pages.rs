//! Pages, tables and pictures of `master check` for all shipped scenes.
use integration_tests::fmus::tree;
use integration_tests::lines::shipped_scene;
use results::report::LinePage;
use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;

/// Shipped scenes with a line of their own each, and a picture in the documents. Variants of one line are left out.
const DRAWN: [&str; 11] = [
    "ac-stitched",
    "as-built",
    "conductor-rail",
    "curve",
    "dc-twin-wire",
    "en50318-2018-ac-simple",
    "en50318-250",
    "overlap",
    "thesis-own-mesh",
    "tram-single-wire",
    "walk",
];

/// Panels of every page.
const PANELS: [&str; 4] = ["elevation", "contact-wire", "plan", "elasticity"];

/// A coarse mesh: pages and pictures do not depend on its accuracy.
const COARSE: [&str; 1] = ["catenary.mesh.elements_per_interval=1"];

/// Page of a shipped scene, with keys.
fn page(name: &str, keys: &[&str]) -> LinePage {
    let scene = shipped_scene(name, keys);
    let prepared = simulation::prepare(scene, name, &tree().join("scenes"), false).unwrap();
    let report = simulation::check::Report::of(&prepared).unwrap();
    simulation::check_page::page(&prepared, &report).unwrap()
}

/// Pages of [`DRAWN`], solved once for all tests.
static PAGES: LazyLock<Vec<LinePage>> = LazyLock::new(|| DRAWN.iter().map(|name| page(name, &COARSE)).collect());

/// Refuses a text whose elements do not close in the order in which they open.
fn assert_balanced(name: &str, html: &str) {
    const VOID: [&str; 3] = ["meta", "br", "!DOCTYPE"];
    let mut open = Vec::new();
    let mut rest = html;
    while let Some(start) = rest.find('<') {
        rest = &rest[start + 1..];
        let end = rest
            .find('>')
            .unwrap_or_else(|| panic!("{name}: <{rest:.60} does not end"));
        let (tag, after) = (&rest[..end], &rest[end + 1..]);
        let element = tag.trim_start_matches('/').split([' ', '\n']).next().unwrap();
        rest = after;
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(element), "{name}: </{element}>");
        } else if !tag.ends_with('/') && !VOID.contains(&element) {
            open.push(element);
            // Signs within scripts and styles are no tags.
            if ["script", "style"].contains(&element) {
                rest = &rest[rest.find(&format!("</{element}>")).expect("an end")..];
            }
        }
    }
    assert!(open.is_empty(), "{name}: {open:?}");
}

/// Numbers in a text, and the text around them.
fn numbers(text: &str) -> (Vec<f64>, Vec<&str>) {
    let is_number = |c: char| c.is_ascii_digit() || c == '.';
    let found = text.split(|c| !is_number(c)).filter_map(|number| number.parse().ok());
    (
        found.collect(),
        text.split(is_number).filter(|part| !part.is_empty()).collect(),
    )
}

fn picture_of(name: &str) -> PathBuf {
    tree().join("docs/scenes/pictures").join(format!("{name}.svg"))
}

#[test]
fn the_page_of_every_line_has_each_panel_balanced_elements_and_a_small_size() {
    for (name, page) in DRAWN.into_iter().zip(PAGES.iter()) {
        let html = page.render();
        assert_balanced(name, &html);
        for panel in PANELS {
            assert!(html.contains(&format!("id=\"panel-{panel}\"")), "{name}: {panel}");
        }
        for heading in ["Limits", "Line", "Supports", "Droppers", "Wires", "Elasticity", "Model"] {
            assert!(html.contains(&format!("<h2>{heading}</h2>")), "{name}: {heading}");
        }
        assert_eq!(
            html.contains("panel-dropper-forces"),
            !page.droppers.is_empty(),
            "{name}"
        );
        assert_eq!(html.contains("panel-curvature"), name == "curve", "{name}");
        assert!(!html.contains("NaN") && !html.contains("inf\""), "{name}");
        assert!(!html.contains("src=") && !html.contains("id=\"plotly\""), "{name}");
        assert!((25_000..250_000).contains(&html.len()), "{name}: {} bytes", html.len());
        // The first section is the verdict.
        assert!(html.find("Verdict:") < html.find("<svg"), "{name}");

        assert_eq!(page.droppers_csv().lines().count(), 1 + page.droppers.len(), "{name}");
        assert_eq!(page.supports_csv().lines().count(), 1 + page.supports.len(), "{name}");
        // Forces that hold the line aside add up to nothing on a straight track.
        let lateral: Option<Vec<f64>> = page.supports.iter().map(|support| support.arm_lateral).collect();
        if let Some(lateral) = lateral.filter(|_| page.curvature.is_empty()) {
            let largest = lateral.iter().fold(0.0_f64, |largest, force| largest.max(force.abs()));
            // Wires at an angle to the track pull at the ends of the line; droppers lean between the wires.
            assert!(
                lateral.iter().sum::<f64>().abs() <= 0.2 * largest + 1e-6,
                "{name}: {lateral:?}"
            );
        }
    }
}

#[test]
fn pictures_in_the_documents_are_those_of_the_scenes() {
    let update = std::env::var_os("UPDATE_PICTURES").is_some();
    let list = fs::read_to_string(tree().join("docs/scenes/README.md")).unwrap();
    for (name, page) in DRAWN.into_iter().zip(PAGES.iter()) {
        let picture = page.picture();
        assert_balanced(name, &picture);
        assert!(picture.len() < 60_000, "{name}: {} bytes", picture.len());
        assert!(
            list.contains(&format!("(pictures/{name}.svg)")),
            "{name} is not in the list of scenes"
        );
        let path = picture_of(name);
        if update {
            fs::write(&path, &picture).unwrap();
        }
        let committed = fs::read_to_string(&path).unwrap_or_default();
        let ((new, around), (old, around_old)) = (numbers(&picture), numbers(&committed));
        let advice = "UPDATE_PICTURES=1 cargo test --release -p integration-tests --test all line_pages writes it anew";
        let differs = |(a, b): (&f64, &f64)| (a - b).abs() > 2.0;
        // Coordinates are whole; another processor may round them to the other side.
        let same = new.len() == old.len() && around.len() == around_old.len() && !new.iter().zip(&old).any(differs);
        assert!(same, "{}: {advice}", path.display());
    }
}

#[test]
fn a_long_line_is_drawn_around_its_evaluated_spans_and_says_so() {
    let keys = [
        "catenary.spans=1000",
        "run.evaluate={ spans=[501, 510] }",
        "run.duration=445",
        "model.reduce=[\"planar\", \"window\"]",
        COARSE[0],
    ];
    let page = page("en50318-250", &keys);
    let html = page.render();
    assert_balanced("long", &html);
    assert!(html.contains("Spans 406 to 605 of 1000 are shown"));
    assert!(html.len() < 250_000, "{} bytes", html.len());
    assert_eq!(page.droppers_csv().lines().count(), 9001);
    assert_eq!(page.supports_csv().lines().count(), 1002);
    assert!(page.picture().len() < 60_000);
}

#[test]
fn a_wide_line_is_drawn_within_the_picture() {
    let keys = [
        "catenary.stagger=[0.55, -0.55]",
        "catenary.spans=6",
        "run.evaluate={ spans=[2, 4] }",
        "run.duration=3.2",
        COARSE[0],
    ];
    let page = page("en50318-250", &keys);
    let html = page.render();
    assert_balanced("wide", &html);
    assert!(html.contains(">550<") && html.contains(">−550<"));
    let picture = page.picture();
    let (_, drawing) = picture.split_once("</style>").unwrap();
    let (numbers, _) = numbers(drawing);
    // The picture is 2000 units wide.
    assert!(numbers.iter().all(|number| *number <= 2000.0));
}
