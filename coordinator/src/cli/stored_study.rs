//! A study in its folder, finished or not, with its scene, settings and evaluations; and a finished one that answers questions, with
//! workers for the simulations that a question needs.

use super::{CommandError, CommandEvaluator, Done, FarmArguments};
use common::scene::{Scene, SceneSource};
use coordinator::analyses::designs::{DESIGNS_DOCUMENT, DesignSpace, StoredSpace};
use coordinator::analyses::learn::{fitted_reliability, uncertain_fits};
use coordinator::analyses::what_if::{FinishedStudy, POPULATION, WhatIf, ask};
use coordinator::presentation::report::SUMMARY_DOCUMENT;
use coordinator::presentation::terminal::Terminal;
use coordinator::results::store::{
    CampaignFile, FILE_NAME, FurtherEvaluations, StoreError, StoredEvaluation,
};
use coordinator::results::summary::StudySummary;
use coordinator::statistics::design::InputModel;
use coordinator::statistics::updating::ConfidentReliability;
use coordinator::study::{
    Correction, FurtherLearning, LifeModel, Method, Observed, Settings, StoredOutcome, StudyError,
    learn_from_results,
};
use std::path::Path;

/// Name of the document with the reason why a study ended without a result.
pub const END_DOCUMENT: &str = "end";

/// A campaign file with its scene and settings.
pub struct StoredStudy {
    /// The campaign file.
    pub campaign: CampaignFile,
    /// The scene with its text.
    pub source: SceneSource,
    /// Settings of the study.
    pub settings: Settings,
}

impl StoredStudy {
    /// Opens the folder of a study for reading, which may be running.
    ///
    /// # Errors
    /// [`CommandError::Store`] or [`CommandError::BadInput`].
    pub fn look(dir: &Path) -> Done<Self> {
        Self::read(CampaignFile::look(dir)?)
    }

    /// Reads scene and settings of an open campaign file.
    ///
    /// # Errors
    /// [`CommandError::BadInput`].
    pub fn read(campaign: CampaignFile) -> Done<Self> {
        let source = scene_of(&campaign)?;
        let settings = Settings::from_stored(&campaign.meta.settings).map_err(|error| {
            foreign(&campaign, &format!("the settings of this study cannot be read: {error}"))
        })?;
        Ok(Self { campaign, source, settings })
    }

    /// The scene at its nominal point.
    pub fn scene(&self) -> &Scene {
        self.source.nominal()
    }
}

/// The error of a command on the results of a study that has none, with the reason if it is known.
pub fn not_finished(campaign: &CampaignFile) -> CommandError {
    let dir = campaign.dir.display();
    let reason: Option<String> = campaign.document(END_DOCUMENT).ok().flatten();
    let fault = match reason {
        Some(reason) => format!("this study ended without a result: {reason}"),
        None => format!("this study is not finished; continue it with `coordinator resume {dir}`"),
    };
    CommandError::refused(dir, fault)
}

/// The summary of a finished study.
///
/// # Errors
/// [`CommandError::Store`] or [`CommandError::BadInput`].
pub fn summary_of(campaign: &CampaignFile) -> Done<StudySummary> {
    campaign.document(SUMMARY_DOCUMENT)?.ok_or_else(|| not_finished(campaign))
}

/// The scene stored in a campaign file.
///
/// # Errors
/// [`CommandError::BadInput`].
pub fn scene_of(campaign: &CampaignFile) -> Done<SceneSource> {
    SceneSource::parse(&campaign.meta.scene_source, &origin(campaign))
        .map_err(|faults| foreign(campaign, &format!("the scene of this study is not accepted:\n{faults}")))
}

/// The error of a study of another version of the program, a part of which this one cannot read. The layout of the file itself is
/// known: another one is [`StoreError::SchemaVersion`].
fn foreign(campaign: &CampaignFile, part: &str) -> CommandError {
    let program = &campaign.meta.version;
    let ours = env!("CARGO_PKG_VERSION");
    let fault = format!("written by version {program} of the program; in this one, version {ours}, {part}");
    CommandError::refused(origin(campaign), fault)
}

fn origin(campaign: &CampaignFile) -> String {
    campaign.dir.join(FILE_NAME).display().to_string()
}

/// Keys of the design variables of a study.
///
/// # Errors
/// [`CommandError::Store`].
pub fn design_keys(campaign: &CampaignFile) -> Done<Vec<String>> {
    let stored = campaign.document::<StoredSpace>(DESIGNS_DOCUMENT)?;
    Ok(stored.map_or(vec![], |stored| stored.variables.into_iter().map(|variable| variable.key).collect()))
}

/// Population on which the surrogates of a [`LifeModel`] are assessed.
const SAMPLES: usize = 20_000;

/// A finished study.
pub struct OpenedStudy {
    /// The campaign file with its scene and settings.
    pub study: StoredStudy,
    /// Result of the study.
    pub summary: StudySummary,
    /// The design variables, if it has any.
    pub space: Option<DesignSpace>,
    /// Settings of the answers: those of the study, with surrogates and a population up to [`POPULATION`].
    pub settings: Settings,
}

impl OpenedStudy {
    /// Opens the folder of a study, for reading or to add simulations.
    ///
    /// # Errors
    /// [`CommandError::Store`] or [`CommandError::BadInput`].
    pub fn open(dir: &Path, simulates: bool) -> Done<Self> {
        let campaign = if simulates { CampaignFile::open(dir)? } else { CampaignFile::look(dir)? };
        Self::of(StoredStudy::read(campaign)?)
    }

    /// Opens the folder of a study of which units are known or decided. With design variables its result is that of the design that
    /// the scene itself has: the study's own is that of a design drawn at random.
    ///
    /// # Errors
    /// As [`OpenedStudy::open`], or [`CommandError::Study`].
    pub fn of_units(dir: &Path) -> Done<Self> {
        let mut opened = Self::open(dir, false)?;
        if let Some(space) = &opened.space {
            let keys: Vec<&str> = space.variables.iter().map(|variable| variable.key.as_str()).collect();
            tracing::warn!(
                "this study has design variables: the answer is for {} of its scene",
                keys.join(", ")
            );
            let present = opened.present()?;
            opened.summary = opened.ask(&present, &present)?.before;
        }
        Ok(opened)
    }

    /// The predictor of lives of units: that of the study, with design variables at the design that the scene itself has.
    ///
    /// # Errors
    /// As [`OpenedStudy::life_model`].
    pub fn model_of_units(&self) -> Done<LifeModel> {
        let inputs = InputModel::from_scene(self.present()?.nominal());
        Ok(self.life_model()?.redistributed(inputs))
    }

    /// The study of an open campaign file.
    ///
    /// # Errors
    /// [`CommandError::Store`] or [`CommandError::BadInput`].
    pub fn of(study: StoredStudy) -> Done<Self> {
        let summary = summary_of(&study.campaign)?;
        let origin = study.campaign.dir.display().to_string();
        let space = study.campaign.document::<StoredSpace>(DESIGNS_DOCUMENT)?;
        let space = space.map(|stored| DesignSpace::from_stored(stored, &origin)).transpose()?;
        let has_population = study.settings.method.learns() && summary.conditional.is_none();
        let of_study =
            if has_population { summary.population.max(study.settings.samples) } else { POPULATION };
        let settings = Settings {
            samples: of_study.min(POPULATION),
            method: Method::ActiveLearning,
            is_rare: summary.conditional.is_some(),
            ..study.settings.clone()
        };
        Ok(Self { study, summary, space, settings })
    }

    /// The scene of the question without changes: with design variables the design that the scene itself has.
    ///
    /// # Errors
    /// [`CommandError::Scene`].
    pub fn present(&self) -> Done<SceneSource> {
        Ok(match &self.space {
            None => self.study.source.clone(),
            Some(space) => space.present(&[])?.0,
        })
    }

    /// Sample and outcome of every simulation that the campaign file holds.
    ///
    /// # Errors
    /// [`CommandError::Store`].
    pub fn outcomes(&self) -> Done<Vec<StoredOutcome>> {
        Ok(known_outcomes(&self.study.campaign, self.study.scene())?)
    }

    /// Reliability and lives of a changed scene against those of `base`, from all simulations that the study has.
    ///
    /// # Errors
    /// [`CommandError::Study`].
    pub fn ask(&self, base: &SceneSource, changed: &SceneSource) -> Done<WhatIf> {
        let finished = FinishedStudy {
            scene: base.nominal(),
            simulated: self.study.scene(),
            settings: &self.settings,
            outcomes: &self.outcomes()?,
            summary: Some(&self.summary).filter(|_| self.space.is_none()),
        };
        ask(&finished, changed.nominal()).map_err(|error| failed(error, &self.study.campaign.dir))
    }

    /// R and lives of a changed scene at a confidence, with what the samples of its measured variables leave open.
    ///
    /// # Errors
    /// [`CommandError::Study`], or [`CommandError::BadInput`] without such a variable.
    pub fn confident(&self, changed: &SceneSource, confidence: f64) -> Done<ConfidentReliability> {
        let (dir, scene) = (&self.study.campaign.dir, changed.nominal());
        let learned = learn_from_results(scene, self.study.scene(), &self.settings, &self.outcomes()?)
            .map_err(|error| failed(error, dir))?;
        let model = LifeModel::new(scene, &learned);
        let fault = match uncertain_fits(&model, &changed.measured, scene) {
            Ok(fits) if !fits.is_empty() => {
                return Ok(fitted_reliability(scene, model, &fits, confidence, self.settings.seed));
            }
            Ok(_) => "no variable of the scene has measured samples (samples = [...]), so that no parameter is known from few values; \
                      `coordinator learn` takes what was observed of units"
                .to_owned(),
            Err(names) => format!(
                "measured variables that are correlated ({}) are not supported: what their samples leave open is not known alone",
                names.join(", ")
            ),
        };
        Err(CommandError::refused(dir.display(), format!("--confidence: {fault}")))
    }

    /// Opens the evaluator of the simulations to be added and starts its workers.
    ///
    /// # Errors
    /// [`CommandError`].
    pub fn evaluator(&self, farm: &FarmArguments, quiet: bool) -> Done<CommandEvaluator> {
        // Samples and accuracy determine what is simulated, so the workers receive the scene of the study.
        CommandEvaluator::started(&self.study.source, &self.settings, farm, quiet)
    }

    /// Adds at most `further` simulations where they reduce the error of R of a changed scene most; their number.
    ///
    /// # Errors
    /// [`CommandError`]; finished simulations are in the study by then.
    pub fn refine(
        &mut self,
        changed: &Scene,
        further: usize,
        evaluator: &mut CommandEvaluator,
        quiet: bool,
    ) -> Done<usize> {
        let stored = &self.outcomes()?;
        let correction = stored_correction(&self.study.campaign, self.study.scene())?;
        let StoredStudy { campaign, source, .. } = &mut self.study;
        let (studied, settings) = (source.nominal(), &self.settings);
        let correction = correction.as_ref();
        let learning = FurtherLearning { correction, changed, studied, settings, stored, further };
        let mut terminal = Terminal::new(quiet);
        let journal = &mut FurtherEvaluations(campaign);
        let learned = learning.learn(evaluator.evaluator(), journal, &mut terminal);
        terminal.finish();
        learned.map_err(|error| failed(error, &self.study.campaign.dir))?;
        Ok(self.outcomes()?.len() - stored.len())
    }

    /// The predictor of lives by all simulations that the study has.
    ///
    /// # Errors
    /// [`CommandError::BadInput`] without surrogates, or the error of the campaign file or the surrogates.
    pub fn life_model(&self) -> Done<LifeModel> {
        let StoredStudy { campaign, settings, .. } = &self.study;
        let (dir, scene) = (&campaign.dir, self.study.scene());
        if !settings.method.learns() {
            let fault = format!(
                "this study has no surrogates (method {}); the responses of units need a study with --method ak",
                settings.method.name()
            );
            return Err(CommandError::refused(dir.display(), fault));
        }
        // The surrogates are wanted, not the curves of the whole population.
        let settings = Settings { samples: settings.samples.min(SAMPLES), ..settings.clone() };
        let learned = learn_from_results(scene, scene, &settings, &self.outcomes()?)
            .map_err(|error| CommandError::of_study(error, dir))?;
        Ok(LifeModel::new(scene, &learned))
    }
}

/// The correction of a study's results by the pairs that its campaign file holds, if it has enough.
///
/// # Errors
/// [`StoreError`].
pub fn stored_correction(campaign: &CampaignFile, scene: &Scene) -> Result<Option<Correction>, StoreError> {
    let mut finer = Vec::new();
    campaign.for_each_known(true, |StoredEvaluation { level, sample, outcome, .. }| {
        finer.push((level, StoredOutcome { sample, outcome: outcome.map(Observed::from_evaluation) }));
    })?;
    if finer.is_empty() {
        return Ok(None);
    }
    Ok(Correction::from_stored(scene, &as_simulated(campaign)?, &finer))
}

/// Sample and outcome of every simulation at the working accuracy that a campaign file holds, corrected by its pairs.
///
/// # Errors
/// [`StoreError`].
pub fn known_outcomes(campaign: &CampaignFile, scene: &Scene) -> Result<Vec<StoredOutcome>, StoreError> {
    let outcomes = as_simulated(campaign)?;
    Ok(match stored_correction(campaign, scene)? {
        Some(correction) => correction.correct_all(outcomes),
        None => outcomes,
    })
}

/// Outcomes at the working accuracy as they were simulated, without correction.
fn as_simulated(campaign: &CampaignFile) -> Result<Vec<StoredOutcome>, StoreError> {
    let mut all = Vec::new();
    campaign.for_each_known(false, |StoredEvaluation { sample, outcome, .. }| {
        all.push(StoredOutcome { sample, outcome: outcome.map(Observed::from_evaluation) });
    })?;
    Ok(all)
}

/// The error of a question about the study in the folder `dir`.
pub fn failed(error: StudyError, dir: &Path) -> CommandError {
    match error {
        // An interruption leaves the finished simulations in the study: the same command goes on from them.
        StudyError::Evaluate(error) => CommandError::Evaluate(error),
        error => CommandError::Study { dir: dir.to_path_buf(), error },
    }
}
