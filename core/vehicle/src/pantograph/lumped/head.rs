//! Head of a lumped pantograph: strips on its first mass.
use super::HeadMarker;
use super::chain::{ChainElement, ChainMasses};
use dynamics::{Force, Layout};
use scene::HeadStrip;

/// Strips on the first mass of a chain.
///
/// ```text
/// z_k = h + q₀ − x_k θ                      strips fixed to a head that rises by q₀ and pitches by θ
/// I θ̈ + c θ̇ + k θ = Σ F_k x_k               positive where the front is lowered
///
/// m_k z̈_k = P_k + k_k (q₀ − q_k) + c_k (q̇₀ − q̇_k) − F_k,   P_k = F₀ k_k/Σ k        strips on springs
/// ```
///
/// The kinematics of small angles are taken as exact: strips stay at `x_k` and at right angles to the track. `F₀` is
/// the contact force at rest at the reference height, at which all strips stand at one height. (derived here)
#[derive(Clone, Debug)]
pub struct Head {
    /// First mass of the chain, in the middle of the head.
    pub middle: HeadMarker,
    strips: Vec<HeadMarker>,
    freedom: Freedom,
    masses: Option<ChainMasses>,
    elements: Vec<ChainElement>,
}

/// Motion of strips against the first mass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Freedom {
    /// All strips rise with the first mass.
    None,
    /// One coordinate more: the angle of the head.
    Pitch,
    /// One coordinate more per strip: its rise.
    Springs,
}

/// Head at rest over given heights of its strips.
pub struct HeadAtRest {
    /// Rise of the first mass, m.
    pub rise: f64,
    /// Coordinates of the head: the angle in rad, or the rises of the strips in m.
    pub q: Vec<f64>,
}

impl Head {
    /// Adds the coordinates of the head to `layout`; `reference_force` (N) is the contact force at rest at the height
    /// of `middle`.
    pub fn new(
        entry: &scene::Lumped,
        middle: HeadMarker,
        reference_force: f64,
        name: &str,
        layout: &mut Layout,
    ) -> Self {
        let mut head = Self {
            middle,
            strips: vec![middle],
            freedom: Freedom::None,
            masses: None,
            elements: Vec::new(),
        };
        if entry.strips.is_empty() {
            return head;
        }
        let at = |strip: &HeadStrip| HeadMarker { x: strip.x, ..middle };
        head.strips = entry.strips.iter().map(at).collect();
        let springs: Vec<_> = entry.strips.iter().filter_map(|strip| strip.spring).collect();
        if let Some(all) = entry.strip_stiffness() {
            let first = layout.add_coordinates(springs.len(), format!("{name}, strip"));
            for (coordinate, (strip, spring)) in (first..).zip(head.strips.iter_mut().zip(&springs)) {
                strip.coordinate = coordinate;
                let preload = reference_force * spring.stiffness / all;
                let below = Some(middle.coordinate);
                let element = ChainElement::new(coordinate, below, spring.stiffness, spring.damping, preload);
                head.elements.push(element);
            }
            head.masses = Some(ChainMasses {
                first,
                masses: springs.iter().map(|spring| spring.mass).collect(),
                static_force: 0.0,
            });
            head.freedom = Freedom::Springs;
        } else if let Some(pitch) = entry.pitch {
            let angle = layout.add_coordinates(1, format!("{name}, pitch of the head"));
            for strip in &mut head.strips {
                strip.pitch = Some(angle);
            }
            head.elements = vec![ChainElement::new(angle, None, pitch.stiffness, pitch.damping, 0.0)];
            head.masses = Some(ChainMasses {
                first: angle,
                masses: vec![pitch.inertia],
                static_force: 0.0,
            });
            head.freedom = Freedom::Pitch;
        }
        head
    }

    /// Strips in order.
    pub fn strips(&self) -> &[HeadMarker] {
        &self.strips
    }

    /// Number of coordinates besides the first mass.
    pub fn coordinates(&self) -> usize {
        self.elements.len()
    }

    /// Masses of strips on springs, whose coordinates follow those of the chain, kg.
    pub fn sprung_masses(&self) -> &[f64] {
        match (&self.masses, self.freedom) {
            (Some(masses), Freedom::Springs) => &masses.masses,
            _ => &[],
        }
    }

    /// Moves all strips to `lateral` m from the middle of the track.
    pub fn set_lateral(&mut self, lateral: f64) {
        self.middle.lateral = lateral;
        for strip in &mut self.strips {
            strip.lateral = lateral;
        }
    }

    /// Visits the forces of the head in a fixed order.
    pub fn forces(&mut self, visit: &mut dyn FnMut(&mut dyn Force)) {
        if let Some(masses) = &mut self.masses {
            visit(masses);
        }
        for element in &mut self.elements {
            visit(element);
        }
    }

    /// Changes of the strips' heights (m, one per strip) that the head allows, one row for each.
    pub fn rises(&self) -> Vec<Vec<f64>> {
        let together = vec![1.0; self.strips.len()];
        match self.freedom {
            Freedom::None => vec![together],
            Freedom::Pitch => vec![together, self.strips.iter().map(|strip| -strip.x).collect()],
            Freedom::Springs => {
                let one = |k: usize| (0..self.strips.len()).map(|l| f64::from(u8::from(k == l))).collect();
                (0..self.strips.len()).map(one).collect()
            }
        }
    }

    /// Coordinates of a level head whose first mass rises by `rise` m under a contact force of `excess` N more than in
    /// the reference state.
    pub fn level(&self, rise: f64, excess: f64) -> Vec<f64> {
        match self.freedom {
            Freedom::None => Vec::new(),
            Freedom::Pitch => vec![0.0],
            Freedom::Springs => vec![rise - excess / self.total_stiffness(); self.strips.len()],
        }
    }

    /// The head with its strips at these rises above the reference height, m, as far as it allows them; the chain under
    /// the head gives way by `compliance` (m/N, none for a chain that gives way at no force), `uplift` N act on the
    /// first mass.
    ///
    /// ```text
    /// rigid:    q₀ = mean of the rises;  with pitch, the straight line of least squares through them
    /// springs:  Σ k_k (q₀ − q_k) = A − q₀/C                balance of the first mass
    /// ```
    pub fn at_rises(&self, rises: &[f64], compliance: Option<f64>, uplift: f64) -> HeadAtRest {
        let mean = mean(rises.iter().copied());
        match self.freedom {
            Freedom::None => HeadAtRest {
                rise: mean,
                q: Vec::new(),
            },
            Freedom::Pitch => {
                let (middle, square) = self.spread();
                let strips = self.strips.iter().zip(rises);
                let slope: f64 = strips.map(|(strip, rise)| (strip.x - middle) * (rise - mean)).sum();
                let angle = -slope / square;
                HeadAtRest {
                    rise: mean + middle * angle,
                    q: vec![angle],
                }
            }
            Freedom::Springs => {
                let springs = self.elements.iter().zip(rises);
                let carried: f64 = springs.map(|(spring, rise)| spring.stiffness * rise).sum();
                let of_chain = compliance.map_or(0.0, |compliance| 1.0 / compliance);
                HeadAtRest {
                    rise: (carried + uplift) / (self.total_stiffness() + of_chain),
                    q: rises.to_vec(),
                }
            }
        }
    }

    /// Contact forces of the strips at rest, N, under `total` (N) with the head as in `at_rest`. Where the head leaves
    /// their division open, they differ in proportion to the distance of the strips.
    pub fn strip_forces(&self, at_rest: &HeadAtRest, total: f64) -> Vec<f64> {
        let count = self.strips.len() as f64;
        match self.freedom {
            Freedom::None => vec![total / count; self.strips.len()],
            Freedom::Pitch => {
                let (middle, square) = self.spread();
                let moment = self.elements[0].stiffness * at_rest.q[0];
                let slope = (moment - total * middle) / square;
                let force = |strip: &HeadMarker| total / count + slope * (strip.x - middle);
                self.strips.iter().map(force).collect()
            }
            Freedom::Springs => {
                let springs = self.elements.iter().zip(&at_rest.q);
                springs
                    .map(|(spring, rise)| spring.preload + spring.stiffness * (at_rest.rise - rise))
                    .collect()
            }
        }
    }

    /// Adds the rise of the base, m, to the coordinates of the head.
    pub fn lift(&self, q: &mut [f64], rise: f64) {
        if self.freedom == Freedom::Springs {
            q.iter_mut().for_each(|q| *q += rise);
        }
    }

    fn total_stiffness(&self) -> f64 {
        self.elements.iter().map(|element| element.stiffness).sum()
    }

    /// Mean place of the strips, m, and the sum of the squared distances from it, m².
    fn spread(&self) -> (f64, f64) {
        let middle = mean(self.strips.iter().map(|strip| strip.x));
        let square = self.strips.iter().map(|strip| (strip.x - middle).powi(2)).sum();
        (middle, square)
    }
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}
