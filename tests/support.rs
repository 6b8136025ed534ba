//! Support for the integration tests.

pub mod lines;
pub mod single_wire;
