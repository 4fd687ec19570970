//! Properties of the codec: round trip, no panic and no unbounded allocation for any bytes, and its errors.

use super::codec::{Encoded, HEADER};
use super::*;
use crate::accuracy::Accuracy;
use crate::external::SimulatorId;
use crate::failure::SimulationFailure;
use crate::outputs::{BodyMotion, BodyTrace, CycleHistory, Diagnostics, Evaluation, JointSummary, WornLife};
use proptest::{collection::vec, prelude::*};

fn number() -> impl Strategy<Value = f64> {
    any::<f64>().prop_map(|x| if x.is_finite() { x } else { -0.0 })
}

fn key() -> impl Strategy<Value = TaskKey> {
    any::<(u64, u64)>().prop_map(|(campaign, task)| TaskKey { campaign, task })
}

fn task() -> impl Strategy<Value = Task> {
    let parts = (key(), any::<u32>(), vec(number(), 0..20), any::<bool>(), proptest::option::of(number()));
    parts.prop_map(|(key, attempt, sample, with_first_cycle, accuracy)| Task {
        key,
        attempt,
        sample,
        with_first_cycle,
        accuracy: accuracy.map(self::accuracy),
        level: 2,
    })
}

fn first_cycle() -> impl Strategy<Value = CycleHistory> {
    (vec(number(), 0..9), vec(number(), 0..9), vec(number(), 0..9), ".{0,5}").prop_map(
        |(time, angle, force, label)| CycleHistory {
            time,
            motion: vec![BodyMotion {
                body: label.clone(),
                position: angle.iter().map(|&x| [x, -x]).collect(),
                angle: angle.clone(),
                speed: force.clone(),
            }],
            bodies: vec![BodyTrace { label: label.clone(), speed: angle.clone(), angle }],
            joint_force: vec![(label.clone(), force.clone())],
            driving_torque: vec![(label, force)],
            ..CycleHistory::default()
        },
    )
}

fn evaluation() -> impl Strategy<Value = Evaluation> {
    let histories = vec(vec(number(), 0..9), 0..3);
    (vec(any::<u32>(), 0..9), histories, number(), vec(number(), 0..9), proptest::option::of(first_cycle()))
        .prop_map(|(cycles, histories, peak_force, wear_depth, first_cycle)| Evaluation {
            worn: first_cycle.clone().map(|cycle| WornLife {
                cycles: vec![0, 7],
                wear_depth: vec![vec![wear_depth.clone(), vec![]]; 2],
                last_cycle: Some(cycle),
            }),
            cycles,
            errors: histories.clone(),
            start: histories.iter().map(|history| history.first().copied()).collect(),
            histories,
            joints: vec![JointSummary {
                name: "1".into(),
                peak_force,
                journal_wear_depth: wear_depth.clone(),
                wear_depth,
            }],
            first_cycle,
            diagnostics: Diagnostics {
                steps: 7,
                free_flight_fraction: vec![("1".into(), 0.25)],
                ..Diagnostics::default()
            },
        })
}

fn failure() -> impl Strategy<Value = SimulationFailure> {
    prop_oneof![
        ".{0,20}".prop_map(|message| SimulationFailure::Panicked { message }),
        (any::<u32>(), number(), number()).prop_map(|(cycle, time, error)| SimulationFailure::StepTooSmall {
            cycle,
            time,
            joint: (cycle % 2 == 0).then(|| "1".into()),
            step: time,
            error
        }),
    ]
}

fn outcome() -> impl Strategy<Value = Outcome> {
    let result = prop_oneof![evaluation().prop_map(Ok), failure().prop_map(Err)];
    (task(), "[a-z]{1,9}/[0-9]", number(), result).prop_map(|(task, worker, wall, result)| Outcome {
        task,
        worker,
        wall,
        result,
    })
}

fn simulator(number: u64) -> SimulatorId {
    SimulatorId { scene: format!("beam {number}"), digest: u128::from(number) << 70 }
}

fn claim() -> impl Strategy<Value = Claim> {
    let who = ("[A-Za-z0-9_.-]{1,100}", any::<u64>()).prop_map(|(name, epoch)| WorkerId { name, epoch });
    (who, any::<(u64, u32, u32, bool)>(), vec(key(), 0..9), vec(outcome(), 0..4)).prop_map(
        |(worker, (sequence, slots, credits, leaving), holding, finished)| Claim {
            offers: if slots % 2 == 0 {
                Offers::Scenes(crate::build::Build(sequence))
            } else {
                Offers::Simulators(vec![simulator(sequence)])
            },
            worker,
            sequence,
            slots,
            credits,
            holding,
            finished,
            leaving,
        },
    )
}

fn reply() -> impl Strategy<Value = Reply> {
    let work = (".{0,99}", number(), vec(task(), 0..9)).prop_map(|(scene, x, tasks)| {
        let subject =
            if tasks.len() % 2 == 0 { Subject::Scene(scene) } else { Subject::Simulator(simulator(7)) };
        Next::Work(WorkOrder {
            subject,
            accuracy: accuracy(x),
            accuracy_name: "draft".into(),
            licensed: x > 0.5,
            tasks,
        })
    });
    let idle = any::<u32>().prop_map(|ask_again| Next::Idle { ask_again });
    (vec(key(), 0..9), prop_oneof![work, idle, any::<u64>().prop_map(|campaign| Next::Leave { campaign })])
        .prop_map(|(acknowledged, next)| Reply { acknowledged, next })
}

fn notice() -> impl Strategy<Value = Notice> {
    let point = (any::<u64>(), vec(number(), 0..9));
    prop_oneof![
        (any::<u64>(), vec(point, 0..9)).prop_map(|(campaign, points)| Notice::Batch { campaign, points }),
        any::<u64>().prop_map(|campaign| Notice::Ended { campaign }),
    ]
}

fn status() -> impl Strategy<Value = Status> {
    let reliability = (any::<u32>(), number(), number())
        .prop_map(|(cycles, total, standard_error)| ReliabilitySoFar { cycles, total, standard_error });
    let study = (".{0,9}", any::<(u64, u64, u64)>(), proptest::option::of(reliability)).prop_map(
        |(scene, (done, planned, failed), reliability)| StudyStatus {
            purpose: scene.clone(),
            scene,
            done,
            planned,
            failed,
            reliability,
            ..StudyStatus::default()
        },
    );
    let worker = ("[a-z]{1,9}", any::<(u32, u32, u64)>(), number()).prop_map(
        |(name, (slots, under_way, done), rate)| WorkerStatus { name, slots, under_way, done, rate },
    );
    let farm = (any::<(u64, u64)>(), number(), vec(worker, 0..5))
        .prop_map(|((queued, under_way), rate, workers)| FarmStatus { queued, under_way, rate, workers });
    let phases = [Phase::Waiting, Phase::Simulating, Phase::Learning, Phase::Ending];
    let phase = proptest::sample::select(phases.to_vec());
    ("[0-9.]{0,9}", any::<u64>(), number(), phase, study, farm).prop_map(
        |(program, clock_ms, up, phase, study, farm)| {
            let scale = ScaleStatus { system: program.clone(), asked: clock_ms, ..ScaleStatus::default() };
            let scale = (clock_ms % 2 == 0).then_some(scale);
            Status { program, clock_ms, up, phase, study, farm, scale }
        },
    )
}

fn accuracy(x: f64) -> Accuracy {
    Accuracy {
        step_tolerance: if (1e-12..=1e3).contains(&x) { x } else { 1e-6 },
        largest_step: 0.01,
        steps_bound: 100,
        wear_samples: 200,
        cycle_jump: 1000,
        wear_tolerance: 0.01,
        warm_up: 0.5,
        points: 2,
        ..Accuracy::reference()
    }
}

fn empty_claim() -> Claim {
    Claim {
        worker: WorkerId { name: "w".into(), epoch: 1 },
        sequence: 1,
        offers: Offers::Scenes(Default::default()),
        slots: 2,
        credits: 2,
        holding: vec![],
        finished: vec![],
        leaving: false,
    }
}

fn frame_with(payload: &[u8]) -> Vec<u8> {
    let mut frame = encode(&empty_claim()).unwrap();
    frame.truncate(HEADER);
    frame[8..12].copy_from_slice(&u32::try_from(payload.len()).unwrap().to_le_bytes());
    frame.extend_from_slice(payload);
    frame
}

proptest! {
    #[test]
    fn claims_are_decoded_unchanged(message in claim()) {
        let frame = encode(&message).unwrap();
        prop_assert_eq!(frame.len() - HEADER, message.encoded_size().unwrap());
        prop_assert_eq!(decode::<Claim>(&frame).unwrap(), message);
    }

    #[test]
    fn replies_are_decoded_unchanged(message in reply()) {
        prop_assert_eq!(decode::<Reply>(&encode(&message).unwrap()).unwrap(), message);
    }

    #[test]
    fn notices_are_decoded_unchanged(message in notice()) {
        prop_assert_eq!(decode::<Notice>(&encode(&message).unwrap()).unwrap(), message);
    }

    #[test]
    fn statuses_are_decoded_unchanged(message in status()) {
        prop_assert_eq!(decode::<Status>(&encode(&message).unwrap()).unwrap(), message);
    }

    #[test]
    fn any_bytes_are_refused_without_a_panic(bytes in vec(any::<u8>(), 0..300)) {
        prop_assert!(decode::<Claim>(&bytes).is_err());
        prop_assert!(decode::<Reply>(&bytes).is_err());
        prop_assert!(decode::<Notice>(&bytes).is_err());
        prop_assert!(decode::<Status>(&bytes).is_err());
    }

    /// With a valid header, a decoded message has the size of the payload, within the widening of types.
    #[test]
    fn any_payload_is_read_or_refused_without_a_panic(payload in vec(any::<u8>(), 0..300)) {
        if let Ok(claim) = decode::<Claim>(&frame_with(&payload)) {
            prop_assert!(claim.encoded_size().unwrap() <= 9 * payload.len());
        }
    }

    #[test]
    fn a_mutated_frame_is_refused_or_read_but_never_panics(
        message in claim(), at in any::<prop::sample::Index>(), flip in 1..=255u8, cut in any::<prop::sample::Index>()
    ) {
        let mut frame = encode(&message).unwrap();
        let shorter = cut.index(frame.len());
        prop_assert!(decode::<Claim>(&frame[..shorter]).is_err());
        let at = at.index(frame.len());
        frame[at] ^= flip;
        let read = decode::<Claim>(&frame);
        if at < HEADER {
            prop_assert!(read.is_err());
        }
    }

    #[test]
    fn another_version_is_refused_by_name(message in reply(), theirs in any::<u16>()) {
        prop_assume!(theirs != PROTOCOL_VERSION);
        let mut frame = encode(&message).unwrap();
        frame[4..6].copy_from_slice(&theirs.to_le_bytes());
        let error = decode::<Reply>(&frame).unwrap_err();
        prop_assert_eq!(&error, &WireError::OtherVersion { theirs, ours: PROTOCOL_VERSION });
        let named = format!("version {theirs}");
        prop_assert!(error.to_string().contains(&named));
    }
}

#[test]
fn a_hostile_length_allocates_nothing() {
    // A worker name of 2^40 bytes, then a claim whose list of outcomes states 2^40 entries.
    let mut name = vec![253];
    name.extend_from_slice(&(1u64 << 40).to_le_bytes());
    let mut list = vec![1, b'w', 1, 1, 2, 2, 0, 253];
    list.extend_from_slice(&(1u64 << 40).to_le_bytes());
    for payload in [name, list] {
        let read = decode::<Claim>(&frame_with(&payload));
        assert!(matches!(read, Err(WireError::Malformed { message: "claim", .. })), "{read:?}");
    }
}

/// A text that states 100 000 bytes in a payload of ten is refused before memory is allocated.
#[test]
fn a_stated_length_is_checked_against_the_payload() {
    let mut name = vec![252];
    name.extend_from_slice(&100_000_u32.to_le_bytes());
    name.extend_from_slice(b"short");
    let Err(WireError::Malformed { reason, .. }) = decode::<Claim>(&frame_with(&name)) else { panic!() };
    assert!(reason.contains("LimitExceeded"), "{reason}");
}

#[test]
fn a_message_of_another_kind_is_named() {
    let error = decode::<Reply>(&encode(&empty_claim()).unwrap()).unwrap_err();
    assert_eq!(error, WireError::OtherKind { expected: "reply", found: Claim::KIND });
}

#[test]
fn trailing_bytes_are_refused() {
    let mut payload = encode(&empty_claim()).unwrap().split_off(HEADER);
    payload.push(0);
    assert!(matches!(decode::<Claim>(&frame_with(&payload)), Err(WireError::Length { .. })));
}

#[test]
fn numbers_that_are_not_finite_are_refused_both_ways() {
    let outcome = |wall, sample: Vec<f64>, history: f64| Outcome {
        task: Task {
            key: TaskKey { campaign: 1, task: 2 },
            attempt: 1,
            sample,
            with_first_cycle: false,
            accuracy: None,
            level: 0,
        },
        worker: "w/0".into(),
        wall,
        result: Ok(Evaluation {
            cycles: vec![1000, 2000],
            histories: vec![vec![0.5, history]],
            errors: vec![vec![0.0; 2]],
            start: vec![],
            joints: vec![],
            first_cycle: None,
            worn: None,
            diagnostics: Diagnostics::default(),
        }),
    };
    let mark = 1.234_567_890_123;
    for (place, good) in [("wall", outcome(mark, vec![2.0], 3.0)), ("sample", outcome(1.0, vec![mark], 3.0))]
        .into_iter()
        .chain([("histories", outcome(1.0, vec![2.0], mark))])
    {
        let mut frame = encode(&Claim { finished: vec![good], ..empty_claim() }).unwrap();
        let bits = mark.to_le_bytes();
        let at = frame.windows(8).position(|w| w == bits).unwrap();
        frame[at..at + 8].copy_from_slice(&f64::NAN.to_le_bytes());
        let error = decode::<Claim>(&frame).unwrap_err();
        assert!(matches!(&error, WireError::NotFinite(quantity) if quantity.contains(place)), "{error}");
    }
    let bad = Claim { finished: vec![outcome(1.0, vec![2.0], f64::INFINITY)], ..empty_claim() };
    assert_eq!(encode(&bad), Err(WireError::NotFinite("histories[0][1]".into())));
}

#[test]
fn issue_settings_that_exhaust_a_worker_passed_if_they_were_finite() {
    let order = |accuracy: Accuracy| {
        encode(&Reply {
            acknowledged: vec![],
            next: Next::Work(WorkOrder {
                subject: Subject::Scene(String::new()),
                accuracy,
                accuracy_name: String::new(),
                licensed: false,
                tasks: vec![],
            }),
        })
    };
    let good = Accuracy::balanced();
    assert!(order(good).is_ok());
    for (setting, bad) in [
        ("wear_samples", Accuracy { wear_samples: 1 << 40, ..good }),
        ("steps_bound", Accuracy { steps_bound: u64::MAX, ..good }),
        ("largest_step", Accuracy { largest_step: -1.0, ..good }),
        ("step_tolerance", Accuracy { step_tolerance: f64::NAN, ..good }),
        ("cycle_jump", Accuracy { cycle_jump: 0, ..good }),
    ] {
        assert_eq!(order(bad), Err(WireError::OutOfRange(setting)));
    }
}

#[test]
fn the_largest_message_passes_and_a_larger_one_does_not() {
    let reply = |bytes: usize| Reply {
        acknowledged: vec![],
        next: Next::Work(WorkOrder {
            subject: Subject::Scene("s".repeat(bytes)),
            accuracy: accuracy(1e-6),
            accuracy_name: String::new(),
            licensed: true,
            tasks: vec![],
        }),
    };
    let around = reply(1 << 20).encoded_size().unwrap() - (1 << 20);
    let largest = reply(MAX_PAYLOAD - around);
    assert_eq!(decode::<Reply>(&encode(&largest).unwrap()).unwrap(), largest);
    assert!(MAX_MESSAGE.parse::<usize>().unwrap() > HEADER + MAX_PAYLOAD + (64 << 10));
    assert_eq!(encode(&reply(MAX_PAYLOAD - around + 1)), Err(WireError::TooLarge(MAX_PAYLOAD + 1)));
}
