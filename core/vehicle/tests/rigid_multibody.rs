//! Rigid bodies and joints in time against closed forms, an independent integration and a published benchmark.
//!
//! Sources:
//! - `[Goldstein]` H. Goldstein, C. Poole, J. Safko, Classical Mechanics, 3rd ed., 5.5–5.7: free body and heavy
//!   symmetric top.
//! - `[IVP]` F. Mazzia, C. Magherini, Test Set for Initial Value Problem Solvers, University of Bari, release 2.4,
//!   problem *Andrews' squeezing mechanism*; its equations are those of `[HW]` E. Hairer, G. Wanner, Solving Ordinary
//!   Differential Equations II, VII.7. Solution by PSIDE at tolerances of 1e-14.

mod rigid_multibody {
    pub mod andrews;
    pub mod free_body;
    pub mod mechanism;
    pub mod pendulum;
    pub mod top;
}
