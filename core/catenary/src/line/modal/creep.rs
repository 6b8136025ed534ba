//! Creep of droppers whose dampers hold wires together.
//!
//! Dampers that are stronger than the waves of wires by far let a dropper stretch slowly only, and forces from step to
//! step cannot add them to its spring. In the modes such a dropper is a stiff rod. Its spring and damper, end to end
//! with the rod, are longer by `y` than at rest:
//!
//! ```text
//! T = T₀ + K (e − y) + β K (ė − ẏ),    c ẏ = T − T₀ − k y,    y ≥ −T₀/k
//! ```
//!
//! with the elongation `e` of the whole. A dropper without tension follows `e`, but to no less than the unstressed
//! length of its spring. Forces `K y + β K ẏ` push rods apart at the end of a step, by the tension at its begin: it
//! moves `y` by `h/2c`, and `y` hardly moves it, as wires give way more easily than rods.
//!
//! Far from strips droppers go on in turn, by the tension `K e` of slow modes, and push slow modes only: waves of
//! faster ones come to the strips from near by.
use super::modes::Modes;
use crate::DropperLaw;
use dynamics::unilateral::next_of;

/// Creep of all droppers.
pub(super) struct Creep {
    /// Spring and damper end to end with the rod.
    law: DropperLaw,
    rod: DropperLaw,
    /// `T₀` of each dropper, N.
    at_rest: Vec<f64>,
    /// Time since the start, s.
    time: f64,
    droppers: Vec<Dropper>,
    /// Changes of the forces on slow modes at the end of the last step, dropper by dropper, N.
    changes: Vec<(usize, f64)>,
}

/// One dropper.
#[derive(Clone, Copy)]
struct Dropper {
    /// `y` when it last went on, m.
    length: f64,
    /// When that was, s.
    time: f64,
    /// Tension then, N; not a number where that is not known.
    tension: f64,
    /// Share of its push that all modes feel, at the begin and the end of the coming step, –.
    shares: [f64; 2],
    /// Push of its rod that all modes feel there, N.
    pushes: [f64; 2],
    /// Push that slow modes feel, N.
    slow: f64,
}

impl Dropper {
    const AT_REST: Self = Self {
        length: 0.0,
        time: 0.0,
        tension: f64::NAN,
        shares: [0.0; 2],
        pushes: [0.0; 2],
        slow: 0.0,
    };

    /// The last tension that is known, or else that of now, N.
    fn last(&self, now: f64) -> f64 {
        if self.tension.is_nan() { now } else { self.tension }
    }
}

impl Creep {
    /// Droppers at rest; none where they do not creep.
    pub fn new(modes: &Modes) -> Option<Self> {
        let droppers = modes.droppers();
        Some(Self {
            law: modes.creeping?,
            rod: modes.law,
            at_rest: modes.at_rest.clone(),
            time: 0.0,
            droppers: vec![Dropper::AT_REST; droppers],
            changes: Vec::with_capacity(droppers),
        })
    }

    /// Begins with a step to rest, of which droppers creep to the end.
    pub fn begin_anew(&mut self) {
        self.time = 0.0;
        self.droppers.fill(Dropper::AT_REST);
    }

    /// Goes on by a step of `h` s.
    pub fn begin(&mut self, h: f64) {
        self.time += h;
        self.changes.clear();
    }

    /// Lets all modes feel a share of the push of a dropper, –, and slow modes the rest.
    pub fn share(&mut self, dropper: usize, share: f64) {
        let all = &mut self.droppers[dropper];
        all.shares = [all.shares[1], share];
        if share == 0.0 {
            all.pushes = [0.0; 2];
        }
    }

    /// Tension of a dropper at the end of the last step, N, where all modes feel it creep.
    pub fn tension(&self, dropper: usize) -> Option<f64> {
        let dropper = &self.droppers[dropper];
        (dropper.shares[1] > 0.0 && !dropper.tension.is_nan()).then_some(dropper.tension)
    }

    /// Pushes of a rod that all modes feel at the begin and the end of the coming step, N.
    pub fn pushes(&self, dropper: usize) -> [f64; 2] {
        self.droppers[dropper].pushes
    }

    /// Changes of the pushes that slow modes feel, N.
    pub fn changes(&self) -> &[(usize, f64)] {
        &self.changes
    }

    /// Least length, m: that of a spring without force.
    fn least(&self, dropper: usize) -> f64 {
        -self.at_rest[dropper] / self.law.stiffness
    }

    /// A dropper at rest under a tension, N: the coming step begins with the push that it ends with.
    pub fn settle(&mut self, dropper: usize, tension: f64) {
        let shares = &mut self.droppers[dropper].shares;
        shares[0] = shares[1];
        let length = (tension - self.at_rest[dropper]) / self.law.stiffness;
        self.push(dropper, [tension, length], [length, 0.0]);
    }

    /// Goes on with a dropper near a strip to the end of a step of `h` s, where its rod would have the tension `spring`
    /// if it could push, N, with the part `by_rate` of its damper.
    pub fn near(&mut self, dropper: usize, [spring, by_rate]: [f64; 2], h: f64) {
        let before = self.droppers[dropper];
        let own = spring - before.pushes[1];
        let tension = own.max(0.0);
        let length = if own < 0.0 {
            ((spring - by_rate) / self.rod.stiffness).max(self.least(dropper))
        } else {
            self.length_under(dropper, tension)
        };
        // The tension is that of now: to go on with it in a straight line would make it swing.
        let next = self.after(dropper, length, [tension; 2], h);
        self.push(dropper, [tension, length], [next, (next - length) / h]);
    }

    /// Goes on with a dropper far from strips, which slow modes stretch by `elongation`, m; returns its tension, N,
    /// negative for what a slack one lacks.
    pub fn far(&mut self, dropper: usize, elongation: f64) -> f64 {
        let before = self.droppers[dropper];
        let spring = self.at_rest[dropper] + self.rod.stiffness * elongation;
        let tension = spring.max(0.0);
        let length = self.length_under(dropper, tension);
        // The push stays until the next turn: that of half way is right in the mean.
        let ahead = (1.5 * tension - 0.5 * before.last(tension)).max(0.0);
        let next = self.after(dropper, length, [tension, ahead], 0.5 * (self.time - before.time));
        self.push(dropper, [tension, length], [next, 0.0]);
        spring
    }

    /// Length of a dropper now, which its tension has reached in a straight line since it last went on, m.
    fn length_under(&self, dropper: usize, tension: f64) -> f64 {
        let before = &self.droppers[dropper];
        self.after(
            dropper,
            before.length,
            [before.last(tension), tension],
            self.time - before.time,
        )
    }

    /// Length after `h` s under a tension that goes from one value to the other in a straight line, m.
    fn after(&self, dropper: usize, length: f64, tensions: [f64; 2], h: f64) -> f64 {
        if h <= 0.0 {
            return length;
        }
        let [begin, end] = tensions.map(|tension| tension - self.at_rest[dropper]);
        let rate = self.law.stiffness / self.law.damping;
        let gone = -(-rate * h).exp_m1();
        // Time in which the last part of the force acts in full.
        let whole = gone / rate;
        let rising = (h - whole) / (rate * h);
        let grown = ((whole - rising) * begin + rising * end) / self.law.damping;
        (length * (1.0 - gone) + grown).max(self.least(dropper))
    }

    /// Takes tension and length now, and the length with its rate that the coming step ends with.
    fn push(&mut self, dropper: usize, [tension, length]: [f64; 2], [next, rate]: [f64; 2]) {
        let DropperLaw { stiffness, damping } = self.rod;
        let (time, all) = (self.time, &mut self.droppers[dropper]);
        let [begin, end] = all.shares;
        let slow = (1.0 - end) * stiffness * next;
        if slow != all.slow {
            self.changes.push((dropper, slow - all.slow));
        }
        *all = Dropper {
            length,
            time,
            tension,
            shares: all.shares,
            pushes: [begin * stiffness * length, end * (stiffness * next + damping * rate)],
            slow,
        };
    }

    /// Writes all that the next step goes by.
    pub fn save(&self, out: &mut Vec<f64>) {
        out.push(self.time);
        for dropper in &self.droppers {
            out.extend([dropper.length, dropper.time, dropper.tension, dropper.slow]);
            out.extend(dropper.shares.iter().chain(&dropper.pushes));
        }
    }

    /// See [`Creep::save`].
    pub fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        self.time = next_of(values);
        for dropper in &mut self.droppers {
            let Dropper {
                length,
                time,
                tension,
                shares,
                pushes,
                slow,
            } = dropper;
            let all = [length, time, tension, slow].into_iter().chain(shares).chain(pushes);
            all.for_each(|value| *value = next_of(values));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: DropperLaw = DropperLaw {
        stiffness: 2e5,
        damping: 1e4,
    };
    const ROD: DropperLaw = DropperLaw {
        stiffness: 1e7,
        damping: 1e3,
    };

    fn creep(at_rest: f64) -> Creep {
        Creep {
            law: LAW,
            rod: ROD,
            at_rest: vec![at_rest],
            time: 0.0,
            droppers: vec![Dropper::AT_REST],
            changes: Vec::new(),
        }
    }

    /// `c ẏ + k y = a t` has the solution `a/k (t − τ (1 − e^(−t/τ)))`, `τ = c/k`.
    #[test]
    fn a_dropper_under_a_force_that_rises_has_the_length_of_the_closed_form() {
        let (creep, tau) = (creep(100.0), LAW.damping / LAW.stiffness);
        for h in [1e-4, 0.02, 0.3] {
            let exact = 500.0 / LAW.stiffness * (h - tau * (1.0 - (-h / tau).exp()));
            let length = creep.after(0, 0.0, [100.0, 100.0 + 500.0 * h], h);
            assert!((length / exact - 1.0).abs() < 1e-9, "{h}: {length} {exact}");
        }
    }

    /// `c ẏ + k y = a sin ω t` has the solution `a/Z (sin(ω t − φ) + e^(−t/τ) sin φ)`, `Z² = k² + ω² c²`,
    /// `tan φ = ω τ`: near strips in every step, far from them once in 16 ms.
    #[test]
    fn droppers_under_a_swinging_tension_have_the_length_of_the_closed_form() {
        let (at_rest, a, h, omega) = (80.0, 60.0, 1e-3, 30.0);
        let tau = LAW.damping / LAW.stiffness;
        let (phi, z) = ((omega * tau).atan(), LAW.stiffness.hypot(omega * LAW.damping));
        let exact = |t: f64| a / z * ((omega * t - phi).sin() + (-t / tau).exp() * phi.sin());
        for (every, most) in [(1, 1e-3), (16, 0.03)] {
            let mut creep = creep(at_rest);
            creep.share(0, 1.0);
            creep.settle(0, at_rest);
            for step in 1..=1200 {
                let t = f64::from(step) * h;
                let swing = a * (omega * t).sin();
                creep.begin(h);
                if every == 1 {
                    let push = creep.pushes(0)[1];
                    creep.near(0, [at_rest + swing + push, 0.0], h);
                } else if step % every == 0 {
                    creep.far(0, swing / ROD.stiffness);
                } else {
                    continue;
                }
                let length = creep.droppers[0].length;
                assert!(
                    (length - exact(t)).abs() < most * a / z,
                    "{t}: {length} m and {} m",
                    exact(t)
                );
            }
        }
    }

    #[test]
    fn a_slack_dropper_follows_its_ends_to_the_unstressed_length() {
        let mut creep = creep(80.0);
        creep.share(0, 1.0);
        creep.share(0, 1.0);
        creep.settle(0, 80.0);
        for (elongation, length) in [(-1e-4, -1e-4 + 80.0 / ROD.stiffness), (-0.01, -80.0 / LAW.stiffness)] {
            creep.begin(1e-3);
            creep.near(0, [80.0 + ROD.stiffness * elongation, 0.0], 1e-3);
            assert_eq!(creep.tension(0), Some(0.0));
            assert!((creep.droppers[0].length - length).abs() < 1e-12);
        }
    }

    #[test]
    fn a_step_from_rest_begins_with_the_push_of_rest() {
        let mut creep = creep(80.0);
        creep.share(0, 0.4);
        creep.settle(0, 60.0);
        let push = 0.4 * ROD.stiffness * (60.0 - 80.0) / LAW.stiffness;
        assert!(creep.pushes(0).iter().all(|own| (own - push).abs() < 1e-9));
    }

    #[test]
    fn pushes_go_over_from_all_modes_to_slow_ones() {
        let (mut creep, mut slow, h) = (creep(80.0), 0.0, 1e-3);
        for share in [1.0, 0.6, 0.1, 0.0, 0.0] {
            creep.begin(h);
            creep.share(0, share);
            let push = creep.pushes(0)[1];
            creep.near(0, [130.0 + push, 0.0], h);
            slow += creep.changes().iter().map(|(_, change)| change).sum::<f64>();
            let [length, push] = [creep.droppers[0].length, creep.pushes(0)[1]];
            let whole = ROD.stiffness * creep.after(0, length, [130.0; 2], h);
            let damper = push - share * whole;
            assert!(
                (slow - (1.0 - share) * whole).abs() < 1e-9 * whole,
                "{slow} N of {whole} N"
            );
            assert!((-1e-9..5.5).contains(&damper), "{damper} N");
        }
    }

    #[test]
    fn a_saved_state_comes_back() {
        let mut creep = creep(80.0);
        for step in 1..4 {
            creep.begin(1e-3);
            creep.share(0, 0.3 * f64::from(step));
            creep.near(0, [70.0 * f64::from(step), 1.0], 1e-3);
        }
        let (mut saved, mut again) = (Vec::new(), Vec::new());
        creep.save(&mut saved);
        creep.begin_anew();
        creep.restore(&mut saved.iter());
        creep.save(&mut again);
        assert_eq!(saved, again);
        assert!(saved.iter().filter(|value| **value != 0.0).count() > 6, "{saved:?}");
    }
}
