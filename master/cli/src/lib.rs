//! The program `master`: arguments in, a table out.
#![forbid(unsafe_code)]

pub mod cli;
pub mod command;
pub mod defect;
