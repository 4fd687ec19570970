//! Contact history of one joint over a simulated cycle, averaged over short intervals.
//!
//! Each interval is a [`ContactSample`]: eccentricity, penetration and normal force averaged with the weight
//! F_N |v_t|, the work density of Archard's law [W], and the work F S = integral of F_N |v_t| dt [N m].
//! Instants without sliding contact have no weight. `interval.rs` says where an interval ends.
//!
//! # Source
//! Archard (1953), J. Appl. Phys. 24, 981-988: wear is proportional to the work F S. The averaging is chosen
//! here.

use super::interval::{ContactInstant, ContactSample, Interval};

/// Contact history of one joint over one cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactHistory {
    /// Samples of the intervals with contact, in order of time.
    pub samples: Vec<ContactSample>,
    /// The interval that has not ended yet.
    pub interval: Interval,
    empty: Interval,
}

impl ContactHistory {
    /// An empty history that cuts a cycle of `period` [s] into about `samples` intervals, and also where the place on the journal has
    /// turned if the journal `wears`.
    pub(crate) fn new(period: f64, samples: usize, wears: bool) -> Self {
        let empty = Interval::new(period / samples as f64, wears);
        ContactHistory { samples: Vec::with_capacity(2 * samples), interval: empty, empty }
    }

    /// Removes all samples, for a new cycle.
    pub(crate) fn clear(&mut self) {
        self.samples.clear();
        self.interval = self.empty;
    }

    /// Adds an instant with weight `duration` [s].
    pub(crate) fn push(&mut self, duration: f64, at: &ContactInstant) {
        let samples = &mut self.samples;
        self.interval.push(duration, at, &mut |_, sample| samples.push(sample));
    }

    /// Ends the current interval; to be called at the end of the cycle.
    pub(crate) fn close_interval(&mut self) {
        self.samples.extend(self.interval.end(0));
    }

    /// Appends the samples of a further cycle.
    pub(crate) fn append(&mut self, further: &ContactHistory) {
        self.samples.extend_from_slice(&further.samples);
    }

    /// Turns the history of several cycles into that of their mean: the same contacts, each with its share of the work.
    pub(crate) fn divide_work(&mut self, cycles: usize) {
        self.samples.iter_mut().for_each(|sample| sample.work /= cycles as f64);
    }

    /// Multiplies the work of every contact by `factor` [1].
    pub(crate) fn scale_work(&mut self, factor: f64) {
        self.samples.iter_mut().for_each(|sample| sample.work *= factor);
    }

    /// Work F S of all contacts [N m].
    pub(crate) fn work(&self) -> f64 {
        self.samples.iter().map(|sample| sample.work).sum()
    }
}
