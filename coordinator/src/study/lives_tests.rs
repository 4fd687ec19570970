//! Lives of whole studies against closed forms: the wear rate is lognormal, the response grows by a known law, and the exact
//! life at each level lies within the stated 95 % interval, or the stated bound, in 95 of 100 studies.

use super::{Method, Settings, StudyResult, run};
use crate::farm::evaluate::{Request, local::LocalEvaluator};
use crate::results::journal::InMemoryJournal;
use crate::results::life_summary::LifeRow;
use crate::results::progress::Silent;
use common::outputs::Evaluation;
use common::random::standard_normal_quantile;
use common::scene::{Scene, SceneSource};

/// Median life [cycles].
const MEDIAN: f64 = 1000.0;
/// Standard deviation of the logarithm of the wear rate [1].
const SPREAD: f64 = 0.3;

/// Growth of the response, 0 at the start and 1 at the median life.
struct Law {
    name: &'static str,
    growth: fn(f64) -> f64,
}

const LAWS: [Law; 5] = [
    Law { name: "linear", growth: |t| t },
    Law { name: "root", growth: f64::sqrt },
    Law { name: "square", growth: |t| t * t },
    Law { name: "run-in", growth: |t| 0.3 * (1.0 - (-t / 0.1).exp()) / (1.0 - (-10_f64).exp()) + 0.7 * t },
    Law { name: "late", growth: |t| 0.3 * t + 0.7 * (t - 0.6).max(0.0) / 0.4 },
];

impl Law {
    /// Life at which the response of this wear rate reaches 1 [cycles].
    fn life(&self, rate: f64) -> f64 {
        let (mut low, mut high) = (0.0, 4.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if rate * (self.growth)(middle) >= 1.0 { high = middle } else { low = middle }
        }
        MEDIAN * high
    }
}

/// A scene with a checkpoint at regular intervals and one lognormal wear rate of median 1.
fn scene(every: u32) -> Scene {
    let mean = (0.5 * SPREAD * SPREAD).exp();
    let std = mean * (SPREAD * SPREAD).exp_m1().sqrt();
    let text = format!(
        "scene = {{ name = \"s\" }}\nsimulator = {{ program = [\"s\"] }}\nlife = {{ cycles = 2000, checkpoint_every = {every} }}\n\
         outputs = [{{ name = \"wear\" }}]\nlimit_states = [{{ name = \"worn\", output = \"wear\", threshold = 1 }}]\n\
         variables = [{{ name = \"rate\", mean = {mean}, std = {std}, distribution = \"lognormal\" }}]"
    );
    SceneSource::parse(&text, "s").unwrap().nominal().clone()
}

/// A study of this law; `with_start` tells whether the value at the start of life is given.
fn study(law: &Law, every: u32, with_start: bool, settings: Settings) -> StudyResult {
    let scene = scene(every);
    let checkpoints = scene.life.checkpoints();
    let simulate = |request: &Request| {
        let value = |n: &u32| request.sample[0] * (law.growth)(f64::from(*n) / MEDIAN);
        let history = checkpoints.iter().map(value).collect();
        let mut evaluation = Evaluation::from_histories(checkpoints.clone(), vec![history]);
        evaluation.start = vec![with_start.then_some(0.0)];
        Ok(evaluation)
    };
    let mut evaluator = LocalEvaluator::new(1, simulate);
    run(&scene, &settings, &mut evaluator, &mut InMemoryJournal::default(), &mut Silent).unwrap()
}

/// How often the exact life was within the limits, was bounded instead of stated, and was outside.
#[derive(Debug, Default)]
struct Tally {
    numbers: usize,
    bounds: usize,
    outside: usize,
    /// Sum of the relative half-widths of the intervals of stated lives.
    widths: f64,
}

impl Tally {
    fn add(&mut self, row: &LifeRow, exact: f64) {
        let (lower, upper) = (row.interval.lower, row.interval.upper.unwrap_or(f64::INFINITY));
        match row.cycles {
            Some(life) => {
                self.numbers += 1;
                self.widths += 0.5 * (upper - lower) / life;
            }
            None => self.bounds += 1,
        }
        self.outside += usize::from(!(lower..=upper).contains(&exact));
    }
}

/// Studies of every law with these distances of the checkpoints; the tally of each law, distance and level is checked.
fn check(distances: &[u32], seeds: u64, settings: impl Fn(&Scene, u64) -> Settings) {
    let mut all = Tally::default();
    for law in &LAWS {
        for every in distances {
            let mut tallies: [Tally; 3] = Default::default();
            for seed in 0..seeds {
                let result = study(law, *every, true, settings(&scene(*every), seed));
                let rows = result.summary.lives.iter().filter(|row| row.limit_state == "total");
                for (row, tally) in rows.zip(&mut tallies) {
                    // R = P(rate < 1 / growth): a life at R belongs to the rate at the quantile R.
                    let rate = (SPREAD * standard_normal_quantile(row.reliability)).exp();
                    tally.add(row, law.life(rate));
                }
            }
            for (tally, level) in tallies.iter().zip(super::LEVELS) {
                let width = tally.widths / tally.numbers.max(1) as f64;
                eprintln!(
                    "{:8} every {every:4} R = {level:4}: {:3} lives (+- {:.1} %), {:3} bounds, {} outside",
                    law.name,
                    tally.numbers,
                    100.0 * width,
                    tally.bounds,
                    tally.outside
                );
                // Eleven of 100 is the 99 % limit of a binomial share of 5 %.
                assert!(
                    tally.outside * 100 <= 11 * seeds as usize + 100,
                    "{} {every} {level}: {tally:?}",
                    law.name
                );
                all.numbers += tally.numbers;
                all.bounds += tally.bounds;
                all.outside += tally.outside;
            }
        }
    }
    eprintln!("{} lives, {} bounds, {} outside", all.numbers, all.bounds, all.outside);
}

#[test]
fn issue_lives_between_checkpoints_lie_in_their_intervals() {
    // Checkpoints every 1/50 and 1/2 of the median life.
    check(&[20, 500], 20, |scene, seed| Settings {
        method: Method::MonteCarlo,
        samples: 400,
        seed,
        ..Settings::from(scene)
    });
}

#[test]
fn issue_lives_by_surrogates_lie_in_their_intervals() {
    check(&[500], 3, |scene, seed| Settings {
        samples: 1000,
        initial: 8,
        batch: 2,
        max_evaluations: 20,
        seed,
        ..Settings::from(scene)
    });
}

#[test]
fn issue_a_life_before_the_first_checkpoint_is_not_invented() {
    let settings = |every| Settings {
        method: Method::MonteCarlo,
        samples: 300,
        seed: 1,
        ..Settings::from(&scene(every))
    };
    let summary = study(&LAWS[0], 2000, false, settings(2000)).summary;
    assert!(summary.lives.is_empty() && summary.is_static());
    // The fall lies between the start and the first checkpoint, and the start is not known.
    let fast = Law { name: "fast", growth: |t| 10.0 * t };
    let summary = study(&fast, 500, false, settings(500)).summary;
    let row = &summary.lives[5];
    assert_eq!((row.limit_state.as_str(), row.reliability, row.cycles), ("total", 0.5, None));
    assert_eq!((row.interval.lower, row.interval.upper), (0.0, Some(500.0)));
    let fall = summary.unresolved_fall.unwrap();
    assert_eq!((fall.from, fall.to, fall.checkpoint_every), (0, 500, 50));
    // With the start known it is interpolated: 100 cycles at the median.
    let row = &study(&fast, 500, true, settings(500)).summary.lives[5];
    assert!((row.cycles.unwrap() / 100.0 - 1.0).abs() < 0.05, "{row:?}");
}
