//! `coordinator doctor`: checks from this machine, one after the other, of all that a worker needs.

use super::status::explained;
use super::{CommandError, Done, print, to_json};
use clap::Args;
use common::wire::{Claim, Offers, Status, WireError, WorkerId};
use coordinator::farm::dispatch::{ClientError, ClientSession, clock_ms};
use serde::Serialize;
use std::net::{SocketAddr, TcpStream, ToSocketAddrs};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Shown below `coordinator doctor --help`.
pub const EXAMPLES: &str = "\
Run it on the machine of a worker, with the --config of the worker. The checks: name, reachability, session (TLS, user and \
password), claim (answer, access control, version), status, clock, liveliness. Each prints one line, `ok` or `failed` with \
advice; checks that cannot be made after a failure are omitted.

Examples:
  coordinator doctor tcp/192.168.1.20:7447
  coordinator doctor tls/coordinator.example:7447 --config /etc/hingewise/zenoh-tls.json5

Exit codes: 0 all checks passed, 1 a check failed, 2 bad input.";

/// Longest wait for one check.
const PATIENCE: Duration = Duration::from_secs(3);
/// Difference of clocks above which certificates and logs of two machines are inconsistent [s].
const CLOCKS: f64 = 30.0;

/// Arguments of `coordinator doctor`.
#[derive(Debug, Clone, Args)]
pub struct DoctorArguments {
    /// Address of the coordinator, e.g. tcp/192.168.1.20:7447
    pub endpoint: String,
    /// Zenoh configuration (JSON5) of the worker
    #[arg(long, value_name = "ZENOH.json5")]
    pub config: Option<PathBuf>,
}

/// Result of one check.
#[derive(Debug, Serialize)]
struct CheckResult {
    check: &'static str,
    ok: bool,
    says: String,
}

/// Value of a check that passed with what it says, or what one that failed says.
type Check<T> = Result<(T, String), String>;

/// Notes the result of a check; its value if it passed.
fn note<T>(findings: &mut Vec<CheckResult>, check: &'static str, found: Check<T>) -> Option<T> {
    let (ok, says, value) = match found {
        Ok((value, says)) => (true, says, Some(value)),
        Err(says) => (false, says, None),
    };
    findings.push(CheckResult { check, ok, says });
    value
}

/// Runs the command.
///
/// # Errors
/// [`CommandError::Failed`] if a check failed.
pub fn doctor(arguments: &DoctorArguments, as_json: bool) -> Done {
    let (host, port) = host_and_port(&arguments.endpoint)?;
    let mut findings = Vec::new();
    examine(&mut findings, arguments, host, port)?;
    print(&if as_json { to_json(&findings)? } else { lines(&findings) })?;
    let failed = findings.iter().filter(|finding| !finding.ok).count();
    let fault = format!("{failed} of {} checks failed", findings.len());
    if failed == 0 { Ok(()) } else { Err(CommandError::Failed(fault)) }
}

fn lines(findings: &[CheckResult]) -> String {
    let line = |CheckResult { check, ok, says }: &CheckResult| {
        format!("{:6}  {check:10}  {says}\n", if *ok { "ok" } else { "failed" })
    };
    findings.iter().map(line).collect()
}

/// Host and port of `tcp/HOST:PORT` or `tls/HOST:PORT`.
fn host_and_port(endpoint: &str) -> Done<(&str, u16)> {
    let parts = || {
        let (protocol, address) = endpoint.split_once('/')?;
        let (host, port) = address.split(['?', '#']).next()?.rsplit_once(':')?;
        let host = host.trim_start_matches('[').trim_end_matches(']');
        (["tcp", "tls"].contains(&protocol) && !host.is_empty()).then_some((host, port.parse().ok()?))
    };
    parts().ok_or_else(|| {
        let reason = "not an endpoint of the kind PROTOCOL/HOST:PORT".to_owned();
        ClientError::Endpoint(endpoint.to_owned(), reason).into()
    })
}

/// Makes the checks in their order, up to a failure that prevents the following ones.
fn examine(findings: &mut Vec<CheckResult>, arguments: &DoctorArguments, host: &str, port: u16) -> Done {
    let Some(addresses) = note(findings, "name", resolve(host, port)) else { return Ok(()) };
    if note(findings, "reach", reach(&addresses)).is_none() {
        return Ok(());
    }
    let begun = Instant::now();
    let session = match ClientSession::open(&arguments.endpoint, arguments.config.as_deref()) {
        Err(error) if error.is_bad_input() => return Err(error.into()),
        opened => opened.map_err(|error| explained(error, begun).to_string()),
    };
    let encrypted = if arguments.endpoint.starts_with("tls/") { "encrypted" } else { "not encrypted" };
    let opened = session.map(|session| (session, format!("open, {encrypted}; we are let in")));
    let Some(session) = note(findings, "session", opened) else { return Ok(()) };
    let worker = WorkerId { name: format!("doctor-{}", std::process::id()), epoch: clock_ms() };
    if note(findings, "claim", claim(&session, &worker)).is_none() {
        return Ok(());
    }
    let asked = clock_ms();
    let Some(status) = note(findings, "status", status(&session)) else { return Ok(()) };
    note(findings, "clock", clock(&status, asked, clock_ms()));
    note(findings, "liveliness", liveliness(&session, &worker));
    Ok(())
}

fn resolve(host: &str, port: u16) -> Check<Vec<SocketAddr>> {
    let addresses: Vec<SocketAddr> = (host, port)
        .to_socket_addrs()
        .map_err(|error| {
            format!("this machine does not know the host {host} ({error}): check its name, DNS or /etc/hosts")
        })?
        .collect();
    let list: Vec<String> = addresses.iter().map(|address| address.ip().to_string()).collect();
    Ok((addresses, format!("{host} is {}", list.join(", "))))
}

fn reach(addresses: &[SocketAddr]) -> Check<()> {
    let mut last = "it has no address".to_owned();
    for address in addresses {
        let begun = Instant::now();
        match TcpStream::connect_timeout(address, PATIENCE) {
            Ok(_) => {
                let took = begun.elapsed().as_secs_f64() * 1e3;
                return Ok(((), format!("something listens at {address}, {took:.1} ms away")));
            }
            Err(error) => last = format!("{address}: {error}"),
        }
    }
    Err(format!(
        "{last}: is the coordinator running with this --listen (0.0.0.0 or this address, not 127.0.0.1), and does every \
         firewall between let the port through?"
    ))
}

/// A claim for no task: it uses the same path as a real one without changing the study.
fn claim(session: &ClientSession, worker: &WorkerId) -> Check<()> {
    let (worker, offers, holding) = (worker.clone(), Offers::Scenes(worker::BUILD), vec![]);
    let (slots, credits, finished) = (0, 0, vec![]);
    let claim = Claim { worker, sequence: 1, offers, slots, credits, holding, finished, leaving: false };
    let begun = Instant::now();
    match session.claim(&claim, PATIENCE) {
        Ok(_) => {
            let took = begun.elapsed().as_secs_f64() * 1e3;
            Ok(((), format!("a coordinator of the same protocol version answers within {took:.1} ms")))
        }
        Err(ClientError::Answer(_, WireError::OtherVersion { theirs, ours })) => Err(format!(
            "the coordinator speaks protocol version {theirs}, this program version {ours}: use the same version of the \
             program on both sides"
        )),
        Err(error) => Err(error.to_string()),
    }
}

fn status(session: &ClientSession) -> Check<Status> {
    let status = session.status(PATIENCE).map_err(|error| format!("{error}; workers can do without"))?;
    let (program, scene) = (&status.program, &status.study.scene);
    let says = format!("Hingewise {program}, study of {scene}, {} workers", status.farm.workers.len());
    Ok((status, says))
}

/// The coordinator's clock was read between two readings of this one [ms].
fn clock(status: &Status, asked: u64, answered: u64) -> Check<()> {
    let middle = (asked as f64 + answered as f64) / 2.0;
    let doubt = (answered as f64 - asked as f64) / 2e3;
    let ahead = (status.clock_ms as f64 - middle) / 1e3;
    let says = format!("the coordinator's clock is {ahead:+.3} s from this one, within {doubt:.3} s");
    let fault = format!("{says}: set both by NTP, certificates depend on it");
    if ahead.abs() <= CLOCKS { Ok(((), says)) } else { Err(fault) }
}

/// Whether the coordinator sees that a worker lives: without that it gives it no task.
fn liveliness(session: &ClientSession, worker: &WorkerId) -> Check<()> {
    let _life = session.declare_liveliness(worker).map_err(|error| error.to_string())?;
    let begun = Instant::now();
    loop {
        match session.status(PATIENCE) {
            Ok(status) if status.farm.workers.iter().any(|seen| seen.name == worker.name) => {
                return Ok(((), "the coordinator sees that we live; a worker would get tasks".to_owned()));
            }
            Ok(_) if begun.elapsed() >= PATIENCE => break,
            Ok(_) => std::thread::sleep(Duration::from_millis(20)),
            // The query before was permitted and answered: this reply is late or lost, on a busy machine or network.
            Err(ClientError::Silent(..)) if begun.elapsed() < 3 * PATIENCE => {}
            Err(error) => return Err(error.to_string()),
        }
    }
    Err("the coordinator does not see that we live, so a worker would get no task: its access_control must allow \
         liveliness_token on hingewise/alive/*/*"
        .to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endpoints_are_read_or_refused() {
        assert_eq!(host_and_port("tcp/192.168.1.20:7447").unwrap(), ("192.168.1.20", 7447));
        assert_eq!(host_and_port("tls/[::1]:7#iface=lo").unwrap(), ("::1", 7));
        for slip in ["localhost:7447", "tcp/localhost", "udp/localhost:7447", "tcp/:7447", "tcp/a:70000"] {
            assert_eq!(host_and_port(slip).unwrap_err().exit_code(), 2, "{slip}");
        }
    }

    #[test]
    fn clocks_are_compared_in_the_middle_of_the_question() {
        let status = |clock_ms| Status { clock_ms, ..Status::default() };
        let (_, says) = clock(&status(1_000_150), 1_000_000, 1_000_200).unwrap();
        assert!(says.contains("+0.050 s from this one, within 0.100 s"), "{says}");
        assert!(clock(&status(1_060_000), 1_000_000, 1_000_200).unwrap_err().contains("NTP"));
    }
}
