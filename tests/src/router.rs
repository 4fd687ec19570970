//! The router `zenohd` as a process, with `zenoh-router.json5` of `deploy/`, and two sites connected by two of them:
//!
//! ```text
//! coordinator <--- router of the near site <--- router of the far site <--- workers
//! ```

use crate::deployed::{KilledOnDrop, certificates, changed_configuration, configuration, has_openssl};
use crate::skipped;
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Longest time for a router to listen; only a defect takes longer.
const PATIENCE: Duration = Duration::from_secs(30);
/// The only host name in the certificates of coordinator and routers that accepts connections here.
const HOST: &str = "127.0.0.1";
/// A worker that the routers permit.
const PERMITTED: &str = "worker:worker-1.example";

/// Path of the program `zenohd`: `$ZENOHD`, otherwise the one on `PATH`. `None`, with a message, if it is not installed.
pub fn zenohd(what: &str) -> Option<PathBuf> {
    if !has_openssl(what) {
        return None;
    }
    let program = PathBuf::from(std::env::var_os("ZENOHD").unwrap_or_else(|| "zenohd".into()));
    match Command::new(&program).arg("--version").output() {
        Ok(output) if output.status.success() => Some(program),
        Ok(output) => panic!("{} --version: {}", program.display(), String::from_utf8_lossy(&output.stderr)),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            let install = "cargo install zenohd --version 1.10.2 --locked";
            skipped(what, &format!("{} is not installed ({install}, or $ZENOHD)", program.display()));
            None
        }
        Err(error) => panic!("{}: {error}", program.display()),
    }
}

/// A router that can be killed and started again at the same endpoint.
pub struct Router {
    zenohd: PathBuf,
    config: PathBuf,
    address: String,
    process: Option<KilledOnDrop>,
}

impl Router {
    /// Starts a router with the certificate in `own`, connected to the endpoint `up`; its files go to `folder`.
    fn start_with(zenohd: &Path, folder: &Path, own: &Path, up: &str) -> Self {
        std::fs::create_dir_all(folder).expect("it can be made");
        for file in ["ca.pem", "certificate.pem", "key.pem"] {
            std::fs::copy(own.join(file), folder.join(file)).expect("certificates.sh makes it");
        }
        let address = free_address();
        let trunk = "\"coordinator.example\", \"gateway.site-a.example\", \"gateway.site-b.example\"";
        let changes = [
            (trunk, "\"127.0.0.1\""),
            ("tls/0.0.0.0:7447", &format!("tls/{address}")),
            ("tls/coordinator.example:7447", up),
        ];
        let config = changed_configuration("zenoh-router.json5", folder, &changes);
        let mut router = Self { zenohd: zenohd.to_owned(), config, address, process: None };
        router.start();
        router
    }

    /// Starts the router again.
    pub fn start(&mut self) {
        let mut command = Command::new(&self.zenohd);
        command.arg("--config").arg(&self.config).stdout(Stdio::null()).stderr(Stdio::null());
        self.process = Some(KilledOnDrop(command.spawn().expect("zenohd starts")));
        let started = Instant::now();
        while TcpStream::connect(&self.address).is_err() {
            assert!(started.elapsed() < PATIENCE, "zenohd does not listen on {}", self.address);
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Kills the router with SIGKILL.
    pub fn kill(&mut self) {
        self.process = None;
    }

    /// Endpoint for workers and other routers.
    pub fn endpoint(&self) -> String {
        format!("tls/{}", self.address)
    }
}

/// An address of this machine with a port that is free now.
fn free_address() -> String {
    let listener = TcpListener::bind((HOST, 0)).expect("a port is free");
    listener.local_addr().expect("it is bound").to_string()
}

/// Two sites connected by routers, and the Zenoh settings of their programs.
pub struct TwoSites {
    /// Router of the coordinator's site.
    pub near: Router,
    /// Router of the workers' site.
    pub far: Router,
    /// Endpoint of the coordinator.
    pub coordinator: String,
    /// Settings of the coordinator.
    pub coordinator_config: PathBuf,
    /// Settings of permitted workers.
    pub worker_config: PathBuf,
    /// Settings of a worker with a certificate of the same authority whose name no router lists.
    pub unlisted_config: PathBuf,
    /// Settings of a worker with a certificate of another authority.
    pub stranger_config: PathBuf,
    /// Settings of a worker without a certificate.
    pub anonymous_config: PathBuf,
}

impl TwoSites {
    /// Makes the certificates in `folder` and starts both routers; they wait for the coordinator.
    pub fn start(zenohd: &Path, folder: &Path) -> Self {
        let own = certificates(&folder.join("tls"), HOST);
        let worker = certificates(&folder.join("tls"), PERMITTED);
        let unlisted = certificates(&folder.join("tls"), "worker:visitor.example");
        let stranger = certificates(&folder.join("other"), PERMITTED);
        std::fs::copy(own.join("ca.pem"), stranger.join("ca.pem")).expect("both exist");
        let anonymous = folder.join("anonymous");
        std::fs::create_dir_all(&anonymous).expect("it can be made");
        std::fs::copy(own.join("ca.pem"), anonymous.join("ca.pem")).expect("both exist");

        let coordinator = format!("tls/{}", free_address());
        let near = Router::start_with(zenohd, &folder.join("near"), &own, &coordinator);
        let far = Router::start_with(zenohd, &folder.join("far"), &own, &near.endpoint());
        let tls = |own: &Path| configuration("zenoh-tls.json5", own);
        Self {
            near,
            far,
            coordinator,
            coordinator_config: tls(&own),
            worker_config: tls(&worker),
            unlisted_config: tls(&unlisted),
            stranger_config: tls(&stranger),
            anonymous_config: configuration("zenoh-password-worker.json5", &anonymous),
        }
    }
}
