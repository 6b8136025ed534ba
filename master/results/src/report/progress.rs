//! The progress bar of a run.

use std::io::IsTerminal;
use std::sync::{Arc, Mutex, PoisonError};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Permission to show progress.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Show {
    /// On stderr, if that is a terminal.
    OnTerminal,
    /// Never.
    Never,
}

/// A progress bar on stderr, drawn only where stderr is a terminal; otherwise it does nothing.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    /// Value of a full bar, and the part of the bar from where to where it moves.
    total: f64,
    from: f64,
    to: f64,
    /// True where the bar goes with it.
    owner: bool,
    /// Share of the bar that is done by parts that run side by side.
    sum: Arc<Mutex<f64>>,
    /// For such a part, what it has added to the sum.
    added: Option<Mutex<f64>>,
}

/// Steps of a full bar.
const STEPS: u64 = 1000;

impl Progress {
    /// A bar for the simulated time from 0 to `duration` s.
    #[must_use]
    pub fn simulated(label: &str, duration: f64, show: Show) -> Self {
        Self::new(
            label,
            duration,
            STEPS,
            "{prefix}  {wide_bar} {percent} %  {msg}  {eta} left",
            show,
        )
    }

    /// A bar for `count` runs.
    #[must_use]
    pub fn counted(label: &str, count: usize, show: Show) -> Self {
        let template = "{prefix}  {wide_bar} {pos}/{len}  {msg}  {elapsed}";
        Self::new(label, count as f64, count as u64, template, show)
    }

    fn new(label: &str, total: f64, length: u64, template: &str, show: Show) -> Self {
        let visible = show == Show::OnTerminal && std::io::stderr().is_terminal();
        let target = if visible {
            ProgressDrawTarget::stderr_with_hz(10)
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(Some(length), target);
        // The templates above are constants; a wrong one would leave the default bar.
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_prefix(label.to_owned());
        Self {
            bar,
            total,
            from: 0.0,
            to: 1.0,
            owner: true,
            sum: Arc::default(),
            added: None,
        }
    }

    /// The same bar for one of several runs: its values from 0 to `total` move it from one share to another, both from
    /// 0 to 1.
    #[must_use]
    pub fn part(&self, from: f64, to: f64, total: f64) -> Self {
        Self {
            bar: self.bar.clone(),
            total,
            from,
            to,
            owner: false,
            sum: Arc::default(),
            added: None,
        }
    }

    /// The same bar for one of several runs side by side: its values from 0 to `total` add up to `share` of the bar.
    #[must_use]
    pub fn beside(&self, share: f64, total: f64) -> Self {
        Self {
            bar: self.bar.clone(),
            total,
            from: 0.0,
            to: share,
            owner: false,
            sum: Arc::clone(&self.sum),
            added: Some(Mutex::new(0.0)),
        }
    }

    /// Moves the bar to the end of this part.
    pub fn fill(&self) {
        self.set(self.total);
    }

    /// A bar for work of which only the share that is done is known, 0 to 1.
    #[must_use]
    pub fn share(label: &str, show: Show) -> Self {
        Self::simulated(label, 1.0, show)
    }

    /// Counts a share of the bar, 0 to 1, as done earlier: the time left goes by what follows.
    pub fn done_earlier(&self, share: f64) {
        self.beside(share, 1.0).fill();
        self.bar.reset_eta();
    }

    /// Moves the bar to `value`, between 0 and the total, s or runs.
    pub fn set(&self, value: f64) {
        let share = if self.total > 0.0 {
            (value / self.total).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let mut share = self.from + share * (self.to - self.from);
        if let Some(added) = &self.added {
            let mut added = added.lock().unwrap_or_else(PoisonError::into_inner);
            let mut sum = self.sum.lock().unwrap_or_else(PoisonError::into_inner);
            *sum += share - *added;
            *added = share;
            share = *sum;
        }
        let length = self.bar.length().unwrap_or(STEPS);
        self.bar.set_position((share * length as f64).round() as u64);
    }

    /// Shows `text` beside the bar.
    pub fn message(&self, text: &str) {
        if !self.bar.is_hidden() {
            self.bar.set_message(text.to_owned());
        }
    }

    /// Prints a line above the bar, or to stderr where there is no bar on a terminal.
    pub fn line(&self, text: &str) {
        if self.bar.is_hidden() {
            eprintln!("{text}")
        } else {
            self.bar.println(text)
        }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl component::Progress for Progress {
    fn reached(&self, t: f64) {
        self.set(t);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if self.owner {
            self.bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_moves_with_the_value_and_stays_inside_its_ends() {
        let progress = Progress::simulated("run", 8.0, Show::Never);
        for (value, position) in [(2.0, 250), (-1.0, 0), (9.0, 1000)] {
            progress.set(value);
            assert_eq!(progress.bar.position(), position);
        }
        let part = progress.part(0.5, 0.75, 10.0);
        part.set(4.0);
        drop(part);
        assert_eq!(progress.bar.position(), 600);
        assert!(!progress.bar.is_finished());
        let bar = Progress::share("study", Show::Never);
        let (one, other) = (bar.beside(0.5, 2.0), bar.beside(0.25, 10.0));
        one.set(1.0);
        other.set(10.0);
        one.set(1.6);
        assert_eq!(bar.bar.position(), 650);
        one.fill();
        assert_eq!(bar.bar.position(), 750);
        let runs = Progress::counted("study", 12, Show::Never);
        runs.set(3.0);
        assert_eq!(runs.bar.position(), 3);
        assert!(runs.bar.is_hidden());
    }
}
