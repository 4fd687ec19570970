//! SIGTERM and Ctrl-C: the first signal stops the worker, the second one ends the process at once.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tokio::runtime::Runtime;
use tokio::signal::unix::{Signal, SignalKind, signal};

/// Exit code after Ctrl-C, and after a second signal.
pub const INTERRUPTED: u8 = 130;

/// Handlers for SIGTERM and SIGINT. Signals that arrive before [`Signals::listen`] are kept, so the handlers are installed
/// before the process becomes visible to others.
pub struct Signals {
    /// Runtime for the signal streams only.
    runtime: Runtime,
    interrupt: Signal,
    terminate: Signal,
}

impl Signals {
    /// Installs the handlers.
    ///
    /// # Errors
    /// The system refuses a handler.
    pub fn catch() -> io::Result<Self> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let (interrupt, terminate) = {
            let _inside = runtime.enter();
            (signal(SignalKind::interrupt())?, signal(SignalKind::terminate())?)
        };
        Ok(Self { runtime, interrupt, terminate })
    }

    /// Calls `stop` at the first signal, on a separate thread. The returned flag is true after Ctrl-C.
    ///
    /// # Errors
    /// The system refuses a thread.
    pub fn listen(self, stop: impl Fn() + Send + 'static) -> io::Result<Arc<AtomicBool>> {
        let interrupted = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&interrupted);
        let Self { runtime, mut interrupt, mut terminate } = self;
        let wait = move || {
            runtime.block_on(async move {
                for first in [true, false] {
                    tokio::select! {
                        _ = interrupt.recv() => flag.store(true, Ordering::Relaxed),
                        _ = terminate.recv() => {}
                    }
                    if first {
                        stop();
                    }
                }
                common::external::kill_all();
                std::process::exit(i32::from(INTERRUPTED));
            });
        };
        std::thread::Builder::new().name("signals".into()).spawn(wait)?;
        Ok(interrupted)
    }
}
