//! Page of `master check` on the line of a scene.

use catenary::{StaticLine, StaticsReport, WireAtRest, WireName, gradients, non_uniformity};
use results::report::{
    LinePage, PageDropper, PageMass, PageRange, PageSpan, PageSupport, PageTension, PageWire, PageWireKind,
};
use scene::{Catenary, Scene};

use crate::check::Report;
use crate::{Prepared, evaluated_spans};

/// Most spans on the page.
const MOST_SPANS: usize = 200;

/// The line of a prepared scene as a page; none of a supplied line.
#[must_use]
pub fn page(prepared: &Prepared, report: &Report) -> Option<LinePage> {
    let line = prepared.statics.as_ref()?;
    let statics = report.statics.as_ref()?;
    let scene = &prepared.scene;
    let (catenary, _) = scene.modelled_line()?;
    let wires = line.wires_at_rest();
    let masts = catenary.supports_x();
    let evaluated = evaluated_spans(scene);
    Some(LinePage {
        title: scene.title.clone(),
        scene: prepared.name.clone(),
        speed_kmh: scene::kmh(scene.run.speed),
        evaluated: range(&masts, evaluated),
        shown: range(&masts, shown(masts.len() - 1, evaluated)),
        masts,
        droppers: droppers(catenary, line, statics, &wires),
        supports: supports(catenary, statics),
        masses: (line.point_masses_at_rest().into_iter())
            .map(|(at, mass)| PageMass { at, mass })
            .collect(),
        curvature: curvature(catenary),
        elasticity: statics
            .elasticity
            .iter()
            .map(|point| (point.x, point.elasticity))
            .collect(),
        spans: spans(scene, statics),
        half_widths: half_widths(scene),
        tensions: tensions(&wires),
        wires: wires.into_iter().map(drawn).collect(),
        limits: report.limits.clone(),
        model: report.model.clone(),
        notes: report.notes.clone(),
    })
}

/// Spans (from 1) of `spans` that the page shows: all, or those around the evaluated ones.
fn shown(spans: usize, (first, last): (usize, usize)) -> (usize, usize) {
    let count = spans.min(MOST_SPANS);
    let evaluated = (last + 1).saturating_sub(first);
    let before = count.saturating_sub(evaluated) / 2;
    let start = first.saturating_sub(before).clamp(1, spans - count + 1);
    (start, start + count - 1)
}

/// Spans `first` to `last` (from 1) between these masts.
fn range(masts: &[f64], (first, last): (usize, usize)) -> PageRange {
    PageRange {
        first,
        last,
        from: masts[first - 1],
        to: masts[last],
    }
}

/// Short name of a wire: stitch wires of one tension length share theirs.
fn short_name(wire: &WireAtRest) -> String {
    let name = wire.label.replace('_', " ");
    match name.split_once(" at support ") {
        Some((stitch, rest)) => match rest.split_once(" of ") {
            Some((_, of)) => format!("{stitch}s of {of}"),
            None => format!("{stitch}s"),
        },
        None => name,
    }
}

fn drawn(wire: WireAtRest) -> PageWire {
    PageWire {
        kind: match wire.name {
            WireName::ContactWire => PageWireKind::Contact,
            WireName::MessengerWire => PageWireKind::Messenger,
            WireName::StitchWire => PageWireKind::Stitch,
        },
        name: short_name(&wire),
        tension_length: wire.tension_length,
        points: wire.points,
        above_chord: wire.above_chord,
    }
}

fn droppers(line: &Catenary, statics: &StaticLine, report: &StaticsReport, wires: &[WireAtRest]) -> Vec<PageDropper> {
    let all = statics.droppers_at_rest().into_iter().zip(&report.droppers);
    let all = all.map(|(drawn, report)| PageDropper {
        tension_length: report.tension_length,
        span: report.span,
        number: report.dropper,
        position: report.x - line.section(report.tension_length - 1).support_x(report.span - 1),
        hangs_from: report.hangs_from.name(),
        wires: drawn.wires.map(|wire| short_name(&wires[wire])),
        top: drawn.ends[0],
        bottom: drawn.ends[1],
        length: report.length,
        force: report.force,
    });
    all.collect()
}

/// Curvature at the supports of each tension length, where the track has curves.
fn curvature(line: &Catenary) -> Vec<Vec<(f64, f64)>> {
    let curved = line.sections().filter(|section| section.is_curved());
    let along = curved.map(|section| {
        let supports = 0..=section.spans();
        supports
            .map(|support| (section.support_x(support), section.curvature_at(support)))
            .collect()
    });
    along.collect()
}

/// Gradients of the contact wire at each support and their changes there, –; none where no strip runs on the wire.
pub(crate) fn used_gradients(line: &Catenary, statics: &StaticsReport) -> Vec<(Option<f64>, Option<f64>)> {
    let mut used_before = false;
    let all = gradients(&statics.supports).into_iter().enumerate();
    let all = all.map(|(i, (gradient, change))| {
        let support = &statics.supports[i];
        // Where another wire is lower, no strip runs on this one.
        let used = statics.supports.get(i + 1).is_some_and(|next| {
            let middle = 0.5 * (support.x + next.x);
            line.lowest_at(middle) == support.tension_length - 1
        });
        let both = used && used_before;
        used_before = used;
        (gradient.filter(|_| used), change.filter(|_| both))
    });
    all.collect()
}

fn supports(line: &Catenary, statics: &StaticsReport) -> Vec<PageSupport> {
    let slopes = used_gradients(line, statics);
    let mut numbers = vec![0; line.tension_lengths.len()];
    let all = statics
        .supports
        .iter()
        .zip(slopes)
        .map(|(support, (gradient, change))| {
            let section = line.section(support.tension_length - 1);
            let number = numbers[support.tension_length - 1];
            numbers[support.tension_length - 1] += 1;
            PageSupport {
                tension_length: support.tension_length,
                number: number + 1,
                x: support.x,
                height: support.contact_wire_z,
                encumbrance: line.messenger_wire.is_some().then(|| section.encumbrance_at(number)),
                stagger: section.stagger_at(number),
                messenger_reaction: support.messenger_reaction,
                arm_force: support.arm_force,
                arm_lateral: support.arm_lateral,
                radius: Some(section.radius_at(number)).filter(|radius| radius.is_finite()),
                gradient,
                change,
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
            ends: [from, to],
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

fn tensions(wires: &[WireAtRest]) -> Vec<PageTension> {
    let mut all: Vec<PageTension> = Vec::new();
    for wire in wires {
        let (name, [least, most]) = (short_name(wire), wire.tension);
        match all.iter_mut().find(|known| known.name == name) {
            Some(known) => (known.least, known.most) = (known.least.min(least), known.most.max(most)),
            None => all.push(PageTension {
                name,
                nominal: wire.nominal_tension,
                least,
                most,
            }),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_is_shown_around_its_evaluated_spans() {
        assert_eq!(shown(20, (5, 14)), (1, 20));
        assert_eq!(shown(1000, (501, 510)), (406, 605));
        assert_eq!(shown(1000, (3, 12)), (1, 200));
        assert_eq!(shown(1000, (995, 1000)), (801, 1000));
        assert_eq!(shown(1000, (101, 700)), (101, 300));
    }
}
