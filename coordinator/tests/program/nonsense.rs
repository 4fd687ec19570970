//! Many commands that make no sense: each ends with exit code 2 and one message, and leaves nothing behind.

use std::path::Path;
use std::process::Command;

/// Least number of different commands that are tried.
const COMMANDS: usize = 60;

#[test]
fn every_nonsense_command_ends_with_2_and_one_message() {
    let folder = tempfile::tempdir().unwrap();
    let empty = folder.path().join("empty");
    let file = folder.path().join("scene.txt.toml");
    std::fs::create_dir(&empty).unwrap();
    std::fs::write(&file, "this is no scene").unwrap();
    let nonsense = crate::rows::<2>("nonsense");
    assert!(nonsense.len() >= COMMANDS);
    let failed: Vec<String> = nonsense
        .iter()
        .filter_map(|[line, says]| Some(format!("`{line}`: {}", ended(folder.path(), line, says).err()?)))
        .collect();
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), nonsense.len(), failed.join("\n"));
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
