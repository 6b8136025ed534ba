//! The fully parameterised beam element against its own laws, closed forms and published results.
mod chain;
mod laws;
mod statics;
mod vibration;
