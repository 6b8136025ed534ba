//! Transfer of the state when the window moves on.
use super::Fixed;
use super::plan::Arrangement;
use dynamics::State;

impl Fixed {
    /// Moves all motions from the coordinates of one arrangement to those of another one.
    pub(super) fn transfer(&self, from: &Arrangement, to: &Arrangement, state: &mut State) {
        for values in [&mut state.q, &mut state.v, &mut state.v_dot, &mut state.a] {
            self.transfer_one(from, to, values);
        }
    }

    fn transfer_one(&self, from: &Arrangement, to: &Arrangement, values: &mut [f64]) {
        let old = values[self.coordinates.clone()].to_vec();
        let old = |index: usize| old[index - self.coordinates.start];
        values[self.coordinates.clone()].fill(0.0);

        for support in to.modelled.start..=to.modelled.end {
            let motion = self.support_motion(from, support, &old);
            let places = self.support(to, support).into_iter().flatten();
            for (index, value) in places.zip(motion) {
                values[index] = value;
            }
        }
        for span in to.modelled.clone() {
            let supports = || -> Vec<f64> {
                let ends = [span, span + 1].into_iter();
                ends.flat_map(|support| self.support_motion(from, support, &old))
                    .collect()
            };
            let before = from
                .window
                .contains(&span)
                .then(|| self.places.inner[span - from.at].clone().map(old));
            // Beyond the modelled spans nothing stretched and no mode moved.
            let (elongations, modes) = from.own(span).unwrap_or_default();
            if to.window.contains(&span) {
                let within = span - to.at;
                let inner = self.places.inner[within].clone();
                if let Some(before) = before {
                    inner.zip(before).for_each(|(index, value)| values[index] = value);
                } else {
                    let mut interface = supports();
                    interface.extend(elongations.map(old));
                    interface.resize(2 * self.plan.at_support + self.plan.elongations, 0.0);
                    let modes: Vec<f64> = modes.map(old).collect();
                    let between = self.cell(span).expand(&interface, &modes);
                    let layers = self.places.layers[within..=within + 1].iter().zip(between.end_layers);
                    let layers = layers.flat_map(|(places, motion)| places.iter().copied().zip(motion));
                    for (index, value) in inner.zip(between.inner).chain(layers) {
                        values[index] = value;
                    }
                }
            } else if let Some((own_elongations, own_modes)) = to.own(span) {
                if let Some(before) = before {
                    let before: Vec<f64> = before.collect();
                    let (stretched, share) = self.cell(span).project(&supports(), &before);
                    let places = own_elongations.chain(own_modes);
                    for (index, value) in places.zip(stretched.into_iter().chain(share.iter().copied())) {
                        values[index] = value;
                    }
                } else {
                    for (index, before) in own_elongations.zip(elongations).chain(own_modes.zip(modes)) {
                        values[index] = old(before);
                    }
                }
            }
        }
        // Layers at supports that both windows have inside; those at the ends of windows belong to the reduced spans
        // there.
        let inside = |arrangement: &Arrangement| arrangement.window.start + 1..arrangement.window.end;
        for support in inside(to).filter(|support| inside(from).contains(support)) {
            let [own, before] = [to, from].map(|arrangement| &self.places.layers[support - arrangement.at]);
            for (&index, &before) in own.iter().zip(before) {
                values[index] = old(before);
            }
        }
    }

    /// Motion of a support; beyond the modelled spans the longitudinal motion of the nearest modelled support.
    fn support_motion(&self, from: &Arrangement, support: usize, old: &dyn Fn(usize) -> f64) -> Vec<f64> {
        let nearest = support.clamp(from.modelled.start, from.modelled.end);
        let places = self.support(from, nearest).into_iter().flatten();
        let per_node = self.plan.at_support / 2;
        let known = |(i, index): (usize, usize)| {
            let longitudinal = i % per_node == 0;
            if nearest == support || longitudinal {
                old(index)
            } else {
                0.0
            }
        };
        places.enumerate().map(known).collect()
    }
}
