//! The export runtime, driven by the importer through the C interface.

mod support;

use fmi2::Error;
use fmi2::abi::Status;
use fmi2::import::{Instance, StepOutcome};
use support::{at, example, initialise, instance, real, running, steps};

const FORCE: &[u32] = &[at::FORCE as u32];
const X: &[u32] = &[at::X as u32];

/// The message of an error that must be `fmi2Error`.
fn refused<T: std::fmt::Debug>(result: Result<T, Error>) -> String {
    match result {
        Err(Error::Call {
            status: Status::Error,
            log,
            ..
        }) => {
            assert_eq!(log.0.len(), 1, "one message: {log:?}");
            log.0[0].clone()
        }
        other => panic!("expected fmi2Error, got {other:?}"),
    }
}

fn set_trouble(instance: &mut Instance, trouble: i32) {
    instance.set_integer(&[at::TROUBLE as u32], &[trouble]).unwrap();
}

#[test]
fn the_oscillator_follows_its_closed_form() {
    let example = example();
    let mut osc = instance(&example.fmu);
    osc.set_real(&[at::DAMPING as u32], &[0.0]).unwrap();
    initialise(&mut osc);
    for n in 0..1000 {
        assert_eq!(osc.do_step(f64::from(n) * 1e-3, 1e-3).unwrap(), StepOutcome::Ok);
    }
    // x = 0.1 cos(20 t); classical Runge-Kutta loses 1e-9 over 20 rad in steps of 0.02 rad
    assert!((real(&mut osc, at::X) - 0.1 * 20.0_f64.cos()).abs() < 1e-8);
    let mut derivatives = [0.0; 3];
    osc.get_real_output_derivatives(&[1, 1, 1], &[1, 2, 3], &mut derivatives)
        .unwrap();
    assert!((derivatives[0] + 2.0 * 20.0_f64.sin()).abs() < 1e-6);
    assert_eq!(derivatives[2], 0.0, "an order above the known ones is 0");
    let (mut integer, mut boolean) = ([0], [true]);
    osc.get_integer(&[at::STEPS as u32], &mut integer).unwrap();
    osc.get_boolean(&[at::ABOVE as u32], &mut boolean).unwrap();
    assert_eq!((integer[0], boolean[0]), (1000, 20.0_f64.cos() > 0.0));
    osc.terminate().unwrap();
    assert!(real(&mut osc, at::X).is_finite(), "values stay readable");
}

#[test]
fn texts_and_parameters_are_set_and_read() {
    let example = example();
    let mut osc = instance(&example.fmu);
    osc.set_string(&[at::LABEL as u32], &["Fahrdraht ü %s #"]).unwrap();
    osc.set_boolean(&[at::USE_DERIVATIVES as u32], &[false]).unwrap();
    osc.set_real(&[at::MASS as u32, at::START as u32], &[3.0, 0.25])
        .unwrap();
    osc.setup_experiment(0.0, None, None).unwrap();
    osc.enter_initialization_mode().unwrap();
    assert_eq!(osc.get_string(&[at::LABEL as u32]).unwrap(), ["Fahrdraht ü %s #"]);
    assert_eq!(
        real(&mut osc, at::X),
        0.25,
        "an output follows its parameter in initialisation mode"
    );
    osc.set_real(&[at::START as u32], &[0.5]).unwrap();
    assert_eq!(real(&mut osc, at::X), 0.5, "also when the parameter is set again");
    osc.exit_initialization_mode().unwrap();
    let mut derivative = [0.0];
    osc.directional_derivative(&[at::A as u32], FORCE, &[6.0], &mut derivative)
        .unwrap();
    assert_eq!(derivative[0], 2.0, "∂a/∂F = 1/m = 1/3, times the seed 6");
    let before = real(&mut osc, at::A);
    osc.set_real(FORCE, &[6.0]).unwrap();
    assert!(
        (real(&mut osc, at::A) - before - 2.0).abs() < 1e-12,
        "read after set without a step"
    );
}

#[test]
fn calls_in_the_wrong_order_are_refused() {
    let example = example();
    let mut value = [0.0];
    type Call<'a> = (&'a str, &'a dyn Fn(&mut Instance) -> Result<(), Error>);
    let before: [Call<'_>; 7] = [
        ("fmi2ExitInitializationMode is illegal before initialisation", &|i| {
            i.exit_initialization_mode()
        }),
        ("fmi2DoStep is illegal before initialisation", &|i| {
            i.do_step(0.0, 1e-3).map(|_| ())
        }),
        ("fmi2Terminate is illegal before initialisation", &|i| i.terminate()),
        ("fmi2GetReal is illegal before initialisation", &|i| {
            i.get_real(X, &mut [0.0])
        }),
        ("fmi2GetRealStatus is illegal before initialisation", &|i| {
            i.last_successful_time().map(|_| ())
        }),
        ("fmi2GetRealOutputDerivatives is illegal before initialisation", &|i| {
            i.get_real_output_derivatives(X, &[1], &mut [0.0])
        }),
        ("fmi2GetDirectionalDerivative is illegal before initialisation", &|i| {
            i.directional_derivative(X, FORCE, &[1.0], &mut [0.0])
        }),
    ];
    for (message, call) in before {
        assert_eq!(refused(call(&mut instance(&example.fmu))), message);
    }
    let initialising: [Call<'_>; 5] = [
        ("fmi2SetupExperiment is illegal in initialisation mode", &|i| {
            i.setup_experiment(0.0, None, None)
        }),
        ("fmi2EnterInitializationMode is illegal in initialisation mode", &|i| {
            i.enter_initialization_mode()
        }),
        ("fmi2DoStep is illegal in initialisation mode", &|i| {
            i.do_step(0.0, 1e-3).map(|_| ())
        }),
        ("fmi2Terminate is illegal in initialisation mode", &|i| i.terminate()),
        ("fmi2GetBooleanStatus is illegal in initialisation mode", &|i| {
            i.wants_to_terminate().map(|_| ())
        }),
    ];
    for (message, call) in initialising {
        let mut osc = instance(&example.fmu);
        osc.setup_experiment(0.0, None, None).unwrap();
        osc.enter_initialization_mode().unwrap();
        assert_eq!(refused(call(&mut osc)), message);
    }
    let stepping: [Call<'_>; 5] = [
        ("fmi2SetupExperiment is illegal between steps", &|i| {
            i.setup_experiment(0.0, None, None)
        }),
        ("fmi2EnterInitializationMode is illegal between steps", &|i| {
            i.enter_initialization_mode()
        }),
        ("fmi2ExitInitializationMode is illegal between steps", &|i| {
            i.exit_initialization_mode()
        }),
        (
            "fmi2SetReal: mass, a Fixed Parameter, cannot be set between steps",
            &|i| i.set_real(&[at::MASS as u32], &[1.0]),
        ),
        (
            "fmi2SetReal: x, a Continuous Output, cannot be set between steps",
            &|i| i.set_real(X, &[1.0]),
        ),
    ];
    for (message, call) in stepping {
        let mut osc = running(&example.fmu);
        assert_eq!(refused(call(&mut osc)), message);
        assert_eq!(refused(osc.do_step(0.0, 1e-3)), "fmi2DoStep is illegal after an error");
        osc.get_real(X, &mut value).unwrap(); // for diagnosis
        assert_eq!(refused(osc.terminate()), "fmi2Terminate is illegal after an error");
    }
    let mut osc = running(&example.fmu);
    osc.terminate().unwrap();
    assert_eq!(
        refused(osc.do_step(0.0, 1e-3)),
        "fmi2DoStep is illegal after fmi2Terminate"
    );
}

#[test]
fn refused_arguments_are_named_and_a_refused_read_has_no_consequence() {
    let example = example();
    let mut osc = running(&example.fmu);
    let mut value = [0.0];
    assert_eq!(
        refused(osc.get_real(&[4_294_967], &mut value)),
        "fmi2GetReal: there is no value reference 4294967; the highest is 12"
    );
    assert_eq!(
        refused(osc.get_real(&[at::STEPS as u32], &mut value)),
        "fmi2GetReal: value reference 9 is steps of type Integer, not Real"
    );
    assert_eq!(
        refused(osc.directional_derivative(X, &[at::MASS as u32], &[1.0], &mut value)),
        "fmi2GetDirectionalDerivative: mass is not an Input"
    );
    assert_eq!(
        refused(osc.get_real_output_derivatives(X, &[0], &mut value)),
        "fmi2GetRealOutputDerivatives: x: derivatives of order 0 do not exist, the first is 1"
    );
    steps(&mut osc, 0, 1);
    type Call<'a> = (&'a str, &'a dyn Fn(&mut Instance) -> Result<(), Error>);
    let calls: [Call<'_>; 9] = [
        ("fmi2SetReal: force = NaN N: must be finite", &|i| {
            i.set_real(FORCE, &[f64::NAN])
        }),
        ("fmi2SetReal: force = -inf N: must be finite", &|i| {
            i.set_real(FORCE, &[f64::NEG_INFINITY])
        }),
        ("fmi2SetReal: there is no value reference 99; the highest is 12", &|i| {
            i.set_real(&[at::FORCE as u32, 99], &[5.0, 5.0])
        }),
        ("fmi2SetRealInputDerivatives: force = inf N: must be finite", &|i| {
            i.set_real_input_derivatives(FORCE, &[1], &[f64::INFINITY])
        }),
        ("fmi2SetRealInputDerivatives: x is not an Input", &|i| {
            i.set_real_input_derivatives(X, &[1], &[1.0])
        }),
        (
            "a step from t = 0 s by -0.001 s: the step size must be positive and both finite",
            &|i| i.do_step(0.0, -1e-3).map(|_| ()),
        ),
        (
            "a step from t = 0 s by NaN s: the step size must be positive and both finite",
            &|i| i.do_step(0.0, f64::NAN).map(|_| ()),
        ),
        ("a step from t = 0.5 s, but the last one ended at t = 0 s", &|i| {
            i.do_step(0.5, 1e-3).map(|_| ())
        }),
        ("a step to t = 10.001 s, which is after the stop time, 10 s", &|i| {
            i.do_step(0.0, 10.001).map(|_| ())
        }),
    ];
    for (message, call) in calls {
        let mut osc = running(&example.fmu);
        let text = refused(call(&mut osc));
        assert!(text.ends_with(message), "{text}");
        assert_eq!(real(&mut osc, at::FORCE), 0.0, "nothing is half set");
        osc.reset().unwrap();
        initialise(&mut osc);
        assert_eq!(
            steps(&mut osc, 0, 20),
            steps(&mut running(&example.fmu), 0, 20),
            "as new after reset"
        );
    }
}

#[test]
fn times_that_differ_by_rounding_are_accepted() {
    let example = example();
    let mut osc = running(&example.fmu);
    let (mut t, h) = (0.0, 1e-3 + 9e-19);
    for _ in 0..10_000 {
        osc.do_step(t, h).unwrap();
        t += h; // as importers do, up to the stop time
    }
    assert_eq!(osc.last_successful_time().unwrap(), Some(t));
}

#[test]
fn a_panic_in_the_model_becomes_an_error_and_the_host_survives() {
    let example = example();
    let mut osc = running(&example.fmu);
    let saved = osc.save_state().unwrap();
    set_trouble(&mut osc, 1);
    let message = refused(osc.do_step(0.0, 1e-3));
    assert!(
        message.starts_with("fmi2DoStep panicked: no luck at t = 0 s ("),
        "{message}"
    );
    assert_eq!(
        refused(osc.get_real(X, &mut [0.0])),
        "fmi2GetReal is illegal after a panic"
    );
    assert_eq!(refused(osc.save_state()), "fmi2GetFMUstate is illegal after a panic");
    osc.restore_state(&saved).unwrap();
    let reference = steps(&mut running(&example.fmu), 0, 20);
    assert_eq!(steps(&mut osc, 0, 20), reference, "a restored instance goes on");
    set_trouble(&mut osc, 1);
    refused(osc.do_step(0.02, 1e-3));
    osc.reset().unwrap();
    initialise(&mut osc);
    assert_eq!(steps(&mut osc, 0, 20), reference, "a reset instance is as new");
}

#[test]
fn a_discarded_step_can_be_repeated_with_a_smaller_one() {
    let example = example();
    let mut osc = running(&example.fmu);
    osc.do_step(0.0, 0.01).unwrap();
    set_trouble(&mut osc, 2);
    let saved = osc.save_state().unwrap();
    let before = real(&mut osc, at::X);
    assert_eq!(osc.do_step(0.01, 2e-3).unwrap(), StepOutcome::Discard);
    assert_eq!(osc.last_successful_time().unwrap(), Some(0.01), "the start of the step");
    assert!(!osc.wants_to_terminate().unwrap());
    assert_eq!(real(&mut osc, at::X), before);
    assert_eq!(
        refused(osc.do_step(0.01, 1e-3)),
        "fmi2DoStep is illegal after a discarded step"
    );
    osc.restore_state(&saved).unwrap();
    assert_eq!(osc.do_step(0.01, 1e-3).unwrap(), StepOutcome::Ok);
    assert_eq!(osc.do_step(0.011, 1e-3).unwrap(), StepOutcome::Ok);
    set_trouble(&mut osc, 3);
    assert_eq!(refused(osc.do_step(0.012, 1e-3)), "fmi2DoStep: the matrix is singular");
}

#[test]
fn an_output_that_is_not_finite_is_an_error() {
    let example = example();
    let mut osc = running(&example.fmu);
    set_trouble(&mut osc, 4);
    assert_eq!(
        refused(osc.get_real(X, &mut [0.0])),
        "fmi2GetReal: x = NaN at t = 0 s: is not finite"
    );
}

/// Derivatives of huge seeds and forces were handed out as infinity with `fmi2OK`.
#[test]
fn regress_35_derivatives_that_are_not_finite_are_errors() {
    let example = example();
    let mut osc = instance(&example.fmu);
    osc.set_real(&[at::MASS as u32], &[1e-3]).unwrap();
    osc.set_real(FORCE, &[f64::MAX]).unwrap();
    initialise(&mut osc);
    let mut value = [0.0];
    assert_eq!(
        refused(osc.directional_derivative(&[at::A as u32], FORCE, &[f64::MAX], &mut value)),
        "fmi2GetDirectionalDerivative: the derivative of a for these seeds is inf: is not finite"
    );
    assert_eq!(
        refused(osc.get_real_output_derivatives(X, &[2], &mut value)),
        "fmi2GetRealOutputDerivatives: derivative 2 of x = inf at t = 0 s: is not finite"
    );
}

#[test]
fn a_restored_state_repeats_bit_for_bit() {
    let example = example();
    let mut osc = running(&example.fmu);
    steps(&mut osc, 0, 30);
    let mut saved = osc.save_state().unwrap();
    let first = steps(&mut osc, 30, 50);
    for _ in 0..3 {
        osc.restore_state(&saved).unwrap();
        assert_eq!(steps(&mut osc, 30, 50), first);
    }
    osc.save_state_again(&saved).unwrap();
    let second = steps(&mut osc, 80, 20);
    osc.terminate().unwrap();
    osc.restore_state(&saved).unwrap();
    assert_eq!(
        steps(&mut osc, 80, 20),
        second,
        "also after terminate, from the state saved in place"
    );
    let other = osc.save_state().unwrap();
    osc.free_state(saved).unwrap();
    saved = osc.save_state().unwrap();
    osc.free_state(other).unwrap();
    osc.free_state(saved).unwrap();
}

#[test]
fn input_derivatives_are_followed_saved_and_cleared() {
    let example = example();
    let mut osc = running(&example.fmu);
    osc.set_real_input_derivatives(FORCE, &[1], &[1000.0]).unwrap();
    osc.set_real_input_derivatives(FORCE, &[2], &[1e9]).unwrap(); // ignored, not refused
    let saved = osc.save_state().unwrap();
    osc.do_step(0.0, 1e-3).unwrap();
    assert!(
        (real(&mut osc, at::FORCE) - 1.0).abs() < 1e-12,
        "the followed value is kept"
    );
    let followed = real(&mut osc, at::X);
    osc.restore_state(&saved).unwrap();
    osc.do_step(0.0, 1e-3).unwrap();
    assert_eq!(
        real(&mut osc, at::X).to_bits(),
        followed.to_bits(),
        "derivatives are part of the state"
    );
    osc.restore_state(&saved).unwrap();
    osc.set_real(FORCE, &[0.0]).unwrap();
    osc.do_step(0.0, 1e-3).unwrap();
    assert_eq!(real(&mut osc, at::FORCE), 0.0, "a set input loses its derivatives");
}

#[test]
fn a_serialised_state_continues_in_another_instance_and_damage_is_refused() {
    let example = example();
    let mut osc = running(&example.fmu);
    steps(&mut osc, 0, 30);
    let saved = osc.save_state().unwrap();
    let bytes = osc.serialize_state(&saved).unwrap();
    let expected = steps(&mut osc, 30, 50);
    drop(osc); // frees the state
    let mut other = instance(&example.fmu);
    let restored = other.deserialize_state(&bytes).unwrap();
    other.restore_state(&restored).unwrap();
    assert_eq!(steps(&mut other, 30, 50), expected);
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x10;
        refused(other.deserialize_state(&damaged));
        refused(other.deserialize_state(&bytes[..at]));
    }
    let mut longer = bytes.clone();
    longer.push(0);
    refused(other.deserialize_state(&longer));
    let message = refused(other.deserialize_state(&bytes[..bytes.len() - 1]));
    assert!(
        message.contains("checksum") || message.contains("truncated"),
        "{message}"
    );
    let message = refused(other.deserialize_state(b"something else entirely"));
    assert!(message.ends_with("wrong magic number"), "{message}");
    assert_eq!(steps(&mut other, 80, 1).len(), 1, "refused bytes have no consequence");
}

#[test]
fn a_state_of_another_fmu_is_refused() {
    let (example, mut package) = (example(), support::package());
    let mut osc = running(&example.fmu);
    let saved = osc.save_state().unwrap();
    let bytes = osc.serialize_state(&saved).unwrap();
    package.resources.insert("other".into(), Vec::new());
    let path = example.folder.path().join("Other.fmu");
    package.write(&path).unwrap();
    let other = fmi2::import::Fmu::open(&path).unwrap();
    let message = refused(instance(&other).deserialize_state(&bytes));
    assert!(message.contains(&example.fmu.description().guid), "{message}");
    assert!(message.contains(&other.description().guid), "{message}");
}

#[test]
fn two_instances_do_not_share_state() {
    let example = example();
    let alone = steps(&mut running(&example.fmu), 0, 100);
    let (mut a, mut b) = (running(&example.fmu), instance(&example.fmu));
    b.set_real(&[at::START as u32], &[0.2]).unwrap();
    initialise(&mut b);
    for (n, expected) in alone.iter().enumerate() {
        let (xa, xb) = (steps(&mut a, n, 1), steps(&mut b, n, 1));
        assert_eq!(xa[0], *expected);
        assert_ne!(xb[0], *expected);
    }
}

#[test]
fn instances_run_on_other_threads_with_small_stacks() {
    let example = example();
    let alone = steps(&mut running(&example.fmu), 0, 100);
    let threads: Vec<_> = (0..4)
        .map(|_| {
            let mut osc = running(&example.fmu);
            let small = std::thread::Builder::new().stack_size(256 << 10);
            small.spawn(move || steps(&mut osc, 0, 100)).unwrap()
        })
        .collect();
    for thread in threads {
        assert_eq!(thread.join().unwrap(), alone);
    }
}

#[test]
fn a_thousand_instances_come_and_go_in_every_phase() {
    let example = example();
    for n in 0..1000 {
        let mut osc = instance(&example.fmu);
        if n % 4 > 0 {
            osc.setup_experiment(0.0, None, None).unwrap();
            osc.enter_initialization_mode().unwrap();
        }
        if n % 4 > 1 {
            osc.exit_initialization_mode().unwrap();
            osc.save_state().unwrap();
        }
        if n % 4 > 2 {
            osc.set_real(FORCE, &[f64::NAN]).unwrap_err();
        }
    }
}

#[test]
fn logging_follows_its_categories_and_errors_are_always_logged() {
    let example = example();
    let mut osc = example.fmu.instantiate("osc", false, true).unwrap();
    osc.set_real(FORCE, &[1.0]).unwrap();
    osc.set_real(FORCE, &[2.0]).unwrap();
    let log = osc.take_log();
    assert_eq!(log.len(), 1, "an oddity is mentioned once: {log:?}");
    assert_eq!((log[0].category.as_str(), log[0].status), ("logEvents", Status::Ok));
    osc.set_debug_logging(true, &["logStatusDiscard"]).unwrap();
    initialise(&mut osc);
    set_trouble(&mut osc, 2);
    steps(&mut osc, 0, 100);
    assert_eq!(osc.take_log(), [], "nothing per step");
    osc.do_step(0.1, 0.01).unwrap();
    assert_eq!(
        osc.take_log()[0].text,
        "fmi2DoStep: no equilibrium at t = 0.1 s, h = 0.01 s"
    );
    osc.set_debug_logging(true, &["logNonsense", "logStatusWarning"])
        .unwrap();
    let log = osc.take_log();
    assert_eq!(
        (log[0].status, log[0].text.contains("logNonsense")),
        (Status::Warning, true)
    );
    osc.set_debug_logging(false, &[]).unwrap();
    refused(osc.do_step(0.0, 0.0));
}

#[test]
fn a_wrong_guid_and_a_missing_resource_are_refused_with_a_message() {
    let example = example();
    std::fs::write(example.fmu.folder().join("resources/guid.txt"), "{other}").unwrap();
    let error = example.fmu.instantiate("osc", false, false).unwrap_err();
    let expected = format!(
        "fmi2Instantiate: the GUID {} is not that of this FMU, {{other}}",
        example.fmu.description().guid
    );
    assert_eq!(
        error.to_string(),
        format!("Oscillator: fmi2Instantiate of \"osc\" failed: {expected}")
    );
    std::fs::remove_file(example.fmu.folder().join("resources/guid.txt")).unwrap();
    let error = example.fmu.instantiate("osc", false, false).unwrap_err().to_string();
    assert!(error.contains("resources/guid.txt: No such file"), "{error}");
    let error = example.fmu.instantiate(" ", false, false).unwrap_err().to_string();
    assert_eq!(error, "instance name \" \" cannot be passed to an FMU");
}
