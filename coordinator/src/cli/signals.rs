//! Ctrl-C and SIGTERM stop a study after saving what is done. A second signal ends the process at once; nothing is lost,
//! since every outcome is recorded when it arrives.

use super::error::{CommandError, Done, INTERRUPTED};
use coordinator::presentation::terminal::print_message;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use tokio::signal::unix::{SignalKind, signal};

/// The flag of this process that becomes true with the first signal.
///
/// # Errors
/// The error of the operating system if it refuses a handler or a thread.
pub fn interruption() -> Done<Arc<AtomicBool>> {
    watch_signals().map_err(|error| CommandError::Failed(format!("signals: {error}")))
}

fn watch_signals() -> io::Result<Arc<AtomicBool>> {
    static FLAG: OnceLock<Arc<AtomicBool>> = OnceLock::new();
    if let Some(flag) = FLAG.get() {
        return Ok(Arc::clone(flag));
    }
    let interrupted = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&interrupted);
    // Its own small runtime: the study is synchronous, and Zenoh brings its own.
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let (mut interrupt, mut terminate) = {
        let _inside = runtime.enter();
        (signal(SignalKind::interrupt())?, signal(SignalKind::terminate())?)
    };
    let wait = move || {
        runtime.block_on(async move {
            for _ in 0..2 {
                tokio::select! {
                    _ = interrupt.recv() => {}
                    _ = terminate.recv() => {}
                }
                if !flag.swap(true, Ordering::Relaxed) {
                    print_message("stopping (again to stop at once)");
                }
            }
            common::external::kill_all();
            std::process::exit(i32::from(INTERRUPTED));
        });
    };
    std::thread::Builder::new().name("signals".into()).spawn(wait)?;
    Ok(Arc::clone(FLAG.get_or_init(|| interrupted)))
}
