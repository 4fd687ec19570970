//! Faults for people: each as its message, its place, the line and carets under the piece, as compilers print them.

use super::faults::{Fault, FaultKind, Faults};
use std::fmt::Write;

impl Faults {
    /// The faults with an excerpt of the file each, and their number if there are several. Faults of one parameter, wherever it is
    /// used, are one.
    ///
    /// ```
    /// use common::scene::SceneSource;
    ///
    /// let text = "[scene]\nname = \"press\"\n[life]\ncycles = 0\n";
    /// let faults = SceneSource::parse(text, "press.toml").unwrap_err();
    /// assert!(faults.explained().contains(
    ///     "error: life.cycles: 0 is out of range, allowed: 1 to 100000000\n \
    ///      --> press.toml:4:10\n  |\n4 | cycles = 0\n  |          ^\n"
    /// ));
    /// ```
    pub fn explained(&self) -> String {
        let mut text = String::new();
        let mut shown: Vec<&Fault> = Vec::new();
        for fault in &self.0 {
            if shown.iter().any(|other| is_repeated(other, fault)) {
                continue;
            }
            shown.push(fault);
            if !text.is_empty() {
                text.push('\n');
            }
            let others = self.0.iter().filter(|other| is_repeated(fault, other) && other.key != fault.key);
            // Writing to a String cannot fail.
            let _ = write!(text, "error: {}", one(fault, others));
        }
        if shown.len() > 1 {
            let _ = write!(text, "\nerror: {} faults\n", shown.len());
        }
        text
    }
}

/// True if two faults of different keys have their cause in one parameter.
fn is_repeated(one: &Fault, other: &Fault) -> bool {
    one.used_at.is_some()
        && other.used_at.is_some()
        && one.location == other.location
        && one.kind == other.kind
}

/// A fault with its excerpt; `others` have the same cause.
fn one<'f>(fault: &Fault, others: impl Iterator<Item = &'f Fault>) -> String {
    let Some(location) = &fault.location else { return format!("{fault}\n") };
    let headline = match &fault.kind {
        FaultKind::Syntax { message, .. } => message.clone(),
        kind if fault.key.is_empty() => kind.to_string(),
        kind => format!("{}: {kind}", fault.key),
    };
    let mut text = format!("{headline}\n{}\n", location.excerpt());
    let margin = " ".repeat(location.line.to_string().len());
    if let Some(used) = &fault.used_at {
        let _ = writeln!(text, "{margin} = {} {used}: {}", fault.kind.related(), used.text.trim());
    }
    for other in others {
        if let Some(used) = &other.used_at {
            let _ = writeln!(text, "{margin} = used at {used}: {}: {}", other.key, used.text.trim());
        }
    }
    text
}
