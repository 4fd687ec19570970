//! What is logged of a failure of the messaging: the text of a Zenoh error without the source location in Zenoh, which is of no use to users, and a
//! few of many refused messages.

use std::fmt::Display;

/// Text of an error without its ` at /path/file.rs:line` parts.
pub fn reason(error: impl Display) -> String {
    let text = error.to_string();
    let mut pieces = text.split(" at /");
    let mut plain = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        match piece.split_once(".rs:") {
            Some((_, rest)) => plain += rest.trim_start_matches(|c: char| c.is_ascii_digit()),
            None => plain = format!("{plain} at /{piece}"),
        }
    }
    plain.trim_end_matches('.').to_owned()
}

/// Number of refused messages of one kind. They are logged at the first, second, fourth, ... time: a flood must not fill the log.
#[derive(Debug, Clone, Copy, Default)]
pub struct Refused(u64);

impl Refused {
    /// Counts a message; returns the number so far if it is to be logged.
    pub fn count(&mut self) -> Option<u64> {
        self.0 = self.0.saturating_add(1);
        self.0.is_power_of_two().then_some(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn source_locations_are_removed() {
        let error =
            "Unable to connect to any of [tcp/127.0.0.1:9] at /home/a/.cargo/registry/zenoh-1/src/net.rs:42.";
        assert_eq!(reason(error), "Unable to connect to any of [tcp/127.0.0.1:9]");
        let chain = "no link at /x/y.rs:1. - Caused by refused at /z.rs:22.";
        assert_eq!(reason(chain), "no link. - Caused by refused");
        assert_eq!(reason("no such file at /tmp"), "no such file at /tmp");
    }

    #[test]
    fn a_flood_is_logged_a_few_times() {
        let mut refused = Refused::default();
        let logged: Vec<u64> = (0..1000).filter_map(|_| refused.count()).collect();
        assert_eq!(logged, [1, 2, 4, 8, 16, 32, 64, 128, 256, 512]);
    }
}
