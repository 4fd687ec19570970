//! A line on a terminal while a single piece of work is done.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// Time between two drawings of the line.
const REDRAW: Duration = Duration::from_millis(250);

/// Does `work`; meanwhile a terminal shows `doing` with the time that has passed. Nothing is shown elsewhere, or if `quiet`.
pub fn while_waiting<T>(quiet: bool, doing: String, work: impl FnOnce() -> T) -> T {
    if quiet || !std::io::stderr().is_terminal() {
        return work();
    }
    let style = ProgressStyle::with_template("{wide_msg} {elapsed}").expect("the template is valid");
    let line = ProgressBar::new_spinner().with_style(style).with_message(doing);
    line.set_draw_target(ProgressDrawTarget::stderr());
    line.enable_steady_tick(REDRAW);
    let done = work();
    line.finish_and_clear();
    done
}
