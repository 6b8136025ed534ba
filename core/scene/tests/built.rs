//! A scene is built without a file, and is the one that a file gives.

use scene::{
    AxialStrain, Catenary, Contact, Correction, Damping, Division, Droppers, Element, Evaluate, Lumped, Mesh,
    MeshChoice, RegistrationArms, Run, Scene, Supports, TensionLength, Wire,
};

/// The line of EN 50318 under its pantograph at 250 km/h, with the mesh of the shipped scene.
fn built() -> Scene {
    let line = Catenary::new(
        TensionLength::new(vec![60.0; 10], 5.3, 1.2),
        (
            Wire::new(1.35, 20_000.0, 1.7e7, 195.0),
            Wire::new(1.07, 16_000.0, 1.1e7, 131.7),
        ),
        Droppers::new(&[5.0, 10.5, 17.0, 23.5, 30.0, 36.5, 43.0, 49.5, 55.0], 1e5),
        (Supports::new(5e5, 5e5, 0.0), RegistrationArms::new(0.0, 5e5, 0.0)),
        Damping::new(0.0125, 1e-4),
        Mesh::new(Division::PerInterval(8)),
    );
    let head = Lumped::new(1.2, 120.0, &[7.2, 15.0], &[4200.0, 50.0], &[10.0, 90.0]);
    let run = Run::new(250.0 / 3.6, 7.0, 20.0, Evaluate::Spans { first: 5, last: 6 });
    Scene::new(
        "EN 50318:2002 reference model, 250 km/h",
        run,
        (line, Contact::penalty(5e4, 0.0)),
        vec![head.into()],
    )
}

#[test]
fn a_scene_built_in_rust_is_the_one_of_the_file() {
    let file = Scene::from_toml(include_str!("../../../scenes/en50318-250.toml"), "x.toml", &[]).unwrap();
    let mut scene = built().checked().unwrap();
    scene.source = file.source.clone();
    scene.run.electrification = file.run.electrification;
    assert_eq!(scene, file);
    assert_eq!(Scene::from_toml(&scene.to_toml(), "again", &[]).unwrap(), scene);
}

#[test]
fn a_wrong_value_of_a_built_scene_is_refused_as_that_of_a_file() {
    let refusal = |change: &dyn Fn(&mut Scene)| {
        let mut scene = built();
        change(&mut scene);
        scene.title = "built".to_owned();
        scene.checked().unwrap_err().to_string()
    };
    let line = |scene: &mut Scene, change: &dyn Fn(&mut Catenary)| match &mut scene.catenary {
        scene::Line::Modelled(line) => change(line),
        scene::Line::Supplied(_) => unreachable!("a modelled line"),
    };
    for (message, expected) in [
        (
            refusal(&|scene| scene.run.duration = -1.0),
            "built: run.duration = -1 s: must be positive and finite",
        ),
        (
            refusal(&|scene| scene.run.speed = f64::NAN),
            "built: run.speed_kmh = NaN km/h: must be positive and finite",
        ),
        (
            refusal(&|scene| line(scene, &|line| line.contact_wire.tension = 15.0)),
            "built: catenary.contact_wire.tension = 15 N: must be at least 100 N for a wire to hang straight; 15 kN \
             are 15000 N",
        ),
        (
            refusal(&|scene| line(scene, &|line| line.tension_lengths[0].stagger.clear())),
            "built: catenary.stagger = []: has 0 entries, must be a list of numbers in m, at least one",
        ),
        (
            refusal(&|scene| line(scene, &|line| line.tension_lengths.clear())),
            "built: catenary.tension_length is missing: must be at least one tension length",
        ),
        (
            refusal(&|scene| line(scene, &|line| line.tension_lengths[0].span_lengths.clear())),
            "built: catenary.spans = 0: must be a whole number from 1 to 5000",
        ),
        (
            refusal(&|scene| line(scene, &|line| line.tension_lengths[0].presag.clear())),
            "built: catenary.presag = []: has 0 entries",
        ),
        (
            refusal(&|scene| line(scene, &|line| line.droppers.positions.clear())),
            "built: catenary.droppers.positions is missing",
        ),
        (refusal(&|scene| scene.pantographs.clear()), "pantograph"),
        (
            refusal(&|scene| scene.run.duration = 80.0),
            "built: run.duration = 80 s: must be at most 8.352 s",
        ),
    ] {
        assert!(
            message.starts_with("built: ") && message.contains(expected),
            "{message}"
        );
    }
}

#[test]
fn a_mesh_is_plain_given_or_to_be_chosen() {
    let given = Mesh {
        corrections: vec![Correction::BendingLayers],
        choice: MeshChoice::Given,
        ..Mesh::new(Division::UpTo(1.0))
    };
    assert!(given.is_given() && !Mesh::new(Division::PerInterval(2)).is_given());
    assert_eq!(Mesh::default(), Mesh::for_error(Element::Cable, AxialStrain::Mean, 1.0));
}
