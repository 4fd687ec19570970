//! Access to a running study: `--metrics` and `--live`.

use super::error::CommandError;
use super::farm::CommandEvaluator;
use clap::Args;
use common::scene::Scene;
use coordinator::farm::dispatch::StatusBoard;
use coordinator::presentation::monitor::{LivePage, MonitorServer, ProgressRelay, listen_address};
use coordinator::results::progress::Observer;
use coordinator::study::Settings;
use std::path::Path;
use std::sync::Arc;

/// Options on the access to a running study.
#[derive(Debug, Clone, Default, Args, PartialEq)]
#[command(next_help_heading = "Output")]
pub struct MonitorArguments {
    /// Serve metrics of the running study for Prometheus at http://ADDRESS:PORT/metrics
    #[arg(long, value_name = "PORT|ADDRESS:PORT")]
    pub metrics: Option<String>,
    /// Serve the report of the running study to browsers of this machine at http://127.0.0.1:PORT
    #[arg(long, value_name = "PORT")]
    pub live: Option<String>,
}

/// The study that a monitor shows.
pub struct WatchedStudy<'a> {
    /// Folder of the study.
    pub dir: &'a Path,
    /// Scene of the study.
    pub scene: &'a Scene,
    /// Settings of the study.
    pub settings: &'a Settings,
}

/// The servers of a running study.
pub struct Monitor {
    board: StatusBoard,
    live: Option<(Arc<LivePage>, MonitorServer)>,
    metrics: Option<MonitorServer>,
}

impl Monitor {
    /// Starts the servers that the arguments ask for; `insecure` allows metrics on an address of a network.
    ///
    /// # Errors
    /// [`CommandError::Monitor`] if an address is not allowed or cannot be used.
    pub fn open(
        arguments: &MonitorArguments,
        insecure: bool,
        evaluator: &CommandEvaluator,
        study: &WatchedStudy<'_>,
    ) -> Result<Self, CommandError> {
        let (board, look) = evaluator.status();
        let trusted = if insecure {
            Ok(())
        } else {
            Err("allowed: a port alone (this machine only), or --insecure if the network is trusted")
        };
        let metrics = arguments
            .metrics
            .as_deref()
            .map(|given| listen_address("--metrics", given, trusted))
            .transpose()?;
        let only_here =
            Err("allowed: a port alone, or an address of this machine only; use ssh -L from other machines");
        let live =
            arguments.live.as_deref().map(|given| listen_address("--live", given, only_here)).transpose()?;
        let metrics = metrics.map(|address| MonitorServer::metrics(address, look)).transpose()?;
        let page = |address| {
            let live = Arc::new(LivePage::new(study.dir, study.scene, study.settings));
            Ok::<_, CommandError>((Arc::clone(&live), MonitorServer::live(address, live)?))
        };
        Ok(Monitor { board, live: live.map(page).transpose()?, metrics })
    }

    /// Prints the addresses of the servers.
    pub fn print_addresses(&self) {
        if let Some((_, server)) = &self.live {
            eprintln!("live report: http://{}", server.address());
        }
        if let Some(server) = &self.metrics {
            eprintln!("metrics: http://{}/metrics", server.address());
        }
    }

    /// An observer that serves the monitor and forwards to `next`.
    pub fn watch<'a>(&self, scene: &str, next: &'a mut dyn Observer) -> ProgressRelay<'a> {
        ProgressRelay::new(
            scene,
            next,
            self.board.clone(),
            self.live.as_ref().map(|(live, _)| Arc::clone(live)),
        )
    }

    /// Shows the end of the study and stops the servers.
    pub fn end(self) {
        if let Some((live, _server)) = &self.live {
            live.end();
        }
    }
}
