//! Who evaluates for a command: a coordinator that listens, and its local workers.

use super::arguments::{FarmArguments, Slots};
use super::error::CommandError;
use super::external;
use super::signals::interruption;
use common::scene::SceneSource;
use coordinator::farm::dispatch::{Board, Campaign, Listen, ZenohEvaluator};
use coordinator::farm::evaluate::Evaluator;
use coordinator::presentation::monitor::Source;
use std::time::Instant;
use worker::service::{self, ServiceConfig, WorkerHandle};
use worker::simulator::simulator;

/// Starts to listen for workers of a campaign; Ctrl-C and SIGTERM end its batches.
pub fn listen(campaign: Campaign, arguments: &FarmArguments) -> Result<ZenohEvaluator, CommandError> {
    let FarmArguments { listen, config, insecure, .. } = arguments.clone();
    let listen = Listen { endpoint: listen, config, insecure };
    let interrupted = interruption().map_err(CommandError::Signals)?;
    Ok(ZenohEvaluator::open(campaign, &listen, interrupted)?)
}

/// How many local slots the arguments ask for.
pub fn local_slots(arguments: &FarmArguments) -> usize {
    match arguments.workers.unwrap_or(Slots::Auto) {
        Slots::Auto => cores(),
        Slots::Count(slots) => slots,
    }
}

/// Cores of this machine.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Who is ready to evaluate a study's samples, before there is a folder for its results.
pub enum Ready {
    /// A coordinator that listens.
    Listening(ZenohEvaluator),
    /// The simulator that the scene names, on so many slots.
    Simulator(Box<dyn Evaluator>, u32),
}

impl Ready {
    /// For a scene; `campaign` is what workers are told.
    pub fn to_study(
        source: &SceneSource,
        campaign: impl FnOnce() -> Result<Campaign, CommandError>,
        arguments: &FarmArguments,
    ) -> Result<Self, CommandError> {
        let scene = source.nominal();
        let Some(simulator) = &scene.simulator else {
            return Ok(Self::Listening(listen(campaign()?, arguments)?));
        };
        external::check_farm(source.origin(), arguments)?;
        let slots = local_slots(arguments);
        Ok(Self::Simulator(external::ready(simulator, scene, slots)?, slots as u32))
    }

    /// Where the study is to post how far it is, and where to look for it.
    pub fn source(&self) -> (Board, Source) {
        match self {
            Self::Listening(evaluator) => (evaluator.board(), Source::Farm(evaluator.look())),
            Self::Simulator(_, slots) => {
                let board = Board::default();
                (board.clone(), Source::Alone { board, slots: *slots, since: Instant::now() })
            }
        }
    }

    /// Starts the local workers, if workers are to work.
    pub fn hire(self, arguments: &FarmArguments) -> Result<Crew, CommandError> {
        match self {
            Self::Listening(evaluator) => Ok(Crew::Farm(Farm::hire(evaluator, arguments)?)),
            Self::Simulator(evaluator, slots) => Ok(Crew::Simulator(evaluator, slots)),
        }
    }
}

/// Who evaluates a study's samples.
pub enum Crew {
    /// Workers.
    Farm(Farm),
    /// The simulator that the scene names, on so many slots.
    Simulator(Box<dyn Evaluator>, u32),
}

impl Crew {
    /// The evaluator.
    pub fn evaluator(&mut self) -> &mut dyn Evaluator {
        match self {
            Self::Farm(farm) => &mut farm.evaluator,
            Self::Simulator(evaluator, _) => &mut **evaluator,
        }
    }

    /// Simulations that can run at once now.
    pub fn concurrency(&self) -> u32 {
        match self {
            Self::Farm(farm) => farm.evaluator.concurrency(),
            Self::Simulator(_, slots) => *slots,
        }
    }

    /// Says where remote workers may join if there are no local ones.
    pub fn say_where(&self) {
        if let Self::Farm(farm) = self {
            farm.say_where();
        }
    }

    /// Tells workers and programs to leave.
    pub fn close(self) {
        if let Self::Farm(farm) = self {
            farm.close();
        }
    }
}

/// A coordinator that listens, and its local workers, `None` if remote ones are to do it all.
pub struct Farm {
    /// The coordinator's end.
    pub evaluator: ZenohEvaluator,
    local: Option<WorkerHandle>,
}

impl Farm {
    /// Starts the local workers.
    pub fn hire(evaluator: ZenohEvaluator, arguments: &FarmArguments) -> Result<Self, CommandError> {
        let slots = local_slots(arguments);
        let endpoint = evaluator.endpoints().first().filter(|_| slots > 0).cloned();
        let spawn = |endpoint| {
            let zenoh_config = arguments.config.clone();
            // The study thinks and serves the farm in this process: simulations give way to it, and have its cores back when
            // it has done.
            let config =
                ServiceConfig { zenoh_config, give_way: true, ..ServiceConfig::new(endpoint, slots) };
            service::spawn(config, simulator())
        };
        let local = endpoint.map(spawn).transpose()?;
        Ok(Farm { evaluator, local })
    }

    /// Says where remote workers may join if there are no local ones.
    pub fn say_where(&self) {
        if self.local.is_none() {
            for endpoint in self.evaluator.endpoints() {
                eprintln!("waiting for workers: worker --connect {endpoint}");
            }
        }
    }

    /// Tells the workers to leave.
    pub fn close(self) {
        self.evaluator.finish();
        if let Some(Err(error)) = self.local.map(WorkerHandle::join) {
            // The command has its results; how a local worker ended only matters to whoever looks for a reason.
            tracing::warn!("local worker: {error}");
        }
    }
}
