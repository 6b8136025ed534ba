//! `model = "linkage"`: a pantograph of rigid bodies and joints.

use crate::keys::{Entry, Keys, Number, Sentences};
use crate::pantograph::HORNS;
use crate::{HeadStrip, Horns};

/// `model = "linkage"`.
///
/// Positions, points and axes are given in the mechanism's own coordinates, whose axes are those of the track and whose
/// origin is free; [`Linkage::base`] says where the mechanism stands in them.
#[derive(Clone, Debug, PartialEq)]
pub struct Linkage {
    /// The collector strip.
    pub strip: LinkageStrip,
    /// Strips of the head, fixed to the body that carries them, at places along the track from `strip.offset`; empty is
    /// one in that place.
    pub strips: Vec<HeadStrip>,
    /// Reference point of the mechanism's base, m, 3 entries (x, y, z); its z is above the top of rail.
    pub base: [f64; 3],
    /// Spring and damper along the prismatic joint that guides the strip's body.
    pub collector_suspension: CollectorSuspension,
    /// The force that raises the mechanism.
    pub uplift: Uplift,
    /// `[[pantograph.bodies]]`.
    pub bodies: Vec<Body>,
    /// `[[pantograph.joints]]`.
    pub joints: Vec<Joint>,
}

/// `pantograph.strip` of a linkage.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkageStrip {
    /// Lateral width, m.
    pub width: f64,
    /// Bent ends of the head beyond the strip; none is a head that ends with its strip.
    pub horns: Option<Horns>,
    /// Name of the body that carries it.
    pub body: String,
    /// Its middle relative to the body's centre of mass, in the body's axes, m, 3 entries.
    pub offset: [f64; 3],
}

/// `pantograph.collector_suspension`: acts along the one prismatic joint of the strip's body, preloaded so that the
/// tabulated configuration is at rest under the contact force that the uplift yields there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CollectorSuspension {
    /// N/m, positive.
    pub stiffness: f64,
    /// N·s/m, not negative.
    pub damping: f64,
}

/// `pantograph.uplift`: a constant vertical force on a point of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Uplift {
    /// N, upward.
    pub force: f64,
    /// Name of the body.
    pub body: String,
    /// Distance of the point from the body's joint with the base, measured from there through the centre of mass, m.
    pub distance: f64,
}

/// `[[pantograph.bodies]]`: a rigid body in its tabulated position.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Unique name; `base` is taken.
    pub name: String,
    /// kg, positive.
    pub mass: f64,
    /// Centre of mass, m, 3 entries (x, y, z).
    pub position: [f64; 3],
    /// Euler angles (φ, θ, ψ) of the principal axes, rad, in the sequence Z-X-Z: see [`Body::rotation`].
    pub orientation: [f64; 3],
    /// Principal moments of inertia (Ixx, Iyy, Izz) about the centre of mass, kg·m², positive.
    pub inertia: [f64; 3],
}

/// `[[pantograph.joints]]`: an ideal joint between two bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Which motion it leaves free.
    pub kind: JointKind,
    /// Name of a body, or `base`.
    pub first: String,
    /// Name of another body, or `base`.
    pub second: String,
    /// Place of the joint in the tabulated position, m, 3 entries.
    pub point: [f64; 3],
}

/// `kind` and `axis` of a joint; an axis has 3 entries (–), is not zero, and need not be of unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointKind {
    /// Rotation about `axis`.
    Revolute {
        /// In the mechanism's coordinates.
        axis: [f64; 3],
    },
    /// Every rotation.
    Spherical,
    /// Translation along `axis`.
    Prismatic {
        /// In the mechanism's coordinates.
        axis: [f64; 3],
    },
}

impl Body {
    /// Rotation matrix (row by row) that takes the body's principal axes to the mechanism's axes.
    ///
    /// ```text
    /// A = R_z(φ) R_x(θ) R_z(ψ)        φ, θ, ψ = orientation
    /// ```
    ///
    /// [Thesis, Table 2] names the angles only. This sequence is the one under which the local x axis of every
    /// bar of the table runs through the bar's joints; with φ = −ψ = ±π/2 it is a rotation by θ about ±y.
    #[must_use]
    pub fn rotation(&self) -> [[f64; 3]; 3] {
        let [(s1, c1), (s, c), (s2, c2)] = self.orientation.map(f64::sin_cos);
        [
            [c1 * c2 - s1 * c * s2, -c1 * s2 - s1 * c * c2, s1 * s],
            [s1 * c2 + c1 * c * s2, -s1 * s2 + c1 * c * c2, -c1 * s],
            [s * s2, s * c2, c],
        ]
    }
}

impl Joint {
    /// Name by the bodies that it joins, `first-second`.
    #[must_use]
    pub fn name(&self) -> String {
        format!("{}-{}", self.first, self.second)
    }
}

impl Linkage {
    /// The name that joints use for what the mechanism stands on.
    pub const BASE: &str = "base";

    /// The body called `name`.
    #[must_use]
    pub fn body(&self, name: &str) -> Option<&Body> {
        self.bodies.iter().find(|body| body.name == name)
    }

    /// Revolute joints with their numbers, from 0.
    pub fn revolutes(&self) -> impl Iterator<Item = (usize, &Joint)> {
        let joints = self.joints.iter().enumerate();
        joints.filter(|(_, joint)| matches!(joint.kind, JointKind::Revolute { .. }))
    }

    /// Number of the revolute joint called `name`, see [`Joint::name`], from 0.
    #[must_use]
    pub fn revolute(&self, name: &str) -> Option<usize> {
        let (number, _) = self.revolutes().find(|(_, joint)| joint.name() == name)?;
        Some(number)
    }
}

impl Entry for Linkage {
    const SENTENCES: Sentences = &[
        ("strip", "Collector strip."),
        (
            "strips",
            "Strips of the head along the track, fixed to the body of `strip`, from its place on; left out, one in \
             that place.",
        ),
        (
            "base",
            "Reference point of the mechanism's base in its own coordinates; z is above the top of rail.",
        ),
        (
            "collector_suspension",
            "Spring and damper along the prismatic joint of the strip's body.",
        ),
        ("uplift", "Constant vertical force that raises the mechanism."),
        ("bodies", "Rigid bodies in their tabulated position."),
        ("joints", "Ideal joints between two bodies, or a body and `base`."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            strip: keys.inline_table("strip", was.map(|linkage| &linkage.strip)),
            strips: keys.any_tables("strips", was.map(|linkage| linkage.strips.as_slice())),
            base: keys.vector("base", was.map(|linkage| linkage.base), Number::any("m")),
            collector_suspension: keys
                .inline_table("collector_suspension", was.map(|linkage| &linkage.collector_suspension)),
            uplift: keys.inline_table("uplift", was.map(|linkage| &linkage.uplift)),
            bodies: keys.tables("bodies", was.map(|linkage| linkage.bodies.as_slice())),
            joints: keys.tables("joints", was.map(|linkage| linkage.joints.as_slice())),
        }
    }
}

const A_BODY: &str = "the name of a body";

impl Entry for LinkageStrip {
    const SENTENCES: Sentences = &[
        ("width", "Lateral width of the strip."),
        ("horns", HORNS),
        ("body", "Name of the body that carries the strip."),
        (
            "offset",
            "Middle of the strip relative to the body's centre of mass, in the body's axes.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            width: keys.number("width", was.map(|strip| strip.width), Number::positive("m")),
            horns: keys.optional_inline_table("horns", was.map(|strip| strip.horns.as_ref())),
            body: keys.text("body", was.map(|strip| strip.body.as_str()), A_BODY),
            offset: keys.vector("offset", was.map(|strip| strip.offset), Number::any("m")),
        }
    }
}

impl Entry for CollectorSuspension {
    const SENTENCES: Sentences = &[("stiffness", "Stiffness."), ("damping", "Damping.")];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            stiffness: keys.number("stiffness", was.map(|spring| spring.stiffness), Number::positive("N/m")),
            damping: keys.number(
                "damping",
                was.map(|spring| spring.damping),
                Number::not_negative("N s/m"),
            ),
        }
    }
}

impl Entry for Uplift {
    const SENTENCES: Sentences = &[
        ("force", "Upward force."),
        ("body", "Name of the body that the force acts on."),
        (
            "distance",
            "Distance of its point from the body's joint with the base, through the centre of mass.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            force: keys.number("force", was.map(|uplift| uplift.force), Number::positive("N")),
            body: keys.text("body", was.map(|uplift| uplift.body.as_str()), A_BODY),
            distance: keys.number("distance", was.map(|uplift| uplift.distance), Number::not_negative("m")),
        }
    }
}

impl Entry for Body {
    const SENTENCES: Sentences = &[
        ("name", "Unique name; `base` is taken."),
        ("mass", "Mass."),
        ("position", "Centre of mass (x, y, z)."),
        (
            "orientation",
            "Euler angles of the principal axes in the sequence Z-X-Z.",
        ),
        ("inertia", "Principal moments of inertia about the centre of mass."),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        Self {
            name: keys.text("name", was.map(|body| body.name.as_str()), "a name"),
            mass: keys.number("mass", was.map(|body| body.mass), Number::positive("kg")),
            position: keys.vector("position", was.map(|body| body.position), Number::any("m")),
            orientation: keys.vector("orientation", was.map(|body| body.orientation), Number::any("rad")),
            inertia: keys.vector("inertia", was.map(|body| body.inertia), Number::positive("kg m²")),
        }
    }
}

/// The words of `kind`.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Revolute,
    Spherical,
    Prismatic,
}

const KINDS: [(&str, Kind); 3] = [
    ("revolute", Kind::Revolute),
    ("spherical", Kind::Spherical),
    ("prismatic", Kind::Prismatic),
];

impl Entry for Joint {
    const SENTENCES: Sentences = &[
        ("kind", "Motion that the joint leaves free."),
        ("first", "Name of a body, or `base`."),
        ("second", "Name of another body, or `base`."),
        ("point", "Place of the joint in the tabulated position."),
        (
            "axis",
            "Axis of a revolute or prismatic joint, of any length; left out with `\"spherical\"`.",
        ),
    ];

    fn entry(keys: &mut Keys, was: Option<&Self>) -> Self {
        let (kind, axis) = match was.map(|joint| joint.kind) {
            Some(JointKind::Revolute { axis }) => (Some(Kind::Revolute), Some(axis)),
            Some(JointKind::Spherical) => (Some(Kind::Spherical), None),
            Some(JointKind::Prismatic { axis }) => (Some(Kind::Prismatic), Some(axis)),
            None => (None, None),
        };
        let kind = keys.word_among("kind", kind, &KINDS, &[], None);
        let first = keys.text("first", was.map(|joint| joint.first.as_str()), A_BODY);
        let second = keys.text("second", was.map(|joint| joint.second.as_str()), A_BODY);
        let point = keys.vector("point", was.map(|joint| joint.point), Number::any("m"));
        if keys.describes() {
            keys.has("axis", false);
        }
        let kind = match kind {
            Some(Kind::Revolute) => JointKind::Revolute {
                axis: keys.vector("axis", axis, Number::any("")),
            },
            Some(Kind::Prismatic) => JointKind::Prismatic {
                axis: keys.vector("axis", axis, Number::any("")),
            },
            Some(Kind::Spherical) => JointKind::Spherical,
            None => {
                keys.abandon();
                JointKind::Spherical
            }
        };
        Self {
            kind,
            first,
            second,
            point,
        }
    }
}
