//! `Pantograph.fmu`: the pantograph on its base as an FMI 2.0 co-simulation slave.
fmi2::export_fmu!(fmu::SceneSlave<vehicle::Subsystem>);
