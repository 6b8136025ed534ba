//! Support for the integration tests.

pub mod single_wire;
