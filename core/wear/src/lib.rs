//! Electrical contact, arcs and wear of contact wire and collector strips, from the series of a run.
//!
//! | file | subject |
//! | --- | --- |
//! | `law` | [`Law`]: worn volume per distance by friction, heat of the contact and arcs |
//! | `circuit` | [`Circuit`]: resistance, drop and shares of the current at the strips of a head |
//! | `section` | [`RoundSection`]: lost area, depth and width of a worn round wire |
//! | `profile` | [`Profile`]: worn area along the wire; deposits keep the volume |
//! | `passage` | [`Passage`]: figures of a passage, arcs among them, and where it wears the wire |
//! | `growth` | growth of a wave of the worn surface by linear theory |
//!
//! # Sources
//!
//! - `[Bucca & Collina 2009]` G. Bucca, A. Collina, A procedure for the wear prediction of collector strip and contact
//!   wire in pantograph–catenary system, Wear 266 (2009) 46–59.
//! - `[Holm 1967]` R. Holm, *Electric Contacts*, Springer.
#![forbid(unsafe_code)]

mod circuit;
mod growth;
mod law;
mod passage;
mod profile;
mod section;

pub use circuit::{Circuit, Shared};
pub use growth::{growth, head_stiffness};
pub use law::{Law, Terms};
pub use passage::{Arc, Contact, Head, HeadFigures, Passage, StripFigures, Train, WireFigures, train};
pub use profile::Profile;
pub use section::RoundSection;
