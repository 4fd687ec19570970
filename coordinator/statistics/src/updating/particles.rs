//! Weighted states of a unit with their predictions.
//!
//! Effective sample size 1 / sum w_i^2 [1]: the number of equal weights that would estimate a mean as well.
//!
//! # Source
//! Kong, Liu, Wong (1994), Sequential imputations and Bayesian missing data problems, Journal of the American Statistical
//! Association 89(425). Systematic resampling: Kitagawa (1996), Journal of Computational and Graphical Statistics 5(1).

/// Predictions at n states.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Predictions {
    /// Number k of measured values.
    pub values_of_state: usize,
    /// Number of limit states.
    pub limit_states: usize,
    /// Predicted values `(n, k)` row-major, each in the unit of its measurement.
    pub values: Vec<f64>,
    /// Standard deviations of errors that the states do not contain `(n, k)` row-major.
    pub errors: Vec<f64>,
    /// Lives by each limit state, infinite beyond the life studied `(n, limit states)` row-major [cycles].
    pub lives: Vec<f64>,
}

impl Predictions {
    /// Predicted value `index` of state `i`, and the standard deviation of its error.
    pub fn value(&self, i: usize, index: usize) -> (f64, f64) {
        let at = i * self.values_of_state + index;
        (self.values[at], self.errors[at])
    }

    /// Lives of state `i` by each limit state [cycles].
    pub fn lives_of(&self, i: usize) -> &[f64] {
        &self.lives[i * self.limit_states..(i + 1) * self.limit_states]
    }

    /// Life of state `i`: the shortest of its limit states [cycles].
    pub fn life(&self, i: usize) -> f64 {
        self.lives_of(i).iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Takes the prediction of state `j` of `other` for state `i`.
    pub(super) fn copy(&mut self, i: usize, other: &Self, j: usize) {
        let (k, s) = (self.values_of_state, self.limit_states);
        self.values[i * k..(i + 1) * k].copy_from_slice(&other.values[j * k..(j + 1) * k]);
        self.errors[i * k..(i + 1) * k].copy_from_slice(&other.errors[j * k..(j + 1) * k]);
        self.lives[i * s..(i + 1) * s].copy_from_slice(&other.lives[j * s..(j + 1) * s]);
    }

    /// The predictions of the chosen states, in this order.
    fn chosen(&self, chosen: &[usize]) -> Self {
        let rows = |of: &[f64], width: usize| {
            chosen.iter().flat_map(|i| of[i * width..(i + 1) * width].iter().copied()).collect()
        };
        Self {
            values: rows(&self.values, self.values_of_state),
            errors: rows(&self.errors, self.values_of_state),
            lives: rows(&self.lives, self.limit_states),
            ..*self
        }
    }
}

/// Weighted states of a unit.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Particles {
    /// Number D of coordinates of a state.
    pub dimension: usize,
    /// States, standard normals `(n, D)` row-major [1].
    pub states: Vec<f64>,
    /// Predictions at them.
    pub predictions: Predictions,
    /// Weights, of sum 1 `(n,)` [1].
    pub weights: Vec<f64>,
}

impl Particles {
    /// States `(n, D)` row-major with equal weights.
    pub fn equal(dimension: usize, states: Vec<f64>, predictions: Predictions) -> Self {
        let n = states.len() / dimension;
        Self { dimension, states, predictions, weights: vec![1.0 / n as f64; n] }
    }

    /// Number n of particles.
    pub fn len(&self) -> usize {
        self.weights.len()
    }

    /// True without any particle.
    pub fn is_empty(&self) -> bool {
        self.weights.is_empty()
    }

    /// State `i` `(D,)` [1].
    pub fn state(&self, i: usize) -> &[f64] {
        &self.states[i * self.dimension..(i + 1) * self.dimension]
    }

    /// Effective sample size [1].
    pub fn effective_size(&self) -> f64 {
        effective_size(&self.weights)
    }

    /// Weighted mean of a number of each particle.
    pub fn mean(&self, of: impl Fn(usize) -> f64) -> f64 {
        self.weights.iter().enumerate().filter(|(_, w)| **w > 0.0).map(|(i, w)| w * of(i)).sum()
    }

    /// Weight of the particles with a property [1].
    pub fn share(&self, has: impl Fn(usize) -> bool) -> f64 {
        self.mean(|i| f64::from(u8::from(has(i))))
    }

    /// Weighted quantiles at probabilities `p`, of a number of each particle that may be infinite.
    pub fn quantiles(&self, p: &[f64], of: impl Fn(usize) -> f64) -> Vec<f64> {
        let positive = (0..self.len()).filter(|i| self.weights[*i] > 0.0);
        weighted_quantiles(positive.map(|i| (of(i), self.weights[i])).collect(), 1.0, p)
    }

    /// `count` particles of equal weight, by systematic resampling from the place `uniform` in (0, 1).
    pub(super) fn resampled(&self, count: usize, uniform: f64) -> Self {
        let (mut i, mut sum) = (0, self.weights[0]);
        let next = |k: usize| {
            let place = (k as f64 + uniform) / count as f64;
            while sum < place && i + 1 < self.len() {
                i += 1;
                sum += self.weights[i];
            }
            i
        };
        let chosen: Vec<usize> = (0..count).map(next).collect();
        let states = chosen.iter().flat_map(|i| self.state(*i).iter().copied()).collect();
        Self::equal(self.dimension, states, self.predictions.chosen(&chosen))
    }
}

/// Effective sample size of weights [1].
pub(super) fn effective_size(weights: &[f64]) -> f64 {
    let (sum, squares) = weights.iter().fold((0.0, 0.0), |(s, q), w| (s + w, q + w * w));
    if squares > 0.0 { sum * sum / squares } else { 0.0 }
}

/// Quantiles at probabilities `p` of values with weights, which have this sum: the first value up to which the weights reach p.
pub(super) fn weighted_quantiles(mut pairs: Vec<(f64, f64)>, total: f64, p: &[f64]) -> Vec<f64> {
    pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let add = |sum: &mut f64, (_, w): &(f64, f64)| {
        *sum += w;
        Some(*sum)
    };
    let cumulated: Vec<f64> = pairs.iter().scan(0.0, add).collect();
    let at = |p: &f64| {
        let i = cumulated.partition_point(|c| *c < p * total).min(pairs.len().saturating_sub(1));
        pairs.get(i).map_or(f64::NAN, |pair| pair.0)
    };
    p.iter().map(at).collect()
}
