//! Values of parameter sets, mapped, converted and handed to the components they are for [SSP 1.0, 5].

use std::collections::BTreeMap;

use fmi2::import::Fmu;
use fmi2::model_description::{BaseType, TypeShape, Unit, Variable};
use scene::ParameterValue;

use super::document::{Binding, Component, Description, Linear, MappingEntry, Parameter, ParameterSet, Source, Value};
use super::problem::{UnitProblem, ValueProblem};
use super::read::{self, File};
use super::unpacked::Unpacked;
use super::{STRUCTURE_FILE, SspError};
use crate::units::{named, same_dimension};

/// Values of one component, by the names of its FMU's variables.
pub(super) type Values = BTreeMap<String, ParameterValue>;

/// Values of all components: those bound to the components themselves, then, stronger, those bound to the system. What
/// fits nothing is told to `notes`.
pub(super) fn values(
    description: &Description,
    fmus: &[Fmu],
    unpacked: Unpacked<'_>,
    notes: &mut Vec<String>,
) -> Result<Vec<Values>, SspError> {
    let (system, units) = (&description.system, &description.units[..]);
    let mut all: Vec<Values> = vec![Values::new(); fmus.len()];
    for (index, component) in system.components.iter().enumerate() {
        for binding in &component.bindings {
            let bound = Bound::load(binding, Some((component, &fmus[index])), units, unpacked)?;
            for (name, parameter, entry) in bound.named() {
                let target = (component, &fmus[index], name.as_str());
                bound.apply(target, parameter, entry, unpacked, &mut all[index], notes)?;
            }
        }
    }
    for binding in &system.bindings {
        let bound = Bound::load(binding, None, units, unpacked)?;
        for (name, parameter, entry) in bound.named() {
            let owner = |component: &Component| name.strip_prefix(&component.name)?.strip_prefix('.').map(str::len);
            // The shortest rest belongs to the longest name.
            let owners = system.components.iter().enumerate();
            let found = owners
                .filter_map(|(index, component)| Some((owner(component)?, index)))
                .min();
            let Some((rest, index)) = found else {
                notes.push(format!("parameter \"{name}\" belongs to no component: not used"));
                continue;
            };
            let target = (&system.components[index], &fmus[index], &name[name.len() - rest..]);
            bound.apply(target, parameter, entry, unpacked, &mut all[index], notes)?;
        }
    }
    Ok(all)
}

/// A binding with its files read.
struct Bound<'a> {
    prefix: String,
    set: ParameterSet,
    mapping: Option<Vec<MappingEntry>>,
    /// Units of the system structure, for a set that does not define its own.
    units: &'a [Unit],
    /// File of the values, for messages.
    file: String,
}

impl<'a> Bound<'a> {
    fn load(
        binding: &Binding,
        component: Option<(&Component, &Fmu)>,
        units: &'a [Unit],
        unpacked: Unpacked<'_>,
    ) -> Result<Self, SspError> {
        let bytes = |uri: &str, in_component: bool| match (in_component, component) {
            (false, _) => unpacked.content(uri, binding.line),
            (true, Some((_, fmu))) => {
                let folder = fmu.folder();
                Unpacked { folder, ..unpacked }.content(uri, binding.line)
            }
            (true, None) => {
                let problem = "sourceBase = \"component\" has no meaning in a binding of the system";
                Err(unpacked.structure().refuse(binding.line, problem))
            }
        };
        let named = |uri| File {
            archive: unpacked.archive,
            name: uri,
        };
        let (set, file) = match &binding.values {
            Source::Inline(set) => (set.clone(), STRUCTURE_FILE.to_owned()),
            Source::File(uri) => (read::parameter_set(&bytes(uri, false)?, named(uri))?, uri.clone()),
            Source::InComponent(uri) => (read::parameter_set(&bytes(uri, true)?, named(uri))?, uri.clone()),
        };
        let mapping = match &binding.mapping {
            None => None,
            Some(Source::Inline(entries)) => Some(entries.clone()),
            Some(Source::File(uri)) => Some(read::mapping(&bytes(uri, false)?, named(uri))?),
            Some(Source::InComponent(uri)) => Some(read::mapping(&bytes(uri, true)?, named(uri))?),
        };
        Ok(Self {
            prefix: binding.prefix.clone(),
            set,
            mapping,
            units,
            file,
        })
    }

    /// Parameters by the names they go by after prefix and mapping; one that no entry mentions keeps its name.
    fn named(&self) -> Vec<(String, &Parameter, Option<&MappingEntry>)> {
        let mut named = Vec::new();
        for parameter in &self.set.parameters {
            let name = format!("{}{}", self.prefix, parameter.name);
            let entries = self.mapping.iter().flatten().filter(|entry| entry.source == name);
            let before = named.len();
            named.extend(entries.map(|entry| (entry.target.clone(), parameter, Some(entry))));
            if named.len() == before {
                named.push((name, parameter, None));
            }
        }
        named
    }

    fn apply(
        &self,
        (component, fmu, name): (&Component, &Fmu, &str),
        parameter: &Parameter,
        entry: Option<&MappingEntry>,
        unpacked: Unpacked<'_>,
        values: &mut Values,
        notes: &mut Vec<String>,
    ) -> Result<(), SspError> {
        let Some(variable) = fmu.description().variable(name) else {
            let component = &component.name;
            notes.push(format!(
                "component \"{component}\" has no variable \"{name}\": its value is not used"
            ));
            return Ok(());
        };
        let value = self.value(fmu, variable, parameter, entry);
        let value = value.map_err(|problem| {
            let file = File {
                archive: unpacked.archive,
                name: &self.file,
            };
            let problem = format!("parameter \"{name}\" of component \"{}\": {problem}", component.name);
            file.refuse(parameter.line, problem)
        })?;
        values.insert(name.to_owned(), value);
        Ok(())
    }

    /// The value for a variable, in the variable's unit.
    fn value(
        &self,
        fmu: &Fmu,
        variable: &Variable,
        parameter: &Parameter,
        entry: Option<&MappingEntry>,
    ) -> Result<ParameterValue, ValueProblem> {
        let map = entry.map_or(Linear::IDENTITY, |entry| entry.map);
        let described = fmu.description();
        let items = variable.declared_type.as_ref().and_then(|name| {
            let definition = described.types.iter().find(|definition| definition.name == *name)?;
            match &definition.shape {
                TypeShape::Enumeration(items) => Some(items),
                _ => None,
            }
        });
        match (&parameter.value, variable.base_type()) {
            (Value::Real { value, unit }, BaseType::Real) => {
                let suppressed = entry.is_some_and(|entry| entry.suppress_unit_conversion);
                let conversion = match unit {
                    Some(unit) if !suppressed => {
                        let mut known = self.set.units.iter().chain(self.units);
                        let defined = known.find(|known| known.name == *unit);
                        let theirs = described.unit_of(variable).cloned();
                        let name = variable
                            .unit()
                            .map(str::to_owned)
                            .or(theirs.as_ref().map(|unit| unit.name.clone()));
                        match name.filter(|name| !name.is_empty()) {
                            Some(name) => convert((unit, defined), (&name, theirs.as_ref()))?,
                            None => as_it_is(unit, defined)?,
                        }
                    }
                    _ => Linear::IDENTITY,
                };
                Ok(ParameterValue::Number(conversion.then(map).apply(*value)))
            }
            (Value::Integer(value), BaseType::Real | BaseType::Integer) => {
                Ok(ParameterValue::Number(map.apply(f64::from(*value))))
            }
            (Value::Boolean(flag), BaseType::Boolean) => Ok(ParameterValue::Boolean(*flag)),
            (Value::String(text), BaseType::String) => Ok(ParameterValue::String(text.clone())),
            (Value::Enumeration(name), BaseType::Integer) => {
                let item = items.into_iter().flatten().find(|item| item.name == *name);
                let item = item.ok_or_else(|| ValueProblem::NoItem { name: name.clone() })?;
                Ok(ParameterValue::Number(f64::from(item.value)))
            }
            (_, expected) => Err(ValueProblem::OtherType { expected }),
        }
    }
}

/// The map from one unit to another. A unit means what its definition says, else what its name says; equal names need
/// no meaning.
pub(super) fn convert(
    (from, from_unit): (&str, Option<&Unit>),
    (to, to_unit): (&str, Option<&Unit>),
) -> Result<Linear, UnitProblem> {
    if to == from {
        return Ok(Linear::IDENTITY);
    }
    let meaning = |name: &str, unit: Option<&Unit>, other: &str| {
        let defined = unit.and_then(|unit| unit.base).or_else(|| named(name));
        let defined = defined.filter(|unit| unit.factor != 0.0);
        defined.ok_or_else(|| UnitProblem::Unknown {
            unit: name.to_owned(),
            other: other.to_owned(),
        })
    };
    let (source, target) = (meaning(from, from_unit, to)?, meaning(to, to_unit, from)?);
    if !same_dimension(&source, &target) {
        let (from, to) = (from.to_owned(), to.to_owned());
        return Err(UnitProblem::Differ { from, to });
    }
    Ok(Linear {
        factor: source.factor / target.factor,
        offset: (source.offset - target.offset) / target.factor,
    })
}

/// Refuses a unit for a variable without one, where the unit is not one of SI.
fn as_it_is(from: &str, from_unit: Option<&Unit>) -> Result<Linear, UnitProblem> {
    let meaning = from_unit.and_then(|unit| unit.base).or_else(|| named(from));
    match meaning {
        Some(unit) if unit.factor == 1.0 && unit.offset == 0.0 => Ok(Linear::IDENTITY),
        _ => Err(UnitProblem::NoTarget { unit: from.to_owned() }),
    }
}
