//! The changes of reliabilities and lives between two results from the same simulations, over populations of common random
//! numbers.

use crate::results::life_summary::{CyclesRange, LifeRow};
use crate::results::summary::{ReliabilityRange, ReliabilityRow, StudySummary};
use crate::statistics::reliability::REACH;
use crate::statistics::reliability::paired::{
    Change, IntervalEstimate, OtherErrors, change, sampling_correlation,
};
use serde::Serialize;
use std::collections::BTreeMap;

/// Changes of R at one checkpoint, by limit state and `total`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReliabilityChange {
    /// Checkpoint of life [cycles].
    pub cycles: u32,
    /// Change of R per curve.
    #[serde(flatten)]
    pub change: BTreeMap<String, Change>,
}

/// Change of the life at which a reliability falls to a level.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChangeOfLife {
    /// Name of the limit state, or `total`.
    pub limit_state: String,
    /// Level of the reliability [1].
    pub reliability: f64,
    /// Change of the life with its 95 % interval [cycles]; absent where one of the lives is not known.
    pub cycles: Option<Change>,
}

impl ChangeOfLife {
    /// True for the life of this curve at this level of the reliability.
    pub fn is_of(&self, name: &str, level: f64) -> bool {
        self.limit_state == name && self.reliability.to_bits() == level.to_bits()
    }
}

/// The points of both populations, which are made from the same uniform numbers.
pub struct PairedResults {
    /// First failures `(curves)(N,)` before and after.
    first: [Vec<Vec<u32>>; 2],
    points: f64,
    errors: OtherErrors,
}

impl PairedResults {
    /// The pair with these first failures before and after, of the system last.
    pub fn new(before: Vec<Vec<u32>>, after: Vec<Vec<u32>>, errors: OtherErrors) -> Self {
        let points = before[0].len() as f64;
        Self { first: [before, after], points, errors }
    }

    /// Correlation of the shares of curve `c` at checkpoints before and after; 0 for populations of other sizes, and for different ones
    /// near the limits, whose points are not the same random numbers.
    fn correlation(&self, c: usize, by: (usize, usize), of: [&StudySummary; 2]) -> f64 {
        let [before, after] = [&self.first[0][c], &self.first[1][c]];
        let is_paired =
            of.iter().all(|summary| summary.conditional.is_none()) || self.first[0] == self.first[1];
        if is_paired && before.len() == after.len() { sampling_correlation(before, after, by) } else { 0.0 }
    }

    /// Half of the 95 % interval of sampling of a share [1].
    fn sampling(&self, r: f64) -> f64 {
        REACH * (r * (1.0 - r) / self.points).max(0.0).sqrt()
    }

    /// Changes of R at every checkpoint.
    pub fn reliability(&self, before: &StudySummary, after: &StudySummary) -> Vec<ReliabilityChange> {
        let names = curve_names(before);
        let interval = |row: &ReliabilityRow, name: &str| {
            let ReliabilityRange { lower, upper } = row.interval_of(name)?;
            let value = *row.reliability.get(name)?;
            Some(IntervalEstimate { value, lower, upper: Some(upper), sampling: self.sampling(value) })
        };
        let (of, rows) = ([before, after], before.reliability.iter().zip(&after.reliability).enumerate());
        rows.map(|(n, (before, after))| {
            let of_curve = |(c, name): (usize, &String)| {
                let r = self.correlation(c, (n, n), of);
                let found = change(interval(before, name)?, interval(after, name)?, r, self.errors);
                Some((name.clone(), found))
            };
            let change = names.iter().enumerate().filter_map(of_curve).collect();
            ReliabilityChange { cycles: before.cycles, change }
        })
        .collect()
    }

    /// Changes of the lives at every level.
    pub fn lives(&self, before: &StudySummary, after: &StudySummary) -> Vec<ChangeOfLife> {
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
                let r = self.correlation(c, (nearest(life_before), nearest(life_after)), [before, after]);
                let interval = |row: &LifeRow, value: f64, summary: &StudySummary| {
                    let CyclesRange { lower, upper } = row.whole_interval();
                    IntervalEstimate { value, lower, upper, sampling: self.sampling_of_life(summary, row) }
                };
                let (before, after) = (interval(b, life_before, before), interval(a, life_after, after));
                Some(change(before, after, r, self.errors))
            });
            ChangeOfLife { limit_state: b.limit_state.clone(), reliability: b.reliability, cycles: both }
        })
        .collect()
    }

    /// Half of the 95 % interval of sampling of a life [cycles], read from the curve at the level and its interval.
    fn sampling_of_life(&self, summary: &StudySummary, row: &LifeRow) -> f64 {
        let reach = self.sampling(row.reliability);
        let curve = summary.curves.iter().find(|curve| curve.limit_state == row.limit_state);
        let life = |level: f64| {
            let curve = curve.filter(|curve| curve.reliability[0] > level)?;
            reached(&curve.cycles, &curve.reliability, level)
        };
        let lives = life(row.reliability + reach).zip(life(row.reliability - reach));
        lives.map_or(0.0, |(first, last)| 0.5 * (last - first))
    }
}

/// Names of the curves: the limit states and `total`.
pub fn curve_names(summary: &StudySummary) -> Vec<String> {
    summary.limit_states.iter().cloned().chain(["total".to_owned()]).collect()
}

/// At most `count` >= 2 of the values, evenly spread from the first to the last one.
pub(in crate::analyses) fn spread<T: Copy>(values: &[T], count: usize) -> Vec<T> {
    let n = values.len().min(count);
    (0..n).map(|i| values[i * (values.len() - 1) / (n - 1).max(1)]).collect()
}

/// The time at which straight lines between `values` `(g,)` [1] at `cycles` `(g,)` first fall to a level [cycles].
pub fn reached(cycles: &[f64], values: &[f64], level: f64) -> Option<f64> {
    let next = values.iter().position(|r| *r <= level)?;
    let Some(before) = next.checked_sub(1) else { return Some(cycles[0]) };
    let (r0, r1) = (values[before], values[next]);
    Some(cycles[before] + (r0 - level) / (r0 - r1) * (cycles[next] - cycles[before]))
}
