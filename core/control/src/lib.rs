//! Control of a pantograph: a sampled controller sees contact force and motion through its sensors and commands an
//! actuator on the pantograph.
//!
//! A command is held from sample to sample, so that the force of the actuator is a known function of time between two
//! samples: line, pantograph and controller have no algebraic loop, as one system and in co-simulation alike.
//!
//! | file | subject |
//! | --- | --- |
//! | `actuator` | force of a drive behind its commands: limit, lag, limit of its rate |
//! | `law` | rules of the commands: PID, skyhook, linear-quadratic regulator |
//! | `controller` | delays and noise around a rule and a drive |
//! | `samples` | times of samples |
//! | `advance` | time steps of a system with controllers |
//! | `linear` | linear pantograph on a spring, from sample to sample |
//! | `riccati` | gains of the linear-quadratic regulator |
//! | `stability` | poles and delay margin of the sampled loop, of a rule that is asked by trials |
#![forbid(unsafe_code)]

mod actuator;
mod advance;
mod controller;
mod law;
mod linear;
mod riccati;
mod samples;
mod stability;

pub use actuator::{Drive, DriveState};
pub use advance::{Channel, Ended, Moment, advance};
pub use controller::{Asked, Controller, ControllerState, Reading, Rule};
pub use linear::{LinearPantograph, LinearParts};
pub use riccati::NoGains;
pub use samples::Samples;
pub use stability::{FEWEST_SAMPLES, SampledLoop};
