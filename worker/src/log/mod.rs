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

/// Starts the log in this `format`. A program calls this once.
///
/// `levels` are those of the modules, in the syntax of [`EnvFilter`], `variable` an environment variable that overrides them. Lines name the
/// module they come from if `with_module`.
pub fn start(levels: &str, variable: &str, format: Format, with_module: bool) {
    let filter = EnvFilter::try_from_env(variable).unwrap_or_else(|_| EnvFilter::new(levels));
    let lines = fmt::layer().with_writer(std::io::stderr).with_target(with_module);
    let lines = match format {
        Format::Text => lines.with_ansi(std::io::stderr().is_terminal()).boxed(),
        Format::Json => lines.json().flatten_event(true).boxed(),
    };
    let refusals = RefusalLayer::start().with_filter(Targets::new().with_targets(refusal::SOURCES));
    registry().with(lines.with_filter(filter)).with(refusals).init();
}
