//! Legs of a campaign, renumbered and further evaluations, what is kept of bores, and files that can only be read.

use super::connection::{from_copy, unchanging};
use super::tests::{finished, meta, record, request, scene};
use super::*;
use crate::farm::evaluate::{Finished, Request};
use crate::results::journal::Journal;
use common::accuracy::Accuracy;
use common::outputs::JointSummary;
use serde_json::json;

/// Numbers of all evaluations, those below zero included.
fn numbers(file: &CampaignFile) -> Vec<i64> {
    let mut statement = file.connection.prepare("SELECT id FROM evaluation ORDER BY id").unwrap();
    statement.query_map([], |row| row.get(0)).unwrap().map(Result::unwrap).collect()
}

/// The request of evaluation `sample` under another number.
fn renumbered(id: u64, sample: u64) -> Request {
    Request { id, ..request(sample) }
}

#[test]
fn a_leg_takes_its_outcomes_from_other_numbers() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    record(&mut file, 0..6);
    file.put_document("summary", &1).unwrap();
    file.begin_leg(json!({ "seed": 1, "max_evaluations": 9 }), "coordinator resume", "0.2").unwrap();
    assert_eq!(file.document::<u32>("summary").unwrap(), None);

    // Requests 0 and 1 as before; 2 has a new sample, 3 that of 5, 4 that of 2.
    let mut recall =
        |request: &Request| file.finished(request).unwrap().map(|found| (found.id, found.worker));
    assert_eq!(recall(&request(0)), Some((0, "host/0".into())));
    assert_eq!(recall(&request(1)), Some((1, "host/1".into())));
    assert_eq!(recall(&renumbered(2, 70)), None);
    assert_eq!(recall(&renumbered(3, 5)), Some((3, "host/5".into())));
    assert_eq!(recall(&renumbered(4, 2)), Some((4, "host/2".into())));
    file.record(&renumbered(2, 70), &Finished { id: 2, ..finished(70) }).unwrap();
    file.ended(5).unwrap();
    assert_eq!(numbers(&file), [-3, -2, 0, 1, 2, 3, 4]);
    assert_eq!(file.count().unwrap(), 5);
    // The tables of values follow.
    let input = "SELECT input.k FROM input WHERE evaluation = 3";
    let k: f64 = file.connection.query_row(input, [], |row| row.get(0)).unwrap();
    assert_eq!(k, request(5).sample[0]);
    drop(file);

    // The settings are those of the last leg, and every leg is known.
    let file = CampaignFile::open(dir.path()).unwrap();
    assert_eq!(file.meta.settings["max_evaluations"], 9);
    assert_eq!(file.meta.command, meta().command);
    let sql = "SELECT number, evaluations, command, settings FROM leg ORDER BY number";
    let mut statement = file.connection.prepare(sql).unwrap();
    let legs = statement.query_map([], |row| row.try_into()).unwrap();
    let legs: Vec<(i64, i64, String, String)> = legs.map(Result::unwrap).collect();
    let shown: Vec<_> =
        legs.iter().map(|(number, before, command, _)| (*number, *before, &**command)).collect();
    assert_eq!(shown, [(1, 0, "coordinator run --scene two"), (2, 6, "coordinator resume")]);
    assert_eq!(legs[0].3, meta().settings.to_string());
    assert_eq!(file.leg_versions().unwrap(), [meta().version, "0.2".to_owned()]);
}

#[test]
fn a_repetition_with_finer_steps_is_no_other_evaluation() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    let finer = Request { accuracy: Some(Accuracy::default()), ..renumbered(2, 3) };
    record(&mut file, 0..1);
    file.record(&renumbered(1, 3), &Finished { id: 1, ..finished(3) }).unwrap();
    file.record(&finer, &Finished { id: 2, ..finished(4) }).unwrap();
    // Requested in the other order, each finds its own outcome.
    assert_eq!(file.finished(&renumbered(1, 80)).unwrap(), None);
    assert!(file.finished(&renumbered(2, 3)).unwrap().unwrap().outcome.is_err());
    assert!(file.finished(&Request { id: 3, ..finer }).unwrap().unwrap().outcome.is_ok());
}

#[test]
fn levels_of_a_sample_are_other_evaluations_and_earlier_files_have_none() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    record(&mut file, 0..2);
    let finer = Request { accuracy: Some(Accuracy::default()), level: 1, ..renumbered(2, 1) };
    assert_eq!(file.finished(&finer).unwrap(), None);
    file.record(&finer, &Finished { id: 2, ..finished(4) }).unwrap();
    // A later leg requests the pair under another number, and its working accuracy first.
    assert_eq!(file.finished(&Request { id: 2, ..request(7) }).unwrap(), None);
    assert!(file.finished(&Request { id: 5, ..finer.clone() }).unwrap().is_some());
    assert_eq!((file.count().unwrap(), file.working_count().unwrap()), (3, 2));
    let of_file = |file: &CampaignFile| {
        let (mut working, mut levels) = (0, vec![]);
        file.for_each_known(false, |_| working += 1).unwrap();
        file.for_each_known(true, |stored| levels.push((stored.level, stored.sample))).unwrap();
        (working, levels)
    };
    assert_eq!(of_file(&file), (2, vec![(1, finer.sample.clone())]));
    drop(file);
    let third_layout = "PRAGMA foreign_keys = OFF; DELETE FROM evaluation WHERE level > 0; ALTER TABLE evaluation DROP COLUMN level;
        PRAGMA user_version = 3;";
    Connection::open(dir.path().join(FILE_NAME)).unwrap().execute_batch(third_layout).unwrap();
    let look = CampaignFile::look(dir.path()).unwrap();
    assert_eq!((look.working_count().unwrap(), of_file(&look)), (2, (2, vec![])));
    assert_eq!(look.evaluation(1).unwrap().unwrap().level, 0);
    drop(look);
    let file = CampaignFile::open(dir.path()).unwrap();
    assert_eq!(of_file(&file), (2, vec![]));
}

#[test]
fn a_study_without_a_result_forgets_its_failures() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    record(&mut file, 3..4);
    file.forget_failed_start().unwrap();
    assert_eq!(file.count().unwrap(), 0);
    record(&mut file, 3..5);
    file.forget_failed_start().unwrap();
    assert_eq!((file.count().unwrap(), file.failed_count().unwrap()), (2, 1));
}

#[test]
fn evaluations_of_a_worker_are_set_aside_and_made_again() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    record(&mut file, 0..6);
    assert_eq!(file.set_worker_aside("hos").unwrap(), 0, "another name");
    assert_eq!(file.set_worker_aside("host/4").unwrap(), 1);
    assert_eq!(file.set_worker_aside("host").unwrap(), 5);
    file.forget_failed_start().unwrap();
    assert_eq!((file.count().unwrap(), numbers(&file).len()), (0, 6));
    assert!((0..6).all(|id| file.finished(&request(id)).unwrap().is_none()));
    record(&mut file, 0..6);
    assert_eq!((file.count().unwrap(), numbers(&file).len()), (6, 12));
}

#[test]
fn issue_a_damaged_outcome_was_believed() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    record(&mut file, 0..2);
    let bytes: Vec<u8> = file
        .connection
        .query_row("SELECT outcome FROM evaluation WHERE id = 1", [], |row| row.get(0))
        .unwrap();
    // The last digit of a recorded value.
    let value = file.finished(&request(1)).unwrap().unwrap().outcome.unwrap().histories[0][0].to_be_bytes();
    let place = bytes.windows(8).position(|window| window == value).expect("CBOR holds it");
    let mut changed = bytes;
    changed[place + 7] ^= 1;
    file.connection.execute("UPDATE evaluation SET outcome = ?1 WHERE id = 1", [changed]).unwrap();
    assert!(file.finished(&request(1)).unwrap().is_none(), "set aside, to be evaluated again");
    assert!(file.finished(&request(0)).unwrap().is_some());
    assert_eq!((file.count().unwrap(), numbers(&file).len()), (1, 2));
}

#[test]
fn a_file_is_read_where_nothing_can_be_written() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(FILE_NAME);
    let rows = |connection: &Connection| -> i64 {
        connection.query_row("SELECT count(*) FROM evaluation", [], |row| row.get(0)).unwrap()
    };
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    record(&mut file, 0..4);
    // What a killed study leaves: the last results are in the log.
    let copy = from_copy(&path).unwrap();
    assert_eq!(rows(&copy.0), 4);
    drop(file);
    assert_eq!(rows(&unchanging(&path).unwrap().0), 4);
    let odd = dir.path().join("a b%41?#");
    std::fs::create_dir(&odd).unwrap();
    std::fs::copy(&path, odd.join(FILE_NAME)).unwrap();
    assert_eq!(rows(&unchanging(&odd.join(FILE_NAME)).unwrap().0), 4);
}

#[test]
fn issue_readers_left_files_beside_the_campaign_file() {
    let dir = tempfile::tempdir().unwrap();
    record(&mut CampaignFile::create(dir.path(), &meta(), &scene()).unwrap(), 0..2);
    let files = || {
        let entries = std::fs::read_dir(dir.path()).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let before = files();
    let reader = CampaignFile::look(dir.path()).unwrap();
    assert_eq!(reader.count().unwrap(), 2);
    assert!(reader.connection.execute("DELETE FROM evaluation", []).is_err());
    drop(reader);
    assert_eq!(files(), before);
}

#[test]
fn readers_neither_lock_nor_wait() {
    let dir = tempfile::tempdir().unwrap();
    assert!(!is_running(dir.path()));
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    record(&mut file, 0..3);
    assert!(is_running(dir.path()));
    let readers = [CampaignFile::look(dir.path()).unwrap(), CampaignFile::look(dir.path()).unwrap()];
    assert!(readers.iter().all(|reader| reader.count().unwrap() == 3));
    drop(file);
    assert!(!is_running(dir.path()));
    CampaignFile::open(dir.path()).unwrap();
}

#[test]
fn further_evaluations_are_kept_and_leave_the_study_alone() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    record(&mut file, 0..3);
    let mut further = FurtherEvaluations(&mut file);
    // A sample of the study is not simulated again; a finer repetition is another evaluation.
    assert_eq!(further.finished(&Request { id: 90, ..request(1) }).unwrap().unwrap().id, 90);
    let finer = Request { id: 93, accuracy: Some(Accuracy::default()), ..request(1) };
    assert_eq!(further.finished(&finer).unwrap(), None);
    for id in [91, 92] {
        further.record(&request(id), &finished(id)).unwrap();
    }
    further.ended(2).unwrap();
    assert_eq!((file.count().unwrap(), file.rounds().unwrap().len()), (3, 0));
    let mut ids = Vec::new();
    file.for_each(|stored| -> Result<(), StoreError> {
        ids.push(stored.id);
        Ok(())
    })
    .unwrap();
    assert_eq!(ids, [0, 1, 2]);
    drop(file);

    // All are found again, also by a reader, the study's own first.
    let file = CampaignFile::look(dir.path()).unwrap();
    let mut samples = Vec::new();
    file.for_each_known(false, |stored| samples.push(stored.sample)).unwrap();
    let expected: Vec<Vec<f64>> = [0, 1, 2, 91, 92].map(|id| request(id).sample).to_vec();
    assert_eq!(samples, expected);
    drop(file);

    // A later leg that requests one of the samples finds its outcome.
    let mut file = CampaignFile::open(dir.path()).unwrap();
    file.begin_leg(json!({ "max_evaluations": 9 }), "coordinator resume", "0.2").unwrap();
    let found = file.finished(&Request { id: 3, ..request(92) }).unwrap().unwrap();
    assert_eq!(found, Finished { id: 3, ..finished(92) });
    assert_eq!(file.count().unwrap(), 4);
}

#[test]
fn bores_are_kept_of_evaluations_with_their_first_cycle() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta(), &scene()).unwrap();
    for id in [0, 1] {
        let mut worn = finished(id);
        let bore = JointSummary {
            name: "1".into(),
            peak_force: 3.0,
            wear_depth: vec![1e-5; 36],
            journal_wear_depth: Vec::new(),
        };
        worn.outcome.as_mut().unwrap().joints = vec![bore];
        file.record(&request(id), &worn).unwrap();
    }
    let bores = [0, 1].map(|id| {
        let kept = file.finished(&request(id)).unwrap().unwrap().outcome.unwrap();
        (request(id).with_first_cycle, kept.joints.len())
    });
    assert_eq!(bores, [(true, 1), (false, 0)]);
}
