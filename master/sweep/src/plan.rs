//! Plan: keys with their values, derived values, constraints, and the cases that follow.

use scene::What;

use crate::base::{Base, Numbers};
use crate::design::{Design, MOST_DIMENSIONS, MOST_SAMPLES, Method, UnitPoints};
use crate::error::SweepError;
use crate::expression::{Expression, is_condition};
use crate::table::FIXED_COLUMNS;
use crate::values::{Value, Values, shown};

/// A key that is varied, and where the wish was typed.
#[derive(Clone, Debug)]
pub struct Varied {
    /// Key of the scene, or a plain name that expressions use.
    pub name: String,
    /// Its values.
    pub values: Values,
    /// Place for messages.
    pub place: String,
}

/// An expression as typed, and where.
#[derive(Clone, Debug)]
pub struct Typed {
    /// Text.
    pub text: String,
    /// Place for messages.
    pub place: String,
}

/// Wishes for a plan, not checked yet.
#[derive(Clone, Debug)]
pub struct PlanWishes {
    /// Keys that are varied, in the order of wishes.
    pub varied: Vec<Varied>,
    /// Keys or plain names with their expressions.
    pub derived: Vec<(String, Typed)>,
    /// Constraints.
    pub constraints: Vec<Typed>,
    /// Combinations or samples.
    pub design: Design,
}

impl PlanWishes {
    /// One case for each row of a table: columns are keys with their values, in the units of the keys.
    #[must_use]
    pub fn rows(columns: Vec<(String, Vec<f64>)>) -> Self {
        let varied = |(name, values): (String, Vec<f64>)| Varied {
            place: format!("rows: {name}"),
            values: Values::Listed(values.into_iter().map(Value::Number).collect()),
            name,
        };
        Self {
            varied: columns.into_iter().map(varied).collect(),
            derived: Vec::new(),
            constraints: Vec::new(),
            design: Design::Rows,
        }
    }
}

/// Source of a number in an expression.
#[derive(Clone, Copy, Debug)]
enum Input {
    Varied(usize),
    Derived(usize),
    Constant(f64),
}

/// An expression with the sources of its names.
#[derive(Clone, Debug)]
struct Bound {
    expression: Expression,
    inputs: Vec<Input>,
}

impl Bound {
    /// The value for varied values and those derived before.
    fn value(&self, varied: &[Value], derived: &[f64]) -> f64 {
        let inputs = self.inputs.iter().map(|input| match *input {
            Input::Varied(index) => varied[index].number().unwrap_or(f64::NAN),
            Input::Derived(index) => derived[index],
            Input::Constant(value) => value,
        });
        // An expression that was evaluated once can be evaluated again.
        self.expression.value(&inputs.collect::<Vec<_>>()).unwrap_or(f64::NAN)
    }
}

/// A checked plan.
#[derive(Clone, Debug)]
pub struct Plan {
    varied: Vec<Varied>,
    /// `true` for each varied key whose values are all numbers: asked for every row of a table that may be long.
    are_numbers: Vec<bool>,
    /// Names and expressions, in an order in which each needs only those before it.
    derived: Vec<(String, Bound)>,
    /// Constraints with the places where they were typed.
    constraints: Vec<(String, Bound)>,
    design: Design,
    points: u64,
}

/// One case of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Number from 1, in the order of the plan; combinations that constraints leave out have none.
    pub number: u64,
    /// Values of the varied keys.
    pub values: Vec<Value>,
    /// Derived values.
    pub derived: Vec<f64>,
}

/// `true` for a key of the scene, `false` for a plain name.
fn is_key(name: &str) -> bool {
    name.contains(['.', '['])
}

/// Reason why a key at the top of a scene is not varied; nothing for a name that is no such key.
fn of_top(name: &str) -> Option<String> {
    let keys = scene::described_keys();
    let top = keys.iter().find(|key| key.path() == name)?;
    if top.range == "text" {
        return Some("is text that changes no figure; must be a key that does, such as run.speed_kmh".to_owned());
    }
    let (entry, is) = match &*top.range {
        "table" => (name.to_owned(), "a table"),
        _ => (format!("{name}[1]"), "a list of tables"),
    };
    let begin = format!("{name}.");
    let inside = |key: &&scene::KeyText| key.path().starts_with(&begin) && !key.unit.is_empty();
    let such_as = keys
        .iter()
        .find(inside)
        .or_else(|| keys.iter().find(|key| key.path().starts_with(&begin)));
    let such_as = such_as.map(|key| format!(", such as {entry}.{}", &key.path()[begin.len()..]));
    Some(format!(
        "is {is} of the scene; must be a key in it{}",
        such_as.unwrap_or_default()
    ))
}

impl Plan {
    /// Checks wishes; numbers of the scene stand in for names that are not varied.
    ///
    /// # Errors
    /// [`SweepError::Wish`].
    pub fn new(wishes: PlanWishes, numbers: &Numbers) -> Result<Self, SweepError> {
        let PlanWishes {
            varied,
            derived,
            constraints,
            design,
        } = wishes;
        check_names(&varied, &derived)?;
        let points = points(&varied, design)?;
        let mut plan = Self {
            are_numbers: varied.iter().map(|varied| varied.values.are_numbers()).collect(),
            varied,
            derived: Vec::new(),
            constraints: Vec::new(),
            design,
            points,
        };
        let mut open = derived;
        while !open.is_empty() {
            let names: Vec<String> = open.iter().map(|(name, _)| name.clone()).collect();
            let before = open.len();
            let mut later = Vec::new();
            for (name, typed) in open {
                let expression = parsed(&typed)?;
                if expression
                    .names
                    .iter()
                    .any(|needed| names.contains(needed) && !plan.has_derived(needed))
                {
                    later.push((name, typed));
                    continue;
                }
                let bound = plan.bound(expression, &typed, numbers)?;
                plan.derived.push((name, bound));
            }
            if later.len() == before {
                let (_, typed) = &later[0];
                let what = format!(
                    "\"{}\": must not depend on itself by way of other derived values",
                    typed.text
                );
                return Err(SweepError::wish(&typed.place, what));
            }
            open = later;
        }
        for typed in constraints {
            let bound = plan.bound(parsed(&typed)?, &typed, numbers)?;
            if !is_condition(&typed.text) {
                let what = format!(
                    "\"{}\": must be a comparison, such as run.speed_kmh < 300, or several joined by &&, || and not()",
                    typed.text
                );
                return Err(SweepError::wish(&typed.place, what));
            }
            plan.constraints.push((typed.place, bound));
        }
        plan.check_plain_names(numbers)?;
        Ok(plan)
    }

    fn has_derived(&self, name: &str) -> bool {
        self.derived.iter().any(|(known, _)| known == name)
    }

    fn bound(&self, expression: Expression, typed: &Typed, numbers: &Numbers) -> Result<Bound, SweepError> {
        let input = |name: &String| {
            if let Some(index) = self.varied.iter().position(|varied| varied.name == *name) {
                if !self.are_numbers[index] {
                    let what = format!(
                        "\"{}\": {name} has values that are no numbers, which no expression takes",
                        typed.text
                    );
                    return Err(SweepError::wish(&typed.place, what));
                }
                return Ok(Input::Varied(index));
            }
            if let Some(index) = self.derived.iter().position(|(known, _)| known == name) {
                return Ok(Input::Derived(index));
            }
            let of_scene = numbers.get(name).map(Input::Constant);
            of_scene.ok_or_else(|| {
                let known = self.varied.iter().map(|varied| &*varied.name);
                let known = known.chain(self.derived.iter().map(|(name, _)| &**name));
                let what = format!(
                    "\"{}\": {name} is no varied or derived value and no number of the scene{}; varied and derived \
                     are {}",
                    typed.text,
                    numbers.meant(name),
                    known.collect::<Vec<_>>().join(", ")
                );
                SweepError::wish(&typed.place, what)
            })
        };
        let inputs = expression.names.iter().map(input).collect::<Result<_, _>>()?;
        Ok(Bound { expression, inputs })
    }

    /// Refuses plain names that nothing uses: a key that was not written out.
    fn check_plain_names(&self, numbers: &Numbers) -> Result<(), SweepError> {
        let bounds = self.derived.iter().chain(&self.constraints).map(|(_, bound)| bound);
        let used: Vec<&String> = bounds.flat_map(|bound| &bound.expression.names).collect();
        let unused = self
            .varied
            .iter()
            .find(|varied| !is_key(&varied.name) && !used.contains(&&varied.name));
        let Some(varied) = unused else { return Ok(()) };
        let name = &varied.name;
        let what = of_top(name).unwrap_or_else(|| {
            format!(
                "is no key of the scene, and no expression uses it{}",
                numbers.meant(name)
            )
        });
        Err(SweepError::wish(&varied.place, format!("{name}: {what}")))
    }

    /// Names of varied and derived values, and whether all values of each are numbers.
    pub fn columns(&self) -> impl Iterator<Item = (&str, bool)> {
        let varied = self
            .varied
            .iter()
            .zip(&self.are_numbers)
            .map(|(varied, are_numbers)| (&*varied.name, *are_numbers));
        varied.chain(self.derived.iter().map(|(name, _)| (&**name, true)))
    }

    /// Number of varied keys.
    #[must_use]
    pub fn varied_count(&self) -> usize {
        self.varied.len()
    }

    /// Number of combinations or samples before constraints.
    #[must_use]
    pub fn points(&self) -> u64 {
        self.points
    }

    /// Text that is the same for the same cases.
    #[must_use]
    pub fn canonical(&self) -> String {
        let varied = self
            .varied
            .iter()
            .map(|varied| format!("{} = {:?}\n", varied.name, varied.values));
        let derived = self
            .derived
            .iter()
            .map(|(name, bound)| format!("{name} = {}\n", bound.expression.text));
        let constraints = self
            .constraints
            .iter()
            .map(|(_, bound)| format!("{}\n", bound.expression.text));
        let all: String = varied.chain(derived).chain(constraints).collect();
        format!("{all}{:?}\n", self.design)
    }

    /// Keys and values of a case as they stand behind `--set`.
    #[must_use]
    pub fn overrides(&self, case: &Case) -> Vec<String> {
        let varied = self
            .varied
            .iter()
            .zip(&case.values)
            .map(|(varied, value)| (&varied.name, value.typed()));
        let derived = self
            .derived
            .iter()
            .zip(&case.derived)
            .map(|((name, _), value)| (name, shown(*value)));
        let keys = varied.chain(derived).filter(|(name, _)| is_key(name));
        keys.map(|(name, value)| format!("{name}={value}")).collect()
    }

    /// The first derived value of a case that is no finite number, in words.
    #[must_use]
    pub fn undefined(&self, case: &Case) -> Option<String> {
        let mut derived = self.derived.iter().zip(&case.derived);
        let ((name, bound), value) = derived.find(|(_, value)| !value.is_finite())?;
        Some(format!(
            "{name} = {} is {value}: must be a finite number",
            bound.expression.text
        ))
    }

    /// Reason of a refused case with the expressions of derived values in place of options that nobody typed.
    #[must_use]
    pub fn with_expressions(&self, case: &Case, reason: &str) -> String {
        let derived = self.derived.iter().zip(&case.derived);
        derived.fold(reason.to_owned(), |reason, ((name, bound), value)| {
            let option = format!("--set {name}={}: ", shown(*value));
            reason.replace(&option, &format!("--derive {name}={}: ", bound.expression.text))
        })
    }

    /// Derived values for these varied ones.
    fn derived(&self, values: &[Value]) -> Vec<f64> {
        let mut derived = Vec::with_capacity(self.derived.len());
        for (_, bound) in &self.derived {
            derived.push(bound.value(values, &derived));
        }
        derived
    }

    /// The case with these varied values; nothing where a constraint leaves it out.
    fn case(&self, number: u64, values: Vec<Value>) -> Option<Case> {
        let derived = self.derived(&values);
        let holds = |(_, bound): &(String, Bound)| {
            let value = bound.value(&values, &derived);
            value != 0.0 && !value.is_nan()
        };
        self.constraints.iter().all(holds).then_some(Case {
            number,
            values,
            derived,
        })
    }

    /// All cases in order.
    #[must_use]
    pub fn cases(&self) -> Cases<'_> {
        let units = match self.design {
            Design::Factorial | Design::OneAtATime | Design::Rows => None,
            Design::Sample(sample) => Some(UnitPoints::new(sample, self.varied.len())),
        };
        Cases {
            plan: self,
            units,
            next: 0,
            number: 0,
        }
    }

    /// Refuses constraints that have no finite numbers to compare for a combination.
    fn check_constraints(&self) -> Result<(), SweepError> {
        if self.constraints.is_empty() {
            return Ok(());
        }
        let mut all = self.cases();
        while let Some(values) = all.values() {
            let derived = self.derived(&values);
            let mut constraints = self.constraints.iter();
            let undecided = constraints.find(|(_, bound)| bound.value(&values, &derived).is_nan());
            if let Some((place, bound)) = undecided {
                let varied = self.varied.iter().zip(&values);
                let at: Vec<String> = varied
                    .map(|(varied, value)| format!("{} = {}", varied.name, value.shown()))
                    .collect();
                let what = format!(
                    "\"{}\": a side of a comparison is no finite number where {}; must be finite for all values",
                    bound.expression.text,
                    at.join(", ")
                );
                return Err(SweepError::wish(place, what));
            }
        }
        Ok(())
    }

    /// Tries every listed value and the bounds of every distribution and of every column of a table, one key at a time
    /// beside the first case: each is refused as `--set` refuses it. Contradictions across keys and derived values out
    /// of range belong to the rows of their cases.
    ///
    /// # Errors
    /// The first refusal.
    pub fn check(&self, base: &Base) -> Result<(), SweepError> {
        self.check_constraints()?;
        let Some(first) = self.cases().next() else {
            let what = format!(
                "none of {} combinations satisfies the constraints: must leave at least one",
                self.points
            );
            return Err(SweepError::wish("constraints", what));
        };
        let values = first.values.clone();
        self.try_case(base, first)?;
        for (index, varied) in self.varied.iter().enumerate() {
            let tried = match self.design {
                // Rows may be very many; like the bounds of a distribution, the ends stand for what is between them.
                Design::Rows => varied.values.ends(),
                _ => varied.values.tried(),
            };
            for value in tried {
                let mut values = values.clone();
                values[index] = value;
                if let Some(case) = self.case(1, values) {
                    self.try_case(base, case)?;
                }
            }
        }
        Ok(())
    }

    fn try_case(&self, base: &Base, case: Case) -> Result<(), SweepError> {
        if self.undefined(&case).is_some() {
            return Ok(());
        }
        let Err(error) = base.read(&self.overrides(&case)) else {
            return Ok(());
        };
        let is_of_case = |problem: &scene::Problem| {
            let is_value = matches!(problem.what, What::Refused { .. } | What::WrongType { .. });
            is_value && self.derived.iter().any(|(name, _)| problem.key == *name)
        };
        if error.problems.iter().all(is_of_case) {
            return Ok(());
        }
        Err(error.into())
    }
}

/// Refuses names that stand twice or mean something else in the table.
fn check_names(varied: &[Varied], derived: &[(String, Typed)]) -> Result<(), SweepError> {
    if varied.is_empty() {
        let what = "no key is varied: must be at least one, such as --vary run.speed_kmh=200:320:10";
        return Err(SweepError::wish("sweep", what));
    }
    let names = varied.iter().map(|varied| (&varied.name, &varied.place));
    let names: Vec<_> = names
        .chain(derived.iter().map(|(name, typed)| (name, &typed.place)))
        .collect();
    for (index, (name, place)) in names.iter().enumerate() {
        if name.is_empty() {
            return Err(SweepError::wish(*place, "must name a key before ="));
        }
        if names[..index].iter().any(|(before, _)| before == name) {
            return Err(SweepError::wish(
                *place,
                format!("{name}: must be varied or derived once, not twice"),
            ));
        }
        if FIXED_COLUMNS.contains(&name.as_str()) {
            let what = of_top(name).unwrap_or_else(|| "is a column of the table; must be another name".to_owned());
            return Err(SweepError::wish(*place, format!("{name}: {what}")));
        }
    }
    Ok(())
}

/// Number of combinations or samples.
fn points(varied: &[Varied], design: Design) -> Result<u64, SweepError> {
    match design {
        Design::Factorial | Design::OneAtATime | Design::Rows => {
            let mut points = 1_u64;
            for (index, varied) in varied.iter().enumerate() {
                let Values::Listed(values) = &varied.values else {
                    let what = format!(
                        "{}: a distribution is sampled; must have --sample latin, sobol or random with --count, or be \
                         a:b:step or a list",
                        varied.name
                    );
                    return Err(SweepError::wish(&varied.place, what));
                };
                let values = values.len() as u64;
                points = match design {
                    Design::OneAtATime => points + values.saturating_sub(1),
                    Design::Rows if index == 0 || values == points => values,
                    Design::Rows => {
                        let what = format!(
                            "{}: has {values} values, must have {points} as the keys before it: one for each row",
                            varied.name
                        );
                        return Err(SweepError::wish(&varied.place, what));
                    }
                    _ => points.saturating_mul(values),
                };
            }
            if points > MOST_SAMPLES {
                let what =
                    format!("{points} combinations: must be at most {MOST_SAMPLES}; --sample draws some of them");
                return Err(SweepError::wish("sweep", what));
            }
            Ok(points)
        }
        Design::Sample(sample) => {
            if sample.count == 0 || sample.count > MOST_SAMPLES {
                let what = format!("{}: must be from 1 to {MOST_SAMPLES}", sample.count);
                return Err(SweepError::wish("count", what));
            }
            if sample.method == Method::Sobol && varied.len() > MOST_DIMENSIONS {
                let what = format!("sobol: must have at most {MOST_DIMENSIONS} varied keys; latin has no such limit");
                return Err(SweepError::wish("sample", what));
            }
            Ok(sample.count)
        }
    }
}

fn parsed(typed: &Typed) -> Result<Expression, SweepError> {
    let wrong = |what| SweepError::wish(&typed.place, format!("\"{}\": {what}", typed.text));
    Expression::parse(&typed.text).map_err(wrong)
}

/// Cases of a plan in order.
pub struct Cases<'a> {
    plan: &'a Plan,
    units: Option<UnitPoints>,
    /// Number of the next combination, from 0.
    next: u64,
    /// Number of the last case.
    number: u64,
}

impl Cases<'_> {
    /// Values of the next combination.
    fn values(&mut self) -> Option<Vec<Value>> {
        if self.next >= self.plan.points {
            return None;
        }
        let mut index = self.next;
        self.next += 1;
        let varied = &self.plan.varied;
        if let Some(units) = &mut self.units {
            let unit = units.next()?;
            return Some(
                varied
                    .iter()
                    .zip(unit)
                    .map(|(varied, u)| varied.values.quantile(u))
                    .collect(),
            );
        }
        match self.plan.design {
            Design::OneAtATime => return one_at_a_time(varied, index),
            Design::Rows => return varied.iter().map(|varied| varied.values.listed_at(index)).collect(),
            Design::Factorial | Design::Sample(_) => {}
        }
        let mut values = Vec::with_capacity(varied.len());
        for varied in varied.iter().rev() {
            let Values::Listed(listed) = &varied.values else {
                return None;
            };
            values.push(listed[(index % listed.len() as u64) as usize].clone());
            index /= listed.len() as u64;
        }
        values.reverse();
        Some(values)
    }
}

/// Values of combination `index` (from 0) where one key at a time has another than its first value.
fn one_at_a_time(varied: &[Varied], index: u64) -> Option<Vec<Value>> {
    let mut further = index.checked_sub(1);
    let mut values = Vec::with_capacity(varied.len());
    for varied in varied {
        let Values::Listed(listed) = &varied.values else {
            return None;
        };
        let own = listed.len() as u64 - 1;
        let chosen = match further {
            Some(place) if place < own => place as usize + 1,
            _ => 0,
        };
        // Once a key has taken its place, those behind have their first values.
        further = further.and_then(|place| place.checked_sub(own));
        values.push(listed[chosen].clone());
    }
    Some(values)
}

impl Iterator for Cases<'_> {
    type Item = Case;

    fn next(&mut self) -> Option<Case> {
        loop {
            let values = self.values()?;
            if let Some(case) = self.plan.case(self.number + 1, values) {
                self.number += 1;
                return Some(case);
            }
        }
    }
}
