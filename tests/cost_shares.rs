//! Shares of the parts of a scene in the time loop, in all modes.
use component::Share;
use integration_tests::fmus::DEFAULT;
use integration_tests::runs::{EN_250, run, scene_with};
use results::Summary;
use simulation::Mode;

/// The full scene with wind on pantograph and wires.
const WIND: &str = include_str!("../scenes/thesis-wind-both.toml");

/// A short run with two dozen evaluated steps.
const SHORT: [&str; 2] = ["run.duration=0.4", "run.evaluate={ time = [0.1, 0.4] }"];

fn summary(text: &str, mode: Mode) -> Summary {
    let name = format!("test-shares-{}", mode.name());
    run(scene_with(text, &SHORT), mode, &name).summary
}

fn parts(summary: &Summary) -> Vec<&str> {
    summary.cost.shares.iter().map(|share| &*share.part).collect()
}

fn sum(shares: &[Share]) -> f64 {
    shares.iter().map(|share| share.share).sum()
}

#[test]
fn one_system_pays_for_the_parts_that_are_modelled_and_for_no_others() {
    for text in [EN_250, DEFAULT, WIND] {
        let summary = summary(text, Mode::Monolithic);
        let (shares, scene) = (&summary.cost.shares, &summary.scene);
        assert!(
            (sum(shares) - 1.0).abs() < 1e-12,
            "{scene}: rounding of a sum of fifteen"
        );
        assert!(shares.iter().all(|share| share.share > 0.0), "{scene}: {shares:?}");
        assert_eq!(parts(&summary).last(), Some(&"master"), "{scene}");
        // Parts of the model with forces under their own name; only wheels feel a track.
        for part in ["vehicle", "wheel_rail", "pantograph", "wind_pantograph", "wind_wires"] {
            let modelled = summary
                .model
                .parts
                .iter()
                .find(|found| found.part == part)
                .unwrap()
                .modelled;
            assert_eq!(parts(&summary).contains(&part), modelled, "{scene}: {part}");
        }
        for part in [
            "wires",
            "droppers",
            "supports",
            "registration_arms",
            "contact",
            "factorization",
            "linear_solution",
            "time_integration",
        ] {
            assert!(parts(&summary).contains(&part), "{scene}: {part}");
        }
        // No contribution is without a name of its own.
        assert!(!parts(&summary).contains(&"catenary"), "{scene}");
    }
}

#[test]
fn coupled_sides_share_the_loop_with_the_master() {
    for mode in [Mode::Inprocess, Mode::Cosimulation] {
        let summary = summary(DEFAULT, mode);
        assert_eq!(
            parts(&summary),
            ["catenary", "pantograph[1]", "master"],
            "{}",
            mode.name()
        );
        let shares = &summary.cost.shares;
        assert!(shares.iter().all(|share| share.share > 0.0), "{shares:?}");
        assert!((sum(shares) - 1.0).abs() < 1e-12, "rounding of a sum of three");
    }
}
