//! Time steps of a system with controllers.

use dynamics::{Motion, Simulator, State, StepError, System};

use crate::controller::{Controller, Reading};

/// A controller and the input of the system that its force is.
pub struct Channel {
    /// Controller.
    pub controller: Controller,
    /// Index in the inputs.
    pub input: usize,
}

/// Motion of a system, and its whole state with accelerations and multipliers.
pub type Moment<'a> = (Motion<'a>, &'a State);

/// Reads the instruments of a controller, counted from 0, at a moment of the system.
type Read<'a, S> = dyn FnMut(&mut S, Moment<'_>, usize, &mut Reading) + 'a;

/// Internal step that has ended: motion, multipliers, length and end, s.
pub type Ended<'a> = (Motion<'a>, &'a [f64], f64, f64);

/// Advances a system with controllers from `t` to `t + h`, s, from event to event.
///
/// `inputs_at(τ, u)` writes the other inputs at `t + τ`; `read(system, moment, k, reading)` reads the
/// instruments of controller `k`; `after` sees each internal step at its end. A force that jumps is taken into the
/// accelerations, see [`Simulator::jump`].
///
/// # Errors
/// See [`StepError`]; the caller restores the state that it saved before.
pub fn advance<S: System>(
    simulator: &mut Simulator<S>,
    channels: &mut [Channel],
    (t, h): (f64, f64),
    inputs_at: &mut dyn FnMut(f64, &mut [f64]),
    read: &mut Read<'_, S>,
    after: &mut dyn FnMut(&mut S, Ended<'_>),
) -> Result<(), StepError> {
    let end = t + h;
    let mut from = t;
    while from < end {
        let mut to = end;
        let mut jumped = false;
        for (k, channel) in channels.iter_mut().enumerate() {
            let (system, motion, state) = simulator.parts_with_state();
            jumped |= channel
                .controller
                .act(from, &mut |reading| read(system, (motion, state), k, reading))?;
            let event = channel.controller.next_event(from);
            // An event at the end belongs to the step that follows.
            if event > from && event < to * (1.0 - 1e-12) - 1e-12 {
                to = event;
            }
        }
        // A step without an event has its own length, to the last bit.
        let length = if from == t && to == end { h } else { to - from };
        if jumped {
            let forces = &mut |u: &mut [f64]| {
                for channel in &*channels {
                    u[channel.input] = channel.controller.force(from);
                }
            };
            simulator.jump_by(forces, length)?;
        }
        let count = simulator.micro_steps(length) as f64;
        let whole = length / count;
        let mut steps = 0.0;
        let channels = &*channels;
        simulator.advance(
            from,
            length,
            &mut |tau, u| {
                inputs_at(from - t + tau, u);
                for channel in channels {
                    u[channel.input] = channel.controller.force(from + tau);
                }
            },
            &mut |system, motion, lambda, dt| {
                // A step that was done in halves counts by its parts, which are exact.
                steps += dt / whole;
                let reached = if steps == count { to } else { from + steps * whole };
                after(system, (motion, lambda, dt, reached));
            },
        )?;
        from = to;
    }
    Ok(())
}
