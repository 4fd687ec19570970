//! Access to a running study: `--live`.

use super::draw::drawing_figure;
use super::signals::interruption;
use super::{CommandError, CommandEvaluator, Done};
use clap::Args;
use common::scene::Scene;
use coordinator::farm::dispatch::StatusBoard;
use coordinator::presentation::monitor::{LivePage, MonitorServer, ProgressRelay, listen_address};
use coordinator::presentation::terminal::print_message;
use coordinator::results::progress::Observer;
use coordinator::study::Settings;
use std::io::IsTerminal;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Interval at which a page that stays looks for a signal.
const POLL_INTERVAL: Duration = Duration::from_millis(100);

/// Options on the access to a running study.
#[derive(Debug, Clone, Default, Args, PartialEq)]
#[command(next_help_heading = "Output")]
pub struct MonitorArguments {
    /// Serve the report of the running study to browsers of this machine at http://127.0.0.1:PORT
    #[arg(long, value_name = "PORT")]
    pub live: Option<String>,
    /// Keep serving that page after the end of the study, until Ctrl-C; always on a terminal
    #[arg(long, requires = "live")]
    pub live_keep: bool,
}

/// The views of a running study.
pub struct Monitor {
    board: StatusBoard,
    live: Option<(Arc<LivePage>, MonitorServer)>,
    /// True if the live page stays after the end of the study.
    keep: bool,
}

impl Monitor {
    /// Starts the server that the arguments ask for.
    ///
    /// # Errors
    /// [`CommandError::BadInput`] if an address is not allowed or cannot be used.
    pub fn open(
        arguments: &MonitorArguments,
        evaluator: &CommandEvaluator,
        dir: &Path,
        scene: &Scene,
        settings: &Settings,
    ) -> Done<Self> {
        let (board, look) = evaluator.status();
        let live =
            arguments.live.as_deref().map(listen_address).transpose().map_err(CommandError::bad_input)?;
        let page = |address| {
            let drawing = drawing_figure(&scene.name, scene);
            let live = Arc::new(LivePage::new(dir, scene, settings, look.clone(), drawing));
            let server = MonitorServer::live(address, Arc::clone(&live)).map_err(CommandError::bad_input)?;
            Ok::<_, CommandError>((live, server))
        };
        Ok(Monitor { board, live: live.map(page).transpose()?, keep: arguments.live_keep })
    }

    /// Prints the address of the page.
    pub fn print_addresses(&self) {
        if let Some((_, server)) = &self.live {
            print_message(format_args!("live report: http://{}", server.address));
        }
    }

    /// An observer that serves the monitor and forwards to `next`.
    pub fn watch<'a>(&self, scene: &str, next: &'a mut dyn Observer) -> ProgressRelay<'a> {
        self.board.post(|study| scene.clone_into(&mut study.scene));
        let live = self.live.as_ref().map(|(live, _)| Arc::clone(live));
        ProgressRelay { next, board: self.board.clone(), live }
    }

    /// Shows the end of the study and stops the server, except for a live page that stays: with `--live-keep`, and on a terminal
    /// unless `quiet`.
    pub fn end(&mut self, quiet: bool) {
        let stays = self.keep || (!quiet && std::io::stderr().is_terminal());
        match &self.live {
            Some((live, _)) if stays => live.mark_ended(),
            Some((live, _)) => {
                live.end();
                self.live = None;
            }
            None => {}
        }
    }

    /// Serves a page that stays until the user interrupts.
    ///
    /// # Errors
    /// [`CommandError::Failed`].
    pub fn serve(self) -> Done {
        let Some((live, server)) = self.live else { return Ok(()) };
        let interrupted = interruption()?;
        print_message(format_args!(
            "the live page stays at http://{} until Ctrl-C; its report is {}",
            server.address,
            live.report_file().display()
        ));
        while !interrupted.load(Ordering::Relaxed) {
            std::thread::sleep(POLL_INTERVAL);
        }
        Ok(())
    }
}
