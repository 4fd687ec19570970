//! Coverage of the lives that `coordinator learn` states from a fleet, and the width of their intervals beside those of a Weibull fit.
//!
//! A fleet has twenty units of the direct study, whose population may differ from that of the study. Each is observed up to a life of its own,
//! drawn so that three fifths of the units are still running then.

use super::{Study, life};
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
    /// Number of intervals that hold the life.
    held: usize,
    /// The same of the Weibull fit's likelihood-ratio intervals.
    weibull_held: usize,
    /// Widths over those of the Weibull fit, where it has one [1].
    widths: Vec<f64>,
}

impl Level {
    fn compare(&mut self, truth: f64, lives: &[ConfidentLife], weibull: Option<&WeibullFit>) {
        let is_own = |life: &&ConfidentLife| (life.reliability - self.reliability).abs() < 1e-9;
        let Some(ConfidentLife { interval: [lower, upper], .. }) = lives.iter().find(is_own) else { return };
        self.held +=
            usize::from(lower.is_some_and(|low| low <= truth) && upper.is_none_or(|high| truth <= high));
        let bounds = weibull.map(|fit| fit.life(self.reliability, CONFIDENCE).likelihood_ratio);
        let (Some([Some(low), Some(high)]), Some(lower), Some(upper)) = (bounds, lower, upper) else {
            return;
        };
        self.weibull_held += usize::from(low <= truth && truth <= high);
        self.widths.push((upper - lower) / (high - low));
    }
}

/// Prints how often the intervals contain the lives of the direct study's population.
pub fn run(study: &Study, direct: &Study, fleets: usize, unknown: &[String]) -> Result<(), Box<dyn Error>> {
    let (source, settings, summary, stored) = study;
    let scene = source.nominal();
    let learned = learn_from_results(scene, scene, settings, stored)?;
    // The first evaluation is the nominal point.
    let units = direct.3.iter().skip(1).filter_map(|s| s.outcome.as_ref().ok());
    let mut lives: Vec<f64> = units.map(|unit| life(scene, unit)).collect();
    lives.sort_unstable_by(f64::total_cmp);
    let quantile = |p: f64| lives[((p * lives.len() as f64) as usize).min(lives.len() - 1)];
    let truths = LEVELS.map(|level| quantile(1.0 - level));
    println!("{} lives; at R = {LEVELS:?}: {truths:.0?} cycles", lives.len());
    let folder = std::env::temp_dir().join(format!("fleets-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let file = folder.join("fleet.csv");
    let mut levels =
        LEVELS.map(|reliability| Level { reliability, held: 0, weibull_held: 0, widths: vec![] });
    let mut rng = ChaCha12Rng::seed_from_u64(super::SEED);
    let error = NOTED * quantile(0.5);
    let (mut without, begun) = (0, Instant::now());
    for _ in 0..fleets {
        let mut text: String = unknown.iter().map(|name| format!("population,,{name},,\n")).collect();
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
        for (seen, truth) in levels.iter_mut().zip(truths) {
            seen.compare(truth, &found, weibull.as_ref());
        }
    }
    std::fs::remove_dir_all(&folder)?;
    let answers = fleets - without;
    println!(
        "{answers} fleets of {UNITS} units in {:.0} s, {without} without an answer",
        begun.elapsed().as_secs_f64()
    );
    for Level { reliability, held, weibull_held, mut widths } in levels {
        widths.sort_unstable_by(f64::total_cmp);
        println!(
            "R = {reliability}: the {:.0} % interval holds the life of {:.1} % of the fleets, Weibull's that of {:.1} % of {}; width over \
             Weibull's: median {:.2}",
            100.0 * CONFIDENCE,
            100.0 * held as f64 / answers as f64,
            100.0 * weibull_held as f64 / widths.len() as f64,
            widths.len(),
            widths.get(widths.len() / 2).copied().unwrap_or(f64::NAN),
        );
    }
    Ok(())
}
