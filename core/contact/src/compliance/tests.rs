use super::*;

const SECTION: WireSection = WireSection {
    axial_stiffness: 1.7e7,
    bending_stiffness: 195.0,
    mass_per_length: 1.35,
    tension: 20_000.0,
};

/// Spans of 20 m with attachments at unequal intervals, `n` elements in each, with bending layers or without.
fn wire(spans: usize, n: usize, layered: bool) -> WireGeometry {
    let (mut lengths, mut layers) = (Vec::new(), vec![0.0]);
    for interval in [4.0, 6.0, 5.0, 5.0].repeat(spans) {
        lengths.extend(vec![interval / n as f64; n]);
        layers.extend(vec![0.0; n - 1]);
        layers.push(if layered { (195.0_f64 / 20_000.0).sqrt() } else { 0.0 });
    }
    layers.pop();
    layers.push(0.0);
    straight(&lengths, &layers)
}

/// Residual compliance from the whole wire at once.
fn of_the_whole_wire(geometry: &WireGeometry, beam: Beam, s: f64) -> f64 {
    let size = 2 * geometry.nodes().len() + geometry.enrichments().len();
    let mut stiffness = transverse_stiffness(geometry, beam, size);
    let mut columns = CurveColumns::default();
    geometry.columns(s, &mut columns);
    let mut n = DVector::zeros(size);
    for column in columns.as_slice() {
        n[column.index] += column.n.z;
    }
    for end in [0, 2 * geometry.lengths().len()] {
        stiffness.row_mut(end).fill(0.0);
        stiffness.column_mut(end).fill(0.0);
        stiffness[(end, end)] = 1.0;
        n[end] = 0.0;
    }
    let answer = stiffness.cholesky().expect("positive").solve(&n);
    beam.under_force(s, geometry.length()).value - n.dot(&answer)
}

fn beam(speed: f64) -> Beam {
    let tension = SECTION.tension - SECTION.mass_per_length * speed * speed;
    Beam {
        tension,
        bending_length: (SECTION.bending_stiffness / tension).sqrt(),
    }
}

/// Places all over a length, at no regular distance from nodes.
fn places(length: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| length * (i as f64 + 0.5 + 0.3 * (i as f64).sin()) / count as f64)
}

#[test]
fn a_patch_gives_the_residual_compliance_of_the_whole_wire() {
    for (n, layered, speed) in [(1, false, 0.0), (2, true, 70.0), (4, true, 90.0), (8, false, 83.0)] {
        let geometry = wire(3, n, layered);
        let compliance = ResidualCompliance::new(&geometry, &SECTION, speed).expect("below the wave speed");
        let largest = places(60.0, 200).map(|s| compliance.at(s).value).fold(0.0, f64::max);
        for s in places(60.0, 40) {
            let (ours, whole) = (compliance.at(s).value, of_the_whole_wire(&geometry, beam(speed), s));
            // Elements that are alike differ by 1e-4 of their length.
            assert!(
                (ours - whole).abs() < 2e-4 * largest,
                "n = {n}, layers {layered}, s = {s}: {ours} {whole} of {largest}"
            );
        }
    }
}

#[test]
fn a_mesh_is_never_softer_than_the_wire() {
    for (n, layered) in [(1, false), (1, true), (3, true), (8, true)] {
        let geometry = wire(2, n, layered);
        let speeds = [0.0, 50.0, 83.0, 118.0];
        let largest = speeds.map(|speed| {
            let compliance = ResidualCompliance::new(&geometry, &SECTION, speed).expect("below the wave speed");
            // `at` cuts at zero, so that the sign is seen before.
            let values = places(40.0, 500).map(|s| {
                let element = geometry.element_at(s);
                let patch = &compliance.patches[compliance.patch[element.0] as usize];
                patch.at(element.1).value
            });
            let (least, most) = values.fold((f64::INFINITY, 0.0_f64), |(a, b), g| (a.min(g), b.max(g)));
            assert!(least > -1e-5 * most, "n = {n}, {speed} m/s: {least} of {most}");
            most
        });
        assert!(
            largest.is_sorted(),
            "the tension that the force feels falls with its speed"
        );
    }
    assert!(ResidualCompliance::new(&wire(1, 1, false), &SECTION, 121.8).is_none());
}

#[test]
fn the_slope_is_the_derivative_and_there_is_no_jump_between_elements() {
    let geometry = wire(2, 4, true);
    let compliance = ResidualCompliance::new(&geometry, &SECTION, 83.0).expect("below the wave speed");
    let value = |s: f64| compliance.at(s).value;
    let largest = places(40.0, 500)
        .map(|s| compliance.at(s).slope.abs())
        .fold(0.0, f64::max);
    let h = 1e-5;
    for s in places(40.0, 300) {
        let quotient = (value(s + h) - value(s - h)) / (2.0 * h);
        assert!((quotient - compliance.at(s).slope).abs() < 1e-3 * largest, "s = {s}");
    }
    for node in 1..geometry.nodes().len() - 1 {
        let s = geometry.node_s(node);
        let (before, after) = (compliance.at(s - 1e-9), compliance.at(s));
        assert!((before.value - after.value).abs() < 1e-4 * largest, "node {node}");
        // Elements bend at a node, the wire does not: the slope is continuous too, but for the tolerance of equal
        // elements.
        assert!((before.slope - after.slope).abs() < 2e-3 * largest, "node {node}");
    }
}

#[test]
fn equal_spans_share_their_patches() {
    let [few, many] = [6, 300]
        .map(|spans| ResidualCompliance::new(&wire(spans, 4, true), &SECTION, 70.0).expect("below the wave speed"));
    assert_eq!(many.patches(), few.patches());
    for s in places(20.0, 50) {
        let (a, b) = (many.at(60.0 + s), many.at(20.0 * 200.0 + s));
        assert!((a.value - b.value).abs() < 1e-11 * a.value, "{a:?} {b:?}");
    }
}

#[test]
fn finer_elements_and_layers_leave_less() {
    let largest = |n: usize, layered: bool| {
        let compliance = ResidualCompliance::new(&wire(3, n, layered), &SECTION, 83.0).expect("below the wave speed");
        places(60.0, 600).map(|s| compliance.at(s).value).fold(0.0, f64::max)
    };
    // The deficit of a string's kink is in proportion to the elements' length; that of the bend that rounds it off is
    // not.
    let order = ((largest(1, false) - largest(2, false)) / (largest(2, false) - largest(4, false))).log2();
    assert!((order - 1.0).abs() < 0.1, "{order}");
    assert!(largest(64, false) < 0.02 * largest(8, false));
    // Nothing is left of a static force at a node with a layer.
    let compliance = ResidualCompliance::new(&wire(3, 4, true), &SECTION, 0.0).expect("at rest");
    assert!(
        compliance.at(24.0).value < 1e-3 * largest(4, true),
        "{:?}",
        compliance.at(24.0)
    );
}

#[test]
fn along_another_piece_of_the_wire_it_is_what_a_new_one_is_to_the_last_bit() {
    let known = ResidualCompliance::new(&wire(3, 4, true), &SECTION, 70.0).expect("below the wave speed");
    let other = wire(5, 4, true);
    let (again, new) = (
        known.along(&other),
        ResidualCompliance::new(&other, &SECTION, 70.0).expect("below the wave speed"),
    );
    for s in places(other.length(), 200) {
        assert_eq!(again.at(s), new.at(s), "{s}");
    }
    assert_eq!(again.patches(), new.patches(), "nothing is kept that it has no use for");
}
