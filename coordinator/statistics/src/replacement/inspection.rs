//! Replacement by inspection: a unit is inspected at given lives, replaced if a measured output has reached a level, replaced
//! at its failure, and at the last of these lives in any case, without another inspection.
//!
//! The measurement of an inspection errs by a normal error of standard deviation e. Over it the renewal of a unit has the exact
//! mean: with the values y_1, y_2, ... of the unit j at its inspections, it passes the i-th with the probability
//! Phi((level - y_i) / e), and fails with the product p_j of those before its failure. So a rare failure counts with its
//! probability, although no draw of the errors would show it. Over N units with the mean cost C_j and length L_j of a renewal,
//!
//!   g = (sum C_j + (c_f - c_p) max p_j / 2) / sum L_j,
//!   standard error = sqrt(sum (C_j - g L_j)^2 / (N (N - 1))) / mean L,
//!
//! the ratio estimator of the renewal-reward theorem, with half of the largest p_j for units as bad that are not among the N.
//! The 95 % limits are g -+ 1.96 standard errors; the upper one allows for failures at least up to the gamma limit of
//! a weighted count, at which the next unit fails for certain: without any failure that is 3.7 / N. Level and number of
//! inspections with the least g are sought among the quantiles of the values and all numbers of inspections. They
//! are chosen by every second unit and their cost is stated over the others, so that the choice does not flatter it.
//!
//! # Source
//! Renewal-reward theorem: Ross (1996), Stochastic Processes, Wiley, section 3.6; ratio estimator: Cochran (1977), Sampling
//! Techniques, Wiley, chapter 6; policy: Jardine, Tsang (2013), Maintenance, Replacement, and Reliability, chapter 3; limit of
//! a weighted count: Fay, Feuer (1997), Confidence intervals for directly standardized rates, Statistics in Medicine 16,
//! 791-801. Half of the largest p_j is this project's own convention, after the prior of Jeffreys.

use crate::reliability::REACH;
use rayon::prelude::*;
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Gamma};
use statrs::function::erf::erfc;
use std::f64::consts::FRAC_1_SQRT_2;

/// Levels that are tried.
const LEVELS: usize = 80;
/// Levels that are tried between the neighbours of the best.
const FINER: usize = 30;
/// Levels below the smallest value that are tried where measurements err, and their distance [errors].
const BELOW: (usize, f64) = (12, 0.5);
/// Upper probability of the limit of failures [1].
const UPPER: f64 = 0.975;

/// Lives of units and their values at inspections.
#[derive(Debug, Clone)]
pub struct InspectedSamples {
    /// Lives `(N,)`, infinite beyond the life studied [cycles].
    pub lives: Vec<f64>,
    /// Lives of the inspections, increasing, within the life studied `(k,)` [cycles].
    pub times: Vec<f64>,
    /// Values without error `(N, k)` row-major [unit of the output], larger for more worn; those after a failure are not used.
    pub values: Vec<f64>,
    /// Standard deviation of the error of a measurement [unit of the output].
    pub error: f64,
    /// True if the values are distances: a level counts at both signs of value plus error.
    pub two_sided: bool,
}

/// Costs of a policy with inspections, in any currency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolicyCosts {
    /// Cost of a planned replacement.
    pub planned: f64,
    /// Cost of a failure with its replacement.
    pub failure: f64,
    /// Cost of an inspection.
    pub inspection: f64,
}

/// Costs and frequencies of a policy.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PolicyOutcome {
    /// Long-run cost of a cycle [currency/cycle].
    pub cost_rate: f64,
    /// Its standard error by the number of units [currency/cycle].
    pub standard_error: f64,
    /// Lower 95 % limit of the cost [currency/cycle].
    pub lower: f64,
    /// Upper 95 % limit of the cost, with failures that no unit shows [currency/cycle].
    pub upper: f64,
    /// Share of the renewals by a failure [1].
    pub failed: f64,
    /// Share of the renewals by the measured level [1].
    pub by_level: f64,
    /// Mean length of a renewal [cycles].
    pub mean_life: f64,
    /// Mean number of inspections in a renewal [1].
    pub inspections: f64,
}

/// The renewal of one unit, as its mean over the errors of measurement.
#[derive(Debug, Clone, Copy, Default)]
struct Renewal {
    cost: f64,
    length: f64,
    failed: f64,
    by_level: f64,
    inspections: f64,
}

impl Renewal {
    /// Adds an end of probability `p` [1].
    fn add(&mut self, p: f64, price: f64, length: f64, (inspections, cost): (usize, f64)) {
        self.cost += p * (price + cost * inspections as f64);
        self.length += p * length;
        self.inspections += p * inspections as f64;
    }
}

impl InspectedSamples {
    /// Number of inspections of unit `j` that its life contains.
    fn alive(&self, j: usize) -> usize {
        self.times.partition_point(|t| *t < self.lives[j])
    }

    /// Probability that a value is measured at a level or beyond [1].
    fn signal(&self, value: f64, level: f64) -> f64 {
        if self.error <= 0.0 {
            return f64::from(u8::from(value >= level));
        }
        let beyond = |distance: f64| 0.5 * erfc(distance / self.error * FRAC_1_SQRT_2);
        let upper = beyond(level - value);
        if !self.two_sided {
            return upper;
        }
        if level <= 0.0 { 1.0 } else { (upper + beyond(level + value)).min(1.0) }
    }

    /// The renewals of unit `j` for a level and every last inspection.
    fn renewals(&self, j: usize, level: f64, costs: &PolicyCosts, mut visit: impl FnMut(usize, &Renewal)) {
        let k = self.times.len();
        let alive = self.alive(j);
        let mut replaced = Renewal::default();
        let mut passed = 1.0;
        for last in 0..alive {
            let time = self.times[last];
            // At the last life a unit is replaced without an inspection.
            let mut ended = replaced;
            ended.add(passed, costs.planned, time, (last, costs.inspection));
            visit(last, &ended);
            let signal = passed * self.signal(self.values[j * k + last], level);
            replaced.add(signal, costs.planned, time, (last + 1, costs.inspection));
            replaced.by_level += signal;
            passed -= signal;
        }
        let passed = passed.max(0.0);
        if alive < k {
            replaced.add(passed, costs.failure, self.lives[j], (alive, costs.inspection));
            replaced.failed = passed;
            (alive..k).for_each(|last| visit(last, &replaced));
        }
    }

    /// Sums over some units for a level and every last inspection `(k,)`.
    fn sums(&self, units: &[usize], level: f64, costs: &PolicyCosts) -> Vec<Renewal> {
        let mut sums = vec![Renewal::default(); self.times.len()];
        for j in units {
            self.renewals(*j, level, costs, |last, renewal| {
                let sum = &mut sums[last];
                sum.cost += renewal.cost;
                sum.length += renewal.length;
                sum.failed = sum.failed.max(renewal.failed);
            });
        }
        sums
    }

    /// Levels worth trying: quantiles of the values of living units, and where measurements err, some below.
    fn levels(&self) -> Vec<f64> {
        let k = self.times.len();
        let of_unit = |j: usize| self.values[j * k..j * k + self.alive(j)].iter().copied();
        let mut all: Vec<f64> = (0..self.lives.len()).flat_map(of_unit).collect();
        all.sort_unstable_by(f64::total_cmp);
        let last = all.len().saturating_sub(1);
        let place = |i: usize| (i as f64 / (LEVELS - 1) as f64 * last as f64) as usize;
        let below = |i: usize| all.first().map(|least| least - BELOW.1 * i as f64 * self.error);
        let mut levels: Vec<f64> = (1..=BELOW.0).rev().filter_map(below).collect();
        levels.extend((0..LEVELS).filter_map(|i| all.get(place(i)).copied()));
        levels.dedup();
        levels
    }
}

/// A level from which on a measured value has the unit replaced [unit of the output], and the index of the inspection at whose life it is
/// replaced in any case.
pub type InspectionPolicy = (f64, usize);

/// The policy with the least cost rate by every second unit; `None` without an inspection.
pub fn best_policy(samples: &InspectedSamples, costs: &PolicyCosts) -> Option<InspectionPolicy> {
    let chosen: Vec<usize> = (0..samples.lives.len()).step_by(2).collect();
    let best_of_level = |level: &f64| {
        let excess = costs.failure - costs.planned;
        let rate = |sums: Renewal| (sums.cost + 0.5 * sums.failed * excess) / sums.length;
        let rates = samples.sums(&chosen, *level, costs).into_iter().map(rate);
        let (last, rate) = rates.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some(((*level, last), rate))
    };
    let best_of = |levels: &[f64]| {
        let found: Vec<_> = levels.par_iter().filter_map(best_of_level).collect();
        found.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).map(|(policy, _)| policy)
    };
    let levels = samples.levels();
    let coarse = best_of(&levels)?;
    // Once more between its neighbours.
    let place = levels.iter().position(|level| *level == coarse.0)?;
    let (from, to) = (levels[place.saturating_sub(1)], levels[(place + 1).min(levels.len() - 1)]);
    let between = |i: usize| from + (to - from) * i as f64 / (FINER - 1) as f64;
    let finer: Vec<f64> = (0..FINER).map(between).chain([coarse.0]).collect();
    best_of(&finer)
}

/// Costs of a policy over the units by which [`best_policy`] does not choose.
pub fn outcome_of(
    samples: &InspectedSamples,
    (level, chosen): InspectionPolicy,
    costs: &PolicyCosts,
) -> PolicyOutcome {
    let of_unit = |j: usize| {
        let mut found = Renewal::default();
        samples.renewals(j, level, costs, |last, renewal| {
            if last == chosen {
                found = *renewal;
            }
        });
        found
    };
    let renewals: Vec<Renewal> = (1..samples.lives.len()).step_by(2).map(of_unit).collect();
    let n = renewals.len() as f64;
    let mean = |of: &dyn Fn(&Renewal) -> f64| renewals.iter().map(of).sum::<f64>() / n;
    let (length, failed) = (mean(&|r| r.length), mean(&|r| r.failed));
    let worst = renewals.iter().map(|r| r.failed).fold(0.0, f64::max);
    let excess = costs.failure - costs.planned;
    let unseen = 0.5 * worst / n;
    let rate = (mean(&|r| r.cost) + excess * unseen) / length;
    // Standard error of the mean of numbers of the renewals, whose own mean is 0 but for the failures not seen.
    let error = |of: &dyn Fn(&Renewal) -> f64| {
        let center = mean(of);
        (mean(&|r| (of(r) - center).powi(2)) / (n - 1.0)).sqrt() / length
    };
    let standard_error = error(&|r| r.cost - rate * r.length);
    let planned_error = error(&|r| r.cost - excess * r.failed - rate * r.length);
    let squares = mean(&|r| r.failed.powi(2));
    let further = excess * (upper_share(failed, squares, n) - failed - unseen).max(0.0) / length;
    PolicyOutcome {
        cost_rate: rate,
        standard_error,
        lower: rate - excess * unseen / length - REACH * standard_error,
        upper: rate + (REACH * standard_error).max((REACH * planned_error).hypot(further)),
        failed: failed + unseen,
        by_level: mean(&|r| r.by_level),
        mean_life: length,
        inspections: mean(&|r| r.inspections),
    }
}

/// Upper limit of the share of failures [1] whose probabilities have the mean `mean` and the mean square `squares` over n units,
/// where a further unit may fail for certain: with y = n mean + 1 and v = n squares + 1, the [`UPPER`] quantile
/// of the gamma distribution of mean y and variance v, over n.
fn upper_share(mean: f64, squares: f64, n: f64) -> f64 {
    let (y, v) = (n * mean + 1.0, n * squares + 1.0);
    let limit = Gamma::new(y * y / v, y / v).map_or(f64::INFINITY, |law| law.inverse_cdf(UPPER));
    (limit / n).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wear that is proportional to time, lives of 1000 to 2000 cycles at equal distances, inspected every 100 cycles.
    fn linear(samples: usize) -> InspectedSamples {
        let lives: Vec<f64> =
            (0..samples).map(|j| 1000.0 + 1000.0 * ((j as f64 * 0.618_034).fract())).collect();
        let times: Vec<f64> = (1..=20).map(|k| 100.0 * f64::from(k)).collect();
        let values = lives.iter().flat_map(|life| times.iter().map(move |t| t / life)).collect();
        InspectedSamples { lives, times, values, error: 0.0, two_sided: false }
    }

    /// Lives of the exact wear law above, measured with an error.
    fn measured(samples: usize, error: f64) -> InspectedSamples {
        InspectedSamples { error, ..linear(samples) }
    }

    #[test]
    fn issue_failures_not_seen_have_no_cost() {
        // Inspections every 100 cycles with an error that lets about one unit in 10 000 fail at a level of 0.75.
        let policy = (0.75, 19);
        let truth_of = |costs: &PolicyCosts| {
            let all = outcome_of(&measured(400_000, 0.04), policy, costs);
            (all.cost_rate, all.failed)
        };
        for failure in [1e3, 1e4, 1e5] {
            let costs = PolicyCosts { planned: 1.0, failure, inspection: 0.0 };
            let ((truth, share), found) =
                (truth_of(&costs), outcome_of(&measured(1000, 0.04), policy, &costs));
            assert!(share > 0.0 && share < 5e-4, "{share}");
            assert!(found.lower < truth && truth < found.upper, "{failure}: {found:?} {truth}");
        }
        // Without an error no unit fails: the limit is that of no failure among 500.
        let costs = PolicyCosts { planned: 1.0, failure: 1e4, inspection: 0.0 };
        let found = outcome_of(&linear(1000), policy, &costs);
        let least = found.cost_rate + 3.0 / 500.0 * 9999.0 / found.mean_life;
        assert!(found.failed == 0.0 && found.upper > least, "{found:?} {least}");
    }

    #[test]
    fn dearer_failures_lower_the_level() {
        let samples = measured(4000, 0.05);
        let level = |failure: f64| {
            let costs = PolicyCosts { planned: 1.0, failure, inspection: 0.0 };
            best_policy(&samples, &costs).unwrap().0
        };
        let levels = [10.0, 1e3, 1e5].map(level);
        assert!(levels[0] > levels[1] + 0.02 && levels[1] > levels[2] + 0.02, "{levels:?}");
    }

    #[test]
    fn the_mean_over_errors_is_that_of_drawn_errors() {
        use rand::SeedableRng;
        use rand_distr::{Distribution, StandardNormal};
        let (exact, policy) = (measured(2000, 0.1), (0.7, 15));
        let costs = PolicyCosts { planned: 1.0, failure: 10.0, inspection: 0.1 };
        let mut rng = rand_chacha::ChaCha12Rng::seed_from_u64(3);
        let mut drawn = linear(40_000);
        drawn
            .values
            .iter_mut()
            .for_each(|y| *y += 0.1 * Distribution::<f64>::sample(&StandardNormal, &mut rng));
        let (exact, drawn) = (outcome_of(&exact, policy, &costs), outcome_of(&drawn, policy, &costs));
        let error = drawn.standard_error.hypot(exact.standard_error);
        assert!((exact.cost_rate - drawn.cost_rate).abs() < 4.0 * error, "{exact:?} {drawn:?}");
        assert!((exact.by_level - drawn.by_level).abs() < 0.02 && (exact.failed - drawn.failed).abs() < 0.01);
        // With two signs: far from 0 the same, at a level of 0 certain.
        let two = InspectedSamples { two_sided: true, ..measured(10, 0.1) };
        assert_eq!((two.signal(0.2, 0.0), two.signal(3.0, 2.9)), (1.0, measured(10, 0.1).signal(3.0, 2.9)));
        assert!((two.signal(0.0, 0.1) - 2.0 * measured(10, 0.1).signal(0.0, 0.1)).abs() < 1e-12);
    }

    #[test]
    fn free_exact_inspections_replace_just_before_the_failure() {
        let samples = linear(4000);
        let costs = PolicyCosts { planned: 1.0, failure: 1000.0, inspection: 0.0 };
        let policy = best_policy(&samples, &costs).unwrap();
        let outcome = outcome_of(&samples, policy, &costs);
        // The next 100 cycles are fatal from a wear of 1 - 100 / life on: at 1000 cycles from 0.9 on.
        assert!((policy.0 - 0.9).abs() < 0.03, "{policy:?}");
        assert!(outcome.failed < 1e-3, "{outcome:?}");
        // Against replacement of all before the first failure, at 1000 cycles.
        assert!(outcome.mean_life > 1250.0 && outcome.cost_rate < 1.0 / 1250.0, "{outcome:?}");
    }

    #[test]
    fn without_a_level_it_is_age_replacement() {
        let samples = linear(4000);
        let costs = PolicyCosts { planned: 1.0, failure: 10.0, inspection: 0.0 };
        let policy = (f64::INFINITY, 11);
        let outcome = outcome_of(&samples, policy, &costs);
        // R(1200) = 0.8, integral 1000 + 200 * 0.9.
        let exact = (0.8 + 0.2 * 10.0) / 1180.0;
        assert!((outcome.cost_rate - exact).abs() < 4.0 * outcome.standard_error, "{outcome:?} {exact}");
        assert_eq!((outcome.by_level, outcome.inspections > 10.0), (0.0, true));
    }

    #[test]
    fn dear_inspections_are_left_out() {
        let samples = linear(1000);
        let costs = PolicyCosts { planned: 1.0, failure: 10.0, inspection: 100.0 };
        let policy = best_policy(&samples, &costs).unwrap();
        // Replaced at the first life, where no inspection is made.
        assert_eq!((policy.1, outcome_of(&samples, policy, &costs).inspections), (0, 0.0));
    }
}
