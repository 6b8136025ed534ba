//! A passage of a train: electrical figures of its heads, arcs, and wear of wire and strips.

use std::collections::BTreeMap;
use std::ops::Range;

use scene::Wear;
use serde::{Deserialize, Serialize};

use crate::{Circuit, Law, Profile, RoundSection, Shared, Terms};

/// Width of the tracks that the wear of a strip is counted in across the track, m: as wide as the flat of a worn wire.
const TRACK: f64 = 0.01;

/// Series of the contact of one strip, one value per output step.
#[derive(Clone, Copy, Debug)]
pub struct Contact<'a> {
    /// Contact force, N.
    pub force: &'a [f64],
    /// Place along the track, m.
    pub x: &'a [f64],
    /// Place along the strip from its middle, m; empty stands for the middle.
    pub aside: &'a [f64],
    /// Gap, m, positive when open.
    pub gap: &'a [f64],
}

/// Strips of a head, and the samples that figures are made of.
#[derive(Clone, Debug)]
pub struct Head<'a> {
    /// Series of each strip.
    pub strips: Vec<Contact<'a>>,
    /// Samples of the evaluation.
    pub evaluated: Range<usize>,
}

/// Conditions that all samples of a passage have in common.
#[derive(Clone, Copy, Debug)]
pub struct Passage<'a> {
    /// Law and circuit.
    pub wear: &'a Wear,
    /// Contact wires that a strip touches, evenly.
    pub wires: usize,
    /// Running speed, m/s.
    pub speed: f64,
    /// Time between two samples, s.
    pub step: f64,
}

/// An arc: contact of no strip while a current flows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Arc {
    /// Begin after the first evaluated sample, s.
    pub begin_s: f64,
    /// Place of its begin, m.
    pub x_m: f64,
    /// Duration, s.
    pub duration_s: f64,
    /// Mean voltage, V.
    pub voltage_v: f64,
    /// Energy, J.
    pub energy_j: f64,
}

/// Electrical figures of a head over its evaluation, and wear of its strips.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct HeadFigures {
    /// Current, A.
    pub current_a: f64,
    /// Mean contact resistance while closed, Ω.
    pub mean_resistance_ohm: Option<f64>,
    /// Largest contact resistance while closed, Ω.
    pub largest_resistance_ohm: Option<f64>,
    /// Mean voltage drop of the closed contact, V.
    pub mean_drop_v: Option<f64>,
    /// Mean power of the closed contact, W.
    pub mean_power_w: Option<f64>,
    /// Heat of the closed contact, J.
    pub contact_energy_j: f64,
    /// Share of the time with an arc, %.
    pub arc_percent: f64,
    /// Energy of all arcs, J.
    pub arc_energy_j: f64,
    /// Arcs.
    pub arcs: Vec<Arc>,
    /// Wear of the strip that wears most; absent where no law of strips is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strip: Option<StripFigures>,
}

/// Wear of a strip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StripFigures {
    /// Number of the strip, from 1.
    pub strip: usize,
    /// Worn volume per distance, m³/m.
    pub volume_m3_per_m: Terms,
    /// Width of its worn part across the track, m.
    pub worn_width_m: f64,
    /// Loss of height by distance where it wears most, m/m.
    pub height_per_m: f64,
    /// Distance until the height that may be worn is gone there, m.
    pub life_m: Option<f64>,
}

/// Wear of each contact wire by a passage of the whole train.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WireFigures {
    /// Mean worn area, m².
    pub area_m2: Terms,
    /// Largest worn area of a cell of the grid, m².
    pub largest_area_m2: f64,
    /// Place of it, m.
    pub largest_x_m: f64,
    /// Passages after which the lost section is at its limit there, the same wear in each.
    pub life_passages: Option<f64>,
}

/// Figures of a passage.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Train {
    /// Each pantograph.
    pub pantographs: Vec<HeadFigures>,
    /// The contact wire; absent where the evaluations of the pantographs have no place in common.
    pub wire: Option<WireFigures>,
}

/// Strips of a head at one sample.
struct Moment<'a> {
    sample: usize,
    shared: &'a Shared,
    /// Wear of each wire and of the strip itself by each strip, m³/m.
    wear: &'a [(Terms, Terms)],
}

impl Passage<'_> {
    /// Distance between two samples, m.
    #[must_use]
    pub fn stride(&self) -> f64 {
        self.speed * self.step
    }

    /// Visits the samples at which forces of head `index` (from 0) are finite.
    fn each(&self, index: usize, head: &Head<'_>, samples: Range<usize>, visit: &mut dyn FnMut(&Moment<'_>)) {
        let circuit = Circuit::new(self.wear, self.wires, self.wear.current_of(index));
        let wire = Law::new(self.wear, &self.wear.wire.law);
        let strip = self.wear.strip.as_ref().map(|strip| Law::new(self.wear, &strip.law));
        let wires = self.wires.max(1) as f64;
        let (mut force, mut gap) = (Vec::new(), Vec::new());
        let mut wear = Vec::new();
        for sample in samples {
            let of = |series: &[f64]| series.get(sample).copied().unwrap_or(f64::NAN);
            force.clear();
            force.extend(head.strips.iter().map(|strip| of(strip.force)));
            gap.clear();
            gap.extend(head.strips.iter().map(|strip| of(strip.gap)));
            if force.iter().any(|force| !force.is_finite()) {
                continue;
            }
            let shared = circuit.shared(&force, &gap);
            wear.clear();
            wear.extend(force.iter().zip(&shared.currents).map(|(force, current)| {
                let power = shared.voltage * current;
                let by = |law: &Law<'_>| Terms {
                    mechanical: law.mechanical(force / wires, current / wires),
                    joule: shared.resistance.map_or(0.0, |_| law.joule(power / wires, self.speed)),
                    arc: match shared.resistance {
                        None => law.arc(power / wires, self.speed),
                        Some(_) => 0.0,
                    },
                };
                (
                    by(&wire),
                    strip.as_ref().map_or(Terms::default(), |law| by(law) * wires),
                )
            }));
            visit(&Moment {
                sample,
                shared: &shared,
                wear: &wear,
            });
        }
    }

    /// Visits the worn pieces of each wire between two places (m): begin and end of a piece, and the volumes that head
    /// `index` (from 0) takes away there, m³.
    pub fn worn(
        &self,
        index: usize,
        head: &Head<'_>,
        (from, to): (f64, f64),
        visit: &mut dyn FnMut((f64, f64), Terms),
    ) {
        let half = 0.5 * self.stride();
        let samples = head.strips.first().map_or(0, |strip| strip.force.len());
        self.each(index, head, 0..samples, &mut |moment| {
            for (strip, (wire, _)) in head.strips.iter().zip(moment.wear) {
                let Some(x) = strip.x.get(moment.sample) else { continue };
                let (a, b) = ((x - half).max(from), (x + half).min(to));
                if b > a {
                    visit((a, b), *wire * (b - a));
                }
            }
        });
    }

    /// Places that all strips of the heads pass in their evaluations, m; `None` where there is none.
    #[must_use]
    pub fn common(&self, heads: &[Head<'_>]) -> Option<(f64, f64)> {
        let half = 0.5 * self.stride();
        let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
        for head in heads {
            for strip in &head.strips {
                let places = strip.x.get(head.evaluated.clone())?;
                from = from.max(places.first()? - half);
                to = to.min(places.last()? + half);
            }
        }
        (from < to && (to - from).is_finite()).then_some((from, to))
    }

    /// Figures of head `index` (from 0).
    #[must_use]
    pub fn figures(&self, index: usize, head: &Head<'_>) -> HeadFigures {
        let current = self.wear.current_of(index);
        let mut figures = HeadFigures {
            current_a: current,
            ..HeadFigures::default()
        };
        let (mut closed, mut resistance, mut drop, mut samples) = (0_usize, 0.0, 0.0, 0_usize);
        let mut largest = 0.0_f64;
        let mut arcing: Option<usize> = None;
        let mut strips = vec![StripWorn::default(); head.strips.len()];
        let begin = head.evaluated.start;
        self.each(index, head, head.evaluated.clone(), &mut |moment| {
            samples += 1;
            let shared = moment.shared;
            let energy = shared.voltage * current * self.step;
            if let Some(own) = shared.resistance {
                closed += 1;
                resistance += own;
                largest = largest.max(own);
                drop += shared.voltage;
                figures.contact_energy_j += energy;
            } else if current > 0.0 {
                let goes_on = arcing.is_some_and(|last| last + 1 == moment.sample);
                if !goes_on {
                    let place = head.strips.first().and_then(|strip| strip.x.get(moment.sample));
                    figures.arcs.push(Arc {
                        begin_s: (moment.sample - begin) as f64 * self.step,
                        x_m: place.copied().unwrap_or_default(),
                        ..Arc::default()
                    });
                }
                arcing = Some(moment.sample);
                if let Some(arc) = figures.arcs.last_mut() {
                    arc.duration_s += self.step;
                    arc.energy_j += energy;
                }
            }
            for ((strip, (_, worn)), sum) in head.strips.iter().zip(moment.wear).zip(&mut strips) {
                let aside = strip.aside.get(moment.sample).copied().unwrap_or_default();
                sum.add(aside, *worn * self.stride());
            }
        });
        for arc in &mut figures.arcs {
            arc.voltage_v = arc.energy_j / (current * arc.duration_s);
        }
        // Sums of nothing are zero without a sign.
        figures.arc_energy_j = figures.arcs.iter().fold(0.0, |sum, arc| sum + arc.energy_j);
        let arc_time = figures.arcs.iter().fold(0.0, |sum, arc| sum + arc.duration_s);
        let time = samples as f64 * self.step;
        if samples > 0 {
            figures.arc_percent = 100.0 * arc_time / time;
        }
        if closed > 0 {
            let mean = 1.0 / closed as f64;
            figures.mean_resistance_ohm = Some(mean * resistance);
            figures.largest_resistance_ohm = Some(largest);
            figures.mean_drop_v = Some(mean * drop);
            figures.mean_power_w = Some(figures.contact_energy_j * mean / self.step);
        }
        if let Some(own) = self.wear.strip.as_ref().filter(|_| samples > 0) {
            let distance = self.speed * time;
            let worn = strips.iter().zip(1..);
            let worn = worn.map(|(worn, number)| worn.figures(number, distance, own));
            figures.strip = worn.max_by(|a, b| a.height_per_m.total_cmp(&b.height_per_m));
        }
        figures
    }
}

/// Volumes worn off a strip, m³.
#[derive(Clone, Debug, Default)]
struct StripWorn {
    all: Terms,
    /// By tracks of [`TRACK`] m across.
    tracks: BTreeMap<i64, f64>,
}

impl StripWorn {
    fn add(&mut self, aside: f64, volume: Terms) {
        self.all += volume;
        // Half a track off: a wire that stays in the middle has one track.
        let track = (aside / TRACK + 0.5).floor() as i64;
        *self.tracks.entry(track).or_default() += volume.sum();
    }

    fn figures(&self, strip: usize, distance: f64, own: &scene::StripWear) -> StripFigures {
        let most = self.tracks.values().copied().fold(0.0, f64::max);
        let height_per_m = most / (TRACK * own.breadth * distance);
        StripFigures {
            strip,
            volume_m3_per_m: self.all * (1.0 / distance),
            worn_width_m: TRACK * self.tracks.len() as f64,
            height_per_m,
            life_m: (height_per_m > 0.0).then(|| own.limit_height / height_per_m),
        }
    }
}

/// Figures of the passage of a train with these heads, the leading one first.
#[must_use]
pub fn train(passage: &Passage<'_>, heads: &[Head<'_>]) -> Train {
    let pantographs = heads.iter().enumerate();
    let pantographs = pantographs.map(|(index, head)| passage.figures(index, head)).collect();
    let wire = passage.common(heads).map(|(from, to)| {
        let mut profile = Profile::new(from, to, passage.wear.grid);
        let mut volume = Terms::default();
        for (index, head) in heads.iter().enumerate() {
            passage.worn(index, head, (from, to), &mut |places, worn| {
                profile.deposit(places, worn.sum());
                volume += worn;
            });
        }
        let profile = profile.averaged(passage.wear.contact_length, false);
        let (largest_x_m, largest_area_m2) = profile.largest();
        WireFigures {
            area_m2: volume * (1.0 / (to - from)),
            largest_area_m2,
            largest_x_m,
            life_passages: (largest_area_m2 > 0.0).then(|| left(passage.wear) / largest_area_m2),
        }
    });
    Train { pantographs, wire }
}

/// Area that may still be lost by an unworn place of the wire, m².
fn left(wear: &Wear) -> f64 {
    let section = RoundSection {
        diameter: wear.wire.diameter,
    };
    (0.01 * wear.wire.limit_percent * section.whole() - section.lost(wear.wire.worn_depth)).max(0.0)
}
