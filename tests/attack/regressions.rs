//! Cases that the attack has found, each with its smallest input.
use super::{IDENTIFIERS, SMALL, states};
use fmi2::import::StepOutcome;
use integration_tests::fmus::started;

/// A number of postcard's at `place`, and the place behind it.
fn number(bytes: &[u8], place: usize) -> (usize, usize) {
    let length = bytes[place..].iter().position(|byte| byte & 0x80 == 0).unwrap() + 1;
    let digits = bytes[place..place + length].iter().rev();
    let number = digits.fold(0, |number, byte| number << 7 | usize::from(byte & 0x7f));
    (number, place + length)
}

/// A saved state without parameters, its length and checksum right, made `fmi2GetReal` panic.
#[test]
fn regress_35_a_saved_state_of_another_shape_is_refused() {
    let _process = super::beside_others();
    for identifier in IDENTIFIERS {
        let fmu = SMALL.open(identifier);
        let mut instance = started(&fmu, "shape");
        let state = instance.save_state().unwrap();
        let mut bytes = instance.serialize_state(&state).unwrap();
        let begin = states::begin_of_model(&bytes);
        // The path of a scene and its text stand before the parameters.
        let (path, place) = number(&bytes, begin);
        let (text, place) = number(&bytes, place + path);
        let parameters = place + text;
        let (count, first) = number(&bytes, parameters);
        bytes.splice(parameters..first + 8 * count, [0]);
        let forged = instance.deserialize_state(&states::complete(bytes, begin)).unwrap();
        let refused = instance.restore_state(&forged).unwrap_err().to_string();
        let expected = format!("the saved state is not of this FMU: it has 0 parameters, must have {count}");
        assert!(refused.contains(&expected), "{refused}");
        instance.restore_state(&state).unwrap();
        assert_eq!(instance.do_step(0.0, 1e-3).unwrap(), StepOutcome::Ok);
    }
}

/// A step without end in sight never came back.
#[test]
fn regress_35_a_step_of_more_internal_steps_than_are_ever_made_is_discarded() {
    let _process = super::beside_others();
    for identifier in IDENTIFIERS {
        let fmu = SMALL.open(identifier);
        for step in [1e300, 1e9] {
            let mut instance = fmu.instantiate("long", false, false).unwrap();
            instance.setup_experiment(0.0, None, None).unwrap();
            instance.enter_initialization_mode().unwrap();
            instance.exit_initialization_mode().unwrap();
            assert_eq!(instance.do_step(0.0, step).unwrap(), StepOutcome::Discard);
        }
    }
}
