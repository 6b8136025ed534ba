//! Support for the integration tests.

pub mod documents;
pub mod fmus;
pub mod installed;
pub mod lines;
pub mod python;
pub mod raw;
pub mod runs;
pub mod single_wire;
pub mod under_wire;
pub mod vendor;
