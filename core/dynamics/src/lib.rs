//! Multibody kernel shared by the overhead line and the rigid side.
//!
//! World frame: x along the track in the direction of travel, y lateral (left), z up. SI units throughout.
//! A mechanical system is a list of contributions: each [`Force`] adds a generalised force, its tangent and its
//! inertia, each [`Constraint`] adds algebraic equations and their Jacobian. Contact, droppers, joints and loads
//! see bodies only through a [`Marker`]. The equations are
//!
//! ```text
//! M v̇ = Q(t, q, v, u) − g_qᵀ λ,    g(t, q) = 0
//! ```
//!
//! with constant `M`; `u` are the inputs of the system followed in time (see [`Motion`]).
//!
//! | file | subject |
//! | --- | --- |
//! | `force` | the law of a contribution: force, tangent, mass, energy, power |
//! | `capability` | one-pass and range evaluation, low-rank updates, history of a contribution |
//! | `constraint` | algebraic equations of a contribution |
//! | `marker` | a point on some body, as forces and joints see it |
//! | `motion` | the state of a system, and the view that contributions take of it |
//! | `layout` | coordinates of a system and its constraint equations |
//! | `system` | the contributions of a system, as solvers visit them |
//! | `blocks` | dense blocks that go to fixed positions of a sparse matrix |
//! | `rotation` | rotation vectors and the exponential map |
//! | `followed_input` | inputs with derivatives inside a communication step |
//! | `energy_balance` | energy stored, brought in, turned into heat |
//! | `linear_force` | a force linear in coordinates, velocities and accelerations |
//! | `unilateral` | law of springs and dampers that only push or only pull, over a time step |
//! | `random` | reproducible random numbers |
//! | `integrate` | equilibrium, and motion in time |
//! | `linear` | linear systems of Newton's method |
//! | `modal` | motion in modes |
//! | `lockstep` | questions of simulations that go on in lockstep |
//! | `simd` | numbers of several owners side by side in vector registers |
//! | `hermite` | a cubic between two samples with slopes |
//! | `resting_spline` | smooth curves through samples |
//! | `monotone_cubic` | curves that rise or fall only where their samples do |
//! | `wind` | wind along the track, and its forces |
//! | `testing` | checks of laws by differences, for tests |
//!
//! # Sources
//! - `[Arnold & Brüls 2007]` M. Arnold, O. Brüls, Convergence of the generalized-α scheme for constrained
//!   mechanical systems, Multibody System Dynamics 18, doi 10.1007/s11044-007-9084-0.
//! - `[Brüls, Cardona & Arnold 2012]` Lie group generalized-α time integration of constrained flexible multibody
//!   systems, Mechanism and Machine Theory 48, doi 10.1016/j.mechmachtheory.2011.07.017.
//! - `[Chung & Hulbert 1993]` A time integration algorithm for structural dynamics with improved numerical
//!   dissipation, Journal of Applied Mechanics 60, doi 10.1115/1.2900803.
//! - `[Fox & Goodwin 1949]` L. Fox, E. T. Goodwin, Some new methods for the numerical integration of ordinary
//!   differential equations, Mathematical Proceedings of the Cambridge Philosophical Society 45, 373.
#![forbid(unsafe_code)]

mod blocks;
mod capability;
mod constraint;
mod energy_balance;
mod followed_input;
mod force;
mod hermite;
mod integrate;
mod layout;
mod linear;
mod linear_force;
pub mod lockstep;
mod marker;
pub mod modal;
mod monotone_cubic;
mod motion;
mod random;
mod resting_spline;
pub mod rotation;
pub mod simd;
mod system;
pub mod testing;
pub mod unilateral;
mod wind;

pub use blocks::{Blocks, dense};
pub use capability::{ByRange, LowRank, OnePass, StepHistory};
pub use constraint::{Constraint, JacobianRows};
pub use energy_balance::EnergyBalance;
pub use followed_input::{FollowedInput, MAX_ORDER};
pub use force::{Force, Power, Weights};
pub use integrate::{
    Checkpoint, Counters, Formulation, GeneralizedAlpha, Halved, Jacobian, NewtonOptions, OutsideError, Simulator,
    StaticOptions, StaticReport, StaticSolver, StepError, period_error, solve_static,
};
pub use layout::Layout;
pub use linear::eigen;
#[doc(hidden)] // for the benchmark of the solver alone
pub use linear::{BlockTridiagonal, LocalColumn, Precision};
pub use linear::{FactoredMatrix, Lu, SparseMatrix, Updates, uncoupled};
pub use linear_force::LinearForce;
pub use marker::{Column, Columns, Frame, Marker};
pub use monotone_cubic::{MonotoneCubic, monotone_slopes};
pub use motion::{Motion, State};
pub use random::SplitMix64;
pub use resting_spline::RestingSpline;
pub use system::{Continuity, PartVisitor, Stage, System};
pub use wind::{
    AerodynamicForce, AerodynamicLaw, AerodynamicLoad, CrossFlow, Flow, Gust, GustProfile, Polar, SectionFlow,
    SlenderFlow, Turbulence, TurbulenceOptions, TurbulenceSpectrum, Wind, WindRecord, WindRecordError, galloping_speed,
};
