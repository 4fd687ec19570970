//! What a campaign file keeps of the bores.

use super::CampaignFile;
use super::tests::{finished, meta, request, scene};
use crate::results::journal::Journal;
use common::outputs::JointSummary;

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
