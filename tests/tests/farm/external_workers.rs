//! A user's own program on worker processes that have it themselves: losses, licences, and coordinators that ask for
//! something else. The measured study of full size: `cargo run --release -p tests --example external_workers`.

use common::accuracy::Accuracy;
use common::external::SimulatorId;
use common::failure::SimulationFailure;
use common::wire::{self, Claim, Next, Outcome, Reply, Subject, Task, TaskKey, WorkOrder, keys};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Condvar, Mutex};
use tests::beam_study::BeamStudy;
use tests::process::Process;
use tests::{PATIENCE, foreign_session, in_time};
use zenoh::query::Query;
use zenoh::{Session, Wait};

#[test]
fn losses_and_workers_without_the_program_change_no_bit() {
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let report = BeamStudy::new(folder.path(), 0.05).with_losses(60, 0.05);
        assert!(report.same_bits, "{report:?}");
        let names: Vec<&str> = report.by_worker.keys().map(String::as_str).collect();
        assert_eq!(names, ["doomed", "first", "second"], "{report:?}");
        assert_eq!(report.by_worker.values().sum::<usize>(), 60);
    });
}

#[test]
fn no_more_programs_run_than_there_are_licences() {
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let study = BeamStudy::new(folder.path(), 0.05);
        let report = study.with_licences(40, 0.05);
        assert!(report.same_bits, "{report:?}");
        // As the program itself notes; all licences are used.
        assert_eq!(report.most_at_once, 3, "{report:?}");
        assert_eq!(study.noted(), (40, 40));
    });
}

/// A listener that answers claims like a coordinator, with these orders, one a reply.
struct Hostile {
    session: Session,
    state: Arc<(Mutex<State>, Condvar)>,
}

#[derive(Default)]
struct State {
    orders: Vec<(Subject, Vec<f64>)>,
    given: usize,
    outcomes: BTreeMap<u64, Outcome>,
}

impl Hostile {
    fn listen(orders: Vec<(Subject, Vec<f64>)>) -> (Self, String) {
        let session = foreign_session("listen/endpoints", "tcp/127.0.0.1:0");
        let endpoint = session.info().locators().wait()[0].to_string();
        let state = Arc::new((Mutex::new(State { orders, ..State::default() }), Condvar::new()));
        (Self { session, state }, endpoint)
    }

    /// The results of all orders.
    fn results(&self) -> Vec<Result<Vec<f64>, SimulationFailure>> {
        let state = Arc::clone(&self.state);
        let _claims = self
            .session
            .declare_queryable(keys::CLAIM)
            .complete(true)
            .callback(move |query| answer(&query, &state))
            .wait()
            .unwrap();
        let (state, changed) = &*self.state;
        let missing = |state: &mut State| state.outcomes.len() < state.orders.len();
        let (mut state, waited) =
            changed.wait_timeout_while(state.lock().unwrap(), PATIENCE, missing).unwrap();
        assert!(!waited.timed_out(), "only {:?}", state.outcomes);
        let outcomes = std::mem::take(&mut state.outcomes).into_values();
        outcomes.map(|outcome| outcome.result.map(|evaluation| evaluation.histories[0].clone())).collect()
    }
}

fn answer(query: &Query, (state, changed): &(Mutex<State>, Condvar)) {
    let claim: Claim = wire::decode(&query.payload().unwrap().to_bytes()).unwrap();
    let mut state = state.lock().unwrap();
    let acknowledged = claim.finished.iter().map(|outcome| outcome.task.key).collect();
    state.outcomes.extend(claim.finished.into_iter().map(|outcome| (outcome.task.key.task, outcome)));
    changed.notify_all();
    let next = match state.orders.get(state.given).cloned() {
        Some((subject, sample)) if claim.credits > 0 => {
            let key = TaskKey { campaign: 1, task: state.given as u64 };
            state.given += 1;
            let task = Task { key, attempt: 1, sample, with_first_cycle: false, accuracy: None, level: 0 };
            let (accuracy, accuracy_name) = (Accuracy::draft(), "draft".to_owned());
            Next::Work(WorkOrder { subject, accuracy, accuracy_name, licensed: false, tasks: vec![task] })
        }
        _ => Next::Idle { ask_again: 20 },
    };
    let frame = wire::encode(&Reply { acknowledged, next }).unwrap();
    query.reply(keys::CLAIM, frame).wait().unwrap();
}

/// A scene that would leave a file in `folder` if its program ran.
fn evil_scene(folder: &Path) -> String {
    format!(
        "scene = {{ name = \"beam\" }}\nsimulator = {{ program = [\"touch\", \"{}\"] }}\n\
         outputs = [{{ name = \"deflection\" }}]\n\
         limit_states = [{{ name = \"bent\", output = \"deflection\", threshold = 1 }}]\n\
         variables = [{{ name = \"x\", mean = 1, std = 1 }}]\n",
        folder.join("evil").display()
    )
}

#[test]
fn a_hostile_coordinator_runs_nothing_but_the_offered_program() {
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let study = BeamStudy::new(folder.path(), 0.0);
        let id = study.id();
        let sample = study.requests(1).remove(0).sample;
        let other = |scene: &str| Subject::Simulator(SimulatorId { scene: scene.into(), ..id.clone() });
        let command = format!("beam; touch {}", folder.path().join("evil").display());
        let mut orders = vec![
            (Subject::Scene(evil_scene(folder.path())), vec![1.0]),
            (Subject::Scene(String::new()), vec![]),
            (other("newer"), sample.clone()),
            (other("../newer.toml"), sample.clone()),
            (other(&folder.path().join("newer.toml").display().to_string()), sample.clone()),
            (other(&command), sample.clone()),
            (Subject::Simulator(SimulatorId { digest: id.digest ^ 1, ..id.clone() }), sample.clone()),
            (Subject::Simulator(id.clone()), sample[1..].to_vec()),
            (Subject::Simulator(id.clone()), [sample.clone(), vec![1.0]].concat()),
        ];
        let refused = orders.len();
        orders.push((Subject::Simulator(id), sample));
        let (coordinator, endpoint) = Hostile::listen(orders);
        let before = files(folder.path());
        let _worker = Process::start(&mut study.worker(&endpoint, "careful", &["--simulator", "beam.toml"]));
        let results = coordinator.results();
        for (number, result) in results[..refused].iter().enumerate() {
            let unusable = matches!(result, Err(SimulationFailure::SimulatorUnusable { .. }));
            assert!(unusable, "order {number}: {result:?}");
        }
        let expected = study.expected(&study.requests(1)).unwrap().remove(&0).unwrap().unwrap();
        assert_eq!(results[refused], Ok(expected.histories[0].clone()));
        // The program ran once, in its folder, where it leaves its log and nothing else is new.
        assert_eq!(study.noted(), (1, 1));
        let new: Vec<String> =
            files(folder.path()).into_iter().filter(|name| !before.contains(name)).collect();
        assert_eq!(new, ["log"]);
    });
}

#[test]
fn a_worker_for_mechanisms_runs_no_program() {
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let study = BeamStudy::new(folder.path(), 0.0);
        let orders = vec![
            (Subject::Scene(evil_scene(folder.path())), vec![1.0]),
            (Subject::Simulator(study.id()), study.requests(1).remove(0).sample),
        ];
        let (coordinator, endpoint) = Hostile::listen(orders);
        let before = files(folder.path());
        let _worker = Process::start(&mut study.worker(&endpoint, "plain", &[]));
        let results = coordinator.results();
        assert!(matches!(results[0], Err(SimulationFailure::NotModelled { .. })), "{results:?}");
        assert!(matches!(results[1], Err(SimulationFailure::SimulatorUnusable { .. })), "{results:?}");
        assert_eq!(files(folder.path()), before);
    });
}

fn files(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
