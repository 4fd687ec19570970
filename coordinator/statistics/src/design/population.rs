//! The Monte Carlo population: samples of the random variables by inverse transform, in standardised units.
//!
//! x_k = F_k^-1(p_k) with p_k uniform in (0, 1) and F_k the distribution function of variable k; correlated
//! variables through the Gaussian copula, see [`InputModel`].
//!
//! The initial design: the points of the population nearest to a Latin hypercube.
//!
//! Choosing among the population keeps every simulated point a sample of the variables, whose classification
//! counts.
//!
//! The nominal point of a scene and a few random points, for measurements outside of a study.
//!
//! # Source
//! Inverse transform: Devroye (1986), Non-Uniform Random Variate Generation, chapter II.
//! A design among the Monte Carlo population: Echard, Gayton, Lemaire (2011), AK-MCS, Structural Safety 33(2);
//! the nearest points to a Latin hypercube: Cui et al. (2026), China Mechanical Engineering 37(6), 1472-1485,
//! doi 10.3969/j.issn.1004-132X.2026.06.020, who choose the design by Latin hypercube.

use super::{InputModel, Stream, latin_hypercube, open_stream};
use common::scene::Scene;
use faer::MatRef;
use rand::{Rng, RngExt};
use rand_chacha::ChaCha12Rng;
use rayon::prelude::*;
use std::ops::Range;

/// Monte Carlo samples of random variables.
///
/// Points are stored in standardised coordinates z (see [`InputModel`]), `(n, d)` row-major; prediction reads them as `(d, n)` column-major blocks without a copy.
#[derive(Debug, Clone)]
pub struct Population {
    /// The random variables.
    pub inputs: InputModel,
    z: Vec<f64>,
    /// Index of the independent sample from which each point descends `(n,)`; empty if all points are independent.
    pub origins: Vec<u32>,
    rng: ChaCha12Rng,
}

/// Replacement of a uniform draw of zero, where unbounded distributions are infinite: half the spacing of the
/// draws [1].
const LEAST_PROBABILITY: f64 = f64::EPSILON / 4.0;

/// A uniform number in (0, 1).
fn uniform(rng: &mut impl Rng) -> f64 {
    rng.random::<f64>().max(LEAST_PROBABILITY)
}

impl Population {
    /// Draws `n` points under `seed`. Distributions without a copula are independent.
    pub fn draw(inputs: impl Into<InputModel>, n: usize, seed: u64) -> Self {
        let rng = open_stream(seed, Stream::Population);
        let mut population = Self { inputs: inputs.into(), z: Vec::new(), origins: Vec::new(), rng };
        population.grow_to(n);
        population
    }

    /// A Latin hypercube of `n` points under `seed`; it must not grow.
    pub fn latin_hypercube(inputs: &InputModel, n: usize, seed: u64) -> Self {
        let z = super::latin_hypercube(inputs, n, seed);
        Self { inputs: inputs.clone(), z, origins: Vec::new(), rng: open_stream(seed, Stream::Population) }
    }

    /// A population of the same variables with the standardised points `(n, d)` row-major; it must not grow. Points of Markov chains
    /// descend each from one of some independent samples, `origins` `(n,)`, which are empty for independent points.
    pub fn with_descendants(&self, z: Vec<f64>, origins: Vec<u32>) -> Self {
        Self { inputs: self.inputs.clone(), z, origins, rng: self.rng.clone() }
    }

    /// Appends points of the same stream up to `n` points: the result equals that of [`Population::draw`] for
    /// `n` points.
    pub fn grow_to(&mut self, n: usize) {
        let d = self.dimension();
        let missing = (n * d).saturating_sub(self.z.len());
        let uniforms: Vec<f64> = (0..missing).map(|_| uniform(&mut self.rng)).collect();
        let inputs = &self.inputs;
        let point = |p: &[f64]| inputs.standardise(&inputs.from_uniforms(p));
        self.z.par_extend(uniforms.par_chunks_exact(d).flat_map_iter(point));
    }

    /// Number of points n.
    pub fn len(&self) -> usize {
        self.z.len() / self.dimension()
    }

    /// True without any point.
    pub fn is_empty(&self) -> bool {
        self.z.is_empty()
    }

    /// Number of variables d.
    pub fn dimension(&self) -> usize {
        self.inputs.dimension()
    }

    /// Point `j` in standardised units `(d,)` [1].
    pub fn standardised(&self, j: usize) -> &[f64] {
        let d = self.dimension();
        &self.z[j * d..(j + 1) * d]
    }

    /// Point `j` in the units of the variables `(d,)` [SI].
    pub fn physical(&self, j: usize) -> Vec<f64> {
        self.inputs.to_physical(self.standardised(j))
    }

    /// Variable `k` of point `j` in its unit [SI].
    pub fn physical_value(&self, j: usize, k: usize) -> f64 {
        self.inputs.physical_value(k, self.standardised(j)[k])
    }

    /// The standardised points `range` as columns `(d, range.len())` [1].
    pub fn columns(&self, range: Range<usize>) -> MatRef<'_, f64> {
        let d = self.dimension();
        MatRef::from_column_major_slice(&self.z[range.start * d..range.end * d], d, range.len())
    }
}

/// Returns the indices of `n` distinct points of the population, each the nearest free one (Euclidean
/// distance in standardised units, lowest index at a tie) to one point of a Latin hypercube under `seed`; all
/// points if the population has fewer.
pub fn choose_by_latin_hypercube(population: &Population, n: usize, seed: u64) -> Vec<usize> {
    let n = n.min(population.len());
    let d = population.dimension();
    let targets = latin_hypercube(&population.inputs, n, seed);
    let square = |j: usize, target: &[f64]| -> f64 {
        population.standardised(j).iter().zip(target).map(|(a, b)| (a - b) * (a - b)).sum()
    };
    let mut taken = vec![false; population.len()];
    let mut chosen = Vec::with_capacity(n);
    for target in targets.chunks_exact(d) {
        let nearest = (0..population.len())
            .into_par_iter()
            .filter(|j| !taken[*j])
            .map(|j| (square(j, target), j))
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if let Some((_, j)) = nearest {
            taken[j] = true;
            chosen.push(j);
        }
    }
    chosen
}

/// The nominal point of a scene (its variables' means), then `random` points of the population of this seed:
/// `(1 + random)(d,)` [SI]. A scene without random variables has only the first, which is empty.
pub fn nominal_and_random(scene: &Scene, seed: u64, random: usize) -> Vec<Vec<f64>> {
    let inputs = InputModel::from_scene(scene);
    let mut points = vec![inputs.means()];
    if inputs.dimension() > 0 {
        let population = Population::draw(&inputs, random, seed);
        points.extend((0..random).map(|j| population.physical(j)));
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::{Correlation, Distribution, GaussianCopula};
    use common::scene::SceneSource;

    fn variables() -> Vec<Distribution> {
        vec![
            Distribution::truncated_normal(5.0, 0.1, 4.7, 5.3).unwrap(),
            Distribution::truncated_normal(-2.0, 3.0, -3.0, 7.0).unwrap(),
            Distribution::lognormal(1.0, 0.2).unwrap(),
            Distribution::triangular(0.0, 1.0, 5.0).unwrap(),
        ]
    }

    fn correlated() -> InputModel {
        let pair = |first, second, coefficient| Correlation { first, second, coefficient };
        let copula = GaussianCopula::new(4, &[pair(0, 3, 0.7), pair(2, 3, -0.4)]).unwrap();
        InputModel::new(variables(), copula)
    }

    fn moments(values: &[f64]) -> (f64, f64) {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        (mean, (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt())
    }

    fn column(population: &Population, k: usize) -> Vec<f64> {
        (0..population.len()).map(|j| population.physical(j)[k]).collect()
    }

    #[test]
    fn moments_are_those_of_the_variables() {
        let n = 40_000;
        for population in [Population::draw(&variables(), n, 7), Population::draw(correlated(), n, 7)] {
            for (k, variable) in variables().iter().enumerate() {
                let (mean, std) = moments(&column(&population, k));
                let error = variable.std() / (n as f64).sqrt();
                assert!((mean - variable.mean()).abs() < 4.0 * error, "{k} {mean} {}", variable.mean());
                assert!((std - variable.std()).abs() < 4.0 * error, "{k} {std} {}", variable.std());
            }
        }
    }

    #[test]
    fn normals_of_the_population_have_the_correlations_asked_for() {
        let n = 40_000;
        let population = Population::draw(correlated(), n, 3);
        let u: Vec<Vec<f64>> = (0..4)
            .map(|k| {
                let variable = &population.inputs.variables()[k];
                column(&population, k).iter().map(|x| variable.to_standard_normal(*x)).collect()
            })
            .collect();
        for (i, j, expected) in [(0, 3, 0.7), (2, 3, -0.4), (0, 2, 0.0), (0, 1, 0.0), (1, 3, 0.0)] {
            let found = u[i].iter().zip(&u[j]).map(|(a, b)| a * b).sum::<f64>() / n as f64;
            // Standard error of a mean of products: sqrt((1 + rho^2) / n).
            let error = ((1.0 + expected * expected) / n as f64).sqrt();
            assert!((found - expected).abs() < 4.0 * error, "{i} {j} {found}");
        }
    }

    /// A variable without correlations has the values it has when all are independent.
    #[test]
    fn correlations_leave_the_others_alone() {
        let (alone, correlated) =
            (Population::draw(&variables(), 500, 3), Population::draw(correlated(), 500, 3));
        for j in 0..500 {
            assert_eq!(alone.standardised(j)[1], correlated.standardised(j)[1]);
            assert_ne!(alone.standardised(j)[3], correlated.standardised(j)[3]);
        }
    }

    /// Each value is the quantile of one number of the stream.
    #[test]
    fn independent_variables_are_drawn_by_inverse_transform() {
        let population = Population::draw(&variables(), 50, 9);
        let mut rng = open_stream(9, Stream::Population);
        for j in 0..50 {
            for (k, variable) in variables().iter().enumerate() {
                let x = variable.quantile(rng.random::<f64>());
                assert_eq!(population.standardised(j)[k], population.inputs.standardised_value(k, x));
                assert_eq!(population.physical_value(j, k), population.physical(j)[k]);
            }
        }
    }

    #[test]
    fn growing_continues_the_same_stream() {
        for inputs in [InputModel::from(&variables()), correlated()] {
            let mut grown = Population::draw(&inputs, 10, 3);
            grown.grow_to(500);
            assert_eq!(grown.z, Population::draw(&inputs, 500, 3).z);
            assert_ne!(grown.z, Population::draw(&inputs, 500, 4).z);
        }
    }

    /// Cases of the TNO black-box reliability challenge with laws of several kinds, by counting.
    #[test]
    fn published_failure_probabilities() {
        let lognormal = |mean, std| Distribution::lognormal(mean, std).unwrap();
        let normal = |mean, std| Distribution::normal(mean, std).unwrap();
        let wide = lognormal(120.0, 12.0);
        let rp8 =
            [wide.clone(), wide.clone(), wide.clone(), wide, lognormal(50.0, 10.0), lognormal(40.0, 8.0)];
        let rp24 = vec![normal(10.0, 3.0); 2];
        let first = |x: &[f64]| x[0] + 2.0 * x[1] + 2.0 * x[2] + x[3] - 5.0 * x[4] - 5.0 * x[5];
        let second = |x: &[f64]| 2.5 - 0.2357 * (x[0] - x[1]) + 0.00463 * (x[0] + x[1] - 20.0).powi(4);
        let count = |population: Population, g: &dyn Fn(&[f64]) -> f64| {
            let n = population.len();
            (0..n).filter(|j| g(&population.physical(*j)) <= 0.0).count() as f64 / n as f64
        };
        let n = 400_000;
        // The references have three digits: 0.6 % and 0.2 % of themselves.
        for (found, expected) in [
            (count(Population::draw(&rp8, n, 2), &first), 7.90e-4),
            (count(Population::draw(&rp24, n, 2), &second), 2.86e-3),
        ] {
            let error = (expected / n as f64).sqrt() + 0.006 * expected;
            assert!((found - expected).abs() < 3.0 * error, "{found} {expected}");
        }
    }

    fn truncated(d: usize) -> Vec<Distribution> {
        vec![Distribution::truncated_normal(1.0, 2.0, -5.0, 7.0).unwrap(); d]
    }

    #[test]
    fn chosen_points_are_distinct_and_reproducible() {
        let population = Population::draw(&truncated(3), 300, 5);
        let chosen = choose_by_latin_hypercube(&population, 120, 5);
        let mut distinct = chosen.clone();
        distinct.sort_unstable();
        distinct.dedup();
        assert_eq!(distinct.len(), 120);
        assert_eq!(chosen, choose_by_latin_hypercube(&population, 120, 5));
        assert_eq!(choose_by_latin_hypercube(&population, 1000, 5).len(), 300);
    }

    #[test]
    fn more_points_begin_with_the_same() {
        let source = SceneSource::builtin("four-bar").expect("built in");
        let (few, many) =
            (nominal_and_random(source.nominal(), 1, 2), nominal_and_random(source.nominal(), 1, 9));
        assert_eq!((few.len(), many.len()), (3, 10));
        assert_eq!(few[..], many[..3]);
        assert_ne!(many[1], many[2]);
        let means = source.nominal().variables.iter().map(|v| v.distribution.mean());
        assert_eq!(few[0], means.collect::<Vec<_>>());
        let ideal = SceneSource::builtin("pendulum").expect("built in");
        assert_eq!(nominal_and_random(ideal.nominal(), 1, 5), [[0.0; 0]]);
    }
}
