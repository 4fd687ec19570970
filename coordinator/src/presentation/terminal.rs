//! Progress of a study on standard error: a progress bar on a terminal, plain lines elsewhere, nothing if quiet.
//! [`ProgressText`] decides on text and time of the lines; it uses neither terminal nor clock.

mod ending;

pub use ending::final_text;

use super::format::{fixed, percent};
use super::progress::{record, reliability_so_far, state_of_study};
use crate::results::progress::{Observer, Progress};
use crate::results::summary::Round;
use common::wire::StudyStatus;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::cell::Cell;
use std::fmt::Display;
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Shortest time between two lines about evaluations.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// Text of the progress; times count from the start of the study.
#[derive(Debug, Default)]
pub struct ProgressText {
    study: StudyStatus,
    /// True once all evaluations are finished.
    ending: bool,
    round: Option<Round>,
    /// Start of the first batch.
    started: Option<Duration>,
    /// Time of the last line about evaluations or a round.
    last_line: Option<Duration>,
}

impl ProgressText {
    /// Records progress and returns the line to print without a terminal, if any: one per round, one per warning, and one
    /// about evaluations every ten seconds at most.
    pub fn line(&mut self, now: Duration, progress: &Progress) -> Option<String> {
        // The nominal point is a batch of its own, and the next one follows without delay.
        let after_nominal = self.study.planned == 1 && matches!(progress, Progress::BatchStarted { .. });
        self.record(now, progress);
        match progress {
            Progress::Warning(text) => Some(format!("warning: {text}")),
            Progress::RoundFinished(round) => {
                self.last_line = Some(now);
                Some(round_line(round))
            }
            // Recalled evaluations take no time and are counted by the line of their batch, which follows.
            Progress::Evaluated { recalled: true, .. } | Progress::Reliability { .. } | Progress::Ending => {
                None
            }
            // Nothing of this batch is left to be simulated.
            Progress::BatchStarted { planned, .. } if self.study.done >= *planned as u64 => None,
            Progress::BatchStarted { .. } | Progress::Evaluated { .. } => {
                let due = after_nominal || self.last_line.is_none_or(|last| now >= last + LINE_EVERY);
                due.then(|| {
                    self.last_line = Some(now);
                    self.state(now)
                })
            }
        }
    }

    fn record(&mut self, now: Duration, progress: &Progress) {
        record(&mut self.study, progress);
        match progress {
            Progress::BatchStarted { .. } => {
                self.started.get_or_insert(now);
            }
            Progress::RoundFinished(round) => self.round = Some(round.clone()),
            Progress::Ending => self.ending = true,
            Progress::Evaluated { .. } | Progress::Reliability { .. } | Progress::Warning(_) => {}
        }
    }

    /// Simulations per second, without recalled evaluations; `None` before the first one.
    fn rate(&self, now: Duration) -> Option<f64> {
        let elapsed = now.saturating_sub(self.started?).as_secs_f64();
        let simulated = self.study.done.saturating_sub(self.study.recalled);
        (simulated > 0 && elapsed > 0.0).then(|| simulated as f64 / elapsed)
    }

    /// The state of the study in one line.
    pub fn state(&self, now: Duration) -> String {
        let error = self.round.as_ref().map(|round| round.surrogate_error);
        state_of_study(&self.study, self.ending, self.rate(now), error).replace('\u{a0}', " ")
    }
}

/// A finished round in one line.
fn round_line(round: &Round) -> String {
    let change = |change| format!(", largest change of any R {}", percent(change));
    let change = round.change_of_r.map_or(String::new(), change);
    // A direct simulation has no surrogates.
    let is_direct = (round.min_u, round.surrogate_error) == (0.0, 0.0);
    let uncertain =
        || format!(", uncertain {}, min U {}", percent(round.share_uncertain), fixed(round.min_u, 3));
    format!(
        "round {}: {} evaluations, {}{change}{}",
        round.round,
        round.evaluations,
        reliability_so_far(round.cycles, round.reliability_total, round.standard_error()),
        if is_direct { String::new() } else { uncertain() }
    )
    .replace('\u{a0}', " ")
}

/// Style of the progress bar: on 80 columns 71 are left for the text.
fn style() -> ProgressStyle {
    ProgressStyle::with_template("{spinner} {bar:6} {wide_msg}")
        .expect("the template is a constant, made once in the tests")
}

/// Shows a study on standard error.
pub struct Terminal {
    text: ProgressText,
    start: Instant,
    quiet: bool,
    /// The progress bar on a terminal; without one there are lines.
    bar: Option<ProgressBar>,
}

impl Terminal {
    /// A progress bar if standard error is a terminal, otherwise plain lines; nothing if `quiet`.
    pub fn new(quiet: bool) -> Self {
        let bar = (!quiet && std::io::stderr().is_terminal()).then(|| {
            let bar =
                ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::stderr()).with_style(style());
            bar.enable_steady_tick(REDRAW);
            bar
        });
        Self { text: ProgressText::default(), start: Instant::now(), quiet, bar }
    }

    /// Clears the progress bar, so that the following output starts on a clean line.
    pub fn finish(&mut self) {
        self.bar.iter().for_each(ProgressBar::finish_and_clear);
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        self.finish();
    }
}

impl Observer for Terminal {
    fn notice(&mut self, progress: &Progress) {
        let now = self.start.elapsed();
        let line = self.text.line(now, progress);
        match &self.bar {
            None if self.quiet => {}
            None => line.into_iter().for_each(print_message),
            Some(bar) => {
                bar.set_length(self.text.study.budget.max(self.text.study.planned));
                bar.set_position(self.text.study.done);
                bar.set_message(self.text.state(now));
                let lasts = matches!(progress, Progress::Warning(_) | Progress::RoundFinished(_));
                if let (true, Some(line)) = (lasts, line) {
                    bar.println(line);
                }
            }
        }
    }
}

/// True once messages are lines of the log.
static IN_LOG: AtomicBool = AtomicBool::new(false);

/// From now on messages are lines of the log, whose format is one for programs.
pub fn messages_to_log() {
    IN_LOG.store(true, Ordering::Relaxed);
}

/// Prints a message and a line break to standard error. If that is a closed pipe or a full disk, the study goes on: its results are in
/// its folder.
pub fn print_message(message: impl Display) {
    let text = printable(&message.to_string());
    match (IN_LOG.load(Ordering::Relaxed), text.starts_with("error")) {
        // There is no other place to report the failure at.
        (false, _) => drop(writeln!(std::io::stderr().lock(), "{text}")),
        (true, false) => tracing::info!("{text}"),
        (true, true) => tracing::error!("{text}"),
    }
}

/// A text with U+FFFD for control characters: texts of workers and of people's programs are in messages, and a terminal would obey them.
fn printable(text: &str) -> String {
    text.replace(|c: char| c.is_control() && !matches!(c, '\n' | '\t'), "\u{fffd}")
}

/// Time between two drawings of the line.
const REDRAW: Duration = Duration::from_millis(250);

/// Time between two lines where standard error is no terminal: short work prints none.
const WAITING_EVERY: Duration = Duration::from_secs(1);

/// Does `work`, which states its progress. A terminal shows `doing`, then the progress last stated, with the time that has passed; elsewhere
/// standard error has a line a second at most. Nothing is shown if `quiet`.
pub fn while_waiting<T>(quiet: bool, doing: String, work: impl FnOnce(&dyn Fn(String)) -> T) -> T {
    if quiet {
        return work(&|_| {});
    }
    if !std::io::stderr().is_terminal() {
        let last = Cell::new(Instant::now());
        return work(&|progress| {
            if last.get().elapsed() >= WAITING_EVERY {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::test_study;

    fn batch(planned: usize, purpose: &str) -> Progress {
        Progress::BatchStarted { planned, budget: 400, purpose: purpose.into() }
    }

    fn evaluated(done: usize, recalled: bool) -> Progress {
        Progress::Evaluated { done, failed: done == 3, recalled, wall: 1.0 }
    }

    fn seconds(seconds: u64) -> Duration {
        Duration::from_secs(seconds)
    }

    #[test]
    fn evaluations_have_at_most_one_line_in_ten_seconds() {
        let mut text = ProgressText::default();
        let first = text.line(seconds(0), &batch(120, "initial design")).unwrap();
        assert_eq!(first, "0/400 evaluations, initial design");
        let lines: Vec<String> =
            (1..=60).filter_map(|k| text.line(seconds(k), &evaluated(k as usize, false))).collect();
        assert_eq!(lines.len(), 6);
        assert_eq!(lines[5], "60/400 evaluations, at most 5 min 40 s left, 1.00/s, initial design, 1 failed");
    }

    #[test]
    fn every_round_has_its_line() {
        let mut text = ProgressText::default();
        text.line(seconds(0), &batch(1, "round 3"));
        let lines: Vec<String> = test_study::study()
            .summary
            .convergence
            .rounds
            .into_iter()
            .filter_map(|round| text.line(seconds(0), &Progress::RoundFinished(round)))
            .collect();
        assert_eq!(lines.len(), 9);
        assert_eq!(
            lines[1],
            "round 1: 132 evaluations, R(66 000) = 0.299 ± 0.044 (95 % but for numerical error), largest change of any R 6.0 %, uncertain 18.6 %, min U 0.180"
        );
        assert!(
            text.state(seconds(5)).ends_with("± 0.0078 (95 % but for numerical error), round 3"),
            "{}",
            text.state(seconds(5))
        );
    }

    #[test]
    fn what_came_from_the_campaign_file_does_not_count_for_the_rate() {
        let mut text = ProgressText::default();
        for done in 1..=100 {
            assert_eq!(text.line(seconds(0), &evaluated(done, true)), None);
        }
        // The first line of a resumed study does not begin at 0.
        let first = text.line(seconds(0), &batch(120, "initial design")).unwrap();
        assert_eq!(first, "100/400 evaluations, initial design, 1 failed, 100 from the campaign file");
        assert!(!text.state(seconds(1)).contains("/s"));
        text.line(seconds(10), &evaluated(101, false));
        let state = text.state(seconds(10));
        assert!(
            state.contains("at most 49 min 50 s left, 0.10/s, initial design, 1 failed, 100 from"),
            "{state}"
        );
    }

    #[test]
    fn issue_80_columns_cut_off_rate_error_and_time() {
        let mut text = ProgressText::default();
        text.line(seconds(0), &batch(384, "round 21"));
        for done in 1..=372 {
            text.record(seconds(1000), &evaluated(done, false));
        }
        let round =
            Round { cycles: 66_000, reliability_total: 0.5, surrogate_error: 0.0091, ..Round::default() };
        text.record(seconds(1000), &Progress::RoundFinished(round));
        let state = text.state(seconds(1000));
        // Spinner, bar of six and two spaces.
        let seen: String = state.chars().take(80 - 9).collect();
        let parts = "372/400 evaluations, at most 1 min 15 s left, 0.37/s, error 0.0091";
        assert!(seen.starts_with(parts), "{seen}");
        // A direct simulation ends when its plan is carried out.
        let mut direct = ProgressText::default();
        direct.record(seconds(0), &batch(400, "simulations"));
        direct.record(seconds(100), &evaluated(100, false));
        assert!(direct.state(seconds(100)).starts_with("100/400 evaluations, 5 min 00 s left, 1.00/s"));
        direct.record(seconds(100), &Progress::Ending);
        assert!(direct.state(seconds(100)).contains(", computing the results"));
    }

    #[test]
    fn the_bar_shows_the_text() {
        let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::hidden());
        bar.set_style(style());
        let (text, start) = (ProgressText::default(), Instant::now());
        let mut terminal = Terminal { text, start, quiet: false, bar: Some(bar.clone()) };
        terminal.notice(&batch(120, "initial design"));
        terminal.notice(&evaluated(7, true));
        assert_eq!((bar.length(), bar.position()), (Some(400), 7));
        let shown = bar.message();
        assert!(shown.starts_with("7/400 evaluations") && shown.contains("initial design"), "{shown}");
        drop(terminal);
        assert!(bar.is_finished());
    }

    #[test]
    fn warnings_are_printed_at_once() {
        let mut text = ProgressText::default();
        text.line(seconds(0), &batch(1, ""));
        let line = text.line(seconds(1), &Progress::Warning("no worker".into()));
        assert_eq!(line.unwrap(), "warning: no worker");
    }

    #[test]
    fn issue_texts_of_workers_reached_the_terminal_as_commands() {
        assert_eq!(
            printable("\u{1b}[2J\u{1b}]0;pwned\u{7} no\tresult\n"),
            "\u{fffd}[2J\u{fffd}]0;pwned\u{fffd} no\tresult\n"
        );
    }
}
