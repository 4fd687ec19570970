//! Sessions from recorded frames: those of one real session are sent again, changed, each time with a new identity and the cookie of the
//! handshake. Without a client process and its waits a hundred times more frames arrive in the same time.

use super::{Attack, Figures, Mutate, PATIENCE, forward, messages_of_a_worker};
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer, ServerName};
use rustls::{ClientConfig, ClientConnection, RootCertStore, StreamOwned};
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Threads that replay.
const THREADS: u64 = 12;
/// Sessions of a thread between two looks at the coordinator.
const SESSIONS: u64 = 50;
/// Time in which a coordinator that refuses a changed frame has closed the connection.
const REFUSAL: Duration = Duration::from_millis(1);
/// Longest wait for a reply of the handshake, to a changed frame too.
const HANDSHAKE: Duration = Duration::from_millis(60);
/// Length of the number in the identity of a session [bytes].
const NUMBER: usize = 8;

/// Frames of a client, without their lengths.
struct Recording {
    frames: Vec<Vec<u8>>,
    tls: Option<Arc<ClientConfig>>,
    port: u16,
}

impl Attack {
    /// Replays recorded sessions whose frames `mutate` changes, until `frames` were changed or `until`. A changed frame counts if the
    /// connection was open when it was sent.
    ///
    /// # Panics
    /// If the coordinator lives and does not answer, or ends without a cause.
    pub fn replay(&mut self, frames: u64, until: Instant, mutate: &Mutate) -> &Figures {
        let recording = self.record();
        let changed = AtomicU64::new(self.figures.changed);
        while changed.load(Ordering::Relaxed) < frames && Instant::now() < until {
            let first = self.figures.sessions;
            thread::scope(|scope| {
                for hand in 0..THREADS {
                    let (recording, changed) = (&recording, &changed);
                    scope.spawn(move || {
                        for k in 0..SESSIONS {
                            let number = first + hand * SESSIONS + k;
                            // The connection may break at any time.
                            let _ = recording.session(number, mutate, changed);
                        }
                    });
                }
            });
            self.figures.sessions += THREADS * SESSIONS;
            self.figures.changed = changed.load(Ordering::Relaxed);
            self.look();
        }
        &self.figures
    }

    /// The frames of one session without changes.
    fn record(&self) -> Recording {
        let frames = Arc::new(Mutex::new(Vec::new()));
        let heard = Arc::clone(&frames);
        let record: Arc<Mutate> = Arc::new(move |frame| {
            heard.lock().unwrap_or_else(PoisonError::into_inner).push(frame.clone());
            false
        });
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let endpoint = format!("tcp/{}", listener.local_addr().expect("it listens"));
        let certificates = self.tls.as_ref().map(|(_, folder)| folder.clone());
        let (port, folder) = (self.port, certificates.clone());
        let proxy = thread::spawn(move || {
            let (client, _) = listener.accept().expect("the client connects");
            forward(client, port, folder.as_deref(), &record);
        });
        messages_of_a_worker(0, &self.client_settings(), &endpoint);
        proxy.join().expect("the proxy ends with its client");
        let frames = frames.lock().unwrap_or_else(PoisonError::into_inner).clone();
        assert!(frames.len() > 8, "the session was not recorded: {frames:?}");
        Recording { frames, tls: certificates.as_deref().map(client_config), port }
    }
}

impl Recording {
    fn session(&self, number: u64, mutate: &Mutate, changed: &AtomicU64) -> std::io::Result<()> {
        let tcp = TcpStream::connect(("127.0.0.1", self.port))?;
        tcp.set_nodelay(true)?;
        let mut connection = Connection { waits: tcp.try_clone()?, stream: stream(tcp, self.tls.as_ref())? };
        let send = |connection: &mut Connection, mut frame: Vec<u8>| -> std::io::Result<()> {
            let is_changed = mutate(&mut frame);
            connection.send(&frame)?;
            changed.fetch_add(u64::from(is_changed), Ordering::Relaxed);
            if is_changed { connection.check_open() } else { Ok(()) }
        };
        // InitSyn: header, version, length of the identity, identity.
        let mut init = self.frames[0].clone();
        init[3..3 + NUMBER].copy_from_slice(&(number + 1).to_le_bytes());
        send(&mut connection, init)?;
        let reply = connection.receive()?;
        let cookie = cookie_of_reply(&reply).ok_or(ErrorKind::InvalidData)?;
        send(&mut connection, with_cookie(&self.frames[1], cookie).ok_or(ErrorKind::InvalidData)?)?;
        connection.receive()?;
        self.frames[2..].iter().try_for_each(|frame| send(&mut connection, frame.clone()))
    }
}

trait Stream: Read + Write {}
impl<S: Read + Write> Stream for S {}

struct Connection {
    stream: Box<dyn Stream>,
    /// The same socket, for its time limits.
    waits: TcpStream,
}

impl Connection {
    fn send(&mut self, frame: &[u8]) -> std::io::Result<()> {
        let length = u16::try_from(frame.len()).unwrap_or(u16::MAX).to_le_bytes();
        self.stream.write_all(&[&length[..], frame].concat())?;
        self.stream.flush()
    }

    fn receive(&mut self) -> std::io::Result<Vec<u8>> {
        self.waits.set_read_timeout(Some(HANDSHAKE))?;
        let mut length = [0; 2];
        self.stream.read_exact(&mut length)?;
        let mut frame = vec![0; usize::from(u16::from_le_bytes(length))];
        self.stream.read_exact(&mut frame)?;
        Ok(frame)
    }

    /// An error if the coordinator closes the connection.
    fn check_open(&mut self) -> std::io::Result<()> {
        self.waits.set_read_timeout(Some(REFUSAL))?;
        match self.stream.read(&mut [0; 1]) {
            Ok(0) => Err(ErrorKind::ConnectionAborted.into()),
            Err(error) if !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => Err(error),
            _ => Ok(()),
        }
    }
}

fn stream(tcp: TcpStream, tls: Option<&Arc<ClientConfig>>) -> std::io::Result<Box<dyn Stream>> {
    let Some(config) = tls else { return Ok(Box::new(tcp)) };
    tcp.set_read_timeout(Some(PATIENCE))?;
    let name = ServerName::try_from("127.0.0.1").expect("an address");
    let connection = ClientConnection::new(Arc::clone(config), name).map_err(std::io::Error::other)?;
    Ok(Box::new(StreamOwned::new(connection, tcp)))
}

/// TLS with the certificates of a folder.
fn client_config(folder: &Path) -> Arc<ClientConfig> {
    let mut roots = RootCertStore::empty();
    roots.add(CertificateDer::from_pem_file(folder.join("ca.pem")).expect("ca.pem")).expect("an authority");
    let chain = CertificateDer::pem_file_iter(folder.join("certificate.pem")).expect("certificate.pem");
    let chain = chain.collect::<Result<Vec<_>, _>>().expect("certificates");
    let key = PrivateKeyDer::from_pem_file(folder.join("key.pem")).expect("key.pem");
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let config = ClientConfig::builder_with_provider(provider).with_safe_default_protocol_versions();
    let config = config.expect("versions of TLS").with_root_certificates(roots);
    Arc::new(config.with_client_auth_cert(chain, key).expect("certificate and key belong together"))
}

/// A number of seven bits a byte, the lowest first, and its length [bytes].
fn number(bytes: &[u8]) -> Option<(usize, usize)> {
    let length = bytes.iter().position(|byte| byte & 0x80 == 0)? + 1;
    let value = bytes[..length].iter().rev().fold(0, |value, byte| (value << 7) | usize::from(byte & 0x7f));
    Some((value, length))
}

/// The cookie of an InitAck, with its length before it: header, version, length of the identity, identity, and, where the header says so,
/// resolution and batch size.
fn cookie_of_reply(frame: &[u8]) -> Option<&[u8]> {
    let identity = usize::from(frame.get(2)? >> 4) + 1;
    let sizes = if frame[0] & 0x40 != 0 { 3 } else { 0 };
    let rest = frame.get(3 + identity + sizes..)?;
    let (size, length) = number(rest)?;
    rest.get(..length + size)
}

/// An OpenSyn with another cookie: header, lease, first sequence number, cookie.
fn with_cookie(frame: &[u8], cookie: &[u8]) -> Option<Vec<u8>> {
    let mut at = 1;
    for _ in 0..2 {
        at += number(frame.get(at..)?)?.1;
    }
    let (size, length) = number(frame.get(at..)?)?;
    Some([&frame[..at], cookie, frame.get(at + length + size..)?].concat())
}
