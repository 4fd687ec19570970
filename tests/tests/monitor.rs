//! Monitoring of a running study: `status`, the live page in a browser, and the findings of `doctor`.

use common::wire::{self, Next, PROTOCOL_VERSION, Phase, Reply, Status, WireError, keys};
use coordinator::farm::dispatch::{ClientError, ClientSession, clock_ms};
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use tests::deployed::{
    LoggedProcess, NAMED, certificates, changed_configuration, configuration, has_openssl, if_installed,
    small_scene,
};
use tests::{
    Barrier, PATIENCE, coordinator, evaluate, expected, in_time, practice_result, program, requests, worker,
};
use worker::service::Departure;
use zenoh::{Config, Session, Wait};

#[test]
fn a_status_counts_waiting_and_running_evaluations_and_workers() {
    in_time(|| {
        let mut coordinator = coordinator();
        let endpoint = coordinator.endpoints[0].clone();
        let session = ClientSession::open(&endpoint, None).unwrap();
        let before = session.status(PATIENCE).unwrap();
        assert_eq!((before.phase, before.farm.workers.len()), (Phase::Learning, 0));
        assert!(before.clock_ms.abs_diff(clock_ms()) < 10_000);

        coordinator.board.post(|study| study.scene = "practice".into());
        let hold = Arc::new(Barrier::default());
        let held = Arc::clone(&hold);
        let (begun, begins) = std::sync::mpsc::channel();
        let handle = worker(&coordinator, "handle", 2, move |sample| {
            let _ = begun.send(());
            held.pass();
            practice_result(sample)
        });
        let observer = std::thread::spawn(move || {
            for _ in 0..2 {
                begins.recv_timeout(PATIENCE).unwrap();
            }
            let status = session.status(PATIENCE).unwrap();
            hold.open();
            (status, session)
        });
        assert_eq!(evaluate(&mut coordinator, &requests(0..10)).unwrap(), expected(0..10));
        let (during, session) = observer.join().unwrap();
        assert_eq!((during.phase, during.study.scene.as_str()), (Phase::Simulating, "practice"));
        let at_worker = during.farm.workers[0].clone();
        assert_eq!((at_worker.name.as_str(), at_worker.slots, at_worker.done), ("handle", 2, 0));
        assert_eq!(
            (during.farm.queued + during.farm.under_way, u64::from(at_worker.under_way)),
            (10, during.farm.under_way)
        );
        let after = session.status(PATIENCE).unwrap();
        assert_eq!((after.phase, after.farm.workers[0].done), (Phase::Learning, 10));
        assert!(after.farm.rate > 0.0);
        coordinator.finish();
        assert_eq!(handle.join().unwrap(), Departure::CampaignEnded);
    });
}

/// A Zenoh session in place of a coordinator: replies to claims and status queries with these frames, if given. Every second
/// query of a kind gets no reply, as on a network that loses messages.
fn false_coordinator(claim: Option<Vec<u8>>, status: Option<Vec<u8>>) -> (Session, String) {
    let mut config = Config::default();
    for (key, value) in [
        ("mode", "\"peer\""),
        ("scouting/multicast/enabled", "false"),
        ("scouting/gossip/enabled", "false"),
        ("listen/endpoints", "[\"tcp/127.0.0.1:0\"]"),
    ] {
        config.insert_json5(key, value).unwrap();
    }
    let session = sessions::open(config).unwrap();
    for (key, frame) in [(keys::CLAIM, claim), (keys::STATUS, status)] {
        let Some(frame) = frame else { continue };
        let asked = AtomicUsize::new(0);
        session
            .declare_queryable(key)
            .callback(move |query| {
                if asked.fetch_add(1, Ordering::Relaxed).is_multiple_of(2) {
                    query.reply(key, frame.clone()).wait().unwrap();
                }
            })
            .background()
            .wait()
            .unwrap();
    }
    let endpoint = session.info().locators().wait()[0].to_string();
    (session, endpoint)
}

fn of_version(version: u16, mut frame: Vec<u8>) -> Vec<u8> {
    frame[4..6].copy_from_slice(&version.to_le_bytes());
    frame
}

fn idle() -> Vec<u8> {
    wire::encode(&Reply { acknowledged: vec![], next: Next::Idle { ask_again: 10 } }).unwrap()
}

#[test]
fn a_status_of_another_version_is_named() {
    in_time(|| {
        let frame = of_version(PROTOCOL_VERSION + 1, wire::encode(&Status::default()).unwrap());
        let (_session, endpoint) = false_coordinator(None, Some(frame));
        let error = ClientSession::open(&endpoint, None).unwrap().status(PATIENCE).unwrap_err();
        let theirs = PROTOCOL_VERSION + 1;
        assert!(
            matches!(&error, ClientError::Answer(_, WireError::OtherVersion { theirs: found, .. }) if *found == theirs),
            "{error}"
        );
        // A session without reply is distinguished from a missing coordinator.
        let (_session, endpoint) = false_coordinator(None, None);
        let error = ClientSession::open(&endpoint, None).unwrap().status(PATIENCE).unwrap_err();
        assert!(matches!(error, ClientError::Silent(..)), "{error}");
        assert!(matches!(ClientSession::open("tcp/127.0.0.1:1", None), Err(ClientError::Unreachable(..))));
    });
}

/// Exit code and output of a command of the coordinator.
fn command(arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::new(program("coordinator")).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[track_caller]
fn finds(arguments: &[&str], code: i32, failed: &[(&str, &str)]) {
    let (found, lines, error) = command(&[&["doctor"], arguments].concat());
    assert_eq!(found, Some(code), "{lines}{error}");
    let faults: Vec<&str> = lines.lines().filter(|line| line.starts_with("failed")).collect();
    assert_eq!(faults.len(), failed.len(), "{lines}");
    for (line, (check, says)) in faults.iter().zip(failed) {
        assert!(line.contains(check) && line.contains(says), "no \"{says}\" of {check} in: {line}");
    }
}

#[test]
fn the_doctor_finds_faults() {
    in_time(|| {
        let healthy = coordinator();
        finds(&[&healthy.endpoints[0]], 0, &[]);
        assert_eq!(command(&["doctor", "nowhere"]).0, Some(2));
        assert_eq!(command(&["doctor", "tcp/127.0.0.1:1", "--config", "/none.json5"]).0, Some(1));
        finds(&["tcp/no-such-host.invalid:7447"], 1, &[("name", "does not know the host")]);
        let free = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = free.local_addr().unwrap();
        // A listener that is no coordinator and closes every connection.
        std::thread::spawn(move || free.incoming().for_each(drop));
        finds(&[&format!("tcp/{address}")], 1, &[("session", "does another program use that port")]);
        let freed = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        finds(&[&format!("tcp/{freed}")], 1, &[("reach", "is the coordinator running")]);

        let (_session, mute) = false_coordinator(None, None);
        finds(&[&mute], 1, &[("claim", "access_control does not permit the query")]);
        let (_session, newer) = false_coordinator(Some(of_version(PROTOCOL_VERSION + 1, idle())), None);
        finds(&[&newer], 1, &[("claim", "use the same version of the program on both sides")]);
        let late = Status { clock_ms: clock_ms() - 3_600_000, ..Status::default() };
        let (_session, late) = false_coordinator(Some(idle()), Some(wire::encode(&late).unwrap()));
        // This one does not report the liveliness token either, and the first query for it gets no reply.
        let unseen = ("liveliness", "liveliness_token on hingewise/alive/*/*");
        finds(&[&late], 1, &[("clock", "set both by NTP"), unseen]);
        let (code, _, error) = command(&["status", "tcp/127.0.0.1:1"]);
        assert!(code == Some(1) && error.contains("nothing listens there"), "{error}");
    });
}

#[test]
fn the_doctor_examines_certificates_and_access() {
    if !has_openssl("the doctor's view of TLS") {
        return;
    }
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let own = certificates(&folder.path().join("ours"), "127.0.0.1");
        let theirs = certificates(&folder.path().join("theirs"), "127.0.0.1");
        let named = [
            (NAMED, "\"127.0.0.1\""),
            // The rule for the liveliness token is missing.
            ("\"claims\", \"life\", \"hearing\"", "\"claims\", \"hearing\""),
        ];
        let incomplete = changed_configuration("zenoh-tls-coordinator.json5", &own, &named);
        let out = folder.path().join("study");
        let arguments = ["run", "four-bar", "--workers", "0", "--listen", "tls/127.0.0.1:0", "--config"];
        let rest = [incomplete.to_str().unwrap(), "--out", out.to_str().unwrap()];
        let coordinator = LoggedProcess::start("coordinator", &[&arguments[..], &rest[..]].concat());
        let endpoint = coordinator.wait_for("waiting for workers: worker --connect ");
        let [own, theirs] = [&own, &theirs].map(|own| configuration("zenoh-tls.json5", own));
        let with = |config: &Path| [endpoint.clone(), "--config".into(), config.to_str().unwrap().to_owned()];
        let finds = |config: &Path, failed: &[(&str, &str)]| {
            let arguments = with(config);
            finds(&arguments.each_ref().map(String::as_str), 1, failed);
        };
        finds(&theirs, &[("session", "another authority than root_ca_certificate")]);
        finds(&own, &[("liveliness", "liveliness_token on hingewise/alive/*/*")]);
    });
}

/// Reply of an HTTP server on this machine.
fn get(address: &str, path: &str, host: &str) -> String {
    let mut line = TcpStream::connect(address).unwrap();
    write!(line, "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n").unwrap();
    let mut answer = String::new();
    line.read_to_string(&mut answer).unwrap();
    answer
}

/// A study of the four-bar with live page, without workers so far: the process, and the addresses of coordinator and page.
fn visible_study(folder: &Path, evaluations: usize, more: &[&str]) -> (LoggedProcess, [String; 2]) {
    let scene = folder.join("small.toml");
    std::fs::write(&scene, small_scene(evaluations)).unwrap();
    let (scene, out) = (scene.to_str().unwrap(), folder.join("study"));
    let what = ["run", scene, "--accuracy", "draft", "--workers", "0", "--out", out.to_str().unwrap()];
    let shown = ["--live", "0", "-v"];
    let study = LoggedProcess::start("coordinator", &[&what[..], &shown, more].concat());
    let endpoint = study.wait_for("waiting for workers: worker --connect ");
    let live = study.wait_for("live report: http://");
    (study, [endpoint, live])
}

#[test]
fn page_and_status_describe_a_running_study() {
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let (mut study, [endpoint, live]) = visible_study(folder.path(), 12, &[]);
        let session = ClientSession::open(&endpoint, None).unwrap();
        while session.status(PATIENCE).unwrap().phase != Phase::Waiting {
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        let (code, json, error) = command(&["status", &endpoint, "--json"]);
        assert_eq!(code, Some(0), "{error}");
        let status: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!((&status["study"]["planned"], &status["study"]["budget"]), (&1.into(), &12.into()));
        let (_, text, _) = command(&["status", &endpoint]);
        assert!(text.contains("waiting for workers") && text.contains("no worker is connected"), "{text}");

        // The page accepts this machine's names only, is read-only, and loads nothing from other hosts.
        let page = get(&live, "/", &live);
        assert!(
            page.starts_with("HTTP/1.1 200") && page.contains("content-security-policy: default-src 'none'")
        );
        assert!(page.contains("Running study: 0/12 evaluations, nominal point"), "{page}");
        // From the first second: progress, workers, the drawing and the limits.
        for piece in [
            "0 of at most 12 evaluations",
            "No worker is connected",
            "id=\"drawing\"",
            "id=\"table-limits-now\"",
        ] {
            assert!(page.contains(piece), "no {piece} in {page}");
        }
        assert!(get(&live, "/report.html", &live).starts_with("HTTP/1.1 404"), "there is no report yet");
        assert!(get(&live, "/", "evil.example").starts_with("HTTP/1.1 403"));
        let news = get(&live, "/news/1", &live);
        assert!(news.contains("\"ended\":false") && news.contains("Running study"), "{news}");
        let mut worker =
            LoggedProcess::start("worker", &["--connect", &endpoint, "--slots", "1", "--log-format", "json"]);
        assert_eq!((study.end(), worker.end()), (Some(0), Some(0)));
        // The study has ended: nothing listens any more.
        let lost = ["--connect", &endpoint, "--give-up-after", "1", "--log-format", "json"];
        let mut lost = LoggedProcess::start("worker", &lost);
        assert_eq!(lost.end(), Some(1));
        for line in worker.log().lines().chain(lost.log().lines()) {
            let line: serde_json::Value = serde_json::from_str(line).unwrap();
            assert!(line["level"].is_string() && line["message"].is_string(), "{line}");
        }
    });
}

/// With `--live-keep` the page and the report are served after the end, until Ctrl-C.
#[test]
fn a_live_page_stays_until_it_is_told() {
    in_time(|| {
        let folder = tempfile::tempdir().unwrap();
        let (mut study, [endpoint, live]) = visible_study(folder.path(), 12, &["--live-keep"]);
        let mut worker = LoggedProcess::start("worker", &["--connect", &endpoint, "--slots", "1"]);
        let stays = study.wait_for("the live page stays at http://");
        assert!(stays.contains("until Ctrl-C") && stays.ends_with("report.html"), "{stays}");
        assert_eq!(worker.end(), Some(0));
        let page = get(&live, "/", &live);
        assert!(page.contains("The study has ended") || page.contains("<h2>Reliability</h2>"), "{page}");
        let report = get(&live, "/report.html", &live);
        assert!(report.starts_with("HTTP/1.1 200") && report.contains("figures/drawing.svg"), "{report}");
        let figure = get(&live, "/figures/drawing.svg", &live);
        assert!(figure.contains("image/svg+xml") && figure.contains("<svg"), "{figure}");
        for outside in
            ["/figures/..%2Fcampaign.db", "/figures/%2Fetc%2Fhosts", "/figures/.svg", "/campaign.db"]
        {
            assert!(get(&live, outside, &live).starts_with("HTTP/1.1 404"), "{outside}");
        }
        assert!(Command::new("kill").args(["-INT", &study.id().to_string()]).status().unwrap().success());
        assert_eq!(study.end(), Some(0));
    });
}

/// In a browser, the page of a study without results changes to the report while the study runs.
#[test]
fn the_live_page_follows_its_study_in_a_browser() {
    let found = ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find(|name| Command::new(name).arg("--version").output().is_ok());
    let Some(browser) = found else {
        if_installed("the live page in a browser", &mut Command::new("chromium"));
        return;
    };
    in_time(move || {
        let folder = tempfile::tempdir().unwrap();
        let (mut study, [endpoint, live]) = visible_study(folder.path(), 12, &[]);
        let profile = folder.path().join("profile");
        let mut chromium = Command::new(browser);
        // Virtual time stops while the browser waits for updates, so it follows the study to its end.
        chromium.args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--virtual-time-budget=600000",
            "--dump-dom",
        ]);
        chromium.arg(format!("--user-data-dir={}", profile.display())).arg(format!("http://{live}/"));
        let seen = std::thread::spawn(move || chromium.output().unwrap());
        study.wait_for("a browser is connected to the live page");
        let mut worker = LoggedProcess::start("worker", &["--connect", &endpoint, "--slots", "1"]);
        assert_eq!((study.end(), worker.end()), (Some(0), Some(0)));
        let output = seen.join().unwrap();
        let dom = String::from_utf8_lossy(&output.stdout);
        let bar =
            dom.split("id=\"live\"").nth(1).and_then(|rest| rest.split("</p>").next()).unwrap_or_default();
        assert!(bar.contains("The study has ended") || bar.contains("does not answer"), "{bar}\n{dom}");
        // The report with its figures replaces the initial sentence.
        assert!(!dom.contains("before the first round of learning"), "the page did not change");
        assert!(dom.contains("<h2>Reliability</h2>") && dom.contains("<svg"), "{dom}");
    });
}
