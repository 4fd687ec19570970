//! The surrogates of a campaign between two rounds: the models, their cached predictions, and when they were
//! fitted.

use super::surrogates::Surrogate;
use crate::statistics::surrogate::{Effort, PredictionCache};

/// Growth of the number of results after which the lengths are fitted anew: every fit costs a prediction of
/// the whole population, while points added at the same lengths cost a row each.
const REFIT: f64 = 1.1;
/// Growth after which the lengths are fitted from several starts, and forms compared, against a lasting local
/// optimum.
const FRESH_FIT: f64 = 1.3;

/// Surrogates of the last round and the state of their fits.
#[derive(Debug)]
pub(super) struct SurrogateState {
    /// Surrogates of the last round, one per mode; empty before the first round.
    pub models: Vec<Surrogate>,
    /// Predictions of the present population, one cache per mode.
    pub caches: Vec<PredictionCache>,
    /// Failure curves of the last round over the present population `(modes + 1, m)`.
    pub previous_curves: Option<Vec<Vec<f64>>>,
    /// Number of results at the last fit of the lengths.
    fitted_at: usize,
    /// Number of results at the last fit from several starts.
    fresh_at: usize,
}

impl SurrogateState {
    /// The state before the first round.
    pub fn new(modes: usize) -> Self {
        Self {
            models: Vec::new(),
            caches: vec![PredictionCache::default(); modes],
            previous_curves: None,
            fitted_at: 0,
            fresh_at: 0,
        }
    }

    /// Effort of the next fit over `n` results.
    pub fn effort(&self, n: usize) -> Effort {
        let (n, fitted, fresh) = (n as f64, self.fitted_at as f64, self.fresh_at as f64);
        if n >= FRESH_FIT * fresh {
            Effort::MultiStart
        } else if n >= REFIT * fitted {
            Effort::Warm
        } else {
            Effort::Keep
        }
    }

    /// Records a fit of this effort over `n` results.
    pub fn record_fit(&mut self, effort: Effort, n: usize) {
        match effort {
            Effort::Keep => {}
            Effort::Warm | Effort::TwoStarts(_) => self.fitted_at = n,
            Effort::MultiStart => (self.fitted_at, self.fresh_at) = (n, n),
        }
    }

    /// Has the lengths fitted anew in the next round.
    pub fn require_fit(&mut self) {
        self.fitted_at = 0;
    }

    /// True if the last fit from several starts used nine tenths of `n` results or more.
    pub fn is_fresh(&self, n: usize) -> bool {
        (n as f64) < REFIT * self.fresh_at as f64
    }

    /// Forgets what was computed over the previous population.
    pub fn reset_population(&mut self) {
        self.caches.fill(PredictionCache::default());
        self.previous_curves = None;
    }
}
