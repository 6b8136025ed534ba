//! Equilibrium, and motion in time.
//!
//! | file | subject |
//! | --- | --- |
//! | `scheme` | coefficients of generalized-α |
//! | `fastest` | the fastest oscillation of a small system |
//! | `generalized_alpha` | the time step: prediction, corrections, end |
//! | `memory` | what the integrator keeps from step to step, saved and restored |
//! | `passes` | prediction and correction of all coordinates in vector registers |
//! | `formulation` | index 3, and index 1 with Baumgarte's stabilisation |
//! | `moving_multipliers` | multipliers of constraints that move along the coordinates |
//! | `convergence_estimate` | residual of a correction, estimated without evaluating it |
//! | `newton` | options, errors and work counters of Newton's method |
//! | `workspace` | matrix, low-rank terms and buffers that statics and time steps share |
//! | `residual` | residual of the equations of motion: whole, in ranges, or known |
//! | `start` | consistent velocities, accelerations and multipliers at the start of a motion |
//! | `statics` | static equilibrium |
//! | `simulator` | a system in time: sub-steps inside a communication step, checkpoints |

pub(crate) mod convergence_estimate;
pub(crate) mod fastest;
pub(crate) mod formulation;
pub(crate) mod generalized_alpha;
pub(crate) mod memory;
pub(crate) mod moving_multipliers;
pub(crate) mod newton;
pub(crate) mod passes;
pub(crate) mod residual;
pub(crate) mod scheme;
pub(crate) mod simulator;
pub(crate) mod start;
pub(crate) mod statics;
pub(crate) mod workspace;

pub use formulation::Formulation;
pub use generalized_alpha::GeneralizedAlpha;
pub use newton::{Counters, Jacobian, NewtonOptions, OutsideError, StepError};
pub use scheme::period_error;
pub use simulator::{Checkpoint, Halved, Simulator};
pub use statics::{StaticOptions, StaticReport, StaticSolver, solve_static};
