//! Zenoh key expressions, each built in one place.

use super::message::{WorkerId, is_worker_name};

/// Key of the workers' claims.
pub const CLAIM: &str = "hingewise/claim";

/// Key of the coordinator's notices to all workers.
pub const NOTICE: &str = "hingewise/notice";

/// Key of queries for the status of a study.
pub const STATUS: &str = "hingewise/status";

/// Liveliness tokens of all workers.
pub const ALIVE_ALL: &str = "hingewise/alive/*/*";

/// Liveliness token of the coordinator.
pub const COORDINATOR: &str = "hingewise/coordinator";

const ALIVE: &str = "hingewise/alive/";

/// Liveliness token of a worker process.
pub fn alive(worker: &WorkerId) -> String {
    format!("{ALIVE}{}/{}", worker.name, worker.epoch)
}

/// The worker of a liveliness token; `None` if the key is not such a token.
pub fn worker_of(key: &str) -> Option<WorkerId> {
    let (name, epoch) = key.strip_prefix(ALIVE)?.split_once('/')?;
    let epoch = epoch.parse().ok()?;
    is_worker_name(name).then(|| WorkerId { name: name.to_owned(), epoch })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::message::worker_name;

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
    fn any_text_gives_a_name_that_is_allowed_in_a_key() {
        assert_eq!(worker_name("Müller's box/1*"), "M-ller-s-box-1-");
        assert!(is_worker_name(&worker_name("")));
        assert!(is_worker_name(&worker_name(&"long".repeat(100))));
        assert!(!is_worker_name("a/b"));
        assert!(!is_worker_name("*"));
    }
}
