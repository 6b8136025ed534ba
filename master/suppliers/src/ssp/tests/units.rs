//! Units of parameters: converted, or refused.

use super::*;

/// The body with a value of a parameter of the collector in a unit, and definitions of units in the set and in the
/// system.
fn body(name: &str, value: &str, unit: &str, in_set: &str, in_system: &str) -> String {
    let set = "<v:Parameter name=\"unknown\">";
    let parameter = format!("<v:Parameter name=\"{name}\"><v:Real value=\"{value}\" unit=\"{unit}\"/></v:Parameter>");
    BODY.replace("target=\"sammler.m1\"", "target=\"sammler.other\"")
        .replace(set, &format!("{parameter}{set}"))
        .replace("<v:Parameter name=\"m1\"><v:Real value=\"1\"/></v:Parameter>", "")
        .replace("<v:Units>", &format!("<v:Units>{in_set}"))
        .replace("<s:Units>", &format!("<s:Units>{in_system}"))
}

fn number(body: &str, name: &str) -> f64 {
    let imported = imported(body).unwrap_or_else(|error| panic!("{}", cosim::chain(&error)));
    match pantograph(&imported.scene).parameters[name] {
        ParameterValue::Number(number) => number,
        ref other => panic!("{other:?}"),
    }
}

#[test]
fn a_value_in_another_unit_than_the_variable_is_converted_whether_the_unit_is_defined_or_not() {
    let kip = "<c:Unit name=\"kip\"><c:BaseUnit kg=\"1\" m=\"1\" s=\"-2\" factor=\"4448.2216\"/></c:Unit>";
    let kip_per_metre = kip.replace("\"kip\"", "\"kip/m\"").replace("m=\"1\" ", "");
    // A file's own definition is stronger than a name.
    let gram = "<c:Unit name=\"g\"><c:BaseUnit kg=\"1\" factor=\"0.5\"/></c:Unit>";
    for (name, value, unit, in_set, in_system, expected) in [
        ("k", "4.2", "kN/m", "", "", 4200.0),
        ("k", "4.2", "N/mm", "", "", 4200.0),
        ("k", "4200", "N/m", "", "", 4200.0),
        ("k", "4200", "kg/s2", "", "", 4200.0),
        ("m1", "7200", "g", "", "", 7.2),
        ("m1", "0.0072", "t", "", "", 7.2),
        ("m1", "4", "g", gram, "", 2.0),
        ("k", "2", "kip/m", &kip_per_metre, "", 8896.4432),
        ("k", "2", "kip/m", "", &kip_per_metre, 8896.4432),
        ("bare", "3", "N/m", "", "", 3.0),
    ] {
        let found = number(&body(name, value, unit, in_set, in_system), name);
        // Two roundings of the factor and the product.
        assert!(
            (found / expected - 1.0).abs() < 1e-14,
            "{value} {unit} is {found}, not {expected}"
        );
    }
}

#[test]
fn a_value_whose_unit_says_nothing_or_something_else_is_refused_with_parameter_unit_and_remedy() {
    let undefined = "<c:Unit name=\"slug\"/>";
    for (name, unit, in_set, expected) in [
        (
            "k",
            "kN",
            "",
            "the unit kN cannot be converted to N/m, the dimensions differ: expected a unit of",
        ),
        (
            "k",
            "furlong",
            "",
            "the unit furlong is not known: expected N/m, a unit defined in <Units>",
        ),
        ("m1", "slug", undefined, "the unit slug is not known: expected kg"),
        (
            "bare",
            "kN/m",
            "",
            "the unit kN/m is not one of SI and the variable has none",
        ),
    ] {
        let found = refusal(&body(name, "4.2", unit, in_set, ""));
        for part in [
            "fremd.ssp",
            "SystemStructure.ssd",
            &format!("parameter \"{name}\" of component"),
            expected,
        ] {
            assert!(found.contains(part), "expected …{part}…, found {found}");
        }
    }
}

#[test]
fn a_mapping_that_suppresses_the_conversion_takes_the_value_as_it_is() {
    let set = SSV.replace("value=\"8500\"", "value=\"8500\" unit=\"g\"");
    let entry = "target=\"sammler.m1\"";
    for (flag, expected) in [("", 8.5e-3), (" suppressUnitConversion=\"true\"", 8.5)] {
        let body = BODY.replace(entry, &format!("{entry}{flag}"));
        let [wire, collector] = fmus();
        let entries = BTreeMap::from([
            (STRUCTURE_FILE.to_owned(), format!("{HEAD}{body}").into_bytes()),
            ("resources/k.fmu".to_owned(), collector),
            ("resources/d.fmu".to_owned(), wire),
            ("resources/set one.ssv".to_owned(), set.as_bytes().to_vec()),
        ]);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fremd.ssp");
        write_archive(&path, &zipped(&entries).unwrap()).unwrap();
        let imported = import(&path, &["run.start_x=10".to_owned()]).unwrap();
        let ParameterValue::Number(mass) = pantograph(&imported.scene).parameters["m1"] else {
            panic!("a number");
        };
        assert!((mass / expected - 1.0).abs() < 1e-14, "{mass}");
    }
}
