//! Forces, tangent and mass of a reduced linkage in its two coordinates.
use super::ReducedLinkage;
use dynamics::{Blocks, Force, Motion, OnePass, Weights};

impl Force for ReducedLinkage {
    fn add_force(&mut self, motion: &Motion<'_>, force: &mut [f64]) {
        let i = self.offsets.coordinate;
        let place = self.motion.place(motion.q[i], motion.q[i + 1]);
        let v = [motion.v[i], motion.v[i + 1]];
        let [along_sigma, along_zeta] = self.rest_force(&place);
        let damper = self.damping * (place.s_q[0] * v[0] + place.s_q[1] * v[1]);
        let carried = self.motion.mass * (place.x_sigma_sigma * v[0] + 2.0 * place.x_sigma_zeta * v[1]) * v[0];
        force[i] += along_sigma - damper * place.s_q[0] - carried * place.x_sigma;
        force[i + 1] += along_zeta - damper * place.s_q[1] - carried * place.x_zeta;
    }

    fn add_tangent(&mut self, motion: &Motion<'_>, weights: Weights, blocks: &mut Blocks<'_>) {
        let i = self.offsets.coordinate;
        let place = self.motion.place(motion.q[i], motion.q[i + 1]);
        let [k11, k12, k21, k22] = self.stiffness(&place);
        let v = [motion.v[i], motion.v[i + 1]];
        let s_q = place.s_q;
        // ∂ṡ/∂q at constant v
        let rate_q = [
            place.s_sigma_sigma * v[0] + place.s_sigma_zeta * v[1],
            place.s_sigma_zeta * v[0],
        ];
        let rate = s_q[0] * v[0] + s_q[1] * v[1];
        let c = self.damping;
        let stiffness = [
            k11 + c * (s_q[0] * rate_q[0] + rate * place.s_sigma_sigma),
            k12 + c * (s_q[0] * rate_q[1] + rate * place.s_sigma_zeta),
            k21 + c * (s_q[1] * rate_q[0] + rate * place.s_sigma_zeta),
            k22 + c * s_q[1] * rate_q[1],
        ];
        // Derivative of the velocity's inertia forces with respect to the velocity; the derivative with respect to the
        // position is of the order of a turn within a step and is left out.
        let carried_v = [
            2.0 * self.motion.mass * (place.x_sigma_sigma * v[0] + place.x_sigma_zeta * v[1]),
            2.0 * self.motion.mass * place.x_sigma_zeta * v[0],
        ];
        let x_q = [place.x_sigma, place.x_zeta];
        let mut values = [0.0; 4];
        for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let damping = c * s_q[row] * s_q[column] + x_q[row] * carried_v[column];
            values[2 * row + column] = weights.q * stiffness[2 * row + column] + weights.v * damping;
        }
        blocks.add(&[i, i + 1], &[i, i + 1], &values);
    }

    /// Mass matrix of the start: [`OnePass::add_dynamic_force`] takes the present one.
    fn add_mass(&self, blocks: &mut Blocks<'_>) {
        let i = self.offsets.coordinate;
        let place = self.motion.place(self.start[0], self.start[1]);
        blocks.add(&[i, i + 1], &[i, i + 1], &place.mass(self.motion.mass));
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        let i = self.offsets.coordinate;
        let place = self.motion.place(motion.q[i], motion.q[i + 1]);
        place.potential[0] + self.motion.weight * place.zeta + 0.5 * self.stiffness * place.s * place.s
            - self.preload * place.s
    }

    fn one_pass(&mut self) -> Option<&mut dyn OnePass> {
        Some(self)
    }
}

impl OnePass for ReducedLinkage {
    fn add_dynamic_force(&mut self, motion: &Motion<'_>, v_dot: &[f64], force: &mut [f64]) {
        self.add_force(motion, force);
        let i = self.offsets.coordinate;
        let place = self.motion.place(motion.q[i], motion.q[i + 1]);
        let [m11, m12, m21, m22] = place.mass(self.motion.mass);
        force[i] -= m11 * v_dot[i] + m12 * v_dot[i + 1];
        force[i + 1] -= m21 * v_dot[i] + m22 * v_dot[i + 1];
    }
}
