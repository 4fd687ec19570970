//! Fuzz test of the decoder of every message: hostile payloads must neither cause a panic nor let memory grow.
//!
//! ```sh
//! cargo run --release -p common --example fuzz_wire -- 10000000
//! ```
//!
//! A third of the payloads are random bytes, most of them after a valid header; a third are valid frames with up to eight
//! bytes changed, removed or inserted; a third are valid frames with a length up to 2^64 - 1 written at a random position.
//! Every frame is passed to every decoder. The payloads follow from the seed (second argument, default 1). The exit code
//! is 1 if the peak memory grows by more than 64 MiB during decoding: a hostile message may take as much as the largest
//! valid one, 16 MiB and its decoded contents.

use common::external::SimulatorId;
use common::failure::SimulationFailure;
use common::outputs::{CycleHistory, Diagnostics, Evaluation, JointSummary};
use common::wire::codec::HEADER;
use common::wire::{
    Claim, FarmStatus, Message, Next, Notice, Offers, Outcome, Reply, Status, Task, TaskKey, WorkerId,
    WorkerStatus, decode, encode,
};
use rand::{Rng, RngExt};
use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use std::process::ExitCode;
use std::time::Instant;

/// Default number of payloads.
const PAYLOADS: u64 = 10_000_000;
/// Largest growth of the peak memory [kB].
const GROWTH: u64 = 64 << 10;

/// One frame of each kind of message, some of them large.
fn sound_frames() -> Vec<Vec<u8>> {
    let task = |task| Task {
        key: TaskKey { campaign: 0xfeed_beef_dead_cafe, task },
        attempt: 2,
        sample: vec![0.04, 1.5e-3, -0.25],
        with_first_cycle: task == 0,
        accuracy: None,
        level: 0,
    };
    let evaluation = Evaluation {
        cycles: vec![1000, 2000, 3000],
        histories: vec![vec![1e-6, 2e-6, 3e-6]; 2],
        errors: vec![vec![1e-9; 3]; 2],
        start: vec![Some(0.0), None],
        joints: vec![JointSummary {
            name: "crank".into(),
            peak_force: 55.0,
            wear_depth: vec![1e-7; 36],
            journal_wear_depth: vec![],
        }],
        first_cycle: Some(CycleHistory {
            time: vec![0.0, 0.1],
            joint_force: vec![("crank".into(), vec![1.0, 2.0])],
            ..CycleHistory::default()
        }),
        worn: None,
        diagnostics: Diagnostics::default(),
    };
    let failure = SimulationFailure::Panicked { message: "index out of bounds".into() };
    let outcome = |result| Outcome { task: task(3), worker: "host-1/0".into(), wall: 0.3, result };
    let claim = Claim {
        worker: WorkerId { name: "host-1".into(), epoch: 1 << 60 },
        sequence: 9,
        offers: Offers::Simulators(vec![SimulatorId { scene: "beam".into(), digest: 1 << 100 }]),
        slots: 2,
        credits: 6,
        holding: (0..9).map(|k| task(k).key).collect(),
        finished: vec![outcome(Ok(evaluation)), outcome(Err(failure))],
        leaving: false,
    };
    let bare = Claim { holding: vec![], finished: vec![], ..claim.clone() };
    let reply = Reply { acknowledged: vec![task(1).key], next: Next::Idle { ask_again: 1000 } };
    let points = (0..9).map(|task| (task, vec![1.0, 2.0])).collect();
    let notice = Notice::Batch { campaign: 7, points };
    let worker = WorkerStatus { name: "host-1".into(), slots: 2, under_way: 6, done: 80, rate: 1.25 };
    let farm = FarmStatus { queued: 3, under_way: 6, rate: 2.5, workers: vec![worker; 4] };
    let status = Status { farm, program: "0.1.0".into(), ..Status::default() };
    let frames = [encode(&claim), encode(&bare), encode(&reply), encode(&notice), encode(&status)];
    frames.map(|frame| frame.expect("a sound message can be encoded")).into()
}

/// Writes the true length into the header, so that the decoder reads the payload.
fn with_true_length(frame: &mut [u8]) {
    if let Some(payload) = frame.len().checked_sub(HEADER) {
        frame[8..12].copy_from_slice(&(payload as u32).to_le_bytes());
    }
}

fn random_bytes(random: &mut ChaCha12Rng, sound: &[Vec<u8>], frame: &mut Vec<u8>) {
    let length = random.random_range(0..300);
    frame.extend((0..length).map(|_| random.next_u64() as u8));
    if random.random_range(0..8) > 0 && length >= HEADER {
        let header = &sound[random.random_range(0..sound.len())][..HEADER];
        frame[..HEADER].copy_from_slice(header);
        with_true_length(frame);
    }
}

fn mutated(random: &mut ChaCha12Rng, sound: &[Vec<u8>], frame: &mut Vec<u8>) {
    frame.extend_from_slice(&sound[random.random_range(0..sound.len())]);
    for _ in 0..=random.random_range(0..8) {
        // The header is changed rarely, so that most frames reach the decoding of their payload.
        let from = if random.random_range(0..16) == 0 { 0 } else { HEADER };
        let at = from + random.random_range(0..frame.len().saturating_sub(from).max(1));
        match random.random_range(0..4) {
            0 => frame.truncate(at),
            1 => frame.insert(at.min(frame.len()), random.next_u64() as u8),
            _ if at < frame.len() => frame[at] = random.next_u64() as u8,
            _ => {}
        }
    }
    if random.random_range(0..8) > 0 {
        with_true_length(frame);
    }
}

fn hostile_lengths(random: &mut ChaCha12Rng, sound: &[Vec<u8>], frame: &mut Vec<u8>) {
    frame.extend_from_slice(&sound[random.random_range(0..sound.len())]);
    let at = HEADER + random.random_range(0..frame.len() - HEADER);
    // The marks of bincode for integers of two, four and eight bytes.
    let stated = random.next_u64() >> random.random_range(0..64);
    let bytes = stated.to_le_bytes();
    let (mark, width) = [(251, 2), (252, 4), (253, 8)][random.random_range(0..3)];
    let written = [&[mark], &bytes[..width]].concat();
    let end = (at + random.random_range(0..written.len() + 1)).min(frame.len());
    frame.splice(at..end, written);
    with_true_length(frame);
}

/// Number of decoders that accept the frame.
fn taken(frame: &[u8]) -> u64 {
    fn one<M: Message>(frame: &[u8]) -> u64 {
        u64::from(decode::<M>(frame).is_ok())
    }
    one::<Claim>(frame) + one::<Reply>(frame) + one::<Notice>(frame) + one::<Status>(frame)
}

/// Peak and present memory of this process [kB]; `None` on systems without `/proc`.
fn memory() -> Option<(u64, u64)> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let value = |key: &str| -> Option<u64> {
        status.lines().find_map(|line| line.strip_prefix(key))?.split_whitespace().next()?.parse().ok()
    };
    Some((value("VmHWM:")?, value("VmRSS:")?))
}

fn main() -> ExitCode {
    let numbers: Result<Vec<u64>, _> = std::env::args().skip(1).map(|text| text.parse()).collect();
    let (payloads, seed) = match numbers.as_deref() {
        Ok([]) => (PAYLOADS, 1),
        Ok([payloads]) => (*payloads, 1),
        Ok([payloads, seed]) => (*payloads, *seed),
        _ => {
            eprintln!("usage: fuzz_wire [PAYLOADS [SEED]], whole numbers");
            return ExitCode::from(2);
        }
    };
    let sound = sound_frames();
    let mut random = ChaCha12Rng::seed_from_u64(seed);
    let mut frame = Vec::with_capacity(1 << 14);
    let (mut bytes, mut read) = ([0u64; 3], [0u64; 3]);
    let before = memory();
    let begun = Instant::now();
    for k in 0..payloads {
        let kind = (k % 3) as usize;
        frame.clear();
        [random_bytes, mutated, hostile_lengths][kind](&mut random, &sound, &mut frame);
        bytes[kind] += frame.len() as u64;
        read[kind] += taken(&frame);
    }
    let seconds = begun.elapsed().as_secs_f64();
    println!("{payloads} payloads, seed {seed}, each to 4 decoders: no panic");
    for (kind, name) in ["random bytes", "changed frames", "hostile lengths"].into_iter().enumerate() {
        println!("  {name:16} {:>7} MB, {} were readable", bytes[kind] / 1_000_000, read[kind]);
    }
    println!("{:.1} s, {:.0} payloads/s", seconds, payloads as f64 / seconds);
    match (before, memory()) {
        (Some((before, _)), Some((peak, now))) => {
            println!("memory: peak {before} kB before, {peak} kB after ({now} kB now)");
            if peak > before + GROWTH {
                println!("peak memory grew by more than {GROWTH} kB");
                return ExitCode::FAILURE;
            }
        }
        _ => println!("memory: not available on this system"),
    }
    ExitCode::SUCCESS
}
