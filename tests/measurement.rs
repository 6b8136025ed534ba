//! Force of a measuring pantograph on the line of EN 50318 against the contact force of the same run.
//!
//! The force below the head is computed here anew, from the recorded motion of the strip: mass 2 is integrated under
//! it, and the spring between both masses is what load cells below the head feel. No code is shared with the
//! pantograph.

use std::f64::consts::PI;

use integration_tests::runs::{EN_300, Run, rms, run, scene_with};
use simulation::Mode;

/// Pantograph of EN 50318:2002: kg, N/m, N s/m.
const MASSES: [f64; 2] = [7.2, 15.0];
const STIFFNESSES: [f64; 2] = [4200.0, 50.0];
const DAMPINGS: [f64; 2] = [10.0, 90.0];

fn measured(instruments: &str) -> Run {
    let (scene, ranges) = EN_300.split_once("[ranges]").unwrap();
    let text = format!("{scene}\n[measurement]\n{instruments}\n[ranges]{ranges}");
    let mut scene = scene_with(
        &text,
        &["catenary.spans=8", "catenary.mesh.corrections=[]", "run.duration=5"],
    );
    scene.run.duration = scene.evaluation_time(0).1 + 0.3;
    run(scene, Mode::Monolithic, "measurement")
}

/// Force of the spring below the head at every sample, N.
fn force_below_the_head(run: &Run) -> Vec<f64> {
    let strip = &run.record.pantographs[0];
    let step = run.summary.evaluation.output_step;
    let (z, v) = (&strip.strip_z, &strip.strip_vz);
    let spring = |[rise, rate]: [f64; 2], z1: f64, v1: f64| {
        strip.force[0] + STIFFNESSES[0] * (rise - z1) + DAMPINGS[0] * (rate - v1)
    };
    let slope = |state: [f64; 2], z1: f64, v1: f64| {
        let below = STIFFNESSES[1] * state[0] + DAMPINGS[1] * state[1];
        [state[1], (strip.force[0] - spring(state, z1, v1) - below) / MASSES[1]]
    };
    let mut state = [0.0; 2];
    let mut found = vec![spring(state, 0.0, v[0])];
    for k in 1..z.len() {
        // Half way: cubic through heights and velocities, and its slope.
        let (from, to) = (z[k - 1] - z[0], z[k] - z[0]);
        let middle = 0.5 * (from + to) + step / 8.0 * (v[k - 1] - v[k]);
        let rate = 1.5 * (to - from) / step - 0.25 * (v[k - 1] + v[k]);
        let by = |slope: [f64; 2], h: f64| [state[0] + h * slope[0], state[1] + h * slope[1]];
        let k1 = slope(state, from, v[k - 1]);
        let k2 = slope(by(k1, 0.5 * step), middle, rate);
        let k3 = slope(by(k2, 0.5 * step), middle, rate);
        let k4 = slope(by(k3, step), to, v[k]);
        for i in 0..2 {
            state[i] += step / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
        found.push(spring(state, to, v[k]));
    }
    found
}

/// rms of the difference of two filtered forces in the evaluation range, in percent of the deviation of the first.
fn difference(run: &Run, truth: &[f64], other: &[f64]) -> f64 {
    let evaluation = &run.summary.evaluation;
    let range = evaluation.samples(&run.record.time, 0);
    let [truth, other] = [truth, other].map(|force| evaluation.filtered(force).unwrap()[range.clone()].to_vec());
    let std = run.summary.pantographs[0].contact_force.filtered.unwrap().std;
    100.0 * rms(&truth, &other) / std
}

#[test]
fn a_rigid_head_measures_the_contact_force_to_one_percent_and_one_that_bends_is_off_by_its_gain() {
    let rigid = measured("strip_mass = 7.2\nsampling_hz = 500");
    let strip = &rigid.record.pantographs[0];
    let below = force_below_the_head(&rigid);
    let step = rigid.summary.evaluation.output_step;
    let acceleration = |k: usize| (strip.strip_vz[k + 1] - strip.strip_vz[k - 1]) / (2.0 * step);
    let last = below.len() - 1;
    let balance = |k: usize| match k {
        0 => below[0],
        k if k == last => below[last],
        k => below[k] - MASSES[0] * acceleration(k),
    };
    let cells_and_accelerometers: Vec<f64> = (0..=last).map(balance).collect();
    let by_springs = difference(&rigid, &strip.force, &cells_and_accelerometers);
    assert!(by_springs < 1.0, "{by_springs} % of σ");
    // Without the accelerometers the same cells are far off: the test can fail.
    assert!(difference(&rigid, &strip.force, &below) > 10.0);

    let emulated = rigid.summary.pantographs[0].measured.as_ref().unwrap();
    assert!(emulated.error_percent_of_std.unwrap() < 1.0, "{emulated:?}");
    assert!(emulated.gains.iter().all(|gain| gain.gain == 1.0));

    let bends = measured("strip_mass = 4.0\nbending_frequency = 60.0");
    let emulated = bends.summary.pantographs[0].measured.as_ref().unwrap();
    let at = |hz: f64| emulated.gains.iter().find(|gain| gain.frequency_hz == hz).unwrap().gain;
    // 1 + (4/π) r²/(1 − r²) with r = f/60 Hz, damping of 2 % apart.
    for (hz, expected) in [(20.0, 1.0 + 0.5 / PI), (10.0, 1.0 + 4.0 / 35.0 / PI)] {
        assert!((at(hz) - expected).abs() < 3e-4, "{hz} Hz: {emulated:?}");
    }
    let error = emulated.error_percent_of_std.unwrap();
    assert!(
        error > 1.0 && error < 16.0,
        "{error} % of σ: more than rigid, less than the gain at 20 Hz alone"
    );
}
