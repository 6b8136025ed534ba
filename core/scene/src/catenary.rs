//! `[catenary]`: the overhead line.

use crate::choice::choice;
use crate::error::What;
use crate::keys::{Entry, Keys, Number, Sentences};
use crate::mesh::Mesh;
use crate::plausible::LEAST_TENSION;
use crate::tension_length::{Placed, from};
use crate::{Change, PointMass, Section, StitchWires, Surface, TensionLength, Tensioning};

/// `[catenary]`, the line as this program models it.
#[derive(Clone, Debug, PartialEq)]
pub struct Catenary {
    /// Geometry, at least one; a single one has its keys in this table itself.
    pub tension_lengths: Vec<TensionLength>,
    /// How the wires end.
    pub wire_ends: WireEnds,
    /// `[catenary.tensioning]`; none for devices without friction and stops.
    pub tensioning: Option<Tensioning>,
    /// How the static state is found.
    pub statics: Statics,
    /// Acceleration of gravity, m/s².
    pub gravity: f64,
    /// `[catenary.contact_wire]`.
    pub contact_wire: Wire,
    /// Distance between the two wires of a twin contact wire, m; none for one wire.
    pub contact_wire_spacing: Option<f64>,
    /// `[catenary.messenger_wire]`; none for a single wire, which its steady arms carry.
    pub messenger_wire: Option<Wire>,
    /// `[catenary.stitch_wires]`; none without.
    pub stitch_wires: Option<StitchWires>,
    /// `[catenary.droppers]`.
    pub droppers: Droppers,
    /// `[catenary.supports]`.
    pub supports: Supports,
    /// `[catenary.registration_arms]`.
    pub registration_arms: RegistrationArms,
    /// `[[catenary.point_mass]]`.
    pub point_masses: Vec<PointMass>,
    /// `[catenary.surface]`; none for an even running surface.
    pub surface: Option<Surface>,
    /// `[catenary.change]`; none for the line as erected.
    pub change: Option<Change>,
    /// `[catenary.damping]`.
    pub damping: Damping,
    /// `[catenary.mesh]`; left out it is chosen as for `error_percent = 1.0`.
    pub mesh: Mesh,
}

/// Kind of a wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WireKind {
    /// The wires that strips touch.
    Contact,
    /// The wire at the supports that carries the contact wires.
    Messenger,
    /// The wires below the messenger wire about the supports.
    Stitch,
}

impl WireKind {
    /// The kind in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Contact => "contact wire",
            Self::Messenger => "messenger wire",
            Self::Stitch => "stitch wire",
        }
    }

    /// True for wires along the whole line, which carry waves; a stitch wire ends before a wave has formed.
    #[must_use]
    pub fn runs_along(self) -> bool {
        self != Self::Stitch
    }
}

/// `[catenary.contact_wire]` or `[catenary.messenger_wire]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wire {
    /// kg/m.
    pub mass_per_length: f64,
    /// Horizontal tension in the static state, N.
    pub tension: f64,
    /// `EA`, N.
    pub axial_stiffness: f64,
    /// `EI`, N·m²; 0 is a string.
    pub bending_stiffness: f64,
    /// Outer diameter, m, where it is known.
    pub diameter: Option<f64>,
    /// Tension above which the scene is refused, N.
    pub breaking_force: Option<f64>,
    /// Stiffnesses that a beam has beyond a cable; of the contact wire with `mesh.element = "beam"` only.
    pub beam: Option<Beam>,
}

/// `[catenary.contact_wire.beam]`: a round wire as a shear-deformable beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// `k G A`, shear correction factor included, N.
    pub shear_stiffness: f64,
    /// `G J`, N·m².
    pub torsional_stiffness: f64,
    /// `ρ I` about a diameter, kg·m.
    pub rotary_inertia: f64,
}

/// `[catenary.droppers]`: the same in every span.
#[derive(Clone, Debug, PartialEq)]
pub struct Droppers {
    /// Distances from the left support, m, strictly increasing, inside the span: one list for all spans, or one for
    /// each in turn.
    pub positions: Vec<Vec<f64>>,
    /// N/m in tension; none in compression.
    pub stiffness: f64,
    /// N·s/m.
    pub damping: f64,
    /// kg per dropper, half of it at each end.
    pub mass: f64,
    /// Mass of the clamp at the upper end, kg.
    pub upper_clamp_mass: f64,
    /// Mass of the clamp at the lower end, kg.
    pub lower_clamp_mass: f64,
    /// Unstressed lengths, m, one per position; only with [`Statics::NodalDisplacement`].
    pub lengths: Option<Vec<Vec<f64>>>,
}

/// `[catenary.supports]`: the springs that hold the messenger wire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Supports {
    /// N/m.
    pub messenger_vertical_stiffness: f64,
    /// N/m.
    pub messenger_lateral_stiffness: f64,
    /// N/m; 0 lets the messenger wire slide freely.
    pub messenger_longitudinal_stiffness: f64,
}

impl Supports {
    /// Stiffnesses of the messenger wire at its supports, N/m: vertical, lateral, longitudinal.
    #[must_use]
    pub fn new(vertical: f64, lateral: f64, longitudinal: f64) -> Self {
        Self {
            messenger_vertical_stiffness: vertical,
            messenger_lateral_stiffness: lateral,
            messenger_longitudinal_stiffness: longitudinal,
        }
    }
}

/// `[catenary.registration_arms]`: what holds the contact wire at the supports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegistrationArms {
    /// N/m about the static height; the static reaction is carried on.
    pub vertical_stiffness: f64,
    /// N/m about the stagger.
    pub lateral_stiffness: f64,
    /// kg, lumped on the contact wire.
    pub mass: f64,
    /// Rise of the contact wire at a support that the steady arm leaves free, m. Not modelled: what the uplift of a run
    /// is held against.
    pub free_uplift: Option<f64>,
    /// True where a stop limits the rise of the steady arm; not modelled either. [EN 50119:2009, 5.10.2]
    pub uplift_stop: bool,
}

/// `[catenary.damping]`: Rayleigh damping of the wires.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damping {
    /// On the mass, 1/s.
    pub alpha: f64,
    /// On the stiffness, s.
    pub beta: f64,
}

impl Damping {
    /// Rayleigh damping with `alpha` (1/s) on the mass and `beta` (s) on the stiffness.
    #[must_use]
    pub fn new(alpha: f64, beta: f64) -> Self {
        Self { alpha, beta }
    }
}

choice! {
    /// `catenary.wire_ends`.
    pub enum WireEnds {
        /// Tensioning weights: the ends slide under a constant horizontal force.
        ConstantTension = "constant_tension",
        /// The ends do not move.
        Fixed = "fixed",
    }
    unavailable: []
}

choice! {
    /// `catenary.statics`: how the static state is found.
    pub enum Statics {
        /// The contact wire is held at its heights, and dropper lengths follow.
        FormFinding = "form_finding",
        /// Dropper lengths are given, and the ends are displaced until the wires are tensioned.
        NodalDisplacement = "nodal_displacement",
    }
    unavailable: []
}

impl Catenary {
    /// One tension length of plain wires between tensioning weights, its dropper lengths to be found, under 9.81 m/s².
    #[must_use]
    pub fn new(
        line: TensionLength,
        (contact_wire, messenger_wire): (Wire, Wire),
        droppers: Droppers,
        (supports, registration_arms): (Supports, RegistrationArms),
        damping: Damping,
        mesh: Mesh,
    ) -> Self {
        Self {
            tension_lengths: vec![line],
            wire_ends: WireEnds::ConstantTension,
            tensioning: None,
            statics: Statics::FormFinding,
            gravity: 9.81,
            contact_wire,
            contact_wire_spacing: None,
            messenger_wire: Some(messenger_wire),
            stitch_wires: None,
            droppers,
            supports,
            registration_arms,
            point_masses: Vec::new(),
            surface: None,
            change: None,
            damping,
            mesh,
        }
    }
}

/// Largest distance of supports of one mast along the track, m.
const SAME_MAST: f64 = 1e-6;

impl Catenary {
    /// Number of spans between neighbouring masts.
    #[must_use]
    pub fn spans(&self) -> usize {
        match self.tension_lengths.as_slice() {
            [only] => only.spans(),
            _ => self.supports_x().len() - 1,
        }
    }

    /// Length of each span of the first tension length, m.
    #[must_use]
    pub fn span_lengths(&self) -> &[f64] {
        &self.tension_lengths[0].span_lengths
    }

    /// Length of each span of every tension length, m.
    pub fn all_span_lengths(&self) -> impl Iterator<Item = f64> + '_ {
        let lengths = self.tension_lengths.iter().flat_map(|length| &length.span_lengths);
        lengths.copied()
    }

    /// Length of the line from the first mast to the last, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.support_x(self.spans())
    }

    /// x of mast `index`, m; counted from 0, at most [`Catenary::spans`].
    #[must_use]
    pub fn support_x(&self, index: usize) -> f64 {
        match self.tension_lengths.as_slice() {
            [only] => only.support_x(index),
            _ => self.supports_x()[index],
        }
    }

    /// x of all masts, m; one more than there are spans. Supports of several tension lengths at one x are one mast.
    #[must_use]
    pub fn supports_x(&self) -> Vec<f64> {
        let mut all: Vec<f64> = self
            .tension_lengths
            .iter()
            .flat_map(TensionLength::supports_x)
            .collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|b, a| *b - *a < SAME_MAST);
        all
    }

    /// True where every tension length has a support at each mast that it passes, and runs beside the others for a span
    /// at least where it begins and ends.
    #[must_use]
    pub(crate) fn has_common_masts(&self) -> bool {
        if self.tension_lengths.len() == 1 {
            return true;
        }
        let masts = self.supports_x();
        let mut beside = vec![0; masts.len() - 1];
        let mut common = true;
        for length in &self.tension_lengths {
            let inside = |x: &&f64| (length.start_x - SAME_MAST..=length.end_x() + SAME_MAST).contains(*x);
            common &= masts.iter().filter(inside).count() == length.spans() + 1;
            let first = masts.partition_point(|x| *x < length.start_x - SAME_MAST);
            let last = (first + length.spans()).min(beside.len());
            beside[first..last].iter_mut().for_each(|count| *count += 1);
        }
        let passed = |mast: usize| {
            let at = masts[mast];
            let mut passing = self.tension_lengths.iter();
            passing.any(|length| length.start_x + SAME_MAST < at && at < length.end_x() - SAME_MAST)
        };
        common && (1..masts.len() - 1).all(passed) && !beside.contains(&0)
    }

    /// True where all spans and supports are alike but for the stagger.
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        let lines = self.tension_lengths.as_slice();
        let changed = self.change.is_some() || !self.point_masses.is_empty();
        !changed
            && self.stitch_wires.is_none()
            && lines.len() == 1
            && lines[0].is_uniform()
            && self.droppers.positions.len() == 1
    }

    /// True where some wire is not straight seen from above, or two are not above one another.
    #[must_use]
    pub fn is_staggered(&self) -> bool {
        let mut all = self.tension_lengths.iter().flat_map(TensionLength::laterals);
        let first = all.next();
        self.contact_wire_spacing.is_some() || all.any(|lateral| Some(lateral) != first)
    }

    /// True where the track of some tension length is curved.
    #[must_use]
    pub fn is_curved(&self) -> bool {
        self.tension_lengths.iter().any(TensionLength::is_curved)
    }

    /// Lateral distances of the contact wires from the stagger, m: one, or two of a twin contact wire.
    #[must_use]
    pub fn contact_wire_offsets(&self) -> Vec<f64> {
        match self.contact_wire_spacing {
            None => vec![0.0],
            Some(spacing) => vec![-0.5 * spacing, 0.5 * spacing],
        }
    }

    /// Number of contact wires, those of all tension lengths.
    #[must_use]
    pub fn contact_wires(&self) -> usize {
        self.tension_lengths.len() * self.contact_wire_offsets().len()
    }

    /// Height of the lowest contact wire at rest at `x` (m), m, straight between its supports; beyond the line that of
    /// its end.
    #[must_use]
    pub fn chord_height(&self, x: f64) -> f64 {
        self.section(self.lowest_at(x)).chord_height(x)
    }

    /// Lateral position of the lowest contact wire at rest at `x` (m), m.
    #[must_use]
    pub fn lateral(&self, x: f64) -> f64 {
        self.section(self.lowest_at(x)).lateral(x)
    }

    /// Tension length (from 0) whose contact wire is lowest at `x` (m); the first one beyond the line.
    #[must_use]
    pub fn lowest_at(&self, x: f64) -> usize {
        if let [_] = self.tension_lengths.as_slice() {
            return 0;
        }
        let there = |(_, section): &(usize, Section<'_>)| {
            let (start, end) = (section.support_x(0), section.support_x(section.spans()));
            (start - SAME_MAST..=end + SAME_MAST).contains(&x)
        };
        let lowest = self.sections().enumerate().filter(there);
        let lowest = lowest.min_by(|a, b| a.1.chord_height(x).total_cmp(&b.1.chord_height(x)));
        lowest.map_or(0, |(number, _)| number)
    }

    /// x of all droppers, m, tension length after tension length, span after span.
    #[must_use]
    pub fn droppers_x(&self) -> Vec<f64> {
        self.sections().flat_map(Section::droppers_x).collect()
    }

    /// Slowest transverse wave of the wires that carry waves along the line, m/s.
    #[must_use]
    pub fn slowest_wave(&self) -> f64 {
        let along = self.wire_kinds().filter(|(kind, _)| kind.runs_along());
        along.map(|(_, wire)| wire.wave_speed()).fold(f64::INFINITY, f64::min)
    }

    /// Kinds of wires of the line with their sections, contact wire first.
    pub fn wire_kinds(&self) -> impl Iterator<Item = (WireKind, &Wire)> {
        let stitch = self
            .stitch_wires
            .as_ref()
            .map(|stitch| (WireKind::Stitch, &stitch.wire));
        let messenger = self.messenger_wire.as_ref().map(|wire| (WireKind::Messenger, wire));
        let contact = (WireKind::Contact, &self.contact_wire);
        [contact].into_iter().chain(messenger).chain(stitch)
    }

    /// Spans from `start` up to and without `end` (from 0) as a line of their own, the first support at x = 0. Several
    /// tension lengths stay whole and move by as much.
    #[must_use]
    pub fn part(&self, start: usize, end: usize) -> Self {
        if self.tension_lengths.len() > 1 {
            let x = self.support_x(start);
            let moved = self.tension_lengths.iter().map(|length| TensionLength {
                start_x: length.start_x - x,
                ..length.clone()
            });
            return Self {
                tension_lengths: moved.collect(),
                ..self.clone()
            };
        }
        Self {
            tension_lengths: vec![self.tension_lengths[0].part(start, end)],
            droppers: self.droppers.beginning_with(start),
            ..self.clone()
        }
    }
}

impl Droppers {
    /// Droppers of a line that begins with span `start` (from 0) of this one.
    fn beginning_with(&self, start: usize) -> Self {
        let rotated = |lists: &Vec<Vec<f64>>| from(lists, start);
        Self {
            positions: rotated(&self.positions),
            lengths: self.lengths.as_ref().map(rotated),
            ..self.clone()
        }
    }

    /// True where no span has a dropper, unless tension lengths have their own.
    pub(crate) fn is_none(&self) -> bool {
        self.positions.iter().all(Vec::is_empty)
    }

    /// No droppers at all.
    #[must_use]
    pub fn none() -> Self {
        Self::new(&[], 1.0)
    }

    /// Droppers at `positions` (m) with a stiffness in N/m, without mass and damping, whose lengths follow.
    #[must_use]
    pub fn new(positions: &[f64], stiffness: f64) -> Self {
        Self {
            positions: vec![positions.to_vec()],
            stiffness,
            damping: 0.0,
            mass: 0.0,
            upper_clamp_mass: 0.0,
            lower_clamp_mass: 0.0,
            lengths: None,
        }
    }
}

impl RegistrationArms {
    /// Arms with a vertical and a lateral stiffness in N/m and a mass in kg, whose uplift is free.
    #[must_use]
    pub fn new(vertical_stiffness: f64, lateral_stiffness: f64, mass: f64) -> Self {
        Self {
            vertical_stiffness,
            lateral_stiffness,
            mass,
            free_uplift: None,
            uplift_stop: false,
        }
    }
}

impl Wire {
    /// A wire of cable elements that never breaks.
    ///
    /// `mass_per_length` in kg/m, `tension` in the static state in N, `axial_stiffness` `EA` in N, `bending_stiffness`
    /// `EI` in N·m².
    #[must_use]
    pub fn new(mass_per_length: f64, tension: f64, axial_stiffness: f64, bending_stiffness: f64) -> Self {
        Self {
            mass_per_length,
            tension,
            axial_stiffness,
            bending_stiffness,
            diameter: None,
            breaking_force: None,
            beam: None,
        }
    }

    /// Bending length `√(EI/T)`, m: what a point force bends a tensioned wire over.
    #[must_use]
    pub fn bending_length(&self) -> f64 {
        (self.bending_stiffness / self.tension).sqrt()
    }

    /// True for a wire of a kind with elements of `shortest` m or more that needs bending layers: shorter ones follow
    /// a bend themselves, none follows the kinks of a string. A strip has no normal on a kink, so that a contact wire
    /// that is a string stays smooth.
    #[must_use]
    pub fn needs_layers(&self, kind: WireKind, shortest: f64) -> bool {
        let bends = self.bending_stiffness > 0.0 || kind != WireKind::Contact;
        bends && self.bending_length() <= shortest
    }

    /// Speed of transverse waves `√(T/m)`, m/s, bending neglected.
    #[must_use]
    pub fn wave_speed(&self) -> f64 {
        (self.tension / self.mass_per_length).sqrt()
    }

    /// Phase speed `ω/k` of transverse waves of `omega` rad/s, m/s, from `m ω² = T k² + EI k⁴`.
    #[must_use]
    pub fn phase_speed(&self, omega: f64) -> f64 {
        let string = 0.5 * self.wave_speed().powi(2);
        let bending = omega.powi(2) * self.bending_stiffness / self.mass_per_length;
        (string + (string.powi(2) + bending).sqrt()).sqrt()
    }
}

impl Entry for Catenary {
    const SENTENCES: Sentences = &[
        (
            "from",
            "Path of a library file with keys of this table, relative to the file that names it, whose own keys win.",
        ),
        (
            "table",
            "Path of a table of supports, relative to the file that names it: one row per support and tension length, \
             in place of the keys from `spans` on that it has columns for; see the guide to real lines.",
        ),
        (
            "wire_ends",
            "Ends of both wires: sliding under the force of tensioning weights, or fixed.",
        ),
        (
            "tensioning",
            "Friction and stops of the tensioning devices, with `wire_ends = \"constant_tension\"`; left out, there \
             are none.",
        ),
        (
            "statics",
            "Way to the static state: the contact wire is held at its heights and dropper lengths follow, or \
             dropper lengths are given.",
        ),
        ("gravity", "Acceleration of gravity."),
        ("contact_wire", "Contact wire."),
        (
            "contact_wire_spacing",
            "Lateral distance between the two wires of a twin contact wire, about the stagger.",
        ),
        (
            "messenger_wire",
            "Messenger wire; left out, with droppers and supports, for a single wire that its steady arms carry.",
        ),
        (
            "tension_length",
            "Tension lengths, each with geometry of its own, where a line has several.",
        ),
        (
            "stitch_wires",
            "Stitch wires about the inner supports; left out, all droppers hang from the messenger wire.",
        ),
        ("droppers", "Droppers."),
        ("supports", "Springs that hold the messenger wire."),
        (
            "registration_arms",
            "Steady arms that hold the contact wire at the supports.",
        ),
        (
            "point_mass",
            "Section insulators, splices, feeder clamps: masses on a wire.",
        ),
        ("surface", "Running surface of the contact wires; left out, it is even."),
        (
            "change",
            "Temperature, ice, and droppers that are not as erected; left out, the line is as erected.",
        ),
        ("damping", "Rayleigh damping of the wires."),
        (
            "mesh",
            "Elements of the wires; left out, the mesh is chosen as for `error_percent = 1.0`.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        keys.written_out("from", "", "text");
        keys.written_out("table", "", "text");
        let several = keys.has("tension_length", was.is_some_and(|line| line.tension_lengths.len() > 1));
        let tension_lengths = if several && !keys.describes() {
            keys.leave_out::<TensionLength>("[[catenary.tension_length]] has it");
            let was: Option<Vec<Placed>> = was.map(|line| line.tension_lengths.iter().cloned().map(Placed).collect());
            let placed = keys.tables("tension_length", was.as_deref());
            placed.into_iter().map(|placed| placed.0).collect()
        } else {
            if keys.describes() {
                keys.tables::<Placed>("tension_length", None);
            }
            vec![keys.part(was.and_then(|line| line.tension_lengths.first()))]
        };
        let wire_ends = keys.word("wire_ends", was.map(|line| line.wire_ends), None);
        let tensioning = keys.optional_inline_table("tensioning", was.map(|line| line.tensioning.as_ref()));
        let statics = keys.word("statics", was.map(|line| line.statics), None);
        let gravity = keys.number("gravity", was.map(|line| line.gravity), Number::positive("m/s²"));
        let contact_wire = keys.table("contact_wire", was.map(|line| &line.contact_wire));
        let contact_wire_spacing = keys.optional_number(
            "contact_wire_spacing",
            was.map(|line| line.contact_wire_spacing),
            Number::positive("m"),
        );
        let messenger_wire = keys.optional_table("messenger_wire", was.map(|line| line.messenger_wire.as_ref()));
        let stitch_wires = keys.optional_table("stitch_wires", was.map(|line| line.stitch_wires.as_ref()));
        let carried = messenger_wire.is_some();
        let because = "a line without messenger_wire has none".to_owned();
        let mut part = |name: &str| {
            let given = keys.has(name, carried);
            if given && !carried {
                keys.report(
                    name,
                    What::LeaveOut {
                        because: because.clone(),
                    },
                );
            }
            carried
        };
        let (has_droppers, has_supports) = (part("droppers"), part("supports"));
        Self {
            tension_lengths,
            wire_ends,
            tensioning,
            statics,
            gravity,
            contact_wire,
            contact_wire_spacing,
            messenger_wire,
            stitch_wires,
            droppers: if has_droppers {
                keys.table("droppers", was.map(|line| &line.droppers))
            } else {
                Droppers::none()
            },
            supports: if has_supports {
                keys.table("supports", was.map(|line| &line.supports))
            } else {
                Supports::new(0.0, 0.0, 0.0)
            },
            registration_arms: keys.table("registration_arms", was.map(|line| &line.registration_arms)),
            point_masses: keys.any_tables("point_mass", was.map(|line| line.point_masses.as_slice())),
            surface: keys.optional_table("surface", was.map(|line| line.surface.as_ref())),
            change: keys.optional_table("change", was.map(|line| line.change.as_ref())),
            damping: keys.table("damping", was.map(|line| &line.damping)),
            mesh: keys.table_or_empty("mesh", was.map(|line| &line.mesh)),
        }
    }
}

impl Entry for Wire {
    const SENTENCES: Sentences = &[
        ("mass_per_length", "Mass per length."),
        ("tension", "Horizontal tension in the static state."),
        ("axial_stiffness", "Axial stiffness `EA`."),
        ("bending_stiffness", "Bending stiffness `EI`; 0 is a string."),
        ("diameter", "Outer diameter, for ice and wind."),
        ("breaking_force", "Tension above which the scene is refused."),
        (
            "beam",
            "Stiffnesses of a shear-deformable beam; of the contact wire with `mesh.element = \"beam\"` only.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            mass_per_length: keys.number(
                "mass_per_length",
                was.map(|wire| wire.mass_per_length),
                Number::positive("kg/m"),
            ),
            tension: keys.number(
                "tension",
                was.map(|wire| wire.tension),
                Number::positive("N").at_least(LEAST_TENSION),
            ),
            axial_stiffness: keys.number(
                "axial_stiffness",
                was.map(|wire| wire.axial_stiffness),
                Number::positive("N"),
            ),
            bending_stiffness: keys.number(
                "bending_stiffness",
                was.map(|wire| wire.bending_stiffness),
                Number::not_negative("N m²"),
            ),
            diameter: keys.optional_number(
                "diameter",
                was.map(|wire| wire.diameter),
                Number::between_in("m", 1e-4, 0.1),
            ),
            breaking_force: keys.optional_number(
                "breaking_force",
                was.map(|wire| wire.breaking_force),
                Number::positive("N"),
            ),
            beam: keys.optional_inline_table("beam", was.map(|wire| wire.beam.as_ref())),
        }
    }
}

impl Entry for Beam {
    const SENTENCES: Sentences = &[
        (
            "shear_stiffness",
            "Shear stiffness `k G A`, shear correction factor included.",
        ),
        ("torsional_stiffness", "Torsional stiffness `G J`."),
        ("rotary_inertia", "Rotary inertia per length about a diameter, `ρ I`."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            shear_stiffness: keys.number(
                "shear_stiffness",
                was.map(|beam| beam.shear_stiffness),
                Number::positive("N"),
            ),
            torsional_stiffness: keys.number(
                "torsional_stiffness",
                was.map(|beam| beam.torsional_stiffness),
                Number::positive("N m²"),
            ),
            rotary_inertia: keys.number(
                "rotary_inertia",
                was.map(|beam| beam.rotary_inertia),
                Number::positive("kg m"),
            ),
        }
    }
}

impl Entry for Droppers {
    const SENTENCES: Sentences = &[
        (
            "positions",
            "Distances from the left support of each span, ascending, inside the span: one list for all spans, or one \
             list for each span. Left out where a rule, names, a table or each tension length have them.",
        ),
        (
            "rule",
            "Positions by a rule, in place of `positions`: in each span the first and last dropper `first` from the \
             supports, the others evenly between them at intervals of at most `longest`.",
        ),
        (
            "pattern",
            "Positions by names of `patterns`, in place of `positions`: one name for all spans, or exactly one for \
             each span; names are not repeated.",
        ),
        (
            "patterns",
            "Named lists of positions, for `pattern` and for tables of supports.",
        ),
        (
            "table",
            "Path of a table of droppers, relative to the file that names it, in place of `positions`: one row per \
             dropper; see the guide to real lines.",
        ),
        ("stiffness", "Stiffness in tension; a dropper bears no compression."),
        ("damping", "Damping while in tension."),
        ("mass", "Mass of a dropper, half of it at each end."),
        ("upper_clamp_mass", "Mass of the clamp at the upper end of a dropper."),
        (
            "lower_clamp_mass",
            "Mass of the clamp at the lower end of a dropper, on the contact wire.",
        ),
        (
            "lengths",
            "Unstressed lengths, one per position; only with `statics = \"nodal_displacement\"`.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let lengths = was.map(|droppers| droppers.lengths.as_deref());
        keys.written_out("rule", "m", "table `{ first, longest }`");
        keys.written_out("pattern", "", "text, or a list of texts");
        keys.written_out("patterns", "m", "table `{ name = [positions], … }`");
        keys.written_out("table", "", "text");
        Self {
            positions: if keys.has("positions", was.is_some_and(|droppers| !droppers.is_none())) {
                let positions = was.map(|droppers| droppers.positions.as_slice());
                keys.list_or_lists("positions", positions, Number::any("m"))
            } else {
                Self::none().positions
            },
            stiffness: keys.number(
                "stiffness",
                was.map(|droppers| droppers.stiffness),
                Number::positive("N/m"),
            ),
            damping: keys.number(
                "damping",
                was.map(|droppers| droppers.damping),
                Number::not_negative("N s/m"),
            ),
            mass: keys.number("mass", was.map(|droppers| droppers.mass), Number::not_negative("kg")),
            upper_clamp_mass: keys.number(
                "upper_clamp_mass",
                was.map(|droppers| droppers.upper_clamp_mass),
                Number::not_negative("kg").default(0.0),
            ),
            lower_clamp_mass: keys.number(
                "lower_clamp_mass",
                was.map(|droppers| droppers.lower_clamp_mass),
                Number::not_negative("kg").default(0.0),
            ),
            lengths: keys
                .has("lengths", lengths.flatten().is_some())
                .then(|| keys.list_or_lists("lengths", lengths.flatten(), Number::positive("m"))),
        }
    }
}

impl Entry for Supports {
    const SENTENCES: Sentences = &[
        (
            "messenger_vertical_stiffness",
            "Vertical stiffness of a support of the messenger wire.",
        ),
        (
            "messenger_lateral_stiffness",
            "Lateral stiffness of a support of the messenger wire.",
        ),
        (
            "messenger_longitudinal_stiffness",
            "Stiffness along the track; 0 lets the messenger wire slide freely.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            messenger_vertical_stiffness: keys.number(
                "messenger_vertical_stiffness",
                was.map(|supports| supports.messenger_vertical_stiffness),
                Number::positive("N/m"),
            ),
            messenger_lateral_stiffness: keys.number(
                "messenger_lateral_stiffness",
                was.map(|supports| supports.messenger_lateral_stiffness),
                Number::not_negative("N/m"),
            ),
            messenger_longitudinal_stiffness: keys.number(
                "messenger_longitudinal_stiffness",
                was.map(|supports| supports.messenger_longitudinal_stiffness),
                Number::not_negative("N/m"),
            ),
        }
    }
}

impl Entry for RegistrationArms {
    const SENTENCES: Sentences = &[
        (
            "vertical_stiffness",
            "Vertical stiffness about the static height, at which the static reaction is carried.",
        ),
        ("lateral_stiffness", "Lateral stiffness about the stagger."),
        ("mass", "Mass lumped on the contact wire."),
        (
            "free_uplift",
            "Rise of the contact wire at a support that the steady arm leaves free; not modelled, a limit for the \
             uplift of a run.",
        ),
        (
            "uplift_stop",
            "True where a stop limits the rise of the steady arm [EN 50119, 5.10.2]; not modelled.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            vertical_stiffness: keys.number(
                "vertical_stiffness",
                was.map(|arms| arms.vertical_stiffness),
                Number::not_negative("N/m"),
            ),
            lateral_stiffness: keys.number(
                "lateral_stiffness",
                was.map(|arms| arms.lateral_stiffness),
                Number::not_negative("N/m"),
            ),
            mass: keys.number("mass", was.map(|arms| arms.mass), Number::not_negative("kg")),
            free_uplift: keys.optional_number("free_uplift", was.map(|arms| arms.free_uplift), Number::positive("m")),
            uplift_stop: keys.flag("uplift_stop", was.map(|arms| arms.uplift_stop), false),
        }
    }
}

impl Entry for Damping {
    const SENTENCES: Sentences = &[("alpha", "Damping on the mass."), ("beta", "Damping on the stiffness.")];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            alpha: keys.number("alpha", was.map(|damping| damping.alpha), Number::not_negative("1/s")),
            beta: keys.number("beta", was.map(|damping| damping.beta), Number::not_negative("s")),
        }
    }
}
