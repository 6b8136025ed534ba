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

    /// Memory that this process may still take, bytes: that of the machine, or what the group that it belongs to is
    /// allowed; nothing where the system does not tell.
    #[must_use]
    pub fn free_memory() -> Option<f64> {
        let number = |file: &str| fs::read_to_string(file).ok()?.trim().parse::<f64>().ok();
        let info = fs::read_to_string("/proc/meminfo").ok()?;
        let free = info.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
        let free: f64 = free.trim().trim_end_matches(" kB").parse().ok()?;
        let allowed = number("/sys/fs/cgroup/memory.max").zip(number("/sys/fs/cgroup/memory.current"));
        let left = allowed.map_or(f64::INFINITY, |(most, taken)| most - taken);
        Some(left.min(1024.0 * free))
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
