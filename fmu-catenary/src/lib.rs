//! `Catenary.fmu`: the overhead line as an FMI 2.0 co-simulation slave.
fmi2::export_fmu!(fmu::SceneSlave<catenary::Subsystem>);
