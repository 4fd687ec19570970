//! HTTP server of a running study: the live report. Read-only, in a thread of its own.

use super::live::LivePage;
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

/// The reason why a server cannot start at an address.
#[derive(Debug, Error)]
#[error("--live {address}: {reason}")]
pub struct MonitorError {
    /// Address of the option, as given.
    pub address: String,
    /// That it is none, that other machines can reach it, or the reason given by the system.
    pub reason: String,
}

/// Address to listen on: of a port alone the loopback address of this machine, or a full loopback address.
///
/// # Errors
/// [`MonitorError`], also for an address that other machines can reach.
pub fn listen_address(given: &str) -> Result<SocketAddr, MonitorError> {
    let port = given.parse().map(|port| SocketAddr::from((Ipv4Addr::LOCALHOST, port)));
    let refused = |reason: &str| MonitorError { address: given.to_owned(), reason: reason.to_owned() };
    let address: SocketAddr = port.or_else(|_| given.parse()).map_err(|_| {
        refused("allowed: a port of this machine, or an address with a port such as 127.0.0.1:9464")
    })?;
    if address.ip().is_loopback() {
        return Ok(address);
    }
    Err(refused(
        "other machines can reach this address and clients are not authenticated; allowed: a port alone, or an address of this \
         machine only; use ssh -L from other machines",
    ))
}

/// A running server, which ends when dropped.
#[derive(Debug)]
pub struct MonitorServer {
    /// Address it listens on.
    pub address: SocketAddr,
    runtime: Option<Runtime>,
}

impl MonitorServer {
    /// Serves the live report for requests to a loopback host name only: a page of another host name cannot read it through
    /// a browser of this machine.
    ///
    /// # Errors
    /// [`MonitorError`].
    pub fn live(address: SocketAddr, live: Arc<LivePage>) -> Result<Self, MonitorError> {
        let router = Router::new()
            .route("/", get(page))
            .route("/news/{after}", get(update))
            .route("/live.js", get(script))
            .route("/report.html", get(report))
            .route("/figures/{name}", get(figure))
            .with_state(live)
            .layer(from_fn(require_loopback_host));
        let refused = |error: std::io::Error| {
            let (address, reason) = (address.to_string(), error.to_string());
            MonitorError { address, reason }
        };
        let mut builder = tokio::runtime::Builder::new_multi_thread();
        builder.worker_threads(1).max_blocking_threads(2).thread_name("monitor").enable_all();
        let runtime = builder.build().map_err(refused)?;
        let listener = runtime.block_on(TcpListener::bind(address)).map_err(refused)?;
        let address = listener.local_addr().map_err(refused)?;
        runtime.spawn(async move { axum::serve(listener, router).await });
        Ok(Self { address, runtime: Some(runtime) })
    }
}

impl Drop for MonitorServer {
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

/// Runs a computation on a blocking thread, so that requests are still served.
async fn compute<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Result<T, StatusCode> {
    tokio::task::spawn_blocking(work).await.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)
}

/// Content security policy: the page may load its own script only.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'self'; connect-src 'self'; \
                      img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

async fn page(State(live): State<Arc<LivePage>>) -> Result<Response, StatusCode> {
    Ok(html(compute(move || live.view()).await?, POLICY))
}

/// Content security policy of the report of a finished study: the script of its animation is part of it.
const REPORT_POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src 'self' data:; \
                             base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// The report in the folder of a study that has ended.
async fn report(State(live): State<Arc<LivePage>>) -> Result<Response, StatusCode> {
    Ok(html(file(live, "report.html".to_owned()).await?, REPORT_POLICY))
}

/// A page with this content security policy, which is not kept.
fn html(text: String, policy: &'static str) -> Response {
    let headers = [
        (header::CONTENT_TYPE, "text/html; charset=utf-8"),
        (header::CONTENT_SECURITY_POLICY, policy),
        (header::CACHE_CONTROL, "no-store"),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    ];
    (headers, text).into_response()
}

/// A figure beside the report, as SVG or CSV.
async fn figure(State(live): State<Arc<LivePage>>, Path(name): Path<String>) -> Result<Response, StatusCode> {
    // No path leads out of the folder.
    let is_name =
        name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c)) && !name.starts_with('.');
    let kind = match name.rsplit_once('.') {
        Some((_, "svg")) if is_name => "image/svg+xml",
        Some((_, "csv")) if is_name => "text/csv; charset=utf-8",
        _ => return Err(StatusCode::NOT_FOUND),
    };
    let text = file(live, format!("figures/{name}")).await?;
    Ok(([(header::CONTENT_TYPE, HeaderValue::from_static(kind))], text).into_response())
}

/// A file of a study that has ended.
async fn file(live: Arc<LivePage>, name: String) -> Result<String, StatusCode> {
    compute(move || live.result_file(&name)).await?.ok_or(StatusCode::NOT_FOUND)
}

async fn script() -> Response {
    let kind = (header::CONTENT_TYPE, HeaderValue::from_static("text/javascript; charset=utf-8"));
    ([kind], include_str!("live.js")).into_response()
}

/// Answers when a page newer than revision `after` is available, or after a timeout.
async fn update(State(live): State<Arc<LivePage>>, Path(after): Path<u64>) -> Response {
    Json(live.update_after(after).await).into_response()
}

/// Refuses requests for a host name other than a loopback name.
async fn require_loopback_host(request: Request, next: Next) -> Response {
    let host = request.headers().get(header::HOST).and_then(|host| host.to_str().ok()).unwrap_or_default();
    if is_loopback(host) { next.run(request).await } else { StatusCode::FORBIDDEN.into_response() }
}

fn is_loopback(host: &str) -> bool {
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
    fn a_port_alone_is_a_loopback_address_and_reachable_addresses_are_refused() {
        assert_eq!(listen_address("8080").unwrap(), "127.0.0.1:8080".parse().unwrap());
        assert_eq!(listen_address("[::1]:7").unwrap().port(), 7);
        let error = listen_address("0.0.0.0:9464").unwrap_err();
        assert!(error.to_string().contains("--live 0.0.0.0:9464"), "{error}");
        for slip in ["", "70000", "localhost:8080", "http://127.0.0.1:1"] {
            let error = listen_address(slip).unwrap_err();
            assert!(error.reason.starts_with("allowed: a port"), "{slip}: {error}");
        }
    }

    #[test]
    fn only_loopback_host_names_are_answered() {
        for host in ["localhost", "localhost:8080", "127.0.0.1:8080", "127.8.8.8", "[::1]:8080", "[::1]"] {
            assert!(is_loopback(host), "{host}");
        }
        for host in ["", "evil.example", "evil.example:8080", "192.168.1.20:8080", "localhost.evil.example"] {
            assert!(!is_loopback(host), "{host}");
        }
    }
}
