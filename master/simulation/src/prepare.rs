//! From a scene as it is written to one with everything resolved: statics, supplied FMUs, starts.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;
use std::time::Instant;

use catenary::StaticLine;
use fmi2::import::{Fmu, Options};
use scene::{Connection, Line, PantographModel, Scene, Start, Supplied};

use crate::statics_hints::with_suspects;
use crate::{Prepared, SetupError, StaticLines};
use crate::{size, table_files};
use cosim::fmu_slave::CosimulationError;
use suppliers::{
    Side, StripAtStart, SuppliedController, SuppliedLine, SuppliedPantograph, SupplierError, Wiring, aligned,
    own_heights,
};
use system::disturbance::Disturbance;
use system::equilibrium;

/// Contact force that no strip starts with, N: several times what pantographs press with at any speed.
const LARGEST_START: f64 = 1000.0;

/// Facts of a supplied FMU.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Other {
    /// `line`, `pantograph 1`, …
    pub name: String,
    /// File.
    pub fmu: String,
    /// The wiring in use, one line per wire.
    pub wiring: Vec<String>,
    /// Remarks on the way in which the FMU is run.
    pub remarks: Vec<String>,
}

/// Solves the statics of a scene and resolves what it leaves open.
///
/// Paths of FMUs and of files that tables are left to are relative to `base`. With `logging`, FMUs are asked for their
/// debug messages.
///
/// # Errors
/// See [`SetupError`].
pub fn prepare(scene: Scene, name: &str, base: &Path, logging: bool) -> Result<Prepared, SetupError> {
    prepare_on(&StaticLines::none(), scene, name, base, logging)
}

/// As [`prepare`], with the static state taken from `lines` where another scene has left it there: the result is the
/// same bit for bit.
///
/// # Errors
/// See [`SetupError`].
pub fn prepare_on(
    lines: &StaticLines,
    mut scene: Scene,
    name: &str,
    base: &Path,
    logging: bool,
) -> Result<Prepared, SetupError> {
    let begin = Instant::now();
    table_files::read(&mut scene, name, base)?;
    size::check(&scene)?;
    let statics = match &scene.catenary {
        Line::Modelled(_) => Some(lines.of(&scene).map_err(|error| with_suspects(error.into(), &scene))?),
        Line::Supplied(_) => None,
    };
    let mut supplied = Vec::new();
    for index in 0..scene.pantographs.len() {
        supplied.push(match scene.pantographs[index].model.clone() {
            PantographModel::Supplied(entry) => Some(start_pantograph(
                &mut scene,
                statics.as_deref(),
                entry,
                index,
                base,
                logging,
            )?),
            _ => None,
        });
    }
    let line = match (&statics, scene.catenary.clone()) {
        (Some(statics), _) => {
            let resolved = equilibrium::resolve(&mut scene, statics);
            resolved.map_err(|error| with_suspects(error.into(), &scene))?;
            None
        }
        (None, Line::Supplied(entry)) => Some(start_line(&mut scene, entry, base, logging)?),
        (None, Line::Modelled(_)) => None,
    };
    catenary::mesh::check(&scene, name)?;
    let controllers = start_controllers(&mut scene, base, logging)?;
    let others = others(&scene, line.as_ref(), &supplied, &controllers);
    let stated = |one: &Option<SuppliedPantograph>| one.as_ref().map_or(0.0, SuppliedPantograph::start_force);
    let stated_forces = supplied.iter().map(stated).collect();
    Ok(Prepared {
        pictures: true,
        scene,
        name: name.to_owned(),
        statics,
        settling: None,
        others,
        supplied,
        controllers: Mutex::new(controllers),
        stated_forces,
        line,
        begin,
        disturbance: Disturbance::default(),
    })
}

fn others(
    scene: &Scene,
    line: Option<&SuppliedLine>,
    pantographs: &[Option<SuppliedPantograph>],
    controllers: &[Option<SuppliedController>],
) -> Vec<Other> {
    let lines = |wiring: &Wiring| wiring.lines().map(str::to_owned).collect();
    let mut others = Vec::new();
    if let (Some(line), Line::Supplied(entry)) = (line, &scene.catenary) {
        others.push(Other {
            name: "line".to_owned(),
            fmu: entry.fmu.clone(),
            wiring: lines(line.wiring()),
            remarks: line.remarks(),
        });
    }
    for (index, (pantograph, entry)) in pantographs.iter().zip(&scene.pantographs).enumerate() {
        if let (Some(pantograph), PantographModel::Supplied(entry)) = (pantograph, &entry.model) {
            others.push(Other {
                name: format!("pantograph {}", index + 1),
                fmu: entry.fmu.clone(),
                wiring: lines(pantograph.wiring()),
                remarks: pantograph.remarks(),
            });
        }
    }
    for (index, controller) in controllers.iter().enumerate() {
        if let (Some(controller), Some((number, entry))) = (controller, scene.controller_of(index)) {
            others.push(Other {
                name: format!("controller {} of pantograph {}", number + 1, index + 1),
                fmu: entry.side.fmu.clone(),
                wiring: lines(controller.wiring()),
                remarks: controller.remarks(),
            });
        }
    }
    others
}

/// Starts the controller FMUs, one place for each pantograph.
fn start_controllers(
    scene: &mut Scene,
    base: &Path,
    logging: bool,
) -> Result<Vec<Option<SuppliedController>>, SetupError> {
    let mut controllers: Vec<_> = scene.pantographs.iter().map(|_| None).collect();
    for number in 0..scene.controllers.len() {
        let table = format!("controller[{}]", number + 1);
        let mut entry = scene.controllers[number].side.clone();
        let fmu = open(&table, &mut entry, base)?;
        let started = SuppliedController::start(&fmu, &mut entry, scene, number, logging);
        let controller = started.map_err(|source| refused(&table, &entry, source))?;
        scene.controllers[number].side = entry;
        if let Some(place) = controllers.get_mut(scene.controllers[number].pantograph) {
            *place = Some(controller);
        }
    }
    Ok(controllers)
}

/// The FMU of an entry of a table of the scene, whose path is made absolute.
fn open(table: &str, entry: &mut Supplied, base: &Path) -> Result<Fmu, SetupError> {
    let path = base.join(&entry.fmu);
    let options = Options {
        time_limit: Some(suppliers::time_limit(entry)),
        ..Options::default()
    };
    let fmu = Fmu::open_with(&path, &options).map_err(|source| SetupError::SceneFmu {
        key: format!("{table}.fmu"),
        source: Box::new(source),
    })?;
    entry.fmu = std::path::absolute(&path).unwrap_or(path).display().to_string();
    Ok(fmu)
}

/// Starts a supplied pantograph, aligns it with the wire where asked for, and takes its start into the scene.
fn start_pantograph(
    scene: &mut Scene,
    statics: Option<&StaticLine>,
    mut entry: Supplied,
    index: usize,
    base: &Path,
    logging: bool,
) -> Result<SuppliedPantograph, SetupError> {
    let table = format!("pantograph[{}]", index + 1);
    let fmu = open(&table, &mut entry, base)?;
    let started = SuppliedPantograph::start(&fmu, &mut entry, scene, index, logging);
    let mut pantograph = started.map_err(|source| refused(&table, &entry, source))?;
    let force = pantograph.start_force();
    if aligned(&entry) {
        let Some(statics) = statics else {
            let what = format!(
                "{table}.outputs.height.offset = \"align\": the height of a supplied line is not known before \
                 it runs; must \
                 be a number in m"
            );
            return Err(SetupError::NotAvailable(what));
        };
        let height = equilibrium::wire_height(scene, statics, index, force)?;
        pantograph.align(height)?;
    }
    if let Some(statics) = statics {
        let height = pantograph.height();
        check_height(scene, statics, index, height).map_err(|source| refused(&table, &entry, source))?;
    }
    let pantograph_entry = &mut scene.pantographs[index];
    pantograph_entry.start = Some(Start {
        height: pantograph.height(),
        force: force.max(0.0),
    });
    pantograph_entry.model = PantographModel::Supplied(entry);
    Ok(pantograph)
}

/// Refuses a strip that starts so far above the wire that the line would not come to rest over it.
fn check_height(scene: &Scene, statics: &StaticLine, index: usize, height: f64) -> Result<(), SupplierError> {
    let under = |force| equilibrium::wire_height(scene, statics, index, force);
    // What the statics have no answer to is left to the start of the line.
    let (Ok(wire), Ok(lifted)) = (under(0.0), under(LARGEST_START)) else {
        return Ok(());
    };
    if height > lifted {
        return Err(SupplierError::Height {
            height,
            wire,
            force: LARGEST_START,
            lifted,
        });
    }
    Ok(())
}

/// Starts a supplied line under the strips, whose starts are taken into the scene where they are not known.
///
/// A strip starts where the scene says, else where the line's FMU has it by itself, else where its pantograph is at
/// rest.
fn start_line(scene: &mut Scene, mut entry: Supplied, base: &Path, logging: bool) -> Result<SuppliedLine, SetupError> {
    let strips = scene.pantographs.len();
    let fmu = open("catenary", &mut entry, base)?;
    let wiring = Wiring::resolve(fmu.description(), &mut entry, Side::Line, strips)
        .map_err(|source| refused("catenary", &entry, source.into()))?;
    for (index, height) in own_heights(&fmu, &wiring, strips).into_iter().enumerate() {
        start_beside_line(scene, index, height)?;
    }
    let starts: Vec<StripAtStart> = (0..strips)
        .map(|index| {
            let start = scene.pantographs[index].start;
            StripAtStart {
                x: scene.head_start_x(index),
                height: start.map_or(0.0, |start| start.height),
                force: start.map_or(0.0, |start| start.force),
            }
        })
        .collect();
    let line = SuppliedLine::start(&fmu, &entry, wiring, scene, &starts, logging)
        .map_err(|source| refused("catenary", &entry, source))?;
    scene.catenary = Line::Supplied(entry);
    Ok(line)
}

/// The start of a pantograph modelled here under a line that is not: at `height` m where the line's FMU says one.
fn start_beside_line(scene: &mut Scene, index: usize, height: Option<f64>) -> Result<(), SetupError> {
    let table = format!("pantograph[{}]", index + 1);
    match &scene.pantographs[index].model {
        PantographModel::Supplied(_) => return Ok(()),
        PantographModel::Lumped(lumped) if lumped.reference_height.is_none() => {
            let what = format!(
                "{table}.reference_height is missing: with catenary.fmu the height of the wire is not known; must be \
                 the height of \
                 the strip in m at which the springs are unstretched"
            );
            return Err(SetupError::NotAvailable(what));
        }
        _ => {}
    }
    if scene.pantographs[index].start.is_some() {
        return Ok(());
    }
    let failed = |source| SetupError::Pantograph {
        pantograph: index + 1,
        source,
    };
    let model = vehicle::PantographModel::of_scene(scene, index, &mut dynamics::Layout::new()).map_err(failed)?;
    let height = height.unwrap_or_else(|| model.reference_height());
    let force = model.equilibrium_at_height(height).map_err(failed)?.force.max(0.0);
    scene.pantographs[index].start = Some(Start { height, force });
    Ok(())
}

fn refused(table: &str, entry: &Supplied, source: SupplierError) -> SetupError {
    let key = match &source {
        SupplierError::Fmu(error) => key_of(entry, error),
        SupplierError::Wiring(error) => error.key(),
        SupplierError::Sign { name, .. } => format!("inputs.{name}"),
        SupplierError::Step { .. } | SupplierError::Sample { .. } | SupplierError::Trial { .. } => "fmu".to_owned(),
        SupplierError::Height { .. } => "outputs.height".to_owned(),
    };
    // A message that names a key of the FMU only does not say which FMU it is.
    let key = format!("{table}.{key} ({})", entry.fmu);
    let source = Box::new(source);
    SetupError::Wiring { key, source }
}

/// The key of an entry that a refusal of its FMU speaks of.
fn key_of(entry: &Supplied, refusal: &CosimulationError) -> String {
    let (CosimulationError::NoVariable { variable, .. } | CosimulationError::WrongType { variable, .. }) = refusal
    else {
        return "fmu".to_owned();
    };
    if entry.parameters.contains_key(variable) {
        return "parameters".to_owned();
    }
    let named = |table: &str, wires: &BTreeMap<String, Connection>| {
        let found = wires.iter().find(|(_, connection)| connection.variable == *variable);
        found.map(|(name, _)| format!("{table}.{name}.variable"))
    };
    named("inputs", &entry.inputs)
        .or_else(|| named("outputs", &entry.outputs))
        .unwrap_or_else(|| "fmu".to_owned())
}
