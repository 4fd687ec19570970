//! The evaluators of a command: a coordinator that listens for workers, with local workers in this process, or the
//! simulator that a scene names, without messages if no remote workers are asked for.

use super::external;
use super::shared::cores;
use super::signals::interruption;
use super::{CommandError, Done, FarmArguments};
use common::accuracy::NamedAccuracy;
use common::evaluation_shape::EvaluationShape;
use common::external::SimulatorId;
use common::panics::end_process;
use common::scene::SceneSource;
use common::wire::ScaleStatus;
use coordinator::farm::allocation::{BatchSystem, ScaleSettings, Scaling};
use coordinator::farm::dispatch::{
    CampaignSimulator, CampaignSpec, CrossCheck, Listen, StatusBoard, Watch, ZenohEvaluator, watch,
};
use coordinator::farm::evaluate::Evaluator;
use coordinator::presentation::monitor::StatusSource;
use coordinator::presentation::terminal::print_message;
use coordinator::results::summary::ScaleRow;
use coordinator::study::Settings;
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};
use worker::service::{self, ServiceConfig, Simulator, WorkerHandle};
use worker::simulator::simulator;

/// Said when the coordinator does not answer its own questions.
const SILENT: &str = "the coordinator no longer answers its own questions: its messaging has failed. Every evaluation recorded so \
                      far is saved: continue a study with `coordinator resume DIR`.";

/// Number of local slots that the arguments ask for.
pub fn local_slots(arguments: &FarmArguments) -> usize {
    arguments.workers.unwrap_or_else(cores)
}

/// The evaluator of a command.
pub enum CommandEvaluator {
    /// Workers, local and remote.
    Workers(Box<WorkerFarm>),
    /// The simulator that the scene names, and its number of slots.
    Simulator(Box<dyn Evaluator>, u32),
}

impl CommandEvaluator {
    /// Opens the evaluator of a scene: starts its simulator, or listens for workers of `campaign`. Local workers are
    /// not started yet, so that a failure here leaves no results folder behind.
    ///
    /// # Errors
    /// [`CommandError`] if the simulator cannot be used, or the address cannot be listened on.
    pub fn open(
        source: &SceneSource,
        settings: &Settings,
        resumed: bool,
        arguments: &FarmArguments,
    ) -> Done<Self> {
        let is_external = source.nominal().simulator.is_some();
        if is_external && !external::has_remote_workers(arguments) {
            let licences = arguments.licences.map_or(usize::MAX, |licences| licences as usize);
            let slots = local_slots(arguments).min(licences);
            return Ok(Self::Simulator(external::open_simulator(source, slots)?, slots as u32));
        }
        let own = is_external.then(|| external::own_simulator(source, local_slots(arguments))).transpose()?;
        let mut farm = WorkerFarm::listen(announced(source, settings, resumed)?, arguments)?;
        farm.simulator = own.unwrap_or(farm.simulator);
        Ok(Self::Workers(Box::new(farm)))
    }

    /// Opens the evaluator for further simulations of a study, and starts its workers.
    ///
    /// # Errors
    /// [`CommandError`].
    pub fn started(
        source: &SceneSource,
        settings: &Settings,
        farm: &FarmArguments,
        quiet: bool,
    ) -> Done<Self> {
        let mut evaluator = Self::open(source, settings, true, farm)?;
        evaluator.start_workers()?;
        if !quiet {
            evaluator.print_endpoints();
        }
        Ok(evaluator)
    }

    /// The status board of the study, and the source of its status.
    pub fn status(&self) -> (StatusBoard, StatusSource) {
        match self {
            Self::Workers(farm) => {
                (farm.evaluator.board.clone(), StatusSource::Farm(farm.evaluator.status_handle()))
            }
            Self::Simulator(_, slots) => {
                let board = StatusBoard::default();
                (board.clone(), StatusSource::Alone { board, slots: *slots, since: Instant::now() })
            }
        }
    }

    /// Starts the local workers, if there are any.
    ///
    /// # Errors
    /// [`CommandError::Worker`].
    pub fn start_workers(&mut self) -> Done {
        match self {
            Self::Workers(farm) => farm.start_workers(),
            Self::Simulator(..) => Ok(()),
        }
    }

    /// The jobs that the study asked for of a batch system, if it did.
    pub fn scale_row(&self) -> Option<ScaleRow> {
        let Self::Workers(farm) = self else { return None };
        let ScaleStatus { system, most, asked, failed, .. } = farm.evaluator.board.scale()?;
        Some(ScaleRow { system, most, asked, failed })
    }

    /// The evaluator as a study uses it.
    pub fn evaluator(&mut self) -> &mut dyn Evaluator {
        match self {
            Self::Workers(farm) => &mut farm.evaluator,
            Self::Simulator(evaluator, _) => &mut **evaluator,
        }
    }

    /// Prints the addresses for remote workers if there are no local ones.
    pub fn print_endpoints(&self) {
        if let Self::Workers(farm) = self {
            farm.print_endpoints();
        }
    }

    /// Disconnects the workers and ends the study for them.
    pub fn close(self) {
        if let Self::Workers(farm) = self {
            farm.close();
        }
    }
}

/// A coordinator that listens for workers, and the workers of this process.
pub struct WorkerFarm {
    /// The evaluator of the coordinator.
    pub evaluator: ZenohEvaluator,
    arguments: FarmArguments,
    /// The simulator of the local workers.
    simulator: Arc<dyn Simulator>,
    /// Whether workers have to have the simulator of the scene themselves.
    is_external: bool,
    local: Option<WorkerHandle>,
    /// Number of the campaign.
    campaign: u64,
    /// Asks a batch system for workers.
    scaling: Option<Scaling>,
    _watched: Option<Sender<()>>,
}

impl WorkerFarm {
    /// Listens for workers of a campaign and starts the local ones; unless `quiet`, prints the addresses for remote ones.
    ///
    /// # Errors
    /// Those of [`WorkerFarm::listen`] and [`WorkerFarm::start_workers`].
    pub fn start(campaign: CampaignSpec, arguments: &FarmArguments, quiet: bool) -> Done<Self> {
        let mut farm = Self::listen(campaign, arguments)?;
        farm.start_workers()?;
        if !quiet {
            farm.print_endpoints();
        }
        Ok(farm)
    }

    /// Listens for workers of a campaign; Ctrl-C and SIGTERM end its batches.
    ///
    /// # Errors
    /// [`CommandError::Failed`], [`CommandError::Dispatch`], [`CommandError::BadInput`].
    pub fn listen(mut spec: CampaignSpec, arguments: &FarmArguments) -> Done<Self> {
        let FarmArguments { listen, config, insecure, licences, mixed_builds, cross_check, .. } =
            arguments.clone();
        spec.build = spec.build.filter(|_| !mixed_builds);
        match &mut spec.simulator {
            Some(simulator) => simulator.licences = licences,
            None if licences.is_some() => {
                let fault = "for scenes that name their own simulator, not for mechanisms";
                return Err(CommandError::refused("--licences", fault));
            }
            None => {}
        }
        let is_external = spec.simulator.is_some();
        let is_exact = !is_external && !mixed_builds;
        let share = cross_check.or(is_exact.then_some(0.0));
        spec.cross_check = share.map(|share| CrossCheck { share, is_exact });
        let listen = Listen { endpoint: listen, config, insecure };
        let interrupted = interruption()?;
        let campaign = spec.id;
        let evaluator = ZenohEvaluator::open(spec, &listen, interrupted)?;
        let (arguments, simulator) = (arguments.clone(), simulator());
        let watched = |endpoint: &String| {
            watch(endpoint.clone(), arguments.config.clone(), Watch::default(), || end_process(SILENT))
        };
        let _watched = evaluator.endpoints.first().map(watched).transpose()?;
        let (local, scaling) = (None, None);
        Ok(Self { evaluator, arguments, simulator, is_external, local, campaign, scaling, _watched })
    }

    /// Starts the local workers, and asks a batch system for others, if the arguments ask for any.
    ///
    /// # Errors
    /// [`CommandError::Worker`].
    pub fn start_workers(&mut self) -> Done {
        let slots = local_slots(&self.arguments);
        let endpoint = self.evaluator.endpoints.first().cloned();
        let spawn = |endpoint| {
            let zenoh_config = self.arguments.config.clone();
            // The learner and the dispatch run in this process too: simulations give way to them.
            let config =
                ServiceConfig { zenoh_config, give_way: true, ..ServiceConfig::new(endpoint, slots) };
            service::spawn(config, Arc::clone(&self.simulator))
        };
        self.local = endpoint.clone().filter(|_| slots > 0).map(spawn).transpose()?;
        let FarmArguments { scale, most, idle, .. } = &self.arguments;
        if let (Some(system), Some(most), Some(endpoint)) = (scale.clone(), *most, endpoint) {
            let settings = ScaleSettings { system, most, idle: idle.unwrap_or(Duration::from_secs(60)) };
            if !matches!(settings.system, BatchSystem::Command(_)) && endpoint.contains("/127.0.0.1:") {
                tracing::warn!(
                    "jobs on other machines cannot reach {endpoint}: --listen or --config sets another address"
                );
            }
            let (status, board) = (self.evaluator.status_handle(), self.evaluator.board.clone());
            let scaling = Scaling::start(settings, (endpoint, self.campaign), status, board);
            self.scaling =
                Some(scaling.map_err(|_| CommandError::Failed("workers cannot be asked for".to_owned()))?);
        }
        Ok(())
    }

    /// Prints the addresses for remote workers if there are no local ones.
    pub fn print_endpoints(&self) {
        if self.local.is_none() && self.scaling.is_none() {
            let more = if self.is_external { " --simulator FILE-OF-THIS-SCENE" } else { "" };
            for endpoint in &self.evaluator.endpoints {
                print_message(format_args!("waiting for workers: worker --connect {endpoint}{more}"));
            }
        }
    }

    /// Disconnects the workers and waits for the local ones to end.
    pub fn close(self) {
        self.evaluator.finish();
        drop(self.scaling);
        if let Some(Err(error)) = self.local.map(WorkerHandle::join) {
            // The command has its results; the end of a local worker only matters for diagnosis.
            tracing::warn!("local worker: {error}");
        }
    }
}

/// The campaign as announced to workers. A study has the same id whenever it is resumed.
///
/// # Errors
/// [`CommandError::Json`].
fn announced(source: &SceneSource, settings: &Settings, resumed: bool) -> Done<CampaignSpec> {
    let scene = source.nominal();
    let simulator = scene.simulator.as_ref().map(|simulator| CampaignSimulator {
        id: SimulatorId::new(simulator, scene),
        timeout: simulator.timeout,
        licences: None,
    });
    let campaign = of_mechanism(source, settings.accuracy.setting.clone(), &serde_json::to_string(settings)?);
    Ok(CampaignSpec { accuracy: settings.evaluated(scene), simulator, resumed, ..campaign })
}

/// A campaign of evaluations of a mechanism; its id is a digest of the scene and of the plan.
pub fn of_mechanism(source: &SceneSource, accuracy: NamedAccuracy, plan: &str) -> CampaignSpec {
    let digest = common::scene::source::digest(&format!("{plan}\n{}", source.text()));
    CampaignSpec {
        // The low half of a 128-bit hash is a 64-bit hash.
        id: digest as u64,
        scene: source.text().to_owned(),
        accuracy: accuracy.accuracy,
        accuracy_name: accuracy.name,
        build: Some(worker::BUILD),
        shape: Some(EvaluationShape::of(source.nominal())),
        simulator: None,
        cross_check: None,
        resumed: false,
    }
}
