//! Displacement of the contact wires in a steady wind.
use super::{Standalone, StaticLine, StaticsError, options};
use crate::{Dimension, WireName};
use dynamics::solve_static;
use serde::{Deserialize, Serialize};

/// The contact wire of one span in the mean wind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BlowOffReport {
    /// Tension length, counted from 1.
    pub tension_length: usize,
    /// Span of the tension length, counted from 1.
    pub span: usize,
    /// Place along the track of the largest lateral position, m.
    #[serde(rename = "x_m")]
    pub x: f64,
    /// Largest lateral position in the wind about the track centre, positive to the left, m.
    #[serde(rename = "lateral_m")]
    pub lateral: f64,
    /// Largest displacement by the wind in the span, positive to the left, m.
    #[serde(rename = "displacement_m")]
    pub displacement: f64,
}

impl StaticLine {
    /// Equilibrium of the line in the mean wind, without gusts and turbulence: the contact wire span by span. Nothing
    /// without wind on the wires, or in the plane.
    ///
    /// # Errors
    /// See [`StaticsError`].
    pub fn blow_off(&self) -> Result<Vec<BlowOffReport>, StaticsError> {
        let Some(wind) = &self.wind else { return Ok(Vec::new()) };
        if self.topology.options().dimension == Dimension::Planar {
            return Ok(Vec::new());
        }
        let mut system = Standalone {
            line: self.system.line.clone().in_wind(Some(&wind.steady())),
            ..self.system.clone()
        };
        let mut state = system.layout.state_at_rest();
        solve_static(&mut system, &mut state, &[], &options(500, &self.topology))?;
        let mut reports: Vec<BlowOffReport> = Vec::new();
        for (planned, wire) in self.topology.wires().iter().zip(system.line.wires()) {
            if planned.name != WireName::ContactWire {
                continue;
            }
            for (node, &span) in wire.geometry().nodes().iter().zip(&planned.span) {
                let (position, _) = node.at(&state.q);
                let here = BlowOffReport {
                    tension_length: planned.section + 1,
                    span: span.max(1),
                    x: position.x,
                    lateral: position.y,
                    displacement: position.y - node.position.y,
                };
                let same =
                    |known: &&mut BlowOffReport| (known.tension_length, known.span) == (here.tension_length, here.span);
                match reports.iter_mut().find(same) {
                    None => reports.push(here),
                    Some(known) => {
                        if here.lateral.abs() > known.lateral.abs() {
                            (known.x, known.lateral) = (here.x, here.lateral);
                        }
                        if here.displacement.abs() > known.displacement.abs() {
                            known.displacement = here.displacement;
                        }
                    }
                }
            }
        }
        let Some(spans) = self.spans_of_short_line() else {
            return Ok(reports);
        };
        let whole = spans.enumerate().filter_map(|(span, (source, shift))| {
            let known = reports.iter().find(|known| known.span == source + 1)?;
            Some(BlowOffReport {
                span: span + 1,
                x: known.x + shift,
                ..*known
            })
        });
        Ok(whole.collect())
    }
}
