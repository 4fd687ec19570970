//! Options, defaults and value parsers that several commands share.

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use common::scene::{Faults, SceneSource};
use coordinator::farm::allocation::BatchSystem;
use coordinator::presentation::terminal::print_message;
use coordinator::statistics::named::{AUTO, parse_or_auto};
use std::error::Error;
use std::fmt::Display;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// Largest number of local worker slots.
const MOST_SLOTS: usize = 1024;

/// Amount and form of the output.
#[derive(Debug, Clone, Copy, Args)]
pub struct Verbosity {
    /// Print results as JSON
    #[arg(long, global = true)]
    pub json: bool,
    /// Format of the log on standard error
    #[arg(long, global = true, value_name = "text|json", default_value = "text")]
    pub log_format: worker::log::Format,
    /// Print nothing but results and errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Log more on standard error (-v: events, -vv: every detail)
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub verbose: u8,
}

impl Verbosity {
    /// Prints a message of progress on standard error.
    pub fn say(self, message: impl Display) {
        if !self.quiet {
            print_message(message);
        }
    }
}

/// Who is responsible for a study, as its report states it, in place of what the scene states.
#[derive(Debug, Clone, Default, Args, PartialEq)]
#[command(next_help_heading = "Head and signatures of the report")]
pub struct ReportTexts {
    /// Title [default: that of the scene]
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
    /// Author of the study
    #[arg(long, value_name = "TEXT")]
    pub author: Option<String>,
    /// Project, or name and number of the item
    #[arg(long, value_name = "TEXT")]
    pub project: Option<String>,
    /// Revision of the study
    #[arg(long, value_name = "TEXT")]
    pub revision: Option<String>,
    /// Who checked the study
    #[arg(long, value_name = "TEXT")]
    pub checked: Option<String>,
    /// Who approved the study
    #[arg(long, value_name = "TEXT")]
    pub approved: Option<String>,
    /// Note to the reader, such as the intended use
    #[arg(long, value_name = "TEXT")]
    pub note: Option<String>,
}

impl ReportTexts {
    /// Those that are given, each with its key in a scene.
    pub fn given(&self) -> Vec<(&'static str, &str)> {
        let Self { title, author, project, revision, checked, approved, note } = self;
        let all = [
            ("scene.title", title),
            ("report.author", author),
            ("report.project", project),
            ("report.revision", revision),
            ("report.checked", checked),
            ("report.approved", approved),
            ("report.note", note),
        ];
        all.into_iter().filter_map(|(key, text)| Some((key, text.as_deref()?))).collect()
    }

    /// The scene with these texts.
    ///
    /// # Errors
    /// [`Faults`] of the scene.
    pub fn in_scene(&self, source: SceneSource) -> Result<SceneSource, Faults> {
        let given = self.given();
        if given.is_empty() {
            return Ok(source);
        }
        source.edited("--title", |document| {
            for (path, text) in given {
                let (table, key) = path.split_once('.').unwrap_or_default();
                let table = document.entry(table).or_insert_with(|| toml::Table::new().into());
                table.as_table_mut().and_then(|table| table.insert(key.to_owned(), text.into()));
            }
        })
    }
}

/// Local and remote workers.
#[derive(Debug, Clone, Default, Args, PartialEq)]
#[command(next_help_heading = "Machines")]
pub struct FarmArguments {
    /// Local worker slots: a number, `auto` for one per core, 0 to use remote workers only [default: auto]
    #[arg(long, value_name = "auto|N", value_parser = slots)]
    pub workers: Option<usize>,
    /// Address for remote workers [default: tcp/127.0.0.1:0, any free port, this machine only]
    #[arg(long, value_name = "ENDPOINT")]
    pub listen: Option<String>,
    /// Zenoh configuration (JSON5), e.g. for TLS and passwords
    #[arg(long, value_name = "ZENOH.json5")]
    pub config: Option<PathBuf>,
    /// Allow --listen without authentication on an address that other machines can reach
    #[arg(long)]
    pub insecure: bool,
    /// Most evaluations of the scene's own simulator at once, on all workers together
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub licences: Option<u32>,
    /// Use workers of other builds of the program too, whose results may differ; the build is recorded with each result's worker
    #[arg(long)]
    pub mixed_builds: bool,
    /// Share of the evaluations that two workers make, whose results have to agree, besides the first one of each worker [default: that one
    /// alone; none with --mixed-builds or a simulator of the scene]
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub cross_check: Option<f64>,
    /// Ask a batch system for workers as the backlog demands: slurm, hyperqueue, or a shell command that runs one worker (see deploy/README.md)
    #[arg(long, value_name = "slurm|hyperqueue|COMMAND", requires = "most")]
    pub scale: Option<BatchSystem>,
    /// Most jobs of --scale at once
    #[arg(long, value_name = "N", requires = "scale", value_parser = positive)]
    pub most: Option<usize>,
    /// Time after which a worker of --scale without tasks leaves [default: 60s]
    #[arg(long, value_name = "TIME", requires = "scale", value_parser = time)]
    pub idle: Option<Duration>,
}

/// Reads a time: `60s`, `10min`, `1h`, or a number of seconds.
///
/// # Errors
/// The allowed values, in words.
pub fn time(text: &str) -> Result<Duration, String> {
    let number = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = match &text[number.len()..] {
        "" | "s" => 1,
        "min" => 60,
        "h" => 3600,
        _ => 0,
    };
    let seconds = number.trim().parse::<u64>().ok().and_then(|number| number.checked_mul(unit));
    let time = seconds.filter(|seconds| *seconds > 0).map(Duration::from_secs);
    time.ok_or_else(|| "allowed: a time above zero, e.g. 60s, 10min or 1h".to_owned())
}

/// Reads a value that is allowed; `allowed` says in words which are.
///
/// # Errors
/// The allowed values, in words.
pub fn value<T: FromStr>(text: &str, allowed: &str, allows: impl FnOnce(&T) -> bool) -> Result<T, String> {
    text.trim().parse().ok().filter(allows).ok_or_else(|| format!("allowed: {allowed}"))
}

/// Parser of a whole number within these bounds.
pub fn within<T>(from: T, to: T) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static
where
    T: FromStr + PartialOrd + Display + Copy + Send + Sync + 'static,
{
    move |text| value(text, &format!("a whole number from {from} to {to}"), |n| (from..=to).contains(n))
}

/// Reads a number above zero.
///
/// # Errors
/// The allowed values, in words.
pub fn above_zero(text: &str) -> Result<f64, String> {
    value(text, "a number above 0", |x: &f64| *x > 0.0 && x.is_finite())
}

/// Reads a whole number above zero.
///
/// # Errors
/// The allowed values, in words.
pub fn positive(text: &str) -> Result<usize, String> {
    value(text, "a whole number >= 1", |n| *n >= 1)
}

/// Reads a whole number.
///
/// # Errors
/// The allowed values, in words.
pub fn whole(text: &str) -> Result<usize, String> {
    value(text, "a whole number >= 0", |_| true)
}

/// Reads the seed of random draws.
///
/// # Errors
/// The allowed values, in words.
pub fn seed(text: &str) -> Result<u64, String> {
    value(text, &format!("a whole number from 0 to {}", u64::MAX), |_| true)
}

/// Reads a share: `1%`, `1 %` or `0.01` [1].
///
/// # Errors
/// The allowed values, in words.
pub fn share(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.strip_suffix('%') {
        Some(percent) => (percent.trim_end(), 100.0),
        None => (text, 1.0),
    };
    let share = number.parse::<f64>().ok().map(|x| x / scale).filter(|x| *x > 0.0 && *x <= 1.0);
    share.ok_or_else(|| "allowed: a share above 0 and up to 1, e.g. 1%, 0.5% or 0.01".to_owned())
}

/// Reads a reliability or a confidence: a share below 1 [1].
///
/// # Errors
/// The allowed values, in words.
pub fn probability(text: &str) -> Result<f64, String> {
    let allowed = || "allowed: a share between 0 and 1, e.g. 0.99 or 90%".to_owned();
    share(text).ok().filter(|x| *x < 1.0).ok_or_else(allowed)
}

/// Parser of a setting's named values; `--help` and error messages list `names`.
pub fn word<T>(names: impl Into<PossibleValuesParser>) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err: Error + Send + Sync + 'static> + Clone + Send + Sync + 'static,
{
    names.into().try_map(|name| name.parse())
}

/// Parser of a setting's named values, or `auto` as `None`.
pub fn word_or_auto<T>(names: &[&'static str]) -> impl TypedValueParser<Value = Option<T>> + use<T>
where
    T: FromStr<Err: Error + Send + Sync + 'static> + Clone + Send + Sync + 'static,
{
    let names = std::iter::once(AUTO).chain(names.iter().copied());
    PossibleValuesParser::new(names.collect::<Vec<_>>()).try_map(|name| parse_or_auto(&name))
}

/// Number of cores of this machine.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Reads a number of local worker slots; `auto` is one slot per core.
fn slots(text: &str) -> Result<usize, String> {
    let read = if text == "auto" { Some(cores()) } else { text.parse().ok().filter(|n| *n <= MOST_SLOTS) };
    read.ok_or_else(|| format!("allowed: auto, or a whole number from 0 to {MOST_SLOTS}"))
}

#[cfg(test)]
mod tests {
    use super::{share, time};
    use std::time::Duration;

    #[test]
    fn times_have_a_unit_or_are_seconds() {
        let seconds = |text: &str| time(text).map(|time| time.as_secs());
        assert_eq!(
            [seconds("60s"), seconds("2min"), seconds("1 h"), seconds("5")],
            [Ok(60), Ok(120), Ok(3600), Ok(5)]
        );
        assert_eq!(time("10min"), Ok(Duration::from_secs(600)));
        for wrong in ["", "0", "-1s", "1d", "s", "1.5s"] {
            assert!(time(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn shares_are_percent_or_plain() {
        assert_eq!(
            [share("1%"), share("1 %"), share("0.01"), share("100%")],
            [Ok(0.01), Ok(0.01), Ok(0.01), Ok(1.0)]
        );
        for slip in ["0", "0%", "-1%", "101%", "1.5", "nan", "inf", "", "%", "one", "1%%"] {
            assert!(share(slip).is_err(), "{slip}");
        }
    }
}
