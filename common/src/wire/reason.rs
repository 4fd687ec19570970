//! Text of a Zenoh error without the source location in Zenoh, which is of no use to users.

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

#[cfg(test)]
mod tests {
    use super::reason;

    #[test]
    fn source_locations_are_removed() {
        let error =
            "Unable to connect to any of [tcp/127.0.0.1:9] at /home/a/.cargo/registry/zenoh-1/src/net.rs:42.";
        assert_eq!(reason(error), "Unable to connect to any of [tcp/127.0.0.1:9]");
        let chain = "no link at /x/y.rs:1. - Caused by refused at /z.rs:22.";
        assert_eq!(reason(chain), "no link. - Caused by refused");
        assert_eq!(reason("no such file at /tmp"), "no such file at /tmp");
    }
}
