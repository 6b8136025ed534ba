//! Bushings: springs and dampers between two bodies in all six directions.
use super::measure::{WIDTH, add_square};
use super::{BodyNow, Characteristic, Grip, Measure, Pair, Wrench};
use dynamics::{Blocks, Force, Marker, Motion, Weights};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

mod set;
#[cfg(test)]
mod tests;

pub(crate) use set::Bushings;

/// Rates of a bushing along and about the axes of the first anchor, one entry per axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    /// N/m.
    pub stiffness: Vector3<f64>,
    /// N·s/m.
    pub damping: Vector3<f64>,
    /// N·m/rad.
    pub rotational_stiffness: Vector3<f64>,
    /// N·m·s/rad.
    pub rotational_damping: Vector3<f64>,
}

impl Rates {
    /// True for a bushing that resists rotations.
    fn resists_rotation(&self) -> bool {
        self.rotational_stiffness != Vector3::zeros() || self.rotational_damping != Vector3::zeros()
    }
}

/// A spring–damper in six directions between two anchors [Thesis, section 3.1].
///
/// ```text
/// d_i = a_i · (r_B − r_A)                        displacement along axis i of the first anchor, m
/// s_i = ½ (a_k · b_j − a_j · b_k)                i, j, k cyclic: rotation of the second anchor about it, –
/// F_i = P_i − k_i d_i − c_i ḋ_i − f_i(d_i),      M_i = −κ_i s_i − γ_i ṡ_i
/// U   = Σ ½ k_i d_i² + ∫f_i − P_i d_i + ½ κ_i s_i²
/// ```
///
/// `F_i` acts along `a_i` on the second anchor, and against `a_i` on the first body at the same point. A relative
/// rotation by φ about the unit vector n gives `s = n sin φ`: the rotation vector but for φ³/6, without the singularity
/// of the rotation vector, and with a potential, so that forces and moments conserve energy at any angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Bushing {
    /// Anchors of the bushing.
    pub pair: Pair,
    /// Linear part.
    pub rates: Rates,
    /// `P`, N: the force on the second anchor at `d = 0` at rest.
    pub preload: Vector3<f64>,
    /// `f_i`, added to the linear part.
    pub characteristics: [Option<Characteristic>; 3],
}

/// Displacements and forces of a bushing at one instant, along and about the axes of the first anchor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BushingLoad {
    /// `d`, m.
    pub displacement: Vector3<f64>,
    /// `F`, N, on the second anchor.
    pub force: Vector3<f64>,
    /// `M`, N·m, on the second anchor.
    pub moment: Vector3<f64>,
    /// Power turned into heat, W.
    pub dissipated: f64,
}

/// A bushing at one instant.
struct BushingView {
    load: BushingLoad,
    /// From the first anchor to the second one, m.
    distance: Vector3<f64>,
    /// Axes of the first anchor.
    axes: Matrix3<f64>,
    /// `∂s_i/∂φ_B` of a bushing that resists rotations.
    turns: Option<[Vector3<f64>; 3]>,
}

/// `∂s_i/∂φ_B` for each axis.
fn turns(a: &Matrix3<f64>, b: &Matrix3<f64>) -> [Vector3<f64>; 3] {
    let axis = |axes: &Matrix3<f64>, i: usize| axes.column(i).into_owned();
    [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        0.5 * (axis(b, j).cross(&axis(a, k)) - axis(b, k).cross(&axis(a, j)))
    })
}

impl Bushing {
    /// Two cosines whose half difference is `s_i`.
    fn cosines(i: usize) -> [Measure; 2] {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        [Measure::Direction(k, j), Measure::Direction(j, k)]
    }

    #[inline]
    fn view(&self, [a, b]: &[Grip<'_>; 2]) -> BushingView {
        let Rates {
            stiffness,
            damping,
            rotational_stiffness,
            rotational_damping,
        } = self.rates;
        let distance = b.position() - a.position();
        let axes = a.axes();
        let to_first = axes.transpose();
        let displacement = to_first * distance;
        let mut load = BushingLoad {
            displacement,
            force: self.preload - stiffness.component_mul(&displacement),
            moment: Vector3::zeros(),
            dissipated: 0.0,
        };
        if damping != Vector3::zeros() {
            let rate = to_first * (b.velocity() - a.velocity() - a.angular_velocity().cross(&distance));
            let viscous = damping.component_mul(&rate);
            load.force -= viscous;
            load.dissipated = viscous.dot(&rate);
        }
        for (axis, curve) in self.characteristics.iter().enumerate() {
            if let Some(curve) = curve {
                load.force[axis] -= curve.at(displacement[axis]).force;
            }
        }
        let turns = self.rates.resists_rotation().then(|| {
            let axes_of_b = b.axes();
            let turns = turns(&axes, &axes_of_b);
            let relative = b.angular_velocity() - a.angular_velocity();
            let cross = to_first * axes_of_b;
            for i in 0..3 {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                let turn = 0.5 * (cross[(k, j)] - cross[(j, k)]);
                let rate = turns[i].dot(&relative);
                load.moment[i] = -rotational_stiffness[i] * turn - rotational_damping[i] * rate;
                load.dissipated += rotational_damping[i] * rate * rate;
            }
            turns
        });
        BushingView {
            load,
            distance,
            axes,
            turns,
        }
    }

    /// Displacements and forces now.
    #[must_use]
    pub fn load(&self, motion: &Motion<'_>) -> BushingLoad {
        let now = self.bodies_now(motion);
        self.view(&self.grips(motion, [now[0].as_ref(), now[1].as_ref()])).load
    }

    /// The bodies of both anchors.
    fn bodies_now(&self, motion: &Motion<'_>) -> [Option<BodyNow>; 2] {
        [&self.pair.first, &self.pair.second].map(|anchor| anchor.pose().map(|pose| pose.now(motion)))
    }

    /// Both anchors on their bodies as they are now.
    #[inline]
    fn grips<'a>(&'a self, motion: &Motion<'_>, now: [Option<&'a BodyNow>; 2]) -> [Grip<'a>; 2] {
        [
            self.pair.first.grip(motion, now[0]),
            self.pair.second.grip(motion, now[1]),
        ]
    }

    /// Forces on the bodies of both anchors.
    #[inline]
    fn wrenches(&self, grips: &[Grip<'_>; 2]) -> [Wrench; 2] {
        let BushingView {
            load,
            distance,
            axes,
            turns,
        } = self.view(grips);
        let along = axes * load.force;
        let mut wrenches = [
            Wrench {
                force: -along,
                moment: -(grips[0].lever() + distance).cross(&along),
            },
            Wrench {
                force: along,
                moment: grips[1].lever().cross(&along),
            },
        ];
        if let Some(turns) = turns {
            let about: Vector3<f64> = turns.iter().zip(load.moment.iter()).map(|(turn, m)| turn * *m).sum();
            wrenches[0].moment -= about;
            wrenches[1].moment += about;
        }
        wrenches
    }
}

impl Force for Bushing {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let now = self.bodies_now(motion);
        let wrenches = self.wrenches(&self.grips(motion, [now[0].as_ref(), now[1].as_ref()]));
        for ((anchor, now), wrench) in [&self.pair.first, &self.pair.second]
            .into_iter()
            .zip(&now)
            .zip(&wrenches)
        {
            if let (Some(pose), Some(now)) = (anchor.pose(), now) {
                wrench.add_to(pose, now, force);
            }
        }
    }

    fn depends_on_inputs(&self) -> bool {
        false
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let view = self.pair.view(motion);
        let load = self.load(motion);
        let mut v = SVector::<f64, WIDTH>::zeros();
        for (v, &index) in v.iter_mut().zip(view.indices()) {
            *v = motion.v[index];
        }
        let mut tangent = SMatrix::<f64, WIDTH, WIDTH>::zeros();
        let mut add = |gradient: SVector<f64, WIDTH>,
                       hessian: SMatrix<f64, WIDTH, WIDTH>,
                       (force, stiffness, damping): (f64, f64, f64)| {
            // ∂ṡ/∂q at constant v
            let rate_q = hessian.transpose() * v;
            let of_q = gradient * (gradient * stiffness + rate_q * damping).transpose() - hessian * force;
            tangent += of_q * weights.q + gradient * gradient.transpose() * (damping * weights.v);
        };
        for i in 0..3 {
            let curve = self.characteristics[i].as_ref();
            let steeper = curve.map_or(0.0, |curve| curve.at(load.displacement[i]).stiffness);
            let (stiffness, damping) = (self.rates.stiffness[i] + steeper, self.rates.damping[i]);
            if curve.is_some() || stiffness != 0.0 || damping != 0.0 || self.preload[i] != 0.0 {
                let measure = Measure::Along(i);
                let law = (load.force[i], stiffness, damping);
                add(view.gradient(measure), view.hessian(measure), law);
            }
            let (stiffness, damping) = (self.rates.rotational_stiffness[i], self.rates.rotational_damping[i]);
            if stiffness != 0.0 || damping != 0.0 {
                let [plus, minus] = Self::cosines(i);
                let gradient = 0.5 * (view.gradient(plus) - view.gradient(minus));
                let hessian = 0.5 * (view.hessian(plus) - view.hessian(minus));
                add(gradient, hessian, (load.moment[i], stiffness, damping));
            }
        }
        add_square(blocks, view.indices(), &tangent);
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let (a, b) = (self.pair.first.frame(motion), self.pair.second.frame(motion));
        let d = a.axes.transpose() * (b.position - a.position);
        let cross = a.axes.transpose() * b.axes;
        (0..3)
            .map(|i| {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                let turn = 0.5 * (cross[(k, j)] - cross[(j, k)]);
                let curve = self.characteristics[i].as_ref();
                0.5 * self.rates.stiffness[i] * d[i] * d[i] - self.preload[i] * d[i]
                    + curve.map_or(0.0, |curve| curve.at(d[i]).energy)
                    + 0.5 * self.rates.rotational_stiffness[i] * turn * turn
            })
            .sum()
    }
}
