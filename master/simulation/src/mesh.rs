//! Notes on the mesh of a line.

use scene::{Division, Scene};

/// The mesh of a line and what makes up for its coarseness; empty for a supplied line.
#[must_use]
pub fn described(scene: &Scene) -> String {
    let Some((catenary, _)) = scene.modelled_line() else {
        return String::new();
    };
    let mesh = &catenary.mesh;
    let without: Vec<String> = catenary::mesh::corrections_left_out(scene)
        .into_iter()
        .filter(|(correction, _)| *correction != scene::Correction::DropperCompliance)
        .map(|(correction, reason)| format!("without {correction}: {reason}"))
        .collect();
    let mut text = format!(
        "{} between droppers, {}",
        match mesh.division {
            Division::PerInterval(count) => format!("{count} elements"),
            Division::UpTo(length) => format!("elements of up to {length} m"),
        },
        match mesh.corrections.as_slice() {
            [] => "plain".to_owned(),
            corrections => corrections
                .iter()
                .map(|correction| correction.name())
                .collect::<Vec<_>>()
                .join(" + "),
        }
    );
    if !without.is_empty() && !mesh.corrections.is_empty() {
        text.push_str(&format!(" ({})", without.join("; ")));
    }
    text
}

/// The error that mesh and internal steps of `step` s are expected to make, or why none is known; `None` for a
/// supplied line.
#[must_use]
pub fn expected_error(scene: &Scene, step: f64) -> Option<String> {
    let (catenary, _) = scene.modelled_line()?;
    let (c, v) = (catenary.slowest_wave(), scene.run.speed);
    if v >= c {
        return Some(format!(
            "mesh: the train is faster than the waves of a wire ({v:.1} m/s, {c:.1} m/s): no mesh resolves the waves \
             ahead of it"
        ));
    }
    let f = scene.run.low_pass_hz;
    let mesh = format!(
        "elements up to {:.2} m for waves of {:.2} m that a {f} Hz force sends ahead of the pantograph",
        catenary.longest_element(),
        (c - v) / f
    );
    Some(match catenary::mesh::expected_error_at(scene, step) {
        Err(why) => format!("mesh: {mesh}; no rule is known for its error with {why}"),
        Ok(error) if error.total() >= 30.0 => format!(
            "this mesh is far from converged: {mesh}; the filtered force may be wrong by more than its own standard \
             deviation"
        ),
        Ok(error) => format!(
            "mesh: the filtered force is wrong by about {:.1} % of its standard deviation, {:.1} % by the mesh and \
             {:.1} % by steps of \
             {:.3} ms: {mesh}; by rule, {}",
            error.total(),
            error.space,
            error.time,
            1e3 * step,
            if catenary::mesh::error_goes_by_waves(scene) {
                "good to a factor of two"
            } else {
                "seldom more than twice that, often far less"
            }
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const EN_300: &str = include_str!("../../../scenes/en50318-300.toml");
    const THESIS: &str = include_str!("../../../scenes/thesis-pantograph.toml");

    fn said(text: &str, overrides: &[&str]) -> String {
        let overrides: Vec<String> = overrides.iter().map(ToString::to_string).collect();
        let scene = system::load(text, "scene.toml", &overrides).unwrap();
        expected_error(&scene, scene.internal_step()).unwrap()
    }

    #[test]
    fn a_mesh_is_judged_by_the_waves_around_the_pantograph() {
        assert!(
            said(THESIS, &[]).contains("far from converged"),
            "{}",
            said(THESIS, &[])
        );
        let plain = said(EN_300, &["catenary.mesh.corrections=none"]);
        assert!(plain.contains("wrong by about 4.9 %"), "{plain}");
        let corrected = said(EN_300, &[]);
        assert!(corrected.contains("wrong by about 0.7 %"), "{corrected}");
        assert!(corrected.ends_with("by rule, good to a factor of two"), "{corrected}");
        let low = said(EN_300, &["run.low_pass_hz=10"]);
        assert!(
            low.contains("wrong by about 0.6 %")
                && low.ends_with("by rule, seldom more than twice that, often far less"),
            "{low}"
        );
        let fast = said(
            EN_300,
            &[
                "run.speed_kmh=450",
                "run.allow_supercritical=true",
                "run.duration=4",
                "run.evaluate={time=[1,3]}",
            ],
        );
        assert!(fast.contains("faster than the waves"), "{fast}");
        let undamped = said(EN_300, &["catenary.damping.beta=0"]);
        assert!(
            undamped.contains("no rule is known for its error with catenary.damping.beta = 0 s: must be at least"),
            "{undamped}"
        );
    }

    #[test]
    fn a_step_is_judged_as_it_is_made() {
        let overrides = ["coupling.macro_step={tolerance=1.0}", "solver.micro_step=0.00125"].map(str::to_owned);
        let scene = system::load(EN_300, "scene.toml", &overrides).unwrap();
        for (step, said) in [
            (1.25e-3, "0.3 % by steps of 1.250 ms"),
            (1e-3, "1.3 % by steps of 1.000 ms"),
        ] {
            let text = expected_error(&scene, step).unwrap();
            assert!(text.contains(said), "{text}");
        }
    }

    #[test]
    fn what_a_line_does_without_is_said_with_its_reason() {
        let overrides = ["solver.rho_inf=0.5".to_owned()];
        let scene = system::load(EN_300, "scene.toml", &overrides).unwrap();
        let text = described(&scene);
        assert!(
            text.starts_with(
                "8 elements between droppers, contact_compliance + bending_layers (without \
                mass_correction: solver.rho_inf = 0.5"
            ),
            "{text}"
        );
        let plain = system::load(THESIS, "scene.toml", &[]).unwrap();
        assert_eq!(described(&plain), "1 elements between droppers, plain");
        let even = system::load(THESIS, "scene.toml", &["catenary.mesh.element_length=0.93".to_owned()]).unwrap();
        assert_eq!(described(&even), "elements of up to 0.93 m between droppers, plain");
    }
}
