//! Spectators of a run: who records it, who shows how far it is.

use crate::{Frame, Point};

/// Recorder of a run: the time loop calls it at the start, after each step, and where a picture is due.
pub trait Observer {
    /// Takes in the start.
    fn start(&mut self, point: &Point);

    /// Takes in the step from `start` to `end`.
    fn step(&mut self, start: &Point, end: &Point);

    /// Whether a picture is due at `t` in s.
    fn wants_frame(&self, t: f64) -> bool;

    /// Takes in a picture of the moment of `point`.
    fn frame(&mut self, point: &Point, frame: Frame);

    /// Pictures taken in so far, in order: some are completed after the run.
    fn frames(&mut self) -> &mut [Frame];
}

/// Display of the simulated time that a run has reached.
pub trait Progress {
    /// Shows that the run has come to `t` in s.
    fn reached(&self, t: f64);
}

/// No display.
impl Progress for () {
    fn reached(&self, _: f64) {}
}
