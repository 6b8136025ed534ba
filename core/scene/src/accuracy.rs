//! `run.accuracy_percent`: mesh, steps, tolerance and reductions that a scene leaves to one wish.

use crate::mesh::DEFAULT_ERROR;
use crate::tree::{At, Node, Table, Value};

/// `run.accuracy_percent`, with what is still to be chosen by it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Largest sum of expected errors of the filtered force, % of its standard deviation.
    pub percent: f64,
    /// Choices left to it.
    pub open: Open,
}

/// Choices that a scene leaves to `run.accuracy_percent`; until they are made nothing runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Open {
    /// Elements and corrections.
    pub mesh: bool,
    /// `solver.micro_step`.
    pub micro_step: bool,
    /// `coupling.macro_step`, which is chosen with the micro step only.
    pub macro_step: bool,
    /// `solver.newton_tolerance`.
    pub newton_tolerance: bool,
    /// `model.reduce`, beyond what changes nothing.
    pub reductions: bool,
}

impl Accuracy {
    /// A wish that every choice is left to.
    #[must_use]
    pub fn new(percent: f64) -> Self {
        let open = Open {
            mesh: true,
            micro_step: true,
            macro_step: true,
            newton_tolerance: true,
            reductions: true,
        };
        Self { percent, open }
    }
}

/// Keys of `catenary.mesh` that decide its error.
const MESH: [&str; 4] = [
    "catenary.mesh.elements_per_interval",
    "catenary.mesh.element_length",
    "catenary.mesh.error_percent",
    "catenary.mesh.corrections",
];
/// Other keys that the wish chooses, but for the steps.
const OTHERS: [&str; 2] = ["solver.newton_tolerance", "model.reduce"];

/// Opens the steps of a scene to an error that is asked for of its mesh, as [`open_steps`].
pub(crate) fn open_steps_to_mesh(root: &mut Table) -> bool {
    let error = root.node_at("catenary.mesh.error_percent").map(|error| error.at);
    error.is_some_and(|at| open_steps(root, matches!(at, At::Override(_))))
}

/// Takes out the steps of files where an override asks for an error, as they are part of the choice, but for a macro
/// step that is not chosen. True where the macro step is left to be chosen with the micro step.
fn open_steps(root: &mut Table, is_asked_anew: bool) -> bool {
    if is_asked_anew {
        take_of_files(root, ["solver.micro_step"]);
    }
    if root.has("solver.micro_step") || !is_coupled_by_rule(root) {
        return false;
    }
    if is_asked_anew {
        take_of_files(root, ["coupling.macro_step"]);
    }
    !root.has("coupling.macro_step")
}

/// True where all that is coupled are models of this program without samples of a control: rules for the coupling error
/// hold for these.
fn is_coupled_by_rule(root: &Table) -> bool {
    let is_ours = |node: &Node| !matches!(&node.value, Value::Table(one) if one.has("fmu") || one.has("control"));
    let are_ours = match root.node("pantograph").map(|node| &node.value) {
        Some(Value::List(all)) => all.iter().all(is_ours),
        _ => true,
    };
    are_ours && !root.has("catenary.fmu") && !root.has("controller")
}

/// Takes out keys with these paths that files gave, but for tables: how macro steps are controlled is more than their
/// length.
fn take_of_files<'a>(root: &mut Table, paths: impl IntoIterator<Item = &'a str>) {
    let of_a_file = |node: &Node| !matches!(node.at, At::Override(_)) && !matches!(node.value, Value::Table(_));
    for path in paths {
        if root.node_at(path).is_some_and(of_a_file) {
            root.take_at(path);
        }
    }
}

/// Choices that the keys of a scene leave to its wish for an accuracy, where it has one.
///
/// A key that is given wins. A wish in an override takes the place of such keys in files, as other overrides do. A mesh
/// that is left open becomes one for an error, to be chosen.
pub(crate) fn left_open(root: &mut Table) -> Open {
    let Some(at) = root.node_at("run.accuracy_percent").map(|wish| wish.at) else {
        return Open::default();
    };
    let says = |root: &Table, path: &str, word: &str| {
        let value = root.node_at(path).map(|node| &node.value);
        matches!(value, Some(Value::String(said)) if said == word)
    };
    // No rule chooses beams.
    let beam = says(root, "catenary.mesh.element", "beam");
    let is_asked_anew = matches!(at, At::Override(_));
    if is_asked_anew {
        let mesh: &[&str] = if beam { &[] } else { &MESH };
        take_of_files(root, mesh.iter().chain(&OTHERS).copied());
    }
    let macro_step = open_steps(root, is_asked_anew);
    let supplied_line = root.has("catenary.fmu");
    let open = Open {
        mesh: !supplied_line && !beam && !MESH.iter().any(|path| root.has(path)),
        micro_step: !root.has("solver.micro_step"),
        macro_step,
        newton_tolerance: !root.has("solver.newton_tolerance"),
        reductions: !supplied_line && (!root.has("model.reduce") || says(root, "model.reduce", "auto")),
    };
    if open.mesh
        && let Some(mesh) = root.table_mut("catenary").and_then(|line| line.table_mut("mesh"))
    {
        let value = Value::Float(DEFAULT_ERROR);
        mesh.push("error_percent", Node { at, value });
    }
    open
}
