//! A made-up study for the tests of report, result files and terminal: two limit states with the lives of the
//! published flapping-wing drive, means and spreads from closed forms instead of simulations.

mod mechanism;

use super::input::{DISTRIBUTIONS_DOCUMENT, OutputDistribution, ReportInput, SUMMARY_DOCUMENT};
use crate::farm::evaluate::{Finished, Request};
use crate::results::journal::Journal;
use crate::results::store::{CampaignFile, CampaignMeta};
use crate::results::summary::*;
use common::accuracy::NamedAccuracy;
use common::failure::SimulationFailure;
use common::outputs::{Diagnostics, Evaluation, JointSummary};
use common::random::{Distribution, RandomVariable};
use common::scene::*;
use mechanism::{PINS, depth, worn};
pub use mechanism::{eccentricity, first_cycle};
use statrs::distribution::{Continuous, ContinuousCDF, Normal};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// Summary and distributions of the made-up study.
pub struct Study {
    pub summary: StudySummary,
    pub distributions: Vec<OutputDistribution>,
}

const VARIABLES: [&str; 14] = [
    "bushing_radius_1",
    "rod_length",
    "bushing_radius_2",
    "rod_inclination",
    "rocker_front_length",
    "rocker_rear_length",
    "journal_modulus_12",
    "bushing_modulus_12",
    "bushing_poisson_12",
    "wear_coefficient_12",
    "wear_coefficient_34",
    "wear_coefficient_56",
    "load_stiffness",
    "friction",
];

pub fn scene() -> Scene {
    let signed = |body, label: &str| SignedBody { body, sign: 1.0, label: label.into() };
    let body = |name: &str, motion| Body { name: name.into(), motion, points: vec![] };
    let variable = |name: &&str| RandomVariable {
        name: name.to_string(),
        distribution: Distribution::truncated_normal(1.0, 0.01, 0.97, 1.03).unwrap(),
        changes: vec![],
        unit: "1".into(),
    };
    let steel = Material { elastic_modulus: 2e11, poisson_ratio: 0.31 };
    let joint = |k: usize| Joint {
        name: k.to_string(),
        journal: Attachment { body: 1, position: PINS[k - 1] },
        bushing: Attachment { body: 2, position: PINS[k - 1] },
        kind: JointKind::Clearance(Clearance {
            journal_radius: 1.5e-3,
            bushing_radius: 1.5235e-3,
            width: 4e-3,
            journal_material: steel,
            bushing_material: steel,
            contact_law: ContactLaw::LocalHertz,
            contact_damping: ContactDamping::None,
            film_damping: 6.55,
            friction: 0.025,
            friction_speed: 2.4e-3,
            wear_coefficient: 1.288e-13,
            control_points: 36,
            wall: None,
        }),
    };
    let kinds = [
        ("max_wear_depth", OutputKind::LargestWear { joints: vec![0] }),
        (
            "angular_velocity_difference",
            OutputKind::AngularVelocityDifference { a: signed(1, "right"), b: signed(2, "left") },
        ),
    ];
    Scene {
        name: "flapping-wing".into(),
        title: "Flapping-wing drive with six worn hinges".into(),
        bodies: vec![
            body("frame", Motion::Fixed),
            body(
                "crank",
                Motion::Driven {
                    position: [0.02, 0.01],
                    drive: Drive::ConstantSpeed { start_angle: 0.0, speed: TAU / 0.125 },
                    inertia: None,
                },
            ),
            body(
                "rod",
                Motion::Free {
                    mass: 0.01,
                    inertia: 1e-6,
                    centre_of_mass: [0.0; 2],
                    start_position: [0.02, 0.01],
                    start_angle: 0.0,
                    start_velocity: [0.0; 2],
                    start_speed: 0.0,
                },
            ),
        ],
        joints: (1..=6).map(joint).collect(),
        loads: vec![],
        gravity: [0.0; 2],
        outputs: kinds.into_iter().map(|(name, kind)| Output { name: name.into(), kind }).collect(),
        variables: VARIABLES.iter().map(variable).collect(),
        correlations: vec![],
        limit_states: vec![
            LimitState { name: "wear".into(), output: 0, threshold: 3e-5, fails: Fails::Above },
            LimitState {
                name: "asymmetry".into(),
                output: 1,
                threshold: 25.0 * PI / 30.0,
                fails: Fails::Above,
            },
        ],
        life: Life { period: 0.125, cycles: 72_000, checkpoint_every: 1000, settle_cycles: 1 },
        study: StudySettings { population: 100_000, initial: 120, batch: 12, max_evaluations: 400, seed: 1 },
        accuracy: NamedAccuracy::default(),
        simulator: None,
    }
}

/// Mean and standard deviation of the two outputs (SI) at a life.
fn moments(cycles: f64) -> [(f64, f64); 2] {
    let wear = 2.88e-5 + 6.2e-10 * (cycles - 64_000.0);
    let growth = ((cycles - 50_000.0) / 14_000.0).max(0.0).powi(3);
    let gamma = 20.6 + 1.15 * growth + 0.8 * ((cycles - 63_000.0) / 1000.0).max(0.0);
    [(wear.max(1e-7), 7e-7), (gamma * PI / 30.0, (0.3 + 0.8 * growth.min(1.5)) * PI / 30.0)]
}

fn reliability_row(cycles: u32, scene: &Scene) -> ReliabilityRow {
    let mut reliability: PerLimitState = scene
        .limit_states
        .iter()
        .zip(moments(cycles.into()))
        .map(|(state, (mean, std))| {
            (state.name.clone(), Normal::new(mean, std).unwrap().cdf(state.threshold))
        })
        .collect();
    let total = reliability.values().product();
    reliability.insert("total".into(), total);
    let standard_error = reliability
        .iter()
        .map(|(name, r)| (name.clone(), (r * (1.0 - r) / 1e5).sqrt() + 0.03 * r * (1.0 - r)))
        .collect();
    // Errors of 0.25 um and 0.1 r/min, as the evaluations state them.
    let moved = |sign: f64| -> PerLimitState {
        let errors = [2.5e-7, 0.1 * PI / 30.0];
        let of = |(state, ((mean, std), error)): (&LimitState, ((f64, f64), f64))| {
            (state.name.clone(), Normal::new(mean + sign * error, std).unwrap().cdf(state.threshold))
        };
        let mut r: PerLimitState =
            scene.limit_states.iter().zip(moments(cycles.into()).into_iter().zip(errors)).map(of).collect();
        r.insert("total".into(), r.values().product());
        r
    };
    let upper = moved(-1.0);
    let range = |(name, lower): (String, f64)| {
        let upper = upper[&name];
        (name, NumericalRange { lower, upper })
    };
    let numerical = moved(1.0).into_iter().map(range).collect();
    ReliabilityRow { cycles, reliability, standard_error, numerical }
}

fn distribution(output: usize, cycles: u32, scene: &Scene) -> OutputDistribution {
    let (mean, std) = moments(cycles.into())[output];
    let normal = Normal::new(mean, std).unwrap();
    let edges: Vec<f64> = (0..=40).map(|k| mean + std * (0.17 * k as f64 - 3.4)).collect();
    let counts = edges.windows(2).map(|e| (1e5 * (normal.cdf(e[1]) - normal.cdf(e[0]))).round() as u64);
    OutputDistribution {
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
        for (k, variable) in VARIABLES.iter().enumerate() {
            let weight = (1.7 * (k + 3 * s) as f64).sin() * 0.8f64.powi(k as i32);
            let scaled =
                SensitivityError { d_pf_d_mean: density * weight, d_pf_d_std: density * weight * weight * z };
            rows.push(SensitivityRow {
                cycles,
                limit_state: state.name.clone(),
                variable: variable.to_string(),
                d_pf_d_mean: scaled.d_pf_d_mean / 0.01,
                d_pf_d_std: scaled.d_pf_d_std / 0.01,
                standard_error: SensitivityError { d_pf_d_mean: 0.3, d_pf_d_std: 0.4 },
                scaled,
            });
        }
    }
    rows
}

/// Who was first goes by who has failed; a tenth of the failures are of both.
fn first_failure_row(cycles: u32, scene: &Scene) -> FirstFailureRow {
    let row = reliability_row(cycles, scene);
    let failed: Vec<f64> =
        scene.limit_states.iter().map(|state| 1.0 - row.reliability[&state.name]).collect();
    let all: f64 = failed.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let system = 1.0 - row.reliability["total"];
    let share = |(state, failed): (&LimitState, &f64)| (state.name.clone(), 0.9 * system * failed / all);
    FirstFailureRow {
        cycles,
        together: 0.1 * system,
        first: scene.limit_states.iter().zip(&failed).map(share).collect(),
    }
}

fn sobol(cycles: u32, scene: &Scene) -> Vec<SobolRow> {
    let of_state = |(s, state): (usize, &LimitState)| {
        let row = |k: usize| SobolRow {
            cycles,
            limit_state: state.name.clone(),
            variable: VARIABLES[(k + 4 * s) % VARIABLES.len()].to_string(),
            first_order: 0.5 * 0.5f64.powi(k as i32),
            total: 0.6 * 0.5f64.powi(k as i32),
            standard_error: SobolError { first_order: 0.01, total: 0.004 },
        };
        (0..VARIABLES.len()).map(row).collect::<Vec<_>>()
    };
    scene.limit_states.iter().enumerate().flat_map(of_state).collect()
}

fn rounds() -> Vec<Round> {
    (0..9)
        .map(|k| Round {
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
        })
        .collect()
}

pub fn study() -> Study {
    let scene = scene();
    let checkpoints = scene.life.checkpoints();
    let moment_row = |cycles: &u32| {
        let [wear, gamma] = moments((*cycles).into());
        let rpm = 30.0 / PI;
        let moments = BTreeMap::from([
            ("wear_mean_m".to_string(), wear.0),
            ("wear_std_m".to_string(), wear.1),
            ("asymmetry_mean_rpm".to_string(), gamma.0 * rpm),
            ("asymmetry_std_rpm".to_string(), gamma.1 * rpm),
        ]);
        MomentsRow { cycles: *cycles, moments }
    };
    let worker = |k: usize| WorkerShare {
        name: format!("workshop-4711/{k}"),
        evaluations: 108,
        simulation_s: 160.0 + k as f64,
    };
    let summary = StudySummary {
        scene: scene.name.clone(),
        version: "0.1.0".into(),
        seed: 20_260_101,
        method: "ak".into(),
        accuracy: "balanced".into(),
        accuracy_settings: Some(common::accuracy::Accuracy::balanced()),
        max_error: None,
        population: 100_000,
        evaluations: EvaluationCounts { total: 216, initial: 120, added: 96, failed: 1 },
        limit_states: scene.limit_states.iter().map(|state| state.name.clone()).collect(),
        first_failure: checkpoints.iter().map(|cycles| first_failure_row(*cycles, &scene)).collect(),
        failures: Failures {
            barred_share: 0.004,
            simulations: vec![FailureRow {
                cause: "at cycle 61000, t = 0.05 s, the bound of 200000 steps per cycle was reached".into(),
                sample: VARIABLES.iter().map(|name| (name.to_string(), 1.01)).collect(),
            }],
        },
        conditional: None,
        sobol: [64_000, 66_000].into_iter().flat_map(|n| sobol(n, &scene)).collect(),
        reliability: checkpoints.iter().map(|cycles| reliability_row(*cycles, &scene)).collect(),
        moments: checkpoints.iter().map(moment_row).collect(),
        sensitivity: [64_000, 66_000, 68_000].into_iter().flat_map(|n| sensitivity(n, &scene)).collect(),
        convergence: Convergence {
            stopped_because: "the estimated error of every R(n) stayed below 0.006 over two rounds".into(),
            targets_met: true,
            rounds: rounds(),
        },
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
        timing_s: Timing { total: 221.4, simulation: 322.0, surrogate: 48.2, idle: 61.0 },
        workers: vec![worker(0), worker(1)],
    };
    let distributions = (0..2)
        .flat_map(|output| checkpoints.iter().map(move |cycles| (output, *cycles)))
        .map(|(output, cycles)| distribution(output, cycles, &scene))
        .collect();
    Study { summary, distributions }
}

fn evaluation(id: u64, scene: &Scene) -> Evaluation {
    let checkpoints = scene.life.checkpoints();
    let shift = (id as f64 * 0.7).sin();
    let history = |output: usize| {
        let at = |cycles: &u32| {
            let (mean, std) = moments((*cycles).into())[output];
            mean + std * shift
        };
        checkpoints.iter().map(at).collect()
    };
    let joint = |k: usize| JointSummary {
        name: k.to_string(),
        peak_force: if k > 4 { 9.27 } else { 5.94 },
        wear_depth: depth(k),
    };
    Evaluation {
        histories: vec![history(0), history(1)],
        errors: vec![vec![2.5e-7; checkpoints.len()], vec![0.1 * PI / 30.0; checkpoints.len()]],
        cycles: checkpoints,
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
    for id in 0..12 {
        let sample = (0..VARIABLES.len()).map(|k| 1.0 + 0.01 * ((id * 14 + k as u64) as f64).sin()).collect();
        let request = Request { id, sample, with_first_cycle: id == 0, accuracy: None };
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

/// What the report of that campaign is made from.
pub fn input() -> ReportInput {
    let dir = tempfile::tempdir().unwrap();
    ReportInput::from_campaign(&campaign(dir.path()), &scene()).unwrap().unwrap()
}
