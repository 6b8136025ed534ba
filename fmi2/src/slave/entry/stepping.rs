//! Steps, derivatives and their status.

use super::values::finite;
use crate::abi::{
    FALSE, Status, StatusKind, fmi2Boolean, fmi2Component, fmi2Integer, fmi2Real, fmi2Status, fmi2StatusKind,
    fmi2String, fmi2ValueReference,
};
use crate::model_description::{BaseType, Causality, Variable};
use crate::slave::instance::{Failure, Instance, elements, elements_mut, enter, refuse};
use crate::slave::model::{Model, ModelError};
use crate::slave::phase::Call;

/// Tolerance of times of the importer, which adds up step sizes: relative, and absolute below 1 s.
const TIME_TOLERANCE: f64 = 1e-9;

/// `fmi2DoStep`. The promise not to come back to this point is ignored: a state may always be restored.
pub unsafe fn do_step<M: Model>(
    component: fmi2Component,
    time: fmi2Real,
    step: fmi2Real,
    _no_set_fmu_state_prior_to_current_point: fmi2Boolean,
) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        let progress = &instance.progress;
        if !time.is_finite() || !step.is_finite() || step <= 0.0 {
            return refuse(format!(
                "a step from t = {time} s by {step} s: the step size must be positive and both finite"
            ));
        }
        if (time - progress.time).abs() > TIME_TOLERANCE * time.abs().max(1.0) {
            return refuse(format!(
                "a step from t = {time} s, but the last one ended at t = {} s",
                progress.time
            ));
        }
        let end = time + step;
        if let Some(stop) = progress.experiment.stop_time
            && end > stop + TIME_TOLERANCE * stop.abs().max(1.0)
        {
            return refuse(format!("a step to t = {end} s, which is after the stop time, {stop} s"));
        }
        instance.model.do_step(time, step)?;
        instance.progress.time = end;
        instance.progress.step_status = Status::Ok;
        Ok(Status::Ok)
    };
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::DoStep, "fmi2DoStep", body) }
}

/// `fmi2CancelStep`: there is never a step to cancel.
pub unsafe fn cancel_step<M: Model>(component: fmi2Component) -> fmi2Status {
    let body = |_: &mut Instance<M>| refuse("steps are not asynchronous, there is none to cancel");
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::CancelStep, "fmi2CancelStep", body) }
}

/// The real variable behind a reference, of that causality.
fn real<M: Model>(
    instance: &Instance<M>,
    reference: fmi2ValueReference,
    causality: Causality,
) -> Result<(usize, &Variable), Failure> {
    let (position, variable) = instance.variable(reference, BaseType::Real)?;
    if variable.causality == causality {
        return Ok((position, variable));
    }
    refuse(format!("{} is not an {causality:?}", variable.name))
}

/// Order of a derivative.
fn order(variable: &Variable, order: fmi2Integer) -> Result<u32, Failure> {
    match u32::try_from(order) {
        Ok(order) if order > 0 => Ok(order),
        _ => refuse(format!(
            "{}: derivatives of order {order} do not exist, the first is 1",
            variable.name
        )),
    }
}

/// `fmi2SetRealInputDerivatives`.
pub unsafe fn set_real_input_derivatives<M: Model>(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    orders: *const fmi2Integer,
    values: *const fmi2Real,
) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        // SAFETY: arrays of the importer.
        let references = unsafe { elements(references, count, "value references") }?;
        // SAFETY: as above.
        let orders = unsafe { elements(orders, count, "orders") }?;
        // SAFETY: as above.
        let values = unsafe { elements(values, count, "values") }?;
        for ((&reference, &n), &value) in references.iter().zip(orders).zip(values) {
            let (_, variable) = real(instance, reference, Causality::Input)?;
            order(variable, n)?;
            finite(variable, value)?;
        }
        for ((&reference, &n), &value) in references.iter().zip(orders).zip(values) {
            let (position, variable) = real(instance, reference, Causality::Input)?;
            let n = order(variable, n)?;
            instance.model.set_input_derivative(position, n, value)?;
        }
        Ok(Status::Ok)
    };
    let name = "fmi2SetRealInputDerivatives";
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::SetRealInputDerivatives, name, body) }
}

/// `fmi2GetRealOutputDerivatives`: 0 above the order that is known.
pub unsafe fn get_real_output_derivatives<M: Model>(
    component: fmi2Component,
    references: *const fmi2ValueReference,
    count: usize,
    orders: *const fmi2Integer,
    values: *mut fmi2Real,
) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        // SAFETY: arrays of the importer.
        let references = unsafe { elements(references, count, "value references") }?;
        // SAFETY: as above.
        let orders = unsafe { elements(orders, count, "orders") }?;
        // SAFETY: as above.
        let values = unsafe { elements_mut(values, count, "values") }?;
        for ((&reference, &n), value) in references.iter().zip(orders).zip(values) {
            let (position, variable) = real(instance, reference, Causality::Output)?;
            let n = order(variable, n)?;
            let found = instance.model.output_derivative(position, n)?;
            if !found.is_finite() {
                let (name, time) = (&instance.variables[position].name, instance.progress.time);
                let message = format!("derivative {n} of {name} = {found} at t = {time} s: is not finite");
                return Err(ModelError::unusable(message).into());
            }
            *value = found;
        }
        Ok(Status::Ok)
    };
    let name = "fmi2GetRealOutputDerivatives";
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::GetRealOutputDerivatives, name, body) }
}

/// `fmi2GetDirectionalDerivative`: the Jacobian of outputs with respect to inputs, times the seed.
pub unsafe fn get_directional_derivative<M: Model>(
    component: fmi2Component,
    unknowns: *const fmi2ValueReference,
    unknown_count: usize,
    knowns: *const fmi2ValueReference,
    known_count: usize,
    seed: *const fmi2Real,
    derivatives: *mut fmi2Real,
) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        // SAFETY: arrays of the importer.
        let unknowns = unsafe { elements(unknowns, unknown_count, "unknowns") }?;
        // SAFETY: as above.
        let knowns = unsafe { elements(knowns, known_count, "knowns") }?;
        // SAFETY: as above.
        let seed = unsafe { elements(seed, known_count, "seeds") }?;
        // SAFETY: as above.
        let derivatives = unsafe { elements_mut(derivatives, unknown_count, "derivatives") }?;
        for &unknown in unknowns {
            real(instance, unknown, Causality::Output)?;
        }
        for (&known, &value) in knowns.iter().zip(seed) {
            let (_, variable) = real(instance, known, Causality::Input)?;
            finite(variable, value)?;
        }
        for (&unknown, derivative) in unknowns.iter().zip(derivatives) {
            let (output, _) = real(instance, unknown, Causality::Output)?;
            let mut sum = 0.0;
            for (&known, &value) in knowns.iter().zip(seed).filter(|(_, value)| **value != 0.0) {
                let (input, _) = real(instance, known, Causality::Input)?;
                sum += value * instance.model.directional_derivative(output, input)?;
            }
            if !sum.is_finite() {
                let name = &instance.variables[output].name;
                return refuse(format!(
                    "the derivative of {name} for these seeds is {sum}: is not finite"
                ));
            }
            *derivative = sum;
        }
        Ok(Status::Ok)
    };
    let name = "fmi2GetDirectionalDerivative";
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::GetDirectionalDerivative, name, body) }
}

/// Answers a status request; `None` is `fmi2Discard`, "cannot be answered" [FMI 2.0, 4.2.3].
unsafe fn status<M: Model, T>(
    component: fmi2Component,
    name: &str,
    kind: fmi2StatusKind,
    value: *mut T,
    answer: impl Fn(&Instance<M>, StatusKind) -> Option<T>,
) -> fmi2Status {
    let body = |instance: &mut Instance<M>| {
        // SAFETY: null or the importer's variable.
        let Some(value) = (unsafe { value.as_mut() }) else {
            return refuse("the pointer to the value is null");
        };
        let kind = StatusKind::try_from(kind).map_err(|unknown| Failure::Refused(unknown.to_string()))?;
        Ok(match answer(instance, kind) {
            Some(answer) => {
                *value = answer;
                Status::Ok
            }
            None => Status::Discard,
        })
    };
    // SAFETY: the condition of this module.
    unsafe { enter::<M>(component, Call::GetStatus, name, body) }
}

/// `fmi2GetStatus`: the status of the last step.
pub unsafe fn get_status<M: Model>(
    component: fmi2Component,
    kind: fmi2StatusKind,
    value: *mut fmi2Status,
) -> fmi2Status {
    let answer = |instance: &Instance<M>, kind| {
        (kind == StatusKind::DoStepStatus).then_some(instance.progress.step_status as fmi2Status)
    };
    // SAFETY: the condition of this module.
    unsafe { status::<M, _>(component, "fmi2GetStatus", kind, value, answer) }
}

/// `fmi2GetRealStatus`: the end of the last completed step; after `fmi2Discard` the start of the failed one.
pub unsafe fn get_real_status<M: Model>(
    component: fmi2Component,
    kind: fmi2StatusKind,
    value: *mut fmi2Real,
) -> fmi2Status {
    let answer =
        |instance: &Instance<M>, kind| (kind == StatusKind::LastSuccessfulTime).then_some(instance.progress.time);
    // SAFETY: the condition of this module.
    unsafe { status::<M, _>(component, "fmi2GetRealStatus", kind, value, answer) }
}

/// `fmi2GetIntegerStatus`: nothing to ask for.
pub unsafe fn get_integer_status<M: Model>(
    component: fmi2Component,
    kind: fmi2StatusKind,
    value: *mut fmi2Integer,
) -> fmi2Status {
    // SAFETY: the condition of this module.
    unsafe { status::<M, _>(component, "fmi2GetIntegerStatus", kind, value, |_, _| None) }
}

/// `fmi2GetBooleanStatus`: the instance never wants to end the simulation.
pub unsafe fn get_boolean_status<M: Model>(
    component: fmi2Component,
    kind: fmi2StatusKind,
    value: *mut fmi2Boolean,
) -> fmi2Status {
    let answer = |_: &Instance<M>, kind| (kind == StatusKind::Terminated).then_some(FALSE);
    // SAFETY: the condition of this module.
    unsafe { status::<M, _>(component, "fmi2GetBooleanStatus", kind, value, answer) }
}

/// `fmi2GetStringStatus`: nothing is ever pending.
pub unsafe fn get_string_status<M: Model>(
    component: fmi2Component,
    kind: fmi2StatusKind,
    value: *mut fmi2String,
) -> fmi2Status {
    // SAFETY: the condition of this module.
    unsafe { status::<M, _>(component, "fmi2GetStringStatus", kind, value, |_, _| None) }
}
