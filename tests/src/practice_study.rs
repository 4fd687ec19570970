//! A complete study whose simulations are a formula: learning, campaign file, messages and processes are those of every
//! study, and their cost is not hidden by the simulations.

use common::evaluation_shape::EvaluationShape;
use common::failure::SimulationFailure;
use common::outputs::{Diagnostics, Evaluation};
use common::scene::{Scene, SceneSource};
use coordinator::farm::dispatch::CampaignSpec;
use coordinator::farm::evaluate::Evaluator;
use coordinator::farm::evaluate::local::LocalEvaluator;
use coordinator::results::journal::Journal;
use coordinator::results::progress::Silent;
use coordinator::results::store::{CampaignFile, CampaignMeta, FILE_NAME};
use coordinator::study::{self, FinerLevels, Method, Settings, StudyError};
use rusqlite::{Connection, OpenFlags};
use serde_json::Value;
use std::path::Path;

/// Means of the variables of the built-in scene `four-bar`, SI.
const MEANS: [f64; 4] = [1e-13, -0.8, 30e-6, 0.05];

/// An evaluation with the shape of the scene `four-bar` that depends on every bit of the sample: wear that grows with all
/// variables and reaches the limit of 8 um near the end of the life of 8000 cycles.
///
/// # Errors
/// Never.
pub fn evaluation(sample: &[f64]) -> Result<Evaluation, SimulationFailure> {
    let cycles: Vec<u32> = (1..=8).map(|k| 1000 * k).collect();
    let relative: f64 = sample.iter().zip(MEANS).map(|(x, mean)| x / mean).product();
    let wear = cycles.iter().map(|n| 8.2e-6 * relative * (f64::from(*n) / 8000.0).powf(0.8)).collect();
    let speed = cycles.iter().map(|n| 10.0 + relative * f64::from(*n) / 8000.0).collect();
    Ok(Evaluation {
        errors: vec![vec![0.0; cycles.len()]; 2],
        histories: vec![wear, speed],
        cycles,
        joints: vec![],
        first_cycle: None,
        worn: None,
        start: vec![],
        diagnostics: Diagnostics::default(),
    })
}

/// A text that identifies a sample of a study.
pub fn mark(sample: &[f64]) -> String {
    format!("{:016x}", sample[0].to_bits())
}

/// The scene `four-bar` with settings of a study.
pub struct PracticeStudy {
    source: SceneSource,
    scene: Scene,
    settings: Settings,
}

impl PracticeStudy {
    /// A study by direct simulation of `samples` samples and the nominal one.
    pub fn monte_carlo(samples: usize) -> Self {
        let source = SceneSource::builtin("four-bar").expect("it is built in");
        let scene = source.nominal().clone();
        let settings = Settings::from(&scene);
        // One level: the evaluations are counted.
        let levels = FinerLevels::None;
        let settings = Settings { method: Method::MonteCarlo, samples, levels, ..settings };
        Self { source, scene, settings }
    }

    /// A study by active learning: an initial design, then rounds up to `evaluations` evaluations.
    pub fn learning(initial: usize, evaluations: usize) -> Self {
        let mut study = Self::monte_carlo(1);
        study.settings.method = Method::ActiveLearning;
        let settings = &mut study.settings;
        (settings.samples, settings.initial, settings.max_evaluations) = (2000, initial, evaluations);
        study
    }

    /// The sample of the nominal mechanism.
    pub fn means(&self) -> Vec<f64> {
        self.source.means()
    }

    /// The campaign as sent to its workers.
    pub fn campaign(&self, resumed: bool) -> CampaignSpec {
        let accuracy = self.settings.accuracy.setting.accuracy;
        CampaignSpec {
            id: 4711,
            scene: self.source.text().to_owned(),
            accuracy,
            accuracy_name: "balanced".into(),
            build: Some(worker::BUILD),
            shape: Some(EvaluationShape::of(&self.scene)),
            simulator: None,
            cross_check: None,
            resumed,
        }
    }

    /// The campaign file in `dir`, and whether it existed already.
    pub fn journal(
        &self,
        dir: &Path,
    ) -> Result<(CampaignFile, bool), coordinator::results::store::StoreError> {
        if dir.join(FILE_NAME).exists() {
            return Ok((CampaignFile::open(dir)?, true));
        }
        let meta = CampaignMeta {
            scene: self.scene.name.clone(),
            scene_source: self.source.text().to_owned(),
            settings: Value::Null,
            command: "practice".into(),
            version: env!("CARGO_PKG_VERSION").into(),
        };
        Ok((CampaignFile::create(dir, &meta, &self.scene)?, false))
    }

    /// Runs the study. Returns the summary as text, without times and workers, which may differ; and the names of the workers.
    ///
    /// # Errors
    /// Errors of the study.
    pub fn run(
        &self,
        evaluator: &mut dyn Evaluator,
        journal: &mut dyn Journal,
    ) -> Result<(String, Vec<String>), StudyError> {
        let result = study::run(&self.scene, &self.settings, evaluator, journal, &mut Silent)?;
        let workers = result.summary.workers.iter().map(|share| share.name.clone()).collect();
        let mut answer = serde_json::to_value(&result.summary).expect("a summary is JSON");
        let all = answer.as_object_mut().expect("a summary is an object");
        assert!(all.remove("timing_s").is_some() && all.remove("workers").is_some());
        Ok((answer.to_string(), workers))
    }

    /// The answer of the study on one thread, without messages.
    pub fn alone(&self) -> String {
        let folder = tempfile::tempdir().expect("there is room for a folder");
        let (mut journal, _) = self.journal(folder.path()).expect("an empty folder takes a campaign");
        let mut evaluator = LocalEvaluator::new(1, |request| evaluation(&request.sample));
        self.run(&mut evaluator, &mut journal).expect("the study ends").0
    }
}

/// The evaluations in the campaign file of `dir`: number, mark of the sample, and time of recording. Empty without a file.
pub fn recorded(dir: &Path) -> Vec<(i64, String, String)> {
    let read = || -> rusqlite::Result<Vec<_>> {
        let file = file(dir)?;
        let mut rows = file.prepare(
            "SELECT e.id, i.wear_coefficient, e.finished_at
             FROM evaluation AS e JOIN input AS i ON i.evaluation = e.id ORDER BY e.id",
        )?;
        let rows = rows.query_map([], |row| Ok((row.get(0)?, mark(&[row.get(1)?]), row.get(2)?)))?;
        rows.collect()
    };
    read().unwrap_or_default()
}

/// Number of evaluations in the campaign file of `dir`; zero without a file.
pub fn count_recorded(dir: &Path) -> usize {
    let count = || -> rusqlite::Result<i64> {
        file(dir)?.query_row("SELECT count(*) FROM evaluation", [], |row| row.get(0))
    };
    count().ok().and_then(|count| usize::try_from(count).ok()).unwrap_or(0)
}

fn file(dir: &Path) -> rusqlite::Result<Connection> {
    let file = Connection::open_with_flags(dir.join(FILE_NAME), OpenFlags::SQLITE_OPEN_READ_ONLY)?;
    file.busy_timeout(crate::PATIENCE)?;
    Ok(file)
}
