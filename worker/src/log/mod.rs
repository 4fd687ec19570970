//! Log of both programs: on standard error, as text or as lines of JSON. [`refusal`] explains failed and refused
//! connections from Zenoh's log.

pub mod refusal;

use refusal::RefusalLayer;
use std::io::IsTerminal;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::layer::{Layer, SubscriberExt};
use tracing_subscriber::util::SubscriberInitExt;
use tracing_subscriber::{EnvFilter, fmt, registry};

/// Format of log lines.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Format {
    /// Plain text for reading.
    #[default]
    Text,
    /// One JSON object per line, for programs that collect logs.
    Json,
}

impl std::str::FromStr for Format {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "text" => Ok(Format::Text),
            "json" => Ok(Format::Json),
            _ => Err("allowed: text, json".to_owned()),
        }
    }
}

/// What a program logs, and how.
#[derive(Debug, Clone, Copy)]
pub struct LogOptions<'a> {
    /// Levels by module, in the syntax of [`EnvFilter`].
    pub levels: &'a str,
    /// Environment variable that overrides `levels`.
    pub variable: &'a str,
    /// Format of the lines.
    pub format: Format,
    /// Whether lines name the module they come from.
    pub with_module: bool,
}

/// Starts the log. A program calls this once.
pub fn start(options: LogOptions<'_>) {
    let filter = EnvFilter::try_from_env(options.variable).unwrap_or_else(|_| EnvFilter::new(options.levels));
    let lines = fmt::layer().with_writer(std::io::stderr).with_target(options.with_module);
    let lines = match options.format {
        Format::Text => lines.with_ansi(std::io::stderr().is_terminal()).boxed(),
        Format::Json => lines.json().flatten_event(true).boxed(),
    };
    let refusals = RefusalLayer::start().with_filter(Targets::new().with_targets(refusal::SOURCES));
    registry().with(lines.with_filter(filter)).with(refusals).init();
}
