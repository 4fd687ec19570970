//! `worker --serve-umbridge`: a server of the UM-Bridge protocol, version 1.0, with one model, the evaluation of a scene.
//! As many evaluations run concurrently as there are slots; further requests wait.
//!
//! The model has one input vector, the random variables in the order of the scene, and one output vector per output, its values at the
//! checkpoints. All in SI.
//!
//! # Source
//! See [`common::umbridge`].

use crate::simulate::{SimulateOptions, simulate};
use axum::Router;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Json, Response};
use axum::routing::{get, post};
use common::accuracy::NamedAccuracy;
use common::failure::SimulationFailure;
use common::scene::{Faults, SceneSource};
use common::umbridge::{
    ErrorBody, ErrorReply, EvaluateRequest, Evaluated, INVALID_INPUT, Info, InputSizes, MODEL_NOT_FOUND,
    ModelInfo, OutputSizes, PROTOCOL_VERSION, SIMULATION_FAILED, SizesRequest, Support, UNSUPPORTED_FEATURE,
};
use common::wire::find_non_finite;
use serde::Serialize;
use serde::de::{DeserializeOwned, IgnoredAny};
use serde_json::{Map, Value};
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use thiserror::Error;
use tokio::net::TcpListener;
use tokio::runtime::Runtime;
use tokio::sync::{Semaphore, oneshot};

/// Reasons for the server not to start.
#[derive(Debug, Error)]
pub enum UmBridgeError {
    /// The text is not an address. Holds the text of the address.
    #[error("--serve-umbridge {0}: allowed: a port, or an address with a port such as 127.0.0.1:4242")]
    Address(String),
    /// Other machines can reach the address, and UM-Bridge does not authenticate clients. Holds the address to listen on.
    #[error(
        "--serve-umbridge {0}: other machines can reach this address, and UM-Bridge does not authenticate \
         clients; give a port alone (this machine only), or --insecure if the network is trusted"
    )]
    Insecure(SocketAddr),
    /// The scene names an external simulator, so it has no mechanism. Holds the file or name of the scene.
    #[error("{0}: the scene names an external simulator; it has no mechanism to serve")]
    NoMechanism(String),
    /// The operating system refuses the address.
    #[error("--serve-umbridge {address}: {reason}")]
    Refused {
        /// Address to listen on.
        address: SocketAddr,
        /// Error of the operating system.
        reason: std::io::Error,
    },
}

/// Parses the address to listen on: a port (on the loopback address), or `ADDRESS:PORT`.
///
/// # Errors
/// [`UmBridgeError::Address`]; [`UmBridgeError::Insecure`] for an address that other machines reach, unless that is allowed: `insecure`.
pub fn address(given: &str, insecure: bool) -> Result<SocketAddr, UmBridgeError> {
    let port = given.parse().map(|port| SocketAddr::from((Ipv4Addr::LOCALHOST, port)));
    let address: SocketAddr =
        port.or_else(|_| given.parse()).map_err(|_| UmBridgeError::Address(given.to_owned()))?;
    if address.ip().is_loopback() || insecure { Ok(address) } else { Err(UmBridgeError::Insecure(address)) }
}

/// A running server. When dropped, it ends at once.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    /// Runtime with the threads of the server.
    runtime: Runtime,
    stop: oneshot::Sender<()>,
    done: tokio::task::JoinHandle<std::io::Result<()>>,
}

impl Server {
    /// Serves a model with `slots` concurrent evaluations; port 0 selects any free port.
    ///
    /// # Errors
    /// [`UmBridgeError::Refused`].
    pub fn start(model: Model, slots: usize, address: SocketAddr) -> Result<Self, UmBridgeError> {
        let refused = |reason| UmBridgeError::Refused { address, reason };
        let mut builder = tokio::runtime::Builder::new_multi_thread();
        builder.worker_threads(1).max_blocking_threads(slots.max(1)).thread_name("umbridge").enable_all();
        let runtime = builder.build().map_err(refused)?;
        let listener = runtime.block_on(TcpListener::bind(address)).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        let (stop, stopped) = oneshot::channel::<()>();
        let state = Arc::new((model, Semaphore::new(slots.max(1))));
        let serve = axum::serve(listener, routes(state)).with_graceful_shutdown(async {
            // The sender stops the server, or was dropped: both end it.
            let _ = stopped.await;
        });
        let done = runtime.spawn(serve.into_future());
        Ok(Self { address, runtime, stop, done })
    }

    /// Address on which the server listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Accepts no further requests, answers the open ones, and returns.
    pub fn finish(self) {
        if self.stop.send(()).is_ok()
            && let Err(error) = self.runtime.block_on(self.done)
        {
            tracing::error!("the server ended with an error: {error}");
        }
        // Only simulations whose clients have disconnected can still be running.
        self.runtime.shutdown_background();
    }
}

/// What the request handlers share: the model, and as many permits as evaluations run at a time.
type ServerState = (Model, Semaphore);

fn routes(state: Arc<ServerState>) -> Router {
    let mut router = Router::new()
        .route("/Info", get(info))
        .route("/ModelInfo", post(model_info))
        .route("/InputSizes", post(input_sizes))
        .route("/OutputSizes", post(output_sizes))
        .route("/Evaluate", post(evaluate));
    for derivative in ["/Gradient", "/ApplyJacobian", "/ApplyHessian"] {
        router = router.route(derivative, post(unsupported));
    }
    router.with_state(state)
}

async fn info() -> Json<Info> {
    Json(Info { protocol_version: PROTOCOL_VERSION, models: vec![NAME.to_owned()] })
}

async fn model_info(State(state): State<Arc<ServerState>>, body: Bytes) -> Response {
    reply((|| {
        let request: SizesRequest<IgnoredAny> = read(&body)?;
        state.0.configured(&request.name, None)?;
        Ok(ModelInfo { support: Support { evaluate: true, ..Support::default() } })
    })())
}

async fn input_sizes(State(state): State<Arc<ServerState>>, body: Bytes) -> Response {
    reply(sizes(&state, &body).map(|()| InputSizes { input_sizes: state.0.input_sizes() }))
}

async fn output_sizes(State(state): State<Arc<ServerState>>, body: Bytes) -> Response {
    reply(sizes(&state, &body).map(|()| OutputSizes { output_sizes: state.0.output_sizes() }))
}

/// Checks a request for sizes. They do not depend on the configuration, which is checked all the same.
fn sizes(state: &ServerState, body: &Bytes) -> Result<(), ErrorBody> {
    let request: SizesRequest<Config> = read(body)?;
    state.0.configured(&request.name, request.config.as_ref()).map(drop)
}

async fn evaluate(State(state): State<Arc<ServerState>>, body: Bytes) -> Response {
    let checked = read::<EvaluateRequest<Config>>(&body).and_then(|request| state.0.check(request));
    let (sample, accuracy) = match checked {
        Ok(checked) => checked,
        Err(error) => return reply::<()>(Err(error)),
    };
    let shared = Arc::clone(&state);
    let failed = |message: String| ErrorBody { kind: SIMULATION_FAILED.into(), message };
    let evaluated = match state.1.acquire().await {
        Ok(_slot) => tokio::task::spawn_blocking(move || shared.0.evaluate(&sample, &accuracy)).await,
        Err(closed) => return reply::<()>(Err(failed(closed.to_string()))),
    };
    // A panic is a defect of the program at this sample; the server keeps running.
    reply(evaluated.unwrap_or_else(|panic| Err(failed(panic.to_string()))))
}

async fn unsupported() -> Response {
    let message = "the model supports evaluation only, no derivatives".to_owned();
    reply::<()>(Err(ErrorBody { kind: UNSUPPORTED_FEATURE.into(), message }))
}

/// Parses the body of a request as JSON, whatever its content type: some clients do not set one.
fn read<T: DeserializeOwned>(body: &Bytes) -> Result<T, ErrorBody> {
    serde_json::from_slice(body).map_err(|error| invalid(format!("the request: {error}")))
}

fn reply<T: Serialize>(result: Result<T, ErrorBody>) -> Response {
    match result {
        Ok(body) => Json(body).into_response(),
        Err(error) => {
            let simulation_failed = error.kind == SIMULATION_FAILED;
            let status =
                if simulation_failed { StatusCode::INTERNAL_SERVER_ERROR } else { StatusCode::BAD_REQUEST };
            (status, Json(ErrorReply { error })).into_response()
        }
    }
}

/// Name of the model, as UM-Bridge models are named by convention.
pub const NAME: &str = "forward";

/// Configuration of a request, e.g. `{"accuracy": "draft"}`.
type Config = Map<String, Value>;

/// The evaluation of one scene as a UM-Bridge model.
#[derive(Debug, Clone)]
pub struct Model {
    source: SceneSource,
    accuracy: NamedAccuracy,
}

impl Model {
    /// A model of a scene; `accuracy` applies unless a request names another one.
    pub fn new(source: SceneSource, accuracy: NamedAccuracy) -> Self {
        Self { source, accuracy }
    }

    /// Lengths of the input vectors.
    fn input_sizes(&self) -> Vec<usize> {
        vec![self.source.variables().len()]
    }

    /// Lengths of the output vectors.
    fn output_sizes(&self) -> Vec<usize> {
        let scene = self.source.nominal();
        vec![scene.life.checkpoints().len(); scene.outputs.len()]
    }

    /// Checks name and configuration of a request; returns the accuracy to use.
    ///
    /// # Errors
    /// The error to send to the client.
    fn configured(&self, name: &str, config: Option<&Config>) -> Result<NamedAccuracy, ErrorBody> {
        if name != NAME {
            let message = format!("unknown model \"{name}\"; available: {NAME}");
            return Err(ErrorBody { kind: MODEL_NOT_FOUND.into(), message });
        }
        let mut accuracy = self.accuracy.clone();
        for (key, value) in config.into_iter().flatten() {
            if key != "accuracy" {
                return Err(invalid(format!("config: unknown key \"{key}\"; allowed: accuracy")));
            }
            let text = value
                .as_str()
                .ok_or_else(|| invalid(format!("config: accuracy is {value}, expected a string")))?;
            accuracy =
                text.parse().map_err(|reason| invalid(format!("config: accuracy \"{text}\": {reason}")))?;
        }
        Ok(accuracy)
    }

    /// Checks an evaluation request; returns its sample and the accuracy to use.
    ///
    /// # Errors
    /// The error to send to the client.
    fn check(&self, request: EvaluateRequest<Config>) -> Result<(Vec<f64>, NamedAccuracy), ErrorBody> {
        let accuracy = self.configured(&request.name, request.config.as_ref())?;
        let sizes: Vec<usize> = request.input.iter().map(Vec::len).collect();
        if sizes != self.input_sizes() {
            let expected = self.input_sizes();
            return Err(invalid(format!("input has vectors of {sizes:?} values, expected {expected:?}")));
        }
        Ok((request.input.into_iter().flatten().collect(), accuracy))
    }

    /// Simulates the sample of a checked request.
    ///
    /// # Errors
    /// The error to send to the client.
    fn evaluate(&self, sample: &[f64], accuracy: &NamedAccuracy) -> Result<Evaluated<f64>, ErrorBody> {
        let body = |message: String| ErrorBody { kind: SIMULATION_FAILED.into(), message };
        let failed = |failure: SimulationFailure| body(failure.to_string());
        let invalid =
            |faults: Faults| failed(SimulationFailure::InvalidSample { faults: faults.to_string() });
        let scene = self.source.resolve_sample(sample).map_err(invalid)?;
        let evaluation = simulate(&scene, &accuracy.accuracy, SimulateOptions::default()).map_err(failed)?;
        match find_non_finite(&evaluation) {
            Some((quantity, _)) => Err(body(format!("{quantity} is not finite"))),
            None => Ok(Evaluated { output: evaluation.histories }),
        }
    }
}

/// The error for an invalid request.
fn invalid(message: String) -> ErrorBody {
    ErrorBody { kind: INVALID_INPUT.into(), message }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_alone_is_a_loopback_address() {
        assert_eq!(address("4242", false).unwrap(), "127.0.0.1:4242".parse().unwrap());
        assert_eq!(address("[::1]:7", false).unwrap().port(), 7);
        for open in ["0.0.0.0:4242", "192.168.1.20:4242"] {
            let error = address(open, false).unwrap_err();
            assert!(error.to_string().contains(open) && error.to_string().contains("--insecure"), "{error}");
            assert_eq!(address(open, true).unwrap(), open.parse().unwrap());
        }
        for slip in ["", "70000", "localhost:4242", "http://127.0.0.1:1"] {
            assert!(matches!(address(slip, true), Err(UmBridgeError::Address(_))), "{slip}");
        }
    }
}
