//! Checks command lines of documents and unit files with the programs.

use std::path::Path;
use std::process::Command;

/// Error message of the program for these arguments; `None` if it accepts them. The arguments are parsed, then `--help` ends
/// the program. Commands, options and their values are checked; missing arguments are not.
pub fn objection(program: &Path, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).arg("--help").output().expect("the program starts");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    (!output.status.success()).then(|| format!("{} {}: {said}", program.display(), arguments.join(" ")))
}

/// Words of a shell command, without redirection of its output. Quoted words stay together.
pub fn words(line: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut quote = None;
    for c in line.chars() {
        match (quote, c) {
            (Some(open), c) if c == open => quote = None,
            (None, '\'' | '"') => quote = Some(c),
            (None, c) if c.is_whitespace() => words.push(String::new()),
            (_, c) => words.last_mut().expect("it is never empty").push(c),
        }
    }
    words.retain(|word| !word.is_empty());
    if let Some(at) = words.iter().position(|word| word == ">") {
        words.truncate(at);
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_split_as_in_a_shell() {
        let found = words("coordinator simulate --set speed='500 r/min'  --json > \"my file\"");
        assert_eq!(found, ["coordinator", "simulate", "--set", "speed=500 r/min", "--json"]);
    }
}
