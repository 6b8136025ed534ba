//! The overhead line under strips: wires of ANCF elements, droppers, supports, registration arms, statics.
//!
//! ```text
//! folder      subject
//! support     fastenings of the wires: supports, registration arms, tensioned ends
//! dropper     unilateral ties between the two wires
//! line        the whole line: in full, linearised, or as a window that follows the strips
//! statics     the static state and its answers to forces
//! subsystem   the line of a scene under prescribed strips as one simulation unit
//! ```
//!
//! # Sources
//! - `[Thesis]` S. Kulkarni, ANCF Analysis of Multibody Pantograph/Catenary Systems, MSc thesis, University of Illinois
//!   at Chicago, 2016.
//! - `[Gerstmayr & Shabana 2006]` Analysis of thin beams and cables using the absolute nodal co-ordinate formulation,
//!   Nonlinear Dynamics 45, doi 10.1007/s11071-006-1856-1.
//! - `[Yakoub & Shabana 2001]` Three dimensional absolute nodal coordinate formulation for beam elements:
//!   implementation and applications, Journal of Mechanical Design 123, doi 10.1115/1.1410099.
//! - `[Gerstmayr, Matikainen & Mikkola 2008]` A geometrically exact beam element based on the absolute nodal coordinate
//!   formulation, Multibody System Dynamics 20, doi 10.1007/s11044-008-9125-3.
//! - `[Nachbagauer, Gruber & Gerstmayr 2013]` Structural and continuum mechanics approaches for a 3D shear deformable
//!   ANCF beam finite element: application to static and linearized dynamic examples, Journal of Computational and
//!   Nonlinear Dynamics 8, doi 10.1115/1.4006787.
//! - `[Bauchau et al. 2015]` Experimental validation of flexible multibody dynamics beam formulations, Multibody System
//!   Dynamics 34, doi 10.1007/s11044-014-9430-y.
#![forbid(unsafe_code)]

mod dropper;
mod line;
mod statics;
mod subsystem;
mod support;

pub use ::ancf::{
    AxialLaw, Beam, BeamCoordinates, BeamInertia, BeamSection, BeamStiffness, BeamTangent, BendingLaw, Cable,
    CableSection, Coordinates, Tangent, beam_mass_matrix, beam_shape, mass_matrix,
};
pub use ::contact::{
    ContactGeometry, ContactPair, ContactState, ContactTangent, ContactTotal, CorrectedWire, OnWire, PenaltyContact,
    PrescribedStrip, ResidualCompliance, RunningSurface, STRIP_VALUES, Sensitivity, SlidingJoint, StripContact,
};
pub use ::mesh;
pub use ::mesh::{CorrectedSteps, load, load_with};
pub use ::wire::{
    Compliance, CurveColumn, CurveColumns, CurvePoint, Enrichment, LoadCorrection, NodeMap, Rayleigh, Wire, WireCurve,
    WireDrag, WireGeometry, WireNode, WirePoint, WireSection,
};
pub(crate) use ::wire::{DirectorInertia, Directors, WireDirectors};
pub use dropper::{Dropper, DropperLaw, Droppers, Slackening};
pub use dynamics::unilateral::{UnilateralStart, UnilateralStep};
pub use line::{
    BendingLayers, Dimension, DropperPlace, DropperSample, Line, LineOptions, LinearDropper, LinearDroppers,
    LinearLine, MassCorrection, ModalLine, NodeOfWire, OverheadLine, PlannedWire, Topology, WindOnLine, WindowSize,
    WindowedLine, WireName, adopt_state, follow_strips,
};
pub use statics::{
    BlowOffReport, DropperAtRest, DropperReport, ElasticityReport, EndReport, StaticAnswer, StaticLine, StaticsError,
    StaticsReport, SupportReport, TensionReport, WireAtRest, gradients, non_uniformity,
};
pub use subsystem::{
    CatenaryError, Checkpoint, ContactOutputs, LineAtRest, Model, SAMPLES, StaticsInputs, StripStart, Subsystem,
    contact_pair, scene_line, static_line, strip_contact,
};
pub use support::{Anchor, Attachment, PointMasses, RegistrationArms, Supports};
pub(crate) use support::{DeadLoad, LineEnd, LineEnds};
