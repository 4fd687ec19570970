//! The progress of a study on a narrow terminal: what matters most is seen, and rounds leave their lines.

use std::process::Command;

#[test]
fn a_terminal_of_80_columns_shows_time_rate_and_error() {
    let folder = tempfile::tempdir().unwrap();
    let run = format!(
        "stty cols 80 rows 24; {} run --scene four-bar --accuracy draft --initial 12 --max-evaluations 40 --out {}",
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
    // Frames of the bar, one over the other, without their control sequences.
    let frames: Vec<&str> = shown
        .split(['\r', '\n', '\u{1b}'])
        .map(|frame| frame.strip_prefix("[2K").unwrap_or(frame))
        .filter(|frame| frame.contains(" left, "))
        // The line of a round is filled with spaces, and the bar follows it.
        .filter_map(|frame| frame.trim_end().rsplit("   ").next().map(str::trim))
        .collect();
    assert!(!frames.is_empty(), "{shown}");
    for frame in &frames {
        assert!(frame.chars().count() <= 80, "{frame}");
        assert!(frame.contains("/40 evaluations, at most ") && frame.contains("/s"), "{frame}");
    }
    assert!(frames.iter().any(|frame| frame.contains("/s, error ")), "{frames:#?}");
    assert!(shown.contains("round 0: 12 evaluations, R("), "{shown}");
}
