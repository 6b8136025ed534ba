//! Page of `master check` on the line of a scene.

use catenary::{StaticLine, StaticsReport, gradients, non_uniformity};
use results::report::{LinePage, PageDropper, PageSpan, PageSupport, PageWire};
use scene::Scene;

use crate::check::Report;
use crate::{Prepared, evaluated_spans};

/// The line of a prepared scene as a page; none of a supplied line.
#[must_use]
pub fn page(prepared: &Prepared, report: &Report) -> Option<LinePage> {
    let line = prepared.statics.as_ref()?;
    let statics = report.statics.as_ref()?;
    let scene = &prepared.scene;
    Some(LinePage {
        title: scene.title.clone(),
        scene: prepared.name.clone(),
        speed_kmh: scene::kmh(scene.run.speed),
        wires: wires(line),
        droppers: droppers(scene, line, statics),
        supports: supports(scene, statics),
        elasticity: statics
            .elasticity
            .iter()
            .map(|point| (point.x, point.elasticity))
            .collect(),
        spans: spans(scene, statics),
        half_widths: half_widths(scene),
        tensions: tensions(scene, statics),
        model: report.model.clone(),
        notes: report.notes.clone(),
    })
}

fn wires(line: &StaticLine) -> Vec<PageWire> {
    let solved = line.line();
    let supports = solved.topology().supports();
    let wires = solved.topology().wires().iter().zip(solved.wires());
    let drawn = wires.map(|(planned, wire)| {
        let nodes = wire.geometry().nodes();
        PageWire {
            name: planned.label.replace('_', " "),
            contact: planned.name == catenary::WireName::ContactWire,
            points: match line.spans_of_short_line() {
                None => nodes.iter().map(|node| node.position.into()).collect(),
                Some(spans) => spans
                    .flat_map(|(span, shift)| {
                        let own = &nodes[supports[span]..=supports[span + 1]];
                        own.iter().map(move |node| moved(node.position.into(), shift))
                    })
                    .collect(),
            },
        }
    });
    drawn.collect()
}

/// A place moved along the track, m.
fn moved([x, y, z]: [f64; 3], way: f64) -> [f64; 3] {
    [x + way, y, z]
}

/// Number of each dropper of the line among the solved ones, and the way from there along the track, m.
fn solved_droppers(line: &StaticLine) -> Vec<(usize, f64)> {
    let places = line.line().topology().droppers();
    match line.spans_of_short_line() {
        None => (0..places.len()).map(|number| (number, 0.0)).collect(),
        Some(spans) => spans
            .flat_map(|(span, shift)| {
                let own = (0..places.len()).filter(move |&number| places[number].span == span + 1);
                own.map(move |number| (number, shift))
            })
            .collect(),
    }
}

fn droppers(scene: &Scene, line: &StaticLine, statics: &StaticsReport) -> Vec<PageDropper> {
    let Some((whole, _)) = scene.modelled_line() else {
        return Vec::new();
    };
    let solved = line.line().droppers().as_slice();
    let all = solved_droppers(line).into_iter().zip(&statics.droppers);
    let all = all.map(|((number, shift), report)| {
        let section = whole.section(report.tension_length - 1);
        PageDropper {
            tension_length: report.tension_length,
            span: report.span,
            number: report.dropper,
            position: report.x - section.support_x(report.span - 1),
            hangs_from: report.hangs_from.name(),
            top: moved(solved[number].upper.reference.into(), shift),
            bottom: moved(solved[number].lower.reference.into(), shift),
            length: report.length,
            force: report.force,
        }
    });
    all.collect()
}

fn supports(scene: &Scene, statics: &StaticsReport) -> Vec<PageSupport> {
    let Some((line, _)) = scene.modelled_line() else {
        return Vec::new();
    };
    let slopes = gradients(&statics.supports);
    let mut numbers = vec![0; line.tension_lengths.len()];
    let mut used_before = false;
    let all = statics
        .supports
        .iter()
        .zip(slopes)
        .enumerate()
        .map(|(i, (support, (gradient, change)))| {
            let section = line.section(support.tension_length - 1);
            let number = numbers[support.tension_length - 1];
            numbers[support.tension_length - 1] += 1;
            // Where another wire is lower, no strip runs on this one.
            let used = statics.supports.get(i + 1).is_some_and(|next| {
                let middle = 0.5 * (support.x + next.x);
                line.lowest_at(middle) == support.tension_length - 1
            });
            let both = used && used_before;
            used_before = used;
            PageSupport {
                tension_length: support.tension_length,
                number: number + 1,
                x: support.x,
                height: support.contact_wire_z,
                encumbrance: line.messenger_wire.is_some().then(|| section.encumbrance_at(number)),
                stagger: section.stagger_at(number),
                messenger_reaction: support.messenger_reaction,
                arm_force: support.arm_force,
                gradient: gradient.filter(|_| used),
                change: change.filter(|_| both),
            }
        });
    all.collect()
}

fn spans(scene: &Scene, statics: &StaticsReport) -> Vec<PageSpan> {
    let Some((line, _)) = scene.modelled_line() else {
        return Vec::new();
    };
    let (first, last) = evaluated_spans(scene);
    let all = (first..=last).filter_map(|number| {
        let (from, to) = (line.support_x(number - 1), line.support_x(number));
        let here = statics.elasticity.iter().filter(|point| (from..=to).contains(&point.x));
        let (u, least, most) = non_uniformity(&here.copied().collect::<Vec<_>>())?;
        Some(PageSpan {
            number,
            least,
            most,
            non_uniformity: u,
        })
    });
    all.collect()
}

fn half_widths(scene: &Scene) -> Vec<f64> {
    let mut all: Vec<f64> = (scene.pantographs.iter())
        .filter_map(|pantograph| Some(0.5 * pantograph.strip_width()?))
        .collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

fn tensions(scene: &Scene, statics: &StaticsReport) -> Vec<(String, f64)> {
    let mut all = vec![("contact wire".to_owned(), statics.tension.contact_wire)];
    let line = scene.modelled_line().map(|(line, _)| line);
    if line.is_some_and(|line| line.messenger_wire.is_some()) {
        all.push(("messenger wire".to_owned(), statics.tension.messenger_wire));
    }
    if let Some(stitch) = line.and_then(|line| line.stitch_wires.as_ref()) {
        all.push(("stitch wires, as erected".to_owned(), stitch.wire.tension));
    }
    all
}
