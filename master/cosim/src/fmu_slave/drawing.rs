//! Pictures of FMUs, drawn from their serialised states.

use component::Component;
use scene::Scene;

use component::Frame;

/// Draws pictures from states that an FMU has serialised.
pub(super) trait Drawing: Send {
    /// Keeps a serialised state, and a place in the picture that it belongs to.
    fn keep(&mut self, bytes: Vec<u8>, frame: &mut Frame);

    /// Draws all states kept.
    fn finish(&mut self, frames: &mut [Frame]);
}

/// A component like the one inside the FMU, which goes to the FMU's states when the run is over.
pub(super) struct CoreDrawing<C: Component> {
    pub scene: Scene,
    pub draw: fn(&mut C, &mut Frame),
    /// Serialised states, each with the place of its pantograph in the picture.
    pub kept: Vec<(Vec<u8>, usize)>,
}

impl<C: Component> Drawing for CoreDrawing<C> {
    fn keep(&mut self, bytes: Vec<u8>, frame: &mut Frame) {
        self.kept.push((bytes, frame.pantographs.len()));
        if C::IDENTIFIER == vehicle::Subsystem::IDENTIFIER {
            frame.pantographs.push(Vec::new());
        }
    }

    fn finish(&mut self, frames: &mut [Frame]) {
        let Ok(mut component) = C::build(&self.scene) else {
            return;
        };
        for ((bytes, place), frame) in self.kept.drain(..).zip(frames) {
            let Some(checkpoint) = fmu::checkpoint::<C>(&bytes) else {
                continue;
            };
            if component.restore(&checkpoint).is_err() {
                continue;
            }
            let mut own = Frame::default();
            (self.draw)(&mut component, &mut own);
            match own.pantographs.pop() {
                Some(outline) => frame.pantographs[place] = outline,
                None => {
                    frame.contact_wire = own.contact_wire;
                    frame.messenger_wire = own.messenger_wire;
                    frame.further_wires = own.further_wires;
                    frame.droppers = own.droppers;
                }
            }
        }
    }
}
