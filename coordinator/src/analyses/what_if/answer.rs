//! The answer to a what-if: reliability, lives and first failures of the studied and of the changed scene, from the same
//! simulations and over populations of common random numbers, and their changes with intervals.

use super::changes::Changes;
use super::region::{Region, widen};
use crate::analyses::paired_results::{ChangeOfLife, PairedResults, ReliabilityChange};
use crate::results::summary::StudySummary;
use crate::statistics::reliability::paired::OtherErrors;
use crate::study::{
    Settings, StoredOutcome, StudyError, learn_from_results, learn_with_surrogates, result_of,
};
use common::scene::Scene;
use serde::Serialize;
use std::time::Instant;

/// Largest population that is assessed, unless another size is asked for: the standard error of R is then at most 0.003, and
/// that of a change mostly much less.
pub const POPULATION: usize = 30_000;

/// A finished study, as far as a what-if needs it.
#[derive(Debug, Clone, Copy)]
pub struct FinishedStudy<'a> {
    /// Scene of the study; with design variables the design that its own scene has.
    pub scene: &'a Scene,
    /// Scene of the simulations, in whose coordinates the surrogates are fitted: that of the study, or its augmented scene.
    pub simulated: &'a Scene,
    /// Settings of the study; `samples` is the size of the population.
    pub settings: &'a Settings,
    /// Outcomes of all simulations.
    pub outcomes: &'a [StoredOutcome],
    /// Result of the study; `None` where it is not that of `scene`.
    pub summary: Option<&'a StudySummary>,
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
    /// Comparison of the result for the studied scene with that of the study; `None` where the study has another one.
    pub agreement: Option<Agreement>,
    /// Largest estimated surrogate error of any R(n) of the changed scene [1], and the one at which learning may stop.
    pub surrogate_error: f64,
    /// Surrogate error at which a study with these settings may stop [1].
    pub target_error: f64,
    /// Number of simulations used.
    pub simulations: usize,
    /// Duration of the answer without reading and writing of files [s].
    pub seconds: f64,
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
    let FinishedStudy { scene, simulated, settings, outcomes, summary } = *study;
    let before = learn_from_results(scene, simulated, settings, outcomes)?;
    let fitted = Some((scene, &before.assessment.surrogates[..]));
    let after = learn_with_surrogates(changed, simulated, settings, outcomes, fitted)?;
    let [before_summary, mut after_summary] = [(scene, &before), (changed, &after)]
        .map(|(scene, learned)| result_of(scene, settings, learned, started).summary);
    let [first, first_changed] = [&before, &after].map(|learned| learned.assessment.first_failures());
    let paired = PairedResults::new(first, first_changed, OtherErrors::Independent);
    let region = Region::new(scene, &before, &after);
    let unknown = region.unknown_share();
    if unknown > 0.0 {
        widen(&mut after_summary, unknown);
    }
    Ok(WhatIf {
        changes: Changes::between(scene, changed),
        reliability: paired.reliability(&before_summary, &after_summary),
        lives: paired.lives(&before_summary, &after_summary),
        region,
        agreement: summary.map(|summary| agreement(summary, &before_summary)),
        surrogate_error: after.assessment.figures.error,
        target_error: settings.targets().error,
        simulations: outcomes.len(),
        before: before_summary,
        after: after_summary,
        seconds: started.elapsed().as_secs_f64(),
    })
}

/// The largest difference of the R(n) of two results of the same scene, with what `study` states there.
fn agreement(study: &StudySummary, again: &StudySummary) -> Agreement {
    let rows = study.reliability.iter().zip(&again.reliability);
    let all = rows.flat_map(|(own, row)| {
        own.reliability.iter().map(|(name, r)| Agreement {
            largest_difference: row.reliability.get(name).map_or(0.0, |again| (r - again).abs()),
            limit_state: name.clone(),
            cycles: own.cycles,
            stated: own.interval_of(name).map_or(0.0, |range| 0.5 * (range.upper - range.lower)),
        })
    });
    let larger = |a: Agreement, b: Agreement| if b.largest_difference > a.largest_difference { b } else { a };
    all.reduce(larger).expect("a study has a checkpoint, and a curve of the system")
}
