//! A user's own program on worker processes that have it themselves: losses, and licences.
//! `cargo build --release --workspace --bins && cargo run --release -p tests --example external_workers`

use tests::beam_study::{BeamReport, BeamStudy};

/// Time of one evaluation [s].
const SECONDS: f64 = 0.2;
/// Evaluations of each study.
const EVALUATIONS: u64 = 400;

fn main() {
    println!("| workers | time [s] | of the ideal | most at once | same bits | evaluations by worker |");
    println!("|---|---|---|---|---|---|");
    let study = || tempfile::tempdir().expect("there is room for a folder");
    let folder = study();
    let report = BeamStudy::new(folder.path(), SECONDS).with_losses(EVALUATIONS, SECONDS);
    print("3 of 2 slots, one killed; one without the program, one with another version", &report);
    let folder = study();
    let report = BeamStudy::new(folder.path(), SECONDS).with_licences(EVALUATIONS, SECONDS);
    print("4 of 2 slots, 3 licences", &report);
}

fn print(workers: &str, report: &BeamReport) {
    println!(
        "| {workers} | {:.2} | {:.1} % | {} | {} | {:?} |",
        report.took,
        100.0 * report.share(),
        report.most_at_once,
        if report.same_bits { "yes" } else { "NO" },
        report.by_worker
    );
}
