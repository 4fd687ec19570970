//! `worker --serve-umbridge`: a server of the UM-Bridge protocol, version 1.0, with one model, the evaluation of a scene.
//! As many evaluations run concurrently as there are slots; further requests wait.
//!
//! # Source
//! See [`common::umbridge`].

mod model;

pub use model::{Model, NAME};

use axum::Router;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Json, Response};
use axum::routing::{get, post};
use common::umbridge::{
    ErrorBody, ErrorReply, EvaluateRequest, Info, InputSizes, ModelInfo, OutputSizes, PROTOCOL_VERSION,
    SIMULATION_FAILED, SizesRequest, Support, UNSUPPORTED_FEATURE,
};
use model::{Config, invalid};
use serde::Serialize;
use serde::de::{DeserializeOwned, IgnoredAny};
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

/// Machines whose clients may connect to the server.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// Only this machine: loopback addresses.
    ThisMachine,
    /// Any machine that reaches the address, without authentication.
    AnyMachine,
}

/// Parses the address to listen on: a port (on the loopback address), or `ADDRESS:PORT`.
///
/// # Errors
/// [`UmBridgeError::Address`]; [`UmBridgeError::Insecure`] for an address that `access` does not allow.
pub fn address(given: &str, access: Access) -> Result<SocketAddr, UmBridgeError> {
    let port = given.parse().map(|port| SocketAddr::from((Ipv4Addr::LOCALHOST, port)));
    let address: SocketAddr =
        port.or_else(|_| given.parse()).map_err(|_| UmBridgeError::Address(given.to_owned()))?;
    if address.ip().is_loopback() || access == Access::AnyMachine {
        Ok(address)
    } else {
        Err(UmBridgeError::Insecure(address))
    }
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
        let state = Arc::new(ServerState { model, slots: Semaphore::new(slots.max(1)) });
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

/// State shared by the request handlers.
struct ServerState {
    model: Model,
    slots: Semaphore,
}

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
        state.model.configured(&request.name, None)?;
        Ok(ModelInfo { support: Support { evaluate: true, ..Support::default() } })
    })())
}

async fn input_sizes(State(state): State<Arc<ServerState>>, body: Bytes) -> Response {
    reply(sizes(&state, &body).map(|()| InputSizes { input_sizes: state.model.input_sizes() }))
}

async fn output_sizes(State(state): State<Arc<ServerState>>, body: Bytes) -> Response {
    reply(sizes(&state, &body).map(|()| OutputSizes { output_sizes: state.model.output_sizes() }))
}

/// Checks a request for sizes. They do not depend on the configuration, which is checked all the same.
fn sizes(state: &ServerState, body: &Bytes) -> Result<(), ErrorBody> {
    let request: SizesRequest<Config> = read(body)?;
    state.model.configured(&request.name, request.config.as_ref()).map(drop)
}

async fn evaluate(State(state): State<Arc<ServerState>>, body: Bytes) -> Response {
    let checked = read::<EvaluateRequest<Config>>(&body).and_then(|request| state.model.check(request));
    let request = match checked {
        Ok(request) => request,
        Err(error) => return reply::<()>(Err(error)),
    };
    let shared = Arc::clone(&state);
    let failed = |message: String| ErrorBody { kind: SIMULATION_FAILED.into(), message };
    let evaluated = match state.slots.acquire().await {
        Ok(_slot) => tokio::task::spawn_blocking(move || shared.model.evaluate(&request)).await,
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_alone_is_a_loopback_address() {
        assert_eq!(address("4242", Access::ThisMachine).unwrap(), "127.0.0.1:4242".parse().unwrap());
        assert_eq!(address("[::1]:7", Access::ThisMachine).unwrap().port(), 7);
        for open in ["0.0.0.0:4242", "192.168.1.20:4242"] {
            let error = address(open, Access::ThisMachine).unwrap_err();
            assert!(error.to_string().contains(open) && error.to_string().contains("--insecure"), "{error}");
            assert_eq!(address(open, Access::AnyMachine).unwrap(), open.parse().unwrap());
        }
        for slip in ["", "70000", "localhost:4242", "http://127.0.0.1:1"] {
            assert!(matches!(address(slip, Access::AnyMachine), Err(UmBridgeError::Address(_))), "{slip}");
        }
    }
}
