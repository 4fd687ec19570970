//! The pages of a running study over HTTP: metrics, and the live report. Read-only; each server on a thread of its own.

use super::live::Live;
use super::metrics::metrics_text;
use super::watch::Source;
use axum::Router;
use axum::extract::{Path, Request, State};
use axum::http::{HeaderValue, StatusCode, header};
use axum::middleware::{Next, from_fn};
use axum::response::{IntoResponse, Json, Response};
use axum::routing::get;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::sync::Arc;
use thiserror::Error;
use tokio::net::TcpListener;
use tokio::runtime::Runtime;

/// Why there is no page.
#[derive(Debug, Error)]
pub enum MonitorError {
    /// No address.
    #[error(
        "{option} {given}: allowed: a port of this machine, or an address with a port such as 127.0.0.1:9464"
    )]
    Address {
        /// Option.
        option: &'static str,
        /// What was given.
        given: String,
    },
    /// An address other machines can reach.
    #[error(
        "{option} {address}: other machines can reach this address, and nobody is asked who they are; {allowed}"
    )]
    Open {
        /// Option.
        option: &'static str,
        /// The address.
        address: SocketAddr,
        /// What is allowed.
        allowed: &'static str,
    },
    /// The system refuses.
    #[error("{option} {address}: {reason}")]
    Refused {
        /// Option.
        option: &'static str,
        /// The address.
        address: SocketAddr,
        /// Why.
        reason: std::io::Error,
    },
}

impl MonitorError {
    /// Whether the user can mend it (exit code 2).
    pub fn is_bad_input(&self) -> bool {
        !matches!(self, MonitorError::Refused { .. })
    }
}

/// The address to listen on: a port of this machine alone, or an address in full. One that other machines can reach only
/// where `open` says that it may be.
///
/// # Errors
/// [`MonitorError::Address`], [`MonitorError::Open`].
pub fn address(
    option: &'static str,
    given: &str,
    open: Result<(), &'static str>,
) -> Result<SocketAddr, MonitorError> {
    let port = given.parse().map(|port| SocketAddr::from((Ipv4Addr::LOCALHOST, port)));
    let address: SocketAddr = port
        .or_else(|_| given.parse())
        .map_err(|_| MonitorError::Address { option, given: given.to_owned() })?;
    match open {
        Err(allowed) if !address.ip().is_loopback() => Err(MonitorError::Open { option, address, allowed }),
        _ => Ok(address),
    }
}

/// A server at work. Dropped, it ends at once.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    runtime: Option<Runtime>,
}

impl Server {
    /// Serves `/metrics`.
    ///
    /// # Errors
    /// [`MonitorError::Refused`].
    pub fn metrics(address: SocketAddr, source: Source) -> Result<Self, MonitorError> {
        Self::start("--metrics", address, Router::new().route("/metrics", get(metrics)).with_state(source))
    }

    /// Serves the live report, to this machine's own names alone: a page of somebody else that calls itself by another
    /// name cannot read it through a browser here.
    ///
    /// # Errors
    /// [`MonitorError::Refused`].
    pub fn live(address: SocketAddr, live: Arc<Live>) -> Result<Self, MonitorError> {
        let router = Router::new()
            .route("/", get(page))
            .route("/news/{after}", get(news))
            .route("/live.js", get(script))
            .with_state(live)
            .layer(from_fn(only_here));
        Self::start("--live", address, router)
    }

    fn start(option: &'static str, address: SocketAddr, router: Router) -> Result<Self, MonitorError> {
        let refused = |reason| MonitorError::Refused { option, address, reason };
        let mut builder = tokio::runtime::Builder::new_multi_thread();
        builder.worker_threads(1).max_blocking_threads(2).thread_name("monitor").enable_all();
        let runtime = builder.build().map_err(refused)?;
        let listener = runtime.block_on(TcpListener::bind(address)).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        runtime.spawn(async move { axum::serve(listener, router).await });
        Ok(Self { address, runtime: Some(runtime) })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

/// Runs what computes beside those who serve.
async fn beside<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Result<T, StatusCode> {
    tokio::task::spawn_blocking(work).await.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)
}

async fn metrics(State(source): State<Source>) -> Result<Response, StatusCode> {
    let status = beside(move || source.status()).await?.ok_or(StatusCode::SERVICE_UNAVAILABLE)?;
    let kind = (header::CONTENT_TYPE, HeaderValue::from_static("text/plain; version=0.0.4; charset=utf-8"));
    Ok(([kind], metrics_text(&status)).into_response())
}

/// The page may load its own script and nothing else.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'self'; connect-src 'self'; \
                      img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

async fn page(State(live): State<Arc<Live>>) -> Result<Response, StatusCode> {
    let view = beside(move || live.view()).await?;
    let headers = [
        (header::CONTENT_TYPE, HeaderValue::from_static("text/html; charset=utf-8")),
        (header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(POLICY)),
        (header::CACHE_CONTROL, HeaderValue::from_static("no-store")),
        (header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff")),
    ];
    Ok((headers, view.html).into_response())
}

async fn script() -> Response {
    let kind = (header::CONTENT_TYPE, HeaderValue::from_static("text/javascript; charset=utf-8"));
    ([kind], include_str!("live.js")).into_response()
}

/// Answers as soon as there is a page newer than the one the reader has, or after a while.
async fn news(State(live): State<Arc<Live>>, Path(after): Path<u64>) -> Response {
    Json(live.news(after).await).into_response()
}

/// Refuses requests for a host name that is not this machine's own.
async fn only_here(request: Request, next: Next) -> Response {
    let host = request.headers().get(header::HOST).and_then(|host| host.to_str().ok()).unwrap_or_default();
    if is_here(host) { next.run(request).await } else { StatusCode::FORBIDDEN.into_response() }
}

fn is_here(host: &str) -> bool {
    let name = match host.rsplit_once(':') {
        Some((name, port)) if port.parse::<u16>().is_ok() => name,
        _ => host,
    };
    let name = name.trim_start_matches('[').trim_end_matches(']');
    name == "localhost" || name.parse::<IpAddr>().is_ok_and(|address| address.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_alone_is_of_this_machine_and_open_addresses_are_refused() {
        let closed = Err("allowed: a loopback address");
        assert_eq!(address("--live", "8080", closed).unwrap(), "127.0.0.1:8080".parse().unwrap());
        assert_eq!(address("--live", "[::1]:7", closed).unwrap().port(), 7);
        let error = address("--metrics", "0.0.0.0:9464", closed).unwrap_err();
        assert!(error.is_bad_input() && error.to_string().contains("--metrics 0.0.0.0:9464"), "{error}");
        assert!(address("--metrics", "0.0.0.0:9464", Ok(())).is_ok());
        for slip in ["", "70000", "localhost:8080", "http://127.0.0.1:1"] {
            assert!(matches!(address("--live", slip, Ok(())), Err(MonitorError::Address { .. })), "{slip}");
        }
    }

    #[test]
    fn only_names_of_this_machine_are_answered() {
        for host in ["localhost", "localhost:8080", "127.0.0.1:8080", "127.8.8.8", "[::1]:8080", "[::1]"] {
            assert!(is_here(host), "{host}");
        }
        for host in ["", "evil.example", "evil.example:8080", "192.168.1.20:8080", "localhost.evil.example"] {
            assert!(!is_here(host), "{host}");
        }
    }
}
