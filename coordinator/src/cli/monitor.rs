//! Who may look at a running study: `--metrics` and `--live`.

use super::error::CommandError;
use super::farm::Ready;
use super::options::StudyOptions;
use clap::Args;
use common::scene::{Scene, SceneSource};
use coordinator::farm::dispatch::Board;
use coordinator::presentation::monitor::{Live, Server, Watch, address};
use coordinator::results::progress::Observer;
use std::path::Path;
use std::sync::Arc;

/// Options for those who watch.
#[derive(Debug, Clone, Default, Args, PartialEq)]
pub struct MonitorArguments {
    /// Offer metrics of the running study to Prometheus, at http://ADDRESS:PORT/metrics
    #[arg(long, value_name = "PORT|ADDRESS:PORT")]
    pub metrics: Option<String>,
    /// Show the report while the study runs, to browsers of this machine, at http://127.0.0.1:PORT
    #[arg(long, value_name = "PORT")]
    pub live: Option<String>,
}

/// Those who look, and where.
pub struct Monitor {
    board: Board,
    live: Option<(Arc<Live>, Server)>,
    metrics: Option<Server>,
}

impl Monitor {
    /// Opens what the arguments ask for; `study` is its folder, scene and options.
    pub fn open(
        arguments: &MonitorArguments,
        insecure: bool,
        ready: &Ready,
        study: (&Path, &SceneSource, &StudyOptions),
    ) -> Result<Self, CommandError> {
        let (dir, source, options) = study;
        let (board, look) = ready.source();
        let trusted = if insecure {
            Ok(())
        } else {
            Err("allowed: a port alone (this machine only), or --insecure if the network is trusted")
        };
        let metrics =
            arguments.metrics.as_deref().map(|given| address("--metrics", given, trusted)).transpose()?;
        let only_here =
            Err("allowed: a port alone, or an address of this machine only; others look through ssh -L");
        let live = arguments.live.as_deref().map(|given| address("--live", given, only_here)).transpose()?;
        let metrics = metrics.map(|address| Server::metrics(address, look)).transpose()?;
        let page = |address| {
            let settings = options.settings();
            let scene = Scene { study: settings.study, ..source.nominal().clone() };
            let live = Arc::new(Live::new(dir, &scene, &settings));
            Ok::<_, CommandError>((Arc::clone(&live), Server::live(address, live)?))
        };
        Ok(Monitor { board, live: live.map(page).transpose()?, metrics })
    }

    /// Says where to look.
    pub fn say_where(&self) {
        if let Some((_, server)) = &self.live {
            eprintln!("live report: http://{}", server.address());
        }
        if let Some(server) = &self.metrics {
            eprintln!("metrics: http://{}/metrics", server.address());
        }
    }

    /// An observer that passes on to `next`.
    pub fn watch<'a>(&self, scene: &str, next: &'a mut dyn Observer) -> Watch<'a> {
        Watch::new(scene, next, self.board.clone(), self.live.as_ref().map(|(live, _)| Arc::clone(live)))
    }

    /// Tells those who look that the study has ended.
    pub fn end(self) {
        if let Some((live, _server)) = &self.live {
            live.end();
        }
    }
}
