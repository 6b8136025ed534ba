//! The figures of the thesis that show computed forces, ours on its mesh and, beside it, on the finest mesh that was
//! computed.

use super::judge::{Line, Reproduction};
use super::plan::Mesh;
use super::published::CASES;
use results::report::escape;
use results::report::plots::{BOUND, COLOURS, Trace, axis, curve, dotted, finished, layout, rounded};

/// Number, heading, cases, drag (0) or lift (1) of the wind on the pan-head where that is shown in place of contact
/// forces, time range in s.
type ThesisFigure = (u8, &'static str, &'static [usize], Option<usize>, [f64; 2]);

/// Figures of the thesis that show computed forces.
const FIGURES: &[ThesisFigure] = &[
    (6, "contact force without wind", &[0], None, [0.0, 10.0]),
    (7, "the same, 7 to 10 s", &[0], None, [7.0, 10.0]),
    (8, "penalty force and sliding joint", &[0, 1], None, [0.0, 10.0]),
    (9, "the same, 7 to 10 s", &[0, 1], None, [7.0, 10.0]),
    (10, "wind on the pantograph", &[2], None, [0.0, 10.0]),
    (11, "drag on the pan-head", &[2], Some(0), [0.0, 10.0]),
    (12, "lift on the pan-head", &[2], Some(1), [0.0, 10.0]),
    (
        13,
        "with wind on the pantograph and without",
        &[0, 2],
        None,
        [0.0, 10.0],
    ),
    (14, "the same, 7 to 10 s", &[0, 2], None, [7.0, 10.0]),
    (15, "wind on pantograph and wires", &[3], None, [0.0, 10.0]),
    (
        16,
        "with wind on pantograph and wires and without",
        &[0, 3],
        None,
        [0.0, 10.0],
    ),
    (17, "the same, 7 to 10 s", &[0, 3], None, [7.0, 10.0]),
];

/// Heading and body of each figure; a body is empty where nothing was computed.
pub(super) fn figures(reproduction: &Reproduction) -> impl Iterator<Item = (String, String)> {
    FIGURES.iter().map(|(number, heading, cases, part, times)| {
        let drawn = |mesh: Mesh, which: &str| {
            let id = format!("figure-{number}-{which}");
            let plot = match part {
                None => contact(reproduction, cases, mesh, *times, &id),
                Some(part) => wind(reproduction, cases[0], mesh, *part, &id),
            };
            plot.map_or_else(String::new, |plot| format!("<p>{}</p>\n{plot}", escape(&mesh.name())))
        };
        let refined = finest(reproduction, cases).map(|mesh| drawn(mesh, "refined"));
        let body = drawn(Mesh::ALL[0], "thesis") + &refined.unwrap_or_default();
        (format!("Fig. {number}: {heading}"), body)
    })
}

/// The finest mesh, other than that of the thesis, on which all these cases have a curve.
fn finest(reproduction: &Reproduction, cases: &[usize]) -> Option<Mesh> {
    let drawable = |mesh: &Mesh| {
        let has = |case: &usize| run(reproduction, *case, *mesh).is_some_and(|line| line.curve.is_some());
        cases.iter().all(has)
    };
    Mesh::ALL[1..].iter().copied().rfind(drawable)
}

/// The run of a case on a mesh, in one system.
fn run(reproduction: &Reproduction, case: usize, mesh: Mesh) -> Option<&Line> {
    Line::of(&reproduction.lines, &CASES[case], mesh)
}

/// Drag (`part` = 0) or lift (1) of the wind on the pan-head; that of even travel as a line.
fn wind(reproduction: &Reproduction, case: usize, mesh: Mesh, part: usize, id: &str) -> Option<String> {
    let line = run(reproduction, case, mesh)?;
    let wind = line.wind.as_ref()?;
    let (name, force) = [("drag", &wind.drag), ("lift", &wind.lift)][part];
    let time: Vec<f64> = (0..force.len()).map(|index| index as f64 * line.output_step).collect();
    let end = time.last().copied().unwrap_or_default();
    let (x, y) = (rounded(&time, 1e3), rounded(force, 1e2));
    let mut traces: Vec<Trace> = vec![curve(x, y, name, COLOURS[0], 1.1)];
    if let Some(even) = line.even_head.map(|even| even[part]) {
        traces.push(dotted(vec![0.0, end], vec![even; 2], "Eq. (18), even travel", BOUND));
    }
    let y = axis(&format!("{name} on the pan-head [N]"));
    Some(finished(traces, layout(axis("time [s]"), y), id, 320))
}

/// Contact forces of some cases, as the time integration gives them; the published mean as a line. Its curves are
/// printed as pictures only.
fn contact(reproduction: &Reproduction, shown: &[usize], mesh: Mesh, [from, to]: [f64; 2], id: &str) -> Option<String> {
    let mut traces: Vec<Trace> = Vec::new();
    for (&index, colour) in shown.iter().zip(COLOURS) {
        let run = run(reproduction, index, mesh);
        let Some((line, computed)) = run.and_then(|line| Some((line, line.curve.as_ref()?))) else {
            continue;
        };
        let samples = computed.raw.iter().enumerate();
        let samples = samples.map(|(index, force)| (index as f64 * line.output_step, *force));
        let (time, force): (Vec<f64>, Vec<f64>) = samples.filter(|(time, _)| (from..=to).contains(time)).unzip();
        let (x, y) = (rounded(&time, 1e3), rounded(&force, 1e1));
        traces.push(curve(x, y, &CASES[index].title, colour, 1.1));
    }
    let last = shown.last().filter(|_| !traces.is_empty())?;
    let case = &CASES[*last];
    let name = format!("published mean, {}", case.title);
    traces.push(dotted(vec![from, to], vec![case.mean.value; 2], &name, BOUND));
    let time = axis("time [s]").range(vec![from, to]);
    Some(finished(traces, layout(time, axis("contact force [N]")), id, 320))
}
