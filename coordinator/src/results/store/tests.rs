use super::*;
use crate::farm::evaluate::{EvaluateError, Finished, Request};
use crate::results::journal::Journal;
use crate::results::summary::Round;
use common::accuracy::NamedAccuracy;
use common::failure::SimulationFailure;
use common::outputs::{BodyTrace, CycleHistory, Diagnostics, Evaluation, JointSummary, WornLife};
use common::random::{Distribution, RandomVariable};
use common::scene::{Fails, Life, LimitState, Output, OutputKind, StudySettings, WearModel};
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

pub(super) fn scene() -> Scene {
    let variable = |name: &str| RandomVariable {
        name: name.into(),
        distribution: Distribution::truncated_normal(1.0, 0.1, 0.7, 1.3).unwrap(),
        changes: vec![],
        unit: "mm".into(),
    };
    let limit = LimitState { name: "wear".into(), output: 0, threshold: 3e-5, fails: Fails::Above };
    Scene {
        name: "two".into(),
        title: "Two variables".into(),
        bodies: vec![],
        joints: vec![],
        loads: vec![],
        gravity: [0.0; 2],
        outputs: vec![Output {
            name: "max_wear_depth".into(),
            kind: OutputKind::LargestWear { joints: vec![] },
        }],
        variables: vec![variable("k"), variable("K")],
        correlations: vec![],
        limit_states: vec![limit],
        units: common::scene::Units::default(),
        control_points_of_model: false,
        wear: WearModel::default(),
        life: Life { period: 0.125, cycles: 2000, checkpoint_every: 1000, settle_cycles: 1, turn_of: None },
        conditions: vec![],
        study: StudySettings { population: 100, initial: 10, batch: 4, max_evaluations: 20, seed: 1 },
        accuracy: NamedAccuracy::default(),
        levels: vec![],
        simulator: None,
    }
}

pub(super) fn meta() -> CampaignMeta {
    CampaignMeta {
        scene: "two".into(),
        scene_source: "[scene]\nname = \"two\" # µ\n".into(),
        settings: serde_json::json!({"seed": 1, "method": "ak"}),
        command: "coordinator run --scene two".into(),
        version: "0.1.0".into(),
    }
}

/// Values that decimal text, SQL's REAL or 32 bits would bend.
fn awkward(id: u64) -> Vec<f64> {
    let values = [-0.0, 0.1 + 0.2, f64::MIN_POSITIVE / 8.0, 1.0 / 3.0, f64::MAX, 2.0, 1e-308, 0.1f32.into()];
    vec![values[id as usize % values.len()], 0.1 * id as f64]
}

pub(super) fn request(id: u64) -> Request {
    Request { id, sample: awkward(id), with_first_cycle: id == 0, accuracy: None, level: 0, not_by: vec![] }
}

pub(super) fn finished(id: u64) -> Finished {
    let x = awkward(id);
    let first_cycle = (id == 0).then(|| CycleHistory {
        time: vec![0.0, 1.0 / 3.0],
        bodies: vec![BodyTrace { label: "right".into(), angle: x.clone(), speed: vec![-0.0, 0.7] }],
        joint_force: vec![("1".into(), vec![0.1, 0.2])],
        ..CycleHistory::default()
    });
    let worn = first_cycle.clone().map(|cycle| WornLife {
        cycles: vec![0, 1000],
        wear_depth: vec![vec![x.clone()], vec![vec![0.1 + 0.2]]],
        last_cycle: Some(cycle),
    });
    let (name, wear_depth) = ("1".into(), x.clone());
    let bore = JointSummary { name, peak_force: 0.1 + 0.2, journal_wear_depth: x.clone(), wear_depth };
    let evaluation = Evaluation {
        worn,
        cycles: vec![1000, 2000],
        histories: vec![x.clone()],
        errors: vec![x.iter().map(|value| value.abs() / 7.0).collect()],
        start: vec![Some(0.1 / 3.0)],
        joints: if id == 0 { vec![bore] } else { vec![] },
        first_cycle,
        diagnostics: Diagnostics {
            steps: u64::MAX,
            free_flight_fraction: vec![("1".into(), 1.0 / 7.0)],
            ..Diagnostics::default()
        },
    };
    let failure =
        SimulationFailure::StepTooSmall { cycle: 7, time: 0.1, joint: None, step: 1e-12, error: f64::NAN };
    let outcome = if id % 5 == 3 { Err(failure) } else { Ok(evaluation) };
    Finished { id, outcome, worker: format!("host/{id}"), wall: 0.1 + id as f64 / 3.0 }
}

pub(super) fn record(file: &mut CampaignFile, ids: impl Iterator<Item = u64>) {
    ids.for_each(|id| file.record(&request(id), &finished(id)).unwrap());
}

/// Equal to the last bit, NaN and the sign of zero included.
fn assert_same_bits(left: &Finished, right: &Finished) {
    let bytes = |finished: &Finished| exact::outcome_to_bytes(&finished.outcome).unwrap();
    assert_eq!(bytes(left), bytes(right));
    assert_eq!(format!("{left:?}"), format!("{right:?}"));
}

#[test]
fn evaluations_come_back_to_the_last_bit() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    record(&mut file, 0..10);
    drop(file);
    let mut file = CampaignFile::open(dir.path()).unwrap();
    for id in 0..10 {
        assert_same_bits(&file.finished(&request(id)).unwrap().unwrap(), &finished(id));
    }
    assert_eq!(file.finished(&request(10)).unwrap(), None);
    let mut seen = Vec::new();
    file.for_each(|stored| {
        let sample = exact::sample_to_bytes(&stored.sample);
        assert_eq!(sample, exact::sample_to_bytes(&request(stored.id.unsigned_abs()).sample));
        seen.push(stored.id);
        Ok::<(), StoreError>(())
    })
    .unwrap();
    assert_eq!(seen, (0..10).collect::<Vec<_>>());
    assert_eq!(file.count().unwrap(), 10);
    assert_eq!(file.meta, meta());
}

#[test]
fn people_can_query_values_by_name() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    record(&mut file, 0..5);
    // Another program, while the study runs.
    let reader =
        Connection::open_with_flags(dir.path().join(FILE_NAME), OpenFlags::SQLITE_OPEN_READ_ONLY).unwrap();
    let (k, depth): (f64, f64) = reader
        .query_row(
            "SELECT input.K_2, output.max_wear_depth FROM input JOIN output USING (evaluation)
             WHERE evaluation = 4 AND cycles = 2000",
            [],
            |row| Ok((row.get(0)?, row.get(1)?)),
        )
        .unwrap();
    assert_eq!((k, depth), (0.4, 0.4));
    let error: f64 = reader
        .query_row(
            "SELECT max_wear_depth FROM output_error WHERE evaluation = 4 AND cycles = 2000",
            [],
            |row| row.get(0),
        )
        .unwrap();
    assert_eq!(error, finished(4).outcome.unwrap().errors[0][1]);
    let failure: String =
        reader.query_row("SELECT failure FROM evaluation WHERE id = 3", [], |row| row.get(0)).unwrap();
    assert_eq!(failure, finished(3).outcome.unwrap_err().to_string());
}

#[test]
fn another_nominal_point_is_refused_and_the_first_outcome_stays() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    record(&mut file, 0..2);
    let mut foreign = request(0);
    foreign.sample[1] = foreign.sample[1].next_up();
    let message = file.finished(&foreign).unwrap_err().to_string();
    assert!(message.contains("evaluation 0 was recorded with another sample"), "{message}");
    assert!(file.record(&foreign, &finished(0)).is_err());
    assert!(file.record(&request(1), &finished(2)).is_err());
    // The same outcome twice is harmless, and the first one stays.
    let late = Finished { worker: "late".into(), ..finished(1) };
    file.record(&request(1), &late).unwrap();
    assert_same_bits(&file.finished(&request(1)).unwrap().unwrap(), &finished(1));
}

#[test]
fn values_that_do_not_fit_the_scene_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    let mut short = request(1);
    short.sample.pop();
    assert!(file.record(&short, &finished(1)).is_err());
    let mut ragged = finished(1);
    ragged.outcome.as_mut().unwrap().histories[0].pop();
    assert!(file.record(&request(1), &ragged).is_err());
    let mut ragged = finished(1);
    ragged.outcome.as_mut().unwrap().errors[0].pop();
    assert!(file.record(&request(1), &ragged).is_err());
    assert_eq!(file.count().unwrap(), 0);
}

#[test]
fn outcomes_recorded_together_are_all_there_or_none() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    let mut all: Vec<_> = (0..5).map(|id| (request(id), finished(id))).collect();
    all[4].1.id = 5;
    assert!(file.record_all(&all).is_err());
    assert_eq!(file.count().unwrap(), 0);
    all[4].1.id = 4;
    file.record_all(&all).unwrap();
    for (request, finished) in &all {
        assert_same_bits(&file.finished(request).unwrap().unwrap(), finished);
    }
}

#[test]
fn folders_in_use_taken_or_empty_are_told_apart() {
    let parent = tempfile::tempdir().unwrap();
    let dir = parent.path().join("a/b");
    assert!(matches!(CampaignFile::open(&dir), Err(StoreError::NoCampaign { .. })));
    let file = CampaignFile::create(&dir, &meta(), &scene()).unwrap();
    let in_use = CampaignFile::create(&dir, &meta(), &scene()).unwrap_err();
    assert!(matches!(in_use, StoreError::InUse { .. }) && in_use.is_bad_input(), "{in_use}");
    assert!(matches!(CampaignFile::open(&dir), Err(StoreError::InUse { .. })));
    drop(file);
    let taken = CampaignFile::create(&dir, &meta(), &scene()).unwrap_err();
    assert!(matches!(taken, StoreError::AlreadyHoldsCampaign { .. }) && taken.is_bad_input());
    assert!(taken.to_string().contains("coordinator resume"), "{taken}");
}

#[test]
fn foreign_files_are_refused_and_left_alone() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(FILE_NAME);
    std::fs::write(&path, "this is no database, but it is long enough to be taken for one".repeat(20))
        .unwrap();
    assert!(matches!(CampaignFile::open(dir.path()), Err(StoreError::NotACampaign { .. })));
    assert!(matches!(
        CampaignFile::create(dir.path(), &meta(), &scene()),
        Err(StoreError::NotACampaign { .. })
    ));
    std::fs::remove_file(&path).unwrap();
    Connection::open(&path).unwrap().execute_batch("CREATE TABLE cats (name TEXT)").unwrap();
    assert!(matches!(CampaignFile::open(dir.path()), Err(StoreError::NotACampaign { .. })));
    std::fs::remove_file(&path).unwrap();
    drop(CampaignFile::create(dir.path(), &meta(), &scene()).unwrap());
    Connection::open(&path).unwrap().execute_batch("PRAGMA user_version = 99").unwrap();
    let newer = CampaignFile::open(dir.path()).unwrap_err();
    assert!(matches!(newer, StoreError::SchemaVersion { found: 99, .. }), "{newer}");
}

#[test]
fn stated_errors_are_repeated_and_unreadable_outcomes_are_named() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    record(&mut file, 0..5);
    // An evaluation that states no errors has none here either.
    let mut silent = finished(5);
    silent.outcome.as_mut().unwrap().errors.clear();
    file.record(&request(5), &silent).unwrap();
    for id in 0..5 {
        assert_same_bits(&file.finished(&request(id)).unwrap().unwrap(), &finished(id));
    }
    let stated = |id: u64| -> Vec<f64> {
        let sql = "SELECT max_wear_depth FROM output_error WHERE evaluation = ?1 ORDER BY cycles";
        let mut statement = file.connection.prepare(sql).unwrap();
        let rows = statement.query_map([id as i64], |row| row.get(0)).unwrap();
        rows.map(Result::unwrap).collect()
    };
    assert_eq!(stated(4), finished(4).outcome.unwrap().errors[0]);
    assert!(stated(3).is_empty() && stated(5).is_empty());

    file.connection.execute("UPDATE evaluation SET outcome = x'00' WHERE id = 2", []).unwrap();
    let refused = file.evaluation(2).unwrap_err();
    assert!(matches!(refused, StoreError::Outcome { id: 2, .. }), "{refused}");
    assert!(refused.is_bad_input() && refused.to_string().contains("start a new study"));
}

#[test]
fn a_start_that_died_before_its_first_commit_does_not_block_the_folder() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join(FILE_NAME), "").unwrap();
    assert!(matches!(CampaignFile::open(dir.path()), Err(StoreError::NoCampaign { .. })));
    let file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    assert_eq!(file.count().unwrap(), 0);
}

/// What a crash leaves is the database and its log as they were at that moment.
#[test]
fn a_copy_taken_in_the_middle_holds_everything_recorded() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    let mut wal_bytes = Vec::new();
    for id in 0..8 {
        record(&mut file, id..=id);
        let copy = tempfile::tempdir().unwrap();
        for name in [FILE_NAME.to_string(), format!("{FILE_NAME}-wal")] {
            std::fs::copy(dir.path().join(&name), copy.path().join(&name)).unwrap();
        }
        let wal = copy.path().join(format!("{FILE_NAME}-wal"));
        wal_bytes.push(std::fs::metadata(&wal).unwrap().len());
        let mut copied = CampaignFile::open(copy.path()).unwrap();
        assert_eq!(copied.count().unwrap(), id as usize + 1);
        assert_same_bits(&copied.finished(&request(id)).unwrap().unwrap(), &finished(id));
    }
    // Torn in the middle of the last commit: that one is gone, all before it are there.
    let torn = tempfile::tempdir().unwrap();
    std::fs::copy(dir.path().join(FILE_NAME), torn.path().join(FILE_NAME)).unwrap();
    let wal = std::fs::read(dir.path().join(format!("{FILE_NAME}-wal"))).unwrap();
    let middle = (wal_bytes[6] + wal_bytes[7]) / 2;
    std::fs::write(torn.path().join(format!("{FILE_NAME}-wal")), &wal[..middle as usize]).unwrap();
    assert_eq!(CampaignFile::open(torn.path()).unwrap().count().unwrap(), 7);
}

const KILLED_DIR: &str = "HINGEWISE_TEST_KILLED_DIR";

/// The test starts itself as a process that records one evaluation after another and prints the number of each. When it
/// is killed, every printed evaluation is in the file, and the lock is free.
#[test]
fn a_killed_process_loses_nothing_it_had_recorded() {
    if let Some(dir) = std::env::var_os(KILLED_DIR) {
        let mut file = CampaignFile::create(Path::new(&dir), &meta(), &scene()).unwrap();
        for id in 0.. {
            record(&mut file, id..=id);
            println!("\nrecorded {id}");
        }
    }
    let dir = tempfile::tempdir().unwrap();
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args([
            "--exact",
            "results::store::tests::a_killed_process_loses_nothing_it_had_recorded",
            "--nocapture",
        ])
        .env(KILLED_DIR, dir.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut recorded = lines.filter_map(|line| line.unwrap().strip_prefix("recorded ")?.parse::<u64>().ok());
    let eleventh = recorded.nth(10);
    let in_use = CampaignFile::open(dir.path()).map(|_| ());
    child.kill().unwrap();
    child.wait().unwrap();
    let last = recorded.last().or(eleventh).unwrap();
    assert!(matches!(in_use, Err(StoreError::InUse { .. })));
    let mut file = CampaignFile::open(dir.path()).unwrap();
    assert!(file.count().unwrap() as u64 > last);
    for id in 0..=last {
        assert_same_bits(&file.finished(&request(id)).unwrap().unwrap(), &finished(id));
    }
}

#[test]
fn rounds_and_documents_come_back() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    let round = Round { round: 1, evaluations: 20, min_u: 0.1, dominance: Some(0.3), ..Round::default() };
    file.note_round(&Round::default()).unwrap();
    file.note_round(&Round::default()).unwrap();
    file.note_round(&round).unwrap();
    assert_eq!(file.rounds().unwrap(), [Round::default(), round]);
    assert_eq!(file.document::<Vec<u32>>("summary").unwrap(), None);
    file.put_document("summary", &vec![1, 2]).unwrap();
    file.put_document("summary", &vec![3]).unwrap();
    assert_eq!(file.document::<Vec<u32>>("summary").unwrap(), Some(vec![3]));
    assert!(file.created_at.ends_with('Z'));
}

#[test]
fn whoever_looks_sees_what_is_recorded_and_changes_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    record(&mut file, 0..3);
    file.put_document("summary", &"of the study").unwrap();
    let mut look = CampaignFile::look(dir.path()).unwrap();
    assert_eq!((look.count().unwrap(), &look.meta), (3, &file.meta));
    assert_eq!(look.document::<String>("summary").unwrap().unwrap(), "of the study");
    look.put_document("summary", &"of the onlooker").unwrap();
    assert_eq!(look.document::<String>("summary").unwrap().unwrap(), "of the onlooker");
    assert_eq!(file.document::<String>("summary").unwrap().unwrap(), "of the study");
    // The study goes on meanwhile, and what it records is seen.
    record(&mut file, 3..5);
    assert_eq!(look.count().unwrap(), 5);
    assert!(matches!(look.record(&request(5), &finished(5)), Err(EvaluateError::Record(_))));
    let empty = tempfile::tempdir().unwrap();
    assert!(matches!(CampaignFile::look(empty.path()), Err(StoreError::NoCampaign { .. })));
}
