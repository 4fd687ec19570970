//! Leases of the workers and their shares.

use super::workers::Workforce;
use common::wire::WorkerId;
use std::time::Duration;

fn id(name: &str) -> WorkerId {
    WorkerId { name: name.into(), epoch: 1 }
}

fn workforce(slots: &[(&str, u32)]) -> Workforce {
    let mut all = Workforce::default();
    for (name, slots) in slots {
        all.add(id(name));
        assert!(all.register_claim(&id(name), 1, *slots, true));
    }
    all
}

#[test]
fn shares_follow_the_slots_and_keep_every_slot_busy() {
    let all = workforce(&[("a", 2), ("b", 6)]);
    let shares = |open| [all.share(&id("a"), open), all.share(&id("b"), open)];
    assert_eq!(shares(32), [8, 24]);
    assert_eq!(shares(9), [3, 7]);
    assert_eq!(shares(1), [2, 6]);
    assert_eq!(all.share(&id("c"), 8), 0);
    assert_eq!(workforce(&[("a", 2)]).share(&id("a"), 8), 8);
}

#[test]
fn shares_follow_the_measured_speed() {
    let mut all = workforce(&[("fast", 2), ("slow", 2), ("new", 4)]);
    // Before its first evaluation, the slow worker counts with the mean speed of the measured ones.
    all.record_evaluation(&id("fast"), 0, 1.0, Duration::ZERO);
    assert_eq!(all.share(&id("slow"), 80), 20);
    all.record_evaluation(&id("slow"), 0, 4.0, Duration::ZERO);
    // Speeds 2, 0.5 and 4 * 2.5/4.
    assert_eq!(["fast", "slow", "new"].map(|name| all.share(&id(name), 100)), [40, 10, 50], "of 100 tasks");
    all.remove(&id("fast"));
    assert_eq!(all.share(&id("slow"), 90), 30);
    all.remove(&id("slow"));
    assert_eq!(all.share(&id("new"), 90), 90);
}

#[test]
fn a_task_at_two_workers_is_held_until_both_have_lost_it() {
    let mut all = workforce(&[("a", 1), ("b", 1)]);
    let second = Duration::from_secs(1);
    all.lease(&id("a"), 7, second);
    all.record_evaluation(&id("a"), 7, 1.0, 2 * second);
    let late = |all: &Workforce, requester: &str, at| -> Vec<u64> {
        all.stragglers(&id(requester), at, 2.0).collect()
    };
    assert_eq!(late(&all, "b", 2 * second), [] as [u64; 0], "not late yet");
    assert_eq!(late(&all, "b", 3 * second), [7]);
    assert_eq!(late(&all, "a", 3 * second), [] as [u64; 0], "it has it already");
    all.lease(&id("b"), 7, 3 * second);
    assert_eq!(late(&all, "c", 9 * second), [] as [u64; 0], "two workers are enough");
    assert!(all.release(&id("a"), 7), "b has it");
    assert_eq!(late(&all, "c", 9 * second), [7]);
    assert_eq!(all.remove(&id("b")), [7]);
    assert!(!all.is_held(7));
}

#[test]
fn a_slow_worker_gets_a_straggler_only_if_no_faster_one_did() {
    let mut all = workforce(&[("a", 1), ("b", 1), ("slow", 1)]);
    let second = Duration::from_secs(1);
    all.lease(&id("a"), 7, Duration::ZERO);
    all.lease(&id("b"), 8, Duration::ZERO);
    all.record_evaluation(&id("b"), 8, 1.0, second);
    all.release_from_all(8);
    all.record_evaluation(&id("slow"), 9, 10.0, second);
    let late = |requester: &str, at: u32| all.stragglers(&id(requester), at * second, 2.0).count();
    assert_eq!(
        [late("b", 1), late("b", 2), late("slow", 2), late("slow", 7), late("slow", 8)],
        [0, 1, 0, 0, 1]
    );
}
