//! Units of an FMU's variables against ours.

use fmi2::model_description::{BaseUnit, ModelDescription, Unit, Variable};

/// Symbols of units that are not coherent, for files that name a unit without defining it: symbol, SI unit, SI units in
/// one of them. Products, quotients and powers of symbols follow: `kN/m`, `N.s/mm`, `mm^2`.
const SCALED: [(&str, &str, f64); 31] = [
    ("µm", "m", 1e-6),
    ("mm", "m", 1e-3),
    ("cm", "m", 1e-2),
    ("dm", "m", 1e-1),
    ("km", "m", 1e3),
    ("g", "kg", 1e-3),
    ("t", "kg", 1e3),
    ("mN", "N", 1e-3),
    ("daN", "N", 10.0),
    ("kN", "N", 1e3),
    ("MN", "N", 1e6),
    ("Nm", "N.m", 1.0),
    ("kNm", "N.m", 1e3),
    ("Ns", "N.s", 1.0),
    ("kNs", "N.s", 1e3),
    ("kPa", "Pa", 1e3),
    ("MPa", "Pa", 1e6),
    ("GPa", "Pa", 1e9),
    ("kJ", "J", 1e3),
    ("kW", "W", 1e3),
    ("mrad", "rad", 1e-3),
    ("deg", "rad", std::f64::consts::PI / 180.0),
    ("°", "rad", std::f64::consts::PI / 180.0),
    ("µs", "s", 1e-6),
    ("ms", "s", 1e-3),
    ("min", "s", 60.0),
    ("h", "s", 3600.0),
    ("kHz", "Hz", 1e3),
    ("-", "1", 1.0),
    ("%", "1", 1e-2),
    ("kmh", "m/s", 1.0 / 3.6),
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
        same_dimension(theirs, &ours).then_some((theirs.factor, theirs.offset))
    }
}

/// `true` where two units are of one dimension; an angle counts as a number.
pub(super) fn same_dimension(a: &BaseUnit, b: &BaseUnit) -> bool {
    const ANGLE: usize = 7;
    a.exponents[..ANGLE] == b.exponents[..ANGLE]
}

/// The meaning of a unit's name: products of symbols joined by `.`, `*`, `·` or a space, each with an optional
/// exponent; those after a `/` count inversely.
pub(super) fn named(whole: &str) -> Option<BaseUnit> {
    let name = ["²", "³", "⁻"].into_iter().zip(["2", "3", "-"]);
    let name = name.fold(whole.trim().to_owned(), |text, (from, to)| text.replace(from, to));
    let (mut coherent, mut factor) = (Vec::new(), 1.0);
    for (position, product) in name.split('/').enumerate() {
        let mut symbols = Vec::new();
        for text in product.trim_matches(['(', ')']).split(['.', '*', '·', '⋅', ' ']) {
            let (symbol, scale) = coherent_symbol(text);
            symbols.push(symbol);
            factor *= if position == 0 { scale } else { scale.recip() };
        }
        coherent.push(symbols.join("."));
    }
    let base = Unit::from_name(&coherent.join("/"))?.base?;
    Some(BaseUnit { factor, ..base })
}

/// A symbol with its exponent in SI, and the number of these SI units in it.
fn coherent_symbol(text: &str) -> (String, f64) {
    let powers = SCALED.iter().filter_map(|(symbol, si, scale)| {
        let exponent = text.strip_prefix(symbol)?;
        if exponent.is_empty() {
            return Some((String::from(*si), *scale));
        }
        let power = exponent.trim_start_matches('^').parse().ok()?;
        let single = si.chars().all(char::is_alphabetic);
        single.then(|| (format!("{si}{exponent}"), scale.powi(power)))
    });
    powers.into_iter().next().unwrap_or_else(|| (text.to_owned(), 1.0))
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
        for (name, ours, expected) in [
            ("kN/m", "N/m", 1e3),
            ("N/mm", "N/m", 1e3),
            ("kN s/m", "N.s/m", 1e3),
            ("Ns/mm", "N.s/m", 1e3),
            ("g", "kg", 1e-3),
            ("t", "kg", 1e3),
            ("kg.cm²", "kg.m2", 1e-4),
            ("t/m^3", "kg/m3", 1e3),
            ("kmh", "m/s", 1.0 / 3.6),
            ("µs", "s", 1e-6),
        ] {
            let (factor, offset) = unit(name).to_si(ours).unwrap();
            assert!(
                (factor / expected - 1.0).abs() < 1e-15 && offset == 0.0,
                "{name}: {factor}"
            );
        }
        for unknown in ["furlong", "kg//m", "mmm", "g^", "kNm2", ""] {
            assert_eq!(named(unknown), None, "{unknown}");
        }
        assert_eq!(unit("1").to_si("rad"), Some((1.0, 0.0)), "an angle is a number");
        assert_eq!(unit("m").to_si("N"), None);
        assert_eq!(Declared::Name("furlong".to_owned()).to_si("m"), None);
    }
}
