//! Monitors the connection to a coordinator: warns the user while it is silent, and gives up after a time limit.

use super::ServiceError;
use std::time::{Duration, Instant};

/// Interval of warnings while no coordinator answers.
const WARN_EVERY: Duration = Duration::from_secs(5);

/// Silence of one coordinator.
pub(super) struct ConnectionMonitor {
    endpoint: String,
    give_up_after: Option<Duration>,
    silent_since: Option<Instant>,
    warned_at: Option<Instant>,
    last_reason: String,
    was_connected: bool,
}

impl ConnectionMonitor {
    /// A monitor for the coordinator at `endpoint`; `give_up_after` bounds the silence, `None`: no bound.
    pub(crate) fn new(endpoint: &str, give_up_after: Option<Duration>) -> Self {
        Self {
            endpoint: endpoint.to_owned(),
            give_up_after,
            silent_since: None,
            warned_at: None,
            last_reason: "no answer".into(),
            was_connected: false,
        }
    }

    /// Registers an answer of the coordinator: the silence ends.
    pub(crate) fn on_answer(&mut self) {
        if !self.was_connected {
            tracing::info!("connected to the coordinator at {}", self.endpoint);
        } else if self.warned_at.is_some() {
            tracing::info!("the coordinator at {} answers again", self.endpoint);
        }
        self.was_connected = true;
        (self.silent_since, self.warned_at) = (None, None);
    }

    /// Registers an attempt without answer, started at `since`.
    pub(crate) fn on_failure(&mut self, since: Instant, reason: String) {
        tracing::debug!("no answer from {}: {reason}", self.endpoint);
        self.on_silence(since, Some(reason));
    }

    /// Registers that an attempt has had no answer since `since`, with the reason if one is known.
    pub(crate) fn on_silence(&mut self, since: Instant, reason: Option<String>) {
        self.silent_since = self.silent_since.or(Some(since));
        if let Some(reason) = reason {
            self.last_reason = reason;
        }
    }

    /// Warns the user every five seconds of silence.
    ///
    /// # Errors
    /// [`ServiceError::Unreachable`] once the silence exceeds `give_up_after`.
    pub(crate) fn check(&mut self, now: Instant) -> Result<(), ServiceError> {
        let Some(since) = self.silent_since else { return Ok(()) };
        let silence = now.saturating_duration_since(since);
        if self.give_up_after.is_some_and(|limit| silence >= limit) {
            return Err(ServiceError::Unreachable {
                endpoint: self.endpoint.clone(),
                seconds: silence.as_secs_f64(),
                last_reason: self.last_reason.clone(),
            });
        }
        let warn_at = self.warned_at.unwrap_or(since) + WARN_EVERY;
        if now >= warn_at {
            self.warned_at = Some(now);
            tracing::warn!(
                "no coordinator has answered at {} for {:.0} s ({}); trying again",
                self.endpoint,
                silence.as_secs_f64(),
                self.last_reason
            );
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silence_counts_from_the_first_failure_and_ends_with_an_answer() {
        let start = Instant::now();
        let second = Duration::from_secs(1);
        let mut monitor = ConnectionMonitor::new("tcp/host:1", Some(10 * second));
        monitor.on_failure(start, "refused".into());
        monitor.on_failure(start + 8 * second, "refused again".into());
        assert!(monitor.check(start + 9 * second).is_ok());
        monitor.on_answer();
        assert!(monitor.check(start + 100 * second).is_ok());
        monitor.on_failure(start + 100 * second, "refused".into());
        let error = monitor.check(start + 110 * second).unwrap_err();
        assert!(error.to_string().contains("tcp/host:1 for 10 s"), "{error}");
        assert!(error.to_string().contains("refused"), "{error}");
    }

    #[test]
    fn without_a_bound_it_never_gives_up() {
        let start = Instant::now();
        let mut monitor = ConnectionMonitor::new("tcp/host:1", None);
        monitor.on_failure(start, "refused".into());
        assert!(monitor.check(start + Duration::from_secs(1_000_000)).is_ok());
    }
}
