//! Galloping: a line without pantographs in a steady wind whose lift feeds its motion.
//!
//! Ice, or wear, gives a wire a lift that depends on the angle of attack. Where the lift falls faster with the angle
//! than the drag holds against it, `C_D + ∂C_L/∂α < 0`, a wire that moves down is pushed further down [Den Hartog 1932,
//! Transactions of the AIEE 51]. The criterion of one wire is in closed form; the motion of the line is integrated in
//! time, droppers that go slack included, until it has died out or has found its limit cycle.
use std::f64::consts::PI;

use catenary::{CatenaryError, Line, StaticLine, WindOnLine, WireName};
use dynamics::{Force, Layout, SectionFlow, Simulator, State, StaticOptions, StepError, System, galloping_speed};
use nalgebra::Vector3;
use scene::{Catenary, Scene, WireKind};
use serde::Serialize;

use crate::disturbance::Deflection;

/// Criterion of one kind of wire.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Criterion {
    /// The wire.
    pub wire: WireName,
    /// `C_D + ∂C_L/∂α` at the angle of the mean wind, –.
    pub slope: f64,
    /// Frequency of the first mode of the longest span as a taut string, Hz.
    #[serde(rename = "frequency_Hz")]
    pub frequency: f64,
    /// Damping of that mode by the structure, – of critical.
    pub damping_ratio: f64,
    /// Speed from which on that mode gallops up and down; none where it never does.
    #[serde(rename = "critical_speed_m_per_s")]
    pub critical_speed: Option<f64>,
    /// Speed from which on some motion of the string gallops, up, down and sideways together: the frequencies of a taut
    /// string are the same in all directions; none where none does.
    #[serde(rename = "critical_speed_all_directions_m_per_s")]
    pub of_all_directions: Option<f64>,
}

/// Criteria of the wires that have a table of drag and lift, in the wind of a scene.
///
/// ```text
/// ω = π/L √(T/m),    2 ζ ω = α + β ω²,    2 m ζ ω + ½ ρ d U (C_D + ∂C_L/∂α) = 0
/// ```
///
/// `m` has the mass of the ice, `d` is the diameter with ice.
#[must_use]
pub fn criteria(scene: &Scene) -> Vec<Criterion> {
    let (Some((line, _)), Some(wind)) = (scene.modelled_line(), &scene.wind) else {
        return Vec::new();
    };
    let Some(wires) = &wind.wires else { return Vec::new() };
    let kinds = [
        (WireKind::Contact, WireName::ContactWire, Some(&line.contact_wire)),
        (
            WireKind::Messenger,
            WireName::MessengerWire,
            line.messenger_wire.as_ref(),
        ),
    ];
    let of = |(kind, name, wire): (WireKind, WireName, Option<&scene::Wire>)| {
        let (wire, polar, diameter) = (wire?, wires.polar(kind)?, scene.diameter_in_wind(kind)?);
        let mass = wire.mass_per_length + line.ice_on(kind);
        let omega = PI / longest_span(line) * (wire.tension / mass).sqrt();
        let rate = line.damping.alpha + line.damping.beta * omega * omega;
        // By the speed of the wind, of any positive speed.
        let direction = Vector3::from(wind.mean_velocity())
            .try_normalize(0.0)
            .unwrap_or(Vector3::y());
        let across = direction.yz().norm();
        let damping = SectionFlow::new(wind.air_density, diameter, polar.polar()).damping(&direction, &Vector3::x());
        let slope = damping.m22 / (0.5 * wind.air_density * diameter * across);
        let least = damping
            .complex_eigenvalues()
            .iter()
            .map(|value| value.re)
            .fold(f64::INFINITY, f64::min);
        Some(Criterion {
            wire: name,
            slope,
            frequency: omega / (2.0 * PI),
            damping_ratio: rate / (2.0 * omega),
            critical_speed: galloping_speed(mass, rate, wind.air_density, diameter, slope * across),
            of_all_directions: (least < 0.0).then(|| mass * rate / -least),
        })
    };
    kinds.into_iter().filter_map(of).collect()
}

fn longest_span(line: &Catenary) -> f64 {
    let lengths = line.tension_lengths.iter().flat_map(|section| &section.span_lengths);
    lengths.copied().fold(0.0, f64::max)
}

/// One wind and one start of the line.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// Speed of the steady wind, m/s; its direction is that of the scene.
    pub speed: f64,
    /// Amplitude of the motion at the start, m: half a sine in each span, neighbours against each other, in passing the
    /// equilibrium.
    pub amplitude: f64,
    /// Simulated time, s.
    pub duration: f64,
}

/// Motion of a line in a steady wind.
#[derive(Clone, Debug, Serialize)]
pub struct Motion {
    /// Speed of the wind.
    #[serde(rename = "speed_m_per_s")]
    pub speed: f64,
    /// Rate at which the vertical amplitude grows while it is small; negative where the motion dies out.
    #[serde(rename = "growth_per_s")]
    pub growth: f64,
    /// Vertical amplitude at the end, at the mid-span and on the wire where it is largest, m.
    #[serde(rename = "amplitude_m")]
    pub amplitude: f64,
    /// Lateral amplitude there.
    #[serde(rename = "lateral_amplitude_m")]
    pub lateral_amplitude: f64,
    /// Frequency of the vertical motion there, Hz.
    #[serde(rename = "frequency_Hz")]
    pub frequency: f64,
    /// How the motion ends.
    pub ends: Ends,
    /// Smallest and largest angle of attack at the mid-spans, degrees.
    #[serde(rename = "angles_deg")]
    pub angles: [f64; 2],
    /// True where an angle is beyond a table, whose end then holds.
    pub beyond_table: bool,
    /// Vertical amplitude there in one window of the observation after the other: middle of the window, s, and
    /// amplitude, m.
    #[serde(rename = "envelope_s_m")]
    pub envelope: Vec<[f64; 2]>,
    /// Path there over the last window, lateral and vertical from the rest in the wind, m.
    #[serde(rename = "path_m")]
    pub path: Vec<[f64; 2]>,
}

/// How a motion in the wind ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ends {
    /// The amplitude falls.
    DiesOut,
    /// The amplitude still grows at the end.
    Grows,
    /// The amplitude stays.
    LimitCycle,
}

impl Ends {
    /// In words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::DiesOut => "dies out",
            Self::Grows => "grows",
            Self::LimitCycle => "limit cycle",
        }
    }
}

/// Errors of a trial.
#[derive(Debug, thiserror::Error)]
pub enum GallopingError {
    /// The line has no static state in the wind, or its motion cannot be integrated.
    #[error("in a wind of {speed} m/s: {source}")]
    Step {
        /// Speed of the wind, m/s.
        speed: f64,
        /// The reason.
        source: StepError,
    },
    /// The line cannot be made.
    #[error(transparent)]
    Line(#[from] CatenaryError),
    /// No force of the air on wires.
    #[error("wind.wires: missing, must be given: without it no force of the air acts on the line")]
    NoWind,
}

/// Periods of the slowest mode in one window of the observation.
const PERIODS: f64 = 4.0;
/// Steps in a period.
const STEPS: f64 = 120.0;
/// Growth by which an amplitude is no longer small.
const SMALL: f64 = 3.0;
/// Change of the amplitude over the last third below which it counts as steady.
const STEADY: f64 = 0.02;

/// A line alone.
struct Alone {
    layout: Layout,
    line: Line,
}

impl System for Alone {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        self.line.forces(visit);
    }
}

/// Node at the middle of a span, and the table of angles of its wire, degrees.
struct Watched {
    vertical: usize,
    lateral: Option<usize>,
    table: Option<[f64; 2]>,
}

/// Extremes of the motion in one window.
#[derive(Clone, Copy)]
struct Window {
    vertical: [f64; 2],
    lateral: [f64; 2],
    /// Upward passes through the mean of the window before.
    passes: usize,
}

impl Window {
    const NEW: Self = Self {
        vertical: [f64::INFINITY, f64::NEG_INFINITY],
        lateral: [f64::INFINITY, f64::NEG_INFINITY],
        passes: 0,
    };

    fn amplitude(&self) -> f64 {
        0.5 * (self.vertical[1] - self.vertical[0])
    }
}

impl Trial {
    /// Integrates the motion of the line whose static state in still air is `statics`.
    ///
    /// # Errors
    /// See [`GallopingError`].
    pub fn run(&self, scene: &Scene, statics: &StaticLine) -> Result<Motion, GallopingError> {
        let mut scene = scene.clone();
        let (line, wind) = match (scene.modelled_line().map(|(line, _)| line.clone()), &mut scene.wind) {
            (Some(line), Some(wind)) => (line, wind),
            _ => return Err(GallopingError::NoWind),
        };
        wind.speed = self.speed;
        let air = Vector3::from(wind.mean_velocity());
        let on_line = WindOnLine::of_scene(&scene).ok_or(GallopingError::NoWind)?.steady();
        let statics = statics.clone().in_wind(Some(on_line));
        let mut layout = Layout::new();
        let line_in_wind = statics.line_in(&mut layout);
        let watched = watched(&scene, &line_in_wind);
        let mut state = layout.state_at_rest();
        let slowest = slowest(&line);
        let mut alone = Alone {
            layout,
            line: line_in_wind,
        };
        let step_error = |source: StepError| GallopingError::Step {
            speed: self.speed,
            source,
        };
        dynamics::solve_static(&mut alone, &mut state, &[], &StaticOptions::default()).map_err(step_error)?;
        // Out of equilibrium by its speed: all forces are in balance at first.
        let speed = Deflection {
            amplitude: self.amplitude * 2.0 * PI * slowest,
        };
        speed.write(&alone.line, &mut state.v);
        alone.layout.fixed().iter().for_each(|index| state.v[*index] = 0.0);
        let rest = state.q.clone();
        let period = 1.0 / slowest;
        let step = period / STEPS;
        let mut simulator = Simulator::new(
            alone,
            state,
            Vec::new(),
            step,
            scene.solver.rho_inf,
            scene.solver.newton_options(),
        );
        simulator.begin();

        let windows_of = ((self.duration / (PERIODS * period)).floor() as usize).max(3);
        let per_window = (PERIODS * STEPS) as usize;
        let mut windows = vec![vec![Window::NEW; watched.len()]; windows_of];
        let (mut angles, mut beyond_table) = ([f64::INFINITY, f64::NEG_INFINITY], false);
        // Places that upward passes are counted at, and the last places: one for each watched node.
        let mut middle: Vec<f64> = watched.iter().map(|at| rest[at.vertical]).collect();
        let mut before = vec![0.0; watched.len()];
        let mut paths = vec![Vec::with_capacity(per_window); watched.len()];
        for (number, window) in windows.iter_mut().enumerate() {
            for step_number in number * per_window..(number + 1) * per_window {
                for (before, at) in before.iter_mut().zip(&watched) {
                    *before = simulator.state().q[at.vertical];
                }
                simulator
                    .advance(step_number as f64 * step, step, &mut |_, _| {}, &mut |_, _, _, _| {})
                    .map_err(step_error)?;
                let State { q, v, .. } = simulator.state();
                for (i, (at, seen)) in watched.iter().zip(window.iter_mut()).enumerate() {
                    let vertical = q[at.vertical];
                    if number + 1 == windows_of {
                        let away = |index: usize| q[index] - rest[index];
                        paths[i].push([at.lateral.map_or(0.0, away), away(at.vertical)]);
                    }
                    widen(&mut seen.vertical, vertical);
                    seen.passes += usize::from(before[i] <= middle[i] && vertical > middle[i]);
                    if let Some(lateral) = at.lateral {
                        widen(&mut seen.lateral, q[lateral]);
                    }
                    let velocity = Vector3::new(0.0, at.lateral.map_or(0.0, |index| v[index]), v[at.vertical]);
                    let angle = SectionFlow::angle(&(air - velocity), &Vector3::x());
                    if let (Some(angle), Some([low, high])) = (angle.map(f64::to_degrees), at.table) {
                        widen(&mut angles, angle);
                        beyond_table |= !(low..=high).contains(&angle);
                    }
                }
            }
            for (middle, seen) in middle.iter_mut().zip(window.iter()) {
                *middle = 0.5 * (seen.vertical[0] + seen.vertical[1]);
            }
        }
        Ok(self.found(&windows, &mut paths, (period, angles, beyond_table)))
    }

    fn found(
        &self,
        windows: &[Vec<Window>],
        paths: &mut [Vec<[f64; 2]>],
        (period, angles, beyond_table): (f64, [f64; 2], bool),
    ) -> Motion {
        let last = &windows[windows.len() - 1];
        let largest = (0..last.len()).max_by(|&a, &b| last[a].amplitude().total_cmp(&last[b].amplitude()));
        let at = largest.unwrap_or(0);
        let amplitudes: Vec<f64> = windows.iter().map(|window| window[at].amplitude()).collect();
        let span = PERIODS * period;
        // The first window has the transient of the start.
        let small = amplitudes
            .iter()
            .skip(1)
            .take_while(|amplitude| **amplitude < SMALL * self.amplitude);
        let known = small.count().max(2).min(amplitudes.len() - 1);
        let growth = slope(&amplitudes[1..1 + known]) / span;
        let third = &amplitudes[amplitudes.len() - (amplitudes.len() / 3).max(2)..];
        let change = third[third.len() - 1] / third[0] - 1.0;
        let end = &last[at];
        let lateral = 0.5 * (end.lateral[1] - end.lateral[0]);
        Motion {
            speed: self.speed,
            growth,
            amplitude: end.amplitude(),
            lateral_amplitude: if lateral.is_finite() { lateral } else { 0.0 },
            frequency: end.passes as f64 / span,
            ends: if change.abs() < STEADY && end.amplitude() > 0.1 * self.amplitude {
                Ends::LimitCycle
            } else if change > 0.0 {
                Ends::Grows
            } else {
                Ends::DiesOut
            },
            angles,
            beyond_table,
            envelope: (amplitudes.iter().enumerate())
                .map(|(number, amplitude)| [(number as f64 + 0.5) * span, *amplitude])
                .collect(),
            path: paths.get_mut(at).map(std::mem::take).unwrap_or_default(),
        }
    }
}

fn widen(range: &mut [f64; 2], value: f64) {
    *range = [range[0].min(value), range[1].max(value)];
}

/// Mean rate of the logarithm of amplitudes, by window: a line of least squares.
fn slope(amplitudes: &[f64]) -> f64 {
    let count = amplitudes.len() as f64;
    let middle = 0.5 * (count - 1.0);
    let logs = amplitudes.iter().map(|amplitude| amplitude.max(f64::MIN_POSITIVE).ln());
    let (mut up, mut down) = (0.0, 0.0);
    for (i, log) in logs.enumerate() {
        let place = i as f64 - middle;
        up += place * log;
        down += place * place;
    }
    if down > 0.0 { up / down } else { 0.0 }
}

/// Frequency of the slowest mode that a wire of the line has between its supports, Hz.
fn slowest(line: &Catenary) -> f64 {
    let wires = [
        Some((&line.contact_wire, WireKind::Contact)),
        line.messenger_wire.as_ref().map(|wire| (wire, WireKind::Messenger)),
    ];
    // Wires that hang together swing together.
    let (mut tension, mut mass) = (0.0, 0.0);
    for (wire, kind) in wires.into_iter().flatten() {
        tension += wire.tension;
        mass += wire.mass_per_length + line.ice_on(kind);
    }
    (tension / mass).sqrt() / (2.0 * longest_span(line))
}

/// Nodes at the middles of the spans, of every wire with a table, or else of all wires.
fn watched(scene: &Scene, line: &Line) -> Vec<Watched> {
    let wires = scene.wind.as_ref().and_then(|wind| wind.wires.as_ref());
    let table = |name: WireName| {
        let polar = wires?.polar(name.kind())?;
        Some([*polar.angles_deg.first()?, *polar.angles_deg.last()?])
    };
    let topology = line.topology();
    let mut all = Vec::new();
    for (number, planned) in topology.wires().iter().enumerate() {
        if planned.name == WireName::StitchWire {
            continue;
        }
        let section = topology
            .support_places()
            .iter()
            .filter(|support| support.section == planned.section);
        let supports: Vec<f64> = section.map(|support| support.x).collect();
        for pair in supports.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let near = |a: &usize, b: &usize| {
                (planned.x[*a] - middle)
                    .abs()
                    .total_cmp(&(planned.x[*b] - middle).abs())
            };
            let Some(node) = (0..planned.x.len()).min_by(near) else {
                continue;
            };
            let map = line.wires()[number].geometry().nodes()[node].map;
            let Some(vertical) = map.position(2) else { continue };
            all.push(Watched {
                vertical,
                lateral: map.position(1),
                table: table(planned.name),
            });
        }
    }
    if all.iter().any(|at| at.table.is_some()) {
        all.retain(|at| at.table.is_some());
    }
    all
}
