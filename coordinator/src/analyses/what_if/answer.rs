//! The answer to a what-if: reliability, lives and first failures of the studied and of the changed scene, from the same
//! simulations and over populations of common random numbers, and their changes with intervals.

use super::changes::Changes;
use super::region::Region;
use crate::results::life_summary::{LifeCurveRow, LifeRow};
use crate::results::summary::{ReliabilityRow, StudySummary};
use crate::statistics::reliability::REACH;
use crate::statistics::reliability::paired::{Change, IntervalEstimate, change, sampling_correlation};
use crate::study::{
    CampaignResult, Settings, StoredOutcome, StudyError, learn_from_results, learn_with_surrogates, result_of,
};
use common::scene::Scene;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// Largest population that is assessed, unless another size is asked for: the standard error of R is then at most 0.003, and
/// that of a change mostly much less.
pub const POPULATION: usize = 30_000;

/// A finished study, as far as a what-if needs it.
#[derive(Debug, Clone, Copy)]
pub struct FinishedStudy<'a> {
    /// Scene of the study.
    pub scene: &'a Scene,
    /// Settings of the study; `samples` is the size of the population.
    pub settings: &'a Settings,
    /// Outcomes of all simulations.
    pub outcomes: &'a [StoredOutcome],
    /// Result of the study.
    pub summary: &'a StudySummary,
}

/// The answer to a what-if.
#[derive(Debug, Clone, PartialEq)]
pub struct WhatIf {
    /// What was changed.
    pub changes: Changes,
    /// Result for the studied scene.
    pub before: StudySummary,
    /// Result for the changed scene.
    pub after: StudySummary,
    /// Changes of R, one row per checkpoint.
    pub reliability: Vec<ReliabilityChange>,
    /// Changes of the lives, one row per row of the lives.
    pub lives: Vec<ChangeOfLife>,
    /// Where the changed population leaves the simulated region.
    pub region: Region,
    /// Comparison of the result for the studied scene with that of the study.
    pub agreement: Agreement,
    /// Largest estimated surrogate error of any R(n) of the changed scene [1], and the one at which learning may stop.
    pub surrogate_error: f64,
    /// Surrogate error at which a study with these settings may stop [1].
    pub target_error: f64,
    /// True if failures of the study are so rare that it has a population conditional on an intermediate event.
    pub is_rare: bool,
    /// Number of simulations used.
    pub simulations: usize,
    /// Duration of the answer without reading and writing of files [s].
    pub seconds: f64,
}

/// Changes of R at one checkpoint, by limit state and `total`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReliabilityChange {
    /// Checkpoint of life [cycles].
    pub cycles: u32,
    /// Change of R per curve.
    #[serde(flatten)]
    pub change: BTreeMap<String, ChangeRow>,
}

/// A change with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ChangeRow {
    /// After minus before.
    pub value: f64,
    /// Lower limit; absent where it is not known.
    pub lower: Option<f64>,
    /// Upper limit; absent where it is not known.
    pub upper: Option<f64>,
}

impl From<Change> for ChangeRow {
    fn from(Change { value, lower, upper }: Change) -> Self {
        Self { value, lower, upper }
    }
}

/// Change of the life at which a reliability falls to a level.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChangeOfLife {
    /// Name of the limit state, or `total`.
    pub limit_state: String,
    /// Level of the reliability [1].
    pub reliability: f64,
    /// Change of the life with its 95 % interval [cycles]; absent where one of the lives is not known.
    pub cycles: Option<ChangeRow>,
}

/// How near the reassessed results come to those of the study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Agreement {
    /// Largest difference of any R(n) from that of the study [1].
    pub largest_difference: f64,
    /// Curve and checkpoint where it occurs.
    pub limit_state: String,
    /// Checkpoint of the difference [cycles].
    pub cycles: u32,
    /// Half of the width of the 95 % interval that the study states there [1].
    pub stated: f64,
}

/// Answers a what-if without any simulation.
///
/// # Errors
/// [`StudyError`].
pub fn ask(study: &FinishedStudy<'_>, changed: &Scene) -> Result<WhatIf, StudyError> {
    let started = Instant::now();
    let FinishedStudy { scene, settings, outcomes, summary } = *study;
    let before = learn_from_results(scene, scene, settings, outcomes)?;
    let fitted = &before.assessment.surrogates;
    let after = learn_with_surrogates(changed, scene, settings, outcomes, fitted)?;
    let summaries = [(scene, &before), (changed, &after)]
        .map(|(scene, learned)| result_of(scene, settings, learned, started).summary);
    let paired = Paired::new(&before, &after);
    let [before_summary, after_summary] = summaries;
    Ok(WhatIf {
        changes: Changes::between(scene, changed),
        reliability: paired.reliability(&before_summary, &after_summary),
        lives: paired.lives(&before_summary, &after_summary),
        region: Region::new(scene, &before, &after),
        agreement: agreement(summary, &before_summary),
        surrogate_error: after.assessment.errors.largest(),
        target_error: settings.targets().error,
        is_rare: summary.conditional.is_some(),
        simulations: outcomes.len(),
        before: before_summary,
        after: after_summary,
        seconds: started.elapsed().as_secs_f64(),
    })
}

/// The points of both populations, which are made from the same uniform numbers.
struct Paired {
    /// First failures `(curves)(N,)` before and after.
    first: [Vec<Vec<u32>>; 2],
    points: f64,
}

impl Paired {
    fn new(before: &CampaignResult, after: &CampaignResult) -> Self {
        let first = [before, after].map(|learned| learned.assessment.first_failures());
        let points = first[0][0].len() as f64;
        Self { first, points }
    }

    /// Correlation of the shares of curve `c` at checkpoints before and after; 0 for populations of other sizes.
    fn correlation(&self, c: usize, by: (usize, usize)) -> f64 {
        let [before, after] = [&self.first[0][c], &self.first[1][c]];
        if before.len() == after.len() { sampling_correlation(before, after, by) } else { 0.0 }
    }

    /// Half of the 95 % interval of sampling of a share [1].
    fn sampling(&self, r: f64) -> f64 {
        REACH * (r * (1.0 - r) / self.points).max(0.0).sqrt()
    }

    fn reliability(&self, before: &StudySummary, after: &StudySummary) -> Vec<ReliabilityChange> {
        let names = curve_names(before);
        let interval = |row: &ReliabilityRow, name: &str| {
            let range = row.interval_of(name)?;
            let value = *row.reliability.get(name)?;
            Some(IntervalEstimate {
                value,
                lower: range.lower,
                upper: Some(range.upper),
                sampling: self.sampling(value),
            })
        };
        let rows = before.reliability.iter().zip(&after.reliability).enumerate();
        rows.map(|(n, (before, after))| {
            let of_curve = |(c, name): (usize, &String)| {
                let r = self.correlation(c, (n, n));
                let found = change(interval(before, name)?, interval(after, name)?, r);
                Some((name.clone(), found.into()))
            };
            let change = names.iter().enumerate().filter_map(of_curve).collect();
            ReliabilityChange { cycles: before.cycles, change }
        })
        .collect()
    }

    fn lives(&self, before: &StudySummary, after: &StudySummary) -> Vec<ChangeOfLife> {
        let names = curve_names(before);
        let checkpoints: Vec<f64> = before.reliability.iter().map(|row| f64::from(row.cycles)).collect();
        // The checkpoint nearest to a life.
        let nearest = |life: f64| {
            let distance = |n: &usize| (checkpoints[*n] - life).abs();
            (0..checkpoints.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
        };
        let rows = before.lives.iter().zip(&after.lives);
        rows.map(|(b, a)| {
            let both = b.cycles.zip(a.cycles).and_then(|(life_before, life_after)| {
                let c = names.iter().position(|name| *name == b.limit_state)?;
                let r = self.correlation(c, (nearest(life_before), nearest(life_after)));
                let interval = |row: &LifeRow, value: f64, summary: &StudySummary| IntervalEstimate {
                    value,
                    lower: row.interval.lower,
                    upper: row.interval.upper,
                    sampling: self.sampling_of_life(summary, row),
                };
                Some(change(interval(b, life_before, before), interval(a, life_after, after), r).into())
            });
            ChangeOfLife { limit_state: b.limit_state.clone(), reliability: b.reliability, cycles: both }
        })
        .collect()
    }

    /// Half of the 95 % interval of sampling of a life [cycles], read from the curve at the level and its interval.
    fn sampling_of_life(&self, summary: &StudySummary, row: &LifeRow) -> f64 {
        let reach = self.sampling(row.reliability);
        let Some(curve) = summary.curves.iter().find(|curve| curve.limit_state == row.limit_state) else {
            return 0.0;
        };
        let lives = [row.reliability + reach, row.reliability - reach].map(|level| life_at(curve, level));
        match lives {
            [Some(first), Some(last)] => 0.5 * (last - first),
            _ => 0.0,
        }
    }
}

/// Names of the curves: the limit states and `total`.
pub fn curve_names(summary: &StudySummary) -> Vec<String> {
    summary.limit_states.iter().cloned().chain(["total".to_owned()]).collect()
}

/// The time at which a curve falls to a level, between its points [cycles].
fn life_at(curve: &LifeCurveRow, level: f64) -> Option<f64> {
    let next = curve.reliability.iter().position(|r| *r <= level)?;
    let before = next.checked_sub(1)?;
    let (r0, r1) = (curve.reliability[before], curve.reliability[next]);
    let share = if r0 > r1 { (r0 - level) / (r0 - r1) } else { 1.0 };
    Some(curve.cycles[before] + share * (curve.cycles[next] - curve.cycles[before]))
}

/// The largest difference of the R(n) of two results of the same scene, with what `study` states there.
fn agreement(study: &StudySummary, again: &StudySummary) -> Agreement {
    let mut found =
        Agreement { largest_difference: 0.0, limit_state: "total".to_owned(), cycles: 0, stated: 0.0 };
    for (own, row) in study.reliability.iter().zip(&again.reliability) {
        for (name, r) in &own.reliability {
            let difference = row.reliability.get(name).map_or(0.0, |again| (r - again).abs());
            if difference > found.largest_difference || found.cycles == 0 {
                let range = own.interval_of(name);
                let stated = range.map_or(0.0, |range| 0.5 * (range.upper - range.lower));
                found = Agreement {
                    largest_difference: difference,
                    limit_state: name.clone(),
                    cycles: own.cycles,
                    stated,
                };
            }
        }
    }
    found
}
