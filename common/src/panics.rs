//! Panics: one in a simulation is the outcome of that simulation; one anywhere else, e.g. in a thread of the messaging library,
//! ends the process. A process that lives on without that thread would wait for ever, and nothing recorded is lost by its end.

use std::any::Any;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::exit;
use std::sync::mpsc::channel;
use std::time::Duration;

/// Longest time that the end of the process waits for programs to be ended.
const LONGEST_END: Duration = Duration::from_secs(2);

thread_local! {
    /// Number of calls of [`caught`] that this thread is in.
    static CAUGHT: Cell<u32> = const { Cell::new(0) };
}

/// Result of `work`, or the message of its panic.
///
/// # Errors
/// The message of the panic.
pub fn caught<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    CAUGHT.set(CAUGHT.get() + 1);
    let result = catch_unwind(AssertUnwindSafe(work));
    CAUGHT.set(CAUGHT.get() - 1);
    result.map_err(|panic| message(&*panic))
}

/// From now on, a panic outside of [`caught`] ends the process with exit code 1, after `advice` on standard error.
pub fn end_process_on_panic(advice: &'static str) {
    let report = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        report(panic);
        if CAUGHT.get() == 0 {
            let thread = std::thread::current();
            let name = thread.name().unwrap_or("without a name");
            end_process(&format!("thread {name} has panicked. {advice}"));
        }
    }));
}

/// Ends the process with exit code 1 and a cause on standard error, whatever its other threads do. Programs it has started are ended.
pub fn end_process(cause: &str) -> ! {
    eprintln!("error: {cause}");
    // In another thread: this one may hold what the end of the programs needs.
    ends_within(LONGEST_END, "end", crate::external::kill_all);
    exit(1)
}

/// Does `work` in a thread of this name; false if it does not end within this time.
pub fn ends_within(time: Duration, thread: &str, work: impl FnOnce() + Send + 'static) -> bool {
    let (done, ended) = channel();
    let work = move || {
        work();
        let _ = done.send(());
    };
    let begun = std::thread::Builder::new().name(thread.to_owned()).spawn(work);
    begun.is_err() || ended.recv_timeout(time).is_ok()
}

fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_caught_panic_is_its_message() {
        assert_eq!(caught(|| 3), Ok(3));
        let nested = caught(|| (caught(|| panic!("inner {}", 1)).map(|()| 0), CAUGHT.get()));
        assert_eq!(nested, Ok((Err("inner 1".into()), 1)));
        assert_eq!(caught(|| -> u8 { panic!("outer") }), Err("outer".into()));
        assert_eq!(CAUGHT.get(), 0);
    }
}
