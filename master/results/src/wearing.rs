//! Current and wear of a run: series of its record as `wear` takes them.

use scene::Wear;
use wear::{Contact, Head, Passage, Train};

use crate::{Evaluation, Record, StripRecord};

/// Current and wear as a scene gives them.
#[derive(Clone, Debug, PartialEq)]
pub struct Wearing {
    /// `[wear]`.
    pub wear: Wear,
    /// Contact wires that a strip touches.
    pub wires: usize,
}

impl Wearing {
    /// Conditions of the passages of a run.
    #[must_use]
    pub fn passage(&self, evaluation: &Evaluation) -> Passage<'_> {
        Passage {
            wear: &self.wear,
            wires: self.wires,
            speed: evaluation.speed,
            step: evaluation.output_step,
        }
    }

    /// Figures of the passage that a run is.
    #[must_use]
    pub fn train(&self, evaluation: &Evaluation, record: &Record) -> Train {
        wear::train(&self.passage(evaluation), &Self::heads(evaluation, record))
    }

    /// Heads of a run with their evaluated samples.
    #[must_use]
    pub fn heads<'a>(evaluation: &Evaluation, record: &'a Record) -> Vec<Head<'a>> {
        let contact = |strip: &'a StripRecord, aside: &'a [f64]| Contact {
            force: &strip.force,
            x: &strip.contact_x,
            aside,
            gap: &strip.gap,
        };
        let heads = record.pantographs.iter().enumerate();
        let heads = heads.map(|(index, head)| {
            let strips = head.each_strip().iter().map(|strip| {
                // Strips of one head are as far aside as the head.
                let aside = match strip.aside.is_empty() {
                    true => &head.aside,
                    false => &strip.aside,
                };
                contact(strip, aside)
            });
            Head {
                strips: strips.collect(),
                evaluated: evaluation.samples(&record.time, index),
            }
        });
        heads.collect()
    }
}
