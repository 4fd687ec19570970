//! Logs of both programs: on standard error, as text or as lines of JSON; and what the messaging library lets fall about
//! connections that failed or were refused, put in words for users ([`refusal`]).

pub mod refusal;

use refusal::RefusalLayer;
use std::io::IsTerminal;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::layer::{Layer, SubscriberExt};
use tracing_subscriber::util::SubscriberInitExt;
use tracing_subscriber::{EnvFilter, fmt, registry};

/// How log lines look.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Format {
    /// For people.
    #[default]
    Text,
    /// One JSON object a line, for programs that collect logs.
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

/// Starts to log what `levels` lets through (in the syntax of `tracing`), unless the environment variable `variable` says
/// otherwise; lines name their module if `with_module`. To be called once, by a program.
pub fn start(levels: &str, variable: &str, format: Format, with_module: bool) {
    let filter = EnvFilter::try_from_env(variable).unwrap_or_else(|_| EnvFilter::new(levels));
    let lines = fmt::layer().with_writer(std::io::stderr).with_target(with_module);
    let lines = match format {
        Format::Text => lines.with_ansi(std::io::stderr().is_terminal()).boxed(),
        Format::Json => lines.json().flatten_event(true).boxed(),
    };
    let heard = RefusalLayer::start().with_filter(Targets::new().with_targets(refusal::SOURCES));
    registry().with(lines.with_filter(filter)).with(heard).init();
}
