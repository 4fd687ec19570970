//! Many commands that make no sense: each ends with exit code 2 and one message, and leaves nothing behind.

use std::path::Path;
use std::process::Command;

/// Least number of different commands that are tried.
const COMMANDS: usize = 60;

/// Arguments, separated by spaces, and a piece of the message. `DIR` is an empty folder, `FILE` a file that is no scene.
const NONSENSE: [(&str, &str); 61] = [
    ("frobnicate", "frobnicate"),
    ("simulat", "simulate"),
    ("--frobnicate", "--frobnicate"),
    ("--workers many", "--workers"),
    ("--workers -1", "--workers"),
    ("--workers 5000", "--workers"),
    ("run flaping-wing", "flapping-wing"),
    ("run no/such.toml", "cannot be read"),
    ("run FILE", "FILE"),
    ("run pendulum", "pendulum"),
    ("run --accuracy exact", "--accuracy"),
    ("run --accuracy draft+jump-x", "--accuracy"),
    ("run --accuracy draft --max-error 1%", "--max-error"),
    ("run --max-error 0", "--max-error"),
    ("run --max-error much", "--max-error"),
    ("run --method guess", "--method"),
    ("run --samples 0", "--samples"),
    ("run --samples many", "--samples"),
    ("run --initial 1 four-bar", "initial"),
    ("run --max-evaluations 0", "--max-evaluations"),
    ("run --seed -5", "--seed"),
    ("run --seed one", "--seed"),
    ("run --target-error -1", "--target-error"),
    ("run --target-error nan", "--target-error"),
    ("run --live port four-bar", "--live"),
    ("run --live 0.0.0.0:80 four-bar", "--live"),
    ("run --live-keep", "--live"),
    ("run --listen nowhere --workers 0 four-bar", "--listen"),
    ("run --listen tcp/0.0.0.0:0 --workers 0 four-bar", "--insecure"),
    ("run --config no.json5 --workers 0 four-bar", "no.json5"),
    ("run --set friction four-bar", "friction"),
    ("run --design friction=2..1 four-bar", "friction"),
    ("run --log-format xml", "--log-format"),
    ("run --quiet -v", "--quiet"),
    ("resume", "<DIR>"),
    ("resume DIR", "holds no study"),
    ("resume no/such", "no/such"),
    ("simulate four-bar --set load_torqe=1", "load_torque"),
    ("simulate four-bar --set friction=-0.1", "friction"),
    ("simulate four-bar --set friction=0.1 --set friction=0.2", "twice"),
    ("simulate four-bar --out no/such/one.json", "no/such"),
    ("simulate four-bar --report DIR", "is a folder"),
    ("simulate --max-error half", "--max-error"),
    ("check four-bar --scene pendulum", "cannot be used with"),
    ("check no-such-scene", "no such scene"),
    ("check FILE", "FILE"),
    ("check four-bar --draw no/such/one.svg", "no/such"),
    ("draw four-bar --phase 2", "--phase"),
    ("draw four-bar --out no/such/one.svg", "no/such"),
    ("explain five-bar", "four-bar"),
    ("scenes --show five-bar", "four-bar"),
    ("init four/bar.toml", "four/bar"),
    ("report DIR", "holds no study"),
    ("sensitivity DIR", "holds no study"),
    ("compare DIR", "<DIR>"),
    ("what-if DIR --set friction.mean=0.1", "DIR"),
    ("optimise DIR --problem no.toml", "no"),
    ("update DIR --measured no.csv", "no"),
    ("tradeoff --out x --setting draft --settings quick", "--setting"),
    ("status nowhere-at-all", "nowhere-at-all"),
    ("completions tcsh", "tcsh"),
];

#[test]
fn every_nonsense_command_ends_with_2_and_one_message() {
    const { assert!(NONSENSE.len() >= COMMANDS) };
    let folder = tempfile::tempdir().unwrap();
    let empty = folder.path().join("empty");
    let file = folder.path().join("scene.txt.toml");
    std::fs::create_dir(&empty).unwrap();
    std::fs::write(&file, "this is no scene").unwrap();
    let failed: Vec<String> = NONSENSE
        .iter()
        .filter_map(|(line, says)| Some(format!("`{line}`: {}", ended(folder.path(), line, says).err()?)))
        .collect();
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), NONSENSE.len(), failed.join("\n"));
    let mut left: Vec<_> =
        std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["empty", "scene.txt.toml"]);
    assert_eq!(std::fs::read_dir(&empty).unwrap().count(), 0);
}

/// Runs a command in a folder; an error if it does not end as bad input does.
fn ended(folder: &Path, line: &str, says: &str) -> Result<(), String> {
    let shown = |text: &str| text.replace("DIR", "empty").replace("FILE", "scene.txt.toml");
    let arguments: Vec<String> = line.split(' ').map(shown).collect();
    let output = Command::new(env!("CARGO_BIN_EXE_coordinator"))
        .args(&arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    let says = if says.starts_with('<') { says.to_owned() } else { shown(says) };
    if output.status.code() != Some(2) {
        return Err(format!("exit {:?}: {message}", output.status.code()));
    }
    if !output.stdout.is_empty() {
        return Err(format!("prints {}", String::from_utf8_lossy(&output.stdout)));
    }
    if message.matches("error: ").count() != 1 {
        return Err(format!("not one message: {message}"));
    }
    if !message.contains(&says) {
        return Err(format!("no \"{says}\" in {message}"));
    }
    Ok(())
}
