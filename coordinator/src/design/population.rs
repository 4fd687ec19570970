//! The Monte Carlo population: independent samples of the random variables, kept in standardised units.

use super::{Stream, open_stream};
use common::random::Distribution;
use faer::MatRef;
use rand::RngExt;
use rand_chacha::ChaCha12Rng;
use std::ops::Range;

/// Monte Carlo samples of independent random variables.
///
/// Points are stored as z = (x - mean) / std with the parents' parameters, one point after the other: `(n, d)`
/// row-major, which prediction reads as `(d, n)` column-major blocks without a copy.
#[derive(Debug, Clone)]
pub struct Population {
    variables: Vec<Distribution>,
    z: Vec<f64>,
    rng: ChaCha12Rng,
}

impl Population {
    /// Draws `n` points by inverse transform under `seed`.
    pub fn draw(variables: &[Distribution], n: usize, seed: u64) -> Self {
        let rng = open_stream(seed, Stream::Population);
        let mut population = Self { variables: variables.to_vec(), z: Vec::new(), rng };
        population.grow_to(n);
        population
    }

    /// Appends points of the same stream until there are `n`: the first points stay what they were, and the
    /// result is what [`Population::draw`] would have given for `n` at once.
    pub fn grow_to(&mut self, n: usize) {
        let d = self.variables.len();
        self.z.reserve((n * d).saturating_sub(self.z.len()));
        while self.z.len() < n * d {
            for variable in &self.variables {
                let x = variable.quantile(self.rng.random::<f64>());
                self.z.push((x - variable.parent_mean()) / variable.parent_std());
            }
        }
    }

    /// Number of points n.
    pub fn len(&self) -> usize {
        self.z.len() / self.variables.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.z.is_empty()
    }

    /// Number of variables d.
    pub fn dimension(&self) -> usize {
        self.variables.len()
    }

    /// The random variables `(d,)`.
    pub fn variables(&self) -> &[Distribution] {
        &self.variables
    }

    /// Point `j` in standardised units `(d,)` [1].
    pub fn standardised(&self, j: usize) -> &[f64] {
        let d = self.dimension();
        &self.z[j * d..(j + 1) * d]
    }

    /// Point `j` in the variables' own units `(d,)` [SI].
    pub fn physical(&self, j: usize) -> Vec<f64> {
        to_physical(&self.variables, self.standardised(j))
    }

    /// Points `range` as the columns of a matrix `(d, range.len())` [1].
    pub fn columns(&self, range: Range<usize>) -> MatRef<'_, f64> {
        let d = self.dimension();
        MatRef::from_column_major_slice(&self.z[range.start * d..range.end * d], d, range.len())
    }
}

/// x = mean + std z, held within the bounds against rounding `(d,)` [SI].
pub(crate) fn to_physical(variables: &[Distribution], z: &[f64]) -> Vec<f64> {
    let value = |(variable, z): (&Distribution, &f64)| {
        let (lower, upper) = variable.support();
        (variable.parent_mean() + variable.parent_std() * z).clamp(lower, upper)
    };
    variables.iter().zip(z).map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn variables() -> Vec<Distribution> {
        vec![
            Distribution::TruncatedNormal { mean: 5.0, std: 0.1, lower: 4.7, upper: 5.3 },
            Distribution::TruncatedNormal { mean: -2.0, std: 3.0, lower: -3.0, upper: 7.0 },
        ]
    }

    #[test]
    fn moments_are_those_of_the_truncated_variables() {
        let n = 40_000;
        let population = Population::draw(&variables(), n, 7);
        for (k, variable) in variables().iter().enumerate() {
            let x: Vec<f64> = (0..n).map(|j| population.physical(j)[k]).collect();
            let mean = x.iter().sum::<f64>() / n as f64;
            let var = x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n as f64;
            let error = variable.std() / (n as f64).sqrt();
            assert!((mean - variable.mean()).abs() < 4.0 * error, "{k} {mean} {}", variable.mean());
            assert!(
                (var.sqrt() - variable.std()).abs() < 4.0 * error,
                "{k} {} {}",
                var.sqrt(),
                variable.std()
            );
        }
    }

    #[test]
    fn growing_continues_the_same_stream() {
        let mut grown = Population::draw(&variables(), 10, 3);
        grown.grow_to(500);
        assert_eq!(grown.z, Population::draw(&variables(), 500, 3).z);
        assert_ne!(grown.z, Population::draw(&variables(), 500, 4).z);
    }
}
