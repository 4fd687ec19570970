//! Throws hostile payloads at the decoder of every message and reports what came of it: nothing may panic, and memory may
//! not grow.
//!
//! ```sh
//! cargo run --release -p common --example fuzz_wire -- 10000000
//! ```
//!
//! A third of the payloads are random bytes, most behind a sound header; a third are sound frames with up to eight bytes
//! changed, cut off or put in; a third are sound frames with lengths up to 2^64 - 1 written over some place. Every frame
//! goes to every decoder. The payloads follow from the seed (second argument, 1 unless given). Exit code 1 if the peak
//! of the memory grows by more than 64 MiB while the payloads are decoded: a hostile message may take what the largest
//! honest one takes, 16 MiB and what stands in it.

use common::failure::SimulationFailure;
use common::outputs::{CycleHistory, Diagnostics, Evaluation, JointSummary};
use common::wire::codec::HEADER;
use common::wire::{
    CandidatePoint, Claim, FarmStatus, Message, Next, Notice, Outcome, Reply, Status, Task, TaskKey,
    WorkerId, WorkerStatus, decode, encode,
};
use std::process::ExitCode;
use std::time::Instant;

/// Payloads unless told otherwise.
const PAYLOADS: u64 = 10_000_000;
/// By how much the peak of the memory may grow [kB].
const GROWTH: u64 = 64 << 10;

/// Splitmix64.
///
/// # Source
/// S. Vigna, 2015, public domain.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound.max(1) as u64) as usize
    }
}

/// One frame of each kind of message, some with much in it.
fn sound_frames() -> Vec<Vec<u8>> {
    let task = |task| Task {
        key: TaskKey { campaign: 0xfeed_beef_dead_cafe, task },
        attempt: 2,
        sample: vec![0.04, 1.5e-3, -0.25],
        with_first_cycle: task == 0,
        accuracy: None,
    };
    let evaluation = Evaluation {
        cycles: vec![1000, 2000, 3000],
        histories: vec![vec![1e-6, 2e-6, 3e-6]; 2],
        errors: vec![vec![1e-9; 3]; 2],
        joints: vec![JointSummary { name: "crank".into(), peak_force: 55.0, wear_depth: vec![1e-7; 36] }],
        first_cycle: Some(CycleHistory {
            time: vec![0.0, 0.1],
            motion: vec![],
            bodies: vec![],
            joint_force: vec![("crank".into(), vec![1.0, 2.0])],
        }),
        worn: None,
        diagnostics: Diagnostics::default(),
    };
    let failure = SimulationFailure::Panicked { message: "index out of bounds".into() };
    let outcome = |result| Outcome { task: task(3), worker: "host-1/0".into(), wall: 0.3, result };
    let claim = Claim {
        worker: WorkerId { name: "host-1".into(), epoch: 1 << 60 },
        sequence: 9,
        slots: 2,
        credits: 6,
        holding: (0..9).map(|k| task(k).key).collect(),
        finished: vec![outcome(Ok(evaluation)), outcome(Err(failure))],
        leaving: false,
    };
    let bare = Claim { holding: vec![], finished: vec![], ..claim.clone() };
    let reply = Reply { acknowledged: vec![task(1).key], next: Next::Idle { ask_again: 1000 } };
    let points = (0..9).map(|task| CandidatePoint { task, sample: vec![1.0, 2.0] }).collect();
    let notice = Notice::Batch { campaign: 7, points };
    let worker = WorkerStatus { name: "host-1".into(), slots: 2, under_way: 6, done: 80, rate: 1.25 };
    let farm = FarmStatus { queued: 3, under_way: 6, rate: 2.5, workers: vec![worker; 4] };
    let status = Status { farm, program: "0.1.0".into(), ..Status::default() };
    let frames = [encode(&claim), encode(&bare), encode(&reply), encode(&notice), encode(&status)];
    frames.map(|frame| frame.expect("a sound message can be encoded")).into()
}

/// States the length that is there, so that the decoder reads what stands behind the header.
fn with_true_length(frame: &mut [u8]) {
    if let Some(payload) = frame.len().checked_sub(HEADER) {
        frame[8..12].copy_from_slice(&(payload as u32).to_le_bytes());
    }
}

fn random_bytes(random: &mut Random, sound: &[Vec<u8>], frame: &mut Vec<u8>) {
    let length = random.below(300);
    frame.extend((0..length).map(|_| random.next() as u8));
    if random.below(8) > 0 && length >= HEADER {
        let header = &sound[random.below(sound.len())][..HEADER];
        frame[..HEADER].copy_from_slice(header);
        with_true_length(frame);
    }
}

fn mutated(random: &mut Random, sound: &[Vec<u8>], frame: &mut Vec<u8>) {
    frame.extend_from_slice(&sound[random.below(sound.len())]);
    for _ in 0..=random.below(8) {
        // The header stays as it is most of the time: behind it lies what can go wrong.
        let from = if random.below(16) == 0 { 0 } else { HEADER };
        let at = from + random.below(frame.len().saturating_sub(from));
        match random.below(4) {
            0 => frame.truncate(at),
            1 => frame.insert(at.min(frame.len()), random.next() as u8),
            _ if at < frame.len() => frame[at] = random.next() as u8,
            _ => {}
        }
    }
    if random.below(8) > 0 {
        with_true_length(frame);
    }
}

fn hostile_lengths(random: &mut Random, sound: &[Vec<u8>], frame: &mut Vec<u8>) {
    frame.extend_from_slice(&sound[random.below(sound.len())]);
    let at = HEADER + random.below(frame.len() - HEADER);
    // The decoder's own marks of integers of two, four and eight bytes.
    let stated = random.next() >> random.below(64);
    let bytes = stated.to_le_bytes();
    let (mark, width) = [(251, 2), (252, 4), (253, 8)][random.below(3)];
    let written = [&[mark], &bytes[..width]].concat();
    let end = (at + random.below(written.len() + 1)).min(frame.len());
    frame.splice(at..end, written);
    with_true_length(frame);
}

/// Which decoders take the frame.
fn taken(frame: &[u8]) -> u64 {
    fn one<M: Message>(frame: &[u8]) -> u64 {
        u64::from(decode::<M>(frame).is_ok())
    }
    one::<Claim>(frame) + one::<Reply>(frame) + one::<Notice>(frame) + one::<Status>(frame)
}

/// Peak and present size of this process in memory [kB]; `None` where the system does not tell.
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
    let mut random = Random(seed);
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
                println!("memory has grown by more than {GROWTH} kB");
                return ExitCode::FAILURE;
            }
        }
        _ => println!("memory: this system does not tell"),
    }
    ExitCode::SUCCESS
}
