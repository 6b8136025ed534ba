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

#[cfg(test)]
mod tests {
    use scene::{WearApplied, WearLaw, WireWear};

    use super::*;

    /// Contacts of 2 mΩ and a film of 1 mΩ at 100 N.
    fn wear() -> Wear {
        let law = WearLaw {
            mechanical_coefficient: 1e-4,
            current_exponent: 0.0,
            force_exponent: 0.0,
            joule_coefficient: 0.0,
            arc_coefficient: 0.0,
            hardness: 1e9,
            melting_heat: 2e5,
            density: 8960.0,
        };
        Wear {
            current: vec![300.0],
            film_resistance: 1e-3,
            constriction_resistance: 2e-3,
            constriction_exponent: 0.5,
            arc_voltage: 20.0,
            arc_gradient: 1000.0,
            reference_force: 100.0,
            reference_current: 500.0,
            contact_length: 0.04,
            grid: 0.1,
            applied: WearApplied::Span,
            depth_step: 1e-5,
            wire: WireWear {
                diameter: 0.012,
                worn_depth: 0.0,
                limit_percent: 20.0,
                law,
            },
            strip: None,
        }
    }

    fn near(found: f64, expected: f64) -> bool {
        (found - expected).abs() <= 1e-12 * expected.abs()
    }

    #[test]
    fn strips_share_the_current_by_their_conductances() {
        let wear = wear();
        let circuit = Circuit::new(&wear, 1, 300.0);
        let even = circuit.shared(&[100.0, 100.0], &[-1e-3, -1e-3]);
        assert!(near(even.resistance.unwrap(), 1.5e-3) && near(even.voltage, 0.45));
        assert!(even.currents.iter().all(|current| near(*current, 150.0)));
        // 25 N: 5 mΩ beside 3 mΩ.
        let uneven = circuit.shared(&[25.0, 100.0], &[-1e-3, -1e-3]);
        assert!(near(uneven.currents[0], 300.0 * 3.0 / 8.0) && near(uneven.currents[1], 300.0 * 5.0 / 8.0));
        let one = circuit.shared(&[0.0, 100.0], &[1e-3, -1e-3]);
        assert!(one.currents[0] == 0.0 && near(one.currents[1], 300.0) && near(one.voltage, 0.9));
    }

    #[test]
    fn an_arc_burns_where_all_are_open_over_the_smallest_gap() {
        let wear = wear();
        let open = Circuit::new(&wear, 1, 300.0).shared(&[0.0, 0.0], &[3e-3, 2e-3]);
        assert_eq!((open.resistance, open.currents), (None, vec![0.0, 300.0]));
        assert!(near(open.voltage, 22.0));
        let still = Circuit::new(&wear, 1, 0.0).shared(&[0.0], &[1e-3]);
        assert_eq!((still.voltage, still.currents), (0.0, vec![0.0]));
    }

    #[test]
    fn two_wires_are_two_contacts_of_half_the_force() {
        let wear = wear();
        let (one, two) = (Circuit::new(&wear, 1, 300.0), Circuit::new(&wear, 2, 300.0));
        assert!(near(two.resistance(100.0), 0.5 * one.resistance(50.0)));
    }

    #[test]
    fn the_drop_of_a_closed_contact_is_at_most_that_of_an_arc() {
        let wear = wear();
        let light = Circuit::new(&wear, 1, 300.0).shared(&[1e-6], &[-1e-9]);
        assert_eq!(light.voltage, 20.0);
        assert!(light.resistance.unwrap() > 20.0 / 300.0);
    }
}
