//! Results of the simulations so far, in the form the surrogates are fitted to.

use crate::statistics::learning::running_maximum;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use faer::Mat;
use std::borrow::Cow;
use std::sync::Arc;

/// Result of a successful evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Observed {
    /// Histories `(outputs)(m,)` [unit of the output].
    pub histories: Vec<Vec<f64>>,
    /// Stated numerical errors of the histories `(outputs)(m,)` [unit of the output], at least 0.
    pub errors: Vec<Vec<f64>>,
    /// Spread of the difference to a finer level from point to point `(outputs)(m,)` [unit of the output]; empty where no pairs have
    /// shown it.
    pub rough: Vec<Vec<f64>>,
    /// Values at the start of life `(outputs,)` [unit of the output]; `None` where they are not known.
    pub start: Vec<Option<f64>>,
    /// Which histories are distances of others from a middle.
    pub distances: Vec<Distance>,
    /// The evaluation that gave it; `None` where that is not known.
    pub source: Option<Arc<Source>>,
}

/// The evaluation that gave a result.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Number of the evaluation in its campaign.
    pub evaluation: u64,
    /// Worker that made it.
    pub worker: String,
}

/// A response that is the distance of an output from the middle between two thresholds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance {
    /// Index of its history.
    pub response: usize,
    /// Index of the history of the output.
    pub output: usize,
    /// The middle [unit of the output].
    pub middle: f64,
}

/// The two sides of a distance |y - c| from a middle: the largest y - c so far, and the largest c - y so far.
#[derive(Debug, Clone)]
pub(super) struct Sides {
    /// Values at the m checkpoints, those of the first side first `(n, 2 m)` [unit of the output].
    pub values: Mat<f64>,
    /// Their stated errors `(n, 2 m)` [unit of the output].
    pub errors: Mat<f64>,
    /// Values at the start of life `(2)(n,)` [unit of the output], if all of them are known.
    starts: Option<[Vec<f64>; 2]>,
}

impl Sides {
    /// Values at the start of life and at the checkpoints `(n, 2 (m + 1))` [unit of the output]; `None` if a start is not known.
    pub(super) fn with_start(&self) -> Option<Mat<f64>> {
        let starts = self.starts.as_ref()?;
        let m = self.values.ncols() / 2;
        let value = |i: usize, o: usize| {
            let (side, place) = (o / (m + 1), o % (m + 1));
            if place == 0 { starts[side][i] } else { self.values[(i, side * m + place - 1)] }
        };
        Some(Mat::from_fn(self.values.nrows(), 2 * (m + 1), value))
    }
}

/// Result of one sample.
pub type ObservedOutcome = Result<Observed, SimulationFailure>;

impl Observed {
    /// Histories `(outputs)(m,)` without numerical errors, from an unknown start.
    pub fn exact(histories: Vec<Vec<f64>>) -> Self {
        let errors = histories.iter().map(|history| vec![0.0; history.len()]).collect();
        let start = vec![None; histories.len()];
        Self { errors, rough: vec![], start, histories, distances: vec![], source: None }
    }

    /// Running maximum of the history of one output from the start of life `(m,)` [unit of the output].
    pub fn running_maximum(&self, output: usize) -> Vec<f64> {
        running_maximum(self.start.get(output).copied().flatten(), &self.histories[output])
    }

    /// This result with the number of its evaluation and the worker that made it.
    #[must_use]
    pub fn by(self, evaluation: u64, worker: &str) -> Self {
        Self { source: Some(Arc::new(Source { evaluation, worker: worker.to_owned() })), ..self }
    }

    /// The histories of an evaluation; its errors are zero if it states none.
    pub fn from_evaluation(evaluation: Evaluation) -> Self {
        let Evaluation { histories, errors, mut start, .. } = evaluation;
        start.resize(histories.len(), None);
        let exact = Self::exact(histories);
        Self { errors: if errors.is_empty() { exact.errors } else { errors }, start, ..exact }
    }
}

/// Points and results of the successful evaluations, in the order of their requests.
#[derive(Debug, Clone)]
pub struct Observations {
    /// Number of variables.
    d: usize,
    /// Standardised points `(n, d)` row-major [1].
    z: Vec<f64>,
    /// Their results `(n,)`.
    results: Vec<Observed>,
    /// Limit state in whose surrogate alone each result is `(n,)`; `None` if it is in all.
    modes: Vec<Option<usize>>,
    /// Number of points of the initial design.
    design: usize,
}

impl Observations {
    /// No observations yet, of `d` variables.
    pub fn new(d: usize) -> Self {
        Self { d, z: Vec::new(), results: Vec::new(), modes: Vec::new(), design: 0 }
    }

    /// Adds a standardised point `(d,)` and its result.
    pub fn add(&mut self, z: &[f64], observed: Observed) {
        self.add_for(z, observed, None);
    }

    /// Adds a standardised point `(d,)` and its result for the surrogate of one limit state alone, or of all.
    pub fn add_for(&mut self, z: &[f64], observed: Observed, mode: Option<usize>) {
        self.z.extend_from_slice(z);
        self.results.push(observed);
        self.modes.push(mode);
    }

    /// The results that the surrogate of limit state `mode` uses.
    pub fn design_of(&self, mode: usize) -> Cow<'_, Self> {
        let others = |of: &Option<usize>| of.is_some_and(|of| of != mode);
        if !self.modes.iter().any(others) {
            return Cow::Borrowed(self);
        }
        let mut own = Self { design: self.design, ..Self::new(self.d) };
        let all = self.standardised().zip(&self.results).zip(&self.modes);
        all.filter(|(_, of)| !others(of)).for_each(|((z, result), of)| own.add_for(z, result.clone(), *of));
        Cow::Owned(own)
    }

    /// The standardised point `(d,)` [1] and the result with this index.
    pub(super) fn result(&self, i: usize) -> Option<(&[f64], &Observed)> {
        Some((self.z.get(i * self.d..(i + 1) * self.d)?, &self.results[i]))
    }

    /// The result at a standardised point `(d,)`.
    pub(super) fn result_at(&self, z: &[f64]) -> Option<&Observed> {
        self.place_of(z).map(|i| &self.results[i])
    }

    fn place_of(&self, z: &[f64]) -> Option<usize> {
        self.standardised().position(|at| at == z)
    }

    /// Replaces the result at a standardised point `(d,)`, or removes the point.
    pub(super) fn replace(&mut self, z: &[f64], observed: Option<Observed>) {
        let Some(i) = self.place_of(z) else { return };
        if let Some(observed) = observed {
            self.results[i] = observed;
            return;
        }
        self.z.drain(i * self.d..(i + 1) * self.d);
        self.results.remove(i);
        self.modes.remove(i);
        self.design -= usize::from(i < self.design);
    }

    /// Declares all points so far the initial design.
    pub fn close_design(&mut self) {
        self.design = self.len();
    }

    /// Whether the initial design has been declared.
    pub fn has_design(&self) -> bool {
        self.design > 0
    }

    /// Number of points n.
    pub fn len(&self) -> usize {
        self.z.len() / self.d
    }

    /// True without any point.
    pub fn is_empty(&self) -> bool {
        self.z.is_empty()
    }

    /// Standardised points `(d,)` [1], one after the other.
    pub fn standardised(&self) -> impl Iterator<Item = &[f64]> {
        self.z.chunks_exact(self.d)
    }

    /// Smallest and largest value of each standardised variable `(d,)` [1].
    pub fn ranges(&self) -> Vec<(f64, f64)> {
        let mut ranges = vec![(f64::INFINITY, f64::NEG_INFINITY); self.d];
        for z in self.standardised() {
            for (range, z) in ranges.iter_mut().zip(z) {
                *range = (range.0.min(*z), range.1.max(*z));
            }
        }
        ranges
    }

    /// Standardised points as columns `(d, n)` [1].
    pub fn points(&self) -> Mat<f64> {
        Mat::from_fn(self.d, self.len(), |k, i| self.z[i * self.d + k])
    }

    /// True if all histories of one output are equal.
    pub fn is_constant(&self, output: usize) -> bool {
        self.results.windows(2).all(|pair| pair[0].histories[output] == pair[1].histories[output])
    }

    /// Values of one output at the start of life `(n,)` [unit of the output], if all of them are known.
    pub fn starts(&self, output: usize) -> Option<Vec<f64>> {
        self.results.iter().map(|result| result.start[output]).collect()
    }

    /// Histories of one output as a matrix `(n, m)` [unit of the output].
    pub fn values(&self, output: usize) -> Mat<f64> {
        self.matrix(|result| result.histories[output].clone())
    }

    /// Stated errors of the histories of one output `(n, m)` [unit of the output].
    pub fn errors(&self, output: usize) -> Mat<f64> {
        self.matrix(|result| result.errors[output].clone())
    }

    /// Running maxima of the histories of one output from the start of life `(n, m)` [unit of the output].
    pub fn running_maxima(&self, output: usize) -> Mat<f64> {
        self.matrix(|result| result.running_maximum(output))
    }

    /// Stated errors of the running maxima of one output `(n, m)` [unit of the output]: at each checkpoint
    /// the error of the largest value so far, for the start of life that of the first checkpoint.
    pub fn errors_of_running_maxima(&self, output: usize) -> Mat<f64> {
        self.matrix(|Observed { histories, errors, start, .. }| {
            errors_of_maximum(start[output], &histories[output], &errors[output])
        })
    }

    /// Spread of the difference to a finer level from point to point of one output `(m,)` [unit of the output]; `None` where no pairs
    /// have shown it.
    pub(super) fn rough(&self, output: usize) -> Option<&[f64]> {
        self.results.last()?.rough.get(output).map(Vec::as_slice)
    }

    /// Replaces every result by what `change` makes of its standardised point `(d,)` and itself.
    pub(super) fn change(&mut self, change: impl Fn(&[f64], Observed) -> Observed) {
        let results = std::mem::take(&mut self.results);
        let changed: Vec<Observed> =
            self.standardised().zip(results).map(|(z, one)| change(z, one)).collect();
        self.results = changed;
    }

    /// The matrix of a row of numbers of each result.
    fn matrix(&self, row: impl Fn(&Observed) -> Vec<f64>) -> Mat<f64> {
        let rows: Vec<Vec<f64>> = self.results.iter().map(row).collect();
        Mat::from_fn(rows.len(), rows.first().map_or(0, Vec::len), |i, n| rows[i][n])
    }

    /// The two sides of a response; `None` if it is no distance from a middle.
    pub(super) fn sides(&self, response: usize) -> Option<Sides> {
        let distances = &self.results.last()?.distances;
        let Distance { output, middle, .. } =
            *distances.iter().find(|distance| distance.response == response)?;
        let signs = [1.0, -1.0];
        let side = |result: &Observed, sign: f64| {
            let distance = |y: &f64| sign * (y - middle);
            let history: Vec<f64> = result.histories[output].iter().map(distance).collect();
            (result.start[output].as_ref().map(distance), history)
        };
        let both = |result: &Observed| signs.map(|sign| side(result, sign)).into_iter();
        let values_of = |result: &Observed| {
            both(result).flat_map(|(start, history)| running_maximum(start, &history)).collect()
        };
        let errors_of = |result: &Observed| {
            let errors = &result.errors[output];
            both(result).flat_map(|(start, history)| errors_of_maximum(start, &history, errors)).collect()
        };
        let starts = |sign: f64| self.results.iter().map(|result| side(result, sign).0).collect();
        let [first, second]: [Option<Vec<f64>>; 2] = signs.map(starts);
        Some(Sides {
            values: self.matrix(values_of),
            errors: self.matrix(errors_of),
            starts: first.zip(second).map(|(first, second)| [first, second]),
        })
    }

    /// Share of the initial design that reached the threshold by each checkpoint `(m,)` [1], from running
    /// maxima `(n, m)`.
    pub fn design_share(&self, running_maxima: &Mat<f64>, threshold: f64) -> Vec<f64> {
        let failed = |n: usize| (0..self.design).filter(|i| running_maxima[(*i, n)] >= threshold).count();
        (0..running_maxima.ncols()).map(|n| failed(n) as f64 / self.design.max(1) as f64).collect()
    }
}

/// Stated errors of the running maximum of a history `(m,)`: at each checkpoint the error of the largest value so far, for the
/// start of life that of the first checkpoint.
fn errors_of_maximum(start: Option<f64>, history: &[f64], errors: &[f64]) -> Vec<f64> {
    let at_start = errors.first().copied().unwrap_or(0.0);
    let mut largest = start.map_or((f64::NEG_INFINITY, 0.0), |start| (start, at_start));
    let take = |(value, error): (&f64, &f64)| {
        if *value > largest.0 {
            largest = (*value, *error);
        }
        largest.1
    };
    history.iter().zip(errors).map(take).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_running_maximum_keeps_the_error_of_its_value() {
        let mut observations = Observations::new(1);
        let histories = vec![vec![1.0, 3.0, 2.0, 4.0]];
        observations.add(
            &[0.0],
            Observed {
                errors: vec![vec![0.1, 0.3, 0.9, 0.2]],
                start: vec![Some(0.5)],
                ..Observed::exact(histories)
            },
        );
        assert_eq!(observations.starts(0), Some(vec![0.5]));
        observations.add(&[1.0], Observed::exact(vec![vec![5.0; 4]]));
        let falling = vec![vec![1.0, 3.0, 2.0, 4.0]];
        observations.add(&[2.0], Observed { start: vec![Some(3.5)], ..Observed::exact(falling) });
        let from_start = observations.running_maxima(0).row(2).iter().copied().collect::<Vec<_>>();
        assert_eq!(from_start, [3.5, 3.5, 3.5, 4.0]);
        assert_eq!(observations.starts(0), None);
        let errors = observations.errors_of_running_maxima(0);
        let row = |i: usize| errors.row(i).iter().copied().collect::<Vec<f64>>();
        assert_eq!(row(0), [0.1, 0.3, 0.3, 0.2]);
        assert_eq!(row(1), [0.0; 4]);
        assert_eq!(
            observations.running_maxima(0).row(0).iter().copied().collect::<Vec<_>>(),
            [1.0, 3.0, 3.0, 4.0]
        );
    }

    #[test]
    fn a_distance_is_the_larger_of_its_sides() {
        let mut observations = Observations::new(1);
        let (y, middle) = (vec![0.5, 3.0, -2.0], 1.0);
        let distance = y.iter().map(|y: &f64| (y - middle).abs()).collect();
        let observed = Observed {
            start: vec![Some(0.0), Some(1.0)],
            errors: vec![vec![0.1, 0.2, 0.3]; 2],
            distances: vec![Distance { response: 1, output: 0, middle }],
            ..Observed::exact(vec![y, distance])
        };
        observations.add(&[0.0], observed);
        assert!(observations.sides(0).is_none());
        let sides = observations.sides(1).unwrap();
        let row = |of: &Mat<f64>| of.row(0).iter().copied().collect::<Vec<f64>>();
        assert_eq!(row(&sides.values), [-0.5, 2.0, 2.0, 1.0, 1.0, 3.0]);
        assert_eq!(row(&sides.errors), [0.1, 0.2, 0.2, 0.1, 0.1, 0.3]);
        assert_eq!(row(&sides.with_start().unwrap()), [-1.0, -0.5, 2.0, 2.0, 1.0, 1.0, 1.0, 3.0]);
        let largest = row(&observations.running_maxima(1));
        assert!((0..3).all(|n| largest[n] == sides.values[(0, n)].max(sides.values[(0, n + 3)])));
    }

    #[test]
    fn each_limit_state_has_the_results_of_its_own_design() {
        let mut observations = Observations::new(1);
        for (z, mode) in [(0.0, None), (1.0, Some(0)), (2.0, Some(1)), (3.0, Some(0))] {
            observations.add_for(&[z], Observed::exact(vec![vec![z]]), mode);
        }
        let points =
            |mode: usize| observations.design_of(mode).standardised().flatten().copied().collect::<Vec<_>>();
        assert_eq!((points(0), points(1)), (vec![0.0, 1.0, 3.0], vec![0.0, 2.0]));
        assert_eq!(observations.design_of(0).values(0)[(2, 0)], 3.0);
    }

    #[test]
    fn an_output_that_no_variable_changes_is_constant() {
        let mut observations = Observations::new(1);
        for z in [0.0, 1.0, 2.0] {
            observations.add(&[z], Observed::exact(vec![vec![3.0, 4.0], vec![3.0, z]]));
        }
        assert!(observations.is_constant(0) && !observations.is_constant(1));
    }
}
