//! Spectators of a run: recorder and display of progress.

use crate::{Frame, Point};

/// Recorder of a run: the time loop calls the recorder at the start, after each step, and for each picture that is due.
pub trait Observer {
    /// Records the start.
    fn start(&mut self, point: &Point);

    /// Records the step from `start` to `end`.
    fn step(&mut self, start: &Point, end: &Point);

    /// True if a picture is due at `t` in s.
    fn wants_frame(&self, t: f64) -> bool;

    /// Records a picture of the moment of `point`.
    fn frame(&mut self, point: &Point, frame: Frame);

    /// Pictures recorded so far, in order: some are completed after the run.
    fn frames(&mut self) -> &mut [Frame];
}

/// Display of the simulated time reached by a run.
pub trait Progress {
    /// Shows that the run has come to `t` in s.
    fn reached(&self, t: f64);
}

/// No display.
impl Progress for () {
    fn reached(&self, _: f64) {}
}
