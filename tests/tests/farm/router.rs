//! The program `zenohd` with `deploy/zenoh-router.json5`: two sites, each with a router, and certificates on every connection.
//! Skipped, with a message, where `zenohd` is not installed (`$ZENOHD`, or on `PATH`).

use std::path::Path;
use std::time::Duration;
use tests::deployed::{LoggedProcess, answer, session, small_scene};
use tests::router::{TwoSites, zenohd};
use tests::{faults, within};
use zenoh::Wait;

/// Time limit of the two studies; only a defect takes longer.
const LONGEST: Duration = Duration::from_secs(180);

fn text(path: &Path) -> &str {
    path.to_str().expect("a plain path")
}

#[test]
fn a_study_through_two_routers_has_the_bits_of_a_local_one() {
    let Some(zenohd) = zenohd("a study through routers") else { return };
    within(LONGEST, move || {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let (scene, alone, farmed) = (at("small.toml"), at("alone"), at("farmed"));
        std::fs::write(&scene, small_scene(12)).unwrap();
        let study = ["run", text(&scene)];
        let mut local = LoggedProcess::start(
            "coordinator",
            &[&study[..], &["--workers", "1", "--out", text(&alone)]].concat(),
        );
        assert_eq!(local.end(), Some(0), "{}", local.log());

        let sites = TwoSites::start(&zenohd, folder.path());
        let listen = ["--workers", "0", "--listen", &sites.coordinator, "--out", text(&farmed)];
        let config = ["--config", text(&sites.coordinator_config)];
        let mut coordinator = LoggedProcess::start("coordinator", &[&study[..], &listen, &config].concat());
        coordinator.wait_for("waiting for workers");

        // Behind the far router, so that the coordinator could not refuse them itself.
        let far = sites.far.endpoint();
        let refused = [
            (&sites.unlisted_config, "its access_control does not permit the query"),
            (&sites.stranger_config, "does not accept our certificate"),
            (&sites.anonymous_config, "requires a client certificate, and --config names none"),
        ];
        let refused = refused.map(|(config, says)| {
            let config =
                ["--connect", &far, "--slots", "1", "--give-up-after", "3", "--config", text(config)];
            (LoggedProcess::start("worker", &config), says)
        });
        for (mut worker, says) in refused {
            let end = worker.wait_for("worker: no coordinator answered at ");
            assert!(end.contains(says), "no \"{says}\" in: {end}");
            assert_eq!(worker.end(), Some(1));
        }
        // A permitted worker reads nothing of the router itself.
        let permitted = session(&sites.worker_config, &far);
        let replies = permitted.get("@/**").timeout(Duration::from_secs(1)).wait().unwrap();
        let own = format!("@/{}/", permitted.zid());
        let described = replies.into_iter().filter_map(|reply| {
            let key = reply.result().ok()?.key_expr().to_string();
            (!key.starts_with(&own)).then_some(key)
        });
        assert_eq!(described.collect::<Vec<_>>(), Vec::<String>::new());
        permitted.close().wait().unwrap();

        let config = text(&sites.worker_config);
        let mut worker =
            LoggedProcess::start("worker", &["--connect", &far, "--name", "served", "--config", config]);
        assert_eq!(coordinator.end(), Some(0), "{}", coordinator.log());
        assert_eq!(worker.end(), Some(0), "{}", worker.log());
        assert_eq!(answer(&alone), answer(&farmed));
        assert!(!coordinator.log().contains("was lost"), "{}", coordinator.log());
    });
}

#[test]
fn a_killed_router_loses_nothing() {
    let second = Duration::from_secs(1);
    let Some(report) = faults::killed_routers(5 * second, 200, second / 10) else { return };
    println!("{report}");
    assert!(report.is_undisturbed(), "{report:?}");
    assert!(report.times.iter().all(|time| *time < 3 * second), "{report:?}");
}
