//! Limit states in words.

use common::scene::{Fails, LimitState};

/// The values with which a limit state has failed, e.g. `failed from 8 um on`; `shown` writes a threshold.
pub(super) fn failed(limit: &LimitState, shown: impl Fn(f64) -> String) -> String {
    let threshold = shown(limit.threshold);
    match limit.fails {
        Fails::Above => format!("failed from {threshold} on"),
        Fails::Below => format!("failed from {threshold} down"),
        Fails::Outside { lower } => format!("failed from {} down and from {threshold} on", shown(lower)),
    }
}
