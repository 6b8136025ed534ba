//! The state of a line, taken along when the window moves on.
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
            // Layers are unknowns of supports within the window only; those of a support that was none have followed statically,
            // and are far from the strips.
            let within = |arrangement: &Arrangement| {
                let window = &arrangement.window;
                (window.start..=window.end)
                    .contains(&support)
                    .then(|| &self.places.layers[support - window.start])
            };
            if let (Some(own), Some(other)) = (within(to), within(from)) {
                for (&index, &before) in own.iter().zip(other) {
                    values[index] = old(before);
                }
            }
        }
        for span in to.modelled.clone() {
            let supports = || -> Vec<f64> {
                let ends = [span, span + 1].into_iter();
                ends.flat_map(|support| self.support_motion(from, support, &old))
                    .collect()
            };
            let was_modelled = from.modelled.contains(&span);
            let before = from
                .window
                .contains(&span)
                .then(|| self.places.inner[span - from.at].clone());
            let modes = if was_modelled {
                from.modes[span - from.modelled.start].clone()
            } else {
                0..0
            };
            if to.window.contains(&span) {
                let own = self.places.inner[span - to.at].clone();
                if let Some(before) = before {
                    for (index, before) in own.zip(before) {
                        values[index] = old(before);
                    }
                } else {
                    let modes: Vec<f64> = modes.map(old).collect();
                    let inner = self.cell(span).expand(&supports(), &modes);
                    for (index, value) in own.zip(inner.iter()) {
                        values[index] = *value;
                    }
                }
            } else {
                let own = to.modes[span - to.modelled.start].clone();
                if let Some(before) = before {
                    let inner: Vec<f64> = before.map(old).collect();
                    let share = self.cell(span).project(&supports(), &inner);
                    for (index, value) in own.zip(share.iter()) {
                        values[index] = *value;
                    }
                } else {
                    for (index, before) in own.zip(modes) {
                        values[index] = old(before);
                    }
                }
            }
        }
    }

    /// Motion of a support; beyond what was modelled, the longitudinal one of the nearest support that was.
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
