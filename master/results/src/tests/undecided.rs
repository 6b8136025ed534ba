//! Records that say nothing carry no verdict.

use super::*;
use crate::standards::Limit;

/// Limits of a run after a change of its evaluation and record.
fn limits(change: impl Fn(&mut RunInfo, &mut Record)) -> Summary {
    let (mut info, mut record) = run(true);
    change(&mut info, &mut record);
    Summary::new(&info, &record)
}

fn of(summary: &Summary, pantograph: usize) -> Vec<&Limit> {
    let wanted = |limit: &&Limit| limit.pantograph == Some(pantograph) && limit.applicable && limit.limit.is_some();
    summary.limits.iter().filter(wanted).collect()
}

#[test]
fn figures_of_a_record_that_says_nothing_are_not_decided_and_the_reason_is_given() {
    let whole = limits(|_, _| ());
    assert!(!of(&whole, 1).is_empty() && of(&whole, 1).iter().all(|limit| limit.pass.is_some()));
    type Change = fn(&mut RunInfo, &mut Record);
    let cases: [(Change, &str); 5] = [
        (
            |info, _| info.evaluation.time = vec![(1.0, 1.0); 2],
            "0 s are evaluated, 0.0 periods",
        ),
        (
            |info, _| info.evaluation.time = vec![(1.0, 1.02); 2],
            "0.02 s are evaluated, 0.4 periods",
        ),
        (
            |info, _| info.evaluation.low_pass_hz = 1.2,
            "periods of run.low_pass_hz = 1.2 Hz; 10 are needed",
        ),
        (
            |info, record| {
                // Every 24th sample, as output_step = 0.024 gives.
                info.evaluation.output_step = 0.024;
                let thin = |series: &mut Vec<f64>| *series = series.iter().step_by(24).copied().collect();
                thin(&mut record.time);
                for strip in &mut record.pantographs {
                    let StripRecord {
                        force,
                        contact_x,
                        contact_y,
                        wire_z,
                        strip_z,
                        strip_vz,
                        gap,
                        ..
                    } = strip;
                    [force, contact_x, contact_y, wire_z, strip_z, strip_vz, gap]
                        .into_iter()
                        .for_each(thin);
                }
                record.supports.iter_mut().for_each(|support| thin(&mut support.uplift));
            },
            "run.output_step = 0.024 s is too coarse for run.low_pass_hz = 20 Hz",
        ),
        (
            |_, record| record.pantographs[0].gap[1500] = -2.3,
            "the strip is up to 2.300 m inside the contact wire",
        ),
    ];
    for (change, reason) in cases {
        let summary = limits(change);
        for limit in of(&summary, 1) {
            assert_eq!(limit.pass, None, "{}: {reason}", limit.quantity);
            assert!(limit.reason.contains(reason), "{} is not in {}", reason, limit.reason);
        }
        assert!(
            summary.notes.iter().any(|note| note.contains(reason)),
            "{:?}",
            summary.notes
        );
        let speed = summary
            .limits
            .iter()
            .find(|limit| limit.quantity == "sampling_rate")
            .unwrap();
        assert!(speed.pass.is_some(), "the setting is what it is");
        let uplift = summary.limits.iter().find(|limit| limit.quantity == "uplift").unwrap();
        assert_eq!(uplift.pass, None);
    }
}

#[test]
fn a_strip_through_the_wire_takes_no_verdict_from_another_pantograph() {
    let summary = limits(|_, record| record.pantographs[0].gap[1500] = -2.3);
    assert!(of(&summary, 2).iter().all(|limit| limit.pass.is_some()));
}

#[test]
fn ten_periods_with_five_samples_each_are_enough() {
    let summary = limits(|info, _| info.evaluation.time = vec![(1.0, 1.5); 2]);
    assert!(
        of(&summary, 1).iter().all(|limit| limit.pass.is_some()),
        "{:?}",
        summary.notes
    );
}
