//! Replacement by inspection: a unit is inspected at given lives, replaced if a measured output has reached a level, replaced
//! at its failure, and at the last of these lives in any case, without another inspection.
//!
//! Over N samples with the cost C_j and the length L_j of the renewal of each,
//!
//!   g = sum C_j / sum L_j,   standard error = sqrt(sum (C_j - g L_j)^2 / (N (N - 1))) / mean L,
//!
//! the ratio estimator of the renewal-reward theorem. Level and number of inspections with the least g are sought among the
//! quantiles of the measured values and all numbers of inspections. They are chosen by every second sample and their cost is
//! stated over the others, so that the choice does not flatter it.
//!
//! # Source
//! Renewal-reward theorem: Ross (1996), Stochastic Processes, Wiley, section 3.6; ratio estimator: Cochran (1977), Sampling
//! Techniques, Wiley, chapter 6; policy: Jardine, Tsang (2013), Maintenance, Replacement, and Reliability, chapter 3.

use rayon::prelude::*;

/// Levels that are tried.
const LEVELS: usize = 80;
/// Levels that are tried between the neighbours of the best.
const FINER: usize = 30;

/// Lives of samples and what their inspections would measure.
#[derive(Debug, Clone)]
pub struct InspectedSamples {
    /// Lives `(N,)`, infinite beyond the life studied [cycles].
    pub lives: Vec<f64>,
    /// Lives of the inspections, increasing, within the life studied `(k,)` [cycles].
    pub times: Vec<f64>,
    /// Measured values `(N, k)` row-major [unit of the output], larger for more worn; those after a failure are not used.
    pub values: Vec<f64>,
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

/// A level and a number of inspections.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InspectionPolicy {
    /// Replaced where the measured value is at least this [unit of the output].
    pub level: f64,
    /// Index of the inspection at whose life a unit is replaced in any case.
    pub last: usize,
}

/// Costs and frequencies of a policy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolicyOutcome {
    /// Long-run cost of a cycle [currency/cycle].
    pub cost_rate: f64,
    /// Its standard error by the number of samples [currency/cycle].
    pub standard_error: f64,
    /// Share of the renewals by a failure [1].
    pub failed: f64,
    /// Share of the renewals by the measured level [1].
    pub by_level: f64,
    /// Mean length of a renewal [cycles].
    pub mean_life: f64,
    /// Mean number of inspections in a renewal [1].
    pub inspections: f64,
}

/// A renewal of one sample.
struct Renewal {
    cost: f64,
    length: f64,
    failed: bool,
    by_level: bool,
    inspections: usize,
}

impl InspectedSamples {
    /// Number of inspections of sample `j` that its life contains, and the index of the first that reaches `level`.
    fn signal(&self, j: usize, level: f64) -> (usize, usize) {
        let k = self.times.len();
        let alive = self.times.partition_point(|t| *t < self.lives[j]);
        let values = &self.values[j * k..j * k + alive];
        (alive, values.iter().position(|y| *y >= level).unwrap_or(k))
    }

    fn renewal(&self, j: usize, policy: &InspectionPolicy, costs: &PolicyCosts) -> Renewal {
        let (alive, signal) = self.signal(j, policy.level);
        let stop = signal.min(policy.last);
        let failed = stop >= alive;
        // At the last life a unit is replaced without an inspection.
        let by_level = !failed && signal < policy.last;
        let inspections = if failed { alive } else { stop + usize::from(by_level) };
        let (end, price) =
            if failed { (self.lives[j], costs.failure) } else { (self.times[stop], costs.planned) };
        let cost = price + costs.inspection * inspections as f64;
        Renewal { cost, length: end, failed, by_level, inspections }
    }

    /// Sums of costs and lengths over some samples for a level and every last inspection `(k,)`.
    fn sums(&self, samples: &[usize], level: f64, costs: &PolicyCosts) -> Vec<(f64, f64)> {
        let mut sums = vec![(0.0, 0.0); self.times.len()];
        for j in samples {
            let (alive, signal) = self.signal(*j, level);
            for (last, sum) in sums.iter_mut().enumerate() {
                let stop = signal.min(last);
                let (price, length, made) = if stop >= alive {
                    (costs.failure, self.lives[*j], alive)
                } else {
                    (costs.planned, self.times[stop], stop + usize::from(signal < last))
                };
                sum.0 += price + costs.inspection * made as f64;
                sum.1 += length;
            }
        }
        sums
    }

    /// Levels worth trying: quantiles of the values measured on living samples.
    fn levels(&self) -> Vec<f64> {
        let k = self.times.len();
        let of_sample = |j: usize| {
            let alive = self.signal(j, f64::INFINITY).0;
            self.values[j * k..j * k + alive].iter().copied()
        };
        let mut all: Vec<f64> = (0..self.lives.len()).flat_map(of_sample).collect();
        all.sort_unstable_by(f64::total_cmp);
        let last = all.len().saturating_sub(1);
        let place = |i: usize| (i as f64 / (LEVELS - 1) as f64 * last as f64) as usize;
        let mut levels: Vec<f64> = (0..LEVELS).filter_map(|i| all.get(place(i)).copied()).collect();
        levels.dedup();
        levels
    }
}

/// The policy with the least cost rate by every second sample; `None` without an inspection.
pub fn best_policy(samples: &InspectedSamples, costs: &PolicyCosts) -> Option<InspectionPolicy> {
    let chosen: Vec<usize> = (0..samples.lives.len()).step_by(2).collect();
    let best_of_level = |level: &f64| {
        let rates = samples.sums(&chosen, *level, costs).into_iter().map(|(cost, length)| cost / length);
        let (last, rate) = rates.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((InspectionPolicy { level: *level, last }, rate))
    };
    let best_of = |levels: &[f64]| {
        let found: Vec<_> = levels.par_iter().filter_map(best_of_level).collect();
        found.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).map(|(policy, _)| policy)
    };
    let levels = samples.levels();
    let coarse = best_of(&levels)?;
    // Once more between its neighbours.
    let place = levels.iter().position(|level| *level == coarse.level)?;
    let (from, to) = (levels[place.saturating_sub(1)], levels[(place + 1).min(levels.len() - 1)]);
    let between = |i: usize| from + (to - from) * i as f64 / (FINER - 1) as f64;
    let finer: Vec<f64> = (0..FINER).map(between).chain([coarse.level]).collect();
    best_of(&finer)
}

/// Costs of a policy over the samples by which [`best_policy`] does not choose.
pub fn outcome_of(
    samples: &InspectedSamples,
    policy: &InspectionPolicy,
    costs: &PolicyCosts,
) -> PolicyOutcome {
    let of_sample = |j: usize| samples.renewal(j, policy, costs);
    let renewals: Vec<Renewal> = (1..samples.lives.len()).step_by(2).map(of_sample).collect();
    let n = renewals.len() as f64;
    let mean = |of: &dyn Fn(&Renewal) -> f64| renewals.iter().map(of).sum::<f64>() / n;
    let length = mean(&|r| r.length);
    let rate = mean(&|r| r.cost) / length;
    let scatter = mean(&|r| (r.cost - rate * r.length).powi(2));
    PolicyOutcome {
        cost_rate: rate,
        standard_error: (scatter / (n - 1.0)).sqrt() / length,
        failed: mean(&|r| f64::from(u8::from(r.failed))),
        by_level: mean(&|r| f64::from(u8::from(r.by_level))),
        mean_life: length,
        inspections: mean(&|r| r.inspections as f64),
    }
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
        InspectedSamples { lives, times, values }
    }

    #[test]
    fn free_exact_inspections_replace_just_before_the_failure() {
        let samples = linear(4000);
        let costs = PolicyCosts { planned: 1.0, failure: 1000.0, inspection: 0.0 };
        let policy = best_policy(&samples, &costs).unwrap();
        let outcome = outcome_of(&samples, &policy, &costs);
        // The next 100 cycles are fatal from a wear of 1 - 100 / life on: at 1000 cycles from 0.9 on.
        assert!((policy.level - 0.9).abs() < 0.03, "{policy:?}");
        assert!(outcome.failed < 1e-3, "{outcome:?}");
        // Against replacement of all before the first failure, at 1000 cycles.
        assert!(outcome.mean_life > 1250.0 && outcome.cost_rate < 1.0 / 1250.0, "{outcome:?}");
    }

    #[test]
    fn without_a_level_it_is_age_replacement() {
        let samples = linear(4000);
        let costs = PolicyCosts { planned: 1.0, failure: 10.0, inspection: 0.0 };
        let policy = InspectionPolicy { level: f64::INFINITY, last: 11 };
        let outcome = outcome_of(&samples, &policy, &costs);
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
        assert_eq!((policy.last, outcome_of(&samples, &policy, &costs).inspections), (0, 0.0));
    }
}
