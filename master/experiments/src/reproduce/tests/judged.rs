use super::super::verdict::{SAME_SIZE, VERDICT_RULE, VISIBLE, judge};
use super::super::{Relation, Spread, Verdict};
use super::{line, page, reproduction, text};
use crate::engine::table::{RunRow, Status};
use crate::reproduce::{Mesh, RunGroup};

/// Verdict of a computed change, both in %.
fn verdict(published: f64, computed: f64) -> Verdict {
    judge(published, Some(computed)).0
}

#[test]
fn a_change_of_a_tenth_of_the_published_one_has_its_direction_only() {
    // Sliding joint over penalty, mean: +2.45 % is published.
    let (found, why) = judge(2.446, Some(0.22));
    assert_eq!(found, Verdict::DirectionOnly);
    assert_eq!(why, "same direction, 0.09 of the published change");
    assert_eq!(verdict(2.446, 10.0), Verdict::DirectionOnly);
    // Wind on the pantograph, mean: +11.53 % is published.
    let (found, why) = judge(11.53, Some(9.97));
    assert_eq!(found, Verdict::Holds);
    assert_eq!(why, "0.86 of the published change");
}

#[test]
fn a_change_of_no_size_or_of_the_other_direction_is_refuted_with_its_figure() {
    let (found, why) = judge(1.573, Some(-10.34));
    assert_eq!(found, Verdict::Refuted);
    assert_eq!(why, "other direction: -10.34 % where +1.57 % is published");
    let (found, why) = judge(2.446, Some(0.05));
    assert_eq!(found, Verdict::Refuted);
    assert_eq!(why, "no visible change: +0.05 % where +2.45 % is published");
}

#[test]
fn no_visible_change_is_refuted_by_one_that_the_thesis_would_have_shown() {
    // Wind on the wires: -0.11 % is published for sigma, which the thesis calls negligible.
    let published: f64 = -0.112;
    assert!(published.abs() < VISIBLE);
    for computed in [-1.62, -2.2, 0.5] {
        let (found, why) = judge(published, Some(computed));
        assert_eq!(found, Verdict::Refuted, "{computed}");
        assert!(why.contains(&format!("{computed:+.2} %")), "{why}");
    }
    assert_eq!(verdict(published, -0.15), Verdict::Holds);
    assert_eq!(verdict(published, 0.15), Verdict::Holds, "neither has a direction");
}

#[test]
fn the_bounds_of_a_verdict_are_the_stated_ones() {
    let [least, most] = SAME_SIZE;
    let published = -4.0; // a power of two: shares of it are exact
    assert_eq!(verdict(published, least * published), Verdict::Holds);
    assert_eq!(verdict(published, most * published), Verdict::Holds);
    assert_eq!(verdict(published, 0.99 * least * published), Verdict::DirectionOnly);
    assert_eq!(verdict(published, 1.01 * most * published), Verdict::DirectionOnly);
    assert_eq!(verdict(0.0, VISIBLE), Verdict::Refuted);
    assert_eq!(verdict(0.0, 0.99 * VISIBLE), Verdict::Holds);
    for missing in [None, Some(f64::NAN), Some(f64::INFINITY)] {
        assert_eq!(judge(published, missing).0, Verdict::NotComputed);
    }
    // The rule in words has the same bounds.
    assert!(VERDICT_RULE.contains(&format!("below {VISIBLE} %")));
}

#[test]
fn the_thesis_itself_holds_on_every_relation() {
    // Its own figures as if they had been computed.
    let thesis = Mesh::Plain(1);
    let of = |case: usize| {
        let published = &crate::reproduce::CASES[case];
        line(
            RunGroup::Published,
            case,
            thesis,
            published.mean.value,
            published.std.value,
        )
    };
    let found = reproduction((0..4).map(of).collect()).relations;
    assert_eq!(found.len(), 6);
    assert!(
        found.iter().all(|relation| relation.verdict == Verdict::Holds),
        "{found:?}"
    );
}

#[test]
fn relations_are_judged_on_each_mesh_and_counted_over_all() {
    let (thesis, refined) = (Mesh::Plain(1), Mesh::Corrected);
    let made = reproduction(vec![
        line(RunGroup::Published, 0, thesis, 106.98, 47.41),
        line(RunGroup::Published, 1, thesis, 107.21, 42.59),
        line(RunGroup::Published, 2, thesis, 117.65, 48.46),
        line(RunGroup::Published, 3, thesis, 117.64, 47.70),
        line(RunGroup::Mesh, 0, refined, 106.31, 37.31),
        line(RunGroup::Mesh, 1, refined, 106.48, 36.27),
    ]);
    let words: Vec<(&str, Mesh, Verdict)> = made
        .relations
        .iter()
        .map(|relation| (relation.of, relation.mesh, relation.verdict))
        .collect();
    assert_eq!(
        words,
        [
            // 107.21/106.98 = +0.21 % against +2.45 %; 42.59/47.41 = -10.2 % against +1.57 %.
            ("mean", thesis, Verdict::DirectionOnly),
            ("std", thesis, Verdict::Refuted),
            // +9.97 % against +11.53 %; +2.2 % against -2.80 %.
            ("mean", thesis, Verdict::Holds),
            ("std", thesis, Verdict::Refuted),
            // -0.01 % against -0.01 %; -1.57 % against -0.11 %.
            ("mean", thesis, Verdict::Holds),
            ("std", thesis, Verdict::Refuted),
            // +0.16 % against +2.45 %, which is below what is visible; -2.8 % against +1.57 %.
            ("mean", refined, Verdict::Refuted),
            ("std", refined, Verdict::Refuted),
        ]
    );
    let published: Vec<&Relation> = made
        .relations
        .iter()
        .filter(|relation| relation.mesh == thesis)
        .collect();
    assert!((published[2].published - 11.53).abs() < 0.005); // printed digits
    let shown = text(&made);
    // The joint's mean: direction only on one mesh of two, refuted on the other.
    let row = shown
        .lines()
        .find(|row| row.contains("+2.45") && row.contains("of 2"))
        .unwrap();
    assert!(row.contains("0 of 2") && row.matches("1 of 2").count() == 2, "{row}");
    assert!(page(&made).finish().contains("direction only"));
}

/// Spreads of one quantity with these standard deviations, N, and its case's.
fn spread(own: Option<f64>, changed: &[Option<f64>]) -> Spread {
    let thesis = Mesh::Plain(1);
    let mut lines = Vec::new();
    if let Some(own) = own {
        lines.push(line(RunGroup::Published, 0, thesis, 100.0, own));
    }
    for (index, std) in changed.iter().enumerate() {
        let mut run = line(RunGroup::Open, 0, thesis, 100.0, 0.0);
        run.quantity = "contact damping d";
        run.value = format!("{index} N s/m");
        run.row.std = *std;
        if std.is_none() {
            run.row.status = Some(Status::Diverged);
        }
        lines.push(run);
    }
    let made = reproduction(lines);
    let [spread] = &made.spreads[..] else {
        panic!("one quantity on one mesh: {:?}", made.spreads)
    };
    spread.clone()
}

#[test]
fn a_spread_reaches_over_its_values_and_the_scenes_own() {
    let found = spread(Some(40.0), &[Some(38.0), Some(30.0)]);
    assert_eq!(found.std(), Some([30.0, 40.0]));
    assert_eq!((found.verdict(), found.holds_published()), ("inside", Some(true)));
    assert_eq!(
        found.why(),
        "published 36.73 N is inside 30.00 N (at 1 N s/m) to 40.00 N (at the scene's own); 2 of 2 values computed"
    );
    let found = spread(Some(40.0), &[Some(38.0), Some(45.0)]);
    assert_eq!((found.std(), found.verdict()), (Some([38.0, 45.0]), "outside"));
    // Without the scene's own run, the values alone.
    let found = spread(None, &[Some(38.0), Some(30.0)]);
    assert_eq!((found.std(), found.verdict()), (Some([30.0, 38.0]), "inside"));
}

#[test]
fn a_spread_without_a_run_is_not_computed_rather_than_outside() {
    let found = spread(Some(40.0), &[None, None]);
    assert_eq!((found.std(), found.verdict()), (None, "not computed"));
    assert_eq!(found.why(), "0 of 2 values computed");
    let found = spread(Some(40.0), &[None, Some(30.0), Some(f64::NAN)]);
    assert_eq!((found.std(), found.verdict()), (Some([30.0, 40.0]), "inside"));
    assert!(found.why().ends_with("1 of 3 values computed"), "{}", found.why());
}

#[test]
fn a_quantity_of_the_wind_is_held_against_the_case_with_wind() {
    let thesis = Mesh::Plain(1);
    let mut changed = line(RunGroup::Open, 3, thesis, 117.0, 35.0);
    changed.quantity = "density of the air";
    let made = reproduction(vec![
        line(RunGroup::Published, 0, thesis, 107.0, 50.0),
        line(RunGroup::Published, 3, thesis, 117.0, 36.0),
        changed,
    ]);
    // 35.66 N lies between 35 N and 36 N; 36.73 N, of the case without wind, does not, and its own 50 N has no part in
    // it.
    assert_eq!(made.spreads[0].std(), Some([35.0, 36.0]));
    assert_eq!(made.spreads[0].verdict(), "inside");
    assert!(made.spreads[0].why().contains("35.66"), "{}", made.spreads[0].why());
}

#[test]
fn terminal_and_page_say_whether_the_published_value_lies_inside() {
    let thesis = Mesh::Plain(1);
    let mut changed = line(RunGroup::Open, 0, thesis, 100.0, 30.0);
    changed.quantity = "contact damping d";
    changed.value = "300.0 N s/m".to_owned();
    let mut lines = vec![line(RunGroup::Published, 0, thesis, 100.0, 40.0), changed];
    let row = |text: &str| {
        let mut rows = text.lines().filter(|row| row.contains("contact damping d"));
        rows.next().unwrap().to_owned()
    };
    let inside = reproduction(lines.clone());
    assert!(row(&text(&inside)).ends_with("inside"), "{}", text(&inside));
    assert!(
        page(&inside)
            .finish()
            .contains("inside the range of 1 of 1: contact damping d")
    );
    lines[1].row.std = Some(38.0);
    let outside = reproduction(lines.clone());
    assert!(row(&text(&outside)).ends_with("outside"), "{}", text(&outside));
    assert!(page(&outside).finish().contains("inside the range of none of them"));
    lines[1].row = RunRow::default();
    let missing = reproduction(lines);
    assert!(row(&text(&missing)).ends_with("not computed"), "{}", text(&missing));
    assert!(page(&missing).finish().contains("Not computed: contact damping d"));
}
