//! Sensitivity: how much results depend on numbers that are not known for certain, one at a time.
//!
//! | file | subject |
//! | --- | --- |
//! | `mod` | parameters with their ranges; effects of each on each figure |
//! | `page` | `sensitivity.html` |
//!
//! The scene is run as it is, and with each parameter at the ends of its range. An effect is the change of a figure
//! there. For independent parameters and small changes they add by squares, those upward and those downward apart:
//!
//! ```text
//! above² = Σ max(0, Δ_low, Δ_high)²        below² = Σ max(0, −Δ_low, −Δ_high)²
//! ```

mod page;

use std::path::Path;

use results::{OutputDirectory, ResultsError, Uncertainty};
use scene::{Mark, Range};
use serde::{Deserialize, Serialize};

use crate::base::{Base, Numbers};
use crate::design::Design;
use crate::error::SweepError;
use crate::plan::{PlanWishes, Varied};
use crate::record::Record;
use crate::values::{Distribution, Value, Values, shown};

/// Name of the table.
pub const CSV: &str = "sensitivity.csv";
/// Name of the file for programs.
pub const JSON: &str = "sensitivity.json";
/// Name of the page.
pub const PAGE: &str = "sensitivity.html";

/// A number with the range that it may have.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its key.
    pub key: String,
    /// Its value, in the unit of the key.
    pub value: f64,
    /// Least that it may be.
    pub low: f64,
    /// Most that it may be.
    pub high: f64,
    /// Its distribution; even between the ends where there is none.
    pub distribution: Option<Distribution>,
    /// Its origin.
    pub mark: Option<Mark>,
}

impl Parameter {
    /// Parameters of a scene: those that it gives ranges, and `more` as `KEY=low:high` or `KEY=normal(mean, std)`,
    /// which hold before them. The ends of a distribution are those of [`Distribution::ends`].
    ///
    /// # Errors
    /// A range that is none, a key without a number, a value outside its range, and a scene without any range.
    pub fn of(base: &Base, more: &[String]) -> Result<Vec<Self>, SweepError> {
        let numbers = Numbers::of(&base.read(&[])?);
        let mut ranges = base.ranges()?;
        for text in more {
            let range = typed(text)?;
            ranges.retain(|known| known.key != range.key);
            ranges.push(range);
        }
        if ranges.is_empty() {
            let what = "gives no number a range: must give some, as in \"catenary.damping.alpha\" = { low = 0.005, \
                        high = 0.03 } under [ranges], or --range catenary.damping.alpha=0.005:0.03";
            return Err(SweepError::wish(&base.origin, what));
        }
        let parameter = |range: Range| {
            let wrong = |what: String| SweepError::wish(format!("{}: ranges", base.origin), what);
            let Some(value) = numbers.get(&range.key) else {
                let what = format!("{}: is no number of the scene{}", range.key, numbers.meant(&range.key));
                return Err(wrong(what));
            };
            let distribution = range.distribution.map(|(shape, numbers)| {
                Distribution::of(shape, numbers).map_err(|what| wrong(format!("{}: {shape} {what}", range.key)))
            });
            let distribution = distribution.transpose()?;
            let [low, high] = distribution
                .as_ref()
                .and_then(Distribution::ends)
                .unwrap_or([range.low.unwrap_or(value), range.high.unwrap_or(value)]);
            if !(low <= value && value <= high && low < high) {
                let of = distribution.map_or_else(String::new, |distribution| format!(" by {distribution}"));
                let what = format!(
                    "{} = {}: must lie within its range, {} to {}{of}, whose ends must differ",
                    range.key,
                    shown(value),
                    shown(low),
                    shown(high)
                );
                return Err(wrong(what));
            }
            let (key, mark) = (range.key, range.mark);
            Ok(Self {
                key,
                value,
                low,
                high,
                distribution,
                mark,
            })
        };
        ranges.into_iter().map(parameter).collect()
    }

    /// Those of these keys, in the order of the keys.
    ///
    /// # Errors
    /// A key that has no range, and one that stands twice.
    pub fn chosen(parameters: Vec<Self>, keys: &[String]) -> Result<Vec<Self>, SweepError> {
        let known: Vec<&str> = parameters.iter().map(|parameter| &*parameter.key).collect();
        let place = |key: &String| {
            let unknown = || {
                let what = format!("{key}: has no range; must be one of {}", known.join(", "));
                SweepError::wish("keys", what)
            };
            known.iter().position(|known| known == key).ok_or_else(unknown)
        };
        let places: Vec<usize> = keys.iter().map(place).collect::<Result<_, _>>()?;
        if let Some((_, key)) = keys
            .iter()
            .enumerate()
            .find(|(index, key)| keys[..*index].contains(key))
        {
            return Err(SweepError::wish("keys", format!("{key}: must stand once, not twice")));
        }
        Ok(places.into_iter().map(|place| parameters[place].clone()).collect())
    }

    /// Ends of the range that differ from the value.
    fn ends(&self) -> impl Iterator<Item = f64> + '_ {
        [self.low, self.high].into_iter().filter(|end| *end != self.value)
    }
}

/// A range as it is typed, `KEY=low:high` or `KEY=normal(mean, std)`.
fn typed(text: &str) -> Result<Range, SweepError> {
    let wrong = |what: &str| SweepError::wish("--range", format!("{text}: {what}"));
    let such = "must be KEY=low:high, such as catenary.damping.alpha=0.005:0.03, or KEY=normal(mean, std)";
    let (key, range) = text.split_once('=').ok_or_else(|| wrong(such))?;
    let key = key.trim().to_owned();
    let known = |key, low, high, distribution| Range {
        key,
        low,
        high,
        distribution,
        mark: None,
    };
    if range.contains('(') {
        return match Values::typed(range).map_err(|what| wrong(&what))? {
            Values::Distributed(Distribution::Of(shape, numbers)) => Ok(known(key, None, None, Some((shape, numbers)))),
            _ => Err(wrong(such)),
        };
    }
    let number = |text: &str| Value::of(text).number();
    let ends = range
        .split_once(':')
        .and_then(|(low, high)| Some([number(low)?, number(high)?]));
    let [low, high] = ends.filter(|_| !key.is_empty()).ok_or_else(|| wrong(such))?;
    Ok(known(key, Some(low), Some(high), None))
}

/// Hash of the scene that a later run of it must have to take the result.
///
/// # Errors
/// A scene that is refused.
pub fn identity(base: &Base) -> Result<String, SweepError> {
    Ok(simulation::identity::identity(&base.scene(&[])?, &base.folder))
}

/// Wishes for the cases: the scene as it is, then each end of each range.
#[must_use]
pub fn wishes(parameters: &[Parameter]) -> PlanWishes {
    let varied = |parameter: &Parameter| {
        let values = std::iter::once(parameter.value).chain(parameter.ends());
        Varied {
            name: parameter.key.clone(),
            values: Values::Listed(values.map(Value::Number).collect()),
            place: format!("ranges: {}", parameter.key),
        }
    };
    PlanWishes {
        varied: parameters.iter().map(varied).collect(),
        derived: Vec::new(),
        constraints: Vec::new(),
        design: Design::OneAtATime,
    }
}

/// Change of a figure with one parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Effect {
    /// Key of the parameter.
    pub key: String,
    /// Its origin; absent where it is not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mark: Option<&'static str>,
    /// Value, least and most of the parameter, in the unit of its key.
    pub value: f64,
    /// See above.
    pub low: f64,
    /// See above.
    pub high: f64,
    /// Change of the figure with the parameter at `low`; absent where the case has no figure.
    pub at_low: Option<f64>,
    /// Change with the parameter at `high`.
    pub at_high: Option<f64>,
    /// Slopes from the value down to `low` and up to `high`, in units of the figure by that of the key.
    pub slopes: [Option<f64>; 2],
}

impl Effect {
    fn changes(&self) -> impl Iterator<Item = f64> {
        [self.at_low, self.at_high].into_iter().flatten()
    }

    /// Largest change without its sign.
    #[must_use]
    pub fn spread(&self) -> f64 {
        self.changes().fold(0.0, |most, change| most.max(change.abs()))
    }
}

/// Dependence of one figure of one pantograph.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FigureEffects {
    /// Pantograph, from 1.
    pub pantograph: usize,
    /// Name as in the table of a sweep.
    pub figure: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Figure of the scene as it is.
    pub value: Option<f64>,
    /// Change downward and upward that all parameters make together.
    pub below: f64,
    /// See above.
    pub above: f64,
    /// Effects, the largest first.
    pub effects: Vec<Effect>,
}

/// Result of a sensitivity analysis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sensitivity {
    /// Name of the scene.
    pub scene: String,
    /// Mode of the runs.
    pub mode: String,
    /// Runs.
    pub runs: usize,
    /// Runs without figures, with their reasons.
    pub failed: Vec<String>,
    /// Hash of the scene without mesh, model, solver and coupling, which change the error and not what is asked.
    pub identity: String,
    /// Figures.
    pub figures: Vec<FigureEffects>,
}

/// The part of a file that later runs of the scene take.
#[derive(Deserialize)]
struct Kept {
    identity: String,
    figures: Vec<KeptFigure>,
}

#[derive(Deserialize)]
struct KeptFigure {
    pantograph: usize,
    figure: String,
    unit: String,
    below: f64,
    above: f64,
    effects: Vec<KeptEffect>,
}

#[derive(Deserialize)]
struct KeptEffect {
    key: String,
}

/// Keys that a run names as those with the largest effects.
const NAMED: usize = 3;

/// Uncertainty of the figures of a scene by the sensitivity analysis in `folder`; nothing where there is none of this
/// scene.
#[must_use]
pub fn uncertainty(folder: &Path, identity: &str) -> Option<Vec<Uncertainty>> {
    let text = std::fs::read_to_string(folder.join(JSON)).ok()?;
    let kept: Kept = serde_json::from_str(&text).ok()?;
    let figure = |figure: KeptFigure| Uncertainty {
        pantograph: figure.pantograph,
        figure: figure.figure,
        unit: figure.unit,
        below: figure.below,
        above: figure.above,
        largest: figure
            .effects
            .into_iter()
            .take(NAMED)
            .map(|effect| effect.key)
            .collect(),
    };
    (kept.identity == identity).then(|| kept.figures.into_iter().map(figure).collect())
}

/// Name, unit, and the figure of a pantograph (from 0) in a record.
pub type Figure = (&'static str, &'static str, fn(&Record, usize) -> Option<f64>);

/// Figures of an analysis.
pub const FIGURES: [Figure; 6] = [
    ("std", "N", |record, index| record.pantographs[index].std),
    ("mean", "N", |record, index| record.pantographs[index].mean),
    ("max", "N", |record, index| record.pantographs[index].max),
    ("min", "N", |record, index| record.pantographs[index].min),
    ("loss", "%", |record, index| record.pantographs[index].loss),
    ("uplift", "mm", |record, _| record.uplift.map(|uplift| 1e3 * uplift)),
];

/// One figure of one pantograph in all cases.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FigureValues {
    /// Pantograph, from 1.
    pub pantograph: usize,
    /// Name as in the table of a sweep.
    pub figure: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Values in the order of the cases; absent for a case without the figure.
    pub values: Vec<Option<f64>>,
}

/// Figures of all cases by pantograph; the uplift belongs to the line and stands once.
#[must_use]
pub fn figures(records: &[Record]) -> Vec<FigureValues> {
    let pantographs = records.first().map_or(0, |record| record.pantographs.len());
    let all = (0..pantographs).flat_map(|index| {
        FIGURES.iter().map(move |&(figure, unit, of)| FigureValues {
            pantograph: index + 1,
            figure,
            unit,
            values: records.iter().map(|record| of(record, index)).collect(),
        })
    });
    all.filter(|values| values.pantograph == 1 || values.figure != "uplift")
        .collect()
}

impl Sensitivity {
    /// Effects from the records of the cases of [`wishes`], in their order.
    #[must_use]
    pub fn of((scene, mode, identity): (&str, &str, String), parameters: &[Parameter], records: &[Record]) -> Self {
        let failed = records.iter().filter(|record| !record.reason.is_empty());
        let failed = failed.map(|record| format!("case {}: {}", record.case, record.reason));
        Self {
            scene: scene.to_owned(),
            mode: mode.to_owned(),
            runs: records.len(),
            failed: failed.collect(),
            identity,
            figures: figures(records)
                .iter()
                .map(|figure| effects_on(figure, parameters))
                .collect(),
        }
    }

    /// Writes `sensitivity.csv`, `sensitivity.json` and `sensitivity.html`.
    ///
    /// # Errors
    /// Reports of the operating system.
    pub fn write(&self, output: &OutputDirectory) -> Result<(), ResultsError> {
        output.write_json(JSON, self)?;
        output.replace(CSV, |out, path| {
            let csv = self.csv().map_err(|source| ResultsError::Csv {
                path: path.to_owned(),
                source,
            })?;
            out.write_all(&csv).map_err(results::io(path, "write"))
        })?;
        output.write_page(PAGE, &self.page())
    }

    /// The table as CSV, a row for each figure and parameter.
    ///
    /// # Errors
    /// None but of memory.
    pub fn csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record([
            "pantograph",
            "figure",
            "unit",
            "figure_value",
            "key",
            "mark",
            "value",
            "low",
            "high",
            "at_low",
            "at_high",
            "slope_low",
            "slope_high",
        ])?;
        let text = |value: Option<f64>| value.map_or_else(String::new, shown);
        for figure in &self.figures {
            for effect in &figure.effects {
                writer.write_record([
                    figure.pantograph.to_string(),
                    figure.figure.to_owned(),
                    figure.unit.to_owned(),
                    text(figure.value),
                    effect.key.clone(),
                    effect.mark.unwrap_or_default().to_owned(),
                    shown(effect.value),
                    shown(effect.low),
                    shown(effect.high),
                    text(effect.at_low),
                    text(effect.at_high),
                    text(effect.slopes[0]),
                    text(effect.slopes[1]),
                ])?;
            }
        }
        writer
            .into_inner()
            .map_err(|error| csv::Error::from(std::io::Error::other(error.to_string())))
    }

    /// The result in words, for the terminal.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!("{}, {}: {} runs\n", self.scene, self.mode, self.runs);
        for figure in &self.figures {
            let Some(value) = figure.value else { continue };
            text.push_str(&format!(
                "\npantograph {}, {} = {value:.2} {unit}, −{:.2}/+{:.2} {unit} by all parameters\n",
                figure.pantograph,
                figure.figure,
                figure.below,
                figure.above,
                unit = figure.unit
            ));
            for effect in &figure.effects {
                let change = |change: Option<f64>| {
                    change.map_or_else(|| "–".to_owned(), |change| format!("{change:+.2}").replace('-', "−"))
                };
                text.push_str(&format!(
                    "  {:<50} {:>10} {:>10}   {} to {}\n",
                    effect.key,
                    change(effect.at_low),
                    change(effect.at_high),
                    shown(effect.low),
                    shown(effect.high)
                ));
            }
        }
        for failed in &self.failed {
            text.push_str(&format!("  {failed}\n"));
        }
        text
    }
}

/// Effects on a figure.
fn effects_on(of: &FigureValues, parameters: &[Parameter]) -> FigureEffects {
    let figure = |case: usize| of.values.get(case).copied().flatten();
    let value = figure(0);
    let mut case = 0;
    let mut effects: Vec<Effect> = Vec::new();
    for parameter in parameters {
        let mut change = |end: f64| {
            (end != parameter.value).then(|| {
                case += 1;
                figure(case).zip(value).map(|(figure, value)| figure - value)
            })?
        };
        let (at_low, at_high) = (change(parameter.low), change(parameter.high));
        let slope = |change: Option<f64>, end: f64| change.map(|change| change / (end - parameter.value));
        effects.push(Effect {
            key: parameter.key.clone(),
            mark: parameter.mark.map(Mark::name),
            value: parameter.value,
            low: parameter.low,
            high: parameter.high,
            at_low,
            at_high,
            slopes: [slope(at_low, parameter.low), slope(at_high, parameter.high)],
        });
    }
    effects.sort_by(|a, b| b.spread().total_cmp(&a.spread()));
    let together = |sign: f64| {
        let most = |effect: &Effect| effect.changes().fold(0.0_f64, |most, change| most.max(sign * change));
        effects.iter().map(|effect| most(effect).powi(2)).sum::<f64>().sqrt()
    };
    FigureEffects {
        pantograph: of.pantograph,
        figure: of.figure,
        unit: of.unit,
        value,
        below: together(-1.0),
        above: together(1.0),
        effects,
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use experiments::engine::table::Status;

    use super::*;
    use crate::plan::Plan;
    use crate::record::Figures;

    const EN_300: &str = include_str!("../../../../scenes/en50318-300.toml");

    fn base() -> Base {
        // Without the ranges of the shipped scene.
        let text: String = EN_300
            .lines()
            .filter(|line| !line.contains("low ="))
            .map(|line| format!("{line}\n"))
            .collect();
        Base::new("a", "a.toml", Path::new(""), text, Vec::new())
    }

    fn ranges(typed: &[&str]) -> Result<Vec<Parameter>, String> {
        let typed: Vec<String> = typed.iter().map(|text| (*text).to_owned()).collect();
        Parameter::of(&base(), &typed).map_err(|error| error.to_string())
    }

    #[test]
    fn the_scene_comes_first_and_then_each_end_alone() {
        let parameters = ranges(&[
            "contact.stiffness=4e4:6e4",
            "pantograph[1].masses[1]=7.2:8",
            "catenary.damping.alpha=0.01:0.02",
        ])
        .unwrap();
        let plan = Plan::new(wishes(&parameters), &Numbers::of(&base().read(&[]).unwrap())).unwrap();
        let cases: Vec<Vec<f64>> = plan
            .cases()
            .map(|case| case.values.iter().filter_map(Value::number).collect())
            .collect();
        let expected = [
            [5e4, 7.2, 0.0125],
            [4e4, 7.2, 0.0125],
            [6e4, 7.2, 0.0125],
            [5e4, 8.0, 0.0125],
            [5e4, 7.2, 0.01],
            [5e4, 7.2, 0.02],
        ];
        assert_eq!(cases, expected);
        assert_eq!(plan.points(), 6);
    }

    #[test]
    fn ends_of_a_distribution_without_bounds_are_its_quantiles() {
        let parameters = ranges(&[
            "contact.stiffness=normal(5e4, 5e3)",
            "pantograph[1].masses[1]=log_uniform(7, 8)",
        ]);
        let parameters = parameters.unwrap();
        // Standard normal quantile at 0.95: 1.6448536269514722 (tables).
        let off = 1.644_853_626_951_472_2 * 5e3;
        let [low, high] = [parameters[0].low, parameters[0].high];
        assert!(
            (low - (5e4 - off)).abs() < 1e-4 && (high - (5e4 + off)).abs() < 1e-4,
            "{low} {high}"
        );
        assert_eq!((parameters[1].low, parameters[1].high), (7.0, 8.0));
        let text = EN_300.replace(
            "[ranges]",
            "[ranges]\n\"contact.damping\" = { lognormal = [1.0, -0.2] }",
        );
        let base = Base::new("a", "a.toml", Path::new(""), text, Vec::new());
        let said = Parameter::of(&base, &[]).unwrap_err().to_string();
        assert!(said.contains("contact.damping: lognormal must have a median"), "{said}");
    }

    #[test]
    fn effects_are_differences_from_the_scene_and_add_by_squares_on_each_side() {
        let parameters = ranges(&["contact.stiffness=4e4:6e4", "pantograph[1].masses[1]=7.2:8"]).unwrap();
        let record = |case: usize, std: Option<f64>| {
            let mut record = Record::without_figures(case as u64, Status::Stable, "", 1);
            record.pantographs[0] = Figures {
                std,
                ..Figures::default()
            };
            record
        };
        let records: Vec<Record> = [30.0, 29.0, 32.0, 27.0]
            .iter()
            .enumerate()
            .map(|(n, std)| record(n + 1, Some(*std)))
            .collect();
        let found = Sensitivity::of(("a", "monolithic", "x".to_owned()), &parameters, &records);
        let std = &found.figures[0];
        let keys: Vec<&str> = std.effects.iter().map(|effect| effect.key.as_str()).collect();
        assert_eq!(keys, ["pantograph[1].masses[1]", "contact.stiffness"]);
        assert_eq!((std.effects[0].at_low, std.effects[0].at_high), (None, Some(-3.0)));
        assert_eq!(std.effects[1].slopes, [Some(1e-4), Some(2e-4)]);
        // Downward −1 and −3, upward 2 alone.
        assert!((std.below - 10.0_f64.sqrt()).abs() < 1e-12 && std.above == 2.0);
        let text = String::from_utf8(found.csv().unwrap()).unwrap();
        assert!(
            text.contains("1,std,N,30,contact.stiffness,,50000,40000,60000,-1,2,0.0001,0.0002"),
            "{text}"
        );
        assert!(
            found.text().contains("std = 30.00 N, −3.16/+2.00 N"),
            "{}",
            found.text()
        );
        assert!(found.page().contains("contact.stiffness"));
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(JSON), serde_json::to_string(&found).unwrap()).unwrap();
        let kept = uncertainty(folder.path(), "x").unwrap();
        assert_eq!(
            (kept[0].above, kept[0].largest[0].as_str()),
            (2.0, "pantograph[1].masses[1]")
        );
        assert_eq!(uncertainty(folder.path(), "y"), None);
    }

    #[test]
    fn ranges_that_are_none_are_refused_with_the_key() {
        for (typed, part) in [
            ("contact.stiffness", "KEY=low:high"),
            ("contact.stiffness=a:b", "KEY=low:high"),
            ("contact.stifness=1:2", "did you mean contact.stiffness?"),
            ("contact.stiffness=6e4:7e4", "within its range"),
            ("contact.law=1:2", "is no number"),
            ("contact.stiffness=normal(5e4)", "two numbers"),
            ("contact.stiffness=normal(5e4,-1)", "standard deviation above 0"),
            ("contact.stiffness=normal(9e4,1e4)", "within its range, 73551"),
            ("contact.stiffness=choice(4e4,6e4)", "KEY=normal(mean, std)"),
        ] {
            let said = ranges(&[typed]).unwrap_err();
            assert!(said.contains(part), "{typed}: {said}");
        }
        assert!(ranges(&[]).unwrap_err().contains("--range"));
        let some = ranges(&["contact.stiffness=4e4:6e4", "catenary.damping.alpha=0.01:0.02"]).unwrap();
        let keys = |keys: &[&str]| keys.iter().map(|key| (*key).to_owned()).collect::<Vec<_>>();
        let chosen = Parameter::chosen(some.clone(), &keys(&["catenary.damping.alpha"])).unwrap();
        assert_eq!(chosen, some[1..]);
        let said = Parameter::chosen(some, &keys(&["contact.damping"]))
            .unwrap_err()
            .to_string();
        assert!(
            said.contains("contact.damping: has no range; must be one of contact.stiffness, "),
            "{said}"
        );
    }
}
