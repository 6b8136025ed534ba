//! The variables of the oscillator; a file of its own, so that whoever writes the model description can include it.

use fmi2::model_description::Variable;

pub mod at {
    //! Positions in the table of variables, which are the value references.
    #![allow(missing_docs, dead_code)] // the names say it; each user needs some of them
    pub const FORCE: usize = 0;
    pub const X: usize = 1;
    pub const V: usize = 2;
    pub const A: usize = 3;
    pub const MASS: usize = 4;
    pub const STIFFNESS: usize = 5;
    pub const DAMPING: usize = 6;
    pub const START: usize = 7;
    pub const LABEL: usize = 8;
    pub const STEPS: usize = 9;
    pub const ABOVE: usize = 10;
    pub const USE_DERIVATIVES: usize = 11;
    pub const TROUBLE: usize = 12;
}

/// The table of variables.
#[must_use]
pub fn table() -> Vec<Variable> {
    vec![
        Variable::input("force", "N", 0.0, "Force on the mass"),
        Variable::output("x", "m", "Position")
            .depends_on(&[])
            .initially_depends_on(&[at::START]),
        Variable::output("v", "m/s", "Velocity")
            .depends_on(&[])
            .initially_depends_on(&[]),
        Variable::output("a", "m/s2", "Acceleration").depends_on(&[at::FORCE]),
        Variable::parameter("mass", "kg", 2.0, "Mass"),
        Variable::parameter("stiffness", "N/m", 800.0, "Stiffness of the spring"),
        Variable::parameter("damping", "N.s/m", 1.0, "Coefficient of the damper"),
        Variable::parameter("start.x", "m", 0.1, "Position at the start"),
        Variable::string_parameter("label", "oscillator", "A text for people"),
        Variable::integer_output("steps", "Steps since the start").depends_on(&[]),
        Variable::boolean_output("above", "Whether the position is positive").depends_on(&[]),
        Variable::boolean_parameter("inputs.use_derivatives", true, "Whether the force is followed"),
        Variable::integer_parameter("trouble", 0, "What is to go wrong").tunable(),
    ]
}
