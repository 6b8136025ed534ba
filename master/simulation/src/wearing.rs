//! Current and wear of a scene for its results, and what is assumed of them.

use results::Wearing;
use scene::Scene;

/// Current and wear of a scene; nothing where it gives none.
#[must_use]
pub fn of(scene: &Scene) -> Option<Wearing> {
    let wear = scene.wear.clone()?;
    let wires = scene
        .modelled_line()
        .map_or(1, |(line, _)| line.contact_wire_offsets().len());
    Some(Wearing { wear, wires })
}

/// Remarks on what is assumed.
#[must_use]
pub fn remarks(scene: &Scene) -> Vec<String> {
    let Some(wear) = &scene.wear else { return Vec::new() };
    let mut remarks = vec![
        "[wear]: the current is held, during arcs too; the heat of a contact counts in full for wire and strip; a worn \
         wire keeps mass, tension and stiffness of a new one"
            .to_owned(),
    ];
    let stride = scene.run.speed * scene.run.output_step;
    if stride > wear.grid.max(wear.contact_length) {
        remarks.push(format!(
            "wear.grid = {} m: a pantograph travels {stride:.3} m in run.output_step = {} s, and the wear of shorter \
             waves is not resolved",
            wear.grid, scene.run.output_step
        ));
    }
    remarks
}
