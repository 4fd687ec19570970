//! The layout of the messages belongs to a version: programs of one version read each other's messages, and those of
//! another version are refused by its number. A change of the layout without a new number would be read as garbage.

use super::*;
use crate::accuracy::{Accuracy, Tier};
use crate::external::SimulatorId;
use crate::failure::SimulationFailure;
use crate::outputs::{
    BodyMotion, BodyTrace, CycleHistory, Diagnostics, EnergyBalance, Evaluation, JointSummary, JournalPath,
    NarrowGroove, PointsError, UnsettledMotion, WornLife,
};

/// Version and layout of the messages: [`PROTOCOL_VERSION`] and the hash of [`frames`]. Where the second changes, a message
/// has another layout, and the first has to change too.
const LAYOUT: (u16, u64) = (16, 0xbbe1_4185_d042_245b);

fn accuracy() -> Accuracy {
    Accuracy {
        step_tolerance: 1e-4,
        largest_step: 0.01,
        steps_bound: 1 << 20,
        wear_samples: 300,
        cycle_jump: 2000,
        wear_tolerance: 0.02,
        warm_up: 0.5,
        tier: Tier::Dynamic,
        points: 3,
        wear_error: false,
    }
}

fn task(attempt: u32) -> Task {
    let accuracy = (attempt > 1).then(accuracy);
    let key = TaskKey { campaign: u64::MAX, task: 70_000 };
    Task { key, attempt, sample: vec![0.1, -2.5e300], with_first_cycle: true, accuracy, level: 1 }
}

fn cycle() -> CycleHistory {
    CycleHistory {
        time: vec![0.0, 0.5],
        bodies: vec![BodyTrace { label: "right".into(), angle: vec![1.0], speed: vec![2.0, 3.0] }],
        motion: vec![BodyMotion {
            body: "crank".into(),
            position: vec![[4.0, 5.0]],
            angle: vec![6.0],
            speed: vec![],
        }],
        joint_force: vec![("1".into(), vec![7.0])],
        journals: vec![JournalPath {
            joint: "1".into(),
            force: vec![[7.0, 8.0]],
            eccentricity: vec![[9.0, 10.0]],
        }],
        slider_position: vec![("2".into(), vec![11.0])],
        driving_torque: vec![("crank".into(), vec![12.0])],
    }
}

fn evaluation() -> Evaluation {
    let energy = EnergyBalance { input: 1.0, stored: 2.0, dissipated: 3.0, unphysical: 4.0, turnover: 5.0 };
    Evaluation {
        cycles: vec![1000, 2000],
        histories: vec![vec![0.25, 0.5]],
        errors: vec![vec![0.125, 0.0625]],
        start: vec![Some(8.0), None],
        joints: vec![JointSummary {
            name: "1".into(),
            peak_force: 9.0,
            wear_depth: vec![10.0, 11.0],
            journal_wear_depth: vec![13.0],
        }],
        first_cycle: Some(cycle()),
        worn: Some(WornLife {
            cycles: vec![0],
            wear_depth: vec![vec![vec![12.0]]],
            last_cycle: Some(cycle()),
        }),
        diagnostics: Diagnostics {
            steps: 1,
            rejected_steps: 2,
            newton_iterations: 300,
            force_evaluations: 70_000,
            simulated_cycles: 5,
            wear_stages: 6,
            rejected_wear_steps: 7,
            free_flight_fraction: vec![("1".into(), 0.25)],
            constraint_drift: 1e-12,
            held_wear_points: 8,
            narrow_grooves: vec![NarrowGroove {
                joint: "1".into(),
                since: 1000,
                angle: 1.5,
                width: 0.5,
                open: 1e-6,
            }],
            control_points: vec![PointsError {
                output: "wear".into(),
                cycles: 3000,
                values: [14.0, 15.0, 16.0],
                error: 17.0,
                converges: true,
                stated: false,
            }],
            unsettled: Some(UnsettledMotion {
                output: "wear".into(),
                change: 0.01,
                further_cycles: 60,
                turning: Some(("crank".into(), 5.75)),
            }),
            quasi_static: true,
            energy: Some(energy),
            worn_energy: None,
        },
    }
}

fn beam() -> SimulatorId {
    SimulatorId { scene: "beam".into(), digest: 1 << 100 }
}

/// One frame of every kind of message, with every field in use.
fn frames() -> Vec<Vec<u8>> {
    let failed = SimulationFailure::StepTooSmall {
        cycle: 3,
        time: 0.5,
        joint: Some("1".into()),
        step: 1e-9,
        error: 2.0,
    };
    let outcome =
        |attempt, result| Outcome { task: task(attempt), worker: "host-1/0".into(), wall: 0.75, result };
    let claim = Claim {
        worker: WorkerId { name: "host-1".into(), epoch: 1 << 40 },
        sequence: 2,
        offers: Offers::Simulators(vec![beam()]),
        slots: 3,
        credits: 4,
        holding: vec![task(1).key],
        finished: vec![outcome(1, Ok(evaluation())), outcome(2, Err(failed))],
        leaving: true,
    };
    let order = |subject| {
        let tasks = vec![task(1), task(2)];
        Next::Work(WorkOrder {
            subject,
            accuracy: accuracy(),
            accuracy_name: "balanced".into(),
            licensed: true,
            tasks,
        })
    };
    let orders = [order(Subject::Scene("[scene]".into())), order(Subject::Simulator(beam()))];
    let replies = [Next::Idle { ask_again: 500 }, Next::Leave { campaign: 7 }];
    let point = (5, vec![0.5]);
    let notices = [Notice::Batch { campaign: 6, points: vec![point] }, Notice::Ended { campaign: 7 }];
    let status = Status {
        program: "0.1.0".into(),
        clock_ms: 1 << 41,
        up: 0.5,
        phase: Phase::Learning,
        study: StudyStatus {
            scene: "drive".into(),
            purpose: "round 3".into(),
            done: 1,
            failed: 2,
            recalled: 3,
            planned: 4,
            budget: 5,
            simulation: 6.0,
            rounds: 7,
            reliability: Some(ReliabilitySoFar { cycles: 8000, total: 0.5, standard_error: 0.01 }),
            warnings: 8,
        },
        farm: FarmStatus {
            queued: 9,
            under_way: 10,
            rate: 11.0,
            workers: vec![WorkerStatus {
                name: "host-1".into(),
                slots: 12,
                under_way: 13,
                done: 14,
                rate: 15.0,
            }],
        },
        scale: Some(ScaleStatus {
            system: "slurm".into(),
            most: 16,
            asked: 17,
            waiting: 18,
            running: 19,
            failed: 20,
            last_failure: "none".into(),
        }),
    };
    let mut frames = vec![encode(&claim).unwrap(), encode(&status).unwrap()];
    frames.extend(
        orders
            .into_iter()
            .chain(replies)
            .map(|next| encode(&Reply { acknowledged: vec![task(1).key], next }).unwrap()),
    );
    frames.extend(notices.map(|notice| encode(&notice).unwrap()));
    frames
}

/// FNV-1a over the frames without their version.
fn hash(frames: &[Vec<u8>]) -> u64 {
    let bytes = frames.iter().flat_map(|frame| frame[..4].iter().chain(&frame[6..]));
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn a_layout_belongs_to_its_version() {
    let found = (PROTOCOL_VERSION, hash(&frames()));
    assert_eq!(
        found, LAYOUT,
        "the messages have another layout: raise PROTOCOL_VERSION if it is still {}, then put ({}, {:#x}) here",
        LAYOUT.0, found.0, found.1
    );
}

#[test]
fn the_header_is_that_of_every_version() {
    for frame in frames() {
        let payload = u32::try_from(frame.len() - 12).unwrap();
        assert_eq!(frame[..4], *b"HNGW");
        assert_eq!(frame[4..6], PROTOCOL_VERSION.to_le_bytes());
        assert!((1..=4).contains(&frame[6]) && frame[7] == 0);
        assert_eq!(frame[8..12], payload.to_le_bytes());
    }
}
