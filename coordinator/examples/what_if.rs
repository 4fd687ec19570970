//! What-if against new studies of the changed scene, or against the truth of made-up responses: every seed draws a change.
//!
//! ```sh
//! cargo run --release -p coordinator --example what_if -- study --seeds 1..10
//! cargo run --release -p coordinator --example what_if -- functions --seeds 1..50
//! ```
//!
//! For a study, the change is answered from its simulations alone, and compared at every checkpoint with a new study of the
//! changed scene under another seed, simulated in this process. A case is within the stated errors if every R(n) differs by
//! at most 1.96 times the root of the sum of squares of both standard errors; where both are settled, within 0.001 of 0 or 1,
//! nothing is compared.

use clap::Parser;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::{Faults, Scene, SceneSource};
use coordinator::analyses::what_if::{FinishedStudy, POPULATION, WhatIf, ask, changed_scene};
use coordinator::farm::evaluate::{Request, local::LocalEvaluator};
use coordinator::results::journal::InMemoryJournal;
use coordinator::results::progress::Silent;
use coordinator::results::store::{CampaignFile, StoredEvaluation};
use coordinator::results::summary::StudySummary;
use coordinator::statistics::design::{InputModel, Population};
use coordinator::study::{Correction, Observed, Settings, StoredOutcome, run};
use rand::{Rng, RngExt};
use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use std::error::Error;
use std::path::Path;
use std::time::Instant;
use worker::simulate::{SimulateOptions, simulate};

/// Compare what-ifs with new studies of the changed scene
#[derive(Debug, Parser)]
struct Arguments {
    /// Folder of a finished study of a mechanism, or `functions` for made-up responses of known truth
    study: String,
    /// Seeds of the changes, FROM..TO, both included
    #[arg(long, default_value = "1..10", value_parser = seeds)]
    seeds: (u64, u64),
    /// Threads that simulate
    #[arg(long, default_value = "2")]
    threads: usize,
    /// Largest shift of a mean in standard deviations
    #[arg(long, default_value = "2")]
    shift: f64,
}

fn seeds(text: &str) -> Result<(u64, u64), String> {
    let ends = text.split_once("..").and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    ends.filter(|(a, b)| a <= b).ok_or_else(|| "allowed: FROM..TO, e.g. 1..10".to_owned())
}

/// Standard errors within which two results agree.
const REACH: f64 = 1.96;
/// Share of R or of its rest below which a checkpoint is settled.
const SETTLED: f64 = 1e-3;

/// Result of one comparison.
struct Compared {
    /// R(n) that were compared, over all curves and checkpoints, and those within the stated errors.
    counted: (usize, usize),
    /// Largest difference in standard errors, and that difference.
    worst: (f64, f64),
}

/// Compares R with `truth` (value and standard error) for every curve and checkpoint.
fn compare(answer: &StudySummary, truth: impl Fn(usize, &str) -> (f64, f64)) -> Compared {
    let mut found = Compared { counted: (0, 0), worst: (0.0, 0.0) };
    for (n, row) in answer.reliability.iter().enumerate() {
        for (name, r) in &row.reliability {
            let (truth, error) = truth(n, name);
            let settled = |r: f64| !(SETTLED..=1.0 - SETTLED).contains(&r);
            if settled(*r) && settled(truth) {
                continue;
            }
            let distance = (r - truth).abs() / row.standard_error[name].hypot(error);
            found.counted.0 += 1;
            found.counted.1 += usize::from(distance <= REACH);
            if distance > found.worst.0 {
                found.worst = (distance, r - truth);
            }
        }
    }
    found
}

/// A random change: the spread of one variable by a factor from 0.5 to 2, the mean of another by up to `shift` standard
/// deviations, and in every second case a threshold by up to a tenth.
fn draw_change(scene: &Scene, rng: &mut impl Rng, shift: f64) -> Vec<String> {
    let d = scene.variables.len();
    let (first, second) = (rng.random_range(0..d), rng.random_range(0..d));
    let (factor, shift) = (2f64.powf(rng.random_range(-1.0..1.0)), rng.random_range(-shift..shift));
    let by_threshold = rng.random_bool(0.5);
    let (state, relative) = (rng.random_range(0..scene.limit_states.len()), rng.random_range(-0.1..0.1));
    let quantity = |k: usize, value: f64| {
        let unit = &scene.variables[k].unit;
        // The unit was read when the scene was checked; "1" denotes a plain number.
        let scale = common::scene::expression::read_unit(unit).map_or(1.0, |u| u.multiply / u.divide);
        if unit == "1" { format!("{value:e}") } else { format!("{:e} {unit}", value / scale) }
    };
    let law = |k: usize| scene.variables[k].distribution.clone();
    let name = |k: usize| &scene.variables[k].name;
    let mut sets = Vec::new();
    // A relative standard deviation would follow the mean.
    let std = |k: usize, factor: f64| format!("{}.std={}", name(k), quantity(k, factor * law(k).given_std()));
    sets.push(std(first, factor));
    let mean = law(second).parent_mean() + shift * law(second).given_std();
    sets.push(format!("{}.mean={}", name(second), quantity(second, mean)));
    if second != first {
        sets.push(std(second, 1.0));
    }
    if by_threshold {
        let limit = &scene.limit_states[state];
        let unit = scene.outputs[limit.output].kind.unit();
        let value = unit.to_file(limit.threshold * (1.0 + relative));
        let unit = match unit.suffix() {
            "m" => " m",
            "rpm" => " r/min",
            "N" => " N",
            "Nm" => " N m",
            "deg" => " deg",
            _ => "",
        };
        sets.push(format!("{}.threshold={value:e}{unit}", limit.name));
    }
    sets
}

fn rng_of(seed: u64) -> ChaCha12Rng {
    ChaCha12Rng::seed_from_u64(seed)
}

/// Prints a line per case and the totals.
struct Totals {
    cases: usize,
    within: usize,
    counted: (usize, usize),
    slowest: f64,
}

impl Totals {
    fn add(&mut self, seed: u64, sets: &[String], answer: &WhatIf, compared: &Compared, note: &str) {
        let all = compared.counted.0 == compared.counted.1;
        self.cases += 1;
        self.within += usize::from(all);
        self.counted.0 += compared.counted.0;
        self.counted.1 += compared.counted.1;
        self.slowest = self.slowest.max(answer.seconds);
        println!(
            "seed {seed}: {}\n  {} of {} R(n) within, largest difference {:.2} standard errors ({:+.4}); surrogate error {:.4}, \
             outside {:.1} % ({:.1} % before); {:.2} s{note}",
            sets.join(", "),
            compared.counted.1,
            compared.counted.0,
            compared.worst.0,
            compared.worst.1,
            answer.surrogate_error,
            100.0 * answer.region.outside_after,
            100.0 * answer.region.outside_before,
            answer.seconds
        );
    }

    fn print(&self) {
        println!(
            "\nevery R(n) within the stated errors in {} of {} cases; {} of {} R(n) ({:.1} %); slowest answer {:.2} s",
            self.within,
            self.cases,
            self.counted.1,
            self.counted.0,
            100.0 * self.counted.1 as f64 / self.counted.0.max(1) as f64,
            self.slowest
        );
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::parse();
    let mut totals = Totals { cases: 0, within: 0, counted: (0, 0), slowest: 0.0 };
    if arguments.study == "functions" {
        for seed in arguments.seeds.0..=arguments.seeds.1 {
            of_functions(seed, arguments.shift, &mut totals)?;
        }
    } else {
        of_study(&arguments, &mut totals)?;
    }
    totals.print();
    Ok(())
}

/// What-ifs of a stored study against new studies.
fn of_study(arguments: &Arguments, totals: &mut Totals) -> Result<(), Box<dyn Error>> {
    let file = CampaignFile::look(Path::new(&arguments.study))?;
    let source = SceneSource::parse(&file.meta.scene_source, &arguments.study)?;
    let settings = Settings::from_stored(&file.meta.settings)?;
    let summary: StudySummary = file.document("summary")?.ok_or("the study is not finished")?;
    let mut outcomes = Vec::new();
    file.for_each_known(false, |StoredEvaluation { sample, outcome, .. }| {
        outcomes.push(StoredOutcome { sample, outcome: outcome.map(Observed::from_evaluation) });
    })?;
    let mut finer = Vec::new();
    file.for_each_known(true, |StoredEvaluation { level, sample, outcome, .. }| {
        finer.push((level, StoredOutcome { sample, outcome: outcome.map(Observed::from_evaluation) }));
    })?;
    if let Some(correction) = Correction::from_stored(source.nominal(), &outcomes, &finer) {
        outcomes = correction.correct_all(outcomes);
    }
    for seed in arguments.seeds.0..=arguments.seeds.1 {
        let sets = draw_change(source.nominal(), &mut rng_of(seed), arguments.shift);
        let changed = match changed_scene(&source, &sets) {
            Ok(changed) => changed,
            Err(faults) => {
                println!("seed {seed}: {}\n  no valid scene: {faults}", sets.join(", "));
                continue;
            }
        };
        let reduced = Settings { samples: summary.population.min(POPULATION), ..settings.clone() };
        let study = FinishedStudy {
            scene: source.nominal(),
            settings: &reduced,
            simulated: source.nominal(),
            outcomes: &outcomes,
            summary: Some(&summary),
        };
        let answer = ask(&study, changed.nominal())?;
        let started = Instant::now();
        let invalid = |faults: Faults| SimulationFailure::InvalidSample { faults: faults.to_string() };
        let of_study = settings.accuracy.setting.accuracy;
        let evaluate = |request: &Request| {
            let scene = changed.resolve_sample(&request.sample).map_err(invalid)?;
            simulate(&scene, &request.accuracy.unwrap_or(of_study), SimulateOptions::default())
        };
        let again = Settings { seed: settings.seed + 1000 + seed, ..settings.clone() };
        let mut evaluator = LocalEvaluator::new(arguments.threads, evaluate);
        let mut journal = InMemoryJournal::default();
        let new = run(changed.nominal(), &again, &mut evaluator, &mut journal, &mut Silent)?.summary;
        let compared = compare(&answer.after, |n, name| {
            (new.reliability[n].reliability[name], new.reliability[n].standard_error[name])
        });
        let note = format!(
            "; new study: {} evaluations, {:.0} s",
            new.evaluations.total,
            started.elapsed().as_secs_f64()
        );
        totals.add(seed, &sets, &answer, &compared, &note);
    }
    Ok(())
}

/// Two responses at the share t of the life [1], from values u of the variables `(d,)`; each has failed from 1 on.
type Response = fn(&[f64], f64) -> [f64; 2];

/// Names, numbers of variables (standard normals before the change) and responses.
const FUNCTIONS: [(&str, usize, Response); 5] = [
    ("linear", 3, |u, t| [0.4 + 0.5 * t + 0.15 * u[0] + 0.1 * t * u[1], 0.3 + 0.6 * t + 0.2 * u[2]]),
    ("product", 3, |u, t| {
        let wear = (0.3 * u[0]).exp() * t * (1.0 + 0.2 * u[1]);
        [0.9 * wear, 0.75 * wear * (1.0 + 0.1 * u[2]).powi(2)]
    }),
    ("quadratic", 4, |u, t| {
        let bowl = u.iter().map(|u| u * u).sum::<f64>();
        [0.2 + 0.5 * t + 0.06 * bowl, 0.3 + 0.5 * t + 0.12 * u[0] * u[1] + 0.05 * u[3]]
    }),
    ("waves", 2, |u, t| {
        let wave = (1.2 * u[0]).sin() * (0.9 * u[1]).cos();
        [0.4 + 0.4 * t + 0.2 * wave + 0.1 * u[0], 0.2 + 0.6 * t + 0.15 * u[1]]
    }),
    ("kink", 3, |u, t| {
        let hinge = (u[0] - 2.0).max(0.0);
        [0.3 + 0.5 * t + 0.08 * u[0] + 0.5 * hinge, 0.3 + 0.5 * t + 0.1 * u[1] + 0.1 * u[2] * u[0]]
    }),
];

/// A what-if of one made-up response against counting over a large population.
fn of_functions(seed: u64, shift: f64, totals: &mut Totals) -> Result<(), Box<dyn Error>> {
    let (name, d, response) = FUNCTIONS[(seed % FUNCTIONS.len() as u64) as usize];
    let variables: Vec<String> = (0..d)
        .map(|k| format!("{{ name = \"u{k}\", distribution = \"normal\", mean = 0, std = 1 }}"))
        .collect();
    let text = format!(
        "scene = {{ name = \"{name}\" }}\nsimulator = {{ program = [\"closure\"] }}\n\
         life = {{ cycles = 1000, checkpoint_every = 100 }}\noutputs = [{{ name = \"a\" }}, {{ name = \"b\" }}]\n\
         limit_states = [{{ name = \"first\", output = \"a\", threshold = 1 }}, {{ name = \"second\", output = \"b\", threshold = 1 }}]\n\
         variables = [{}]",
        variables.join(", ")
    );
    let source = SceneSource::parse(&text, name)?;
    let scene = source.nominal();
    let cycles = scene.life.checkpoints();
    let histories = |x: &[f64]| -> Vec<Vec<f64>> {
        let at: Vec<[f64; 2]> = (1..=10).map(|k| response(x, f64::from(k) / 10.0)).collect();
        (0..2).map(|o| at.iter().map(|both| both[o]).collect()).collect()
    };
    let settings = Settings { samples: 20_000, seed, ..Settings::from(scene) };
    let evaluate =
        |request: &Request| Ok(Evaluation::from_histories(cycles.clone(), histories(&request.sample)));
    let mut journal = InMemoryJournal::default();
    let summary =
        run(scene, &settings, &mut LocalEvaluator::new(1, evaluate), &mut journal, &mut Silent)?.summary;
    let stored = |(sample, finished): &(Vec<f64>, coordinator::farm::evaluate::Finished)| StoredOutcome {
        sample: sample.clone(),
        outcome: finished.outcome.clone().map(Observed::from_evaluation),
    };
    let outcomes: Vec<StoredOutcome> = journal.outcomes().values().map(stored).collect();
    let sets = draw_change(scene, &mut rng_of(seed), shift);
    let changed = changed_scene(&source, &sets)?;
    let study = FinishedStudy {
        scene,
        simulated: scene,
        settings: &settings,
        outcomes: &outcomes,
        summary: Some(&summary),
    };
    let answer = ask(&study, changed.nominal())?;
    let truth = count(changed.nominal(), &histories, seed);
    let compared = compare(&answer.after, |n, curve| {
        let c = answer.after.limit_states.iter().position(|name| name == curve).unwrap_or(2);
        let r = truth[c][n];
        (r, (r * (1.0 - r) / COUNTED as f64).sqrt())
    });
    totals.add(seed, &sets, &answer, &compared, &format!("; {name}, {} evaluations", outcomes.len()));
    Ok(())
}

/// Points of the population over which the truth is counted.
const COUNTED: usize = 400_000;

/// R of every limit state and of the system `(3)(m,)` by counting, over points of another seed.
fn count(scene: &Scene, histories: &dyn Fn(&[f64]) -> Vec<Vec<f64>>, seed: u64) -> Vec<Vec<f64>> {
    let population = Population::draw(InputModel::from_scene(scene), COUNTED, seed + 5000);
    let mut alive = vec![vec![0.0; 10]; 3];
    for j in 0..COUNTED {
        let found = histories(&population.physical(j));
        let first = |o: usize| {
            let limit = scene.limit_states[o].threshold;
            found[o].iter().position(|y| *y >= limit).unwrap_or(10)
        };
        let all = [first(0), first(1), first(0).min(first(1))];
        for (curve, first) in alive.iter_mut().zip(all) {
            curve[..first].iter_mut().for_each(|r| *r += 1.0 / COUNTED as f64);
        }
    }
    alive
}
