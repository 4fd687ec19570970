//! Key expressions, each built in one place.

use super::message::WorkerId;

/// Queries of workers that ask for tasks and hand in outcomes.
pub const CLAIM: &str = "hingewise/claim";

/// What the coordinator announces to all workers.
pub const NOTICE: &str = "hingewise/notice";

/// Queries of whoever wants to know how a study is getting on.
pub const STATUS: &str = "hingewise/status";

/// The liveliness tokens of all workers.
pub const ALIVE_ALL: &str = "hingewise/alive/*/*";

/// Liveliness token of the coordinator.
pub const COORDINATOR: &str = "hingewise/coordinator";

const ALIVE: &str = "hingewise/alive/";

/// Longest name of a worker [bytes].
pub const LONGEST_NAME: usize = 100;

/// Liveliness token of one epoch (one start) of a worker.
pub fn alive(worker: &WorkerId) -> String {
    format!("{ALIVE}{}/{}", worker.name, worker.epoch)
}

/// The worker a liveliness token belongs to; `None` if the key is not one of ours.
pub fn worker_of(key: &str) -> Option<WorkerId> {
    let (name, epoch) = key.strip_prefix(ALIVE)?.split_once('/')?;
    let epoch = epoch.parse().ok()?;
    is_worker_name(name).then(|| WorkerId { name: name.to_owned(), epoch })
}

/// Whether `name` can stand in a key: letters, digits, `-`, `_`, `.`; 1 to [`LONGEST_NAME`] of them.
pub fn is_worker_name(name: &str) -> bool {
    (1..=LONGEST_NAME).contains(&name.len()) && name.bytes().all(is_name_byte)
}

/// A worker name made of any text (e.g. a host name): what cannot stand in a key becomes `-`.
pub fn worker_name(text: &str) -> String {
    let mut name: String = text
        .chars()
        .map(|c| if c.is_ascii() && is_name_byte(c as u8) { c } else { '-' })
        .take(LONGEST_NAME)
        .collect();
    if name.is_empty() {
        name.push('-');
    }
    name
}

fn is_name_byte(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_' | b'.')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_token_names_its_worker() {
        let worker = WorkerId { name: "host-4711".into(), epoch: 12 };
        assert_eq!(alive(&worker), "hingewise/alive/host-4711/12");
        assert_eq!(worker_of(&alive(&worker)), Some(worker));
        for foreign in ["hingewise/alive/a", "hingewise/alive/a/b", "hingewise/alive/a/1/2", "x/alive/a/1"] {
            assert_eq!(worker_of(foreign), None, "{foreign}");
        }
    }

    #[test]
    fn any_text_gives_a_name_that_can_stand_in_a_key() {
        assert_eq!(worker_name("Müller's box/1*"), "M-ller-s-box-1-");
        assert!(is_worker_name(&worker_name("")));
        assert!(is_worker_name(&worker_name(&"long".repeat(100))));
        assert!(!is_worker_name("a/b"));
        assert!(!is_worker_name("*"));
    }
}
