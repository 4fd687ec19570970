//! Results of the simulations so far, in the form the surrogates are fitted to.

use crate::statistics::learning::running_maximum;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use faer::Mat;

/// Result of a successful evaluation.
#[derive(Debug, Clone, PartialEq)]
pub struct Observed {
    /// Histories `(outputs)(m,)` [unit of the output].
    pub histories: Vec<Vec<f64>>,
    /// Stated numerical errors of the histories `(outputs)(m,)` [unit of the output], at least 0.
    pub errors: Vec<Vec<f64>>,
    /// Values at the start of life `(outputs,)` [unit of the output]; `None` where they are not known.
    pub start: Vec<Option<f64>>,
}

/// Result of one sample.
pub type ObservedOutcome = Result<Observed, SimulationFailure>;

impl Observed {
    /// Histories `(outputs)(m,)` without numerical errors, from an unknown start.
    pub fn exact(histories: Vec<Vec<f64>>) -> Self {
        let errors = histories.iter().map(|history| vec![0.0; history.len()]).collect();
        Self { errors, start: vec![None; histories.len()], histories }
    }

    /// Running maximum of the history of one output from the start of life `(m,)` [unit of the output].
    pub fn running_maximum(&self, output: usize) -> Vec<f64> {
        running_maximum(self.start.get(output).copied().flatten(), &self.histories[output])
    }

    /// The histories of an evaluation; its errors are zero if it states none.
    pub fn from_evaluation(evaluation: Evaluation) -> Self {
        let Evaluation { histories, errors, mut start, .. } = evaluation;
        start.resize(histories.len(), None);
        let exact = Self::exact(histories);
        Self { errors: if errors.is_empty() { exact.errors } else { errors }, start, ..exact }
    }
}

/// Points and histories of the successful evaluations, in the order of their requests.
#[derive(Debug, Clone)]
pub struct Observations {
    /// Number of variables.
    d: usize,
    /// Standardised points `(n, d)` row-major [1].
    z: Vec<f64>,
    /// Histories per output `(outputs)(n)(m,)` [unit of the output].
    histories: Vec<Vec<Vec<f64>>>,
    /// Stated errors `(outputs)(n)(m,)` [unit of the output].
    errors: Vec<Vec<Vec<f64>>>,
    /// Values at the start of life `(outputs)(n,)` [unit of the output].
    start: Vec<Vec<Option<f64>>>,
    /// Number of points of the initial design.
    design: usize,
}

impl Observations {
    /// No observations yet, of `d` variables and `outputs` outputs.
    pub fn new(d: usize, outputs: usize) -> Self {
        Self {
            d,
            z: Vec::new(),
            histories: vec![Vec::new(); outputs],
            errors: vec![Vec::new(); outputs],
            start: vec![Vec::new(); outputs],
            design: 0,
        }
    }

    /// Adds a standardised point `(d,)` and its result.
    pub fn add(&mut self, z: &[f64], observed: Observed) {
        self.z.extend_from_slice(z);
        for (all, history) in self.histories.iter_mut().zip(observed.histories) {
            all.push(history);
        }
        for (all, errors) in self.errors.iter_mut().zip(observed.errors) {
            all.push(errors);
        }
        for (all, start) in self.start.iter_mut().zip(observed.start) {
            all.push(start);
        }
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

    /// Standardised points as columns `(d, n)` [1].
    pub fn points(&self) -> Mat<f64> {
        Mat::from_fn(self.d, self.len(), |k, i| self.z[i * self.d + k])
    }

    /// Histories of one output `(n)(m,)` [unit of the output].
    pub fn histories(&self, output: usize) -> &[Vec<f64>] {
        &self.histories[output]
    }

    /// True if all histories of one output are equal.
    pub fn is_constant(&self, output: usize) -> bool {
        self.histories[output].windows(2).all(|pair| pair[0] == pair[1])
    }

    /// Values of one output at the start of life `(n,)` [unit of the output], if all of them are known.
    pub fn starts(&self, output: usize) -> Option<Vec<f64>> {
        self.start[output].iter().copied().collect()
    }

    /// Histories of one output as a matrix `(n, m)` [unit of the output].
    pub fn values(&self, output: usize) -> Mat<f64> {
        as_matrix(&self.histories[output])
    }

    /// Stated errors of the histories of one output `(n, m)` [unit of the output].
    pub fn errors(&self, output: usize) -> Mat<f64> {
        as_matrix(&self.errors[output])
    }

    /// Running maxima of the histories of one output from the start of life `(n, m)` [unit of the output].
    pub fn running_maxima(&self, output: usize) -> Mat<f64> {
        let rows = self.histories[output].iter().zip(&self.start[output]);
        let maxima: Vec<Vec<f64>> = rows.map(|(history, start)| running_maximum(*start, history)).collect();
        as_matrix(&maxima)
    }

    /// Stated errors of the running maxima of one output `(n, m)` [unit of the output]: at each checkpoint
    /// the error of the largest value so far, for the start of life that of the first checkpoint.
    pub fn errors_of_running_maxima(&self, output: usize) -> Mat<f64> {
        let errors_of_maxima =
            |((history, errors), start): ((&Vec<f64>, &Vec<f64>), &Option<f64>)| -> Vec<f64> {
                let at_start = errors.first().copied().unwrap_or(0.0);
                let mut largest = start.map_or((f64::NEG_INFINITY, 0.0), |start| (start, at_start));
                let take = |(value, error): (&f64, &f64)| {
                    if *value > largest.0 {
                        largest = (*value, *error);
                    }
                    largest.1
                };
                history.iter().zip(errors).map(take).collect()
            };
        let rows = self.histories[output].iter().zip(&self.errors[output]).zip(&self.start[output]);
        let errors: Vec<Vec<f64>> = rows.map(errors_of_maxima).collect();
        as_matrix(&errors)
    }

    /// Share of the initial design that reached the threshold by each checkpoint `(m,)` [1], from running
    /// maxima `(n, m)`.
    pub fn design_share(&self, running_maxima: &Mat<f64>, threshold: f64) -> Vec<f64> {
        let failed = |n: usize| (0..self.design).filter(|i| running_maxima[(*i, n)] >= threshold).count();
        (0..running_maxima.ncols()).map(|n| failed(n) as f64 / self.design.max(1) as f64).collect()
    }
}

fn as_matrix(rows: &[Vec<f64>]) -> Mat<f64> {
    let m = rows.first().map_or(0, Vec::len);
    Mat::from_fn(rows.len(), m, |i, n| rows[i][n])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_running_maximum_keeps_the_error_of_its_value() {
        let mut observations = Observations::new(1, 1);
        let histories = vec![vec![1.0, 3.0, 2.0, 4.0]];
        observations.add(
            &[0.0],
            Observed { errors: vec![vec![0.1, 0.3, 0.9, 0.2]], start: vec![Some(0.5)], histories },
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
    fn an_output_that_no_variable_changes_is_constant() {
        let mut observations = Observations::new(1, 2);
        for z in [0.0, 1.0, 2.0] {
            observations.add(&[z], Observed::exact(vec![vec![3.0, 4.0], vec![3.0, z]]));
        }
        assert!(observations.is_constant(0) && !observations.is_constant(1));
    }
}
