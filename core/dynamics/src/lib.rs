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
//! # Sources
//! - `[Arnold & Brüls 2007]` M. Arnold, O. Brüls, Convergence of the generalized-α scheme for constrained
//!   mechanical systems, Multibody System Dynamics 18, doi 10.1007/s11044-007-9084-0.
//! - `[Brüls, Cardona & Arnold 2012]` Lie group generalized-α time integration of constrained flexible multibody
//!   systems, Mechanism and Machine Theory 48, doi 10.1016/j.mechmachtheory.2011.07.017.
//! - `[Chung & Hulbert 1993]` A time integration algorithm for structural dynamics with improved numerical
//!   dissipation, Journal of Applied Mechanics 60, doi 10.1115/1.2900803.
#![forbid(unsafe_code)]

mod aerodynamic;
mod augmented;
mod balance;
mod block_tridiagonal;
mod blocks;
mod buffer;
mod constraint;
mod convergence_estimate;
mod factor;
mod factored;
mod force;
mod input;
mod integrator;
mod leaves;
mod lu;
mod marker;
mod matrix;
mod motion;
mod moving;
mod newton;
mod part;
mod passes;
mod pattern;
mod random;
mod residual;
pub mod rotation;
mod scheme;
mod simulator;
mod sparse;
mod start;
mod statics;
mod system;
mod updates;
mod wind;
mod woodbury;

pub use aerodynamic::{AerodynamicForce, AerodynamicLaw, AerodynamicLoad, CrossFlow, Flow, Polar};
pub use augmented::Formulation;
pub use balance::EnergyBalance;
pub use block_tridiagonal::{BlockTridiagonal, LocalColumn};
pub use blocks::Blocks;
pub use constraint::{Constraint, JacobianRows, RowSink};
pub use factored::FactoredMatrix;
pub use force::{Force, Power, Weights};
pub use input::{FollowedInput, MAX_ORDER};
pub use integrator::{GeneralizedAlpha, Memory};
pub use marker::{Column, Columns, Frame, Marker};
pub use motion::{Motion, State};
pub use newton::{Counters, Jacobian, NewtonOptions, StepError};
pub use random::SplitMix64;
pub use scheme::Scheme;
pub use simulator::{Checkpoint, Simulator};
pub use sparse::SparseMatrix;
pub use statics::{StaticOptions, StaticReport, solve_static};
pub use system::{Continuity, Layout, Stage, System};
pub use updates::Updates;
pub use wind::{
    Gust, GustProfile, Turbulence, TurbulenceOptions, TurbulenceSpectrum, Wind, WindRecord, WindRecordError,
};
