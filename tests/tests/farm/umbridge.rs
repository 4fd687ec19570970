//! The UM-Bridge protocol over real sockets: client and server of this program with each other, and each of them with the
//! Python package `umbridge`, which `.ci/run` installs in a virtual environment.

use common::external::{SimulatorError, SimulatorId, SlotError};
use common::scene::{Scene, SceneSource};
use coordinator::farm::dispatch::{CampaignSimulator, CampaignSpec, Listen, ZenohEvaluator};
use coordinator::farm::evaluate::{EvaluateError, EvaluationResult, Evaluator, Finished, Request};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::Arc;
use tests::deployed::KilledOnDrop;
use tests::{campaign, evaluate, in_time, open_simulator, skipped};
use worker::own_simulators::OwnSimulators;
use worker::service::{self, Departure, ServiceConfig};
use worker::simulate::{SimulateOptions, simulate};
use worker::umbridge::{Model, Server};

/// A scene with the variables and outputs of the four-bar, evaluated by the server at `url`.
fn study(url: &str, more: &str) -> Scene {
    source(url, more).nominal().clone()
}

fn source(url: &str, more: &str) -> SceneSource {
    let text = format!(
        "simulator = {{ umbridge = \"{url}\", timeout = \"20 s\" {more} }}\n\
         scene = {{ name = \"four-bar from outside\" }}\n\
         life = {{ cycles = 8000, checkpoint_every = 1000 }}\n\
         outputs = [{{ name = \"wear\", unit = \"m\" }}, {{ name = \"speed\", unit = \"rad/s\" }}]\n\
         limit_states = [{{ name = \"worn\", output = \"wear\", threshold = 8e-6 }}]\n\
         variables = [{{ name = \"wear_coefficient\", mean = 1e-13, std = \"5 %\" }}, \
         {{ name = \"torque\", mean = -0.8, std = \"3 %\" }}, {{ name = \"clearance\", mean = 3e-5, std = 2e-6 }}, \
         {{ name = \"friction\", mean = 0.05, std = \"5 %\" }}]"
    );
    SceneSource::parse(&text, "outside").unwrap()
}

fn evaluator(scene: &Scene, slots: usize) -> Result<Box<dyn Evaluator>, SimulatorError> {
    open_simulator(scene, slots)
}

fn request(id: u64, sample: &[f64]) -> Request {
    Request { id, sample: sample.to_vec(), with_first_cycle: false, accuracy: None, level: 0, not_by: vec![] }
}

fn outcomes(scene: &Scene, batch: &[Request]) -> Result<BTreeMap<u64, EvaluationResult>, EvaluateError> {
    let mut all = BTreeMap::new();
    evaluator(scene, 2).map_err(SlotError::from)?.evaluate(
        batch,
        &mut |Finished { id, outcome, .. }| {
            assert!(all.insert(id, outcome).is_none());
            Ok(())
        },
    )?;
    Ok(all)
}

/// True if the values are equal up to the last digit, which may change in JSON.
fn near(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-15 * b.abs())
}

/// A server of the four-bar with accuracy `draft`, on a free loopback port.
fn server() -> (Server, String) {
    let source = SceneSource::builtin("four-bar").unwrap();
    let model = Model::new(source, "draft".parse().unwrap());
    let server = Server::start(model, 2, "127.0.0.1:0".parse().unwrap()).unwrap();
    let url = format!("http://{}", server.address());
    (server, url)
}

/// Samples with short decimals, which JSON transfers exactly.
const SAMPLES: [[f64; 4]; 3] =
    [[1e-13, -0.8, 3e-5, 0.05], [1.1e-13, -0.82, 2.8e-5, 0.05], [0.9e-13, -0.75, 3e-5, 0.04]];

#[test]
fn a_worker_offers_a_model_to_a_coordinator_that_does_not_reach_its_server() {
    in_time(|| {
        let (server, url) = server();
        let near = source(&url, "");
        // Another address, another time limit: the same simulator.
        let far = source("http://127.0.0.1:9", ", model = \"other\"");
        let id = SimulatorId::of_scene(far.nominal()).unwrap();
        let simulator = Some(CampaignSimulator { id, timeout: 20.0, licences: None });
        let campaign = CampaignSpec { simulator, ..campaign() };
        let mut coordinator = ZenohEvaluator::open(campaign, &Listen::default(), Arc::default()).unwrap();
        let own = OwnSimulators::open(std::slice::from_ref(&near)).unwrap();
        let config = ServiceConfig::new(&coordinator.endpoints[0], 2);
        let worker = service::spawn(config, Arc::new(own)).unwrap();
        let batch: Vec<Request> = (0..).zip(SAMPLES).map(|(id, sample)| request(id, &sample)).collect();
        assert_eq!(evaluate(&mut coordinator, &batch).unwrap(), outcomes(near.nominal(), &batch).unwrap());
        coordinator.finish();
        assert_eq!(worker.join().unwrap(), Departure::CampaignEnded);
        server.finish();
    });
}

#[test]
fn a_scene_gives_the_same_values_over_umbridge_as_in_process() {
    in_time(|| {
        let (server, url) = server();
        let batch: Vec<Request> = (0..).zip(SAMPLES).map(|(id, sample)| request(id, &sample)).collect();
        let found = outcomes(&study(&url, ""), &batch).unwrap();
        let source = SceneSource::builtin("four-bar").unwrap();
        let draft = "draft".parse::<common::accuracy::NamedAccuracy>().unwrap().accuracy;
        for (outcome, sample) in found.values().zip(SAMPLES) {
            let here = simulate(&source.resolve_sample(&sample).unwrap(), &draft, SimulateOptions::default())
                .unwrap();
            let there = outcome.as_ref().unwrap();
            assert_eq!(there.cycles, here.cycles);
            for (a, b) in there.histories.iter().zip(&here.histories) {
                assert!(near(a, b), "{a:?} {b:?}");
            }
        }
        // Every request carries the configuration.
        let scene = study(&url, ", config = { accuracy = \"balanced\" }");
        let balanced = outcomes(&scene, &batch[..1]).unwrap();
        assert_ne!(balanced[&0].as_ref().unwrap().histories, found[&0].as_ref().unwrap().histories);
        server.finish();
    });
}

#[test]
fn a_model_that_does_not_fit_the_scene_is_refused_with_the_reason() {
    in_time(|| {
        let (server, url) = server();
        let said = |scene: &Scene| evaluator(scene, 1).err().expect("it does not fit").to_string();
        let mut other = study(&url, ", model = \"posterior\"");
        assert!(said(&other).contains("has no model \"posterior\"; it has: forward"), "{}", said(&other));
        other = study(&url, ", config = { acuracy = \"draft\" }");
        assert!(
            said(&other).contains("InvalidInput: config: unknown key \"acuracy\"; allowed: accuracy"),
            "{}",
            said(&other)
        );
        other = study(&url, "");
        other.variables.pop();
        assert!(
            said(&other).contains("takes 4 input values [4], the scene has 3 variables"),
            "{}",
            said(&other)
        );
        other = study(&url, "");
        other.outputs.pop();
        assert!(said(&other).contains("returns 16 output values [8, 8]"), "{}", said(&other));
        // A sample without a result is a failed simulation with the cause of the server.
        let failed = outcomes(&study(&url, ""), &[request(0, &[1e-13, -0.8, -1e-5, 0.05])]).unwrap();
        let cause = failed[&0].as_ref().unwrap_err().to_string();
        assert!(cause.contains("SimulationFailed") && cause.contains("radial_clearance"), "{cause}");
        server.finish();
        assert!(said(&study(&url, "")).contains(&format!("simulator.umbridge: {url}/Info: ")));
    });
}

/// Python with the package `umbridge`, in the target folder.
fn python() -> Option<PathBuf> {
    let test = std::env::current_exe().unwrap();
    let python = test.ancestors().nth(3).unwrap().join("umbridge/bin/python");
    let check = Command::new(&python).args(["-c", "import umbridge"]).output();
    if check.is_ok_and(|output| output.status.success()) {
        return Some(python);
    }
    skipped(
        "UM-Bridge against its Python package",
        &format!("{} has none; .ci/run installs it", python.display()),
    );
    None
}

#[test]
fn the_python_package_evaluates_our_scene() {
    let Some(python) = python() else { return };
    let (server, url) = server();
    let program = format!(
        "import json, umbridge\n\
         model = umbridge.HTTPModel('{url}', 'forward')\n\
         assert model.supports_evaluate() and not model.supports_gradient()\n\
         assert model.get_input_sizes() == [4] and model.get_output_sizes() == [8, 8]\n\
         print(json.dumps(model([[1e-13, -0.8, 3e-5, 0.05]], {{'accuracy': 'draft'}})))\n\
         try: model([[1e-13]])\n\
         except Exception as error: print(error)\n"
    );
    let output = Command::new(python).args(["-c", &program]).output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    let (values, error) = said.split_once('\n').unwrap();
    let values: Vec<Vec<f64>> = serde_json::from_str(values).unwrap();
    let found = outcomes(&study(&url, ""), &[request(0, &SAMPLES[0])]).unwrap();
    assert_eq!(values, found[&0].as_ref().unwrap().histories);
    assert!(error.contains("InvalidInput") && error.contains("[1] values, expected [4]"), "{error}");
    server.finish();
}

#[test]
fn a_model_of_the_python_package_is_evaluated() {
    let Some(python) = python() else { return };
    let free = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let program = format!(
        "import umbridge\n\
         class Made(umbridge.Model):\n    \
             def get_input_sizes(self, config): return [1, 3]\n    \
             def get_output_sizes(self, config): return [12, 4]\n    \
             def supports_evaluate(self): return True\n    \
             def __call__(self, input, config):\n        \
                 x = input[0][0]\n        \
                 if x == 2: raise ValueError('two')\n        \
                 return [[x * k for k in range(12)], [sum(input[1]) if x != 3 else float('nan')] * 4]\n\
         umbridge.serve_models([Made('made')], {free})\n"
    );
    let mut child = Command::new(python)
        .args(["-u", "-c", &program])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let out = BufReader::new(child.stdout.take().unwrap());
    let _running = KilledOnDrop(child);
    in_time(move || {
        // It prints a line when it listens; its output must be read, or it would fail.
        let mut lines = out.lines().map_while(Result::ok);
        let listening = lines.any(|line| line.contains("Running on"));
        assert!(listening, "the server ended");
        let scene = study(&format!("http://127.0.0.1:{free}"), ", model = \"made\"");
        let batch = [1.5, 2.0, 3.0].map(|x| request(x as u64, &[x, 0.25, -1.0, 0.5]));
        let found = outcomes(&scene, &batch).unwrap();
        let good = found[&1].as_ref().unwrap();
        assert_eq!(good.histories[0], (0..8).map(|k| 1.5 * f64::from(k)).collect::<Vec<_>>());
        assert_eq!(good.histories[1], [12.0, 13.5, 15.0, 16.5, -0.25, -0.25, -0.25, -0.25]);
        let cause = |id: u64| found[&id].as_ref().unwrap_err().to_string();
        assert!(cause(2).contains("HTTP status 500"), "{}", cause(2));
        assert!(cause(3).contains("returned nan for output speed at cycle 5000"), "{}", cause(3));
    });
}
