//! A sweep as it is wished for: a TOML file, options of the command line, or both.

use std::path::PathBuf;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::design::{Design, Method, Sample};
use crate::error::SweepError;
use crate::plan::{PlanWishes, Typed, Varied};
use crate::values::{Distribution, Value, Values, range};

/// Seed where none is given.
const SEED: u64 = 1;

/// Wishes for a sweep, not checked against a scene yet.
#[derive(Clone, Debug, Default)]
pub struct Wishes {
    /// Scene, relative to the file of the sweep.
    pub scene: Option<PathBuf>,
    /// Word of the mode.
    pub mode: Option<String>,
    /// Keys set for all cases, `key=value`.
    pub set: Vec<String>,
    /// Keys that are varied.
    pub varied: Vec<Varied>,
    /// Keys or plain names with their expressions.
    pub derived: Vec<(String, Typed)>,
    /// Constraints.
    pub constraints: Vec<Typed>,
    /// Method of samples; nothing for all combinations.
    pub method: Option<Method>,
    /// Number of samples.
    pub count: Option<u64>,
    /// Seed.
    pub seed: Option<u64>,
    /// `true` where filtered forces are kept.
    pub series: bool,
}

/// Keys of the file.
const KEYS: [&str; 8] = ["scene", "mode", "set", "vary", "derive", "where", "sample", "series"];

/// Keys of its table `sample`.
const SAMPLE_KEYS: [&str; 3] = ["method", "count", "seed"];

/// Keys of a table of values; names of distributions and their numbers are others.
const RANGE_KEYS: [&str; 3] = ["from", "to", "step"];

/// Most changes of letters from what is typed to the key that is meant.
const FARTHEST: usize = 2;

/// Names of distributions.
fn distributions() -> impl Iterator<Item = &'static str> {
    scene::Shape::ALL.iter().map(|shape| shape.name()).chain(["choice"])
}

/// `true` for the text of a sweep, as opposed to that of a scene: one with a key of a sweep, or with a key that is none
/// of a scene and nearest in spelling to one of a sweep, and an empty one.
#[must_use]
pub fn is_sweep(text: &str) -> bool {
    let top = |path: String| path.split('.').next().unwrap_or_default().to_owned();
    let of_scene: Vec<String> = scene::described_keys().iter().map(|key| top(key.path())).collect();
    let distance = |key: &str, known: &str| strsim::damerau_levenshtein(key, known);
    let is_own = |key: &str| {
        let to_own = KEYS.iter().map(|own| distance(key, own)).min().unwrap_or_default();
        let to_scene = of_scene
            .iter()
            .map(|known| distance(key, known))
            .min()
            .unwrap_or_default();
        to_own <= FARTHEST && to_own < to_scene
    };
    let is_own_table = |table: &DeTable| table.is_empty() || table.keys().any(|key| is_own(key.get_ref()));
    DeTable::parse(text).is_ok_and(|table| is_own_table(table.get_ref()))
}

/// A table of the file, its keys in the order of the file.
struct Reader<'a> {
    text: &'a str,
    origin: &'a str,
}

type Entry<'t, 'i> = (String, usize, &'t Spanned<DeValue<'i>>);

impl Reader<'_> {
    /// Place of a key that begins at this byte.
    fn place(&self, key: &str, at: usize) -> String {
        let line = self.text[..at.min(self.text.len())].matches('\n').count() + 1;
        format!("{}:{line}: {key}", self.origin)
    }

    /// Entries of a table in the order of the file.
    fn entries<'t, 'i>(&self, table: &'t DeTable<'i>) -> Vec<Entry<'t, 'i>> {
        let entry = |(key, value): (&'t Spanned<_>, &'t Spanned<DeValue<'i>>)| {
            let name: &std::borrow::Cow<'_, str> = key.get_ref();
            (name.to_string(), key.span().start, value)
        };
        let mut entries: Vec<Entry<'t, 'i>> = table.iter().map(entry).collect();
        entries.sort_by_key(|(_, at, _)| *at);
        entries
    }

    /// Keys of the scene under a table; dotted keys without quotes are tables in tables.
    fn keys<'t, 'i>(&self, table: &'t DeTable<'i>, before: &str, keys: &mut Vec<Entry<'t, 'i>>) {
        for (name, at, value) in self.entries(table) {
            let path = if before.is_empty() {
                name.clone()
            } else {
                format!("{before}.{name}")
            };
            match value.get_ref() {
                DeValue::Table(inner) if !name.contains(['.', '[']) && !is_values(inner) => {
                    self.keys(inner, &path, keys)
                }
                _ => keys.push((path, at, value)),
            }
        }
    }

    /// A value as it is typed.
    fn typed(&self, value: &Spanned<DeValue<'_>>) -> String {
        self.text.get(value.span()).unwrap_or_default().trim().to_owned()
    }

    fn value(&self, value: &Spanned<DeValue<'_>>) -> Value {
        match value.get_ref() {
            DeValue::Integer(digits) => match i64::from_str_radix(digits.as_str(), digits.radix()) {
                Ok(number) => Value::Number(number as f64),
                Err(_) => Value::Word(self.typed(value)),
            },
            DeValue::Float(digits) => match digits.as_str().parse() {
                Ok(number) if f64::is_finite(number) => Value::Number(number),
                _ => Value::Word(self.typed(value)),
            },
            _ => Value::Word(self.typed(value)),
        }
    }

    fn values(&self, value: &Spanned<DeValue<'_>>) -> Result<Values, String> {
        match value.get_ref() {
            DeValue::String(text) => Values::typed(text),
            DeValue::Array(list) => Values::listed(list.iter().map(|entry| self.value(entry)).collect()),
            DeValue::Table(table) => self.table_of_values(table),
            _ => Values::listed(vec![self.value(value)]),
        }
    }

    fn table_of_values(&self, table: &DeTable<'_>) -> Result<Values, String> {
        let entries = self.entries(table);
        if let [(name, _, value)] = &*entries
            && let DeValue::Array(list) = value.get_ref()
        {
            let arguments: Vec<Value> = list.iter().map(|entry| self.value(entry)).collect();
            return Distribution::named(name, &arguments).map(Values::Distributed);
        }
        let number = |wanted: &str| {
            let found = entries.iter().find(|(name, ..)| name == wanted);
            found.and_then(|(_, _, value)| self.value(value).number())
        };
        match (number("from"), number("to"), number("step"), entries.len()) {
            (Some(from), Some(to), Some(step), 3) => range(from, to, step).map(Values::Listed),
            _ => Err(format!(
                "must be a list, \"a:b:step\", {{ from = a, to = b, step = s }}, or one of {} with a list, such as \
                 {{ normal = [110, 5] }}",
                distributions().collect::<Vec<_>>().join(", ")
            )),
        }
    }

    fn text_of(&self, place: &str, value: &Spanned<DeValue<'_>>) -> Result<String, SweepError> {
        match value.get_ref() {
            DeValue::String(text) => Ok(text.to_string()),
            _ => Err(SweepError::wish(
                place,
                format!("{}: must be a text in quotes", self.typed(value)),
            )),
        }
    }

    fn table_of<'t, 'i>(&self, place: &str, value: &'t Spanned<DeValue<'i>>) -> Result<&'t DeTable<'i>, SweepError> {
        match value.get_ref() {
            DeValue::Table(table) => Ok(table),
            _ => Err(SweepError::wish(
                place,
                format!("{}: must be a table", self.typed(value)),
            )),
        }
    }

    fn count(&self, place: &str, value: &Spanned<DeValue<'_>>) -> Result<u64, SweepError> {
        let number = self
            .value(value)
            .number()
            .filter(|number| *number >= 0.0 && number.fract() == 0.0);
        number
            .map(|number| number as u64)
            .ok_or_else(|| SweepError::wish(place, format!("{}: must be a whole number from 0", self.typed(value))))
    }

    fn unknown(&self, place: &str, name: &str, known: &[&str]) -> SweepError {
        let near = |known: &&&str| strsim::damerau_levenshtein(known, name);
        let nearest = known.iter().min_by_key(near).filter(|known| near(known) <= FARTHEST);
        let nearest = nearest.map_or_else(String::new, |near| format!(", did you mean {near}?"));
        SweepError::wish(
            place,
            format!("unknown key{nearest}; known keys are {}", known.join(", ")),
        )
    }
}

/// `true` for a table that is values of a key, not a part of the key's path.
fn is_values(table: &DeTable<'_>) -> bool {
    let own = |key: &str| RANGE_KEYS.contains(&key) || distributions().any(|name| name == key);
    table.keys().all(|key| own(key.get_ref()))
}

/// `true` where `set`, `key=value`, sets this key.
fn is_of(set: &str, key: &str) -> bool {
    set.split_once('=').is_some_and(|(set, _)| set.trim() == key)
}

/// A method by its name.
///
/// # Errors
/// Names that there are.
pub fn method(name: &str) -> Result<Method, String> {
    let found = Method::ALL.into_iter().find(|method| method.name() == name.trim());
    found.ok_or_else(|| format!("must be one of {}", Method::ALL.map(Method::name).join(", ")))
}

impl Wishes {
    /// Wishes of a file; `origin` is its name in messages.
    ///
    /// # Errors
    /// The first key that is unknown or has a wrong value.
    pub fn read(text: &str, origin: &str) -> Result<Self, SweepError> {
        let wrong = |error: toml::de::Error| {
            let message = error.message().trim().replace('\n', ", ");
            let at = error.span().map_or(0, |span| span.start);
            let line = text[..at.min(text.len())].matches('\n').count() + 1;
            SweepError::wish(format!("{origin}:{line}"), format!("not valid TOML: {message}"))
        };
        let parsed = DeTable::parse(text).map_err(wrong)?;
        let reader = Reader { text, origin };
        let mut wishes = Self::default();
        for (name, at, value) in reader.entries(parsed.get_ref()) {
            let place = reader.place(&name, at);
            match &*name {
                "scene" => wishes.scene = Some(reader.text_of(&place, value)?.into()),
                "mode" => wishes.mode = Some(reader.text_of(&place, value)?),
                "series" => match value.get_ref() {
                    DeValue::Boolean(series) => wishes.series = *series,
                    _ => return Err(SweepError::wish(place, "must be true or false")),
                },
                "where" => wishes.take_constraints(&reader, &place, value)?,
                "sample" => wishes.take_sample(&reader, reader.table_of(&place, value)?)?,
                "set" | "vary" | "derive" => wishes.take_keys(&reader, &name, reader.table_of(&place, value)?)?,
                _ => return Err(reader.unknown(&place, &name, &KEYS)),
            }
        }
        wishes.check_set(&wishes.set)?;
        Ok(wishes)
    }

    /// Refuses keys that are varied or derived and set to one value for all cases, too; `set` has the form `key=value`.
    ///
    /// # Errors
    /// The first such key.
    pub fn check_set(&self, set: &[String]) -> Result<(), SweepError> {
        let varied = self.varied.iter().map(|varied| (&varied.name, &varied.place, "varied"));
        let derived = self.derived.iter().map(|(name, typed)| (name, &typed.place, "derived"));
        for (name, place, how) in varied.chain(derived) {
            if let Some(set) = set.iter().find(|set| is_of(set, name)) {
                let what = format!("{name}: is set for all cases too, by {set}; must be {how} or set, not both");
                return Err(SweepError::wish(place, what));
            }
        }
        Ok(())
    }

    fn take_constraints(
        &mut self,
        reader: &Reader<'_>,
        place: &str,
        value: &Spanned<DeValue<'_>>,
    ) -> Result<(), SweepError> {
        let one = [value];
        let several: Vec<_> = match value.get_ref() {
            DeValue::Array(list) => list.iter().collect(),
            _ => one.to_vec(),
        };
        for value in several {
            self.constraints.push(Typed {
                text: reader.text_of(place, value)?,
                place: place.to_owned(),
            });
        }
        Ok(())
    }

    fn take_sample(&mut self, reader: &Reader<'_>, table: &DeTable<'_>) -> Result<(), SweepError> {
        for (name, at, value) in reader.entries(table) {
            let place = reader.place(&format!("sample.{name}"), at);
            match &*name {
                "method" => {
                    let text = reader.text_of(&place, value)?;
                    let found = method(&text).map_err(|what| SweepError::wish(&place, format!("\"{text}\": {what}")));
                    self.method = Some(found?);
                }
                "count" => self.count = Some(reader.count(&place, value)?),
                "seed" => self.seed = Some(reader.count(&place, value)?),
                _ => return Err(reader.unknown(&place, &name, &SAMPLE_KEYS)),
            }
        }
        Ok(())
    }

    fn take_keys(&mut self, reader: &Reader<'_>, table: &str, entries: &DeTable<'_>) -> Result<(), SweepError> {
        let mut keys = Vec::new();
        reader.keys(entries, "", &mut keys);
        for (name, at, value) in keys {
            let place = reader.place(&format!("{table}.\"{name}\""), at);
            match table {
                "set" => self.set.push(format!("{name}={}", reader.typed(value))),
                "vary" => {
                    let refused = |what| SweepError::wish(&place, format!("{}: {what}", reader.typed(value)));
                    let values = reader.values(value).map_err(refused)?;
                    self.varied.push(Varied { name, values, place });
                }
                _ => {
                    let text = reader.text_of(&place, value)?;
                    self.derived.push((name, Typed { text, place }));
                }
            }
        }
        Ok(())
    }

    /// Adds `key=values` of the command line; takes the place of the file's value or values of that key.
    ///
    /// # Errors
    /// Values that are none.
    pub fn vary(&mut self, text: &str) -> Result<(), SweepError> {
        let place = format!("--vary {text}");
        let form =
            "must have the form key=values, such as run.speed_kmh=200:320:10 or pantograph[1].static_force=100,120";
        let (name, values) = text.split_once('=').ok_or_else(|| SweepError::wish(&place, form))?;
        let values = Values::typed(values).map_err(|what| SweepError::wish(&place, what))?;
        let name = name.trim().to_owned();
        self.set.retain(|set| !is_of(set, &name));
        // The same key twice on the command line is refused by the plan; one of the file is replaced.
        let of_file = self
            .varied
            .iter()
            .position(|varied| varied.name == name && !varied.place.starts_with("--vary"));
        let varied = Varied { name, values, place };
        match of_file {
            Some(index) => self.varied[index] = varied,
            None => self.varied.push(varied),
        }
        Ok(())
    }

    /// Adds `key=expression` of the command line; takes the place of the file's value or expression of that key.
    ///
    /// # Errors
    /// A text without `=`.
    pub fn derive(&mut self, text: &str) -> Result<(), SweepError> {
        let place = format!("--derive {text}");
        let form = "must have the form key=expression, such as run.duration=600/(run.speed_kmh/3.6)";
        let (name, expression) = text.split_once('=').ok_or_else(|| SweepError::wish(&place, form))?;
        let name = name.trim().to_owned();
        let typed = Typed {
            text: expression.trim().to_owned(),
            place,
        };
        self.set.retain(|set| !is_of(set, &name));
        let own = |typed: &Typed| typed.place.starts_with("--derive");
        match self
            .derived
            .iter_mut()
            .find(|(known, typed)| *known == name && !own(typed))
        {
            Some((_, of_file)) => *of_file = typed,
            None => self.derived.push((name, typed)),
        }
        Ok(())
    }

    /// Adds a constraint of the command line.
    pub fn constrain(&mut self, text: &str) {
        self.constraints.push(Typed {
            text: text.to_owned(),
            place: "--where".to_owned(),
        });
    }

    /// Wishes for the plan.
    ///
    /// # Errors
    /// A number of samples without a method, or a method without a number.
    pub fn plan(&self) -> Result<PlanWishes, SweepError> {
        let design = match (self.method, self.count) {
            (Some(method), Some(count)) => Design::Sample(Sample {
                method,
                count,
                seed: self.seed.unwrap_or(SEED),
            }),
            (Some(method), None) => {
                let what = format!(
                    "{}: must have a number of samples too, such as --count 100",
                    method.name()
                );
                return Err(SweepError::wish("sample", what));
            }
            (None, Some(_)) => {
                let what = "must have a method too: --sample latin, sobol or random";
                return Err(SweepError::wish("count", what));
            }
            (None, None) if self.seed.is_some() => {
                return Err(SweepError::wish(
                    "seed",
                    "must be left out without --sample: combinations need no seed",
                ));
            }
            (None, None) => Design::Factorial,
        };
        Ok(PlanWishes {
            varied: self.varied.clone(),
            derived: self.derived.clone(),
            constraints: self.constraints.clone(),
            design,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = r#"
scene = "en50318-300.toml"
mode = "monolithic"
where = "run.speed_kmh < 300"

[set]
"catenary.spans" = 8
"coupling.macro_step" = { tolerance = 1.0 }

[vary]
run.speed_kmh = "200:320:10"
"pantograph[1].static_force" = { normal = [110, 5] }
coupling.algorithm = ["jacobi", "gauss_seidel"]
a = { from = 1, to = 2, step = 0.5 }

[derive]
run.duration = "600 / (run.speed_kmh / 3.6)"

[sample]
method = "latin"
count = 1_000
"#;

    #[test]
    fn a_file_is_read_in_its_order() {
        assert!(is_sweep(FILE));
        let wishes = Wishes::read(FILE, "s.toml").unwrap();
        assert_eq!(wishes.scene, Some("en50318-300.toml".into()));
        assert_eq!(
            wishes.set,
            ["catenary.spans=8", "coupling.macro_step={ tolerance = 1.0 }"]
        );
        let names: Vec<&str> = wishes.varied.iter().map(|varied| &*varied.name).collect();
        assert_eq!(
            names,
            ["run.speed_kmh", "pantograph[1].static_force", "coupling.algorithm", "a"]
        );
        assert_eq!(
            wishes.varied[1].values,
            Values::Distributed(Distribution::Of(scene::Shape::Normal, [110.0, 5.0]))
        );
        let words = ["\"jacobi\"", "\"gauss_seidel\""].map(|word| Value::Word(word.to_owned()));
        assert_eq!(wishes.varied[2].values, Values::Listed(words.to_vec()));
        assert_eq!(wishes.derived[0].0, "run.duration");
        assert_eq!(wishes.constraints[0].text, "run.speed_kmh < 300");
        let sample = Sample {
            method: Method::Latin,
            count: 1000,
            seed: SEED,
        };
        assert_eq!(wishes.plan().unwrap().design, Design::Sample(sample));
    }

    #[test]
    fn options_take_the_place_of_the_file() {
        let mut wishes = Wishes::read(FILE, "s.toml").unwrap();
        wishes.vary("run.speed_kmh=250").unwrap();
        wishes.derive("run.duration=2").unwrap();
        wishes.vary("b=1,2").unwrap();
        assert_eq!(wishes.varied.len(), 5);
        assert_eq!(wishes.varied[0].values, Values::Listed(vec![Value::Number(250.0)]));
        assert_eq!(wishes.derived[0].1.text, "2");
    }

    #[test]
    fn mistakes_name_line_and_key_and_what_would_be_right() {
        for (from, to, parts) in [
            (
                "[vary]",
                "[varry]",
                ["s.toml:10: varry: unknown key", "did you mean vary?"],
            ),
            (
                "method",
                "methud",
                ["s.toml:20: sample.methud: unknown key", "did you mean method?"],
            ),
            (
                "\"latin\"",
                "\"latim\"",
                ["\"latim\": must be one of", "latin, sobol, random"],
            ),
            (
                "200:320:10",
                "200:320:-10",
                ["s.toml:11: vary.\"run.speed_kmh\"", "one above 0"],
            ),
            ("normal =", "gauss =", ["s.toml:12", "must be one of uniform(from, to)"]),
            ("[set]", "[set", ["s.toml:6", "not valid TOML"]),
            (
                "scene = \"en50318-300.toml\"",
                "scene = 3",
                ["s.toml:2: scene: 3", "text in quotes"],
            ),
        ] {
            let said = Wishes::read(&FILE.replace(from, to), "s.toml").unwrap_err().to_string();
            assert!(parts.iter().all(|part| said.contains(part)), "{said}");
        }
    }

    #[test]
    fn a_sweep_is_known_by_its_keys_even_where_one_is_mistyped() {
        for text in [
            "",
            "# nothing\n",
            "[vray]\na = [1]\n",
            "scene = \"a.toml\"\n",
            "[set]\na = 1\n",
            "wher = \"a > 1\"",
        ] {
            assert!(is_sweep(text), "{text}");
        }
        for text in [
            "[run]\nspeed_kmh = 3\n",
            "[modle]\n",
            "[ranges]\n",
            "titel = \"a\"\n",
            "[set\n",
        ] {
            assert!(!is_sweep(text), "{text}");
        }
    }

    #[test]
    fn a_key_is_varied_or_set_and_not_both() {
        let twice = FILE.replace(
            "\"catenary.spans\" = 8",
            "\"catenary.spans\" = 8\n\"run.speed_kmh\" = 250",
        );
        let said = Wishes::read(&twice, "s.toml").unwrap_err().to_string();
        let expected = "run.speed_kmh: is set for all cases too, by run.speed_kmh=250; must be varied or set, not both";
        assert!(
            said.starts_with("s.toml:12: vary") && said.ends_with(expected),
            "{said}"
        );
        // What the command line varies takes the place of what the file sets.
        let mut wishes = Wishes::read(FILE, "s.toml").unwrap();
        wishes.vary("catenary.spans=8,10").unwrap();
        assert_eq!(wishes.set, ["coupling.macro_step={ tolerance = 1.0 }"]);
        assert!(wishes.check_set(&["run.low_pass_hz=20".to_owned()]).is_ok());
        assert!(wishes.check_set(&["run.duration=3".to_owned()]).is_err());
    }
}
