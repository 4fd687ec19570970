//! A line on a terminal while a single piece of work is done, and lines in a log.

use super::print_message;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::cell::Cell;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Time between two drawings of the line.
const REDRAW: Duration = Duration::from_millis(250);

/// Time between two lines where standard error is no terminal: short work prints none.
const LINE_EVERY: Duration = Duration::from_secs(1);

/// Does `work`, which states its progress. A terminal shows `doing`, then the progress last stated, with the time that has passed; elsewhere
/// standard error has a line a second at most. Nothing is shown if `quiet`.
pub fn while_waiting<T>(quiet: bool, doing: String, work: impl FnOnce(&dyn Fn(String)) -> T) -> T {
    if quiet {
        return work(&|_| {});
    }
    if !std::io::stderr().is_terminal() {
        let last = Cell::new(Instant::now());
        return work(&|progress| {
            if last.get().elapsed() >= LINE_EVERY {
                last.set(Instant::now());
                print_message(progress);
            }
        });
    }
    let style = ProgressStyle::with_template("{wide_msg} {elapsed}").expect("the template is valid");
    let line = ProgressBar::new_spinner().with_style(style).with_message(doing);
    line.set_draw_target(ProgressDrawTarget::stderr());
    line.enable_steady_tick(REDRAW);
    let done = work(&|progress| line.set_message(progress));
    line.finish_and_clear();
    done
}
