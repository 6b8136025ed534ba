//! Droppers and supports of a line at rest as CSV.

use super::LinePage;
use crate::report::format::fixed;

impl LinePage {
    /// Droppers for the workshop.
    #[must_use]
    pub fn droppers_csv(&self) -> String {
        let mut text =
            "tension_length,span,dropper,position_m,hangs_from,x_m,unstressed_length_m,force_N,from,to\n".to_owned();
        for dropper in &self.droppers {
            let [from, to] = &dropper.wires;
            text.push_str(&format!(
                "{},{},{},{:.3},{},{:.3},{:.4},{:.1},{from},{to}\n",
                dropper.tension_length,
                dropper.span,
                dropper.number,
                dropper.position,
                dropper.hangs_from,
                dropper.bottom[0],
                dropper.length,
                dropper.force
            ));
        }
        text
    }

    /// Supports, as a table.
    #[must_use]
    pub fn supports_csv(&self) -> String {
        let mut text = "tension_length,support,x_m,contact_wire_height_m,encumbrance_m,stagger_m,\
                        messenger_reaction_N,arm_force_N,gradient,gradient_change,arm_lateral_N,radius_m\n"
            .to_owned();
        for support in &self.supports {
            text.push_str(&format!(
                "{},{},{:.3},{:.4},{},{:.3},{:.1},{:.1},{},{},{},{}\n",
                support.tension_length,
                support.number,
                support.x,
                support.height,
                fixed(support.encumbrance, 5),
                support.stagger,
                support.messenger_reaction,
                support.arm_force,
                fixed(support.gradient, 5),
                fixed(support.change, 5),
                fixed(support.arm_lateral, 1),
                fixed(support.radius, 1)
            ));
        }
        text
    }
}
