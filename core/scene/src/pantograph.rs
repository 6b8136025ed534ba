//! `[[pantograph]]`: one table per pantograph, the first one leads.

use dynamics::MonotoneCubic;

use crate::error::What;
use crate::keys::{Entry, Keys, Length, Number, Sentences, placeholder};
use crate::{Control, HeadPitch, HeadStrip, Horns, Linkage, Supplied};

/// `[[pantograph]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Pantograph {
    /// x of the middle of its head relative to `run.start_x`, m; negative behind.
    pub offset_x: f64,
    /// Model of the pantograph.
    pub model: PantographModel,
    /// The state at t = 0 where it is already known; the program writes it into the resolved scene.
    pub start: Option<Start>,
    /// The state of each strip of a head with several at t = 0; empty where nothing is known, or one strip is all.
    pub strip_starts: Vec<Start>,
    /// Controller and drive; none is a pantograph that is raised by a constant force.
    pub control: Option<Control>,
}

/// `pantograph.model`, or `pantograph.fmu`.
#[derive(Clone, Debug, PartialEq)]
pub enum PantographModel {
    /// `model = "lumped"`: masses one above the other.
    Lumped(Lumped),
    /// `model = "linkage"`: a mechanism of rigid bodies.
    Linkage(Linkage),
    /// `fmu = "…"`: a supplied model.
    Supplied(Supplied),
}

/// `pantograph.start`: height and force at t = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Height of the strip above the top of rail, m; of a head with several strips, the mean of theirs.
    pub height: f64,
    /// Contact force, N, not negative; of a head with several strips, the sum of theirs.
    pub force: f64,
}

/// `pantograph.strip` of a lumped pantograph.
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// Lateral width of the strip, m, centred on the track.
    pub width: f64,
    /// Bent ends of the head beyond the strip; none is a head that ends with its strip.
    pub horns: Option<Horns>,
}

/// `model = "lumped"`: n masses in a vertical chain, collector head first.
///
/// Element i (spring, damper, friction) joins mass i to mass i + 1, the last one joins the last mass to the base.
#[derive(Clone, Debug, PartialEq)]
pub struct Lumped {
    /// The collector strip, on the first mass.
    pub strip: Strip,
    /// Upward force that the raised pantograph exerts at rest, N.
    pub static_force: f64,
    /// Upward force of the air that meets the pantograph, N per (m/s)² of the speed.
    pub aero_coefficient: f64,
    /// kg, positive, n entries.
    pub masses: Vec<f64>,
    /// N/m, not negative, n entries.
    pub stiffnesses: Vec<f64>,
    /// N·s/m, not negative, n entries.
    pub dampings: Vec<f64>,
    /// Height of the strip at which all springs of the chain, without any force, are unstretched, m; `None` stands for
    /// the static height of the contact wire over the strip's start.
    pub reference_height: Option<f64>,
    /// True where element i pushes only, n entries; all false by default.
    pub unilateral: Vec<bool>,
    /// Coulomb friction force of element i, N, not negative, n entries; all 0 by default.
    pub friction: Vec<f64>,
    /// Strips of the head; empty is one in its middle. With strips on springs of their own, the first mass is the frame
    /// under them.
    pub strips: Vec<HeadStrip>,
    /// Rotation of a head with several fixed strips; none is a head that rises only.
    pub pitch: Option<HeadPitch>,
}

impl Lumped {
    /// Masses (kg), springs (N/m) and dampers (N·s/m) one above the other, collector head first, without friction,
    /// pushing and pulling, under a strip of `strip_width` m; the raised pantograph exerts `static_force` N at rest.
    #[must_use]
    pub fn new(strip_width: f64, static_force: f64, masses: &[f64], stiffnesses: &[f64], dampings: &[f64]) -> Self {
        Self {
            strip: Strip {
                width: strip_width,
                horns: None,
            },
            static_force,
            aero_coefficient: 0.0,
            masses: masses.to_vec(),
            stiffnesses: stiffnesses.to_vec(),
            dampings: dampings.to_vec(),
            reference_height: None,
            unilateral: vec![false; masses.len()],
            friction: vec![0.0; masses.len()],
            strips: Vec::new(),
            pitch: None,
        }
    }

    /// Stiffness of all springs under strips together, N/m; none without such springs.
    #[must_use]
    pub fn strip_stiffness(&self) -> Option<f64> {
        let springs = self.strips.iter().filter_map(|strip| strip.spring);
        springs.map(|spring| spring.stiffness).reduce(|a, b| a + b)
    }

    /// The pantograph with the upward force of its air at `speed` (m/s) as part of its static force.
    #[must_use]
    pub fn at_speed(&self, speed: f64) -> Self {
        let lift = if self.aero_coefficient == 0.0 {
            0.0
        } else {
            self.aero_coefficient * speed * speed
        };
        Self {
            static_force: self.static_force + lift,
            aero_coefficient: 0.0,
            ..self.clone()
        }
    }
}

impl From<Lumped> for Pantograph {
    fn from(lumped: Lumped) -> Self {
        PantographModel::Lumped(lumped).into()
    }
}

impl From<PantographModel> for Pantograph {
    /// The leading pantograph.
    fn from(model: PantographModel) -> Self {
        Self {
            offset_x: 0.0,
            model,
            start: None,
            strip_starts: Vec::new(),
            control: None,
        }
    }
}

impl Pantograph {
    /// Lateral width of the strip, m, where the scene says it.
    #[must_use]
    pub fn strip_width(&self) -> Option<f64> {
        match &self.model {
            PantographModel::Lumped(lumped) => Some(lumped.strip.width),
            PantographModel::Linkage(linkage) => Some(linkage.strip.width),
            PantographModel::Supplied(side) => Some(side.strip.as_ref()?.width),
        }
    }

    /// Horns of the head, where it has some.
    #[must_use]
    pub fn horns(&self) -> Option<&Horns> {
        match &self.model {
            PantographModel::Lumped(lumped) => lumped.strip.horns.as_ref(),
            PantographModel::Linkage(linkage) => linkage.strip.horns.as_ref(),
            PantographModel::Supplied(side) => side.strip.as_ref()?.horns.as_ref(),
        }
    }

    /// Largest distance from the middle of the head at which a wire rests on it, m, where the scene says it.
    #[must_use]
    pub fn half_length(&self) -> Option<f64> {
        let horns = self.horns().map(Horns::half_length);
        horns.or_else(|| Some(0.5 * self.strip_width()?))
    }

    /// Height of the top of a head with horns above its strip over the distance from its middle, m.
    #[must_use]
    pub fn top(&self) -> Option<MonotoneCubic> {
        Some(self.horns()?.top(self.strip_width()?))
    }
}

/// Sentence on the horns of a strip.
pub(crate) const HORNS: &str =
    "Bent ends of the head beyond the straight strip, which carry a wire too; left out, the head ends with the strip.";

/// The words of `model`.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Lumped,
    Linkage,
}

const KINDS: [(&str, Kind); 2] = [("lumped", Kind::Lumped), ("linkage", Kind::Linkage)];

impl Entry for Pantograph {
    const SENTENCES: Sentences = &[
        (
            "offset_x",
            "Place of the strip, or of the middle of a head with several, relative to `run.start_x`, negative behind.",
        ),
        (
            "from",
            "Path of a library file with keys of this table, relative to the scene; keys that the scene has win.",
        ),
        (
            "model",
            "Masses one above the other, or a mechanism of rigid bodies; left out with `fmu`.",
        ),
        (
            "start",
            "State at t = 0 where it is known; the program writes it into resolved scenes.",
        ),
        (
            "strip_start",
            "State of each strip of a head with several at t = 0; the program writes it into resolved scenes.",
        ),
        (
            "control",
            "Controller and drive that act while the pantograph runs; left out, it is raised by a constant force.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        keys.written_out("from", "", "text");
        let offset_x = keys.number(
            "offset_x",
            was.map(|pantograph| pantograph.offset_x),
            Number::any("m").default(0.0),
        );
        if keys.describes() {
            return Self::described(keys, offset_x);
        }
        // `model` or `fmu` says which other keys there are.
        let model = was.map(|pantograph| &pantograph.model);
        let supplied = model.and_then(|model| match model {
            PantographModel::Supplied(side) => Some(side),
            _ => None,
        });
        let model = if keys.has("fmu", supplied.is_some()) {
            let side = Supplied::pantograph(keys, supplied);
            if was.is_none() {
                let because = "fmu is given, which describes the whole pantograph";
                if keys.has("model", false) {
                    let because = because.to_string();
                    keys.report("model", What::LeaveOut { because });
                }
                keys.leave_out::<Lumped>(because);
                keys.leave_out::<Linkage>(because);
            }
            Some(PantographModel::Supplied(side))
        } else if was.is_none() && !keys.has("model", false) {
            let expected = "\"lumped\" or \"linkage\", or else fmu = \"path\" for a supplied FMU".to_string();
            keys.report("model", What::Missing { expected });
            None
        } else {
            let kind = model.map(|model| match model {
                PantographModel::Linkage(_) => Kind::Linkage,
                _ => Kind::Lumped,
            });
            keys.word_among("model", kind, &KINDS, &[], None)
                .map(|kind| match (kind, model) {
                    (Kind::Lumped, Some(PantographModel::Lumped(lumped))) => {
                        PantographModel::Lumped(keys.part(Some(lumped)))
                    }
                    (Kind::Lumped, _) => PantographModel::Lumped(keys.part(None)),
                    (Kind::Linkage, Some(PantographModel::Linkage(linkage))) => {
                        PantographModel::Linkage(keys.part(Some(linkage)))
                    }
                    (Kind::Linkage, _) => PantographModel::Linkage(keys.part(None)),
                })
        };
        if let Some(PantographModel::Linkage(_)) = &model {
            refuse_pitch(keys);
        }
        let model = model.unwrap_or_else(|| {
            keys.abandon();
            PantographModel::Lumped(placeholder())
        });
        Self {
            offset_x,
            model,
            start: keys.optional_inline_table("start", was.map(|pantograph| pantograph.start.as_ref())),
            strip_starts: keys.any_tables("strip_start", was.map(|pantograph| pantograph.strip_starts.as_slice())),
            control: keys.optional_inline_table("control", was.map(|pantograph| pantograph.control.as_ref())),
        }
    }
}

/// Refuses the pitch of a lumped head on a linkage.
fn refuse_pitch(keys: &mut Keys) {
    if keys.has("pitch", false) {
        let because = "model is \"linkage\", whose head turns as its joints let it: a revolute joint under it, or none";
        let because = because.to_string();
        keys.report("pitch", What::LeaveOut { because });
    }
}

impl Pantograph {
    /// The keys of every model in turn.
    fn described(keys: &mut Keys, offset_x: f64) -> Self {
        keys.word_among("model", None, &KINDS, &[], None);
        let start = keys.optional_inline_table("start", None);
        let strip_starts = keys.any_tables("strip_start", None);
        let control = keys.optional_inline_table("control", None);
        let lumped = keys.only("`model = \"lumped\"`", |keys| keys.part(None));
        keys.only("`model = \"linkage\"`", |keys| keys.part::<Linkage>(None));
        keys.only("`fmu`", |keys| Supplied::pantograph(keys, None));
        Self {
            offset_x,
            model: PantographModel::Lumped(lumped),
            start,
            strip_starts,
            control,
        }
    }
}

impl Entry for Start {
    const SENTENCES: Sentences = &[
        ("height", "Height of the strip above the top of rail."),
        ("force", "Contact force."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            height: keys.number("height", was.map(|start| start.height), Number::any("m")),
            force: keys.number("force", was.map(|start| start.force), Number::not_negative("N")),
        }
    }
}

impl Entry for Strip {
    const SENTENCES: Sentences = &[
        ("width", "Lateral width of the strip, centred on the track."),
        ("horns", HORNS),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            width: keys.number("width", was.map(|strip| strip.width), Number::positive("m")),
            horns: keys.optional_inline_table("horns", was.map(|strip| strip.horns.as_ref())),
        }
    }
}

impl Entry for Lumped {
    const SENTENCES: Sentences = &[
        ("masses", "Masses, collector head first."),
        ("strip", "Collector strip, on the first mass."),
        (
            "static_force",
            "Upward force that the raised pantograph exerts at rest.",
        ),
        (
            "aero_coefficient",
            "Upward force of the air on the pantograph per square of the speed, part of the static force of a run; \
             without a table of wind.",
        ),
        ("stiffnesses", "Spring under each mass, the last one to the base."),
        ("dampings", "Damper under each mass."),
        (
            "reference_height",
            "Height of the strip with all springs unstretched; left out, the static height of the contact wire over \
             the start.",
        ),
        (
            "unilateral",
            "True where the element under a mass pushes only, one per mass; all false where left out.",
        ),
        (
            "friction",
            "Coulomb friction force under each mass; all 0 where left out.",
        ),
        (
            "strips",
            "Strips of the head along the track; left out, one in its middle. With springs of their own, the first of \
             `masses` is the frame under them.",
        ),
        (
            "pitch",
            "Rotation of a head with several fixed strips about its lateral axis; left out, the head rises only.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let masses = keys.numbers(
            "masses",
            was.map(|lumped| lumped.masses.as_slice()),
            Number::positive("kg"),
            Length::NotEmpty,
        );
        let n = masses.len();
        let friction = was.map(|lumped| lumped.friction.as_slice());
        Self {
            strip: keys.inline_table("strip", was.map(|lumped| &lumped.strip)),
            static_force: keys.number(
                "static_force",
                was.map(|lumped| lumped.static_force),
                Number::positive("N"),
            ),
            aero_coefficient: keys.number(
                "aero_coefficient",
                was.map(|lumped| lumped.aero_coefficient),
                Number::any("N s²/m²").default(0.0),
            ),
            masses,
            stiffnesses: keys.numbers(
                "stiffnesses",
                was.map(|lumped| lumped.stiffnesses.as_slice()),
                Number::not_negative("N/m"),
                Length::Any,
            ),
            dampings: keys.numbers(
                "dampings",
                was.map(|lumped| lumped.dampings.as_slice()),
                Number::not_negative("N s/m"),
                Length::Any,
            ),
            reference_height: keys.optional_number(
                "reference_height",
                was.map(|lumped| lumped.reference_height),
                Number::positive("m"),
            ),
            unilateral: keys
                .optional_flags("unilateral", was.map(|lumped| lumped.unilateral.as_slice()))
                .unwrap_or_else(|| vec![false; n]),
            friction: if keys.has("friction", friction.is_some()) {
                keys.numbers("friction", friction, Number::not_negative("N"), Length::Any)
            } else {
                vec![0.0; n]
            },
            strips: keys.any_tables("strips", was.map(|lumped| lumped.strips.as_slice())),
            pitch: keys.optional_inline_table("pitch", was.map(|lumped| lumped.pitch.as_ref())),
        }
    }
}
