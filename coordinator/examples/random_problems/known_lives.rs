//! Lives of known distribution, and the true lives at levels of reliability beside those that the stated interval of R(n)
//! allows.
//!
//! With independent lives of distribution functions F_i, of which the least counts, P_f(t) = 1 - product over i of
//! (1 - F_i(t)). Between two checkpoints a curve of P_f is straight on Weibull paper, ln(-ln(1 - P_f)) over ln t, as that of
//! a Weibull life is; from 0 or to 1 it is straight over t.

use super::course::Course;
use super::learn::Comparison;
use super::problem::RandomProblem;
use super::truth::Truth;
use common::random::Distribution;
use coordinator::study::LEVELS;

/// Failure probability by time t of the least of independent lives of these distributions [1].
pub fn failed_by(laws: &[Distribution], t: f64) -> f64 {
    1.0 - laws.iter().map(|law| 1.0 - law.cdf(t)).product::<f64>()
}

/// Time by which the share p [1] has failed.
pub fn life_of_share(laws: &[Distribution], p: f64) -> f64 {
    let (mut low, mut high) = (0.0, laws.iter().map(|law| law.quantile(p)).fold(f64::INFINITY, f64::min));
    if laws.len() == 1 {
        return high;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        *if failed_by(laws, middle) < p { &mut low } else { &mut high } = middle;
    }
    high
}

/// True life at a level of reliability, and the stated interval, in intervals of the checkpoints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LifeComparison {
    /// Reliability [1].
    pub level: f64,
    /// True life.
    pub truth: f64,
    /// Lower limit of the 95 % interval; that of all lives before the first checkpoint is 1.
    pub lower: f64,
    /// Its upper limit; infinite beyond the end of life.
    pub upper: f64,
}

impl LifeComparison {
    /// True if the interval holds the true life.
    pub fn is_within(&self) -> bool {
        self.lower <= self.truth && self.truth <= self.upper
    }

    /// The lives of a problem with wear between its first and its last checkpoint; none for other problems.
    pub fn all(problem: &RandomProblem, truth: &Truth, checkpoints: &[Comparison]) -> Vec<Self> {
        let Course::Wear { laws, .. } = &problem.course else {
            return vec![];
        };
        let largest: Vec<f64> = checkpoints.iter().map(|c| c.interval.1).collect();
        let least: Vec<f64> = checkpoints.iter().map(|c| c.interval.0).collect();
        let (first, last) = (truth.pf[0], truth.pf[truth.pf.len() - 1]);
        let at = |level: f64| {
            let failed = 1.0 - level;
            if first >= failed || last < failed {
                return None;
            }
            let known = || truth.limit * life_of_share(laws, failed);
            let life = if laws.is_empty() { reached(&truth.pf, failed)? } else { known() };
            let end = checkpoints.len() as f64;
            Some(Self {
                level,
                truth: life,
                lower: reached(&largest, failed).unwrap_or(end),
                upper: reached(&least, failed).unwrap_or(f64::INFINITY),
            })
        };
        LEVELS.into_iter().filter_map(at).collect()
    }
}

/// Time at which the shares at the checkpoints 1, ..., m first reach p [1]; 1 before the first, `None` beyond the last.
fn reached(shares: &[f64], p: f64) -> Option<f64> {
    let after = shares.iter().position(|share| *share >= p)?;
    let Some(before) = after.checked_sub(1) else {
        return Some(1.0);
    };
    let (start, end) = ((before + 1) as f64, (after + 1) as f64);
    let along = |value: fn(f64) -> f64| {
        let [low, high, wanted] = [shares[before], shares[after], p].map(value);
        (wanted - low) / (high - low)
    };
    if shares[before] > 0.0 && shares[after] < 1.0 {
        let on_paper = along(|share| (-(-share).ln_1p()).ln());
        return Some(start * (end / start).powf(on_paper));
    }
    Some(start + along(|share| share) * (end - start))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::family::Family;
    use crate::problem::Class;
    use crate::truth::truth;

    #[test]
    fn known_lives_agree_with_integration_and_with_the_curve() {
        for (index, class) in [(0, Class::Lognormal), (2, Class::Weibull), (10, Class::Competing)] {
            let mut problem = Family::Lives.problem(1, index);
            assert_eq!(problem.class, class);
            let known = truth(&problem);
            let at_end = known.pf[problem.checkpoints() - 1];
            assert!((at_end / problem.wanted - 1.0).abs() < 1e-9, "{at_end} {}", problem.wanted);
            let exact = |n: usize| Comparison {
                pf: known.pf[n],
                // For the interpolation between checkpoints.
                standard_error: 2e-2 * known.pf[n],
                interval: (0.96 * known.pf[n], 1.04 * known.pf[n]),
                truth: known.pf[n],
                truth_error: 0.0,
            };
            let checkpoints: Vec<Comparison> = (0..problem.checkpoints()).map(exact).collect();
            let lives = LifeComparison::all(&problem, &known, &checkpoints);
            assert!(!lives.is_empty() && lives.iter().all(LifeComparison::is_within), "{lives:?}");
            let Course::Wear { laws, .. } = &mut problem.course else {
                unreachable!("all problems of the family wear")
            };
            laws.clear();
            let integrated = truth(&problem);
            assert!((integrated.limit / known.limit - 1.0).abs() < 5e-3, "{class:?} {}", integrated.limit);
            for (a, b) in integrated.pf.iter().zip(&known.pf) {
                assert!((a - b).abs() < 3e-3, "{class:?} {a} {b}");
            }
        }
    }

    #[test]
    fn times_on_weibull_paper_are_those_of_a_weibull_life() {
        let share = |t: f64| -(-(t / 10.0).powf(0.8)).exp_m1();
        let shares: Vec<f64> = (1..=20).map(|n| share(f64::from(n))).collect();
        for t in [1.3, 2.0, 7.7, 19.9] {
            assert!((reached(&shares, share(t)).unwrap() - t).abs() < 1e-9, "{t}");
        }
        assert_eq!((reached(&shares, 0.01), reached(&shares, 0.99)), (Some(1.0), None));
        assert_eq!(reached(&[0.0, 0.2, 1.0], 0.1), Some(1.5));
    }
}
