//! Parts of a lumped pantograph: masses that rise and fall, and the elements between them.
use crate::multibody::{Anchor, BaseMarker, Measure, Pair};
use crate::{Apparent, Travel};
use dynamics::{Blocks, Columns, Force, Frame, LowRank, Marker, Motion, Power, StepHistory, Updates, Weights};
use nalgebra::{Matrix3, Vector3};

/// Sliding velocity (m/s) at which the regularised friction has reached tanh(1) of Coulomb's.
///
/// Chosen: a tenth of the velocities of a strip on a line in operation, and slow enough for steps of a millisecond.
pub const FRICTION_VELOCITY: f64 = 0.01;

/// Masses of a chain, and the static force that lifts the last mass.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainMasses {
    /// Index of the first mass's coordinate; the others follow.
    pub first: usize,
    /// kg, collector head first.
    pub masses: Vec<f64>,
    /// Upward force on the last mass, N: the lift of the raised pantograph in excess of the weight.
    pub static_force: f64,
}

impl Force for ChainMasses {
    fn add_force(&mut self, _motion: &Motion<'_>, force: &mut [f64]) {
        force[self.first + self.masses.len() - 1] += self.static_force;
    }

    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        for (i, &mass) in self.masses.iter().enumerate() {
            blocks.add(&[self.first + i], &[self.first + i], &[mass]);
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        -self.static_force * motion.q[self.first + self.masses.len() - 1]
    }
}

/// Vertical force of a drive between a mass of a chain and its base, as the input `u[input]`, N.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainDrive {
    /// Coordinate of the driven mass.
    pub coordinate: usize,
    /// Index in the inputs.
    pub input: usize,
    /// Moving base that bears the reaction.
    pub foot: Option<Foot>,
}

impl Force for ChainDrive {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let drive = motion.u[self.input];
        force[self.coordinate] += drive;
        if let Some(foot) = &self.foot {
            let mut columns = Columns::default();
            foot.pair.second.columns(motion, &mut columns);
            columns.add_force(&Vector3::new(0.0, 0.0, -drive), &Vector3::zeros(), force);
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let Some(foot) = &self.foot else { return };
        // The foot turns with its body.
        let view = foot.pair.view(motion);
        let (indices, bend) = (view.indices(), view.hessian(Foot::RISE));
        let load = weights.q * motion.u[self.input];
        for (k, &of) in indices.iter().enumerate() {
            for (l, &by) in indices.iter().enumerate() {
                blocks.add(&[of], &[by], &[load * bend[(k, l)]]);
            }
        }
    }

    /// The drive brings in all of its power.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        let base = self.foot.as_ref().map_or(0.0, |foot| foot.rise(motion).1);
        Some(Power {
            driven: motion.u[self.input] * (motion.v[self.coordinate] - base),
            dissipated: 0.0,
        })
    }
}

/// Inertia of the masses of a chain on a base in a curve: along the chain, perpendicular to the plane of the rails.
///
/// ```text
/// F = −m (a + Ω̇ × r + Ω × (Ω × r) + 2 Ω × ṙ)_z + m g (1 − e_up·e_z),    r = (0, b, h + q)
/// ```
///
/// `F` is the leaning part of the weight, which the static force of a chain contains, and the centrifugal force's
/// share. The guide of the chain bears the forces across the chain.
#[derive(Clone, Debug)]
pub struct ChainInertia {
    /// Travel of the base.
    pub travel: Travel,
    /// Index of the first mass's coordinate; the others follow.
    pub first: usize,
    /// kg, collector head first.
    pub masses: Vec<f64>,
    /// `b`, lateral position of the chain from the middle of the track, m.
    pub lateral: f64,
    /// `h`, height of a chain without extent above the top of rail, m.
    pub height: f64,
    /// `g`, m/s².
    pub gravity: f64,
}

impl ChainInertia {
    /// Force per mass at the coordinate `index`, N/kg.
    fn force_per_mass(&self, apparent: &Apparent, index: usize, motion: &Motion<'_>) -> f64 {
        let position = Vector3::new(0.0, self.lateral, self.height + motion.q[index]);
        let velocity = Vector3::new(0.0, 0.0, motion.v[index]);
        apparent.leaning_weight(self.gravity).z - apparent.acceleration_of(&position, &velocity).z
    }
}

impl Force for ChainInertia {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let Some(apparent) = self.travel.apparent(motion.t) else {
            return;
        };
        for (index, mass) in (self.first..).zip(&self.masses) {
            force[index] += mass * self.force_per_mass(&apparent, index, motion);
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let Some(apparent) = self.travel.apparent(motion.t) else {
            return;
        };
        // −∂F/∂q = m e_z·(Ω × (Ω × e_z))
        let turn = apparent.angular_velocity;
        let stiffness = weights.q * turn.cross(&turn.cross(&Vector3::z())).z;
        for (index, mass) in (self.first..).zip(&self.masses) {
            blocks.add(&[index], &[index], &[mass * stiffness]);
        }
    }

    /// The travel of the base brings in all of the power.
    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        let mut power = Power::default();
        if let Some(apparent) = self.travel.apparent(motion.t) {
            for (index, mass) in (self.first..).zip(&self.masses) {
                power.driven += mass * self.force_per_mass(&apparent, index, motion) * motion.v[index];
            }
        }
        Some(power)
    }
}

/// Moving base under the last element of a chain.
///
/// The foot bears the force of the chain and the reaction `S` of the static force: at rest the contact force.
#[derive(Clone, Debug, PartialEq)]
pub struct Foot {
    /// Pair from a fixed point, the foot's reference position, to the foot.
    pub pair: Pair,
    /// `S`, N.
    pub lift: f64,
}

impl Foot {
    const RISE: Measure = Measure::Point(2);

    /// Foot that is at `reference` (m) in the reference state.
    #[must_use]
    pub fn new(foot: Anchor, reference: Vector3<f64>, lift: f64) -> Self {
        let first = Anchor::Base(BaseMarker {
            position: reference,
            axes: Matrix3::identity(),
        });
        Self {
            pair: Pair { first, second: foot },
            lift,
        }
    }

    fn frame(&self, motion: &Motion<'_>) -> Frame {
        self.pair.second.frame(motion)
    }

    /// Rise and its rate, m and m/s.
    fn rise(&self, motion: &Motion<'_>) -> (f64, f64) {
        let frame = self.frame(motion);
        let reference = self.pair.first.frame(motion).position.z;
        (frame.position.z - reference, frame.velocity.z)
    }
}

/// Spring, damper and friction between a mass and the one below, or the base.
///
/// ```text
/// s = q_below − q_above         compression beyond the reference state, m; at the last one q_below is the base's rise
/// N = P + k s + c ṡ             a plain element
/// N = max(0, P + k s + c ṡ)     where it pushes only (a stop, a loose head), as long as P + k s > 0, else 0
/// F = N + R tanh(ṡ / v_R)       on the mass above; −F on the mass below
/// ```
///
/// `v_R` is [`FRICTION_VELOCITY`]: Coulomb friction `R sign(ṡ)` with the jump rounded off.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainElement {
    /// Coordinate of the mass above.
    pub above: usize,
    /// Coordinate of the mass below; `None` is the base.
    pub below: Option<usize>,
    /// Moving base under an element without a mass below.
    pub foot: Option<Foot>,
    /// `k`, N/m.
    pub stiffness: f64,
    /// `c`, N·s/m.
    pub damping: f64,
    /// `P`, compression in the reference state, N.
    pub preload: f64,
    /// True for an element that pushes only.
    pub unilateral: bool,
    /// `R`, N.
    pub friction: f64,
    /// Tangent coefficient in the factored matrix, N/m.
    factored: f64,
    /// True if the element was open at the last evaluation of the force.
    open: bool,
    /// Number of low-rank rows so far with a part of a turning foot.
    rows: u64,
}

impl ChainElement {
    /// An element without friction that pushes and pulls.
    #[must_use]
    pub fn new(above: usize, below: Option<usize>, stiffness: f64, damping: f64, preload: f64) -> Self {
        Self {
            above,
            below,
            foot: None,
            stiffness,
            damping,
            preload,
            unilateral: false,
            friction: 0.0,
            factored: 0.0,
            open: false,
            rows: 0,
        }
    }

    /// `(s, ṡ)`, m and m/s.
    fn compression(&self, motion: &Motion<'_>) -> (f64, f64) {
        let (q, v) = match (self.below, &self.foot) {
            (Some(below), _) => (motion.q[below], motion.v[below]),
            (None, Some(foot)) => foot.rise(motion),
            (None, None) => (0.0, 0.0),
        };
        (q - motion.q[self.above], v - motion.v[self.above])
    }

    /// `(F, ∂F/∂s, ∂F/∂ṡ)`, and true for an open element.
    fn law(&self, motion: &Motion<'_>) -> (f64, f64, f64, bool) {
        let (s, rate) = self.compression(motion);
        let elastic = self.preload + self.stiffness * s;
        let normal = elastic + self.damping * rate;
        let open = self.unilateral && (elastic <= 0.0 || normal <= 0.0);
        let (mut force, stiffness, mut damping) = if open {
            (0.0, 0.0, 0.0)
        } else {
            (normal, self.stiffness, self.damping)
        };
        if self.friction > 0.0 {
            let tanh = (rate / FRICTION_VELOCITY).tanh();
            force += self.friction * tanh;
            damping += self.friction / FRICTION_VELOCITY * (1.0 - tanh * tanh);
        }
        (force, stiffness, damping, open)
    }

    /// Coefficient of the tangent `S = coefficient · u uᵀ`, `u = ∂s/∂q`, N/m.
    fn coefficient(&self, motion: &Motion<'_>, weights: Weights) -> f64 {
        let (_, stiffness, damping, _) = self.law(motion);
        weights.q * stiffness + weights.v * damping
    }

    fn switches(&self) -> bool {
        self.unilateral || self.friction > 0.0
    }
}

impl Force for ChainElement {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let (normal, .., open) = self.law(motion);
        self.open = open;
        force[self.above] += normal;
        if let Some(below) = self.below {
            force[below] -= normal;
        } else if let Some(foot) = &self.foot {
            let mut columns = Columns::default();
            foot.pair.second.columns(motion, &mut columns);
            columns.add_force(&Vector3::new(0.0, 0.0, -normal - foot.lift), &Vector3::zeros(), force);
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let s = self.coefficient(motion, weights);
        self.factored = s;
        match (self.below, &self.foot) {
            (Some(below), _) => blocks.add(&[self.above, below], &[self.above, below], &[s, -s, -s, s]),
            (None, None) => blocks.add(&[self.above], &[self.above], &[s]),
            (None, Some(foot)) => {
                let view = foot.pair.view(motion);
                let count = view.indices().len();
                let (rise_q, rise_qq) = (view.gradient(Foot::RISE), view.hessian(Foot::RISE));
                let load = self.law(motion).0 + foot.lift;
                let mut v = rise_q * 0.0;
                for (v, &index) in v.iter_mut().zip(view.indices()) {
                    *v = motion.v[index];
                }
                // ∂ṡ/∂q at constant v
                let (_, _, damping, _) = self.law(motion);
                let rate_q = rise_qq.transpose() * v;
                blocks.add(&[self.above], &[self.above], &[s]);
                for k in 0..count {
                    let index = view.indices()[k];
                    let of_rate = weights.q * damping * rate_q[k];
                    blocks.add(&[self.above], &[index], &[-s * rise_q[k] - of_rate]);
                    blocks.add(&[index], &[self.above], &[-s * rise_q[k]]);
                    for l in 0..count {
                        let of_rate = weights.q * damping * rise_q[k] * rate_q[l];
                        let bent = weights.q * load * rise_qq[(k, l)];
                        let value = s * rise_q[k] * rise_q[l] + of_rate + bent;
                        blocks.add(&[index], &[view.indices()[l]], &[value]);
                    }
                }
            }
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let (s, _) = self.compression(motion);
        let open_at = -self.preload / self.stiffness;
        // An open element keeps the energy of the moment of opening.
        let s = if self.unilateral && self.stiffness > 0.0 {
            s.max(open_at)
        } else {
            s
        };
        let lifted = match (self.below, &self.foot) {
            (None, Some(foot)) => foot.lift * foot.rise(motion).0,
            _ => 0.0,
        };
        self.preload * s + 0.5 * self.stiffness * s * s + lifted
    }

    fn power(&self, motion: &Motion<'_>) -> Option<Power> {
        let foot = self.foot.as_ref()?;
        if !matches!(foot.pair.second, Anchor::Given(_)) {
            return None;
        }
        // The lift of the foot does work; the energy knows the law at rest only.
        let (normal, ..) = self.law(motion);
        let (s, rate) = self.compression(motion);
        let elastic = self.preload + self.stiffness * s;
        let elastic = if self.unilateral { elastic.max(0.0) } else { elastic };
        Some(Power {
            driven: (normal + foot.lift) * foot.rise(motion).1,
            dissipated: (normal - elastic) * rate,
        })
    }

    fn low_rank(&mut self) -> Option<&mut dyn LowRank> {
        Some(self)
    }

    fn step_history(&mut self) -> Option<&mut dyn StepHistory> {
        Some(self)
    }
}

impl LowRank for ChainElement {
    fn push_updates(&mut self, motion: &Motion<'_>, weights: Weights, updates: &mut Updates) {
        if !self.switches() {
            return;
        }
        let change = self.coefficient(motion, weights) - self.factored;
        if change != 0.0 {
            let below = self.below.map(|below| (below, 1.0));
            let mut columns = Columns::default();
            if let (None, Some(foot)) = (self.below, &self.foot) {
                foot.pair.second.columns(motion, &mut columns);
                self.rows += u64::from(!columns.as_slice().is_empty());
            }
            let foot = columns
                .as_slice()
                .iter()
                .map(|column| (column.index, column.translation.z));
            updates.rank_one(
                0,
                self.rows,
                change,
                std::iter::once((self.above, -1.0)).chain(below).chain(foot),
            );
        }
    }
}

impl StepHistory for ChainElement {
    fn continues_to(&mut self, motion: &Motion<'_>) -> bool {
        !self.unilateral || self.law(motion).3 == self.open
    }
}
