//! Messages on standard error.

use std::fmt::Display;
use std::io::Write;

/// Prints a message and a line break to standard error. If that is a closed pipe or a full disk, the study goes on: its results are in
/// its folder.
pub fn print_message(message: impl Display) {
    // There is no other place to report the failure at.
    let _ = writeln!(std::io::stderr().lock(), "{message}");
}
