//! When programs of remote workers end: at their time limit, with the run time of their worker, with a worker that is killed,
//! and without contact to the coordinator that holds their licences. The program of these tests hangs, together with a child
//! process.

use common::accuracy::Accuracy;
use common::external::SimulatorId;
use common::failure::SimulationFailure;
use common::scene::SceneSource;
use coordinator::farm::dispatch::{CampaignSimulator, CampaignSpec, Listen, ZenohEvaluator};
use coordinator::farm::evaluate::{EvaluateError, Evaluator, Finished, Request};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use tests::process::Process;
use tests::{Outcomes, PATIENCE, in_time, open_simulator, program, stop, within};

/// Replies with the number of the evaluation; the evaluation with the number in its argument hangs, or all of them. A process
/// that hangs notes its number and that of its child.
const SCRIPT: &str = r#"
while read -r line; do
    id=${line#*\"id\":}
    id=${id%%,*}
    if [ "$1" = "$id" ] || [ "$1" = all ]; then
        sleep 600 &
        echo "$$ $!" >>"$2"
        sleep 600
    fi
    echo "{\"id\": $id, \"outputs\": {\"y\": [$id]}}"
done
"#;

struct Study {
    folder: tempfile::TempDir,
}

impl Study {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("script.sh"), SCRIPT).unwrap();
        Self { folder }
    }

    /// The scene file of a machine whose program hangs at the evaluation `hangs`.
    fn file(&self, hangs: &str, timeout: &str) -> PathBuf {
        let file = self.folder.path().join(format!("{hangs}-{timeout}.toml"));
        let (script, notes) = (self.folder.path().join("script.sh"), self.notes());
        let text = format!(
            "scene = {{ name = \"limited\" }}\n\
             simulator = {{ program = [\"sh\", '{}', \"{hangs}\", '{}'], timeout = \"{timeout}\" }}\n\
             outputs = [{{ name = \"y\" }}]\n\
             limit_states = [{{ name = \"large\", output = \"y\", threshold = 1 }}]\n\
             variables = [{{ name = \"x\", mean = 1, std = 1 }}]\n",
            script.display(),
            notes.display()
        );
        std::fs::write(&file, text).unwrap();
        file
    }

    fn notes(&self) -> PathBuf {
        self.folder.path().join("notes")
    }

    /// Numbers of the processes that hang, at least `count` of them.
    fn hanging(&self, count: usize) -> Vec<String> {
        let started = Instant::now();
        loop {
            let notes = std::fs::read_to_string(self.notes()).unwrap_or_default();
            let numbers: Vec<String> = notes.split_whitespace().map(str::to_owned).collect();
            if numbers.len() >= count {
                return numbers;
            }
            assert!(started.elapsed() < PATIENCE, "{notes}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    fn coordinator(&self, licences: Option<u32>, interrupted: Arc<AtomicBool>) -> ZenohEvaluator {
        let source = SceneSource::load(&self.file("never", "60 s").display().to_string()).unwrap();
        let id = SimulatorId::of_scene(source.nominal()).unwrap();
        let campaign = CampaignSpec {
            id: 23,
            scene: source.text().to_owned(),
            accuracy: Accuracy::balanced(),
            build: None,
            shape: None,
            accuracy_name: "balanced".into(),
            simulator: Some(CampaignSimulator { id, timeout: 60.0, licences }),
            cross_check: None,
            resumed: false,
        };
        ZenohEvaluator::open(campaign, &Listen::default(), interrupted).unwrap()
    }

    fn worker(&self, endpoint: &str, name: &str, file: &Path, more: &[&str]) -> Process {
        let mut command = Command::new(program("worker"));
        command.args(["--connect", endpoint, "--slots", "2", "--name", name, "--quiet"]);
        command.arg("--simulator").arg(file).args(more).stderr(Stdio::null());
        Process::start(&mut command)
    }
}

fn requests(count: u64) -> Vec<Request> {
    let request = |id: u64| Request {
        id,
        sample: vec![id as f64],
        with_first_cycle: false,
        accuracy: None,
        level: 0,
        not_by: vec![],
    };
    (0..count).map(request).collect()
}

/// Outcomes of evaluations, and the workers that returned them.
fn evaluate(evaluator: &mut dyn Evaluator, count: u64) -> Result<(Outcomes, Vec<String>), EvaluateError> {
    let (mut outcomes, mut workers) = (Outcomes::new(), vec![]);
    evaluator.evaluate(&requests(count), &mut |Finished { id, outcome, worker, .. }| {
        assert!(outcomes.insert(id, outcome).is_none(), "evaluation {id} was recorded twice");
        workers.push(worker.split('/').next().unwrap_or_default().to_owned());
        Ok(())
    })?;
    workers.sort();
    workers.dedup();
    Ok((outcomes, workers))
}

/// True if a process runs; a zombie, which its parent has not reaped yet, does not. The state follows the name in parentheses. (The
/// command line of a process is empty for a moment whenever it executes another program.)
fn runs(number: &String) -> bool {
    std::fs::read_to_string(Path::new("/proc").join(number).join("stat"))
        .is_ok_and(|stat| stat.rsplit_once(") ").is_some_and(|(_, state)| !state.starts_with(['Z', 'X'])))
}

#[track_caller]
fn assert_end_within(limit: Duration, processes: &[String]) {
    let started = Instant::now();
    while processes.iter().any(runs) {
        assert!(started.elapsed() < limit, "of {processes:?} some run after {limit:?}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_program_that_hangs_is_a_failed_evaluation_as_on_one_machine() {
    in_time(|| {
        let study = Study::new();
        let file = study.file("3", "1 s");
        let mut coordinator = study.coordinator(None, Arc::default());
        let _worker = study.worker(&coordinator.endpoints[0], "w", &file, &[]);
        let (remote, _) = evaluate(&mut coordinator, 8).unwrap();
        // One attempt, whose whole process group has ended while the worker goes on.
        let hung = study.hanging(2);
        assert_eq!(hung.len(), 2);
        assert_end_within(Duration::from_secs(1), &hung);
        assert_eq!(remote[&3], Err(SimulationFailure::TimedOut { seconds: 1.0 }));
        assert_eq!(remote.values().filter(|outcome| outcome.is_ok()).count(), 7);

        let source = SceneSource::load(&file.display().to_string()).unwrap();
        let scene = source.nominal();
        let mut local = open_simulator(scene, 2).unwrap();
        assert_eq!(evaluate(&mut *local, 8).unwrap().0, remote);
    });
}

#[test]
fn a_worker_whose_run_time_ends_returns_its_evaluations_and_ends_its_programs() {
    in_time(|| {
        let study = Study::new();
        // With licences no evaluation goes to a second worker before.
        let mut coordinator = study.coordinator(Some(9), Arc::default());
        let mut short = study.worker(
            &coordinator.endpoints[0],
            "short",
            &study.file("all", "60 s"),
            &["--walltime", "5"],
        );
        let (outcomes, workers) = std::thread::scope(|scope| {
            let endpoint = coordinator.endpoints[0].clone();
            let evaluated = scope.spawn(|| evaluate(&mut coordinator, 8).unwrap());
            let hung = study.hanging(4);
            assert!(hung.iter().all(runs), "{hung:?}");
            assert!(short.end(PATIENCE).success());
            assert_end_within(Duration::from_secs(1), &hung);
            let _long = study.worker(&endpoint, "long", &study.file("never", "60 s"), &[]);
            evaluated.join().unwrap()
        });
        assert_eq!((outcomes.len(), outcomes.values().filter(|outcome| outcome.is_ok()).count()), (8, 8));
        assert_eq!(workers, ["long"]);
    });
}

#[test]
fn the_programs_of_a_killed_worker_end_with_it() {
    in_time(|| {
        let study = Study::new();
        let interrupted = Arc::new(AtomicBool::new(false));
        let mut coordinator = study.coordinator(None, Arc::clone(&interrupted));
        let mut worker = study.worker(&coordinator.endpoints[0], "w", &study.file("all", "60 s"), &[]);
        let evaluated = std::thread::spawn(move || evaluate(&mut coordinator, 2));
        let hung = study.hanging(4);
        assert!(hung.iter().all(runs), "{hung:?}");
        worker.kill();
        assert_end_within(Duration::from_secs(1), &hung);
        stop(&interrupted);
        assert!(matches!(evaluated.join().unwrap(), Err(EvaluateError::Interrupted)));
    });
}

#[test]
fn programs_under_licences_end_while_their_worker_is_stopped() {
    within(2 * PATIENCE, || {
        let study = Study::new();
        let mut coordinator = study.coordinator(Some(2), Arc::default());
        let endpoint = coordinator.endpoints[0].clone();
        let stopped = study.worker(&endpoint, "stopped", &study.file("1", "60 s"), &[]);
        let (outcomes, workers, other) = std::thread::scope(|scope| {
            let evaluated = scope.spawn(|| evaluate(&mut coordinator, 2).unwrap());
            let hung = study.hanging(2);
            stopped.signal("STOP");
            let at = Instant::now();
            let other = study.worker(&endpoint, "other", &study.file("never", "60 s"), &[]);
            // The coordinator gives the licence to the other worker later.
            assert_end_within(common::wire::LICENCE_CONTACT + Duration::from_secs(1), &hung);
            assert!(at.elapsed() > common::wire::LICENCE_CONTACT / 2, "not at once");
            let (outcomes, workers) = evaluated.join().unwrap();
            (outcomes, workers, other)
        });
        assert_eq!((outcomes.len(), outcomes.values().filter(|outcome| outcome.is_ok()).count()), (2, 2));
        assert!(workers.contains(&"other".to_owned()), "{workers:?}");
        // What was ended is no report of an unusable program: the worker goes on with other evaluations.
        stopped.signal("CONT");
        drop(other);
        let (outcomes, workers) = evaluate(&mut coordinator, 1).unwrap();
        assert_eq!((outcomes[&0].is_ok(), workers), (true, vec!["stopped".to_owned()]));
    });
}

#[test]
fn programs_under_licences_end_without_contact_and_not_at_once() {
    within(2 * PATIENCE, || {
        let study = Study::new();
        let interrupted = Arc::new(AtomicBool::new(false));
        let mut coordinator = study.coordinator(Some(2), Arc::clone(&interrupted));
        let worker = study.worker(
            &coordinator.endpoints[0],
            "w",
            &study.file("all", "60 s"),
            &["--give-up-after", "0"],
        );
        let evaluated = std::thread::spawn(move || {
            let ended = evaluate(&mut coordinator, 2);
            // As if it were killed: without notice.
            drop(coordinator);
            ended.map(drop)
        });
        let hung = study.hanging(4);
        stop(&interrupted);
        assert!(matches!(evaluated.join().unwrap(), Err(EvaluateError::Interrupted)));
        std::thread::sleep(common::wire::LICENCE_CONTACT / 2);
        assert!(hung.iter().all(runs), "a coordinator that is back soon finds its evaluations");
        assert_end_within(common::wire::LICENCE_CONTACT / 2 + Duration::from_secs(1), &hung);
        drop(worker);
    });
}
