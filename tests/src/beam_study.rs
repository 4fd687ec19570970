//! Studies of the program `beam` on worker processes that have it themselves, with losses and with licences.

use crate::process::Process;
use crate::{Outcomes, open_simulator, program};
use common::accuracy::Accuracy;
use common::evaluation_shape::EvaluationShape;
use common::external::SimulatorId;
use common::scene::SceneSource;
use coordinator::farm::dispatch::{CampaignSimulator, CampaignSpec, Listen, ZenohEvaluator};
use coordinator::farm::evaluate::{EvaluateError, Evaluator, Finished, Request};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Time limit of every wait.
const LONGEST: Duration = Duration::from_secs(120);
/// Slots of each worker.
const SLOTS: u32 = 2;

/// The scene in a file, with its program.
pub struct BeamStudy {
    folder: PathBuf,
    source: SceneSource,
}

/// Result of a batch.
#[derive(Debug)]
pub struct BeamReport {
    /// Whether the outcomes are those of the program without messages, bit for bit.
    pub same_bits: bool,
    /// Evaluations by each worker.
    pub by_worker: BTreeMap<String, usize>,
    /// Wall time [s].
    pub took: f64,
    /// Time that workers without any pause between evaluations would take [s].
    pub ideal: f64,
    /// Most evaluations at once, as the program itself noted.
    pub most_at_once: usize,
}

impl BeamReport {
    /// The share of the ideal, e.g. `17.4 s, 97.1 % of the ideal`.
    pub fn share(&self) -> f64 {
        self.ideal / self.took
    }
}

impl BeamStudy {
    /// A study in `folder` whose evaluations sleep for `seconds`.
    pub fn new(folder: &Path, seconds: f64) -> Self {
        let file = folder.join("beam.toml");
        std::fs::write(&file, beam_scene(folder, seconds, "1")).expect("there is room for a file");
        std::fs::write(folder.join("newer.toml"), beam_scene(folder, seconds, "2")).expect("and another one");
        let source = SceneSource::load(&file.display().to_string()).expect("the scene is valid");
        Self { folder: folder.to_owned(), source }
    }

    /// What coordinator and workers agree by.
    pub fn id(&self) -> SimulatorId {
        SimulatorId::of_scene(self.source.nominal()).expect("the scene names its simulator")
    }

    /// A coordinator for the study.
    pub fn coordinator(&self, licences: Option<u32>) -> ZenohEvaluator {
        let campaign = CampaignSpec {
            id: 22,
            scene: self.source.text().to_owned(),
            accuracy: Accuracy::balanced(),
            accuracy_name: "balanced".into(),
            build: Some(worker::BUILD),
            shape: Some(EvaluationShape::of(self.source.nominal())),
            simulator: Some(CampaignSimulator { id: self.id(), timeout: 60.0, licences }),
            cross_check: None,
            resumed: false,
        };
        ZenohEvaluator::open(campaign, &Listen::default(), Arc::default()).expect("loopback")
    }

    /// The command of a worker process with two slots and these arguments.
    pub fn worker(&self, endpoint: &str, name: &str, more: &[&str]) -> Command {
        let mut command = Command::new(program("worker"));
        command.args(["--connect", endpoint, "--slots", &SLOTS.to_string(), "--name", name, "--quiet"]);
        command.args(more).current_dir(&self.folder).stderr(Stdio::null());
        command
    }

    /// Evaluations `0..count`, each of another sample.
    pub fn requests(&self, count: u64) -> Vec<Request> {
        let request = |id: u64| {
            let scale = |k: usize| 1.0 + 1e-3 * ((id * (k as u64 + 7)) % 101) as f64;
            let sample = self.source.means().iter().enumerate().map(|(k, mean)| mean * scale(k)).collect();
            Request { id, sample, with_first_cycle: false, accuracy: None, level: 0, not_by: vec![] }
        };
        (0..count).map(request).collect()
    }

    /// The outcomes of the program without sleep and without messages.
    ///
    /// # Errors
    /// Errors of the evaluator.
    pub fn expected(&self, batch: &[Request]) -> Result<Outcomes, EvaluateError> {
        let folder = tempfile::tempdir().expect("there is room for a folder");
        let quick = Self::new(folder.path(), 0.0);
        let local = open_simulator(quick.source.nominal(), 1);
        let mut local = local.map_err(|error| EvaluateError::Slot(error.into()))?;
        let mut outcomes = Outcomes::new();
        local.evaluate(batch, &mut |Finished { id, outcome, .. }| {
            outcomes.insert(id, outcome);
            Ok(())
        })?;
        Ok(outcomes)
    }

    /// Evaluates `count` samples of `seconds` on four workers: one has no program, one another version, two work; a fifth
    /// works too, and is killed in the midst of evaluations when a fifth of them has ended.
    pub fn with_losses(&self, count: u64, seconds: f64) -> BeamReport {
        let mut coordinator = self.coordinator(None);
        let endpoint = coordinator.endpoints[0].clone();
        let start = |name: &str, more: &[&str]| Process::start(&mut self.worker(&endpoint, name, more));
        let own = ["--simulator", "beam.toml"];
        let _others =
            [start("plain", &[]), start("newer", &["--simulator", "newer.toml"]), start("first", &own)];
        let (_second, mut doomed) = (start("second", &own), start("doomed", &own));
        // Workers that get no tasks are listed without slots.
        let here = coordinator.connected.wait_for(LONGEST, |all| {
            all.len() == 5 && all.iter().filter(|worker| worker.slots == SLOTS).count() == 3
        });
        assert!(here, "{:?}", coordinator.workers());
        let mut killed = None;
        let report = self.evaluated(&mut coordinator, count, |ended, since| {
            if killed.is_none() && ended as u64 > count / 5 {
                killed = Some(since.elapsed().as_secs_f64());
                doomed.kill();
            }
        });
        let (work, killed) = (count as f64 * seconds, killed.expect("it was killed"));
        let [all, left] = [3.0, 2.0].map(|workers| workers * f64::from(SLOTS));
        coordinator.finish();
        BeamReport { ideal: killed + (work - all * killed) / left, ..report }
    }

    /// Evaluates `count` samples of `seconds` on four workers with three licences.
    pub fn with_licences(&self, count: u64, seconds: f64) -> BeamReport {
        const LICENCES: u32 = 3;
        let mut coordinator = self.coordinator(Some(LICENCES));
        let endpoint = coordinator.endpoints[0].clone();
        let own = ["--simulator", "beam.toml"];
        let _workers =
            ["a", "b", "c", "d"].map(|name| Process::start(&mut self.worker(&endpoint, name, &own)));
        let here = coordinator
            .connected
            .wait_for(LONGEST, |all| all.len() == 4 && all.iter().all(|worker| worker.slots == SLOTS));
        assert!(here, "{:?}", coordinator.workers());
        assert_eq!(coordinator.concurrency(), LICENCES);
        let report = self.evaluated(&mut coordinator, count, |_, _| {});
        coordinator.finish();
        BeamReport { ideal: count as f64 * seconds / f64::from(LICENCES), ..report }
    }

    /// Runs a batch; calls `watch` with the number of ended evaluations and the begin after each.
    fn evaluated(
        &self,
        coordinator: &mut ZenohEvaluator,
        count: u64,
        mut watch: impl FnMut(usize, Instant),
    ) -> BeamReport {
        let batch = self.requests(count);
        let expected = self.expected(&batch).expect("the program runs here");
        let (mut outcomes, mut by_worker) = (Outcomes::new(), BTreeMap::<String, usize>::new());
        let begun = Instant::now();
        coordinator
            .evaluate(&batch, &mut |Finished { id, outcome, worker, .. }| {
                assert!(outcomes.insert(id, outcome).is_none(), "evaluation {id} was recorded twice");
                let name = worker.split('/').next().unwrap_or_default().to_owned();
                *by_worker.entry(name).or_default() += 1;
                watch(outcomes.len(), begun);
                Ok(())
            })
            .expect("the batch ends");
        let took = begun.elapsed().as_secs_f64();
        let same_bits = same_bits(&outcomes, &expected);
        BeamReport { same_bits, by_worker, took, ideal: took, most_at_once: self.most_at_once() }
    }

    /// Numbers of evaluations that the program noted as begun and as ended.
    pub fn noted(&self) -> (usize, usize) {
        let log = std::fs::read_to_string(self.folder.join("log")).unwrap_or_default();
        let count = |what: &str| log.lines().filter(|line| line.starts_with(what)).count();
        (count("begin"), count("end"))
    }

    /// Most evaluations at once, by the notes of the program.
    fn most_at_once(&self) -> usize {
        let log = std::fs::read_to_string(self.folder.join("log")).expect("the program writes its notes");
        let mut steps: Vec<(f64, i32)> = log
            .lines()
            .map(|line| {
                let (what, time) = line.split_once(' ').expect("two words");
                (time.parse().expect("a time"), if what == "begin" { 1 } else { -1 })
            })
            .collect();
        // At the same time, an end comes first.
        steps.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let (mut now, mut most) = (0, 0);
        for (_, step) in steps {
            now += step;
            most = most.max(now);
        }
        usize::try_from(most).expect("an evaluation begins before it ends")
    }
}

/// The scene of the program `beam` with its log in `folder`.
pub fn beam_scene(folder: &Path, seconds: f64, version: &str) -> String {
    let (beam, log) = (program("beam"), folder.join("log"));
    let variable = |name: &str, mean: &str| {
        format!("[[variables]]\nname = \"{name}\"\nmean = \"{mean}\"\nstd = \"5 %\"\n")
    };
    let variables = [("load", "500 N"), ("width", "20 mm"), ("height", "40 mm"), ("modulus", "206 GPa")]
        .map(|(name, mean)| variable(name, mean))
        .concat();
    format!(
        "[scene]\nname = \"beam\"\n[simulator]\nprogram = ['{}', '{seconds}', '{}']\ntimeout = \"1 min\"\n\
         version = \"{version}\"\n[life]\ncycles = 50\ncheckpoint_every = 5\n\
         [[outputs]]\nname = \"deflection\"\nunit = \"mm\"\n\
         [[limit_states]]\nname = \"bent\"\noutput = \"deflection\"\nthreshold = 10\n{variables}\
         [[variables]]\nname = \"corrosion\"\nmean = 2e-5\nstd = \"20 %\"\n",
        beam.display(),
        log.display()
    )
}

/// True if both have the same evaluations with the same bits.
fn same_bits(a: &Outcomes, b: &Outcomes) -> bool {
    let bits = |outcomes: &Outcomes| -> BTreeSet<(u64, Vec<u64>)> {
        outcomes
            .iter()
            .filter_map(|(id, outcome)| {
                let values = outcome.as_ref().ok()?.histories.iter().flatten();
                Some((*id, values.map(|value| value.to_bits()).collect()))
            })
            .collect()
    };
    a.len() == b.len() && bits(a).len() == a.len() && bits(a) == bits(b)
}
