//! Isolation that a scene asks for.

use std::time::Duration;

use fmi2::isolation::Isolation;
use scene::Supplied;

/// Isolation of an entry of the scene; `None` for an FMU in this process.
#[must_use]
pub fn isolation_of(entry: &Supplied) -> Option<Isolation> {
    entry.isolate.then(|| Isolation {
        time_limit: time_limit(entry),
        memory_limit: entry.memory_limit.map(|bytes| bytes as u64),
        environment: entry.environment.clone(),
    })
}

/// Longest time that a call of the FMU may take; a millisecond at least.
#[must_use]
pub fn time_limit(entry: &Supplied) -> Duration {
    Duration::try_from_secs_f64(entry.step_timeout)
        .unwrap_or(Duration::MAX)
        .clamp(Duration::from_millis(1), Duration::from_secs(10 * 365 * 86_400))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_limit_is_a_millisecond_at_least() {
        let entry = |step_timeout, isolate| Supplied {
            isolate,
            step_timeout,
            memory_limit: Some(1e9),
            ..Supplied::unwired("")
        };
        assert_eq!(time_limit(&entry(60.0, false)), Duration::from_secs(60));
        assert_eq!(time_limit(&entry(1e-9, false)), Duration::from_millis(1));
        assert!(time_limit(&entry(1e300, false)) > Duration::from_secs(86_400));
        assert_eq!(isolation_of(&entry(60.0, false)), None);
        let isolation = isolation_of(&entry(60.0, true)).unwrap();
        assert_eq!(isolation.memory_limit, Some(1_000_000_000));
    }
}
