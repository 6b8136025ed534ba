//! The committed model descriptions equal those that the code makes of the thesis scene.
use fmi2::model_description::{BaseType, Causality, GUID_PLACEHOLDER, ModelDescription, Variable};
use integration_tests::fmus::{SHIPPED, tree};
use integration_tests::runs::{prepared, scene_with};
use std::collections::BTreeSet;

/// Height and force of the start come from an iteration that ends at 1e-6 N.
const START_TOLERANCE: f64 = 1e-6;

fn committed(identifier: &str) -> String {
    let path = tree().join(format!("modelDescription/{identifier}.xml"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn generated() -> [(&'static str, String); 2] {
    let scene = prepared(scene_with(SHIPPED, &[]), "thesis").scene;
    [
        ("Catenary", fmu::description::<catenary::Subsystem>(&scene).to_xml()),
        ("Pantograph", fmu::description::<vehicle::Subsystem>(&scene).to_xml()),
    ]
}

/// A text without the values of its start attributes, and these values.
fn without_starts(xml: &str) -> (String, Vec<String>) {
    const ATTRIBUTE: &str = " start=\"";
    let mut pieces = xml.split(ATTRIBUTE);
    let mut rest = pieces.next().unwrap_or_default().to_owned();
    let mut starts = Vec::new();
    for piece in pieces {
        let (value, behind) = piece.split_once('"').unwrap();
        starts.push(value.to_owned());
        rest.push_str(ATTRIBUTE);
        rest.push('"');
        rest.push_str(behind);
    }
    (rest, starts)
}

fn same_start(a: &str, b: &str) -> bool {
    match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= START_TOLERANCE * a.abs().max(1.0),
        _ => a == b,
    }
}

#[test]
fn committed_model_descriptions_match_the_variable_tables() {
    let update = "`cargo run --release -- package --write-descriptions` writes them anew";
    for (identifier, new) in generated() {
        let (new, new_starts) = without_starts(&new);
        let (old, old_starts) = without_starts(&committed(identifier));
        for (line, (new, old)) in new.lines().zip(old.lines()).enumerate() {
            assert_eq!(
                old,
                new,
                "modelDescription/{identifier}.xml, line {}: {update}",
                line + 1
            );
        }
        assert_eq!(old, new, "modelDescription/{identifier}.xml: {update}");
        for (new, old) in new_starts.iter().zip(&old_starts) {
            assert!(
                same_start(new, old),
                "modelDescription/{identifier}.xml: start {old} is now {new}: {update}"
            );
        }
    }
}

#[test]
fn committed_model_descriptions_have_a_placeholder_for_the_guid_and_references_in_order() {
    for identifier in ["Catenary", "Pantograph"] {
        let xml = committed(identifier);
        assert_eq!(xml.matches(GUID_PLACEHOLDER).count(), 1);
        let description = ModelDescription::from_xml(xml.as_bytes()).unwrap();
        assert_eq!(description.guid, GUID_PLACEHOLDER);
        assert_eq!(description.co_simulation.model_identifier, identifier);
        for (position, variable) in description.variables.iter().enumerate() {
            assert_eq!(variable.value_reference as usize, position, "{}", variable.name);
        }
    }
}

#[test]
fn both_have_the_capabilities_that_iterating_masters_need() {
    for identifier in ["Catenary", "Pantograph"] {
        let able = ModelDescription::from_xml(committed(identifier).as_bytes())
            .unwrap()
            .co_simulation;
        assert!(
            able.can_handle_variable_communication_step_size && able.can_interpolate_inputs,
            "{identifier}"
        );
        assert!(
            able.can_get_and_set_fmu_state && able.can_serialize_fmu_state,
            "{identifier}"
        );
        assert!(
            able.provides_directional_derivative && able.max_output_derivative_order >= 1,
            "{identifier}"
        );
        assert!(
            !able.can_be_instantiated_only_once_per_process && !able.needs_execution_tool,
            "{identifier}"
        );
    }
}

fn names(variables: &[Variable], causality: Causality) -> BTreeSet<&str> {
    let chosen = variables.iter().filter(|variable| variable.causality == causality);
    chosen.map(|variable| variable.name.as_str()).collect()
}

#[test]
fn inputs_and_outputs_are_those_that_users_rely_on() {
    let motion = ["x", "y", "z", "vx", "vy", "vz", "roll"].map(|name| format!("strip[1].{name}"));
    let line = ModelDescription::from_xml(committed("Catenary").as_bytes())
        .unwrap()
        .variables;
    assert_eq!(
        names(&line, Causality::Input),
        motion.iter().map(String::as_str).collect()
    );
    let contact = [
        "force",
        "fx",
        "fy",
        "fz",
        "mean_force",
        "mean_fx",
        "mean_fy",
        "mean_fz",
        "work",
        "x",
        "y",
        "wire.z",
    ];
    let contact = contact.into_iter().chain(["wire.vz", "gap", "closed"]);
    let mut outputs: BTreeSet<String> = contact.map(|name| format!("contact[1].{name}")).collect();
    outputs.extend((1..=10).map(|j| format!("contact[1].sample[{j}]")));
    outputs.extend((1..=21).map(|k| format!("support[{k}].uplift")));
    outputs.extend(["droppers.slack".into(), "energy".into()]);
    let offered = names(&line, Causality::Output);
    for name in &outputs {
        assert!(offered.contains(name.as_str()), "Catenary has no output {name}");
    }
    let parameters = names(&line, Causality::Parameter);
    for name in ["start.height", "start.force", "start.x", "speed"] {
        assert!(
            parameters.contains(format!("strip[1].{name}").as_str()),
            "Catenary has no parameter {name}"
        );
    }
    assert!(parameters.contains("scene") && parameters.contains("inputs.follow_velocity"));

    let pantograph = ModelDescription::from_xml(committed("Pantograph").as_bytes())
        .unwrap()
        .variables;
    let load = [
        "contact[1].fx",
        "contact[1].fy",
        "contact[1].fz",
        "contact[1].y",
        "wind.vx",
        "wind.vy",
        "wind.vz",
    ];
    assert_eq!(names(&pantograph, Causality::Input), load.into_iter().collect());
    let offered = names(&pantograph, Causality::Output);
    for name in motion.iter().map(String::as_str).chain([
        "strip[1].work",
        "strip[1].wind.drag",
        "strip[1].wind.lift",
        "strip[1].control.force",
        "base.z",
        "uplift_force",
    ]) {
        assert!(offered.contains(name), "Pantograph has no output {name}");
    }
    // Vehicle outputs: the base of the pantograph, and each of the eight wheels.
    let base = ["x", "y", "z", "roll", "pitch", "yaw"].map(|name| format!("base.{name}"));
    let wheels = (1..=8).flat_map(|i| ["load", "derailment_quotient"].map(|name| format!("wheel[{i}].{name}")));
    for name in base.into_iter().chain(wheels) {
        assert!(offered.contains(name.as_str()), "Pantograph has no output {name}");
    }
    assert!(!offered.contains("wheel[9].load"));
    let parameters = names(&pantograph, Causality::Parameter);
    for name in ["start.height", "start.force", "start.x", "speed", "scene"] {
        assert!(parameters.contains(name), "Pantograph has no parameter {name}");
    }
}

#[test]
fn every_variable_has_a_description_and_every_real_a_unit() {
    for identifier in ["Catenary", "Pantograph"] {
        for variable in ModelDescription::from_xml(committed(identifier).as_bytes())
            .unwrap()
            .variables
        {
            assert!(
                variable.description.as_ref().is_some_and(|text| !text.is_empty()),
                "{}",
                variable.name
            );
            assert!(
                variable.base_type() != BaseType::Real || variable.unit().is_some(),
                "{}",
                variable.name
            );
        }
    }
}
