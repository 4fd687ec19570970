//! The front page is short, shows what is promised, and prints what the program prints.

use crate::markdown::{read, shown_lines};
use crate::quick_study;

/// Digital object identifier of the publication that the model and the default study follow.
const SEED_PAPER: &str = "10.3969/j.issn.1004-132X.2026.06.020";

#[test]
fn the_front_page_fits_two_screens() {
    let readme = read("README.md");
    let lines = readme.lines().count();
    assert!(lines <= 150 && readme.len() <= 9000, "{lines} lines, {} bytes", readme.len());
}

#[test]
fn the_front_page_opens_with_its_two_commands_and_ci_runs_the_second() {
    let readme = read("README.md");
    let opening = readme.lines().take(40).collect::<Vec<_>>().join("\n");
    let shown = shown_lines(&opening);
    let main_job = "cargo run --release -p coordinator -- --workers auto";
    let tests = "cargo test --release --workspace";
    assert!(shown.contains(&main_job) && shown.contains(&tests), "{shown:?}");
    assert!(read(".ci/run").lines().any(|line| line == tests), ".ci/run does not run `{tests}`");
    assert!(opening.contains(".svg)") || opening.contains(".png)"), "no picture");
    assert!(opening.contains("Nothing calibrated is a prediction"), "the first limit is not in sight");
}

#[test]
fn the_seed_paper_is_cited_wherever_its_results_are_used() {
    let validation = "coordinator/doc/validation.md";
    for file in ["README.md", "common/scenes/flapping-wing.toml", validation] {
        assert!(read(file).contains(SEED_PAPER), "{file} does not cite {SEED_PAPER}");
    }
}

/// Words of the lines that have any, without numbers: these may differ in the last digit between processors.
fn wording(lines: &[&str]) -> Vec<Vec<String>> {
    let words = |line: &&str| {
        let letters: String = line.chars().map(|c| if c.is_alphabetic() { c } else { ' ' }).collect();
        letters.split_whitespace().map(str::to_owned).collect::<Vec<_>>()
    };
    lines.iter().map(words).filter(|words| !words.is_empty()).collect()
}

#[test]
fn the_output_shown_is_that_of_the_command_shown() {
    let readme = read("README.md");
    let command = quick_study::COMMAND.join(" ");
    let shown = shown_lines(&readme);
    assert!(
        shown.contains(&format!("target/release/coordinator {command}").as_str()),
        "{command} is not shown"
    );
    let output =
        readme.split("```text\n").nth(1).and_then(|rest| rest.split("```").next()).expect("an output");
    let printed = wording(&quick_study::followed().printed.lines().collect::<Vec<_>>());
    for line in wording(&output.lines().collect::<Vec<_>>()) {
        assert!(printed.contains(&line), "the program does not print {line:?} but {printed:?}");
    }
}
