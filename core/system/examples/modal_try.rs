use component::exchange::contact;
use system::one_system::OneSystem;
fn main() {
    let mut args = std::env::args().skip(1);
    let path = args.next().unwrap();
    let out = args.next().unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let sets: Vec<String> = args.collect();
    let mut scene = system::load(&text, &path, &sets).unwrap();
    let begin = std::time::Instant::now();
    let statics = catenary::static_line(&scene).unwrap();
    system::equilibrium::resolve(&mut scene, &statics).unwrap();
    let t_static = begin.elapsed().as_secs_f64();
    let mut whole = OneSystem::new(&scene, &statics, &[5, 6, 7]).unwrap();
    let setup = begin.elapsed().as_secs_f64();
    let h = scene.internal_step();
    let steps = (scene.run.duration / h).round() as usize;
    let start = whole.point(0.0);
    let mut points = [start.clone(), start];
    let mut csv = String::from("time,contact[1].force\n");
    let begin = std::time::Instant::now();
    let mut forces = Vec::new();
    for n in 0..steps {
        whole.advance(n as f64 * h, h, &mut points, &mut |_, p| forces.push((p.t, p.contact(0)[contact::FORCE]))).unwrap();
    }
    let wall = begin.elapsed().as_secs_f64();
    for (t, f) in forces { csv.push_str(&format!("{t},{f}\n")); }
    std::fs::create_dir_all(&out).unwrap();
    std::fs::write(format!("{out}/timeseries.csv"), csv).unwrap();
    let work = whole.work();
    std::fs::write(format!("{out}/summary.json"), format!("{{\"cost\":{{\"real_time_factor\":{},\"setup_s\":{},\"wall_s\":{},\"newton_iterations\":{}}}}}", wall / (steps as f64 * h), setup, t_static, work.newton_iterations)).unwrap();
}
