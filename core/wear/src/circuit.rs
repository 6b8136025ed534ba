//! Electrical state of the strips of a head.

use scene::Wear;

/// Contacts of a head that share a current:
///
/// ```text
/// R_c(F) = R_f + R_k (F₀/F)^m                         m = 1/2 for plastic contact spots [Holm 1967]
/// U = min(I / Σ 1/R_c, U₀),    I_i = I R/R_i          closed contacts in parallel
/// U_a = U₀ + E g                                      all open: one arc over the smallest gap g
/// ```
///
/// A drop beyond the voltage `U₀` of an arc without length melts the contact: no closed one has more. The current is
/// given, as that of a traction circuit with its inductance during a short arc.
#[derive(Clone, Copy, Debug)]
pub struct Circuit<'a> {
    wear: &'a Wear,
    /// Contact wires that every strip touches.
    wires: f64,
    current: f64,
}

/// Current of a head at one time, as its strips share it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shared {
    /// Voltage between wire and head, V.
    pub voltage: f64,
    /// Resistance of the closed contacts together, Ω; `None` where all are open.
    pub resistance: Option<f64>,
    /// Current of each strip, A.
    pub currents: Vec<f64>,
}

impl<'a> Circuit<'a> {
    /// Circuit of a head that takes `current` (A) from `wires` contact wires, evenly from each.
    #[must_use]
    pub fn new(wear: &'a Wear, wires: usize, current: f64) -> Self {
        Self {
            wear,
            wires: wires.max(1) as f64,
            current,
        }
    }

    /// Resistance of a strip under `force` (N), Ω; infinite where it is open.
    #[must_use]
    pub fn resistance(&self, force: f64) -> f64 {
        if force <= 0.0 {
            return f64::INFINITY;
        }
        let wear = self.wear;
        let spots = (wear.reference_force * self.wires / force).powf(wear.constriction_exponent);
        (wear.film_resistance + wear.constriction_resistance * spots) / self.wires
    }

    /// Current of strips with the forces `force` (N), whose gaps are `gap` (m, positive where open).
    #[must_use]
    pub fn shared(&self, force: &[f64], gap: &[f64]) -> Shared {
        let conductances = force.iter().map(|force| 1.0 / self.resistance(*force));
        let conductances: Vec<f64> = conductances.collect();
        let sum: f64 = conductances.iter().sum();
        if sum > 0.0 {
            return Shared {
                voltage: (self.current / sum).min(self.wear.arc_voltage),
                resistance: Some(1.0 / sum),
                currents: conductances.iter().map(|own| self.current * own / sum).collect(),
            };
        }
        let mut currents = vec![0.0; force.len()];
        let nearest = gap.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
        let Some((strip, gap)) = nearest.filter(|_| self.current > 0.0) else {
            return Shared {
                currents,
                ..Shared::default()
            };
        };
        if let Some(current) = currents.get_mut(strip) {
            *current = self.current;
        }
        Shared {
            voltage: self.wear.arc_voltage + self.wear.arc_gradient * gap.max(0.0),
            resistance: None,
            currents,
        }
    }
}
