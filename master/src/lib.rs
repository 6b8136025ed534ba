//! The co-simulation master: slaves, coupling algorithms, recording, results and reports.
//!
//! ```text
//! module        subject
//! slave         what an algorithm sees of a subsystem
//! interface     names and order of the values that are exchanged
//! algorithm     who steps when, and from which values
//! run           the time loop
//! recorder      communication points to series
//! account       where the wall time of a run goes
//! timed         a slave whose time is taken
//! inprocess     slaves made of the core components
//! cosimulation  slaves made of FMUs
//! instance      an instance of an FMU, wherever it runs
//! isolation     FMUs in processes of their own
//! supplied   somebody else's pantograph or line behind the scene's wiring
//! monolithic    line and pantographs as one system
//! equilibrium   the state at t = 0
//! settling    the way of somebody else's pantograph to rest before that
//! package       FMUs made from a scene
//! ssp           the co-simulation as a system structure, and scenes made of somebody else's
//! prepare       a scene resolved: statics, FMUs of somebody else, starts
//! simulation    a resolved scene in a mode, to a record
//! hardship      what is done to a run on purpose, to see whether it survives
//! test_problem  two small slaves and their truth: what a coupling algorithm is worth
//! results       files of a run; statistics, standards and report make them
//! table_of_runs one row per run: columns, errors, status
//! stability     the hard cases, and where runs stop being stable
//! compare       all modes and algorithms on one scene
//! reproduce     a published piece of work computed again, published beside computed
//! study         speed against error: references, sweeps, Pareto front
//! cli, command  arguments, and one file per subcommand; check and inspect hold what two of them say
//! ```
#![forbid(unsafe_code)]

pub mod algorithm;
pub mod check;
pub mod cli;
pub mod command;
pub mod compare;
pub mod cosimulation;
pub mod equilibrium;
pub mod hardship;
pub mod inprocess;
pub mod inspect;
pub mod instance;
pub mod interface;
pub mod isolation;
mod mesh;
mod modelled;
pub mod monolithic;
pub mod package;
pub mod parallel;
mod prepare;
pub mod recorder;
pub mod report;
pub mod reproduce;
pub mod results;
pub mod run;
pub mod settling;
pub mod simulation;
pub mod slave;
pub mod sliding_joint;
pub mod ssp;
pub mod stability;
pub mod standards;
mod statics_hints;
pub mod statistics;
mod strip_overrun;
pub mod study;
pub mod suppliers;
mod table_files;
pub mod table_of_runs;
pub mod test_problem;
pub mod time_shares;
pub mod timed;
