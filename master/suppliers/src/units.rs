//! Units of an FMU's variables against ours.

use fmi2::model_description::{BaseUnit, ModelDescription, Unit, Variable};

/// Names of units that are not coherent, for files that name a unit without defining it: name, SI unit, SI units in one
/// of them.
const NAMED: [(&str, &str, f64); 18] = [
    ("mm", "m", 1e-3),
    ("cm", "m", 1e-2),
    ("dm", "m", 1e-1),
    ("km", "m", 1e3),
    ("mm/s", "m/s", 1e-3),
    ("cm/s", "m/s", 1e-2),
    ("km/h", "m/s", 1.0 / 3.6),
    ("kmh", "m/s", 1.0 / 3.6),
    ("kN", "N", 1e3),
    ("daN", "N", 10.0),
    ("MN", "N", 1e6),
    ("deg", "rad", std::f64::consts::PI / 180.0),
    ("°", "rad", std::f64::consts::PI / 180.0),
    ("mrad", "rad", 1e-3),
    ("deg/s", "rad/s", std::f64::consts::PI / 180.0),
    ("ms", "s", 1e-3),
    ("min", "s", 60.0),
    ("h", "s", 3600.0),
];

/// Unit declared by a variable.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Declared {
    /// Nothing.
    Nothing,
    /// A name without a meaning in SI.
    Name(String),
    /// A unit.
    Unit(String, BaseUnit),
}

impl Declared {
    /// Unit of a variable, own or inherited.
    pub fn of(description: &ModelDescription, variable: &Variable) -> Self {
        let Some(name) = description.real_attributes(variable).and_then(|real| real.unit) else {
            return Self::Nothing;
        };
        let defined = description.unit_of(variable).and_then(|unit| unit.base);
        match defined.or_else(|| named(&name)) {
            Some(base) => Self::Unit(name, base),
            None => Self::Name(name),
        }
    }

    /// ` [kN]`, or nothing.
    pub fn shown(&self) -> String {
        match self {
            Self::Nothing => String::new(),
            Self::Name(name) | Self::Unit(name, _) => format!(" [{name}]"),
        }
    }

    /// `(a, b)` of `SI value = a · value + b`, where it is a unit of the same dimension as `ours`; an angle counts as a
    /// number.
    pub fn to_si(&self, ours: &str) -> Option<(f64, f64)> {
        let (Self::Unit(_, theirs), Some(ours)) = (self, named(ours)) else {
            return None;
        };
        const ANGLE: usize = 7;
        (theirs.exponents[..ANGLE] == ours.exponents[..ANGLE]).then_some((theirs.factor, theirs.offset))
    }
}

/// The meaning of a unit's name.
fn named(name: &str) -> Option<BaseUnit> {
    if let Some((_, si, factor)) = NAMED.iter().find(|(known, _, _)| *known == name) {
        let base = Unit::from_name(si)?.base?;
        return Some(BaseUnit {
            factor: *factor,
            ..base
        });
    }
    Unit::from_name(name)?.base
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_convert_by_dimension_and_not_by_name() {
        let unit = |name: &str| Declared::Unit(name.to_owned(), named(name).unwrap());
        assert_eq!(unit("mm").to_si("m"), Some((1e-3, 0.0)));
        assert_eq!(unit("kN").to_si("N"), Some((1e3, 0.0)));
        assert_eq!(unit("kg.m/s2").to_si("N"), Some((1.0, 0.0)));
        let (factor, _) = unit("km/h").to_si("m/s").unwrap();
        assert!((90.0 * factor - 25.0).abs() < 1e-12);
        let (factor, _) = unit("deg").to_si("rad").unwrap();
        assert!((180.0 * factor - std::f64::consts::PI).abs() < 1e-15);
        assert_eq!(unit("1").to_si("rad"), Some((1.0, 0.0)), "an angle is a number");
        assert_eq!(unit("m").to_si("N"), None);
        assert_eq!(Declared::Name("furlong".to_owned()).to_si("m"), None);
    }
}
