//! The data of a report, read from the campaign file: the source of the scene, every evaluation, and the results of the
//! study from the documents `summary` and `distributions`. The report of a finished study needs no new evaluation.

use super::WrittenScene;
use super::format::words;
use super::life::governing;
use super::untested::{no_simulated_failure, steps_and_noise};
use crate::presentation::motion_cautions::{control_points_notes, motion_cautions};
use crate::results::store::{CampaignFile, CampaignMeta, StoreError};
use crate::results::summary::StudySummary;
use crate::results::verified::{VerificationRow, verifications};
use crate::study::ExplicitModel;
use common::outputs::{COUNTERS, CycleHistory, Diagnostics, Evaluation, NarrowGroove, WornLife};
use common::scene::{ContactLaw, JointKind, LimitState, OutputUnit, Scene};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Name of the document that holds the [`StudySummary`].
pub const SUMMARY_DOCUMENT: &str = "summary";

/// Name of the document that holds the [`CheckpointDistribution`]s.
pub const DISTRIBUTIONS_DOCUMENT: &str = "distributions";

/// Name of the document that holds the surrogates as plain numbers, an [`ExplicitModel`] or none.
pub const EXPLICIT_DOCUMENT: &str = "surrogates";

/// Distribution of one output at one checkpoint over the population, in SI.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CheckpointDistribution {
    /// Name of the output.
    pub output: String,
    /// Checkpoint of the distribution [cycles].
    pub cycles: u32,
    /// Mean [SI unit of the output].
    pub mean: f64,
    /// Standard deviation [SI unit of the output].
    pub std: f64,
    /// Edges of the bins, increasing `(bins + 1,)` [SI unit of the output].
    pub edges: Vec<f64>,
    /// Points of the population in each bin `(bins,)`.
    pub counts: Vec<u64>,
    /// Pairs of probability and quantile, increasing [1, SI unit of the output].
    pub quantiles: Vec<(f64, f64)>,
}

/// A simulation with a result: values of the random variables, in the scene's order `(d,)` [SI], and checkpoint by which each limit state has
/// failed, if it has `(limit states,)` [cycles].
pub type SimulatedSample = (Vec<f64>, Vec<Option<u32>>);

/// Work of all evaluations with a result, summed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WorkTotals {
    /// Evaluations with a result.
    pub evaluations: u64,
    /// Longest simulation time [s].
    pub longest: f64,
    /// Evaluations with grooves narrower than their journals, by joint.
    pub grooved: Vec<GroovedJoint>,
    /// Sums of the [`COUNTERS`].
    pub counts: [u64; COUNTERS.len()],
}

/// The data of a report.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportInput {
    /// Result of the study.
    pub summary: StudySummary,
    /// The evaluation at the variables' means, with its first cycle.
    pub nominal: Option<Evaluation>,
    /// Distributions of the outputs over the population.
    pub distributions: Vec<CheckpointDistribution>,
    /// The surrogates as plain numbers, where the study stored them.
    pub explicit: Option<ExplicitModel>,
    /// Median and largest numerical error that the evaluations state of an output at the checkpoint where R is nearest 1/2 `(outputs,)` [SI];
    /// empty if none do.
    pub stated: Vec<[f64; 2]>,
    /// Evaluations with a result, in the order of their numbers.
    pub samples: Vec<SimulatedSample>,
    /// Evaluations without a result: number, and reason given by the simulator.
    pub failures: Vec<(u64, String)>,
    /// Numerical work of all evaluations.
    pub work: WorkTotals,
    /// What direct simulation has shown of the study.
    pub verified: Vec<VerificationRow>,
    /// Cautions: limits of this study that a reader must know.
    pub notes: Vec<String>,
    /// Scene, settings, command and program of the study as its file states them.
    pub meta: CampaignMeta,
    /// The scene as it was written.
    pub written: WrittenScene,
    /// The scene with every variable at its mean.
    pub scene: Scene,
}

impl ReportInput {
    /// Reads the data from the file of a finished study; `scene` is the resolved `scene_source` of the file.
    /// `None` if the study has not been finished.
    ///
    /// # Errors
    /// [`StoreError`].
    pub fn from_campaign(campaign: &CampaignFile, scene: &Scene) -> Result<Option<Self>, StoreError> {
        let Some(mut summary) = campaign.document::<StudySummary>(SUMMARY_DOCUMENT)? else { return Ok(None) };
        // A study by an earlier version has stored less of this.
        summary.identify(scene, &campaign.meta.scene_source, &campaign.created_at);
        let distributions = campaign.document(DISTRIBUTIONS_DOCUMENT)?.unwrap_or_default();
        let go_on = go_on(&summary, &campaign.dir);
        let mut input = Self::new(scene, summary, distributions);
        input.notes.splice(0..0, go_on);
        match verifications(&campaign.dir) {
            Ok(rows) => input.verified = rows,
            Err(reason) => input.notes.push(reason),
        }
        input.explicit = campaign.document::<Option<ExplicitModel>>(EXPLICIT_DOCUMENT)?.flatten();
        input.meta = campaign.meta.clone();
        input.written = WrittenScene::new(&input.meta.scene_source);
        let cycles = governing(&input.summary).map(|row| row.cycles);
        let mut stated: Vec<Vec<f64>> = vec![vec![]; scene.outputs.len()];
        campaign.for_each(|stored| {
            if let Ok(evaluation) = &stored.outcome {
                input.work.add(&evaluation.diagnostics, stored.wall);
            }
            if stored.level > 0 {
                return Ok(());
            }
            match stored.outcome {
                Ok(evaluation) => {
                    let place = evaluation.cycles.iter().position(|at| Some(*at) == cycles);
                    let errors = evaluation.errors.iter().filter_map(|errors| errors.get(place?));
                    // The nominal simulation alone states all of its error where finer levels measure it.
                    if stored.id > 0 || input.summary.levels.is_none() {
                        stated.iter_mut().zip(errors).for_each(|(all, error)| all.push(*error));
                    }
                    input.samples.push((stored.sample, failures_of(scene, &evaluation)));
                    if stored.id == 0 {
                        input.notes.extend(cautions(scene, &evaluation));
                        input.nominal = Some(evaluation);
                    }
                }
                Err(failure) => {
                    input.failures.push((stored.id.unsigned_abs(), failure.to_string()));
                }
            }
            Ok::<(), StoreError>(())
        })?;
        input.stated = stated.into_iter().filter_map(median_and_largest).collect();
        Ok(Some(input))
    }

    /// The data of one mechanism without a study: the `summary` has no results.
    pub fn of_one(scene: &Scene, summary: StudySummary, nominal: Option<Evaluation>) -> Self {
        let mut input = Self { nominal, ..Self::new(scene, summary, vec![]) };
        input.notes.extend(input.nominal.iter().flat_map(|evaluation| cautions(scene, evaluation)));
        input
    }

    /// The data that scene and results provide, without the evaluations.
    fn new(scene: &Scene, summary: StudySummary, distributions: Vec<CheckpointDistribution>) -> Self {
        Self {
            notes: of_designs(&summary)
                .into_iter()
                .chain(unsupported(&summary))
                .chain(of_contact_law(scene))
                .chain(control_points_notes(&summary.control_points))
                .collect(),
            summary,
            nominal: None,
            distributions,
            explicit: None,
            stated: vec![],
            samples: vec![],
            failures: vec![],
            work: WorkTotals::default(),
            verified: vec![],
            meta: CampaignMeta::default(),
            written: WrittenScene::default(),
            scene: scene.clone(),
        }
    }

    /// States these texts by their keys in a scene, in place of those of the scene.
    pub fn sign(&mut self, texts: &[(&'static str, &str)]) {
        for (key, text) in texts {
            match *key {
                "scene.title" => (*text).clone_into(&mut self.scene.title),
                key => self.written.rename(key, text),
            }
        }
    }

    /// The first cycle of the nominal mechanism.
    pub fn first_cycle(&self) -> Option<&CycleHistory> {
        self.nominal.as_ref()?.first_cycle.as_ref()
    }

    /// The nominal mechanism over life.
    pub fn worn(&self) -> Option<&WornLife> {
        self.nominal.as_ref()?.worn.as_ref()
    }

    /// The last cycle of the nominal mechanism.
    pub fn last_cycle(&self) -> Option<&CycleHistory> {
        self.worn()?.last_cycle.as_ref()
    }

    /// True if lives are simulated here: of a mechanism, or around the cycles of a program.
    pub fn has_lives(&self) -> bool {
        self.scene.simulator.as_ref().is_none_or(|simulator| simulator.cycles.is_some())
    }

    /// `mechanism` or `system`.
    pub fn subject(&self) -> &'static str {
        self.summary.subject()
    }

    /// The unit a limit state's output is shown in.
    pub fn unit_of(&self, state: &LimitState) -> OutputUnit {
        self.scene.unit_of(&self.scene.outputs[state.output])
    }

    /// The name of a limit state's output, as words.
    pub fn output_of(&self, state: &LimitState) -> String {
        words(&self.scene.outputs[state.output].name)
    }
}

/// Median and largest of these values; `None` without any.
fn median_and_largest(mut values: Vec<f64>) -> Option<[f64; 2]> {
    values.sort_unstable_by(f64::total_cmp);
    Some([*values.get(values.len() / 2)?, *values.last()?])
}

/// Checkpoint by which each limit state of an evaluation has failed, if it has [cycles].
fn failures_of(scene: &Scene, evaluation: &Evaluation) -> Vec<Option<u32>> {
    let first = |state: &LimitState| {
        let history = evaluation.histories.get(state.output)?;
        let first = history.iter().position(|value| state.is_reached(*value))?;
        evaluation.cycles.get(first).copied()
    };
    scene.limit_states.iter().map(first).collect()
}

impl WorkTotals {
    fn add(&mut self, diagnostics: &Diagnostics, wall: f64) {
        self.evaluations += 1;
        self.longest = self.longest.max(wall);
        add_grooves(&mut self.grooved, &diagnostics.narrow_grooves);
        self.counts.iter_mut().zip(COUNTERS).for_each(|(sum, (.., count))| *sum += count(diagnostics));
    }
}

/// A caution if learning ended before its targets were met, with the command that goes on, or found no failure.
fn go_on(summary: &StudySummary, dir: &Path) -> Option<String> {
    let why = &summary.convergence.stopped_because;
    // The page may be read on another machine: the name of the folder says which study it is.
    let name = dir.file_name().map_or(dir, Path::new);
    let command = summary.convergence.command_to_go_on(name);
    let command = command.map_or(String::new(), |command| format!(" To go on with it: {command}."));
    let none_failed = summary.reliability.iter().all(|at| at.reliability["total"] == 1.0);
    let note = if none_failed && command.is_empty() {
        format!("Learning found no failure, so that every R is a bound. It ended because {why}.")
    } else {
        format!("This study ended before its targets were met: {why}.{command}")
    };
    (!summary.convergence.targets_met).then_some(note)
}

/// Cautions if no simulation exceeded a limit, where outputs jump at their limits, and of outliers.
fn unsupported(summary: &StudySummary) -> Vec<String> {
    let steps = steps_and_noise(summary).into_iter().filter(|note| !note.starts_with("noise"));
    no_simulated_failure(summary).into_iter().chain(steps).collect()
}

/// The note of a study over design variables.
fn of_designs(summary: &StudySummary) -> Option<String> {
    let ranges = Some(summary.designs.join(", ")).filter(|ranges| !ranges.is_empty())?;
    Some(format!(
        "The curves and sensitivities of this page are those of a design drawn at random from the ranges of {ranges}. Single designs: \
         designs/designs.html, and `coordinator designs`."
    ))
}

/// What is to be said about the motion of the nominal mechanism.
fn cautions(scene: &Scene, evaluation: &Evaluation) -> Vec<String> {
    motion_cautions(scene, evaluation).into_iter().map(|caution| caution.message).collect()
}

/// Cautions about properties of the model that affect the result.
fn of_contact_law(scene: &Scene) -> Option<String> {
    let local_hertz = scene.joints.iter().any(|joint| {
        matches!(&joint.kind, JointKind::Clearance(hinge) if hinge.contact_law == ContactLaw::LocalHertz)
    });
    let watches_speed = scene.limit_states.iter().any(|state| {
        scene.outputs.get(state.output).map(|output| output.kind.unit()) == Some(OutputUnit::AngularVelocity)
    });
    let text = "The contact law local-hertz measures penetration in one direction only. On a worn bore it does not \
            conserve energy and can excite a vibration that increases angular-velocity differences late in life; with \
            the conformal law foundation the flapping-wing drive shows no such growth. A failure by asymmetry found \
            with local-hertz is a property of that law.";
    (local_hertz && watches_speed).then(|| text.to_owned())
}

/// Number of the evaluations of a study in which a joint had such a groove, and the most open one, with the earliest life at which one was
/// there.
pub type GroovedJoint = (u64, NarrowGroove);

/// Adds the grooves of one evaluation to the counts of their joints.
fn add_grooves(grooved: &mut Vec<GroovedJoint>, grooves: &[NarrowGroove]) {
    for groove in grooves {
        let Some((evaluations, widest)) = grooved.iter_mut().find(|(_, known)| known.joint == groove.joint)
        else {
            grooved.push((1, groove.clone()));
            continue;
        };
        *evaluations += 1;
        let since = widest.since.min(groove.since);
        if groove.open > widest.open {
            widest.clone_from(groove);
        }
        widest.since = since;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::test_study;

    #[test]
    fn an_unfinished_study_has_a_caution() {
        let mut summary = test_study::study().summary;
        assert!(go_on(&summary, Path::new("a/b")).is_none());
        summary.convergence.targets_met = false;
        summary.convergence.larger_budget = Some(80);
        let said = go_on(&summary, Path::new("a/b")).unwrap();
        assert!(said.contains(&summary.convergence.stopped_because), "{said}");
        assert!(said.ends_with("To go on with it: coordinator resume b --max-evaluations 80."), "{said}");
        summary.convergence.larger_budget = None;
        for at in &mut summary.reliability {
            at.reliability.insert("total".into(), 1.0);
        }
        let said = go_on(&summary, Path::new("a/b")).unwrap();
        assert!(said.starts_with("Learning found no failure, so that every R is a bound."), "{said}");
    }

    #[test]
    fn the_caution_on_the_contact_law_appears_only_where_it_applies() {
        let mut scene = test_study::scene();
        assert!(of_contact_law(&scene).is_some());
        for joint in &mut scene.joints {
            if let JointKind::Clearance(clearance) = &mut joint.kind {
                clearance.contact_law = ContactLaw::Foundation;
            }
        }
        assert!(of_contact_law(&scene).is_none());
        let mut scene = test_study::scene();
        scene.limit_states.truncate(1);
        assert!(of_contact_law(&scene).is_none());
    }

    #[test]
    fn grooves_are_counted_by_joint_and_the_most_open_one_is_kept() {
        let groove = |joint: &str, since, open| NarrowGroove {
            joint: joint.into(),
            since,
            angle: 1.0,
            width: 0.2,
            open,
        };
        let mut grooved = vec![];
        for evaluation in [
            vec![groove("a", 4000, 1e-6)],
            vec![],
            vec![groove("a", 2000, 2e-6), groove("b", 8000, 5e-7)],
            vec![groove("a", 3000, 1.5e-6)],
        ] {
            add_grooves(&mut grooved, &evaluation);
        }
        let found: Vec<_> =
            grooved.iter().map(|(number, widest)| (*number, widest.since, widest.open)).collect();
        assert_eq!(found, [(3, 2000, 2e-6), (1, 8000, 5e-7)]);
    }
}
