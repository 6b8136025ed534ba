//! Panels over the track.

use std::fmt::Write as _;

use super::panel::{Panel, Scale, said};
use super::{LinePage, PageWire, PageWireKind};

/// Digits of 1/1000 mm/N.
const ELASTICITY_PER: f64 = 1e4;

/// All panels with their controls.
pub(super) fn section(page: &LinePage) -> String {
    let panels = [
        elevation(page),
        contact_wire(page),
        plan(page),
        curvature(page),
        dropper_forces(page),
        elasticity(page),
    ];
    format!(
        "<div class=\"controls\" hidden>\n\
         <button type=\"button\" data-zoom=\"in\" aria-label=\"Zoom in\">+</button>\
         <button type=\"button\" data-zoom=\"out\" aria-label=\"Zoom out\">−</button>\
         <button type=\"button\" data-zoom=\"all\">Whole line</button>\
         <button type=\"button\" data-zoom=\"evaluated\">Evaluated spans</button>\n\
         <span class=\"place\" aria-live=\"polite\"></span>\n</div>\n{}\
         <div class=\"track\" tabindex=\"0\" role=\"group\" aria-label=\"Line over the track\" \
         data-from=\"{}\" data-evaluated=\"{} {}\" data-span=\"{}\">\n\
         <div class=\"inner\">\n<div class=\"cursor\" hidden></div>\n{}{}</div>\n</div>\n\
         <p class=\"caption keys\">Keys: ← and → to the next mast or dropper, + and − zoom, 0 the whole line, Home and \
         End. Shaded: evaluated spans. Heights and lateral positions are stretched.</p>\n",
        legend(page),
        page.shown.from,
        page.evaluated.from,
        page.evaluated.to,
        page.shown.first,
        panels.concat(),
        axis(page)
    )
}

/// Class of the colour of a tension length; colours are used again from the sixth on.
pub(super) fn colour(tension_length: usize) -> String {
    format!("t{}", (tension_length + 4) % 5 + 1)
}

fn class(wire: &PageWire) -> String {
    let kind = match wire.kind {
        PageWireKind::Contact => "contact",
        PageWireKind::Messenger => "messenger",
        PageWireKind::Stitch => "stitch",
    };
    format!("wire {kind} {}", colour(wire.tension_length))
}

fn legend(page: &LinePage) -> String {
    let mut keys = String::new();
    let mut key = |class: &str, text: &str| {
        let _ = write!(keys, "<span><i class=\"{class}\"></i>{text}</span>");
    };
    let several = page
        .supports
        .iter()
        .map(|support| support.tension_length)
        .max()
        .unwrap_or(1);
    if several > 1 {
        for number in 1..=several {
            key(
                &format!("contact {}", colour(number)),
                &format!("tension length {number}"),
            );
        }
    }
    let has = |kind: PageWireKind| page.wires.iter().any(|wire| wire.kind == kind);
    key("contact", "contact wire");
    if has(PageWireKind::Messenger) {
        key("messenger", "messenger wire");
    }
    if has(PageWireKind::Stitch) {
        key("stitch", "stitch wire");
    }
    if !page.droppers.is_empty() {
        key("dropper", "dropper");
    }
    if page.droppers.iter().any(super::PageDropper::is_slack) {
        key("slack", "slack dropper");
    }
    if !page.masses.is_empty() {
        key("mass", "point mass");
    }
    if !page.half_widths.is_empty() {
        key("strip", "end of the strip");
    }
    format!("<p class=\"legend\">{keys}</p>\n")
}

/// Wires that have the same class and name, in their order.
fn groups(wires: &[PageWire]) -> Vec<Vec<&PageWire>> {
    let mut groups: Vec<Vec<&PageWire>> = Vec::new();
    // Contact wires last: they are drawn over the others.
    let contact = |wire: &&PageWire| wire.kind == PageWireKind::Contact;
    let others = wires.iter().filter(|wire| !contact(wire));
    for wire in others.chain(wires.iter().filter(contact)) {
        match groups.iter_mut().find(|group| group[0].name == wire.name) {
            Some(group) => group.push(wire),
            None => groups.push(vec![wire]),
        }
    }
    groups
}

/// Draws values along wires, each group of wires as one curve.
fn wires(panel: &mut Panel, wires: &[PageWire], tolerance: f64, value: impl Fn(&PageWire, usize) -> f64) {
    for group in groups(wires) {
        let pieces: Vec<Vec<(f64, f64)>> = group
            .iter()
            .map(|wire| {
                let points = wire.points.iter().enumerate();
                points.map(|(number, point)| (point[0], value(wire, number))).collect()
            })
            .collect();
        let pieces = pieces.iter().map(Vec::as_slice);
        panel.curve(&class(group[0]), &group[0].name, tolerance, pieces);
    }
}

fn elevation(page: &LinePage) -> String {
    let shown = |x: f64| page.shown.contains(x);
    let heights = page.wires.iter().flat_map(|wire| &wire.points);
    let heights = heights.filter(|point| shown(point[0])).map(|point| point[2]);
    let scale = Scale::of(heights, 0.5, 1000.0, 3);
    let mut panel = Panel::new(page, ["elevation", "Elevation", "height above rail, m"], 260, scale);
    let line = |dropper: &super::PageDropper| [dropper.top, dropper.bottom].map(|[x, _, z]| (x, z));
    let (slack, tight): (Vec<_>, Vec<_>) = page.droppers.iter().partition(|dropper| dropper.is_slack());
    panel.lines("dropper", tight.into_iter().map(line));
    panel.lines("slack", slack.into_iter().map(line));
    wires(&mut panel, &page.wires, 0.8 * coarseness(page), |wire, number| {
        wire.points[number][2]
    });
    panel.dots(
        "support",
        page.supports.iter().map(|support| (support.x, support.height)),
    );
    panel.dots("mass", page.masses.iter().map(|mass| (mass.at[0], mass.at[2])));
    for mass in &page.masses {
        panel.label("above", (mass.at[0], mass.at[2]), &format!("{} kg", mass.mass));
    }
    panel.finish()
}

/// Factor on the tolerances of curves: a long line is drawn in less detail, so that the page stays small.
fn coarseness(page: &LinePage) -> f64 {
    let spans = page.shown.last + 1 - page.shown.first;
    (spans as f64 / 40.0).max(1.0)
}

/// Contact wires of the page.
fn contact_wires(page: &LinePage) -> Vec<PageWire> {
    let contact = |wire: &&PageWire| wire.kind == PageWireKind::Contact;
    page.wires.iter().filter(contact).cloned().collect()
}

fn contact_wire(page: &LinePage) -> String {
    let contact = contact_wires(page);
    let shown = contact
        .iter()
        .flat_map(|wire| wire.points.iter().zip(&wire.above_chord))
        .filter(|(point, _)| page.shown.contains(point[0]));
    let scale = Scale::of(shown.map(|(_, above)| 1e3 * above), 4.0, 10.0, 1);
    let titles = [
        "contact-wire",
        "Contact wire",
        "height above the chord of the nominal heights at supports, mm",
    ];
    let mut panel = Panel::new(page, titles, 150, scale);
    wires(&mut panel, &contact, 1.2 * coarseness(page), |wire, number| {
        1e3 * wire.above_chord[number]
    });
    panel.finish()
}

fn plan(page: &LinePage) -> String {
    let lateral = page.wires.iter().flat_map(|wire| &wire.points);
    let lateral = lateral
        .filter(|point| page.shown.contains(point[0]))
        .map(|point| 1e3 * point[1]);
    let ends = page.half_widths.iter().flat_map(|half| [1e3 * half, -1e3 * half]);
    let scale = Scale::of(lateral.chain(ends), 100.0, 1.0, 0);
    let mut panel = Panel::new(page, ["plan", "Plan", "left of the track centre, mm"], 220, scale);
    let (from, to) = (page.shown.from, page.shown.to);
    panel.lines("centre", [[(from, 0.0), (to, 0.0)]]);
    for half in &page.half_widths {
        panel.lines("strip", [1e3, -1e3].map(|mm| [(from, mm * half), (to, mm * half)]));
    }
    wires(&mut panel, &page.wires, 0.7, |wire, number| {
        1e3 * wire.points[number][1]
    });
    panel.dots(
        "support",
        page.supports.iter().map(|support| (support.x, 1e3 * support.stagger)),
    );
    let mut last = None;
    for support in &page.supports {
        let here = (support.tension_length, support.stagger);
        if last.replace(here) == Some(here) {
            continue;
        }
        let stagger = 1e3 * support.stagger;
        let class = if stagger < 0.0 { "below" } else { "above" };
        panel.label(class, (support.x, stagger), &said(stagger, 0));
    }
    panel.finish()
}

fn curvature(page: &LinePage) -> String {
    if page.curvature.is_empty() {
        return String::new();
    }
    let per_km = |(x, value): &(f64, f64)| (*x, 1e3 * value);
    let all: Vec<Vec<(f64, f64)>> = page
        .curvature
        .iter()
        .map(|line| line.iter().map(per_km).collect())
        .collect();
    let values = all.iter().flatten().map(|(_, value)| *value).chain([0.0]);
    let scale = Scale::of(values, 0.05, 1e4, 3).with_room_above(0.3);
    let titles = [
        "curvature",
        "Curvature of the track",
        "1/km, positive with the middle to the left",
    ];
    let mut panel = Panel::new(page, titles, 100, scale);
    panel.lines("centre", [[(page.shown.from, 0.0), (page.shown.to, 0.0)]]);
    panel.curve("wire curvature", "curvature", 0.7, all.iter().map(Vec::as_slice));
    let mut last = None;
    for support in &page.supports {
        if let Some(radius) = support.radius.filter(|radius| last != Some(*radius)) {
            panel.label("above", (support.x, 1e3 / radius), &format!("R {}", said(radius, 0)));
        }
        last = support.radius;
    }
    panel.finish()
}

fn dropper_forces(page: &LinePage) -> String {
    if page.droppers.is_empty() {
        return String::new();
    }
    let shown = page
        .droppers
        .iter()
        .filter(|dropper| page.shown.contains(dropper.bottom[0]));
    let scale = Scale::of(shown.clone().map(|dropper| dropper.force).chain([0.0]), 10.0, 10.0, 1).with_zero();
    let mut panel = Panel::new(page, ["dropper-forces", "Forces of the droppers", "N"], 150, scale);
    let mut lengths: Vec<usize> = page.droppers.iter().map(|dropper| dropper.tension_length).collect();
    lengths.dedup();
    for number in lengths {
        let own = shown.clone().filter(|dropper| dropper.tension_length == number);
        let name = match page.supports.iter().any(|support| support.tension_length > 1) {
            true => format!("dropper of tension length {number}"),
            false => "dropper".to_owned(),
        };
        panel.bars(
            &format!("bar {}", colour(number)),
            &name,
            own.map(|dropper| (dropper.bottom[0], dropper.force)),
        );
    }
    let slack = shown.filter(|dropper| dropper.is_slack());
    panel.dots("slack", slack.map(|dropper| (dropper.bottom[0], 0.0)));
    panel.finish()
}

fn elasticity(page: &LinePage) -> String {
    if page.elasticity.is_empty() {
        return String::new();
    }
    let points: Vec<(f64, f64)> = page.elasticity.iter().map(|(x, rise)| (*x, 1e3 * rise)).collect();
    let rises = points.iter().map(|(_, rise)| *rise);
    let most = rises.clone().fold(0.0, f64::max);
    // A strip above the curve is left to the figures of the spans.
    let scale = Scale::of(rises, 0.1 * most, ELASTICITY_PER, 4).with_room_above(0.15);
    let titles = [
        "elasticity",
        "Elasticity and its non-uniformity u",
        "rise under 100 N, mm/N",
    ];
    let mut panel = Panel::new(page, titles, 150, scale);
    panel.curve("wire elasticity", "elasticity", 0.7, [points.as_slice()]);
    panel.dots("point", points.iter().copied());
    let high = scale.range[1];
    for span in &page.spans {
        let middle = 0.5 * (span.ends[0] + span.ends[1]);
        panel.label(
            "under",
            (middle, high),
            &format!("{} %", said(100.0 * span.non_uniformity, 1)),
        );
    }
    panel.finish()
}

/// Numbers and places of the masts.
fn axis(page: &LinePage) -> String {
    let masts: Vec<(usize, f64)> = (1..).zip(page.masts.iter().copied()).collect();
    let shown: Vec<_> = masts.into_iter().filter(|(_, x)| page.shown.contains(*x)).collect();
    let mut html = String::from("<div class=\"axis\"><div class=\"ticks\">mast<br>m</div><div class=\"labels\">\n");
    for (number, x) in shown {
        let left = 100.0 * (x - page.shown.from) / (page.shown.to - page.shown.from);
        let _ = writeln!(
            html,
            "<span style=\"left:{left:.2}%\">{number}<br>{}</span>",
            said(x, 0)
        );
    }
    html + "</div></div>\n"
}
