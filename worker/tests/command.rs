//! The `worker` command as a user meets it: help, exit codes, one clear message.

use common::wire::{self, Next, PROTOCOL_VERSION, Reply, keys};
use std::process::{Command, Output};
use std::time::{Duration, Instant};
use zenoh::{Config, Session, Wait};

fn worker(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_worker"));
    command.env_remove("RUST_LOG").args(arguments).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// A coordinator that answers every claim with this frame.
fn answering(frame: Vec<u8>) -> (Session, String) {
    let mut config = Config::default();
    for (key, value) in [
        ("mode", "\"peer\""),
        ("listen/endpoints", "[\"tcp/127.0.0.1:0\"]"),
        ("scouting/multicast/enabled", "false"),
        ("scouting/gossip/enabled", "false"),
        ("scouting/delay", "0"),
    ] {
        config.insert_json5(key, value).unwrap();
    }
    let session = sessions::open(config).unwrap();
    let endpoint = session.info().locators().wait()[0].to_string();
    session
        .declare_queryable(keys::CLAIM)
        .callback(move |query| query.reply(keys::CLAIM, frame.clone()).wait().unwrap())
        .background()
        .wait()
        .unwrap();
    (session, endpoint)
}

fn farewell() -> Vec<u8> {
    wire::encode(&Reply { acknowledged: vec![], next: Next::Leave { campaign: 1 } }).unwrap()
}

/// An address nobody listens on: bound for a moment, then free.
fn nobody() -> String {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    format!("tcp/{}", listener.local_addr().unwrap())
}

#[test]
fn help_shows_examples_and_exits_0() {
    let output = worker(&["--help"]);
    assert_eq!(output.status.code(), Some(0));
    let help = String::from_utf8(output.stdout).unwrap();
    assert!(help.contains("Examples:") && help.contains("--connect"), "{help}");
}

#[test]
fn bad_input_exits_2_and_names_it() {
    for (arguments, named) in [
        (&["--slots", "2"][..], "--connect"),
        (&["--connect", "tcp/127.0.0.1:1", "--slots", "0"], "--slots"),
        (&["--connect", "tcp/127.0.0.1:1", "--walltime", "0"], "--walltime"),
        (&["--connect", "tcp/127.0.0.1:1", "--idle-timeout", "soon"], "--idle-timeout"),
        (&["--connect", "tcp/127.0.0.1:1", "--stay", "--give-up-after", "9"], "--give-up-after"),
        (&["--connect", "tcp/127.0.0.1:1", "--connect", "there"], "\"there\""),
        (&["--connect", "nowhere"], "\"nowhere\""),
        (&["--connect", "tcp/127.0.0.1:1", "--config", "/missing/zenoh.json5"], "/missing/zenoh.json5"),
    ] {
        let output = worker(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", said(&output));
        assert!(said(&output).contains(named), "{arguments:?}: {}", said(&output));
    }
}

#[test]
fn an_unreachable_coordinator_is_named_and_exits_1_in_time() {
    let endpoint = nobody();
    let started = Instant::now();
    let output = worker(&["--quiet", "--connect", &endpoint, "--give-up-after", "1"]);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    let text = said(&output);
    assert!(text.contains(&endpoint) && text.lines().count() == 1, "{text}");
    assert!(started.elapsed() >= Duration::from_secs(1));
}

#[test]
fn another_protocol_version_is_named_and_exits_1() {
    let mut frame = farewell();
    frame[4..6].copy_from_slice(&(PROTOCOL_VERSION + 1).to_le_bytes());
    let (_coordinator, endpoint) = answering(frame);
    let output = worker(&["--quiet", "--connect", &endpoint]);
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    let text = said(&output);
    let versions = [PROTOCOL_VERSION + 1, PROTOCOL_VERSION].map(|version| format!("version {version}"));
    assert!(versions.iter().all(|version| text.contains(version)), "{text}");
    assert_eq!(text.lines().count(), 1, "{text}");
}

#[test]
fn the_end_of_the_campaign_exits_0() {
    let (_coordinator, endpoint) = answering(farewell());
    let output = worker(&["--connect", &endpoint, "--slots", "1"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert!(said(&output).contains("the coordinator has finished"), "{}", said(&output));
}

#[test]
fn sigterm_drains_and_exits_0_and_ctrl_c_exits_130() {
    let idle = Reply { acknowledged: vec![], next: Next::Idle { ask_again: 100 } };
    for (signal, code) in [("TERM", 0), ("INT", 130)] {
        let frame = wire::encode(&idle).unwrap();
        let (session, endpoint) = answering(frame);
        let (there, seen) = std::sync::mpsc::channel();
        let _alive = session
            .liveliness()
            .declare_subscriber(keys::ALIVE_ALL)
            .history(true)
            .callback(move |_| {
                let _ = there.send(());
            })
            .wait()
            .unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_worker"))
            .args(["--quiet", "--connect", &endpoint])
            .spawn()
            .unwrap();
        let connected = seen.recv_timeout(Duration::from_secs(30));
        let killed = Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status();
        assert!(connected.is_ok() && killed.unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(code), "SIG{signal}");
    }
}

#[test]
fn a_scene_is_offered_by_umbridge_on_this_machine_alone() {
    for (arguments, named) in [
        (&["--serve-umbridge", "here"][..], "--serve-umbridge here: allowed: a port"),
        (&["--serve-umbridge", "0.0.0.0:0"], "or --insecure if the network is trusted"),
        (&["--serve-umbridge", "0", "--scene", "five-bar"], "did you mean \"four-bar\"?"),
        (&["--serve-umbridge", "0", "--accuracy", "exact"], "\"exact\" is neither a preset"),
        (&["--serve-umbridge", "0", "--connect", "tcp/127.0.0.1:1"], "cannot be used with"),
        (&["--connect", "tcp/127.0.0.1:1", "--scene", "four-bar"], "cannot be used with"),
    ] {
        let output = worker(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", said(&output));
        assert!(said(&output).contains(named), "{arguments:?}: {}", said(&output));
    }
    let mut child = Command::new(env!("CARGO_BIN_EXE_worker"))
        .env_remove("RUST_LOG")
        .args(["--serve-umbridge", "0", "--scene", "four-bar"])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let mut log = std::io::BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    std::io::BufRead::read_line(&mut log, &mut line).unwrap();
    assert!(
        line.contains("serving evaluations of four-bar as model \"forward\" at http://127.0.0.1:"),
        "{line}"
    );
    let killed = Command::new("kill").args(["-TERM", &child.id().to_string()]).status();
    assert!(killed.unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}
