//! Coverage of the lives that `coordinator learn` states from a fleet, and the width of their intervals beside those of a Weibull fit and,
//! where the posterior is known, the exact ones.
//!
//! A fleet has twenty units of a population that may differ from that of the study. Each is observed up to a life of its own,
//! drawn so that three fifths of the units are still running then.

use super::Study;
use coordinator::analyses::learn::{LearnSettings, learn};
use coordinator::analyses::update::read_fleet;
use coordinator::statistics::life_data::{UnitLife, WeibullFit};
use coordinator::statistics::updating::ConfidentLife;
use coordinator::study::{LifeModel, learn_from_results};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, StandardNormal};
use std::error::Error;
use std::fmt::Write as _;
use std::time::Instant;

/// Number of units of a fleet.
const UNITS: usize = 20;
/// Expected share of the units that are still running [1].
const RUNNING: f64 = 0.6;
/// Standard deviation of the life at which a failure is noted, as a share of the median life [1].
const NOTED: f64 = 0.005;
/// Confidence of the intervals [1].
const CONFIDENCE: f64 = 0.9;
/// Levels of R whose lives are compared [1].
const LEVELS: [f64; 2] = [0.99, 0.9];

/// What the fleets have shown of the life at a level of R.
struct Level {
    reliability: f64,
    /// Number of intervals that hold the life, that end before it, and that begin after it.
    held: usize,
    before: usize,
    after: usize,
    /// The same of the Weibull fit's likelihood-ratio intervals.
    weibull_held: usize,
    /// Widths over those of the Weibull fit, where it has one [1].
    widths: Vec<f64>,
    /// Widths over the exact ones, and the number of these that hold the life.
    over_exact: Vec<f64>,
    exact_held: usize,
}

impl Level {
    fn compare(
        &mut self,
        truth: f64,
        lives: &[ConfidentLife],
        weibull: Option<&WeibullFit>,
        exact: Option<[f64; 2]>,
    ) {
        let is_own = |life: &&ConfidentLife| (life.reliability - self.reliability).abs() < 1e-9;
        let Some(ConfidentLife { interval: [lower, upper], .. }) = lives.iter().find(is_own) else { return };
        let (ends, begins) = (upper.is_some_and(|high| high < truth), lower.is_none_or(|low| low > truth));
        self.before += usize::from(ends);
        self.after += usize::from(begins);
        self.held += usize::from(!ends && !begins);
        if let (Some([low, high]), Some(lower), Some(upper)) = (exact, lower, upper) {
            self.exact_held += usize::from(low <= truth && truth <= high);
            self.over_exact.push((upper - lower) / (high - low));
        }
        let bounds = weibull.map(|fit| fit.life(self.reliability, CONFIDENCE).likelihood_ratio);
        let (Some([Some(low), Some(high)]), Some(lower), Some(upper)) = (bounds, lower, upper) else {
            return;
        };
        self.weibull_held += usize::from(low <= truth && truth <= high);
        self.widths.push((upper - lower) / (high - low));
    }
}

/// Intervals of the lives at the levels with the confidence given, from the lives of units and the error of a failure, in closed form.
pub type ExactLives<'a> = &'a dyn Fn(&[UnitLife], f64, f64, &[f64]) -> Vec<[f64; 2]>;

/// Prints how often the intervals contain the lives of fleets' populations, each of which is a number of lives, ascending; `unknown` are
/// the rows of what is not known, without their first two columns.
pub fn run(
    study: &Study,
    mut population: impl FnMut(&mut ChaCha12Rng) -> Vec<f64>,
    fleets: usize,
    unknown: &[String],
    exact: Option<ExactLives<'_>>,
) -> Result<(), Box<dyn Error>> {
    let (source, settings, summary, stored) = study;
    let scene = source.nominal();
    let learned = learn_from_results(scene, scene, settings, stored)?;
    let folder = std::env::temp_dir().join(format!("fleets-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let file = folder.join("fleet.csv");
    let mut levels = LEVELS.map(|reliability| Level {
        reliability,
        held: 0,
        before: 0,
        after: 0,
        weibull_held: 0,
        widths: vec![],
        over_exact: vec![],
        exact_held: 0,
    });
    let mut rng = ChaCha12Rng::seed_from_u64(super::SEED);
    let (mut without, begun) = (0, Instant::now());
    for fleet in 0..fleets {
        let lives = population(&mut rng);
        let quantile = |p: f64| lives[((p * lives.len() as f64) as usize).min(lives.len() - 1)];
        let truths = LEVELS.map(|level| quantile(1.0 - level));
        let error = NOTED * quantile(0.5);
        if fleet == 0 {
            println!("{} lives of the first population; at R = {LEVELS:?}: {truths:.0?} cycles", lives.len());
        }
        let mut text: String = unknown.iter().map(|row| format!("population,,{row}\n")).collect();
        let mut data = Vec::new();
        for unit in 0..UNITS {
            let own = lives[rng.random_range(0..lives.len())];
            // With a uniform share in 0 to 2 (1 - RUNNING) of all lives, RUNNING of the units live longer.
            let until = quantile(rng.random::<f64>() * 2.0 * (1.0 - RUNNING));
            if own <= until {
                let noise: f64 = StandardNormal.sample(&mut rng);
                let noted = own + error * noise;
                writeln!(text, "U{unit},{noted:.1},failed,,{error:.1}")?;
                data.push(UnitLife::Failed(noted));
            } else {
                writeln!(text, "U{unit},{until:.1},survived")?;
                data.push(UnitLife::Running(until));
            }
        }
        std::fs::write(&file, &text)?;
        let model = LifeModel::new(scene, &learned);
        let fleet = read_fleet(&file, source, &model, Some(&[]))?;
        let own = LearnSettings { ranks: false, confidence: CONFIDENCE, ..LearnSettings::new(settings.seed) };
        let found = match learn(scene, summary, model, &fleet, &[], &[], &own) {
            Ok(found) => found.confident.lives,
            Err(error) => {
                println!("no answer: {error}");
                without += 1;
                continue;
            }
        };
        let weibull = WeibullFit::new(&data).ok();
        let intervals = exact.map(|exact| exact(&data, error, CONFIDENCE, &LEVELS));
        for (k, (seen, truth)) in levels.iter_mut().zip(truths).enumerate() {
            seen.compare(truth, &found, weibull.as_ref(), intervals.as_ref().map(|all| all[k]));
        }
    }
    std::fs::remove_dir_all(&folder)?;
    let answers = fleets - without;
    println!(
        "{answers} fleets of {UNITS} units in {:.0} s, {without} without an answer",
        begun.elapsed().as_secs_f64()
    );
    for Level { reliability, held, before, after, weibull_held, mut widths, mut over_exact, exact_held } in
        levels
    {
        widths.sort_unstable_by(f64::total_cmp);
        over_exact.sort_unstable_by(f64::total_cmp);
        println!(
            "R = {reliability}: the {:.0} % interval holds the life of {:.1} % of the fleets, ends before that of {:.1} % and begins \
             after that of {:.1} %; Weibull's holds that of {:.1} % of {}; width over Weibull's: median {:.2}",
            100.0 * CONFIDENCE,
            100.0 * held as f64 / answers as f64,
            100.0 * before as f64 / answers as f64,
            100.0 * after as f64 / answers as f64,
            100.0 * weibull_held as f64 / widths.len() as f64,
            widths.len(),
            widths.get(widths.len() / 2).copied().unwrap_or(f64::NAN),
        );
        if let Some(median) = over_exact.get(over_exact.len() / 2) {
            let held = 100.0 * exact_held as f64 / over_exact.len() as f64;
            println!(
                "    the exact interval holds that of {held:.1} %; width over the exact one: median {median:.3}"
            );
        }
    }
    Ok(())
}
