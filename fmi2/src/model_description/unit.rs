//! Units as products of powers of the SI base units [FMI 2.0, 2.2.2].

/// Exponents of kg, m, s, A, K, mol, cd, rad and the linear map `SI = factor · value + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseUnit {
    /// Exponents in the order kg, m, s, A, K, mol, cd, rad.
    pub exponents: [i32; 8],
    /// Factor, –.
    pub factor: f64,
    /// Offset in the SI unit.
    pub offset: f64,
}

impl Default for BaseUnit {
    fn default() -> Self {
        Self {
            exponents: [0; 8],
            factor: 1.0,
            offset: 0.0,
        }
    }
}

/// Names of the base units in the order of [`BaseUnit::exponents`].
pub const BASE_UNITS: [&str; 8] = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];

/// A unit for people: `display = factor · value + offset`, the other way round than [`BaseUnit`].
#[derive(Clone, Debug, PartialEq)]
pub struct DisplayUnit {
    /// Name.
    pub name: String,
    /// Factor, –.
    pub factor: f64,
    /// Offset in the display unit.
    pub offset: f64,
}

/// A unit definition.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Name, as variables refer to it.
    pub name: String,
    /// Meaning in SI; `None` if the file gives none.
    pub base: Option<BaseUnit>,
    /// Alternatives for people.
    pub display_units: Vec<DisplayUnit>,
}

/// Symbols understood by [`Unit::from_name`] with their exponents in the order of [`BASE_UNITS`].
const SYMBOLS: [(&str, [i32; 8]); 15] = [
    ("1", [0, 0, 0, 0, 0, 0, 0, 0]),
    ("kg", [1, 0, 0, 0, 0, 0, 0, 0]),
    ("m", [0, 1, 0, 0, 0, 0, 0, 0]),
    ("s", [0, 0, 1, 0, 0, 0, 0, 0]),
    ("A", [0, 0, 0, 1, 0, 0, 0, 0]),
    ("K", [0, 0, 0, 0, 1, 0, 0, 0]),
    ("mol", [0, 0, 0, 0, 0, 1, 0, 0]),
    ("cd", [0, 0, 0, 0, 0, 0, 1, 0]),
    ("rad", [0, 0, 0, 0, 0, 0, 0, 1]),
    ("Hz", [0, 0, -1, 0, 0, 0, 0, 0]),
    ("N", [1, 1, -2, 0, 0, 0, 0, 0]),
    ("Pa", [1, -1, -2, 0, 0, 0, 0, 0]),
    ("J", [1, 2, -2, 0, 0, 0, 0, 0]),
    ("W", [1, 2, -3, 0, 0, 0, 0, 0]),
    ("V", [1, 2, -3, -1, 0, 0, 0, 0]),
];

impl Unit {
    /// The coherent SI unit of that name, such as `N.s/m`, `kg.m2` or `1/s`: factors joined by `.`, `*` or `·`, each
    /// with an optional whole exponent; every factor after a `/` up to the end counts inversely. `None` for an unknown
    /// symbol.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let mut exponents = [0; 8];
        for (position, product) in name.split('/').enumerate() {
            let sign = if position == 0 { 1 } else { -1 };
            for factor in product.trim_matches(['(', ')']).split(['.', '*', '·']) {
                let (symbol, power) = split_exponent(factor)?;
                let (_, powers) = SYMBOLS.iter().find(|(known, _)| *known == symbol)?;
                for (sum, p) in exponents.iter_mut().zip(powers) {
                    *sum += sign * power * p;
                }
            }
        }
        let base = BaseUnit {
            exponents,
            ..BaseUnit::default()
        };
        Some(Self {
            name: name.to_owned(),
            base: Some(base),
            display_units: Vec::new(),
        })
    }

    /// Factor and offset that turn a value in `self` into `other`: `other = factor · value + offset`; `None` for
    /// different or unknown dimensions. Names are not compared.
    #[must_use]
    pub fn conversion_to(&self, other: &Self) -> Option<(f64, f64)> {
        let (from, to) = (self.base?, other.base?);
        (from.exponents == to.exponents).then(|| (from.factor / to.factor, (from.offset - to.offset) / to.factor))
    }
}

/// `m2` → (`m`, 2), `s^-1` → (`s`, −1), `1` → (`1`, 1).
fn split_exponent(factor: &str) -> Option<(&str, i32)> {
    if factor == "1" {
        return Some((factor, 1));
    }
    let end = factor.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(factor.len());
    let (symbol, exponent) = factor.split_at(end);
    match exponent.trim_start_matches('^') {
        "" if exponent.is_empty() => Some((symbol, 1)),
        digits => Some((symbol, digits.parse().ok().filter(|p: &i32| p.abs() <= 9)?)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exponents(name: &str) -> Option<[i32; 8]> {
        Unit::from_name(name)
            .and_then(|unit| unit.base)
            .map(|base| base.exponents)
    }

    #[test]
    fn names_of_units_give_their_exponents() {
        assert_eq!(exponents("N.s/m"), Some([1, 0, -1, 0, 0, 0, 0, 0]));
        assert_eq!(exponents("kg.m2"), Some([1, 2, 0, 0, 0, 0, 0, 0]));
        assert_eq!(exponents("m/s^2"), Some([0, 1, -2, 0, 0, 0, 0, 0]));
        assert_eq!(exponents("N.m/rad"), Some([1, 2, -2, 0, 0, 0, 0, -1]));
        assert_eq!(exponents("1/s"), exponents("Hz"));
        assert_eq!(exponents("kg/(m.s)"), Some([1, -1, -1, 0, 0, 0, 0, 0]));
        assert_eq!(exponents("1"), Some([0; 8]));
        for unknown in ["furlong", "", "m..s", "m^", "N/"] {
            assert_eq!(exponents(unknown), None, "{unknown}");
        }
    }

    #[test]
    fn units_of_equal_dimension_convert_by_factor_and_offset_whatever_their_name() {
        let celsius = BaseUnit {
            exponents: [0, 0, 0, 0, 1, 0, 0, 0],
            factor: 1.0,
            offset: 273.15,
        };
        let celsius = Unit {
            name: "degC".into(),
            base: Some(celsius),
            display_units: vec![],
        };
        let kelvin = Unit::from_name("K").unwrap();
        assert_eq!(celsius.conversion_to(&kelvin), Some((1.0, 273.15)));
        assert_eq!(kelvin.conversion_to(&celsius), Some((1.0, -273.15)));
        assert_eq!(kelvin.conversion_to(&Unit::from_name("N").unwrap()), None);
        let joined = Unit::from_name("N.m").unwrap();
        assert_eq!(joined.conversion_to(&Unit::from_name("J").unwrap()), Some((1.0, 0.0)));
    }
}
