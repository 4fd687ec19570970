//! The progress of a study on a narrow terminal: what matters most is seen, and rounds leave their lines; and
//! output that cannot be written.

use std::path::Path;
use std::process::Command;

#[test]
fn a_terminal_of_80_columns_shows_time_rate_and_error() {
    let folder = tempfile::tempdir().unwrap();
    let run = format!(
        "stty cols 80 rows 24; {} run four-bar --levels draft --initial 12 --max-evaluations 40 --out {}",
        env!("CARGO_BIN_EXE_coordinator"),
        folder.path().join("study").display()
    );
    // A pseudo-terminal by `script` of util-linux.
    let Ok(output) = Command::new("script").args(["-qec", &run, "/dev/null"]).output() else {
        eprintln!("not checked: the progress on a terminal: there is no `script`");
        return;
    };
    let shown = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{shown}");
    // Frames of the bar, one over the other, without their control sequences. The bar follows the line of a round, which is filled
    // with spaces.
    let frames = shown
        .split(['\r', '\n', '\u{1b}'])
        .map(|frame| frame.strip_prefix("[2K").unwrap_or(frame))
        .flat_map(|frame| frame.trim_end().split("   "))
        .map(str::trim);
    let (mut checked, mut with_error, mut round_ended) = (0, 0, false);
    for frame in frames {
        round_ended |= frame.starts_with("round 0: 12 evaluations, R(");
        let Some((before, _)) = frame.split_once("/40 evaluations") else { continue };
        assert!(frame.chars().count() <= 80, "{frame}");
        let done = before.rsplit(' ').next().and_then(|done| done.parse::<u32>().ok());
        // Before the first result there is no rate; after the last one nothing is left.
        if done.is_none_or(|done| done == 0 || done == 40) || frame.contains("computing the results") {
            continue;
        }
        // Once the whole budget is under way, the time left is no bound.
        let is_bound = done.is_none_or(|done| done < 36);
        assert!(!is_bound || frame.contains(", at most "), "{frame}");
        assert!(frame.contains(" left, ") && frame.contains("/s"), "{frame}");
        assert!(!round_ended || frame.contains("/s, error "), "{frame}");
        checked += 1;
        with_error += u32::from(round_ended);
    }
    assert!(round_ended && checked >= 3 && with_error >= 1, "{checked} {with_error}\n{shown}");
}

#[test]
fn issue_a_full_disk_was_no_error() {
    let full = Path::new("/dev/full");
    if !full.exists() {
        return;
    }
    let simulate = |options: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_coordinator"));
        command.args(["simulate", "four-bar", "--accuracy", "draft"]).args(options);
        command
    };
    let mut to_standard_output = simulate(&[]);
    to_standard_output.stdout(std::fs::File::options().write(true).open(full).unwrap());
    for (mut command, place) in [
        (simulate(&["--out", "/dev/full"]), "/dev/full: "),
        (simulate(&["--report", "/dev/full"]), "/dev/full: "),
        (to_standard_output, "standard output: "),
    ] {
        let output = command.output().unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0), "{message}");
        assert!(message.starts_with(&format!("error: {place}No space left")), "{message}");
    }
}
