//! Further evaluations beside those of the study.

use super::tests::{finished, meta, record, request, scene};
use super::*;
use crate::farm::evaluate::{Finished, Request};
use crate::results::journal::Journal;
use common::accuracy::Accuracy;
use serde_json::json;

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
