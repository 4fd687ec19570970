//! Messages on standard error.

use std::fmt::Display;
use std::io::Write;

/// Prints a message and a line break to standard error. If that is a closed pipe or a full disk, the study goes on: its results are in
/// its folder.
pub fn print_message(message: impl Display) {
    // There is no other place to report the failure at.
    let _ = writeln!(std::io::stderr().lock(), "{}", printable(&message.to_string()));
}

/// A text with U+FFFD for control characters: texts of workers and of people's programs are in messages, and a terminal would obey them.
fn printable(text: &str) -> String {
    text.replace(|c: char| c.is_control() && !matches!(c, '\n' | '\t'), "\u{fffd}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issue_texts_of_workers_reached_the_terminal_as_commands() {
        assert_eq!(
            printable("\u{1b}[2J\u{1b}]0;pwned\u{7} no\tresult\n"),
            "\u{fffd}[2J\u{fffd}]0;pwned\u{fffd} no\tresult\n"
        );
    }
}
