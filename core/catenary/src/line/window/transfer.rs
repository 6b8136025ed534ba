//! Transfer of the state when the window moves on.
use super::places::SpanPlaces;
use super::plan::Arrangement;
use super::{Fixed, coordinates_per_node};
use crate::NodeOfWire;
use dynamics::State;
use std::ops::Range;

/// An arrangement and the positions of the coordinates of its window.
pub(super) type Placed<'a> = (&'a Arrangement, &'a SpanPlaces);

impl Fixed {
    /// Moves all motions from the coordinates of one arrangement to those of another one.
    pub(super) fn transfer(&self, from: Placed<'_>, to: Placed<'_>, state: &mut State) {
        for values in [&mut state.q, &mut state.v, &mut state.v_dot, &mut state.a] {
            self.transfer_one(from, to, values);
        }
    }

    fn transfer_one(&self, from_placed: Placed<'_>, to_placed: Placed<'_>, values: &mut [f64]) {
        let ((from, from_places), (to, to_places)) = (from_placed, to_placed);
        let old = values[self.coordinates.clone()].to_vec();
        let old = |index: usize| old[index - self.coordinates.start];
        values[self.coordinates.clone()].fill(0.0);

        for support in to.modelled.start..=to.modelled.end {
            let motion = self.support_motion(from_placed, support, &old);
            let places = to.support(to_places, support).into_iter().flatten();
            for (index, value) in places.zip(motion) {
                values[index] = value;
            }
        }
        let interface_size =
            |span: usize| self.at_support(span) + self.at_support(span + 1) + self.elongations_of(span);
        for span in to.modelled.clone() {
            let supports = || -> Vec<f64> {
                let ends = [span, span + 1].into_iter();
                ends.flat_map(|support| self.support_motion(from_placed, support, &old))
                    .collect()
            };
            let before = from
                .window
                .contains(&span)
                .then(|| from_places.inner[span - from.at].clone().map(old));
            // Beyond the modelled spans nothing stretched and no mode moved.
            let (elongations, modes) = from.own(span).unwrap_or_default();
            if to.window.contains(&span) {
                let within = span - to.at;
                let inner = to_places.inner[within].clone();
                if let Some(before) = before {
                    inner.zip(before).for_each(|(index, value)| values[index] = value);
                } else {
                    let mut interface = supports();
                    interface.extend(elongations.map(old));
                    interface.resize(interface_size(span), 0.0);
                    let modes: Vec<f64> = modes.map(old).collect();
                    let between = self.cell(span).expand(&interface, &modes);
                    let layers = to_places.layers[within..=within + 1].iter().zip(between.end_layers);
                    let layers = layers.flat_map(|(places, motion)| places.iter().copied().zip(motion));
                    for (index, value) in inner.zip(between.inner).chain(layers) {
                        values[index] = value;
                    }
                }
            } else if let Some((own_elongations, own_modes)) = to.own(span) {
                if let Some(before) = before {
                    let before: Vec<f64> = before.collect();
                    let (stretched, shares) = self.cell(span).project(&supports(), &before);
                    let shares = self.cell(span).by_part(own_modes).zip(&shares);
                    let of_modes = shares.flat_map(|(modes, share)| modes.zip(share.iter().copied()));
                    for (index, value) in own_elongations.zip(stretched).chain(of_modes) {
                        values[index] = value;
                    }
                } else {
                    let of_part = |modes: Range<usize>| self.cell(span).by_part(modes);
                    let modes = of_part(own_modes).zip(of_part(modes));
                    let modes = modes.flat_map(|(own, before)| own.zip(before));
                    for (index, before) in own_elongations.zip(elongations).chain(modes) {
                        values[index] = old(before);
                    }
                }
            }
        }
        // Layers at supports that both windows have inside; those at the ends of windows belong to the reduced spans
        // there.
        let inside = |arrangement: &Arrangement| arrangement.window.start + 1..arrangement.window.end;
        for support in inside(to).filter(|support| inside(from).contains(support)) {
            let [own, before] =
                [to_placed, from_placed].map(|(arrangement, places)| &places.layers[support - arrangement.at]);
            for (&index, &before) in own.iter().zip(before) {
                values[index] = old(before);
            }
        }
    }

    /// Motion of a support; beyond the modelled spans the longitudinal motion of the nearest modelled support.
    fn support_motion(&self, (from, places): Placed<'_>, support: usize, old: &dyn Fn(usize) -> f64) -> Vec<f64> {
        let nearest = support.clamp(from.modelled.start, from.modelled.end);
        let places = from.support(places, nearest).into_iter().flatten();
        if nearest == support {
            return places.map(old).collect();
        }
        let per_node = coordinates_per_node(self.topology.options().dimension);
        let places: Vec<usize> = places.collect();
        let wire = |at: NodeOfWire| {
            let planned = &self.topology.wires()[at.wire];
            (planned.section, planned.name, planned.offset)
        };
        let mut motion = vec![0.0; self.at_support(support)];
        for (at, motion) in self.nodes_at(support).zip(motion.chunks_exact_mut(per_node)) {
            let same = self.nodes_at(nearest).position(|other| wire(other) == wire(at));
            motion[0] = same.map_or(0.0, |node| old(places[node * per_node]));
        }
        motion
    }
}
