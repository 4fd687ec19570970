//! How far a changed population leaves the region that the simulations cover: the range of the simulated values of each
//! variable, and the predicted standard deviations of the surrogates.
//!
//! The surrogates' stated errors grow outside of the region as their model says. The model holds there only if the response
//! goes on as it does inside, which no simulation has shown.

use crate::analyses::paired_results::reached;
use crate::results::life_summary::{CyclesRange, LifeCurveRow};
use crate::results::summary::{ReliabilityRange, StudySummary};
use crate::study::CampaignResult;
use common::scene::Scene;
use serde::Serialize;

/// Share of the studied population by which the largest usual standard deviation is defined [1].
const USUAL: f64 = 0.99;

/// Shares of the populations outside the simulated region.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Region {
    /// Share of the studied population [1] with at least one variable outside the range of its simulated values.
    pub outside_before: f64,
    /// Share of the changed population [1] with at least one variable outside that range.
    pub outside_after: f64,
    /// Share of the changed population [1] where a surrogate is less certain than for 99 % of the studied one.
    pub uncertain_after: f64,
    /// The variables with the largest shares of the changed population outside, largest first; those with none are left out.
    pub variables: Vec<OutsideVariable>,
}

/// The part of a variable's distribution that was not simulated.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutsideVariable {
    /// Name of the variable.
    pub name: String,
    /// Smallest simulated value [SI].
    pub simulated_from: f64,
    /// Largest simulated value [SI].
    pub simulated_to: f64,
    /// Share of the studied population outside of these [1].
    pub outside_before: f64,
    /// Share of the changed population outside of these [1].
    pub outside_after: f64,
}

/// Share of a population [1] beyond twice the studied one's by which the region counts as left.
const MARGIN: f64 = 0.05;

/// Share of a population [1] outside of the region, more than that of the studied one, from which the surrogates' own errors are not
/// taken for the intervals.
const MOST: f64 = 0.5;

/// True if the share `after` of the changed population outside of a region is clearly larger than that of the studied one.
fn is_more(before: f64, after: f64) -> bool {
    after > 2.0 * before + MARGIN
}

impl OutsideVariable {
    /// True if the changed population leaves the simulated values of this variable clearly more than the studied one.
    pub fn is_left(&self) -> bool {
        is_more(self.outside_before, self.outside_after)
    }
}

impl Region {
    /// The region of the results of `after`, whose populations are those of `before` and `after`, in the same coordinates.
    pub fn new(scene: &Scene, before: &CampaignResult, after: &CampaignResult) -> Self {
        let d = scene.variables.len();
        let ranges = after.observations.ranges();
        let (outside_before, by_before) = shares_outside(before, &ranges);
        let (outside_after, by_after) = shares_outside(after, &ranges);
        let inputs = &before.classified.population.inputs;
        let variable = |k: usize| OutsideVariable {
            name: scene.variables[k].name.clone(),
            simulated_from: inputs.physical_value(k, ranges[k].0),
            simulated_to: inputs.physical_value(k, ranges[k].1),
            outside_before: by_before[k],
            outside_after: by_after[k],
        };
        let mut variables: Vec<_> = (0..d).filter(|k| by_after[*k] > 0.0).map(variable).collect();
        variables.sort_by(|a, b| b.outside_after.total_cmp(&a.outside_after));
        Self { outside_before, outside_after, uncertain_after: uncertain(before, after), variables }
    }

    /// Share of the changed population outside of the simulated values [1], if it is most of it and more than that of the studied one;
    /// else 0.
    pub fn unknown_share(&self) -> f64 {
        let any = (self.outside_before, self.outside_after);
        let shares = self.variables.iter().map(|v| (v.outside_before, v.outside_after)).chain([any]);
        shares.filter(|(before, after)| after - before > MOST).map(|(_, after)| after).fold(0.0, f64::max)
    }

    /// True if the changed population leaves the region clearly more than the studied one.
    pub fn is_left(&self) -> bool {
        is_more(self.outside_before, self.outside_after)
            || is_more(1.0 - USUAL, self.uncertain_after)
            || self.variables.iter().any(OutsideVariable::is_left)
    }
}

/// Share of a population outside of any of these ranges, and by variable [1].
fn shares_outside(learned: &CampaignResult, ranges: &[(f64, f64)]) -> (f64, Vec<f64>) {
    let population = learned.classified.unconditional();
    let (mut any, mut by_variable) = (0usize, vec![0usize; ranges.len()]);
    for j in 0..population.len() {
        let values = population.standardised(j).iter().zip(ranges);
        let outside: Vec<bool> = values.map(|(z, (low, high))| z < low || z > high).collect();
        any += usize::from(outside.contains(&true));
        by_variable.iter_mut().zip(outside).for_each(|(count, is_outside)| *count += usize::from(is_outside));
    }
    let share = |count: usize| count as f64 / population.len() as f64;
    (share(any), by_variable.into_iter().map(share).collect())
}

/// Share of the changed population [1] where the surrogate of any limit state has a larger standard deviation than for the
/// share [`USUAL`] of the studied one.
fn uncertain(before: &CampaignResult, after: &CampaignResult) -> f64 {
    let modes = before.assessment.modes.iter().zip(&after.assessment.modes);
    let bounds = modes.map(|(before, after)| {
        let mut usual = before.variance_factor.clone();
        let place = ((usual.len() - 1) as f64 * USUAL) as usize;
        let (_, bound, _) = usual.select_nth_unstable_by(place, f64::total_cmp);
        (*bound, after.variance_factor.as_slice())
    });
    let bounds: Vec<(f64, &[f64])> = bounds.collect();
    let n = bounds.first().map_or(0, |(_, factors)| factors.len());
    let exceeds = |j: &usize| bounds.iter().any(|(bound, factors)| factors[*j] > *bound);
    (0..n).filter(exceeds).count() as f64 / n.max(1) as f64
}

/// Widens the 95 % intervals of R and of the lives of `summary` by a share s of unknown units [1].
///
/// A surrogate states its own error, which supposes that the response goes on as inside. If the share of the population outside is large,
/// that supposition decides R. Then nothing is taken as known there: all or none of these units may fail,
///
///   R - s <= R(n) <= R + s, within 0 and 1,
///
/// and a life lies where these limits fall to its level. The same convention bounds a share that cannot be simulated.
pub(super) fn widen(summary: &mut StudySummary, share: f64) {
    let down = |r: &mut f64| *r = (*r - share).max(0.0);
    let up = |r: &mut f64| *r = (*r + share).min(1.0);
    for row in &mut summary.reliability {
        let names: Vec<String> = row.reliability.keys().cloned().collect();
        for name in names {
            let Some(ReliabilityRange { mut lower, mut upper }) = row.interval_of(&name) else { continue };
            down(&mut lower);
            up(&mut upper);
            row.numerical.remove(&name);
            row.interval.insert(name, ReliabilityRange { lower, upper });
        }
    }
    for curve in &mut summary.curves {
        curve.lower.iter_mut().chain(&mut curve.numerical_lower).for_each(down);
        curve.upper.iter_mut().chain(&mut curve.numerical_upper).for_each(up);
    }
    for life in &mut summary.lives {
        let of_life = |curve: &&LifeCurveRow| curve.limit_state == life.limit_state;
        let Some(curve) = summary.curves.iter().find(of_life) else { continue };
        let fall = |limit: &[f64]| reached(&curve.cycles, limit, life.reliability);
        let range = |lower: &[f64], upper: &[f64], end: f64| CyclesRange {
            lower: fall(lower).unwrap_or(end),
            upper: fall(upper),
        };
        life.interval = range(&curve.lower, &curve.upper, life.interval.lower);
        if let Some(with) = &mut life.with_numerical_error
            && !curve.numerical_lower.is_empty()
        {
            *with = range(&curve.numerical_lower, &curve.numerical_upper, with.lower);
        }
    }
}
