//! Wheel–rail contact: contact points, normal forces, creep forces. [Thesis, section 4.1, Eq. (4)–(5)]
//!
//! [`Profile`]s are smooth curves through point lists; a [`Wheel`] turns a profile about the axle, a [`Rail`] sweeps a
//! profile along a [`RailLine`]. [`WheelRail`] finds all points of largest overlap, and adds normal force ([`Hertz`])
//! and creep forces ([`CreepModel`]) to a wheelset seen through a marker.
//!
//! Neglected: the rotation of the contact ellipse by the yaw of the wheelset (of second order in it), and the change of
//! the rail's own bending along its length within the tangent.
//!
//! | file | subject |
//! | --- | --- |
//! | `profile`, `spline` | cross-sections as smooth curves |
//! | `surface` | wheels and rails as surfaces |
//! | `search`, `contact_point`, `overlap` | candidates, contact points, shared patches |
//! | `hertz` | elastic contact |
//! | `creepage`, `creep_force`, `kalker` | sliding, tangential forces, coefficients of the linear theory |
//! | `wheel_contact`, `wheel_rail` | one contact; all contacts of a wheel as a force |
//!
//! # Sources
//! - `[Carlson 1995]` B. C. Carlson, Numerical computation of real or complex elliptic integrals, Numerical Algorithms
//!   10, doi 10.1007/BF02198293.
//! - `[Johnson 1985]` K. L. Johnson, Contact Mechanics, Cambridge University Press.
//! - `[Kalker 1982]` J. J. Kalker, A fast algorithm for the simplified theory of rolling contact, Vehicle System
//!   Dynamics 11, doi 10.1080/00423118208968684.
//! - `[Kalker 1990]` J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact, Kluwer. Table E.3 stands in
//!   `kalker_coefficients.csv`.
//! - `[Polach 1999]` O. Polach, A fast wheel–rail forces calculation computer code, Vehicle System Dynamics 33
//!   (supplement).
//! - `[Shabana, Zaazaa, Escalona & Sany 2004]` Development of elastic force model for wheel/rail contact problems,
//!   Journal of Sound and Vibration 269, doi 10.1016/S0022-460X(03)00074-9.
//! - `[Shen, Hedrick & Elkins 1983]` A comparison of alternative creep force models for rail vehicle dynamic analysis,
//!   8th IAVSD Symposium.
mod contact_point;
mod creep_force;
mod creepage;
mod hertz;
mod kalker;
mod overlap;
mod profile;
mod search;
mod spline;
mod surface;
#[cfg(test)]
mod tests;
mod wheel_contact;
#[expect(clippy::module_inception, reason = "the force has the name of its subject")]
mod wheel_rail;

pub(crate) use contact_point::{ContactPoint, SurfaceParameters};
pub(crate) use creep_force::{CreepLaw, CreepModel, CreepSlopes, Fastsim, Patch};
pub(crate) use creepage::Creepage;
pub(crate) use hertz::{Ellipse, Hertz, Material};
pub(crate) use kalker::KalkerCoefficients;
pub use profile::ProfileError;
pub(crate) use profile::{Profile, ProfilePoint};
#[cfg(test)]
pub(crate) use surface::StraightRail;
pub(crate) use surface::{Rail, RailFrame, RailLine, Side, Wheel};
#[cfg(test)]
pub(crate) use wheel_contact::WheelContact;
pub(crate) use wheel_rail::{WheelRail, WheelRailParts};
