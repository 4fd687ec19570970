//! Test fixture: a study of the built-in flapping-wing drive whose results come from closed forms instead of simulations, for
//! the tests of result files, report and terminal. Its mechanism is replaced by a rod on six pins with known motion.

mod mechanism;
mod points;

use crate::farm::evaluate::{Finished, Request};
use crate::presentation::report::{
    CheckpointDistribution, DISTRIBUTIONS_DOCUMENT, ReportInput, SUMMARY_DOCUMENT,
};
use crate::results::journal::Journal;
use crate::results::life_summary::{CyclesRange, LifeCurveRow, LifeRow};
use crate::results::scene_summary::{limit_rows, sha256, unit_rows, variable_rows};
use crate::results::store::{CampaignFile, CampaignMeta};
use crate::results::summary::*;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::{Diagnostics, Evaluation, JointSummary};
use common::scene::{Scene, SceneSource};
use mechanism::{depth, rod_on_pins, worn};
pub use mechanism::{eccentricity, first_cycle};
pub use points::report_with_samples;
use points::{failure_point, prediction};
use statrs::distribution::{Continuous, ContinuousCDF, Normal};
use std::f64::consts::PI;
use std::path::Path;

/// Numerical errors of the two outputs [m, rad/s].
const STATED_ERRORS: [f64; 2] = [2.5e-7, 0.1 * PI / 30.0];

/// Summary and distributions of the study.
pub struct TestStudy {
    pub summary: StudySummary,
    pub distributions: Vec<CheckpointDistribution>,
}

/// The built-in scene with the mechanism of the fixture.
pub fn scene() -> Scene {
    let mut scene = SceneSource::builtin("flapping-wing").unwrap().nominal().clone();
    rod_on_pins(&mut scene);
    scene
}

/// Mean and standard deviation of the two outputs [SI] at a life [cycles].
fn moments(cycles: f64) -> [(f64, f64); 2] {
    let wear = 2.88e-5 + 6.2e-10 * (cycles - 64_000.0);
    let growth = ((cycles - 50_000.0) / 14_000.0).max(0.0).powi(3);
    let gamma = 20.6 + 1.15 * growth + 0.8 * ((cycles - 63_000.0) / 1000.0).max(0.0);
    [(wear.max(1e-7), 7e-7), (gamma * PI / 30.0, (0.3 + 0.8 * growth.min(1.5)) * PI / 30.0)]
}

/// Reliabilities of normal outputs whose means are shifted by a multiple of the stated errors.
fn reliabilities(cycles: u32, scene: &Scene, shift: f64) -> PerLimitState {
    let outputs = moments(cycles.into()).into_iter().zip(STATED_ERRORS);
    let states = scene.limit_states.iter().zip(outputs);
    let mut r: PerLimitState = states
        .map(|(state, ((mean, std), error))| {
            (state.name.clone(), Normal::new(mean + shift * error, std).unwrap().cdf(state.threshold))
        })
        .collect();
    r.insert("total".into(), r.values().product());
    r
}

fn reliability_row(cycles: u32, scene: &Scene) -> ReliabilityRow {
    let reliability = reliabilities(cycles, scene, 0.0);
    let interval = |r: f64| {
        let reach = 1.96 * error_of(r);
        ReliabilityRange { lower: (r - reach).max(0.0), upper: (r + reach).min(1.0) }
    };
    let of_curves = || reliability.iter().map(|(name, r)| (name.clone(), *r));
    let mut row = ReliabilityRow {
        cycles,
        standard_error: of_curves().map(|(name, r)| (name, error_of(r))).collect(),
        interval: of_curves().map(|(name, r)| (name, interval(r))).collect(),
        reliability: reliability.clone(),
        ..ReliabilityRow::default()
    };
    let [upper, lower] = [-1.0, 1.0].map(|shift| reliabilities(cycles, scene, shift));
    for name in reliability.keys() {
        row.add_numerical(name, ReliabilityRange { lower: lower[name], upper: upper[name] });
    }
    row
}

/// Standard error of a reliability.
fn error_of(r: f64) -> f64 {
    (r * (1.0 - r) / 1e5).sqrt() + 0.03 * r * (1.0 - r)
}

/// The curve of a limit state or of the system, every 250 cycles.
fn life_curve(name: &str, scene: &Scene) -> LifeCurveRow {
    let times: Vec<u32> = (0..=288).map(|k| 250 * k).collect();
    let curve = |shift: f64, errors: f64| -> Vec<f64> {
        let r = times.iter().map(|t| reliabilities(*t, scene, shift)[name]);
        r.map(|r| (r + errors * 1.96 * error_of(r)).clamp(0.0, 1.0)).collect()
    };
    LifeCurveRow {
        limit_state: name.to_owned(),
        reliability: curve(0.0, 0.0),
        lower: curve(1.0, -1.0),
        upper: curve(-1.0, 1.0),
        numerical_lower: vec![],
        numerical_upper: vec![],
        cycles: times.iter().map(|t| f64::from(*t)).collect(),
    }
}

/// Lives read from such a curve.
fn lives(curve: &LifeCurveRow) -> Vec<LifeRow> {
    let reached = |values: &[f64], level: f64| {
        let at = values.iter().position(|r| *r <= level)?;
        let along = (values[at - 1] - level) / (values[at - 1] - values[at]);
        Some(curve.cycles[at - 1] + along * (curve.cycles[at] - curve.cycles[at - 1]))
    };
    let range = |lower: &[f64], upper: &[f64], level: f64| CyclesRange {
        lower: reached(lower, level).unwrap(),
        upper: reached(upper, level),
    };
    let row = |level: f64| LifeRow {
        limit_state: curve.limit_state.clone(),
        reliability: level,
        cycles: reached(&curve.reliability, level),
        interval: range(&curve.lower, &curve.upper, level),
        with_numerical_error: None,
    };
    [0.99, 0.9, 0.5].map(row).to_vec()
}

fn distribution(output: usize, cycles: u32, scene: &Scene) -> CheckpointDistribution {
    let (mean, std) = moments(cycles.into())[output];
    let normal = Normal::new(mean, std).unwrap();
    let edges: Vec<f64> = (0..=40).map(|k| mean + std * (0.17 * k as f64 - 3.4)).collect();
    let counts = edges.windows(2).map(|e| (1e5 * (normal.cdf(e[1]) - normal.cdf(e[0]))).round() as u64);
    CheckpointDistribution {
        output: scene.outputs[output].name.clone(),
        cycles,
        mean,
        std,
        counts: counts.collect(),
        quantiles: [0.01, 0.25, 0.5, 0.75, 0.99].map(|p| (p, normal.inverse_cdf(p))).to_vec(),
        edges,
    }
}

fn sensitivity(cycles: u32, scene: &Scene) -> Vec<SensitivityRow> {
    let mut rows = Vec::new();
    for (s, state) in scene.limit_states.iter().enumerate() {
        let (mean, std) = moments(cycles.into())[s];
        let z = (state.threshold - mean) / std;
        let density = Normal::standard().pdf(z);
        for (k, variable) in scene.variables.iter().enumerate() {
            let weight = (1.7 * (k + 3 * s) as f64).sin() * 0.8f64.powi(k as i32);
            let scaled =
                SensitivityError { d_pf_d_mean: density * weight, d_pf_d_std: density * weight * weight * z };
            rows.push(SensitivityRow {
                cycles,
                limit_state: state.name.clone(),
                variable: variable.name.clone(),
                d_pf_d_mean: scaled.d_pf_d_mean / 0.01,
                d_pf_d_std: scaled.d_pf_d_std / 0.01,
                standard_error: SensitivityError { d_pf_d_mean: 0.3, d_pf_d_std: 0.4 },
                scaled,
            });
        }
    }
    rows
}

/// First failures in proportion to all failures; a tenth of the failures are of both.
fn first_failure_row(row: &ReliabilityRow, scene: &Scene) -> FirstFailureRow {
    let failed = |name: &str| 1.0 - row.reliability[name];
    let all: f64 = scene.limit_states.iter().map(|state| failed(&state.name)).sum();
    let share = |name: &str| 0.9 * failed("total") * failed(name) / all.max(f64::MIN_POSITIVE);
    let first = scene.limit_states.iter().map(|state| (state.name.clone(), share(&state.name)));
    FirstFailureRow { cycles: row.cycles, together: 0.1 * failed("total"), first: first.collect() }
}

fn sobol(cycles: u32, scene: &Scene) -> Vec<SobolRow> {
    let d = scene.variables.len();
    let mut rows = Vec::new();
    for (s, state) in scene.limit_states.iter().enumerate() {
        rows.extend((0..d).map(|k| SobolRow {
            cycles,
            limit_state: state.name.clone(),
            variable: scene.variables[(k + 4 * s) % d].name.clone(),
            first_order: 0.5 * 0.5f64.powi(k as i32),
            total: 0.6 * 0.5f64.powi(k as i32),
            standard_error: SobolError { first_order: 0.01, total: 0.004 },
        }));
    }
    rows
}

fn round(k: usize) -> Round {
    Round {
        round: k,
        evaluations: 120 + 12 * k,
        min_u: 0.02 + 0.16 * k as f64,
        share_uncertain: 0.3 * 0.62f64.powi(k as i32),
        change_of_r: (k > 0).then(|| 0.12 * 0.5f64.powi(k as i32)),
        surrogate_error: 0.03 * 0.75f64.powi(k as i32),
        cov_pf: 0.004,
        dominance: Some(0.7),
        cycles: if k == 0 { 65_000 } else { 66_000 },
        reliability_total: 0.347 + 0.08 * (-0.6f64).powi(k as i32),
        repairs: usize::from(k == 1),
    }
}

pub fn study() -> TestStudy {
    let scene = scene();
    let checkpoints = scene.life.checkpoints();
    let reliability: Vec<_> = checkpoints.iter().map(|cycles| reliability_row(*cycles, &scene)).collect();
    let moment_row = |cycles: &u32| {
        let [wear, gamma] = moments((*cycles).into());
        let rpm = 30.0 / PI;
        let moments = [
            ("wear_mean_m", wear.0),
            ("wear_std_m", wear.1),
            ("asymmetry_mean_rpm", gamma.0 * rpm),
            ("asymmetry_std_rpm", gamma.1 * rpm),
        ];
        MomentsRow {
            cycles: *cycles,
            moments: moments.map(|(key, value)| (key.to_string(), value)).into_iter().collect(),
        }
    };
    let worker = |k: usize| WorkerShare {
        name: format!("workshop-4711/{k}"),
        evaluations: 108,
        simulation_s: 160.0 + k as f64,
    };
    let names = scene.limit_states.iter().map(|state| state.name.as_str()).chain(["total"]);
    let curves: Vec<LifeCurveRow> = names.map(|name| life_curve(name, &scene)).collect();
    let summary = StudySummary {
        schema: SCHEMA,
        created: "2026-01-31T12:00:00.000Z".into(),
        scene_sha256: sha256("a scene"),
        limits: limit_rows(&scene),
        variables: variable_rows(&scene),
        units: unit_rows(&scene),
        lives: curves.iter().flat_map(lives).collect(),
        curves,
        unresolved_fall: None,
        control_points: Vec::new(),
        levels: None,
        variants: Vec::new(),
        scene: scene.name.clone(),
        version: "0.1.0".into(),
        seed: 20_260_101,
        method: "ak".into(),
        accuracy: "balanced".into(),
        accuracy_settings: Some(Accuracy::balanced()),
        max_error: None,
        population: 100_000,
        evaluations: EvaluationCounts { total: 216, initial: 120, added: 96, failed: 1 },
        designs: Vec::new(),
        simulations_beyond_a_limit: Some(90),
        largest_gap: Some(0.031),
        outliers: Vec::new(),
        scale: None,
        untested: None,
        limit_states: scene.limit_states.iter().map(|state| state.name.clone()).collect(),
        first_failure: reliability.iter().map(|row| first_failure_row(row, &scene)).collect(),
        failures: Failures {
            barred_share: 0.004,
            simulations: vec![FailureRow {
                cause: "at cycle 61000, t = 0.05 s, the bound of 200000 steps per cycle was reached".into(),
                sample: scene.variables.iter().map(|variable| (variable.name.clone(), 1.01)).collect(),
            }],
        },
        conditional: None,
        sobol: [64_000, 66_000].into_iter().flat_map(|n| sobol(n, &scene)).collect(),
        reliability,
        moments: checkpoints.iter().map(moment_row).collect(),
        sensitivity: [64_000, 66_000, 68_000].into_iter().flat_map(|n| sensitivity(n, &scene)).collect(),
        convergence: Convergence {
            stopped_because: "the estimated error of every R(n) stayed below 0.006 over two rounds".into(),
            targets_met: true,
            larger_budget: None,
            rounds: (0..9).map(round).collect(),
        },
        failure_points: scene.limit_states.iter().map(|state| failure_point(&state.name, &scene)).collect(),
        predictions: scene.limit_states.iter().map(|state| prediction(&state.name)).collect(),
        surrogates: vec![SurrogateRow {
            limit_state: "wear".into(),
            q2: 0.98,
            q2_cross_validated: Some(0.97),
            variance_factor: Some(1.2),
            noise_share: Some(0.03),
            kernel: "gaussian".into(),
            trend: "constant".into(),
            share_of_stated_error: Some(0.05),
            ..SurrogateRow::default()
        }],
        timing_s: Timing {
            total: 221.4,
            simulation: 322.0,
            surrogate: 48.2,
            idle: 61.0,
            runs: 1,
            workers: 2,
        },
        workers: vec![worker(0), worker(1)],
    };
    let distributions = (0..2)
        .flat_map(|output| checkpoints.iter().map(move |cycles| (output, *cycles)))
        .map(|(output, cycles)| distribution(output, cycles, &scene))
        .collect();
    TestStudy { summary, distributions }
}

fn evaluation(id: u64, scene: &Scene) -> Evaluation {
    let checkpoints = scene.life.checkpoints();
    let shift = (id as f64 * 0.7).sin();
    let history = |output: usize| {
        let moments = checkpoints.iter().map(|cycles| moments((*cycles).into())[output]);
        moments.map(|(mean, std)| mean + std * shift).collect()
    };
    let joint = |k: usize| JointSummary {
        name: k.to_string(),
        peak_force: if k > 4 { 9.3 } else { 5.9 },
        wear_depth: depth(k),
        journal_wear_depth: Vec::new(),
    };
    Evaluation {
        histories: vec![history(0), history(1)],
        errors: STATED_ERRORS.map(|error| vec![error; checkpoints.len()]).to_vec(),
        cycles: checkpoints,
        start: vec![Some(0.0), None],
        joints: (1..=6).map(joint).collect(),
        first_cycle: (id == 0).then(first_cycle),
        worn: (id == 0).then(worn),
        diagnostics: Diagnostics {
            steps: 1_250_000,
            rejected_steps: 310,
            newton_iterations: 4_100,
            force_evaluations: 3_760_000,
            simulated_cycles: 81,
            wear_stages: 240,
            rejected_wear_steps: 2,
            free_flight_fraction: (1..=6).map(|k| (k.to_string(), 0.01 * k as f64)).collect(),
            ..Diagnostics::default()
        },
    }
}

/// A finished campaign of twelve evaluations, one of them failed.
pub fn campaign(dir: &Path) -> CampaignFile {
    let scene = scene();
    let meta = CampaignMeta {
        scene: scene.name.clone(),
        scene_source: "[scene]\nname = \"flapping-wing\"\ntitle = \"six < seven & more\"\n".into(),
        settings: serde_json::json!({"method": "ak", "seed": 20_260_101, "population": 100_000}),
        command: "coordinator run --scene flapping-wing --workers auto --out study".into(),
        version: "0.1.0".into(),
    };
    let mut campaign = CampaignFile::create(dir, &meta, &scene).unwrap();
    let d = scene.variables.len() as u64;
    for id in 0..12 {
        let sample = (0..d).map(|k| 1.0 + 0.01 * ((id * d + k) as f64).sin()).collect();
        let request =
            Request { id, sample, with_first_cycle: id == 0, accuracy: None, level: 0, not_by: vec![] };
        let failure =
            SimulationFailure::TooManySteps { cycle: 61_000, time: 0.05, joint: None, bound: 200_000 };
        let outcome = if id == 7 { Err(failure) } else { Ok(evaluation(id, &scene)) };
        let finished = Finished { id, outcome, worker: format!("workshop-4711/{}", id % 2), wall: 1.5 };
        campaign.record(&request, &finished).unwrap();
    }
    let study = study();
    for round in &study.summary.convergence.rounds {
        campaign.note_round(round).unwrap();
    }
    campaign.put_document(SUMMARY_DOCUMENT, &study.summary).unwrap();
    campaign.put_document(DISTRIBUTIONS_DOCUMENT, &study.distributions).unwrap();
    campaign
}

/// The data of the report of that campaign.
pub fn report_input() -> ReportInput {
    let dir = tempfile::tempdir().unwrap();
    ReportInput::from_campaign(&campaign(dir.path()), &scene()).unwrap().unwrap()
}
