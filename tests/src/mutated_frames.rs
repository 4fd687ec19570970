//! Zenoh sessions whose frames are changed on their way to a coordinator, below the codec of this program: real clients connect through a
//! proxy that changes bytes. The coordinator must go on, or end with its cause and go on when resumed; it must not live on in silence.

mod replay;

use crate::deployed::{KilledOnDrop, LoggedProcess, small_scene, try_session};
use crate::faults::soak::Random;
use crate::program;
use common::wire::{WorkerId, keys};
use coordinator::farm::dispatch::ClientSession;
use std::io::{Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{ChildStdin, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};
use zenoh::Wait;

/// Time in which a coordinator that lives has to answer.
const PATIENCE: Duration = Duration::from_secs(20);
/// Time in which a coordinator ends that does not answer its own queries: three of them, twenty seconds apart.
const UNTIL_END: Duration = Duration::from_secs(180);
/// Sessions between two looks at the coordinator.
const SESSIONS_PER_LOOK: u64 = 20;
/// Processes of clients at the same time.
const AT_ONCE: u64 = 4;
const SESSIONS_OF_A_HAND: u64 = SESSIONS_PER_LOOK / AT_ONCE;
/// Changes the frames that a client sends, from the length of each on; true if it did.
pub type Mutate = dyn Fn(&mut Vec<u8>) -> bool + Send + Sync;

/// What has happened.
#[derive(Debug, Default)]
pub struct Figures {
    /// Sessions through the proxy.
    pub sessions: u64,
    /// Frames that were changed.
    pub changed: u64,
    /// Ends of the coordinator, each with a cause and followed by `resume`.
    pub ends: Vec<String>,
}

/// A changed byte, a few of them, a frame cut or prolonged, by a generator that starts at `seed`: one frame of five.
pub fn random_changes(seed: u64) -> Box<Mutate> {
    let random = Mutex::new(Random(seed));
    let draw = move |below: u64| random.lock().unwrap_or_else(PoisonError::into_inner).below(below);
    Box::new(move |frame| {
        if frame.is_empty() || draw(5) > 0 {
            return false;
        }
        match draw(8) {
            0 => frame.truncate(draw(frame.len() as u64) as usize),
            1 => frame.extend((0..=draw(40)).map(|_| draw(256) as u8)),
            kind => {
                for _ in 0..=(if kind == 2 { draw(8) } else { 0 }) {
                    let at = draw(frame.len() as u64) as usize;
                    frame[at] = if kind < 6 { draw(256) as u8 } else { frame[at] ^ (1 << draw(8)) };
                }
            }
        }
        true
    })
}

/// A coordinator that waits for workers, a proxy before it, and clients of the proxy.
pub struct Attack {
    folder: PathBuf,
    /// Zenoh settings of coordinator and proxy with mutual TLS, and the folder of the certificates.
    tls: Option<(PathBuf, PathBuf)>,
    port: u16,
    coordinator: LoggedProcess,
    figures: Figures,
}

impl Attack {
    /// Starts the coordinator of a small study in `folder`; with mutual TLS if `tls` is a configuration and a folder of certificates.
    pub fn start(folder: &Path, tls: Option<(PathBuf, PathBuf)>) -> Self {
        std::fs::write(folder.join("small.toml"), small_scene(12)).expect("the folder can be written");
        let port =
            TcpListener::bind("127.0.0.1:0").and_then(|free| free.local_addr()).expect("a free port").port();
        let folder = folder.to_owned();
        let coordinator = Self::coordinator(&folder, &tls, port, false);
        Self { folder, tls, port, coordinator, figures: Figures::default() }
    }

    fn coordinator(folder: &Path, tls: &Option<(PathBuf, PathBuf)>, port: u16, again: bool) -> LoggedProcess {
        let at = |name: &str| folder.join(name).display().to_string();
        let endpoint = format!("{}/127.0.0.1:{port}", if tls.is_some() { "tls" } else { "tcp" });
        let (scene, study) = (at("small.toml"), at("study"));
        let mut arguments = if again { vec!["resume", &study] } else { vec!["run", &scene, "--out", &study] };
        arguments.extend(["--workers", "0", "--listen", &endpoint]);
        let config = tls.as_ref().map(|(config, _)| config.display().to_string());
        arguments.extend(config.iter().flat_map(|config| ["--config", config]));
        let coordinator = LoggedProcess::start("coordinator", &arguments);
        coordinator.wait_for("waiting for workers");
        coordinator
    }

    /// Endpoint of the coordinator and the settings to reach it without the proxy.
    fn direct(&self) -> (String, Option<&Path>) {
        let scheme = if self.tls.is_some() { "tls" } else { "tcp" };
        (format!("{scheme}/127.0.0.1:{}", self.port), self.tls.as_ref().map(|(config, _)| config.as_path()))
    }

    /// Runs `sessions` sessions of a worker's messages whose frames `mutate` changes, until `until`.
    ///
    /// # Panics
    /// If the coordinator lives and does not answer, or ends without a cause.
    pub fn run(&mut self, sessions: u64, until: Instant, mutate: Box<Mutate>) -> &Figures {
        let changed = Arc::new(AtomicU64::new(0));
        let counted = Arc::clone(&changed);
        let mutate: Arc<Mutate> = Arc::new(move |frame| {
            let is_changed = mutate(frame);
            counted.fetch_add(u64::from(is_changed), Ordering::Relaxed);
            is_changed
        });
        let plain = self.client_settings();
        for look in 0..sessions.div_ceil(SESSIONS_PER_LOOK) {
            if Instant::now() > until {
                break;
            }
            let first = look * SESSIONS_PER_LOOK;
            let hands: Vec<_> = (0..AT_ONCE)
                .map(|hand| self.hand(first + hand * SESSIONS_OF_A_HAND, &plain, &mutate))
                .collect();
            hands.into_iter().for_each(Hand::end);
            self.figures.sessions += SESSIONS_PER_LOOK;
            self.figures.changed = changed.load(Ordering::Relaxed);
            self.look();
        }
        &self.figures
    }

    /// The file with the settings of a client of the proxy: an attempt that was spoilt is given up soon.
    fn client_settings(&self) -> PathBuf {
        let plain = self.folder.join("plain.json5");
        std::fs::write(&plain, "{ connect: { timeout_ms: 300, exit_on_failure: true } }")
            .expect("the folder can be written");
        plain
    }

    /// Starts a process with sessions `first` and following, each through its own proxy.
    fn hand(&self, first: u64, settings: &Path, mutate: &Arc<Mutate>) -> Hand {
        let mut command = Command::new(program("frames_client"));
        command.arg(settings).arg(first.to_string()).stdout(Stdio::null()).stderr(Stdio::null());
        let proxies = (0..SESSIONS_OF_A_HAND).map(|_| {
            let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
            let address = listener.local_addr().expect("it listens");
            command.arg(format!("tcp/{address}"));
            let (port, tls, mutate) = (self.port, self.tls.clone(), Arc::clone(mutate));
            let proxy = thread::spawn(move || {
                if let Ok((client, _)) = listener.accept() {
                    forward(client, port, tls.as_ref().map(|(_, folder)| folder.as_path()), &mutate);
                }
            });
            (address, proxy)
        });
        let proxies = proxies.collect();
        Hand { proxies, client: KilledOnDrop(command.spawn().expect("the program starts")) }
    }

    fn look(&mut self) {
        let started = Instant::now();
        loop {
            if let Some(code) = self.coordinator.ended() {
                let log = self.coordinator.log();
                // By its own decision, or by that of the system (e.g. an allocation that a length in the frame asks for).
                assert!([1, -1].contains(&code), "{code}: {log}");
                let is_cause = |line: &&str| {
                    ["panicked at", "memory allocation", "error: "].iter().any(|words| line.contains(words))
                };
                // Zenoh's TLS links read and write one session of rustls at a time without a lock (Zenoh's issue 2557): a record that
                // is an error for the reader may end the process by a signal.
                let by_signal = (code == -1 && self.tls.is_some()).then_some("a signal, without a message");
                let cause = log.lines().find(is_cause).or(by_signal);
                self.figures.ends.push(cause.unwrap_or_else(|| panic!("no cause: {log}")).to_owned());
                self.coordinator = Self::coordinator(&self.folder, &self.tls, self.port, true);
                return;
            }
            let (endpoint, config) = self.direct();
            let answer =
                ClientSession::open(&endpoint, config).and_then(|session| session.status(PATIENCE / 4));
            if answer.is_ok() {
                return;
            }
            assert!(
                started.elapsed() < UNTIL_END,
                "the coordinator lives and does not answer: {answer:?}\n{}",
                self.coordinator.log()
            );
        }
    }
}

/// A process of clients with its proxies.
struct Hand {
    proxies: Vec<(SocketAddr, JoinHandle<()>)>,
    client: KilledOnDrop,
}

impl Hand {
    /// Waits for the clients. A changed frame may spoil a client too, which is of no interest here.
    fn end(mut self) {
        let begun = Instant::now();
        while begun.elapsed() < PATIENCE && matches!(self.client.0.try_wait(), Ok(None)) {
            thread::sleep(Duration::from_millis(5));
        }
        drop(self.client);
        for (address, proxy) in self.proxies {
            // An attempt that never reached the proxy leaves it listening.
            drop(TcpStream::connect(address));
            let _ = proxy.join();
        }
    }
}

/// What a worker declares and sends, most of it in separate frames. The connection may break at any time.
pub fn messages_of_a_worker(number: u64, settings: &Path, endpoint: &str) {
    let Ok(session) = try_session(settings, endpoint) else { return };
    let worker = WorkerId { name: format!("zz{number}"), epoch: number };
    let declared = (
        session.liveliness().declare_token(keys::alive(&worker)).wait(),
        session.declare_subscriber(keys::NOTICE).callback(|_| ()).wait(),
    );
    for k in 0..4u8 {
        let claim = session.get(format!("{}?worker={}", keys::CLAIM, worker.name)).payload(vec![k; 60]);
        let _ = claim.timeout(Duration::from_millis(200)).callback(|_| ()).wait();
        if let Ok(key) = session.declare_keyexpr(format!("hingewise/other/{number}/{k}")).wait() {
            let _ = session.put(&key, vec![k; 9]).express(true).wait();
        }
    }
    if let Ok(replies) = session.get(keys::STATUS).timeout(Duration::from_millis(100)).wait() {
        let _ = replies.recv();
    }
    drop(declared);
    // Closing may block on a broken connection.
    let closed = thread::spawn(move || sessions::close(&session));
    let begun = Instant::now();
    while !closed.is_finished() && begun.elapsed() < Duration::from_secs(1) {
        thread::sleep(Duration::from_millis(5));
    }
}

/// Passes on what a client sends, changed, and what the coordinator replies, until either ends.
fn forward(mut client: TcpStream, port: u16, certificates: Option<&Path>, mutate: &Arc<Mutate>) {
    let Some((mut to, mut from)) = upstream(port, certificates) else { return };
    let Ok(mut back) = client.try_clone() else { return };
    let replies = thread::spawn(move || {
        let mut buffer = [0; 1 << 16];
        while let Ok(length @ 1..) = from.read(&mut buffer) {
            if back.write_all(&buffer[..length]).is_err() {
                break;
            }
        }
        let _ = back.shutdown(Shutdown::Both);
    });
    let mut length = [0; 2];
    // A frame on a stream: its length, two bytes, then its bytes.
    while client.read_exact(&mut length).is_ok() {
        let mut frame = vec![0; usize::from(u16::from_le_bytes(length))];
        if client.read_exact(&mut frame).is_err() {
            break;
        }
        mutate(&mut frame);
        let length = u16::try_from(frame.len()).unwrap_or(u16::MAX).to_le_bytes();
        if to.write_all(&[&length[..], &frame].concat()).and_then(|()| to.flush()).is_err() {
            break;
        }
    }
    to.end();
    let _ = replies.join();
}

/// The two directions of a connection to the coordinator.
fn upstream(port: u16, certificates: Option<&Path>) -> Option<(Towards, Box<dyn Read + Send>)> {
    let Some(folder) = certificates else {
        let stream = TcpStream::connect(("127.0.0.1", port)).ok()?;
        stream.set_nodelay(true).ok()?;
        return Some((Towards::Tcp(stream.try_clone().ok()?), Box::new(stream)));
    };
    let at = |name: &str| folder.join(name).display().to_string();
    let mut child = Command::new("openssl")
        .args(["s_client", "-quiet", "-connect", &format!("127.0.0.1:{port}")])
        .args(["-CAfile", &at("ca.pem"), "-cert", &at("certificate.pem"), "-key", &at("key.pem")])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .ok()?;
    let (to, from): (ChildStdin, ChildStdout) = (child.stdin.take()?, child.stdout.take()?);
    Some((Towards::Tls(KilledOnDrop(child), Some(to)), Box::new(from)))
}

enum Towards {
    Tcp(TcpStream),
    Tls(KilledOnDrop, Option<ChildStdin>),
}

impl Towards {
    fn end(&mut self) {
        match self {
            Self::Tcp(stream) => drop(stream.shutdown(Shutdown::Both)),
            Self::Tls(child, to) => {
                drop(to.take());
                let _ = child.0.kill();
            }
        }
    }
}

impl Write for Towards {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match self {
            Self::Tcp(stream) => stream.write(bytes),
            Self::Tls(_, to) => to.as_mut().map_or(Ok(0), |to| to.write(bytes)),
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        match self {
            Self::Tcp(stream) => stream.flush(),
            Self::Tls(_, to) => to.as_mut().map_or(Ok(()), Write::flush),
        }
    }
}
