//! A model of a UM-Bridge server that gives cycles, against a closed form: a force that does not turn, on a bushing in which the journal does.

use crate::evaluate;
use axum::Json;
use axum::extract::State;
use axum::routing::{get, post};
use common::scene::SceneSource;
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::sync::{Arc, Mutex};
use worker::evaluation_slots::EvaluationSlots;

const JOURNAL: f64 = 5e-3;
const COEFFICIENT: f64 = 1e-13;
const INSTANTS: usize = 100;

/// Configurations of the requests so far, each with the largest radius of the bushing.
type Asked = Arc<Mutex<Vec<(Value, f64)>>>;

/// One cycle under the force of the request: outputs, instants, force in x and y, angle.
async fn evaluated(State(asked): State<Asked>, Json(request): Json<Value>) -> Json<Value> {
    let bushing = request["input"][1].as_array().unwrap().iter().map(|r| r.as_f64().unwrap());
    let deepest = bushing.fold(0.0, f64::max);
    asked.lock().unwrap().push((request["config"].clone(), deepest));
    let force = request["input"][0][0].as_f64().unwrap();
    let of = |value: &dyn Fn(f64) -> f64| -> Vec<f64> {
        (0..INSTANTS).map(|k| value(k as f64 / INSTANTS as f64)).collect()
    };
    let instants = [of(&|t| 0.1 * t), of(&|_| force), of(&|t| deepest * 1e-6 * t), of(&|t| TAU * t)];
    let output = [&[vec![force]][..], &instants].concat();
    Json(json!({ "output": output }))
}

/// A server of the model `pin`, and of `short`, which gives no angle, at this address.
fn server(asked: &Asked) -> String {
    let (sender, address) = std::sync::mpsc::channel();
    let asked = Arc::clone(asked);
    let serve = async move {
        let info = json!({ "protocolVersion": 1.0, "models": ["pin", "short"] });
        let about = json!({ "support": { "Evaluate": true } });
        let outputs = async |Json(asked): Json<Value>| {
            let vectors = if asked["name"] == "pin" { 4 } else { 3 };
            let sizes = [vec![1], vec![INSTANTS; vectors]].concat();
            Json(json!({ "outputSizes": sizes }))
        };
        let router = axum::Router::new()
            .route("/Info", get(async move || Json(info.clone())))
            .route("/ModelInfo", post(async move || Json(about.clone())))
            .route("/InputSizes", post(async || Json(json!({ "inputSizes": [2, 36, 36] }))))
            .route("/OutputSizes", post(outputs))
            .route("/Evaluate", post(evaluated))
            .with_state(asked);
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        sender.send(listener.local_addr().unwrap()).unwrap();
        axum::serve(listener, router).await.unwrap();
    };
    // The thread ends with the test.
    std::thread::spawn(|| tokio::runtime::Runtime::new().unwrap().block_on(serve));
    format!("http://{}", address.recv().unwrap())
}

fn scene(url: &str, more: &str) -> SceneSource {
    let text = format!(
        r#"
scene = {{ name = "pin" }}
simulator = {{ gives = "cycle", tier = "contact", umbridge = "{url}", config = {{ mesh = 3 }}, {more} }}
life = {{ period = "100 ms", cycles = 4000, checkpoint_every = 1000 }}
study = {{ accuracy = "draft" }}
parameters = {{ load = "5 N", worn = "{COEFFICIENT} 1/Pa" }}
materials.steel = {{ elastic_modulus = "206 GPa", poisson_ratio = 0.3 }}
joints = [{{ name = "pin", journal_radius = "{JOURNAL} m", radial_clearance = "30 um", width = "10 mm", journal_material = "steel", bushing_material = "steel", contact_law = "local-hertz", wear_coefficient = "worn", control_points = 36 }}]
outputs = [{{ name = "wear", type = "worn-volume" }}, {{ name = "force", unit = "N" }}]
limit_states = [{{ name = "worn", output = "wear", threshold = "1 mm^3" }}]
variables = [{{ name = "load", changes = ["parameters.load"], std = "5 %" }}, {{ name = "worn", changes = ["parameters.worn"], std = "5 %" }}]
conditions = [{{ name = "half", share = 0.75, changes = {{ parameters.load = "0.5 * load" }} }}, {{ name = "whole", share = 0.25, changes = {{ parameters.load = "load", life.period = "100 ms" }} }}]
"#
    );
    SceneSource::parse(&text, "pin.toml").unwrap_or_else(|faults| panic!("{faults}"))
}

#[test]
fn a_model_wears_its_pin_under_two_conditions() {
    let asked = Asked::default();
    let url = server(&asked);
    let life = evaluate(&scene(&url, "model = \"pin\""), &[8.0, COEFFICIENT]).unwrap().unwrap();
    // Archard: V = K F s, with the mean force.
    let expected = 4000.0 * COEFFICIENT * (0.75 * 4.0 + 0.25 * 8.0) * TAU * JOURNAL;
    let found = life.histories[0][3];
    assert!((found / expected - 1.0).abs() < 1e-3, "{found}, by the law {expected}");
    assert_eq!(life.histories[1], [8.0; 4], "the largest of both conditions");
    let asked = asked.lock().unwrap();
    assert_eq!(asked.len() as u64, life.diagnostics.simulated_cycles);
    for (pair, cycle) in asked.chunks(2).zip([0, 250]) {
        for ((config, _), condition) in pair.iter().zip(["half", "whole"]) {
            let expected = json!({ "mesh": 3, "cycle": cycle, "condition": condition, "accuracy": "draft", "period": 0.1 });
            assert_eq!(*config, expected);
        }
    }
    // Both conditions are on the same bore, which wears.
    assert!(asked.chunks(2).all(|pair| pair[0].1 == pair[1].1) && asked[2].1 > asked[0].1 + 1e-7);
}

#[test]
fn a_model_of_other_vectors_is_refused() {
    let url = server(&Asked::default());
    let refused = |source: &SceneSource| match EvaluationSlots::open(source).unwrap() {
        Err(error) => error.to_string(),
        Ok(_) => evaluate(source, &[8.0, COEFFICIENT]).unwrap_err().to_string(),
    };
    let short = refused(&scene(&url, "model = \"short\""));
    let expected =
        "simulator.model: model \"short\" has vectors of [1, 100, 100, 100] values, expected 1 outputs";
    assert!(short.starts_with(expected), "{short}");
    let points = scene(&url, "model = \"pin\"").text().replace("control_points = 36", "control_points = 48");
    let points = refused(&SceneSource::parse(&points, "pin.toml").unwrap());
    assert_eq!(
        points,
        "simulator.model: model \"pin\" has vectors of [2, 36, 36] values, expected [2, 48, 48] by the control points"
    );
}
