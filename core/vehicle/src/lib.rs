//! Rail vehicles and pantographs on a base that travels along the track.
//!
//! Coordinates describe pantograph and vehicle in the frame of the base, which moves along the track at constant speed.
//! On straight track this frame is inertial; in a curve the frame turns and leans with the track (`Travel`), and the
//! inertia of bodies in the turning frame is a force (`rail_vehicle::CurveInertia`). Only markers seen from outside
//! (`Travelling`) add the travel. Statics are rest in this frame, and no digits are lost to the distance covered.
//!
//! [`PantographModel`] is a pantograph of a scene in a shared [`dynamics::Layout`]; [`Subsystem`] runs one alone under
//! a contact force from outside.
//!
//! | file | subject |
//! | --- | --- |
//! | `model` | a pantograph on its base: statics with the vehicle, start, forces, strip |
//! | `pantograph` | lumped, linkage and reduced pantographs behind one trait |
//! | `base_motion`, `given_motion` | motion of the base: none, given, or that of a vehicle |
//! | `rail_vehicle` | the vehicle under the pantograph |
//! | `multibody` | rigid bodies, joints, springs |
//! | `track`, `travel`, `base` | curves and irregularities; travel of the frame |
//! | `wheel_rail` | contact points, normal and creep forces |
//! | `subsystem`, `signals` | one pantograph as a simulation unit, and the signals |
//!
//! # Sources
//! - `[Thesis]` S. Kulkarni, ANCF Analysis of Multibody Pantograph/Catenary Systems, MSc thesis, University of Illinois
//!   at Chicago, 2016.
//! - `[Haug 1989]` E. J. Haug, Computer Aided Kinematics and Dynamics of Mechanical Systems, Allyn and Bacon.
//! - `[Shabana, Zaazaa & Sugiyama 2008]` A. A. Shabana, K. E. Zaazaa & H. Sugiyama, Railroad Vehicle Dynamics: A
//!   Computational Approach, CRC Press.
#![forbid(unsafe_code)]

mod base;
mod base_motion;
#[cfg(test)]
mod check;
mod error;
mod given_motion;
mod model;
pub mod multibody;
mod pantograph;
mod rail_vehicle;
mod signals;
mod subsystem;
mod track;
mod travel;
mod wheel_rail;

pub use base::Base;
use base::Travelling;
pub use error::{Irreducible, VehicleError};
pub use given_motion::{Displaced, GivenMotion};
pub use model::{PantographModel, Placement, WIND_INPUTS};
pub use multibody::AppliedForce;
pub use pantograph::{Air, Equilibrium, Linkage};
pub use rail_vehicle::Vehicle;
pub use subsystem::{Checkpoint, INPUTS, StripMotion, Subsystem, instruments};
use travel::{Apparent, Travel};
pub use wheel_rail::ProfileError;
