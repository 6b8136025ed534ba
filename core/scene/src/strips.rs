//! Numbering of strips over all heads, their places and their state at the start.

use std::ops::Range;

use crate::check::{Found, refuse};
use crate::write::{shown_entries, shown_number};
use crate::{Catenary, ContactLaw, HeadStrip, Line, Pantograph, PantographModel, Scene, Start};

/// The one strip of a head without `strips`.
const MIDDLE: [HeadStrip; 1] = [HeadStrip { x: 0.0, spring: None }];

impl Pantograph {
    /// Strips of the head in order, at least one.
    #[must_use]
    pub fn strips(&self) -> &[HeadStrip] {
        match &self.model {
            PantographModel::Lumped(lumped) if !lumped.strips.is_empty() => &lumped.strips,
            PantographModel::Linkage(linkage) if !linkage.strips.is_empty() => &linkage.strips,
            _ => &MIDDLE,
        }
    }

    /// True for a head with more than one strip.
    #[must_use]
    pub fn has_several_strips(&self) -> bool {
        self.strips().len() > 1
    }

    /// State of strip `strip` (from 0) of the head at t = 0, where it is known: its own, or that of the head, of whose
    /// force each strip has an equal part.
    #[must_use]
    pub fn strip_start(&self, strip: usize) -> Option<Start> {
        let own = self.strip_starts.get(strip).copied();
        own.or_else(|| {
            self.start.map(|start| Start {
                height: start.height,
                force: start.force / self.strips().len() as f64,
            })
        })
    }

    /// Sets the state of the head at t = 0: its strips rise with it, and share the change of its force.
    pub fn set_start(&mut self, start: Start) {
        if let Some(was) = self.start {
            let count = self.strip_starts.len() as f64;
            for strip in &mut self.strip_starts {
                strip.height += start.height - was.height;
                strip.force += (start.force - was.force) / count;
            }
        }
        self.start = Some(start);
    }

    /// Sets the state of strip `strip` (from 0) at t = 0; those of the others are `otherwise` where nothing is known.
    /// The head follows: mean of the heights, sum of the forces.
    pub fn set_strip_start(&mut self, strip: usize, start: Start, otherwise: Start) {
        let count = self.strips().len();
        if count == 1 {
            self.start = Some(start);
            return;
        }
        let mut starts: Vec<Start> = (0..count)
            .map(|other| self.strip_start(other).unwrap_or(otherwise))
            .collect();
        starts[strip] = start;
        self.start = Some(Start {
            height: starts.iter().map(|start| start.height).sum::<f64>() / count as f64,
            force: starts.iter().map(|start| start.force).sum(),
        });
        self.strip_starts = starts;
    }

    /// Refuses starts of strips that do not belong to the strips of the head.
    pub(crate) fn check_strip_starts(&self, path: &str, found: &mut Found) {
        let (given, strips) = (self.strip_starts.len(), self.strips().len());
        let key = format!("{path}.strip_start");
        if given > 0 && strips == 1 {
            let expected = "must be left out: a head with one strip has start alone";
            refuse(found, key, shown_entries(given), expected);
        } else if given > 0 && (given != strips || self.start.is_none()) {
            let expected = format!("must have {strips}, one per strip, and start beside it, or be left out");
            refuse(found, key, shown_entries(given), expected);
        }
    }
}

impl Scene {
    /// Number of strips of all heads.
    #[must_use]
    pub fn strip_count(&self) -> usize {
        self.strip_counts().iter().sum()
    }

    /// Number of strips of each head in turn.
    #[must_use]
    pub fn strip_counts(&self) -> Vec<usize> {
        let counts = self.pantographs.iter().map(|pantograph| pantograph.strips().len());
        counts.collect()
    }

    /// Strips (from 0, over all heads) of pantograph `pantograph` (from 0).
    #[must_use]
    pub fn strips_of(&self, pantograph: usize) -> Range<usize> {
        let before = self.pantographs[..pantograph].iter();
        let first = before.map(|pantograph| pantograph.strips().len()).sum();
        first..first + self.pantographs[pantograph].strips().len()
    }

    /// Pantograph (from 0) of strip `strip` (from 0, over all heads), and the strip's number on its head (from 0).
    ///
    /// # Panics
    /// A strip that the scene does not have.
    #[must_use]
    pub fn head_of(&self, strip: usize) -> (usize, usize) {
        let heads = (0..self.pantographs.len()).map(|pantograph| (pantograph, self.strips_of(pantograph)));
        let mut found = heads
            .filter(|(_, strips)| strips.contains(&strip))
            .map(|(pantograph, strips)| (pantograph, strip - strips.start));
        found
            .next()
            .unwrap_or_else(|| panic!("strip {strip} of {}", self.strip_count()))
    }

    /// x of the middle of the head of pantograph `index` (from 0) at t = 0, m.
    #[must_use]
    pub fn head_start_x(&self, index: usize) -> f64 {
        self.run.start_x + self.pantographs[index].offset_x
    }

    /// x of the middle of the head of pantograph `index` (from 0) at `time` in s, m, as the train moves.
    #[must_use]
    pub fn head_x(&self, index: usize, time: f64) -> f64 {
        self.head_start_x(index) + self.run.speed * time
    }

    /// x of strip `strip` (from 0, over all heads) at t = 0, m.
    #[must_use]
    pub fn strip_start_x(&self, strip: usize) -> f64 {
        let (pantograph, own) = self.head_of(strip);
        self.head_start_x(pantograph) + self.pantographs[pantograph].strips()[own].x
    }

    /// Spans of a line, as short as its shortest, that the strips are apart, rounded up.
    #[must_use]
    pub fn spans_between_strips(&self, catenary: &Catenary) -> usize {
        let starts = || (0..self.strip_count()).map(|strip| self.strip_start_x(strip));
        let apart = starts().fold(f64::NEG_INFINITY, f64::max) - starts().fold(f64::INFINITY, f64::min);
        let shortest = catenary.all_span_lengths().fold(f64::INFINITY, f64::min);
        (apart / shortest).ceil() as usize
    }

    /// x of strip `strip` (from 0, over all heads) at `time` in s, m, as the train moves.
    #[must_use]
    pub fn strip_x(&self, strip: usize, time: f64) -> f64 {
        self.strip_start_x(strip) + self.run.speed * time
    }

    /// State of strip `strip` (from 0, over all heads) at t = 0, where it is known.
    #[must_use]
    pub fn strip_start(&self, strip: usize) -> Option<Start> {
        let (pantograph, own) = self.head_of(strip);
        self.pantographs[pantograph].strip_start(own)
    }

    /// Name of strip `strip` (from 0, over all heads) in messages.
    #[must_use]
    pub fn strip_name(&self, strip: usize) -> String {
        let (pantograph, own) = self.head_of(strip);
        if self.pantographs[pantograph].has_several_strips() {
            format!("strip {} of pantograph[{}]", own + 1, pantograph + 1)
        } else {
            format!("the strip of pantograph[{}]", pantograph + 1)
        }
    }

    /// Refuses heads that cross, and heads with several strips where one strip is all that can be.
    pub(crate) fn check_heads(&self, found: &mut Found) {
        let Some(several) = self.pantographs.iter().position(Pantograph::has_several_strips) else {
            return;
        };
        let reach = |index: usize| {
            let offset = self.pantographs[index].offset_x;
            let places = self.pantographs[index].strips().iter().map(|strip| offset + strip.x);
            places.fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), x| {
                (from.min(x), to.max(x))
            })
        };
        for index in 1..self.pantographs.len() {
            let ((behind, _), (_, ahead)) = (reach(index - 1), reach(index));
            if ahead >= behind {
                let offset = self.pantographs[index].offset_x;
                let expected = format!(
                    "must be less than {} m: the strips of the head must be behind those of the pantograph before it",
                    offset - (ahead - behind)
                );
                let key = format!("pantograph[{}].offset_x", index + 1);
                refuse(found, key, shown_number(offset, "m"), expected);
            }
        }
        let key = format!("pantograph[{}].strips", several + 1);
        let value = shown_entries(self.pantographs[several].strips().len());
        if (self.contact.as_ref()).is_some_and(|contact| contact.law == ContactLaw::SlidingJoint) {
            let expected = "must be one strip, or contact.law \"penalty\": a sliding joint holds one strip of a head";
            refuse(found, key, value, expected);
            return;
        }
        let other = |pantograph: &Pantograph| matches!(pantograph.model, PantographModel::Supplied(_));
        let supplied = match &self.catenary {
            Line::Supplied(_) => Some("catenary.fmu".to_owned()),
            Line::Modelled(_) => {
                let index = self.pantographs.iter().position(other);
                index.map(|index| format!("pantograph[{}].fmu", index + 1))
            }
        };
        if let Some(supplied) = supplied {
            let expected = format!(
                "must be one strip beside {supplied}: a supplied FMU is wired to one strip per pantograph, so that \
                 heads with several need line and pantographs that are modelled here"
            );
            refuse(found, key, value, expected);
        }
    }
}
