//! `[model]`: what is left out to be faster.

use crate::check::{Found, refuse};
use crate::choice::choice;
use crate::keys::{Entry, Keys, Sentences, placeholder};
use crate::{PantographModel, Scene};

/// `[model]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Model {
    /// Reductions in use, without repetition; empty is the full model.
    pub reductions: Vec<Reduction>,
    /// True where those that change nothing are still to be added, see [`Scene::choose_reductions`]; a scene that was
    /// read has them.
    pub auto: bool,
}

impl Default for Model {
    /// An empty table.
    fn default() -> Self {
        placeholder()
    }
}

impl Model {
    /// True where a reduction is in use.
    #[must_use]
    pub fn has(&self, reduction: Reduction) -> bool {
        self.reductions.contains(&reduction)
    }
}

choice! {
    /// An entry of `model.reduce`.
    pub enum Reduction {
        /// No lateral coordinates of the line: exact where nothing pushes or leads it sideways. Staggered wires and
        /// those in curves keep their lateral places at rest.
        Planar = "planar",
        /// The line linearised about its static, sagging state: exact for small motion only.
        Linearised = "linearised",
        /// The line as straight wires with small slopes that move up and down: what two-dimensional programs take for a
        /// line. It is not the linearisation of the real one, whose sag couples lift and tension.
        Flat = "flat",
        /// Only the spans around the pantographs in full; those beyond linear and reduced to their supports and lowest
        /// modes.
        Window = "window",
        /// The linearised line in its own modes, found once: for many runs over one line, and for real time.
        Modal = "modal",
        /// The mechanism reduced to its one motion.
        Linkage = "linkage",
    }
    unavailable: []
}

impl Entry for Model {
    const SENTENCES: Sentences = &[(
        "reduce",
        "Reductions in use; `\"auto\"` takes those that change nothing.",
    )];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        if let Some(model) = was.filter(|model| model.auto) {
            return model.clone();
        }
        let chosen = keys.words("reduce", was.map(|model| model.reductions.as_slice()));
        Self {
            auto: chosen.is_none(),
            reductions: chosen.unwrap_or_default(),
        }
    }
}

impl Reduction {
    /// True for a reduction of the line.
    fn of_the_line(self) -> bool {
        matches!(
            self,
            Self::Planar | Self::Linearised | Self::Flat | Self::Window | Self::Modal
        )
    }
}

impl Scene {
    /// Why a planar line is not the line itself: what pushes or leads it sideways; `None` where nothing does.
    #[must_use]
    pub fn leaves_its_plane(&self) -> Option<String> {
        let (catenary, _) = self.modelled_line()?;
        if catenary.contact_wire_spacing.is_some() {
            return Some("catenary.contact_wire_spacing sets two contact wires side by side".to_owned());
        }
        if catenary.is_staggered() {
            return Some("catenary.stagger differs from support to support".to_owned());
        }
        if catenary.is_curved() {
            return Some("catenary.curve_radius bends the track".to_owned());
        }
        self.pushed_sideways()
    }

    /// Why the line cannot be planar: what pushes it or its strips sideways; `None` where nothing does.
    #[must_use]
    pub fn pushed_sideways(&self) -> Option<String> {
        self.modelled_line()?;
        if let Some(reason) = self.wind_pushes_sideways() {
            return Some(reason);
        }
        let (vehicle, track) = (self.vehicle.as_deref(), self.track.as_deref());
        if let Some(reason) = vehicle.and_then(|vehicle| vehicle.leaves_the_plane(track)) {
            return Some(reason.to_owned());
        }
        self.pantographs.iter().enumerate().find_map(|(index, pantograph)| {
            let PantographModel::Supplied(side) = &pantograph.model else {
                return None;
            };
            let tilts = side.outputs.contains_key("roll");
            tilts.then(|| format!("pantograph[{}].outputs.roll may tilt the strip", index + 1))
        })
    }

    /// True for a line without lateral coordinates; a flat line never has any.
    #[must_use]
    pub fn is_planar(&self) -> bool {
        self.model.has(Reduction::Planar) || self.model.has(Reduction::Flat)
    }

    /// Resolves `model.reduce = "auto"`: only what changes nothing is left out.
    ///
    /// A linearised line must be asked for: its distance from the nonlinear one is known from a run of both only. So
    /// must a window: its error grows with the time run, with droppers that go slack beyond the window and with echoes
    /// of far ends, which no rule bounds beforehand.
    pub fn choose_reductions(&mut self) {
        let can_be_planar = self.leaves_its_plane().is_none() && self.element_obstacle().is_none();
        if self.model.has(Reduction::Modal) && !self.is_planar() && can_be_planar {
            // Nothing ever excites the modes sideways.
            self.model.reductions.push(Reduction::Planar);
        }
        if !std::mem::take(&mut self.model.auto) {
            return;
        }
        if self.modelled_line().is_some() && can_be_planar {
            self.model.reductions.push(Reduction::Planar);
        }
        if self.linkage_not_reducible().is_none() {
            self.model.reductions.push(Reduction::Linkage);
        }
    }

    /// Reductions that this scene cannot have, alone or together.
    pub(crate) fn check_reductions(&self, found: &mut Found) {
        let mut left_out = |reduction: Reduction, reason: String| leave_out(found, reduction, &reason);
        for &reduction in &self.model.reductions {
            if reduction == Reduction::Planar && self.modelled_line().is_none() {
                // The word asks nothing of a line that is not modelled, and resolved scenes whose line was replaced
                // name it.
                continue;
            }
            if reduction.of_the_line() && self.modelled_line().is_none() {
                left_out(reduction, "the line is a supplied FMU".to_owned());
                continue;
            }
            let of_the_line = reduction.of_the_line();
            let obstacle = self.element_obstacle().filter(|_| of_the_line);
            if let Some(reason) = obstacle.or_else(|| self.wind_forbids(reduction)) {
                left_out(reduction, reason);
                continue;
            }
            match reduction {
                Reduction::Planar | Reduction::Flat => {
                    if let Some(reason) = self.pushed_sideways().or_else(|| self.horns_out_of_plane()) {
                        left_out(reduction, reason);
                    }
                }
                Reduction::Linearised if self.model.has(Reduction::Flat) => {
                    let reason = "\"flat\" is another linear line; one of the two";
                    left_out(reduction, reason.to_owned());
                }
                Reduction::Linkage => {
                    if let Some(reason) = self.linkage_not_reducible() {
                        left_out(reduction, reason);
                    }
                }
                Reduction::Window if self.model.has(Reduction::Flat) => {
                    let reason = "\"flat\" is a line for comparisons, always whole; one of the two";
                    left_out(reduction, reason.to_owned());
                }
                Reduction::Modal if self.model.has(Reduction::Window) => {
                    let reason = "\"window\" models a part of the line, whose modes are not those of the line; one of \
                                  the two";
                    left_out(reduction, reason.to_owned());
                }
                Reduction::Modal if self.holds_strips() => {
                    let reason = "contact.law = \"sliding_joint\" holds the strip on the wire: \"modal\" needs the \
                                  penalty law";
                    left_out(reduction, reason.to_owned());
                }
                Reduction::Modal => {
                    if let Some(reason) = self.horns_out_of_plane() {
                        left_out(
                            reduction,
                            format!("{reason}, and \"modal\" lets strips lift the wire only"),
                        );
                    }
                }
                Reduction::Window if self.solver.fixed_work => {
                    let reason = "solver.fixed_work factors once, and a window factors anew with every move; \
                                  \"modal\", or the line as it is";
                    left_out(reduction, reason.to_owned());
                }
                Reduction::Linearised | Reduction::Window => {}
            }
        }
    }

    /// Why horns forbid a line that strips do not push sideways.
    fn horns_out_of_plane(&self) -> Option<String> {
        let index = self
            .pantographs
            .iter()
            .position(|pantograph| pantograph.horns().is_some())?;
        let reason = self.leaves_its_plane()?;
        Some(format!(
            "{reason}, so that the wire may come onto pantograph[{}].strip.horns, which push it sideways",
            index + 1
        ))
    }

    /// True under a sliding joint.
    fn holds_strips(&self) -> bool {
        self.modelled_line()
            .is_some_and(|(_, contact)| contact.law == crate::ContactLaw::SlidingJoint)
    }

    /// A window is cut out of the line at its masts.
    pub(crate) fn check_window(&self, found: &mut Found) {
        if self.model.has(Reduction::Window)
            && let Some((catenary, _)) = self.modelled_line()
            && let Some(reason) = catenary.without_window()
        {
            leave_out(found, Reduction::Window, reason);
        }
    }
}

/// Refuses a reduction.
fn leave_out(found: &mut Found, reduction: Reduction, reason: &str) {
    let expected = format!("must be left out: {reason}");
    refuse(found, "model.reduce", format!("\"{reduction}\""), expected);
}
