//! The parts of a lumped pantograph: masses that rise and fall, and what joins them.
use dynamics::{Blocks, Columns, Force, Frame, Marker, Motion, Updates, Weights};
use nalgebra::{Matrix3, Vector3};

/// Sliding velocity (m/s) at which the regularised friction has reached tanh(1) = 76 % of Coulomb's.
///
/// Chosen: a tenth of the velocities that a strip has on a line in operation, and slow enough for steps of a millisecond.
pub const FRICTION_VELOCITY: f64 = 0.01;

/// The masses of a chain, and the static force that lifts the last of them.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainMasses {
    /// Index of the first mass's coordinate; the others follow.
    pub first: usize,
    /// kg, collector head first.
    pub masses: Vec<f64>,
    /// Upward force on the last mass, N. It is the lift that the raised pantograph has in excess of its weight.
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

/// Spring, damper and friction between a mass and the one below, or the base.
///
/// ```text
/// s = q_below − q_above         compression beyond the reference state, m; q_below = 0 for the base
/// N = P + k s + c ṡ             a plain element
/// N = max(0, P + k s + c ṡ)     where it pushes only (a stop, a loose head), as long as P + k s > 0, else 0
/// F = N + R tanh(ṡ / v_R)       on the mass above; −F on the mass below
/// ```
///
/// `v_R` is [`FRICTION_VELOCITY`]: Coulomb friction `R sign(ṡ)` with the jump rounded off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainElement {
    /// Coordinate of the mass above.
    pub above: usize,
    /// Coordinate of the mass below; `None` is the base.
    pub below: Option<usize>,
    /// `k`, N/m.
    pub stiffness: f64,
    /// `c`, N·s/m.
    pub damping: f64,
    /// `P`, compression in the reference state, N.
    pub preload: f64,
    /// Whether it pushes only.
    pub unilateral: bool,
    /// `R`, N.
    pub friction: f64,
    /// Tangent coefficient in the factored matrix, N/m.
    factored: f64,
}

impl ChainElement {
    /// An element without friction that pushes and pulls.
    #[must_use]
    pub fn new(above: usize, below: Option<usize>, stiffness: f64, damping: f64, preload: f64) -> Self {
        Self {
            above,
            below,
            stiffness,
            damping,
            preload,
            unilateral: false,
            friction: 0.0,
            factored: 0.0,
        }
    }

    /// `(s, ṡ)`, m and m/s.
    fn compression(&self, motion: &Motion<'_>) -> (f64, f64) {
        let (q, v) = self
            .below
            .map_or((0.0, 0.0), |below| (motion.q[below], motion.v[below]));
        (q - motion.q[self.above], v - motion.v[self.above])
    }

    /// `(F, ∂F/∂s, ∂F/∂ṡ)`.
    fn law(&self, motion: &Motion<'_>) -> (f64, f64, f64) {
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
        (force, stiffness, damping)
    }

    /// Coefficient of the tangent `S = coefficient · u uᵀ`, `u = ∂s/∂q`, N/m.
    fn coefficient(&self, motion: &Motion<'_>, weights: Weights) -> f64 {
        let (_, stiffness, damping) = self.law(motion);
        weights.q * stiffness + weights.v * damping
    }

    fn switches(&self) -> bool {
        self.unilateral || self.friction > 0.0
    }
}

impl Force for ChainElement {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let (normal, ..) = self.law(motion);
        force[self.above] += normal;
        if let Some(below) = self.below {
            force[below] -= normal;
        }
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let s = self.coefficient(motion, weights);
        self.factored = s;
        match self.below {
            Some(below) => blocks.add(&[self.above, below], &[self.above, below], &[s, -s, -s, s]),
            None => blocks.add(&[self.above], &[self.above], &[s]),
        }
    }

    fn push_updates(&mut self, motion: &Motion<'_>, weights: Weights, updates: &mut Updates) {
        if !self.switches() {
            return;
        }
        let change = self.coefficient(motion, weights) - self.factored;
        if change != 0.0 {
            let below = self.below.map(|below| (below, 1.0));
            updates.rank_one(0, 0, change, std::iter::once((self.above, -1.0)).chain(below));
        }
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let (s, _) = self.compression(motion);
        let open_at = -self.preload / self.stiffness;
        // An open element keeps the energy that it had when it opened.
        let s = if self.unilateral && self.stiffness > 0.0 {
            s.max(open_at)
        } else {
            s
        };
        self.preload * s + 0.5 * self.stiffness * s * s
    }

    fn save(&self, out: &mut Vec<f64>) {
        if self.switches() {
            out.push(self.factored);
        }
    }

    fn restore(&mut self, values: &mut std::slice::Iter<'_, f64>) {
        if self.switches()
            && let Some(&factored) = values.next()
        {
            self.factored = factored;
        }
    }
}

/// The strip on the first mass of a chain, in the frame of the base: it rises and falls, nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadMarker {
    /// Coordinate of the mass.
    pub coordinate: usize,
    /// Height above the top of rail where the coordinate is zero, m.
    pub reference_height: f64,
}

impl Marker for HeadMarker {
    fn frame(&self, motion: &Motion<'_>) -> Frame {
        Frame {
            position: Vector3::new(0.0, 0.0, self.reference_height + motion.q[self.coordinate]),
            axes: Matrix3::identity(),
            velocity: Vector3::new(0.0, 0.0, motion.v[self.coordinate]),
            angular_velocity: Vector3::zeros(),
        }
    }

    fn columns(&self, _motion: &Motion<'_>, columns: &mut Columns) {
        columns.push(self.coordinate, Vector3::z(), Vector3::zeros());
    }
}
