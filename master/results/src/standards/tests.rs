use scene::Electrification::{self, Ac15Kv, Ac25Kv, Dc1_5Kv, Dc3Kv};

use super::*;

/// A line of 20 kN and 1.35 kg/m, whose waves run at 121.7 m/s = 438.2 km/h.
pub(super) fn conditions(electrification: Option<Electrification>, speed_kmh: f64) -> Conditions {
    Conditions {
        line: Line {
            electrification,
            wave_speed: Some((20_000.0_f64 / 1.35).sqrt()),
            free_uplift: None,
            uplift_stop: false,
        },
        speed: speed_kmh / 3.6,
        low_pass_hz: 20.0,
        filter: Filter::ZeroPhase,
        output_step: 1e-3,
        uplift: Some(0.05),
    }
}

pub(super) fn figures(force: &[f64], amplitude: f64) -> Figures {
    Figures {
        force: ForceStatistics::of(force),
        vertical_amplitude: Some(amplitude),
        loss_of_contact: Some(0.0),
        arcing: Some(0.0),
        section: 120.0,
        longest_span: Some(60.0),
    }
}

/// The limit of `quantity` in `standard`, of one pantograph with a mean of 100 N and forces of 80 and 120 N.
fn one(conditions: &Conditions, standard: &str, quantity: &str) -> Limit {
    of(conditions, &figures(&[80.0, 120.0], 0.02), standard, quantity)
}

fn of(conditions: &Conditions, figures: &Figures, standard: &str, quantity: &str) -> Limit {
    let all = limits(conditions, &[*figures], &Assessment::default());
    let mut found = all
        .into_iter()
        .filter(|l| l.standard == standard && l.quantity == quantity);
    let limit = found
        .next()
        .unwrap_or_else(|| panic!("no limit of {quantity} in {standard}"));
    assert!(found.next().is_none(), "{standard} limits {quantity} twice");
    limit
}

#[test]
fn the_mean_force_follows_the_curves_by_system_and_speed() {
    // By hand: a v² + b.
    for (system, speed, upper, lower) in [
        (Ac25Kv, 0.0, 90.0, 60.0),
        (Ac25Kv, 100.0, 94.7, 64.7),
        (Ac15Kv, 160.0, 102.032, 72.032),
        (Ac25Kv, 200.0, 108.8, 78.8),
        (Ac25Kv, 250.0, 130.625, 89.375),
        (Ac25Kv, 300.0, 157.3, 102.3),
        (Dc3Kv, 160.0, 134.832, 114.576),
        (Dc3Kv, 250.0, 170.625, 150.0),
        (Dc1_5Kv, 200.0, 178.8, 114.8),
        (Dc1_5Kv, 220.0, 200.352, 124.208),
    ] {
        let conditions = conditions(Some(system), speed);
        for (quantity, expected, bound) in [("mean", upper, Bound::AtMost), ("mean_lower", lower, Bound::AtLeast)] {
            let limit = one(&conditions, "EN 50367", quantity);
            // Rounding of the conversion to m/s and back, cut at 1e-6 km/h.
            assert!(
                (limit.limit.unwrap() - expected).abs() < 1e-6,
                "{system} at {speed} km/h, {quantity}: {:?}",
                limit.limit
            );
            assert_eq!((limit.bound, limit.applicable), (bound, true));
            assert_eq!(limit.clause, "2012, Table 6 (TSI ENE 4.2.11)");
        }
    }
}

#[test]
fn the_branches_for_ac_meet_at_200_km_per_h_and_those_for_1_5_kv_do_not() {
    let jump = |system, quantity| {
        let at = |speed| {
            one(&conditions(Some(system), speed), "EN 50367", quantity)
                .limit
                .unwrap()
        };
        at(200.000_01) - at(200.0)
    };
    // The slope over 1e-5 km/h is 4e-6 N; 181.2 N follow on 178.8 N.
    assert!(jump(Ac25Kv, "mean").abs() < 1e-5);
    assert!((jump(Dc1_5Kv, "mean") - 2.4).abs() < 1e-4);
    assert!(jump(Dc1_5Kv, "mean_lower").abs() < 1e-4);
}

#[test]
fn the_thesis_limits_at_its_200_km_per_h_are_among_those_of_an_ac_line() {
    // [Thesis, 4.2.3]
    let conditions = conditions(Some(Ac25Kv), 200.0);
    for (quantity, limit) in [
        ("mean", 0.00097 * 200.0 * 200.0 + 70.0),
        ("std", 30.0),
        ("max", 350.0),
        ("vertical_amplitude", 0.080),
        ("uplift", 0.120),
        ("arcing", 0.2),
    ] {
        let found = one(&conditions, "EN 50367", quantity);
        assert!((found.limit.unwrap() - limit).abs() < 1e-9, "{quantity}"); // rounding of the sum
        assert_eq!(
            (found.certainty, found.pass),
            (Certainty::Cited, Some(true)),
            "{quantity}"
        );
    }
}

#[test]
fn a_mean_force_outside_its_band_fails_on_the_side_where_it_is_outside() {
    let conditions = conditions(Some(Ac25Kv), 200.0); // 78.8 N to 108.8 N
    for (mean, upper, lower) in [
        (78.0, true, false),
        (79.0, true, true),
        (108.7, true, true),
        (108.9, false, true),
    ] {
        let figures = figures(&[mean - 1.0, mean + 1.0], 0.02);
        assert_eq!(
            of(&conditions, &figures, "EN 50367", "mean").pass,
            Some(upper),
            "{mean}"
        );
        assert_eq!(
            of(&conditions, &figures, "EN 50367", "mean_lower").pass,
            Some(lower),
            "{mean}"
        );
    }
}

#[test]
fn the_standard_deviation_is_held_against_three_tenths_of_the_runs_own_mean_on_every_line() {
    for system in [None, Some(Ac25Kv), Some(Dc3Kv)] {
        let conditions = conditions(system, 250.0);
        let std = of(&conditions, &figures(&[69.0, 131.0], 0.02), "EN 50367", "std"); // mean 100 N, std 31 N
        assert!((std.limit.unwrap() - 30.0).abs() < 1e-12); // rounding of 0.3
        assert_eq!(std.pass, Some(false));
        let std = of(&conditions, &figures(&[71.0, 129.0], 0.02), "EN 50367", "std");
        assert_eq!(std.pass, Some(true));
    }
}

#[test]
fn each_bound_is_strict_or_not_as_it_is_written() {
    let conditions = Conditions {
        uplift: Some(0.120),
        ..conditions(Some(Ac25Kv), 250.0)
    };
    let figures = figures(&[0.0, 350.0], 0.080);
    for (standard, quantity, pass) in [
        ("EN 50367", "max", false),               // < 350 N
        ("EN 50119", "max", true),                // ≤ 350 N
        ("EN 50119", "min", false),               // > 0
        ("EN 50367", "vertical_amplitude", true), // ≤ 80 mm
        ("EN 50367", "uplift", true),             // ≤ 120 mm
        ("EN 50317", "band", true),               // = 20 Hz
    ] {
        assert_eq!(
            of(&conditions, &figures, standard, quantity).pass,
            Some(pass),
            "{standard} {quantity}"
        );
    }
    let more = Conditions {
        uplift: Some(0.1201),
        low_pass_hz: 30.0,
        ..conditions
    };
    assert_eq!(of(&more, &figures, "EN 50367", "uplift").pass, Some(false));
    assert_eq!(of(&more, &figures, "EN 50317", "band").pass, Some(false));
}

#[test]
fn the_largest_force_goes_by_system_above_200_km_per_h_only() {
    for (system, speed, limit) in [
        (Some(Ac25Kv), 200.0, Some(300.0)),
        (Some(Ac15Kv), 200.5, Some(350.0)),
        (Some(Dc3Kv), 200.0, Some(300.0)),
        (Some(Dc1_5Kv), 201.0, Some(400.0)),
        (None, 200.0, Some(300.0)),
        (None, 250.0, None),
    ] {
        let found = one(&conditions(system, speed), "EN 50119", "max");
        assert_eq!(
            (found.limit, found.applicable),
            (limit, limit.is_some()),
            "{system:?} {speed}"
        );
        assert_eq!(found.certainty, Certainty::Remembered);
    }
    let quoted = one(&conditions(Some(Dc3Kv), 250.0), "EN 50367", "max");
    assert_eq!((quoted.applicable, quoted.limit, quoted.pass), (false, None, None));
    assert!(quoted.reason.contains("for DC"), "{}", quoted.reason);
}

#[test]
fn arcing_goes_by_system_between_160_and_250_km_per_h() {
    for (system, speed, limit) in [
        (Some(Ac25Kv), 160.0, Some(0.1)),
        (Some(Ac25Kv), 249.0, Some(0.1)),
        (Some(Ac25Kv), 250.0, Some(0.2)),
        (Some(Dc3Kv), 160.0, Some(0.1)),
        (Some(Dc3Kv), 161.0, Some(0.2)),
        (Some(Dc1_5Kv), 250.0, Some(0.2)),
        (None, 160.0, Some(0.1)),
        (None, 200.0, None),
        (None, 250.0, Some(0.2)),
    ] {
        let found = one(&conditions(system, speed), "TSI ENE", "arcing");
        assert_eq!(
            (found.limit, found.applicable),
            (limit, limit.is_some()),
            "{system:?} {speed}"
        );
    }
    let lost = Figures {
        loss_of_contact: Some(0.4),
        arcing: Some(0.15),
        ..figures(&[80.0, 120.0], 0.02)
    };
    let conditions = conditions(Some(Ac25Kv), 200.0);
    let strict = of(&conditions, &lost, "TSI ENE", "arcing");
    assert_eq!((strict.value, strict.pass), (Some(0.15), Some(false)));
    assert_eq!(of(&conditions, &lost, "EN 50367", "arcing").pass, Some(true));
    for text in ["no electrical model", "5 ms", "0.400 %"] {
        assert!(strict.remark.contains(text), "{text}: {}", strict.remark);
    }
}

#[test]
fn a_steady_arm_has_to_leave_twice_the_uplift_or_one_and_a_half_times_with_a_stop() {
    let with = |free_uplift, uplift_stop, uplift| {
        let mut conditions = conditions(None, 250.0);
        conditions.line.free_uplift = free_uplift;
        conditions.line.uplift_stop = uplift_stop;
        conditions.uplift = uplift;
        one(&conditions, "EN 50119", "free_uplift")
    };
    for (space, stop, needed, pass) in [
        (0.100, false, 0.100, true),
        (0.099, false, 0.100, false),
        (0.076, true, 0.075, true),
        (0.074, true, 0.075, false),
    ] {
        let limit = with(Some(space), stop, Some(0.05));
        assert!((limit.limit.unwrap() - needed).abs() < 1e-15); // rounding of the product
        assert_eq!((limit.value, limit.pass), (Some(space), Some(pass)), "{space} {stop}");
        assert!(
            limit.clause.contains("5.10.2") && limit.reason.contains("stop"),
            "{}",
            limit.reason
        );
    }
    assert_eq!(with(Some(0.1), false, Some(-0.01)).limit, Some(0.0));
    assert_eq!(with(Some(0.1), false, None).pass, None);
    let unknown = with(None, false, Some(0.05));
    assert_eq!((unknown.applicable, unknown.pass), (false, None));
    for text in ["set catenary.registration_arms.free_uplift", "100 mm"] {
        assert!(unknown.reason.contains(text), "{}", unknown.reason);
    }
}

#[test]
fn a_train_may_run_at_seven_tenths_of_the_speed_of_waves() {
    // 0.7 · √(20 kN / 1.35 kg/m) = 85.20 m/s = 306.7 km/h
    assert_eq!(
        one(&conditions(None, 306.0), "EN 50119", "speed_ratio").pass,
        Some(true)
    );
    assert_eq!(
        one(&conditions(None, 307.5), "EN 50119", "speed_ratio").pass,
        Some(false)
    );
    let mut foreign = conditions(None, 100.0);
    foreign.line.wave_speed = None;
    let limit = one(&foreign, "EN 50119", "speed_ratio");
    assert_eq!((limit.applicable, limit.value, limit.pass), (false, None, None));
    assert!(limit.reason.contains("FMU"), "{}", limit.reason);
}

#[test]
fn the_force_has_to_be_sampled_200_times_a_second() {
    for (step, pass) in [(1e-3, true), (5e-3, true), (6e-3, false)] {
        let conditions = Conditions {
            output_step: step,
            ..conditions(None, 360.0)
        };
        assert_eq!(one(&conditions, "EN 50317", "sampling_rate").pass, Some(pass), "{step}");
    }
    let rate = one(&conditions(None, 360.0), "EN 50317", "sampling_rate");
    assert!(rate.remark.contains("every 100 mm"), "{}", rate.remark);
    let section = one(&conditions(None, 360.0), "EN 50317", "control_section");
    assert_eq!((section.value, section.pass), (Some(120.0), Some(true)));
    assert_eq!(section.certainty, Certainty::Chosen);
    // A whole span holds, rounding included; a part of one does not.
    for (length, pass) in [(60.0, Some(true)), (60.0 - 1e-9, Some(true)), (59.9, None)] {
        let figures = Figures {
            section: length,
            ..figures(&[80.0, 120.0], 0.02)
        };
        let section = of(&conditions(None, 360.0), &figures, "EN 50317", "control_section");
        assert_eq!(section.pass, pass, "{length}");
    }
}

#[test]
fn a_scene_without_a_system_is_told_which_key_to_set() {
    let without = conditions(None, 220.0);
    for (standard, quantity) in [
        ("EN 50367", "mean"),
        ("EN 50367", "mean_lower"),
        ("EN 50367", "max"),
        ("EN 50119", "max"),
        ("TSI ENE", "arcing"),
    ] {
        let limit = one(&without, standard, quantity);
        assert_eq!((limit.applicable, limit.limit, limit.pass), (false, None, None));
        assert!(limit.value.is_some(), "the value of {quantity} is known all the same");
        for text in [
            "run.electrification",
            "\"ac_25kv\"",
            "\"ac_15kv\"",
            "\"dc_3kv\"",
            "\"dc_1_5kv\"",
        ] {
            assert!(limit.reason.contains(text), "{}", limit.reason);
        }
    }
}

#[test]
fn every_limit_has_a_clause_and_says_why_it_applies_or_not() {
    for system in Electrification::ALL.iter().copied().map(Some).chain([None]) {
        for speed in [100.0, 160.0, 200.0, 220.0, 250.0, 320.0] {
            let both = [figures(&[80.0, 120.0], 0.02); 2];
            let all = limits(&conditions(system, speed), &both, &Assessment::default());
            for limit in &all {
                assert!(!limit.clause.is_empty() && !limit.reason.is_empty(), "{limit:?}");
                assert_eq!(
                    limit.pass.is_some(),
                    limit.applicable && limit.limit.is_some() && limit.value.is_some(),
                    "{limit:?}"
                );
            }
            let of_second = all.iter().filter(|l| l.pantograph == Some(2)).count();
            assert_eq!(of_second, all.iter().filter(|l| l.pantograph == Some(1)).count());
        }
    }
}

#[test]
fn a_run_without_force_is_not_decided() {
    let empty = Figures {
        force: None,
        loss_of_contact: None,
        arcing: None,
        vertical_amplitude: None,
        section: 0.0,
        longest_span: None,
    };
    let all = limits(
        &Conditions {
            uplift: None,
            ..conditions(Some(Ac25Kv), 200.0)
        },
        &[empty],
        &Assessment::default(),
    );
    for limit in all.iter().filter(|limit| limit.pantograph.is_some()) {
        assert_eq!(limit.pass, None, "{}", limit.quantity);
    }
}
