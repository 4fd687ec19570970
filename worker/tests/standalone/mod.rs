//! A job outside any campaign.

use common::accuracy::Accuracy;
use common::wire::{Subject, Task, TaskKey, WorkOrder};
use std::sync::Arc;
use worker::service::Job;

/// A job outside any campaign, without the first cycle.
pub fn standalone(scene: &str, sample: &[f64], accuracy: Accuracy) -> Job {
    let subject = Subject::Scene(scene.to_owned());
    let order = WorkOrder { subject, accuracy, accuracy_name: String::new(), licensed: false, tasks: vec![] };
    let task = Task {
        key: TaskKey { campaign: 0, task: 0 },
        attempt: 1,
        sample: sample.to_vec(),
        with_first_cycle: false,
        accuracy: None,
        level: 0,
    };
    Job { order: Arc::new(order), task, coordinator: 0 }
}
