//! The machine that figures were taken on.

use std::fs;

use serde::{Deserialize, Serialize};

/// Machine that wall times belong to.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Model of the processor.
    pub cpu: String,
    /// Cores that this program may use.
    pub cores: usize,
    /// Operating system and architecture.
    pub system: String,
}

impl Machine {
    /// The machine of this process.
    #[must_use]
    pub fn this() -> Self {
        let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let model = info
            .lines()
            .find_map(|line| line.strip_prefix("model name")?.split_once(':'));
        let architecture = std::env::consts::ARCH;
        Self {
            cpu: model.map_or_else(|| architecture.to_owned(), |(_, name)| name.trim().to_owned()),
            cores: std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
            system: format!("{}, {architecture}", std::env::consts::OS),
        }
    }

    /// One line.
    #[must_use]
    pub fn name(&self) -> String {
        let cores = if self.cores == 1 { "core" } else { "cores" };
        format!("{}, {} {cores}, {}", self.cpu, self.cores, self.system)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_machine_has_a_name_and_a_core() {
        let machine = Machine::this();
        assert!(!machine.cpu.is_empty() && machine.cores >= 1 && machine.name().contains("core"));
    }
}
