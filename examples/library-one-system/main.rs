//! A line and a pantograph built in Rust and run as one system; prints the statistics of the contact force.

use catenary::static_line;
use component::exchange::contact;
use scene::{
    Catenary, Contact, Damping, Division, Droppers, Evaluate, Lumped, Mesh, RegistrationArms, Run, Scene, Supports,
    TensionLength, Wire,
};
use system::{equilibrium, one_system::OneSystem};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let line = Catenary::new(
        TensionLength::new(vec![60.0; 8], 5.3, 1.2), // m
        (
            Wire::new(1.35, 20_000.0, 1.7e7, 195.0), // kg/m, N, N, N m^2
            Wire::new(1.07, 16_000.0, 1.1e7, 131.7),
        ),
        Droppers::new(&[5.0, 10.5, 17.0, 23.5, 30.0, 36.5, 43.0, 49.5, 55.0], 1e5), // m, N/m
        (Supports::new(5e5, 5e5, 0.0), RegistrationArms::new(0.0, 5e5, 0.0)),
        Damping::new(0.0125, 1e-4),
        Mesh::plain(Division::PerInterval(8)),
    );
    let head = Lumped::new(1.2, 120.0, &[7.2, 15.0], &[4200.0, 50.0], &[10.0, 90.0]); // m, N, kg, N/m, N s/m
    let run = Run::new(250.0 / 3.6, 5.0, 20.0, Evaluate::Spans { first: 4, last: 5 }); // m/s, s, m
    let contact = Contact::penalty(5e4, 0.0); // N/m, N s/m
    let scene = Scene::new("Built in Rust", run, (line, contact), vec![head.into()]);
    let mut scene = scene.checked()?;

    let statics = static_line(&scene)?;
    equilibrium::resolve(&mut scene, &statics)?;
    let mut system = OneSystem::new(&scene, &statics, &[])?;
    let mut points = [system.point(0.0), system.point(0.0)];
    let (from, to) = scene.evaluation_time(0);
    let (h, mut forces) = (scene.coupling.macro_step, Vec::new());
    for n in 0..(scene.run.duration / h).round() as usize {
        system.advance(n as f64 * h, h, &mut points, &mut |_, now| {
            if (from..=to).contains(&now.t) {
                forces.push(now.contact(0)[contact::FORCE]);
            }
        })?;
    }
    let mean = forces.iter().sum::<f64>() / forces.len() as f64;
    let square = forces.iter().map(|force| (force - mean).powi(2)).sum::<f64>() / forces.len() as f64;
    println!(
        "contact force, unfiltered: mean {mean:.1} N, std {:.1} N",
        square.sqrt()
    );
    Ok(())
}
