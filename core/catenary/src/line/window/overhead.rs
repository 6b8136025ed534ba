//! A windowed line as an overhead line.
use super::curve::{Elsewhere, WindowCurve};
use super::plan::Arrangement;
use super::{WindowedLine, span_at};
use crate::{DropperSample, Line, NodeOfWire, OverheadLine, WireCurve, WireName};
use dynamics::{Continuity, Force, Motion, PartVisitor, State, StepHistory};
use nalgebra::Vector3;
use std::ops::Range;
use std::sync::Arc;

impl WindowedLine {
    /// Visits the histories of the inner line, always in the same order.
    fn histories(&mut self, visit: &mut dyn FnMut(&mut dyn StepHistory)) {
        self.inner.forces(&mut |force| {
            if let Some(history) = force.step_history() {
                visit(history);
            }
        });
    }
}

impl OverheadLine for WindowedLine {
    fn parts(&mut self, visit: &mut PartVisitor<'_>) {
        self.inner.parts(visit);
        visit("wires", &mut self.far);
    }

    fn contact_wires(&self) -> usize {
        self.fixed.topology.contact_wires().count()
    }

    fn contact_curve(&self, (strip, wire): (usize, usize)) -> Arc<dyn WireCurve> {
        let Some(own) = self.own_wires[wire] else {
            return Arc::new(Elsewhere);
        };
        Arc::new(WindowCurve {
            inner: self.inner.contact_curve((strip, own)),
            position: self.fixed.position,
            origin: self.origin,
        })
    }

    /// Slack droppers of the window; those of reduced spans are always taut.
    fn slack_count(&self, motion: &Motion<'_>) -> usize {
        self.inner.slack_count(motion)
    }

    fn elongations(&self) -> &[f64] {
        self.inner.elongations()
    }

    fn energy(&self, motion: &Motion<'_>) -> f64 {
        self.inner.energy(motion) - self.energy_at_rest + self.far.energy(motion)
    }

    fn dropper_samples(&self, motion: &Motion<'_>) -> Vec<DropperSample> {
        let start = Vector3::x() * self.start();
        let mut samples: Vec<DropperSample> = self.inner.dropper_samples(motion);
        for sample in &mut samples {
            sample.top += start;
            sample.bottom += start;
        }
        let fixed = &self.fixed;
        let node = |at: NodeOfWire| fixed.equilibrium.wires[at.wire].nodes()[at.node].position;
        for span in self.drawn().filter(|span| !self.arrangement.window.contains(span)) {
            let from = fixed.source_of(span, 1);
            let shift = Vector3::x() * (fixed.supports_x[span] - fixed.topology.mast_x(from));
            let droppers = fixed.topology.droppers().iter().zip(&fixed.equilibrium.dropper_lengths);
            let of_span = droppers.filter(|(place, _)| fixed.topology.span_of(place) == from);
            samples.extend(of_span.map(|(place, unstressed_length)| {
                let [top, bottom] = [place.upper, place.lower].map(|at| node(at) + shift);
                let elongation = (top - bottom).norm() - unstressed_length;
                DropperSample {
                    top,
                    bottom,
                    force: (fixed.catenary.droppers.stiffness * elongation).max(0.0),
                }
            }));
        }
        samples
    }

    fn shape(&self) -> Option<&Line> {
        None
    }

    fn shape_mut(&mut self) -> Option<&mut Line> {
        None
    }

    fn support_count(&self) -> usize {
        self.fixed.supports_x.len()
    }

    fn set_uplift_reference(&mut self, q: &[f64]) {
        self.uplift_reference.fill(0.0);
        let wires = self.fixed.most_wires_at_a_mast();
        for support in self.arrangement.modelled.start..=self.arrangement.modelled.end {
            let rises: Vec<f64> = self.rises(support).map(|index| q[index]).collect();
            self.uplift_reference[wires * support..][..rises.len()].copy_from_slice(&rises);
        }
    }

    /// A support that is not modelled at present stands at its static height.
    fn uplift(&self, support: usize, q: &[f64]) -> f64 {
        let at_rest = -self.uplift_reference[self.fixed.most_wires_at_a_mast() * support];
        let rise = self.most_lifted(support, q).map_or(at_rest, |(rise, _)| rise);
        // A wire that ends at the mast does not move.
        if self.fixed.topology.has_inner_end(self.fixed.source_support(support)) {
            rise.max(0.0)
        } else {
            rise
        }
    }

    fn uplift_rate(&self, support: usize, q: &[f64], v: &[f64]) -> f64 {
        let ends = self.fixed.topology.has_inner_end(self.fixed.source_support(support));
        let lifted = self.most_lifted(support, q).filter(|(rise, _)| !ends || *rise > 0.0);
        lifted.map_or(0.0, |(_, index)| v[index])
    }

    /// Reduced spans and those beyond are drawn at rest.
    fn polylines(&self, name: WireName, q: &[f64], most: usize) -> Vec<Vec<Vector3<f64>>> {
        let fixed = &self.fixed;
        let drawn = self.drawn();
        let shape = self.inner.shape();
        let window = fixed.source_of(self.arrangement.at, fixed.plan.window);
        let window = window..window + fixed.plan.window;
        // The wire of the window that a wire of the whole line is cut to, and its node at the left of a span.
        let in_window = |number: usize, span: usize| {
            let present = |number: &usize| !fixed.topology.nodes_in(*number, &window).is_empty();
            let own = shape?.wires().get((0..number).filter(present).count())?.geometry();
            let from = window.start + span - self.arrangement.at;
            let node = fixed.topology.nodes_in(number, &(from..from + 1)).start;
            Some((own, node - fixed.topology.nodes_in(number, &window).start))
        };
        let of_name = |number: &usize| fixed.topology.wires()[*number].name == name;
        let numbers: Vec<usize> = (0..fixed.topology.wires().len()).filter(of_name).collect();
        let nodes_in = |number: usize, span: usize| {
            let from = fixed.source_of(span, 1);
            fixed.topology.nodes_in(number, &(from..from + 1))
        };
        let elements = |span: usize| {
            let all = numbers.iter().map(|&wire| nodes_in(wire, span).len().saturating_sub(1));
            all.max().unwrap_or(0)
        };
        let stride = drawn.clone().map(elements).sum::<usize>().div_ceil(most).max(1);
        let mut lines = Vec::new();
        for number in numbers {
            let mut points = Vec::new();
            let rest = &fixed.equilibrium.wires[number];
            for span in drawn.clone() {
                let range = nodes_in(number, span);
                let left = fixed.topology.mast_x(fixed.source_of(span, 1));
                let at_rest = Vector3::x() * (fixed.supports_x[span] - left);
                if range.is_empty() {
                    continue;
                }
                let moves = self.arrangement.window.contains(&span);
                let own = if moves { in_window(number, span) } else { None };
                let goes_on = !nodes_in(number, (span + 1).min(fixed.plan.spans - 1)).is_empty();
                let last = usize::from(span + 1 == drawn.end || name == WireName::StitchWire || !goes_on);
                let shown = range.clone().take(range.len().saturating_sub(1) + last);
                for node in shown.filter(|node| (node - range.start) % stride == 0 || node + 1 == range.end) {
                    points.push(match own {
                        Some((wire, first)) => {
                            wire.nodes()[first + node - range.start].at(q).0 + Vector3::x() * self.start()
                        }
                        None => rest.nodes()[node].position + at_rest,
                    });
                }
            }
            if !points.is_empty() {
                lines.push(points);
            }
        }
        lines
    }

    fn follow(&mut self, (rear, _): (f64, f64), state: &mut State) -> Continuity {
        let at = self.fixed.plan.position(span_at(&self.fixed.supports_x, rear));
        if at <= self.arrangement.at {
            return Continuity::Kept;
        }
        let next = self.fixed.arrangement(at);
        let source = |arrangement: &Arrangement| self.fixed.source_of(arrangement.at, self.fixed.plan.window);
        let places = if source(&next) == source(&self.arrangement) {
            Arc::clone(&self.places)
        } else {
            Arc::new(self.fixed.places(&next))
        };
        self.fixed
            .transfer((&self.arrangement, &self.places), (&next, &places), state);
        state.q[self.fixed.position] = self.fixed.supports_x[at] - self.origin;
        let mut history = Vec::new();
        self.histories(&mut |kept| kept.save(&mut history));
        let continuity = self.go_to(next);
        if continuity == Continuity::Replaced {
            // Droppers know from the step that has just ended how the next one begins.
            // Windows may have different droppers: those that the window has too many or too few of start anew below.
            let mut own = Vec::new();
            self.histories(&mut |kept| kept.save(&mut own));
            let common = own.len().min(history.len());
            own[..common].copy_from_slice(&history[..common]);
            let mut values = own.iter();
            self.histories(&mut |kept| kept.restore(&mut values));
        }
        for &index in self.held.iter().filter(|&&index| index != self.fixed.position) {
            for values in [&mut state.q, &mut state.v, &mut state.v_dot, &mut state.a] {
                values[index] = 0.0;
            }
        }
        let motion = state.motion(&[]);
        self.histories(&mut |kept| kept.end_step(&motion));
        continuity
    }

    fn adopt(&mut self, state: &State) -> Continuity {
        let x = self.origin + state.q[self.fixed.position];
        // Supports are metres apart.
        let at = self.fixed.supports_x.partition_point(|&support| support < x - 1e-3);
        if at == self.arrangement.at {
            return Continuity::Kept;
        }
        let next = self.fixed.arrangement(at);
        self.go_to(next)
    }

    fn held(&self) -> Option<(Range<usize>, &[usize])> {
        Some((self.fixed.coordinates.clone(), &self.held))
    }
}
