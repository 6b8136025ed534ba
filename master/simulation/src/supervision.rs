//! A second process where FMUs of others run in this one.

use fmi2::scratch::Scratch;
use scene::Scene;

/// Has a scene with supplied FMUs that run in this process worked on by a child, which this process then watches; see
/// [`fmi2::supervision`]. `unpacked` is the folder of the archive that the scene was made of. To be called before
/// anything is written.
pub fn supervise(scene: &Scene, unpacked: &mut Option<Scratch>) {
    let in_process = scene.supplied_sides().filter(|side| !side.isolate);
    let fmus: Vec<String> = in_process.map(|side| side.fmu.clone()).collect();
    fmi2::supervision::supervise(&fmus, unpacked);
}
