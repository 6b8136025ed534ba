//! Errors of a pantograph or the vehicle under the pantograph.

use crate::wheel_rail::ProfileError;

/// Reason why a pantograph could not be built or has no equilibrium.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VehicleError {
    /// The scene hands the pantograph to a supplied FMU.
    #[error("the pantograph is the FMU {fmu}: it has no equations here")]
    Supplied {
        /// Path of the FMU as written in the scene.
        fmu: String,
    },
    /// The height at which the grounded spring is unstretched is not known.
    #[error(
        "pantograph.reference_height is not set: give the height (m) of the strip at which the last spring is \
         unstretched"
    )]
    NoReferenceHeight,
    /// A name that belongs to no body of the linkage.
    #[error("pantograph.{key} = \"{name}\": the linkage has no body of this name")]
    UnknownBody {
        /// Key in the scene.
        key: &'static str,
        /// Name found under the key.
        name: String,
    },
    /// The body that the uplift acts on does not stand on the base.
    #[error("pantograph.uplift.body = \"{name}\" has no joint with the base to measure the distance from")]
    NoBaseJoint {
        /// The body.
        name: String,
    },
    /// The strip's body is not guided by exactly one prismatic joint.
    #[error(
        "pantograph.strip.body = \"{name}\" has {count} prismatic joints: the collector suspension needs exactly one"
    )]
    NoSuspension {
        /// The body.
        name: String,
        /// Number of its prismatic joints.
        count: usize,
    },
    /// The suspension's preload and the contact force cannot balance the tabulated position.
    #[error(
        "the linkage is not in balance in its tabulated position: {residual:.3e} N remain in {coordinate} whatever the \
         contact force and the preload of the collector suspension"
    )]
    NotBalanced {
        /// Largest force left, N or N·m.
        residual: f64,
        /// Name of the coordinate with the largest force.
        coordinate: String,
    },
    /// The mechanism has other motions than one.
    #[error("the linkage cannot be reduced to one motion: {reason}; leave \"linkage\" out of model.reduce")]
    NotReducible {
        /// Reason.
        reason: Irreducible,
    },
    /// A chain element that only pushes would have to pull, or nothing carries the difference to the static force.
    #[error(
        "no equilibrium under a contact force of {force:.3} N: the raised pantograph exerts {static_force:.3} N at rest"
    )]
    OutOfReach {
        /// Contact force, N.
        force: f64,
        /// Force at the reference height, N.
        static_force: f64,
    },
    /// Newton's method did not find an equilibrium of the linkage.
    #[error(
        "no equilibrium of the linkage at {target}: it may not reach there ({residual:.3e} N or m remain after \
         {iterations} iterations, tolerance {tolerance:.1e})"
    )]
    NotConverged {
        /// Requested target ("strip height 5.3 m").
        target: String,
        /// Newton iterations done.
        iterations: usize,
        /// Largest residual left, N, N·m or m.
        residual: f64,
        /// Tolerance of the residual.
        tolerance: f64,
    },
    /// Points that make no force–displacement curve.
    #[error(
        "vehicle.bushings \"{name}\".stop must have two points or more, its displacements must ascend and its forces \
         must not fall"
    )]
    NoCharacteristic {
        /// Name of the bushing.
        name: String,
    },
    /// A table that has to be read from a file first.
    #[error("{key} = {file:?}: must be read into the scene first, as `master` does; or give the lists themselves")]
    Unread {
        /// Key in the scene.
        key: &'static str,
        /// Path of the file.
        file: String,
    },
    /// A start on a cant ramp, where a vehicle is not at rest.
    #[error(
        "{path}: start = {start} m must be {least:.3} m or more: a run starts at rest on straight track, the foremost \
         wheel or the pantograph's base at {ahead:.3} m, and the cant ramp begins half its rounding = {rounding} m \
         before"
    )]
    StartsInCurve {
        /// Key of the curve.
        path: String,
        /// Begin of the transition, m.
        start: f64,
        /// Smallest begin of the transition, m.
        least: f64,
        /// Foremost wheel or base at the start, m.
        ahead: f64,
        /// Rounding of the cant ramp, m.
        rounding: f64,
    },
    /// A vehicle in space without data that its wheels need.
    #[error("vehicle.model = \"full\" needs {key}")]
    Missing {
        /// Key or table in the scene.
        key: &'static str,
    },
    /// A point list that makes no profile.
    #[error("{key}: {reason}")]
    Profile {
        /// Key in the scene.
        key: &'static str,
        /// Reason.
        reason: ProfileError,
    },
    /// A rail profile without a gauge face.
    #[error("track.rail.profile must reach from the gauge face, 14 mm below its top, over the top")]
    NoGaugeFace,
    /// The vehicle has no state of rest.
    #[error("no equilibrium of the vehicle")]
    Unsettled(#[source] dynamics::StepError),
    /// Pantograph and vehicle do not come to rest together.
    #[error(
        "no common equilibrium of vehicle and pantograph: the base still moves by {change:.1e} m after \
         {iterations} iterations"
    )]
    Restless {
        /// Change of the base in the last iteration, m.
        change: f64,
        /// Iterations done.
        iterations: usize,
    },
    /// A model without a point that a drive could act on.
    #[error("pantograph.control: this pantograph has no point that a drive could act on")]
    NoDrive,
    /// A name that belongs to no revolute joint of the linkage.
    #[error("pantograph.control.actuator.joint = \"{name}\": the linkage has no revolute joint of this name")]
    UnknownJoint {
        /// Name found under the key.
        name: String,
    },
    /// A joint whose moment does not press the strip against the wire.
    #[error(
        "pantograph.control.actuator.joint = \"{name}\": a moment on it does not raise the strip in the tabulated \
         position (it bears {ratio:.1e} N of contact force per N m): drive another joint"
    )]
    RaisesNothing {
        /// Name of the joint.
        name: String,
        /// Contact force per moment, 1/m.
        ratio: f64,
    },
    /// A regulator without gains.
    #[error("pantograph.control: {0}")]
    NoGains(#[from] control::NoGains),
    /// The accelerations at the start are not determined.
    #[error("the pantograph cannot start: {0}")]
    Start(#[from] dynamics::StepError),
}

impl From<Irreducible> for VehicleError {
    fn from(reason: Irreducible) -> Self {
        Self::NotReducible { reason }
    }
}

/// Reason why a linkage cannot be reduced to one motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Irreducible {
    /// The base of the linkage moves.
    #[error("its base moves")]
    BaseMoves,
    /// Joints leave other motions free.
    #[error("{0}")]
    Motions(String),
    /// The strip's body has no prismatic joint with a moving body.
    #[error("{name} is guided by no moving body")]
    NoGuide {
        /// The strip's body.
        name: String,
    },
    /// More than one motion of the mechanism without the strip's body.
    #[error("it has several motions in the tabulated position")]
    SeveralMotions,
    /// The motion turns no body.
    #[error("no body turns")]
    NoTurn,
    /// The motion ends at the tabulated position.
    #[error("its tabulated position is singular")]
    Singular,
}
