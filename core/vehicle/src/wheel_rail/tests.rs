//! Whole contacts: the force of a wheel, against finite differences and published cases.
mod benchmark;
mod curve;
mod force;
mod running;
mod support;
