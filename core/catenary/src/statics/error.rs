//! Errors of statics.
use dynamics::StepError;

/// Errors of statics.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StaticsError {
    /// The equations of equilibrium could not be solved.
    #[error("the line has no static equilibrium: {0}")]
    NoEquilibrium(#[from] StepError),
    /// The modes of the line were not found.
    #[error("model.reduce = \"modal\": the modes of the line were not found: {reason}")]
    Modes {
        /// Reason.
        reason: String,
    },
    /// Element lengths did not settle.
    #[error(
        "form finding: after {iterations} rounds nodes are still {distance:.3e} m from their nominal x, \
         tolerance {tolerance:.1e} m"
    )]
    FormNotFound {
        /// Rounds used.
        iterations: usize,
        /// Largest distance left, m.
        distance: f64,
        /// Tolerance, m.
        tolerance: f64,
    },
    /// The prescribed heights make the contact wire press a dropper upwards.
    #[error(
        "dropper {dropper} of span {span} at x = {x} m would have to push with {force:.3} N to hold the contact \
         wire at its height: droppers only pull; less presag, or other dropper positions"
    )]
    DropperPushes {
        /// Span, from 1.
        span: usize,
        /// Number within the span, from 1.
        dropper: usize,
        /// Position along the track, m.
        x: f64,
        /// Force that the dropper would push with, N.
        force: f64,
    },
    /// A span cannot stand between its supports.
    #[error(
        "span {span}, held at its supports, has no stable static state: a wire without tension, or a dropper too short"
    )]
    Unstable {
        /// Span, from 1.
        span: usize,
    },
    /// The messenger wire sags to the contact wire or below it.
    #[error(
        "dropper {dropper} of span {span} at x = {x} m would be {length:.4} m long: the messenger wire sags \
         too low; more encumbrance or messenger tension"
    )]
    NoRoomForDropper {
        /// Span, from 1.
        span: usize,
        /// Number within the span, from 1.
        dropper: usize,
        /// Position along the track, m.
        x: f64,
        /// Length left for the dropper, m.
        length: f64,
    },
    /// A wire would break under its static tension.
    #[error("{wire} breaks: static tension {tension:.1} N at x = {x:.2} m, breaking force {limit} N")]
    WireBreaks {
        /// `contact_wire` or `messenger_wire`.
        wire: String,
        /// Largest static tension, N.
        tension: f64,
        /// Position along the track, m.
        x: f64,
        /// `breaking_force` of the scene, N.
        limit: f64,
    },
    /// Ends under tensioning devices come to no rest.
    #[error(
        "the ends of the wires come to no rest at catenary.change.temperature = {temperature} K above the erection; \
         catenary.tensioning.friction may be too small a part of the changes, or the steps between temperatures \
         too large"
    )]
    EndsDoNotSettle {
        /// Temperature above that of the erection, K.
        temperature: f64,
    },
    /// A point asked for is not on the line.
    #[error("x = {x} m is not on the line, which reaches from 0 to {length} m")]
    BesideTheLine {
        /// Position asked for, m.
        x: f64,
        /// Length of the line, m.
        length: f64,
    },
}
