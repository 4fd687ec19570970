//! Limit of open files of the process (`ulimit -n`), of which each session takes one: raised as far as needed and permitted.

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

/// Files that are not sessions: campaign file, log and pages, and what Zenoh and the system need.
const OTHER_FILES: u64 = 200;

/// The number of sessions for which files can be opened, at most `sessions`: raises the soft limit of this process up to
/// the hard one if it is too low, and logs a warning if that is not enough.
pub(super) fn bounded_by_open_files(sessions: u32) -> u32 {
    let wanted = u64::from(sessions) + OTHER_FILES;
    let Rlimit { current, maximum } = getrlimit(Resource::Nofile);
    // `None`: no limit.
    if current.is_none_or(|current| current >= wanted) {
        return sessions;
    }
    let raised = maximum.map_or(wanted, |maximum| maximum.min(wanted));
    let limit = match setrlimit(Resource::Nofile, Rlimit { current: Some(raised), maximum }) {
        Ok(()) => raised,
        Err(_) => current.unwrap_or(wanted),
    };
    let possible = sessions_within(limit).min(sessions);
    if possible < sessions {
        tracing::warn!(
            "at most {possible} workers can connect instead of {sessions}: this process may open {limit} files (ulimit -n)"
        );
    }
    possible
}

/// Sessions within a limit of open files; at least one.
fn sessions_within(limit: u64) -> u32 {
    u32::try_from(limit.saturating_sub(OTHER_FILES)).unwrap_or(u32::MAX).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_soft_limit_is_raised_as_far_as_needed() {
        let before = getrlimit(Resource::Nofile);
        let possible = bounded_by_open_files(700);
        let after = getrlimit(Resource::Nofile);
        assert_eq!(after.maximum, before.maximum);
        assert!(after.current.is_none_or(|current| current >= u64::from(possible) + OTHER_FILES));
        assert_eq!(bounded_by_open_files(1), 1);
    }

    #[test]
    fn a_low_limit_leaves_files_for_the_rest() {
        assert_eq!(sessions_within(1024), 824);
        assert_eq!(sessions_within(10), 1);
        assert_eq!(sessions_within(u64::MAX), u32::MAX);
    }
}
