//! Opens the sessions of Zenoh for workers, coordinators and tests. Opening one is most of Zenoh, as a future that is compiled
//! again by every crate that waits for it: here it is compiled once.

use std::path::Path;
use zenoh::{Config, Session, Wait};

/// The settings of this file, or Zenoh's default.
///
/// # Errors
/// That of Zenoh, for a file that cannot be read or is no configuration.
#[inline(never)]
pub fn configuration(file: Option<&Path>) -> zenoh::Result<Config> {
    file.map_or_else(|| Ok(Config::default()), Config::from_file)
}

/// Opens a session and waits until it is open; the settings limit the time.
///
/// # Errors
/// That of Zenoh.
#[inline(never)]
pub fn open(settings: Config) -> zenoh::Result<Session> {
    zenoh::open(settings).wait()
}

/// Closes a session and waits until it is closed, which may take long on a broken connection.
#[inline(never)]
pub fn close(session: &Session) {
    // A session that is closed already is what was asked for.
    let _ = session.close().wait();
}
