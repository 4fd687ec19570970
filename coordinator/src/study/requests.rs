//! The simulations a campaign has requested: which are under way, which are repeated after a failure, and how
//! many count against the budget.

use super::{ClassifiedPopulation, SampleRequest, Step};
use crate::statistics::design::{InputModel, Population};
use common::failure::SimulationFailure;
use std::collections::{HashSet, VecDeque};

/// A requested simulation.
#[derive(Debug, Clone, Default)]
pub(super) struct PendingSample {
    /// Standardised point `(d,)` [1].
    pub z: Vec<f64>,
    /// The point in the variables' own units `(d,)` [SI].
    pub sample: Vec<f64>,
    /// Index in the population that is classified; the nominal point, the initial design and points of no population or of another one
    /// have none.
    pub member: Option<usize>,
    /// True for the repetition of a failed simulation.
    pub stricter: bool,
    /// True if the point explores, see [`crate::statistics::learning::explore`] and
    /// [`crate::statistics::learning::farthest`].
    pub exploring: bool,
    /// True on the rim, beyond the population, where the simulator may not reach.
    pub beyond: bool,
    /// Limit state whose design alone it joins; `None` if it joins all.
    pub mode: Option<usize>,
    /// Workers that have evaluated the sample, one for each time; empty for a first evaluation.
    pub not_by: Vec<String>,
}

impl PendingSample {
    /// The nominal point: every variable at its mean.
    pub fn nominal(inputs: &InputModel) -> Self {
        let sample = inputs.means();
        Self { sample: sample.clone(), ..Self::at(inputs.standardise(&sample), inputs) }
    }

    /// True for another evaluation of a sample that has been evaluated before.
    pub fn is_repetition(&self) -> bool {
        self.stricter || !self.not_by.is_empty()
    }

    /// The standardised point `z` `(d,)` [1], which is none of the population.
    pub fn at(z: Vec<f64>, inputs: &InputModel) -> Self {
        Self { sample: inputs.to_physical(&z), z, ..Self::default() }
    }
}

/// Requests in the order in which they were made.
#[derive(Debug, Default)]
pub(super) struct Requests {
    /// Marks the points of the present population that were requested `(N,)`, all copies of them included.
    pub requested: Vec<bool>,
    /// Bits of the standardised points requested so far.
    known: HashSet<Vec<u64>>,
    /// Samples that failed once, to be requested again, each with its cause.
    pub retries: VecDeque<(PendingSample, SimulationFailure)>,
    /// Number of simulations requested.
    pub total: usize,
    /// Number of outcomes received.
    pub received: usize,
    /// Number of them that were repetitions.
    repeated: usize,
    /// Chunks under way, the oldest first.
    chunks: VecDeque<Vec<PendingSample>>,
}

impl Requests {
    /// No requests yet, over a population of `population` points.
    pub fn new(population: usize) -> Self {
        Self { requested: vec![false; population], ..Self::default() }
    }

    /// Counts simulations that were made before, at these standardised points `(n)(d,)`, among them repetitions.
    pub fn begin_with_results(&mut self, points: &[Vec<f64>]) {
        self.known.extend(points.iter().map(|z| bits(z)));
        (self.total, self.received) = (points.len(), points.len());
        self.repeated = points.len() - self.known.len();
    }

    /// Marks the points of a new or larger population that were requested before.
    pub fn mark_known(&mut self, population: &Population) {
        let known = |j| self.known.contains(&bits(population.standardised(j)));
        self.requested = (0..population.len()).map(known).collect();
    }

    /// Marks point `j` of the population as requested, along the chains of a conditional population all copies
    /// of it, and returns it.
    pub fn take(&mut self, classified: &ClassifiedPopulation, j: usize) -> PendingSample {
        let population = &classified.population;
        self.requested[j] = true;
        if classified.condition.levels > 0 {
            let z = population.standardised(j);
            let copies = (0..population.len()).filter(|i| population.standardised(*i) == z);
            copies.for_each(|i| self.requested[i] = true);
        }
        let z = population.standardised(j).to_vec();
        PendingSample { member: Some(j), ..PendingSample::at(z, &population.inputs) }
    }

    /// Registers a chunk as under way and returns the step that requests it.
    pub fn begin(&mut self, chunk: Vec<PendingSample>) -> Step {
        self.total += chunk.len();
        self.known.extend(chunk.iter().map(|pending| bits(&pending.z)));
        let request = |p: &PendingSample| SampleRequest {
            stricter: p.stricter,
            not_by: p.not_by.clone(),
            ..SampleRequest::new(p.sample.clone())
        };
        let requests = chunk.iter().map(request).collect();
        self.chunks.push_back(chunk);
        Step::Evaluate(requests)
    }

    /// Removes the oldest chunk, whose `count` outcomes have arrived.
    pub fn finish_oldest(&mut self, count: usize) -> Vec<PendingSample> {
        let chunk = self.chunks.pop_front().expect("outcomes belong to a chunk under way");
        assert_eq!(chunk.len(), count, "every requested sample has one outcome");
        self.received += count;
        self.repeated += chunk.iter().filter(|pending| pending.is_repetition()).count();
        chunk
    }

    /// Number of samples with an outcome, each counted once.
    pub fn samples_received(&self) -> usize {
        self.received - self.repeated
    }

    /// True if outliers under way are evaluated again.
    pub fn is_repeating(&self) -> bool {
        self.chunks.iter().flatten().any(|pending| !pending.not_by.is_empty())
    }

    /// Number of simulations under way.
    pub fn under_way(&self) -> usize {
        self.chunks.iter().map(Vec::len).sum()
    }

    /// Standardised points `(d,)` of the samples under way.
    pub fn points_under_way(&self) -> impl Iterator<Item = &[f64]> {
        self.chunks.iter().flatten().map(|pending| pending.z.as_slice())
    }

    /// Indices in the population of the samples under way.
    pub fn members_under_way(&self) -> Vec<usize> {
        self.chunks.iter().flatten().filter_map(|pending| pending.member).collect()
    }
}

/// Bits of a standardised point `(d,)`.
pub(super) fn bits(z: &[f64]) -> Vec<u64> {
    z.iter().map(|z| z.to_bits()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::reliability::Condition;
    use common::random::Distribution;

    #[test]
    fn issue_requested_points_are_known_in_every_later_population() {
        let variable = Distribution::normal(0.0, 1.0).unwrap();
        let mut population = Population::draw(&vec![variable; 2], 10, 1);
        let mut requests = Requests::new(10);
        let taken = requests.take(&ClassifiedPopulation::new(population.clone()), 3);
        requests.begin(vec![taken]);
        population.grow_to(30);
        requests.mark_known(&population);
        assert_eq!((0..30).filter(|j| requests.requested[*j]).collect::<Vec<_>>(), [3]);
        // Chains repeat points: the third is a known one, the others are two copies of a new one.
        let (known, new) = (population.standardised(3).to_vec(), vec![5.0, 1.0]);
        let chains = population.with_descendants([&new[..], &new, &known].concat(), vec![]);
        requests.mark_known(&chains);
        assert_eq!(requests.requested, [false, false, true]);
        let mut chains = ClassifiedPopulation::new(chains);
        chains.condition = Condition { probability: 1e-3, cov: 0.0, gamma: 0.0, levels: 3 };
        assert_eq!(requests.take(&chains, 0).z, new);
        assert_eq!(requests.requested, [true; 3]);
    }
}
