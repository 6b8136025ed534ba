//! Guess of the variables of an FMU that a coupling needs.
//!
//! A variable counts by its causality, its type and its unit, which must not contradict; then by its name, as models in
//! several languages have it, by its description, and by being the only one of its unit.

use fmi2::model_description::{BaseType, Causality, Kind, ModelDescription, Variable};

use super::quantity::{Side, unit};
use super::units::Declared;
use component::exchange::{contact, instrument, strip};

/// A connection that is guessed.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Guess {
    /// This program's name.
    pub name: String,
    /// The FMU's.
    pub variable: String,
    /// Reason of the guess.
    pub because: String,
}

/// Names and words of one quantity.
struct Words {
    /// Whole names, the likeliest first.
    names: &'static [&'static str],
    /// Parts of a name or of a description.
    parts: &'static [&'static str],
}

const FORCE: Words = Words {
    names: &[
        "force",
        "f",
        "f_c",
        "fc",
        "contact_force",
        "contactforce",
        "f_contact",
        "fcontact",
        "f_k",
        "fk",
        "kontaktkraft",
        "f_kontakt",
        "kraft",
        "effort",
        "force_contact",
        "effort_contact",
        "forza",
        "fuerza",
        "u",
        "in",
    ],
    parts: &[
        "contact force",
        "contactforce",
        "contact_force",
        "kontaktkraft",
        "anpresskraft",
        "anpreßkraft",
        "effort de contact",
        "force de contact",
        "forza di contatto",
        "fuerza de contacto",
        "接触力",
        "force",
        "kraft",
        "effort",
        "forza",
        "fuerza",
        "сила",
    ],
};

const HEIGHT: Words = Words {
    names: &[
        "height", "z", "z1", "x1", "z_1", "x_1", "z_head", "z_strip", "zk", "h", "hoehe", "höhe", "hauteur", "altezza",
        "altura", "y1", "y", "s", "position", "pos", "lage", "out", "x",
    ],
    parts: &[
        "height",
        "hoehe",
        "höhe",
        "hauteur",
        "altezza",
        "altura",
        "高さ",
        "высота",
        "position",
        "displacement",
        "lage",
        "uplift",
        "hub",
        "déplacement",
        "deplacement",
        "spostamento",
    ],
};

const VELOCITY: Words = Words {
    names: &[
        "velocity",
        "v",
        "v1",
        "v_1",
        "vz",
        "dz",
        "zd",
        "zdot",
        "z_dot",
        "xdot",
        "dx1",
        "der(z)",
        "der(z1)",
        "der(x1)",
        "geschwindigkeit",
        "vitesse",
        "velocita",
        "velocità",
        "velocidad",
        "speed",
    ],
    parts: &[
        "velocity",
        "geschwindigkeit",
        "vitesse",
        "velocit",
        "velocidad",
        "speed",
        "速度",
        "скорость",
    ],
};

const COMMAND: Words = Words {
    names: &[
        "command",
        "u",
        "force_command",
        "f_command",
        "u_c",
        "f_cmd",
        "f_act",
        "actuator_force",
        "control",
        "control_force",
        "stellkraft",
        "y",
        "out",
    ],
    parts: &["command", "actuator", "control", "drive", "stell", "consigne"],
};

/// Names of the contact force that a controller aims at.
const DESIRED: [&str; 10] = [
    "desired_force",
    "force_desired",
    "f_desired",
    "f_d",
    "setpoint",
    "set_point",
    "f_set",
    "f_ref",
    "reference_force",
    "sollkraft",
];

/// Words that speak for the strip among several bodies.
const STRIP: [&str; 14] = [
    "strip",
    "head",
    "collector",
    "pan-head",
    "panhead",
    "contact",
    "wippe",
    "schleifleiste",
    "palette",
    "archet",
    "bande",
    "strisciante",
    "mesilla",
    "schleif",
];

/// Score from which on a guess is taken.
const ENOUGH: u32 = 20;

/// Candidates of one causality.
struct Candidates<'a> {
    description: &'a ModelDescription,
    causality: Causality,
}

impl<'a> Candidates<'a> {
    fn all(&self) -> impl Iterator<Item = &'a Variable> {
        let causality = self.causality;
        self.description
            .variables
            .iter()
            .filter(move |variable| variable.causality == causality && variable.base_type() == BaseType::Real)
    }

    /// The variable of exactly one of these names, or of one of them in other letters.
    fn named(&self, names: &[&str]) -> Option<&'a Variable> {
        names.iter().find_map(|name| {
            let exact = self.all().find(|variable| variable.name == *name);
            exact.or_else(|| {
                self.all()
                    .find(|variable| variable.name.to_lowercase() == name.to_lowercase())
            })
        })
    }

    /// The likeliest variable in `si`, other than `taken`.
    fn likeliest(&self, words: &Words, si: &str, taken: &[&str]) -> Option<(&'a Variable, String)> {
        let fits = |variable: &Variable| match Declared::of(self.description, variable) {
            declared @ Declared::Unit(..) => declared.to_si(si).is_some().then_some(true),
            _ => Some(false),
        };
        let open: Vec<(&Variable, bool)> = self
            .all()
            .filter(|variable| !taken.contains(&variable.name.as_str()))
            .filter_map(|variable| Some((variable, fits(variable)?)))
            .collect();
        let of_unit = open.iter().filter(|(_, unit)| *unit).count();
        let mut best: Option<(u32, &Variable, String)> = None;
        for (variable, has_unit) in &open {
            let (mut points, mut because) = (0, Vec::new());
            let name = variable.name.to_lowercase();
            let bare = name.trim_matches('\'');
            let last = bare.rsplit(['.', '/']).next().unwrap_or(bare);
            if let Some(rank) = words.names.iter().position(|known| *known == bare || *known == last) {
                points += 60 - rank as u32;
                because.push("name".to_owned());
            } else if words.parts.iter().any(|part| bare.contains(part)) {
                points += 30;
                because.push("name".to_owned());
            }
            let text = variable.description.as_deref().unwrap_or_default().to_lowercase();
            if let Some(rank) = words.parts.iter().position(|part| text.contains(part)) {
                points += 30 - (rank as u32).min(15);
                because.push("description".to_owned());
            }
            if points > 0 && STRIP.iter().any(|word| bare.contains(word) || text.contains(word)) {
                points += 10;
            }
            if *has_unit {
                points += 10;
                because.push("unit".to_owned());
                if of_unit == 1 {
                    points += 20;
                    because.push("the only one in it".to_owned());
                }
            } else if open.len() == 1 {
                points += 20;
                because.push("the only one".to_owned());
            }
            if points >= ENOUGH && best.as_ref().is_none_or(|(most, _, _)| points > *most) {
                best = Some((points, variable, because.join(", ")));
            }
        }
        best.map(|(_, variable, because)| (variable, because))
    }
}

fn guess_of(name: impl Into<String>, variable: &Variable, because: impl Into<String>) -> Guess {
    Guess {
        name: name.into(),
        variable: variable.name.clone(),
        because: because.into(),
    }
}

/// A wiring guessed from the variables: inputs and outputs as a scene would have them.
#[must_use]
pub fn guess(description: &ModelDescription, side: Side) -> [Vec<Guess>; 2] {
    let of = |causality| Candidates { description, causality };
    match side {
        Side::Pantograph => pantograph(&of(Causality::Input), &of(Causality::Output)),
        Side::Line => line(&of(Causality::Input), &of(Causality::Output)),
        Side::Controller => controller(&of(Causality::Input), &of(Causality::Output)),
    }
}

/// The side that an FMU seems to be, by what is recognised in it: a pantograph takes a force, a line gives one, a
/// controller takes a force and gives one.
#[must_use]
pub fn side(description: &ModelDescription) -> Option<Side> {
    let whole = |side: Side| {
        let [inputs, outputs] = guess(description, side);
        !inputs.is_empty() && !outputs.is_empty()
    };
    let structured = |name: &str| description.variable(name).is_some();
    if structured("strip[1].z") && structured("contact[1].force") {
        return Some(Side::Line);
    }
    if whole(Side::Pantograph) {
        return Some(Side::Pantograph);
    }
    let in_newton = |guesses: &[Guess]| {
        guesses.iter().any(|guess| {
            let variable = description.variable(&guess.variable);
            let declared = variable.map(|variable| Declared::of(description, variable));
            declared.is_some_and(|declared| declared.to_si("N").is_some())
        })
    };
    let [inputs, outputs] = guess(description, Side::Controller);
    if in_newton(&inputs) && in_newton(&outputs) {
        return Some(Side::Controller);
    }
    whole(Side::Line).then_some(Side::Line)
}

fn controller(inputs: &Candidates<'_>, outputs: &Candidates<'_>) -> [Vec<Guess>; 2] {
    let mut given = Vec::new();
    let desired = inputs.named(&DESIRED);
    let taken: Vec<&str> = desired.iter().map(|variable| variable.name.as_str()).collect();
    let force = inputs.named(&["force", instrument::SIGNALS[instrument::FORCE].name]);
    let force = force.map(|variable| (variable, "name".to_owned()));
    if let Some((force, because)) = force.or_else(|| inputs.likeliest(&FORCE, "N", &taken)) {
        given.push(guess_of("force", force, because));
    }
    if let Some(desired) = desired {
        given.push(guess_of("desired_force", desired, "name"));
    }
    let [names, _] = scene::CONTROLLER;
    for &name in names.iter().filter(|name| !["force", "desired_force"].contains(name)) {
        if let Some(variable) = inputs.named(&[name]) {
            given.push(guess_of(name, variable, "name"));
        }
    }
    let has = |given: &[Guess], name: &str| given.iter().any(|guess| guess.name.ends_with(name));
    if !has(&given, "velocity")
        && let Some((velocity, because)) = inputs.likeliest(&VELOCITY, "m/s", &taken)
    {
        let other = given.iter().any(|guess| guess.variable == velocity.name);
        given.extend((!other).then(|| guess_of("velocity", velocity, because)));
    }
    let command = outputs.likeliest(&COMMAND, "N", &[]);
    let read = command.map(|(command, because)| guess_of("command", command, because));
    [given, read.into_iter().collect()]
}

fn pantograph(inputs: &Candidates<'_>, outputs: &Candidates<'_>) -> [Vec<Guess>; 2] {
    let mut given = Vec::new();
    let ours = [("force_z", "fz"), ("force_x", "fx"), ("force_y", "fy")];
    if let Some(variable) = inputs.named(&["contact[1].fz", "contact.fz"]) {
        given.push(guess_of("force_z", variable, "name"));
        for (name, axis) in &ours[1..] {
            let names = [format!("contact[1].{axis}"), format!("contact.{axis}")];
            if let Some(variable) = inputs.named(&names.each_ref().map(String::as_str)) {
                given.push(guess_of(*name, variable, "name"));
            }
        }
    } else if let Some((variable, because)) = inputs.likeliest(&FORCE, "N", &[]) {
        given.push(guess_of("force", variable, because));
    }
    let mut read = Vec::new();
    let height = outputs
        .named(&["strip[1].z"])
        .map(|variable| (variable, "name".to_owned()));
    if let Some((height, because)) = height.or_else(|| outputs.likeliest(&HEIGHT, "m", &[])) {
        read.push(guess_of("height", height, because));
        let position = outputs.description.position(&height.name);
        let derivative = outputs.all().find(
            |variable| matches!(&variable.kind, Kind::Real { derivative_of: Some(of), .. } if Some(*of) == position),
        );
        let velocity = outputs
            .named(&["strip[1].vz"])
            .map(|variable| (variable, "name".to_owned()))
            .or_else(|| derivative.map(|variable| (variable, format!("derivative of {}", height.name))))
            .or_else(|| {
                outputs
                    .named(&[&format!("der({})", height.name)])
                    .map(|variable| (variable, "name".to_owned()))
            })
            .or_else(|| outputs.likeliest(&VELOCITY, "m/s", &[&height.name]));
        if let Some((velocity, because)) = velocity {
            read.push(guess_of("velocity", velocity, because));
        }
        // Not the roll: a scene says itself whether its line is to be tilted, which makes it spatial.
        for name in ["x", "y", "vx", "vy"] {
            if let Some(variable) = outputs.named(&[&format!("strip[1].{name}")]) {
                read.push(guess_of(name, variable, "name"));
            }
        }
    }
    [given, read]
}

fn line(inputs: &Candidates<'_>, outputs: &Candidates<'_>) -> [Vec<Guess>; 2] {
    let (mut given, mut read) = (Vec::new(), Vec::new());
    for i in 1.. {
        let before = (given.len(), read.len());
        for signal in &strip::SIGNALS[..strip::MOTION] {
            let name = signal.of(strip::GROUP, i);
            if let Some(variable) = inputs.named(&[&name]) {
                given.push(guess_of(name, variable, "name"));
            }
        }
        for signal in &contact::SIGNALS[..contact::COUNT] {
            let name = signal.of(contact::GROUP, i);
            if let Some(variable) = outputs.named(&[&name]) {
                read.push(guess_of(name, variable, "name"));
            }
        }
        if (given.len(), read.len()) == before {
            break;
        }
    }
    let has = |guesses: &[Guess], name: &str| guesses.iter().any(|guess| guess.name == name);
    if !has(&given, "strip[1].z")
        && let Some((height, because)) = inputs.likeliest(&HEIGHT, "m", &[])
    {
        let taken: Vec<&str> = vec![&height.name];
        let velocity = inputs.likeliest(&VELOCITY, "m/s", &taken);
        given.push(guess_of("strip[1].z", height, because));
        if let Some((velocity, because)) = velocity {
            given.push(guess_of("strip[1].vz", velocity, because));
        }
    }
    if !has(&read, "contact[1].force")
        && !has(&read, "contact[1].fz")
        && let Some((force, because)) = outputs.likeliest(&FORCE, "N", &[])
    {
        read.push(guess_of("contact[1].force", force, because));
    }
    debug_assert!(
        given
            .iter()
            .chain(&read)
            .all(|guess| unit(Side::Line, &guess.name).is_some())
    );
    [given, read]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn description(variables: Vec<Variable>) -> ModelDescription {
        ModelDescription::of_slave("X", variables)
    }

    /// The variables guessed, with our names.
    fn guessed(variables: Vec<Variable>) -> Vec<(String, String)> {
        let [inputs, outputs] = guess(&description(variables), Side::Pantograph);
        let pair = |guess: Guess| (guess.name, guess.variable);
        inputs.into_iter().chain(outputs).map(pair).collect()
    }

    fn pairs(expected: &[(&str, &str)]) -> Vec<(String, String)> {
        expected
            .iter()
            .map(|(a, b)| ((*a).to_owned(), (*b).to_owned()))
            .collect()
    }

    #[test]
    fn usual_names_of_several_languages_are_recognised() {
        for (force, height, velocity) in [
            ("F_c", "z1", "v1"),
            ("Kontaktkraft", "Höhe", "Geschwindigkeit"),
            ("effort_contact", "hauteur_archet", "vitesse_archet"),
            ("'contact force'", "'head height'", "'head velocity'"),
        ] {
            let found = guessed(vec![
                Variable::input("T_ambient", "K", 0.0, ""),
                Variable::input(force, "N", 0.0, ""),
                Variable::output("z_frame", "m", "Frame"),
                Variable::output(height, "m", ""),
                Variable::output(velocity, "m/s", ""),
            ]);
            assert_eq!(
                found,
                pairs(&[("force", force), ("height", height), ("velocity", velocity)])
            );
        }
    }

    #[test]
    fn a_unit_decides_where_names_say_nothing_and_vetoes_where_it_contradicts() {
        let found = guessed(vec![
            Variable::input("force", "m", 0.0, "a distance in spite of its name"),
            Variable::input("q17", "N", 0.0, ""),
            Variable::output("a1", "m/s2", ""),
            Variable::output("a2", "m", ""),
            Variable::output("a3", "m/s", ""),
        ]);
        assert_eq!(found, pairs(&[("force", "q17"), ("height", "a2"), ("velocity", "a3")]));
    }

    #[test]
    fn a_line_is_told_from_a_pantograph_by_who_gives_the_force() {
        let line = description(vec![
            Variable::input("strip_height", "m", 0.0, ""),
            Variable::output("F_contact", "N", ""),
        ]);
        assert_eq!(side(&line), Some(Side::Line));
        let [inputs, outputs] = guess(&line, Side::Line);
        assert_eq!(
            (inputs[0].name.as_str(), outputs[0].name.as_str()),
            ("strip[1].z", "contact[1].force")
        );
        let nothing = description(vec![Variable::input("T", "K", 0.0, "")]);
        assert_eq!(side(&nothing), None);
    }
}
