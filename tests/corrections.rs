//! Corrections of a coarse mesh, against closed forms and fine meshes.
use catenary::{
    AxialLaw, BendingLaw, BendingLayers, ContactPair, ContactTangent, CorrectedSteps, CorrectedWire, Enrichment,
    LineOptions, LoadCorrection, MassCorrection, NodeMap, PenaltyContact, PrescribedStrip, ResidualCompliance,
    StaticLine, WireCurve, WireGeometry, WireSection,
};
use dynamics::{StaticOptions, solve_static};
use integration_tests::lines::{EN, scene_line};
use integration_tests::runs::{EN_300, Run, rms, run, scene_with};
use integration_tests::single_wire::{Load, Material, SingleWire};
use nalgebra::Vector3;
use scene::Division;
use simulation::Mode;
use std::sync::Arc;

/// The contact wire of the reference model.
const SECTION: WireSection = WireSection {
    axial_stiffness: 1.7e7,
    bending_stiffness: 195.0,
    mass_per_length: 1.35,
    tension: 20_000.0,
};
const MATERIAL: Material = Material {
    section: SECTION,
    laws: (AxialLaw::Mean, BendingLaw::Constant),
    gravity: 0.0,
};

/// `√(EI/T)`, m.
fn bending_length(tension: f64) -> f64 {
    (SECTION.bending_stiffness / tension).sqrt()
}

fn compliant(geometry: &Arc<WireGeometry>, speed: f64) -> CorrectedWire {
    let compliance = ResidualCompliance::new(geometry, &SECTION, speed).expect("below the wave speed");
    CorrectedWire {
        geometry: Arc::clone(geometry),
        compliance: Some(Arc::new(compliance)),
        load: None,
        surface: None,
    }
}

/// Deflection at the place of a pinned tensioned beam where a unit force acts, m/N.
fn flexibility(x: f64, length: f64) -> f64 {
    let layer = bending_length(SECTION.tension);
    let rest = length - x;
    let sinh = |x: f64| (x / layer).sinh();
    x * rest / (SECTION.tension * length) - layer / SECTION.tension * sinh(x) * sinh(rest) / sinh(length)
}

#[test]
fn a_strip_feels_the_flexibility_of_the_wire_anywhere_on_a_coarse_mesh() {
    const ELEMENTS: usize = 6;
    const LENGTH: f64 = 30.0;
    for layered in [false, true] {
        let lengths = vec![LENGTH / ELEMENTS as f64; ELEMENTS];
        let mut geometry = WireGeometry::straight(Vector3::zeros(), Vector3::x(), &lengths, |node| {
            NodeMap::planar(4 * node)
        });
        let mut coordinates = 4 * (ELEMENTS + 1);
        if layered {
            geometry = geometry.with_enrichments(vec![Enrichment {
                node: 3,
                index: coordinates,
                direction: Vector3::z(),
                bending_length: bending_length(SECTION.tension),
                reference: 0.0,
            }]);
            coordinates += 1;
        }
        let mut wire = SingleWire::new(&MATERIAL, geometry, coordinates)
            .pinned(0)
            .pinned(ELEMENTS);
        let law = PenaltyContact {
            stiffness: 5e5,
            damping: 0.0,
        };
        let mut worst = [0.0_f64; 2];
        for (corrected, worst) in worst.iter_mut().enumerate() {
            let curve: Arc<dyn WireCurve> = if corrected == 1 {
                Arc::new(compliant(wire.geometry(), 0.0))
            } else {
                wire.geometry().clone()
            };
            let strip = Box::new(PrescribedStrip { first: 0 });
            wire.contact = Some(ContactPair::new(law, curve, strip, 1.2, ContactTangent::RankOne));
            for i in 1..60 {
                let x = 0.5 * f64::from(i) + 0.07;
                let u = [x, 0.0, 1e-5, 0.0, 0.0, 0.0, 0.0, 0.0];
                let mut state = wire.layout.state_at_rest();
                let mut options = StaticOptions::default();
                options.newton.tolerance = 1e-8;
                solve_static(&mut wire, &mut state, &u, &options).expect("an equilibrium");
                let contact = wire.contact.as_ref().expect("set above");
                let found = contact.state(&state.motion(&u)).expect("on the wire").force;
                let exact = 1e-5 / (1.0 / law.stiffness + flexibility(x, LENGTH));
                *worst = worst.max((found / exact - 1.0).abs());
            }
        }
        let [plain, corrected] = worst;
        println!("layer {layered}: plain {plain:.2e}, corrected {corrected:.2e}");
        assert!(
            plain > 5e-3 && corrected < 2e-5,
            "layer {layered}: plain {plain}, corrected {corrected}"
        );
    }
}

/// Deviation of the height under a moving force of 1 N from that of an infinite beam under tension, `F t/(2 m c) − F
/// λ_v/(2 T_v)`, as it runs over elements of `length` m: (of the mesh alone, with its residual compliance), m.
fn under_a_moving_force(length: f64, speed: f64) -> (f64, f64) {
    const WIRE: f64 = 200.0;
    const START: f64 = 70.0;
    let count = (WIRE / length).round() as usize;
    let mut wire = SingleWire::planar(&MATERIAL, WIRE, count).pinned(0).pinned(count);
    let load = Load {
        geometry: Arc::clone(wire.geometry()),
        force: Vector3::z(),
        start: START,
        speed,
    };
    wire.loads.push(load.clone());
    let curve = compliant(wire.geometry(), speed);
    let (m, t_static) = (SECTION.mass_per_length, SECTION.tension);
    let tension = t_static - m * speed * speed;
    let c = (t_static / m).sqrt();
    let h = 5e-4;
    let mut integrator = integration_tests::single_wire::trapezoid(1e-7);
    let mut state = wire.layout.state_at_rest();
    let (mut plain, mut corrected) = (Vec::new(), Vec::new());
    // Until the first wave comes back from an end.
    let steps = ((2.0 * START / (c + speed)).min((2.0 * WIRE - 2.0 * START) / (c + speed)) / h) as usize;
    for step in 1..=steps {
        let t = step as f64 * h;
        integrator
            .step(&mut wire, &mut state, &[], t, h)
            .expect("the wire moves on");
        let s = load.s(t);
        let height = wire.point(s, &state).r.z;
        let exact = t / (2.0 * m * c) - bending_length(tension) / (2.0 * tension);
        // The waves of the start have left.
        if t > 0.25 {
            plain.push(height - exact);
            corrected.push(height + curve.compliance(s).value - exact);
        }
    }
    let zero = vec![0.0; plain.len()];
    (rms(&plain, &zero), rms(&corrected, &zero))
}

#[test]
fn the_residual_compliance_is_what_a_mesh_lacks_under_a_moving_force() {
    let speed = 60.0;
    let bend = bending_length(SECTION.tension - SECTION.mass_per_length * speed * speed);
    let (plain, corrected) = under_a_moving_force(1.25, speed);
    println!("elements of 1.25 m, bend {bend:.3} m: plain {plain:.2e} m, corrected {corrected:.2e} m");
    // The rest are the short waves of the start, which such elements hold back.
    assert!(corrected < 0.35 * plain, "plain {plain}, corrected {corrected}");
}

/// Phase error of a standing wave of wavelength 20 m after ten periods, rad.
fn phase_error(h: f64, rho_inf: f64, corrected: bool) -> f64 {
    const LENGTH: f64 = 40.0;
    let section = WireSection {
        bending_stiffness: 0.0,
        ..SECTION
    };
    let material = Material { section, ..MATERIAL };
    let mut wire = SingleWire::planar(&material, LENGTH, 80).pinned(0).pinned(80);
    if corrected {
        // The step for which the trapezoidal rule makes the same error.
        let r = (1.0 - rho_inf) / (1.0 + rho_inf);
        wire.wire = wire.wire.with_mass_correction(h * (1.0_f64 + 4.5 * r * r).sqrt());
    }
    let k = 2.0 * std::f64::consts::PI / 20.0;
    let omega = k * (SECTION.tension / SECTION.mass_per_length).sqrt();
    let mut state = wire.layout.state_at_rest();
    let amplitude = 1e-4;
    wire.displace(&mut state, |s| {
        [amplitude * (k * s).sin(), amplitude * k * (k * s).cos(), 0.0, 0.0]
    });
    let options = dynamics::NewtonOptions {
        tolerance: 1e-8,
        ..Default::default()
    };
    let mut integrator = dynamics::GeneralizedAlpha::new(rho_inf, options);
    integrator
        .start_accelerations(&mut wire, &mut state, &[])
        .expect("accelerations");
    let steps = (20.0 * std::f64::consts::PI / (omega * h)).round() as usize;
    for step in 1..=steps {
        integrator
            .step(&mut wire, &mut state, &[], step as f64 * h, h)
            .expect("the wire vibrates");
    }
    let point = wire.point(5.0, &state);
    let phase = (-point.velocity.z / omega).atan2(point.r.z);
    let exact = (omega * h * steps as f64).rem_euclid(2.0 * std::f64::consts::PI);
    let error = phase - exact;
    error - 2.0 * std::f64::consts::PI * (error / (2.0 * std::f64::consts::PI)).round()
}

#[test]
fn the_mass_correction_takes_the_leading_error_off_the_time_step() {
    for rho_inf in [1.0, 0.9] {
        let [coarse, fine] = [1e-3, 5e-4].map(|h| phase_error(h, rho_inf, false).abs());
        let order = (coarse / fine).log2();
        assert!(
            (order - 2.0).abs() < 0.1,
            "plain, {rho_inf}: {coarse} {fine}, order {order}"
        );
        // (ω h)² (1/12 + 3/8 r²) of ten periods.
        let omega = 2.0 * std::f64::consts::PI / 20.0 * (20_000.0_f64 / 1.35).sqrt();
        let r = (1.0 - rho_inf) / (1.0 + rho_inf);
        let expected = 20.0 * std::f64::consts::PI * (omega * 1e-3).powi(2) * (1.0 / 12.0 + 0.375 * r * r);
        assert!((coarse / expected - 1.0).abs() < 0.01, "{coarse} against {expected}");
        let [corrected, finer] = [1e-3, 5e-4].map(|h| phase_error(h, rho_inf, true).abs());
        println!("rho {rho_inf}: {coarse:.3e} {fine:.3e} corrected {corrected:.3e} {finer:.3e}");
        assert!(corrected < 0.02 * coarse, "{rho_inf}: {corrected} of {coarse}");
    }
}

/// Largest error of the waves that a strip at two thirds of their speed, whose force changes with 20 Hz, sends ahead of
/// itself along a string, as a share of their amplitude; the step is `h` s.
///
/// A string that a force moves along with the speed `v` from x = x₀ has at a place `x` ahead of it the height `∫₀^τ F
/// dt / (2 m c)`, `τ = (c t − (x − x₀))/(c − v)` [d'Alembert]. `F` is what the contact was found to have.
fn error_ahead_of_a_strip(h: f64, corrected_load: bool) -> f64 {
    const LENGTH: f64 = 60.0;
    const ELEMENTS: usize = 240;
    const START: f64 = 10.0;
    const SEEN_AT: f64 = 50.0;
    let section = WireSection {
        bending_stiffness: 0.0,
        ..SECTION
    };
    let material = Material { section, ..MATERIAL };
    let mut wire = SingleWire::planar(&material, LENGTH, ELEMENTS)
        .pinned(0)
        .pinned(ELEMENTS);
    wire.wire = wire.wire.with_mass_correction(h);
    let (m, c) = (
        section.mass_per_length,
        (section.tension / section.mass_per_length).sqrt(),
    );
    let v = 2.0 / 3.0 * c;
    let law = PenaltyContact {
        // Soft, so that the elements underneath are not felt.
        stiffness: 2e3,
        damping: 0.0,
    };
    let kappa = 1.0 / 6.0;
    let curve = Arc::new(CorrectedWire {
        geometry: Arc::clone(wire.geometry()),
        compliance: ResidualCompliance::new(wire.geometry(), &section, v).map(Arc::new),
        load: corrected_load.then_some(LoadCorrection { step: h, kappa }),
        surface: None,
    });
    let strip = Box::new(PrescribedStrip { first: 0 });
    wire.contact = Some(ContactPair::new(law, curve, strip, 1.2, ContactTangent::RankOne));
    // Height that gives a force which starts smoothly and then is 0.5 to 1.5 N, so that the tension stays constant.
    let omega = 40.0 * std::f64::consts::PI;
    let rise = 1.0 / (2.0 * m * c);
    const SETTLED: f64 = 0.02;
    let height = |t: f64| {
        let start = SETTLED * (2.0 - (2.0 + t / SETTLED) * (-t / SETTLED).exp());
        rise * (t - 0.5 * (omega * t).sin() / omega - 0.5 * start)
    };
    let rate = |t: f64| rise * (1.0 - 0.5 * (omega * t).cos() - 0.5 * (1.0 + t / SETTLED) * (-t / SETTLED).exp());
    let mut integrator = integration_tests::single_wire::trapezoid(1e-7);
    let mut state = wire.layout.state_at_rest();
    let (mut impulse, mut before, mut worst) = (vec![0.0], 0.0, 0.0_f64);
    let steps = (0.375 / h) as usize;
    for step in 1..=steps {
        let t = step as f64 * h;
        let pressed = 2.0 * m * c * rate(t) / law.stiffness;
        let u = [START + v * t, 0.0, height(t) + pressed, v, 0.0, 0.0, 0.0, 0.0];
        integrator
            .step(&mut wire, &mut state, &u, t, h)
            .expect("the wire moves on");
        let contact = wire.contact.as_ref().expect("set above");
        let force = contact.state(&state.motion(&u)).expect("on the wire").force;
        let so_far = impulse[step - 1];
        impulse.push(so_far + 0.5 * h * (before + force));
        before = force;
        let tau = (c * t - (SEEN_AT - START)) / (c - v);
        if tau > 0.0 {
            let (whole, part) = ((tau / h) as usize, (tau / h).fract());
            let exact = (impulse[whole] + part * (impulse[whole + 1] - impulse[whole])) / (2.0 * m * c);
            // The short waves of the start have passed, or have not come yet.
            if tau > 0.02 {
                worst = worst.max((wire.point(SEEN_AT, &state).r.z - exact).abs());
            }
        }
    }
    worst / (0.5 * rise / omega)
}

#[test]
fn a_moving_force_is_corrected_with_the_mass() {
    let h = 5e-4;
    let [plain, corrected] = [false, true].map(|load| error_ahead_of_a_strip(h, load));
    // Forces that change with `Ω` at the nodes, three times as fast as that of the contact, send out waves that are by
    // `(Ω h)²/6` too small.
    let omega = 3.0 * 40.0 * std::f64::consts::PI;
    let expected = (omega * h).powi(2) / 6.0;
    println!("plain {plain:.3e}, corrected {corrected:.3e}; closed form {expected:.3e}");
    assert!((plain / expected - 1.0).abs() < 0.15, "{plain} against {expected}");
    // A ninth remains, because the contact force itself changes, and the error of the mesh: 8 elements per wave.
    assert!(corrected < 0.25 * plain, "{corrected} of {plain}");
}

#[test]
fn statics_of_a_corrected_coarse_mesh_are_those_of_a_fine_one() {
    let mut catenary = scene_line(EN, &[]);
    catenary.tension_lengths[0].span_lengths.truncate(4);
    catenary.mesh.division = Division::PerInterval(4);
    let corrections = LineOptions {
        layers: BendingLayers::AtAttachments,
        contact_compliance: Some(83.3),
        mass_correction: Some(MassCorrection {
            steps: CorrectedSteps::alike(1e-3),
            rho_inf: 0.9,
        }),
        ..LineOptions::default()
    };
    let coarse = StaticLine::solve(&catenary, LineOptions::default()).unwrap();
    let corrected = StaticLine::solve(&catenary, corrections).unwrap();
    catenary.mesh.division = Division::PerInterval(32);
    let fine = StaticLine::solve(&catenary, LineOptions::default()).unwrap();
    for (a, b) in corrected.report().droppers.iter().zip(&fine.report().droppers) {
        assert!((a.force - b.force).abs() < 1e-3 * b.force, "{} {}", a.force, b.force);
    }
    // At attachments, and between them and between nodes.
    let x = [60.0, 61.3, 65.0, 66.1, 70.5, 73.8, 90.0, 93.1];
    let [coarse, corrected, fine] = [&coarse, &corrected, &fine].map(|line| line.elasticity(&x).unwrap());
    let mut worst = (0.0_f64, 0.0_f64);
    for ((coarse, corrected), fine) in coarse.iter().zip(&corrected).zip(&fine) {
        println!(
            "x = {}: {:.5} {:.5} {:.5} mm/N",
            fine.x,
            1e3 * coarse.elasticity,
            1e3 * corrected.elasticity,
            1e3 * fine.elasticity
        );
        worst.0 = worst.0.max((coarse.elasticity / fine.elasticity - 1.0).abs());
        worst.1 = worst.1.max((corrected.elasticity / fine.elasticity - 1.0).abs());
    }
    assert!(
        worst.1 < 5e-4 && worst.1 < 0.2 * worst.0,
        "plain {}, corrected {}",
        worst.0,
        worst.1
    );
}

/// Four spans of the reference model at 300 km/h; `mesh` is `elements_per_interval=…` or `element_length=…`.
fn short(mesh: &str, corrections: &str, step: f64) -> Run {
    let mesh = format!("catenary.mesh.{mesh}");
    let corrections = format!("catenary.mesh.corrections={corrections}");
    let steps = [
        format!("solver.micro_step={step}"),
        format!("coupling.macro_step={step}"),
    ];
    let overrides = [
        "catenary.spans=4",
        "run.start_x=30",
        "run.duration=1.6",
        "run.evaluate={time=[0.3,1.3]}",
        &mesh,
        &corrections,
        &steps[0],
        &steps[1],
    ];
    run(scene_with(EN_300, &overrides), Mode::Monolithic, "corrections")
}

#[test]
fn a_corrected_mesh_is_several_times_closer_to_the_converged_force_than_a_plain_one() {
    let reference = short("elements_per_interval=14", "auto", 2.5e-4);
    let error = |run: &Run| 100.0 * run.filtered_difference(&reference) / reference.sigma();
    let eight = |corrections| error(&short("elements_per_interval=8", corrections, 1e-3));
    let [plain, corrected] = ["none", "auto"].map(eight);
    println!("8 elements per interval, 1 ms: plain {plain:.2} %, corrected {corrected:.2} % of σ");
    assert!(
        plain > 2.0 && corrected < 1.0 && corrected < 0.3 * plain,
        "plain {plain} %, corrected {corrected} %"
    );
    let [even, coarser] = [("0.8125", 1e-3), ("0.93", 1.6e-3)].map(|(length, step)| {
        let run = short(&format!("element_length={length}"), "auto", step);
        assert!(run.written.contains("mass_correction"), "{}", run.written);
        error(&run)
    });
    println!("76 even elements, 1 ms: {even:.2} %; 66, 1.6 ms: {coarser:.2} % of σ");
    // Equal longest element, and some of 0.71 m in place of 0.63 m.
    assert!(even < 1.25 * corrected, "{even} %, corrected {corrected} %");
    // Bound from fourth-order elements that are 1.14 times as long and second-order steps that are 1.6 times as long.
    assert!(coarser < 2.6 * corrected, "{coarser} %, corrected {corrected} %");
}

#[test]
fn a_run_starts_at_rest_on_a_corrected_mesh() {
    // A train that nearly stands: what moves in the first tenth of a second comes from the start alone.
    let overrides = [
        "catenary.spans=4",
        "catenary.mesh.elements_per_interval=4",
        "run.speed_kmh=0.001",
        "run.start_x=97.3",
        "run.duration=0.1",
        "run.evaluate={time=[0.0,0.1]}",
        "run.low_pass_hz=100",
    ];
    let run = run(scene_with(EN_300, &overrides), Mode::Monolithic, "corrections-start");
    let scene = &run.written;
    assert!(
        scene.contains("corrections = [\"contact_compliance\", \"bending_layers\", \"mass_correction\"]"),
        "{scene}"
    );
    let force = &run.record.pantographs[0].force;
    let change = force.iter().map(|f| (f - force[0]).abs()).fold(0.0, f64::max);
    assert!(change < 1e-3, "{change} N of {} N", force[0]);
}
