//! Whole contacts: the force of a wheel, against finite differences and published cases.
mod benchmark;
mod force;
mod running;
mod support;
