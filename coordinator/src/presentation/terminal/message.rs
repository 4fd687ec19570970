//! Messages on standard error.

use std::fmt::Display;
use std::io::Write;

/// Prints a message in a line of its own on standard error. A closed pipe or a full disk behind standard error does not end a
/// study: its results are in its folder.
pub fn print_message(message: impl Display) {
    // There is no other place to report the failure at.
    let _ = writeln!(std::io::stderr().lock(), "{message}");
}
