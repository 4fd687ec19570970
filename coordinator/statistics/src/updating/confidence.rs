//! Reliability over life at a confidence: what differs between units apart from what is not known of their population.
//!
//! Every set of parameters has its own curve R(n | theta), the share of units that live beyond n. The curves of many sets, with their
//! weights, give at every n a distribution of R, and at every level of R a distribution of the life; their quantiles are the
//! bounds at a confidence C:
//!
//! | number | quantile over the sets |
//! |---|---|
//! | at least | 1 - C: with the probability C, R or the life is not below it |
//! | median | 1/2 |
//! | interval | (1 - C) / 2 and (1 + C) / 2 |
//!
//! The mean of R over the sets is the probability that one more unit lives beyond n. A unit that fails first by one limit state counts as
//! living on where its failures by another one are counted: the share that fails first by each until n is its cumulative incidence.

use super::particles::{effective_size, weighted_quantiles};
use serde::Serialize;

/// Curves and lives under many sets of parameters.
#[derive(Debug, Clone, Default)]
pub struct CurveDraws {
    /// Lives at which R is stated `(m,)` [cycles].
    pub cycles: Vec<f64>,
    /// Levels of R at which lives are stated `(l,)` [1].
    pub levels: Vec<f64>,
    /// R of each set `(P)(m,)` [1].
    pub curves: Vec<Vec<f64>>,
    /// Lives of each set, infinite beyond the study `(P)(l,)` [cycles].
    pub lives: Vec<Vec<f64>>,
    /// Weights of the sets, of sum 1 `(P,)` [1].
    pub weights: Vec<f64>,
    /// Effective number of points of each set `(P,)` [1].
    pub sizes: Vec<f64>,
}

/// R at one life.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ConfidentRow {
    /// Life at which R is stated [cycles].
    pub cycles: f64,
    /// Median of R [1].
    pub median: f64,
    /// Probability that one more unit lives longer [1].
    pub mean: f64,
    /// R is not below this with the confidence stated [1].
    pub at_least: f64,
    /// Interval of R with the confidence stated [1].
    pub interval: [f64; 2],
}

/// The life at one level of R.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ConfidentLife {
    /// Level of R [1].
    pub reliability: f64,
    /// Median of the life [cycles]; `null` beyond the study.
    pub median: Option<f64>,
    /// The life is not below this with the confidence stated [cycles]; `null` beyond the study.
    pub at_least: Option<f64>,
    /// Interval of the life with the confidence stated [cycles]; `null` beyond the study.
    pub interval: [Option<f64>; 2],
}

/// Reliability over life at a confidence.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ConfidentReliability {
    /// The confidence C [1].
    pub confidence: f64,
    /// R at the checkpoints.
    pub reliability: Vec<ConfidentRow>,
    /// Lives at the levels.
    pub lives: Vec<ConfidentLife>,
    /// Median over the sets of the effective number of points by which R of a set was counted [1].
    pub effective_size: f64,
    /// Bounds by each limit state alone and of its first failures; empty for a single limit state.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub limit_states: Vec<ConfidentLimitState>,
}

/// Reliability by one limit state at a confidence.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ConfidentLimitState {
    /// Name of the limit state.
    pub limit_state: String,
    /// R by it alone at the checkpoints.
    pub reliability: Vec<ConfidentRow>,
    /// Lives by it alone at the levels.
    pub lives: Vec<ConfidentLife>,
    /// Share of the units that have failed first by it, at the checkpoints; `at_least` is the bound from below.
    pub first_failures: Vec<ConfidentRow>,
}

impl CurveDraws {
    /// No set yet.
    pub fn new(cycles: Vec<f64>, levels: Vec<f64>) -> Self {
        Self { cycles, levels, ..Self::default() }
    }

    /// Order of lives `(n,)` that [`Self::add`] reads.
    pub fn order(lives: &[f64]) -> Vec<usize> {
        let mut order: Vec<usize> = (0..lives.len()).collect();
        order.sort_unstable_by(|a, b| lives[*a].total_cmp(&lives[*b]));
        order
    }

    /// Adds a set of parameters with its `weight`, under which points with these `lives` `(n,)`, in this `order`, have the weights
    /// `points` `(n,)`, not all zero.
    pub fn add(&mut self, weight: f64, lives: &[f64], order: &[usize], points: &[f64]) {
        let sum: f64 = points.iter().sum();
        if sum <= 0.0 {
            return;
        }
        let (mut failed, mut row) = (0.0, Vec::with_capacity(self.cycles.len()));
        let mut at_level = vec![f64::INFINITY; self.levels.len()];
        let mut next = self.cycles.iter().peekable();
        for j in order {
            while next.next_if(|n| lives[*j] > **n).is_some() {
                row.push((1.0 - failed / sum).max(0.0));
            }
            failed += points[*j];
            for (life, level) in at_level.iter_mut().zip(&self.levels) {
                if life.is_infinite() && failed > (1.0 - level) * sum {
                    *life = lives[*j];
                }
            }
        }
        row.resize(self.cycles.len(), (1.0 - failed / sum).max(0.0));
        self.curves.push(row);
        self.lives.push(at_level);
        self.weights.push(weight);
        self.sizes.push(effective_size(points));
    }

    /// Quantiles at probabilities `p` of a number of each set.
    fn quantiles_of(&self, weights: &[f64], of: impl Fn(usize) -> f64, p: &[f64]) -> Vec<f64> {
        let pairs = weights.iter().enumerate().map(|(t, w)| (of(t), *w)).collect();
        weighted_quantiles(pairs, weights.iter().sum(), p)
    }

    /// Interval of the life at the level of index `level` with other `weights` of the sets `(P,)`, at a confidence [cycles].
    pub fn life_interval(&self, weights: &[f64], level: usize, confidence: f64) -> [f64; 3] {
        let p = [0.5 * (1.0 - confidence), 1.0 - confidence, 0.5 * (1.0 + confidence)];
        let found = self.quantiles_of(weights, |t| self.lives[t][level], &p);
        [found[0], found[1], found[2]]
    }

    /// A number of each set at every checkpoint at a confidence C in (0, 1).
    fn rows(&self, confidence: f64, of: impl Fn(&[f64], usize) -> f64) -> Vec<ConfidentRow> {
        let p = probabilities(confidence);
        let total: f64 = self.weights.iter().sum();
        let row = |(n, cycles): (usize, &f64)| {
            let q = self.quantiles_of(&self.weights, |t| of(&self.curves[t], n), &p);
            let weighted = self.curves.iter().zip(&self.weights).map(|(curve, w)| w * of(curve, n));
            let mean = weighted.sum::<f64>() / total;
            ConfidentRow { cycles: *cycles, median: q[0], mean, at_least: q[1], interval: [q[2], q[3]] }
        };
        self.cycles.iter().enumerate().map(row).collect()
    }

    /// The share of the units that have failed, at a confidence C in (0, 1).
    pub fn failed(&self, confidence: f64) -> Vec<ConfidentRow> {
        self.rows(confidence, |curve, n| 1.0 - curve[n])
    }

    /// The bounds at a confidence C in (0, 1).
    pub fn at_confidence(&self, confidence: f64) -> ConfidentReliability {
        let p = probabilities(confidence);
        let finite = |life: f64| life.is_finite().then_some(life);
        let life = |(l, reliability): (usize, &f64)| {
            let q = self.quantiles_of(&self.weights, |t| self.lives[t][l], &p);
            let [median, at_least, lower, upper] = [q[0], q[1], q[2], q[3]].map(finite);
            ConfidentLife { reliability: *reliability, median, at_least, interval: [lower, upper] }
        };
        ConfidentReliability {
            confidence,
            reliability: self.rows(confidence, |curve, n| curve[n]),
            lives: self.levels.iter().enumerate().map(life).collect(),
            effective_size: self.quantiles_of(&self.weights, |t| self.sizes[t], &[0.5])[0],
            limit_states: Vec::new(),
        }
    }
}

/// Probabilities of the median, the bound from below, and the interval.
fn probabilities(confidence: f64) -> [f64; 4] {
    [0.5, 1.0 - confidence, 0.5 * (1.0 - confidence), 0.5 * (1.0 + confidence)]
}
