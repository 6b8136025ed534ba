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
//! length of its spring. Forces `K y + β K ẏ` push rods apart at the end of a step, see [`Creeping`].
//!
//! Far from strips droppers go on in turn, by the tension `K e` of slow modes, and push slow modes only: waves of
//! faster ones come to the strips from near by.
use super::modes::Modes;
use super::slack::{Answers, Yielding};
use crate::DropperLaw;
use dynamics::modal::LARGEST_TURN;
use dynamics::unilateral::next_of;
use std::f64::consts::FRAC_PI_2;

/// Tension by which droppers near strips creep in a step.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Creeping {
    /// That at its begin: it moves `y` by `h/2c`, and `y` hardly moves it, as wires give way more easily than rods.
    UnderBegin,
    /// That at its end, found with the forces of strips, with the rate of a parabola through the last lengths: a
    /// straight line between tensions would let these swing from step to step.
    UnderEnd,
}

/// Largest push of a rod in a step in units of the tension at the begin that makes it, by which droppers creep with an
/// error that steps have anyway; found on the line of the thesis.
const MOST_PUSHED: f64 = 1.25;
/// Largest change of the tension by that push, in units of the tension, and part of its answer that comes late: pushes
/// beyond would swing.
const MOST_FELT: f64 = 1.0 / 16.0;

impl Creeping {
    /// The simpler one that serves, where droppers creep at all.
    pub fn of(modes: &Modes, answers: &mut Answers) -> Option<Self> {
        let pushed = 0.5 * answers.step.h * modes.law.stiffness / modes.creeping?.damping;
        let felt = (0..modes.droppers()).map(|dropper| pushed * answers.by_own(modes, dropper));
        let felt = felt.fold(0.0, f64::max);
        let late = (0..modes.droppers()).map(|dropper| answers_late(modes, dropper, answers.step.h));
        let late = late.fold(0.0, f64::max);
        let serves = pushed <= MOST_PUSHED && felt <= MOST_FELT && late <= MOST_FELT;
        Some(if serves { Self::UnderBegin } else { Self::UnderEnd })
    }
}

/// Creep of all droppers.
pub(super) struct Creep {
    /// Spring and damper end to end with the rod.
    law: DropperLaw,
    rod: DropperLaw,
    creeping: Creeping,
    /// `T₀` of each dropper, N.
    at_rest: Vec<f64>,
    /// Tension that each dropper loses by a push that slow modes feel, –: the others give way, too.
    lost: Vec<f64>,
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
    /// `y` one step before, m; not a number where that is not known.
    length_before: f64,
    /// When it last went on, s.
    time: f64,
    /// Tension then, N; not a number where that is not known.
    tension: f64,
    /// Share of its push that all modes feel at the end of the coming step, –.
    share: f64,
    /// Push of its rod that all modes feel there, N.
    push: f64,
    /// Push that slow modes feel, N.
    slow: f64,
}

impl Dropper {
    const AT_REST: Self = Self {
        length: 0.0,
        length_before: f64::NAN,
        time: 0.0,
        tension: f64::NAN,
        share: 0.0,
        push: 0.0,
        slow: 0.0,
    };

    /// Rate at the end of a step of `h` s as a multiple of the length there, 1/s, and the rest of it, m/s: that of the
    /// parabola through the last lengths, which damps what is faster than steps, or straight.
    fn rate(&self, h: f64) -> [f64; 2] {
        if self.length_before.is_nan() {
            return [1.0 / h, -self.length / h];
        }
        [1.5 / h, (0.5 * self.length_before - 2.0 * self.length) / h]
    }

    /// The last tension that is known, or else that of now, N.
    fn last(&self, now: f64) -> f64 {
        if self.tension.is_nan() { now } else { self.tension }
    }
}

impl Creep {
    /// Droppers at rest; none where they do not creep.
    pub fn new(modes: &Modes, creeping: Creeping) -> Option<Self> {
        let droppers = modes.droppers();
        Some(Self {
            law: modes.creeping?,
            rod: modes.law,
            creeping,
            at_rest: modes.at_rest.clone(),
            lost: (0..droppers).map(|dropper| lost(modes, dropper)).collect(),
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
        all.share = share;
        if share == 0.0 {
            all.push = 0.0;
        }
    }

    /// Tension of a dropper at the end of the last step, N, where all modes feel it creep.
    pub fn tension(&self, dropper: usize) -> Option<f64> {
        let dropper = &self.droppers[dropper];
        (dropper.share > 0.0 && !dropper.tension.is_nan()).then_some(dropper.tension)
    }

    /// Push of a rod that all modes feel at the end of the coming step, N.
    pub fn push(&self, dropper: usize) -> f64 {
        self.droppers[dropper].push
    }

    /// Change of the push at the end of a step of `h` s, which is known, with the tension there.
    pub fn yielding(&self, dropper: usize, h: f64) -> Yielding {
        if h == 0.0 {
            return Yielding {
                by_tension: self.rod.stiffness / self.law.stiffness,
                expected: self.at_rest[dropper],
            };
        }
        if self.creeping == Creeping::UnderBegin {
            return Yielding::default();
        }
        let all = &self.droppers[dropper];
        let ([own, _], DropperLaw { stiffness, damping }) = (all.rate(h), self.law);
        Yielding {
            by_tension: all.share * (self.rod.stiffness + own * self.rod.damping) / (stiffness + own * damping),
            expected: all.last(0.0),
        }
    }

    /// Takes a force that pulls off the push at the end of the step, N.
    pub fn yield_by(&mut self, dropper: usize, force: f64) {
        self.droppers[dropper].push -= force;
    }

    /// Tension that a dropper loses by the push that slow modes feel, N.
    pub fn lost(&self, dropper: usize) -> f64 {
        self.lost[dropper] * self.droppers[dropper].slow
    }

    /// Changes of the pushes that slow modes feel, N.
    pub fn changes(&self) -> &[(usize, f64)] {
        &self.changes
    }

    /// Least length, m: that of a spring without force.
    fn least(&self, dropper: usize) -> f64 {
        -self.at_rest[dropper] / self.law.stiffness
    }

    /// A dropper at rest under a tension, N.
    pub fn settle(&mut self, dropper: usize, tension: f64) {
        let length = (tension - self.at_rest[dropper]) / self.law.stiffness;
        self.expect(dropper, [tension, length], [length, 0.0]);
    }

    /// Goes on with a dropper near a strip to the end of a step of `h` s, where it has the tension `own`, negative for
    /// what a slack one lacks, N, and its rod without a damper would have `spring` if it could push and nothing pushed
    /// it.
    pub fn near(&mut self, dropper: usize, [own, spring]: [f64; 2], h: f64) {
        let (tension, before) = (own.max(0.0), self.droppers[dropper]);
        let goes_on = (self.time - before.time - h).abs() <= 1e-9 * h;
        let length = if own < 0.0 {
            (spring / self.rod.stiffness).max(self.least(dropper))
        } else if self.creeping == Creeping::UnderEnd && goes_on {
            self.under_end(dropper, tension, h)[0]
        } else {
            self.length_under(dropper, tension)
        };
        let all = &mut self.droppers[dropper];
        all.length_before = if goes_on { before.length } else { f64::NAN };
        all.length = length;
        all.tension = tension;
        let next = self.next(dropper, h);
        self.expect(dropper, [tension, length], next);
    }

    /// Length at the end of a step of `h` s with the tension at its begin, m, and its rate, m/s. To go on with the
    /// tension in a straight line would make it swing.
    fn next(&self, dropper: usize, h: f64) -> [f64; 2] {
        let Dropper { length, tension, .. } = self.droppers[dropper];
        match self.creeping {
            Creeping::UnderBegin => {
                let next = self.after(dropper, length, [tension; 2], h);
                [next, (next - length) / h]
            }
            Creeping::UnderEnd => self.under_end(dropper, tension, h),
        }
    }

    /// Length at the end of a step of `h` s with a tension there, m, and its rate, m/s.
    fn under_end(&self, dropper: usize, tension: f64, h: f64) -> [f64; 2] {
        let [own, past] = self.droppers[dropper].rate(h);
        let DropperLaw { stiffness, damping } = self.law;
        let length = (tension - self.at_rest[dropper] - damping * past) / (stiffness + own * damping);
        let length = length.max(self.least(dropper));
        [length, own * length + past]
    }

    /// Expects a step of `h` s that is not as long as the last one.
    pub fn expect_other(&mut self, dropper: usize, h: f64) {
        let all = &mut self.droppers[dropper];
        all.length_before = f64::NAN;
        let [next, rate] = self.next(dropper, h);
        self.droppers[dropper].push = self.pushed(dropper, [next, rate]);
    }

    /// Push that all modes feel by a length of a dropper, m, and its rate, m/s.
    fn pushed(&self, dropper: usize, [length, rate]: [f64; 2]) -> f64 {
        self.droppers[dropper].share * (self.rod.stiffness * length + self.rod.damping * rate)
    }

    /// Goes on with a dropper far from strips, which slow modes stretch by `elongation`, m; returns its tension, N,
    /// negative for what a slack one lacks.
    pub fn far(&mut self, dropper: usize, elongation: f64) -> f64 {
        let before = self.droppers[dropper];
        let spring = self.at_rest[dropper] + self.rod.stiffness * elongation - self.lost(dropper);
        let tension = spring.max(0.0);
        let length = self.length_under(dropper, tension);
        // The push stays until the next turn: that of half way is right in the mean.
        let ahead = (1.5 * tension - 0.5 * before.last(tension)).max(0.0);
        let next = self.after(dropper, length, [tension, ahead], 0.5 * (self.time - before.time));
        self.expect(dropper, [tension, length], [next, 0.0]);
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
        let [whole, rising] = self.gone(h);
        let gone = whole * self.law.stiffness / self.law.damping;
        let grown = ((whole - rising) * begin + rising * end) / self.law.damping;
        (length * (1.0 - gone) + grown).max(self.least(dropper))
    }

    /// Times in which a force that stays, and one that rises to the end of `h` s, would act in full on the damper
    /// alone, s.
    fn gone(&self, h: f64) -> [f64; 2] {
        let rate = self.law.stiffness / self.law.damping;
        let whole = -(-rate * h).exp_m1() / rate;
        [whole, (h - whole) / (rate * h)]
    }

    /// Takes tension and length now, and the length with its rate that the coming step ends with.
    fn expect(&mut self, dropper: usize, [tension, length]: [f64; 2], [next, rate]: [f64; 2]) {
        let push = self.pushed(dropper, [next, rate]);
        let (time, all) = (self.time, &mut self.droppers[dropper]);
        let slow = (1.0 - all.share) * self.rod.stiffness * next;
        if slow != all.slow {
            self.changes.push((dropper, slow - all.slow));
        }
        *all = Dropper {
            length,
            time,
            tension,
            push,
            slow,
            ..*all
        };
    }

    /// Writes all that the next step goes by.
    pub fn save(&self, out: &mut Vec<f64>) {
        out.push(self.time);
        for dropper in &self.droppers {
            out.extend([dropper.length, dropper.length_before, dropper.time, dropper.tension]);
            out.extend([dropper.share, dropper.push, dropper.slow]);
        }
    }

    /// See [`Creep::save`].
    pub fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        self.time = next_of(values);
        for dropper in &mut self.droppers {
            let Dropper {
                length,
                length_before,
                time,
                tension,
                share,
                push,
                slow,
            } = dropper;
            for value in [length, length_before, time, tension, share, push, slow] {
                *value = next_of(values);
            }
        }
    }
}

/// Part of the answer of a rod to a push by modes that turn by more than a quarter in a step of `h` s, –: the tension
/// at the begin of a step has another sign than that at its end. Modes beyond the largest turn are damped.
fn answers_late(modes: &Modes, dropper: usize, h: f64) -> f64 {
    let is_late = |stiffness: f64| (FRAC_PI_2..=LARGEST_TURN).contains(&(stiffness.sqrt() * h));
    let entries = modes.joint(dropper).iter().zip(&modes.stiffness);
    let late = entries.filter(|(_, stiffness)| is_late(**stiffness));
    let give: f64 = late
        .map(|(entry, stiffness)| f64::from(*entry).powi(2) / stiffness)
        .sum();
    modes.law.stiffness * give
}

/// Tension that a dropper loses by a push of its rod that slow modes feel and others do not, –.
fn lost(modes: &Modes, dropper: usize) -> f64 {
    let give = |row: &[f32]| -> f64 {
        let entries = row.iter().zip(&modes.stiffness);
        entries
            .map(|(entry, stiffness)| f64::from(*entry).powi(2) / stiffness)
            .sum()
    };
    let of_others = give(modes.joint(dropper)) - give(modes.creeping_row(dropper));
    1.0 - modes.law.stiffness * (of_others + modes.residual_between(dropper, dropper))
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
            creeping: Creeping::UnderBegin,
            lost: vec![0.0],
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
                    let own = at_rest + swing;
                    creep.near(0, [own, own + creep.push(0)], h);
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

    /// The same of a weaker damper under the tension at the end of each step, which yields what was not expected.
    #[test]
    fn droppers_that_yield_have_the_length_of_the_closed_form() {
        let (at_rest, a, h, omega) = (80.0, 60.0, 1e-3, 60.0);
        let mut creep = creep(at_rest);
        creep.creeping = Creeping::UnderEnd;
        creep.law.damping = 300.0;
        let tau = creep.law.damping / LAW.stiffness;
        let (phi, z) = ((omega * tau).atan(), LAW.stiffness.hypot(omega * creep.law.damping));
        creep.share(0, 1.0);
        creep.settle(0, at_rest);
        for step in 1..=300 {
            let t = f64::from(step) * h;
            let own = at_rest + a * (omega * t).sin();
            creep.yield_by(0, creep.yielding(0, h).force(own));
            let push = creep.push(0);
            creep.begin(h);
            creep.near(0, [own, own + push], h);
            let Dropper {
                length, length_before, ..
            } = creep.droppers[0];
            if step > 2 {
                let rate = (length - length_before) / h;
                let damper = (push - ROD.stiffness * length) / ROD.damping;
                assert!(
                    (damper - rate).abs() < 0.1 * a / z * omega,
                    "{damper} m/s and {rate} m/s"
                );
            }
            if step > 20 {
                let exact = a / z * (omega * t - phi).sin();
                assert!((length - exact).abs() < 5e-3 * a / z, "{t}: {length} m and {exact} m");
            }
        }
        // A step of another length knows no length before the last one.
        creep.expect_other(0, 0.5 * h);
        assert!(creep.droppers[0].length_before.is_nan());
    }

    #[test]
    fn a_slack_dropper_follows_its_ends_to_the_unstressed_length() {
        let mut creep = creep(80.0);
        creep.share(0, 1.0);
        creep.share(0, 1.0);
        creep.settle(0, 80.0);
        for (elongation, length) in [(-1e-4, -1e-4 + 80.0 / ROD.stiffness), (-0.01, -80.0 / LAW.stiffness)] {
            creep.begin(1e-3);
            let spring = 80.0 + ROD.stiffness * elongation;
            creep.near(0, [spring - creep.push(0), spring], 1e-3);
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
        assert!((creep.push(0) - push).abs() < 1e-9);
    }

    #[test]
    fn pushes_go_over_from_all_modes_to_slow_ones() {
        let (mut creep, mut slow, h) = (creep(80.0), 0.0, 1e-3);
        for share in [1.0, 0.6, 0.1, 0.0, 0.0] {
            creep.begin(h);
            creep.share(0, share);
            creep.near(0, [130.0, 130.0 + creep.push(0)], h);
            slow += creep.changes().iter().map(|(_, change)| change).sum::<f64>();
            let [length, push] = [creep.droppers[0].length, creep.push(0)];
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
            let own = 70.0 * f64::from(step);
            creep.near(0, [own, own + 1.0], 1e-3);
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
