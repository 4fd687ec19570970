//! Studies whose simulator offers levels of accuracy, on analytic responses: how often the interval of R(n), everything included, holds the
//! exact value, and what the study costs beside one that simulates the finest level only.
//!
//! ```sh
//! cargo run --release -p coordinator --example pairs_of_levels -- 24 1
//! ```
//! The arguments are the number of problems and the seed of their family. The first three are published; of the others every second one has
//! levels that agree, with errors that fall to a quarter from level to level, and every second one levels that do not: an error with a
//! length scale of its own at every level, or one that jumps from point to point. An evaluation costs four times one of the level before.
//!
//! # Source
//! Forrester, Sobester, Keane (2007); borehole: Morris, Mitchell, Ylvisaker (1993), its lower fidelity Xiong, Qian, Wu (2013); the bimodal
//! limit state and its lower fidelities: Chaudhuri, Marques, Willcox (2021), mfEGRA.

#[path = "random_problems/draw.rs"]
#[allow(dead_code)] // The families of `random_problems` draw more.
mod draw;
#[path = "random_problems/response.rs"]
#[allow(dead_code)]
mod response;

use common::outputs::Evaluation;
use common::scene::{Scene, SceneSource};
use coordinator::farm::evaluate::{Request, local::LocalEvaluator};
use coordinator::results::{journal::InMemoryJournal, progress::Silent, summary::StudySummary};
use coordinator::statistics::design::{InputModel, Population};
use coordinator::study::{FinerLevels, Settings, run};
use draw::{direction, phase, scaled};
use rand::RngExt;
use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use response::{Response, Term, hash_to_normal};
use std::error::Error;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Cost of an evaluation over that of one of the level before [1].
const COST: f64 = 4.0;
/// Checkpoints, and the rise of the response from one to the next in standard deviations [1].
const CHECKPOINTS: u32 = 5;
const RISE: f64 = 0.35;
/// Points of the population that gives limits and exact reliabilities.
const POINTS: usize = 1_000_000;
/// Values of R beyond which a checkpoint is not compared [1].
const COMPARED: (f64, f64) = (0.01, 0.99);

/// Response at a level, of values of the variables `(d,)`.
type AtLevel = Box<dyn Fn(u8, &[f64]) -> f64 + Sync>;

/// A problem with levels.
struct Problem {
    name: String,
    /// Lines of the variables in the scene.
    variables: Vec<String>,
    /// Number of levels; the finest is 255 for the exact response.
    levels: u8,
    response: AtLevel,
    /// True if the levels converge, or differ by little.
    agrees: bool,
}

/// The level that stands for the exact response.
const EXACT: u8 = u8::MAX;

fn normal(name: &str, mean: f64, std: f64) -> String {
    format!("{{ name = \"{name}\", mean = {mean}, std = {std} }}")
}

fn uniform(name: &str, lower: f64, upper: f64) -> String {
    format!("{{ name = \"{name}\", distribution = \"uniform\", lower = {lower}, upper = {upper} }}")
}

fn forrester() -> Problem {
    let response = |level: u8, x: &[f64]| {
        let exact = (6.0 * x[0] - 2.0).powi(2) * (12.0 * x[0] - 4.0).sin();
        if level == 0 { 0.5 * exact + 10.0 * (x[0] - 0.5) - 5.0 } else { exact }
    };
    let variables = vec![uniform("x", 0.0, 1.0)];
    Problem { name: "Forrester".into(), variables, levels: 2, response: Box::new(response), agrees: false }
}

fn borehole() -> Problem {
    let response = |level: u8, x: &[f64]| {
        let [rw, r, tu, hu, tl, hl, l, kw] = *x else { return f64::NAN };
        let log = (r / rw).ln();
        let (first, one) = if level == 0 { (5.0, 1.5) } else { (TAU, 1.0) };
        first * tu * (hu - hl) / (log * (one + tu / tl) + 2.0 * l * tu / (rw * rw * kw))
    };
    let variables = vec![
        normal("rw", 0.10, 0.016_181_2),
        "{ name = \"r\", distribution = \"lognormal\", mean = 3698.3, std = 4892.4 }".to_owned(),
        uniform("tu", 63_070.0, 115_600.0),
        uniform("hu", 990.0, 1110.0),
        uniform("tl", 63.1, 116.0),
        uniform("hl", 700.0, 820.0),
        uniform("l", 1120.0, 1680.0),
        uniform("kw", 9855.0, 12_045.0),
    ];
    Problem { name: "borehole".into(), variables, levels: 2, response: Box::new(response), agrees: true }
}

fn bimodal() -> Problem {
    let response = |level: u8, x: &[f64]| {
        let exact = (x[0].powi(2) + 4.0) * (x[1] - 1.0) / 20.0 - (2.5 * x[0]).sin() - 2.0;
        let [a, b] = [x[0], x[1]];
        exact
            + match level {
                0 => 3.0 * (5.0 * a / 11.0 + 5.0 * b / 11.0 + 35.0 / 11.0).sin(),
                1 => (5.0 * a / 22.0 + 5.0 * b / 44.0 + 1.25).sin(),
                _ => 0.0,
            }
    };
    let variables = vec![normal("x1", 1.5, 1.0), normal("x2", 2.5, 1.0)];
    Problem { name: "bimodal".into(), variables, levels: 3, response: Box::new(response), agrees: false }
}

/// A plane with waves of the given wave number [1] over d standard normal variables.
fn waves(rng: &mut ChaCha12Rng, d: usize, slope: f64, number: f64) -> Response {
    let mut terms = vec![Term::Plane(scaled(&direction(rng, d), slope))];
    for _ in 0..3 {
        let frequency = scaled(&direction(rng, d), number);
        terms.push(Term::Wave { amplitude: 0.25, frequency, phase: phase(rng) });
    }
    Response::Sum(terms)
}

fn random(seed: u64, index: u64) -> Problem {
    let mut rng = ChaCha12Rng::seed_from_u64(seed);
    rng.set_stream(index);
    let d = rng.random_range(1..=6);
    let exact = waves(&mut rng, d, 1.0, 1.0);
    let agrees = index.is_multiple_of(2);
    let jumps = rng.random_bool(0.5);
    // Error of the coarsest level over the spread of the response.
    let size = rng.random_range(0.05..0.5);
    let errors: Vec<Response> = (0..3)
        .map(|_| {
            let number = if agrees { 0.5 } else { rng.random_range(1.0..3.0) };
            waves(&mut rng, d, 0.3, number)
        })
        .collect();
    let bias = rng.random_range(-1.0..1.0);
    let response = move |level: u8, x: &[f64]| {
        let error = match level {
            EXACT => 0.0,
            // The same function at every level, as of a discretisation.
            level if agrees => size * (bias + errors[0].value(x)) * 0.25_f64.powi(i32::from(level)),
            level if jumps => {
                size * (bias + hash_to_normal(x, level.into())) * 0.5_f64.powi(i32::from(level))
            }
            level => size * (bias + errors[usize::from(level)].value(x)) * 0.5_f64.powi(i32::from(level)),
        };
        exact.value(x) + error
    };
    let kind = match (agrees, jumps) {
        (true, _) => "agree",
        (false, true) => "jump",
        (false, false) => "differ",
    };
    Problem {
        name: format!("{index} {kind} d={d}"),
        variables: (0..d).map(|k| normal(&format!("x{k}"), 0.0, 1.0)).collect(),
        levels: 3,
        response: Box::new(response),
        agrees,
    }
}

impl Problem {
    /// The level whose response is the exact one, or that stands for it.
    fn exact(&self) -> u8 {
        if self.levels == 3 && self.name != "bimodal" { EXACT } else { self.levels - 1 }
    }

    fn scene(&self, limit: f64) -> Result<SceneSource, Box<dyn Error>> {
        let names: Vec<String> = (0..self.levels).map(|k| format!("\"level {k}\"")).collect();
        let mut text = format!(
            "scene = {{ name = \"levels\" }}\n\
             simulator = {{ program = [\"closure\"], levels = [{}], finest_is_exact = {} }}\n\
             life = {{ cycles = {}, checkpoint_every = 100 }}\n\
             outputs = [{{ name = \"y\", unit = \"\" }}]\n\
             limit_states = [{{ name = \"limit\", output = \"y\", threshold = {limit} }}]\n",
            names.join(", "),
            self.exact() != EXACT,
            100 * CHECKPOINTS,
        );
        write!(text, "variables = [{}]", self.variables.join(", "))?;
        Ok(SceneSource::parse(&text, "levels")?)
    }

    /// Limit, rise from checkpoint to checkpoint, and exact R `(m,)` [1].
    fn exact_reliability(&self) -> Result<(f64, f64, Vec<f64>), Box<dyn Error>> {
        let source = self.scene(1.0)?;
        let population = Population::draw(InputModel::from_scene(source.nominal()), POINTS, 1);
        let at = |j: usize| (self.response)(self.exact(), &population.physical(j));
        let mut values: Vec<f64> = (0..POINTS).map(at).collect();
        values.sort_unstable_by(f64::total_cmp);
        let mean = values.iter().sum::<f64>() / POINTS as f64;
        let rise = RISE * (values.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / POINTS as f64).sqrt();
        let limit = values[POINTS / 2];
        let safe = |n: u32| {
            let limit = limit + rise * f64::from(CHECKPOINTS - n);
            values.partition_point(|y| *y < limit) as f64 / POINTS as f64
        };
        Ok((limit, rise, (1..=CHECKPOINTS).map(safe).collect()))
    }

    /// A study; `at` is the level in the place of each level.
    fn study(
        &self,
        scene: &Scene,
        settings: &Settings,
        rise: f64,
        at: impl Fn(u8) -> u8 + Sync,
    ) -> Result<StudySummary, Box<dyn Error>> {
        let cycles: Vec<u32> = (1..=CHECKPOINTS).map(|n| 100 * n).collect();
        let evaluate = |request: &Request| {
            let last = (self.response)(at(request.level), &request.sample);
            let value = |n: u32| last - rise * f64::from(CHECKPOINTS - n);
            Ok(Evaluation::from_histories(cycles.clone(), vec![(1..=CHECKPOINTS).map(value).collect()]))
        };
        let mut evaluator = LocalEvaluator::new(2, evaluate);
        let result = run(scene, settings, &mut evaluator, &mut InMemoryJournal::default(), &mut Silent)?;
        Ok(result.summary)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<u64> = std::env::args().skip(1).map(|text| text.parse()).collect::<Result<_, _>>()?;
    let [count, seed] = arguments[..] else { return Err("expected a number of problems and a seed".into()) };
    let mut problems = vec![forrester(), borehole(), bimodal()];
    problems.extend((0..count.saturating_sub(3)).map(|index| random(seed, index)));
    println!(
        "{:<16} {:>9} {:>7} {:>8} {:>8} {:>9} {:>6} {:>8}",
        "problem", "evaluated", "finer", "cost", "single", "held", "worst", "widest"
    );
    let mut all = [(0, 0, 0.0_f64, vec![]), (0, 0, 0.0_f64, vec![])];
    for problem in &problems {
        let (limit, rise, exact) = problem.exact_reliability()?;
        let source = problem.scene(limit)?;
        let scene = source.nominal();
        let settings = Settings { seed, ..Settings::from(scene) };
        let found = problem.study(scene, &settings, rise, |level| level)?;
        let alone = Settings { levels: FinerLevels::None, ..settings };
        let single = problem.study(scene, &alone, rise, |_| problem.levels - 1)?;
        let levels = found.levels.as_ref();
        let finer = levels.map_or([0; 2], |levels| [levels.pairs[0], levels.pairs[1]]);
        let working = found.evaluations.total - finer[0] - finer[1];
        let cost = working as f64 + COST * (finer[0] as f64 + COST * finer[1] as f64);
        let of_single = single.evaluations.total as f64 * COST.powi(i32::from(problem.levels) - 1);
        let (mut compared, mut held, mut worst, mut widest) = (0, 0, 0.0_f64, 0.0_f64);
        for (row, exact) in found.reliability.iter().zip(&exact) {
            let Some(interval) =
                row.interval_of("total").filter(|_| (COMPARED.0..COMPARED.1).contains(exact))
            else {
                continue;
            };
            let half = 0.5 * (interval.upper - interval.lower);
            let off = (row.reliability["total"] - exact).abs() / half;
            compared += 1;
            held += usize::from(interval.lower <= *exact && *exact <= interval.upper);
            (worst, widest) = (worst.max(off), widest.max(half));
        }
        println!(
            "{:<16} {working:>9} {:>7} {cost:>8.0} {of_single:>8.0} {:>9} {worst:>6.2} {widest:>8.4}",
            problem.name,
            format!("{}+{}", finer[0], finer[1]),
            format!("{held} of {compared}"),
        );
        let kind = &mut all[usize::from(problem.agrees)];
        (kind.0, kind.1, kind.2) = (kind.0 + held, kind.1 + compared, kind.2.max(worst));
        kind.3.push(cost / of_single);
    }
    for (name, (held, compared, worst, mut costs)) in ["differ", "agree"].into_iter().zip(all) {
        costs.sort_unstable_by(f64::total_cmp);
        println!(
            "levels that {name}: {held} of {compared} intervals hold ({:.1} %), worst {worst:.2} half widths; cost over that of the finest \
             level alone: median {:.2}, largest {:.2}",
            100.0 * f64::from(held as u32) / f64::from(compared as u32),
            costs[costs.len() / 2],
            costs[costs.len() - 1],
        );
    }
    Ok(())
}
