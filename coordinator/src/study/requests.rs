//! The simulations a campaign has requested: which are under way, which are repeated after a failure, and how
//! many count against the budget.

use super::step::{SampleRequest, Step};
use common::failure::SimulationFailure;
use std::collections::VecDeque;

/// A requested simulation.
#[derive(Debug, Clone)]
pub(super) struct PendingSample {
    /// Standardised point `(d,)` [1].
    pub z: Vec<f64>,
    /// The point in the variables' own units `(d,)` [SI].
    pub sample: Vec<f64>,
    /// Index in the population; the nominal point has none.
    pub member: Option<usize>,
    /// True for the repetition of a failed simulation.
    pub stricter: bool,
    /// True if the point was chosen for its predicted variance, see [`crate::statistics::learning::explore`].
    pub exploring: bool,
}

/// Requests in the order in which they were made.
#[derive(Debug, Default)]
pub(super) struct Requests {
    /// Marks the points of the present population that were requested `(N,)`.
    pub requested: Vec<bool>,
    /// Samples that failed once, to be requested again, each with its cause.
    pub retries: VecDeque<(PendingSample, SimulationFailure)>,
    /// Number of simulations requested.
    pub total: usize,
    /// Number of outcomes received.
    pub received: usize,
    /// Chunks under way, the oldest first.
    chunks: VecDeque<Vec<PendingSample>>,
}

impl Requests {
    /// No requests yet, over a population of `population` points.
    pub fn new(population: usize) -> Self {
        Self { requested: vec![false; population], ..Self::default() }
    }

    /// Registers a chunk as under way and returns the step that requests it.
    pub fn begin(&mut self, chunk: Vec<PendingSample>) -> Step {
        self.total += chunk.len();
        let request = |p: &PendingSample| SampleRequest { sample: p.sample.clone(), stricter: p.stricter };
        let requests = chunk.iter().map(request).collect();
        self.chunks.push_back(chunk);
        Step::Evaluate(requests)
    }

    /// Removes the oldest chunk, whose `count` outcomes have arrived.
    pub fn finish_oldest(&mut self, count: usize) -> Vec<PendingSample> {
        let chunk = self.chunks.pop_front().expect("outcomes belong to a chunk under way");
        assert_eq!(chunk.len(), count, "every requested sample has one outcome");
        self.received += count;
        chunk
    }

    /// Number of simulations under way.
    pub fn under_way(&self) -> usize {
        self.chunks.iter().map(Vec::len).sum()
    }

    /// Indices in the population of the samples under way.
    pub fn members_under_way(&self) -> Vec<usize> {
        self.chunks.iter().flatten().filter_map(|pending| pending.member).collect()
    }
}
