//! Line and pantograph of a scene as two components, stepped in turn by this program.

use component::{Component, of_pantograph};
use system::equilibrium;

const SCENE: &str = include_str!("../../scenes/en50318-300.toml");
const STEP: f64 = 0.001; // s
const DURATION: f64 = 3.0; // s
const EVALUATED_FROM: f64 = 2.0; // s

/// Values that the line takes from the strip, and the mean forces that the strip takes from the line.
const STRIP: [&str; 7] = ["x", "y", "z", "vx", "vy", "vz", "roll"];
const LOAD: [(&str, &str); 4] = [("mean_fx", "fx"), ("mean_fy", "fy"), ("mean_fz", "fz"), ("y", "y")];

/// Position of a signal of component `C` by its name.
fn signal<C: Component>(scene: &scene::Scene, name: &str) -> usize {
    let signals = C::signals(scene);
    let found = signals.iter().position(|signal| signal.name == name);
    found.unwrap_or_else(|| panic!("{} has no signal {name}", C::IDENTIFIER))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = system::load(SCENE, "en50318-300.toml", &[])?;
    let statics = catenary::static_line(&scene)?;
    equilibrium::resolve(&mut scene, &statics)?;
    let alone = of_pantograph(&scene, 0);
    let mut line = catenary::Subsystem::build(&scene)?;
    let mut pantograph = vehicle::Subsystem::build(&alone)?;

    let strip = STRIP.map(|name| {
        let name = format!("strip[1].{name}");
        (
            signal::<vehicle::Subsystem>(&alone, &name),
            signal::<catenary::Subsystem>(&scene, &name),
        )
    });
    let load = LOAD.map(|(from, to)| {
        (
            signal::<catenary::Subsystem>(&scene, &format!("contact[1].{from}")),
            signal::<vehicle::Subsystem>(&alone, &format!("contact[1].{to}")),
        )
    });
    let force = signal::<catenary::Subsystem>(&scene, "contact[1].force");

    let mut forces = Vec::new();
    for n in 0..(DURATION / STEP).round() as usize {
        let t = n as f64 * STEP;
        for (from, to) in strip {
            line.set_input(to, pantograph.output(from));
        }
        line.do_step(t, STEP)?;
        for (from, to) in load {
            pantograph.set_input(to, line.output(from));
        }
        pantograph.do_step(t, STEP)?;
        if t >= EVALUATED_FROM {
            forces.push(line.output(force));
        }
    }
    let mean = forces.iter().sum::<f64>() / forces.len() as f64;
    let variance = forces.iter().map(|force| (force - mean).powi(2)).sum::<f64>() / forces.len() as f64;
    println!(
        "contact force, unfiltered: mean {mean:.1} N, std {:.1} N",
        variance.sqrt()
    );
    Ok(())
}
