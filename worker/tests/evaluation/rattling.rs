//! The slider-crank with a clearance of half a millimetre: no cycle repeats the one before.

use crate::scenes::{evaluate as run, every_joint, scene};
use common::accuracy::{Accuracy, Tier};
use common::outputs::Evaluation;

#[test]
fn issue_the_stated_wear_error_of_a_rattling_mechanism_exceeded_the_wear() {
    const STARTS: u32 = 10;
    // With single cycles, each probed by three others, it took these steps and stated 200 %.
    const STEPS_BEFORE: f64 = 30_162.0;
    // The motion is chaotic, and error and steps of one start are a matter of luck: their means over ten starts count.
    let (mut error, mut steps) = (0.0, 0.0);
    for start in 0..STARTS {
        let mut scene = scene("slider-crank", &[]);
        every_joint(&mut scene, |clearance| clearance.bushing_radius += 5e-8 * f64::from(start));
        let evaluation = run(&scene, &Accuracy::draft());
        let relative = evaluation.errors[0].iter().zip(&evaluation.histories[0]).map(|(e, h)| e / h);
        error += relative.fold(0.0, f64::max) / f64::from(STARTS);
        steps += evaluation.diagnostics.steps as f64 / f64::from(STARTS);
    }
    println!("{:.1} % stated at most, {steps:.0} steps", 100.0 * error);
    assert!(error < 0.12, "{error}");
    // Steps of one start scatter by 5 %, their mean over ten by 2 %.
    assert!(steps < 2.1 * STEPS_BEFORE, "{steps} steps");
}

#[test]
fn what_repeats_is_measured_in_single_cycles() {
    let mut scene = scene("four-bar", &[]);
    scene.life.cycles = 1000;
    // Settling, the first cycle, a cycle after each block, the probes, and two on finer surfaces.
    assert_eq!(run(&scene, &Accuracy::draft()).diagnostics.simulated_cycles, 11);
}

/// Fifty evaluations with other numbers of settling cycles and clearances that differ by 50 nm: each measures other cycles of the same
/// mechanism.
///
///     cargo test --release -p worker --test evaluation rattling -- --ignored --nocapture
#[test]
#[ignore = "a measurement of a minute"]
fn stated_errors_against_fifty_starts() {
    let starts = std::env::var("STARTS").ok().and_then(|n| n.parse().ok()).unwrap_or(50);
    for accuracy in [Accuracy::draft(), Accuracy::balanced()] {
        let runs: Vec<Evaluation> = (1..=starts)
            .map(|settle| {
                let mut scene = scene("slider-crank", &[]);
                scene.life.settle_cycles = settle;
                every_joint(&mut scene, |clearance| clearance.bushing_radius += 5e-8 * f64::from(settle));
                run(&scene, &Accuracy { tier: Tier::Dynamic, ..accuracy })
            })
            .collect();
        for run in &runs {
            let last = run.cycles.len() - 1;
            let (depth, error) = (run.histories[0][last], run.errors[0][last]);
            let steps = run.diagnostics.steps;
            println!("{depth:.4e} m +- {:.1} % at the end, {steps} steps", 100.0 * error / depth);
        }
        let cycles = &runs[0].cycles;
        for output in 0..runs[0].histories.len() {
            println!(
                "output {output}: cycles, mean, scatter of the runs, mean stated error, runs within half of theirs, within theirs, \
                 rms ratio, runs that state less than 10 %"
            );
            let mut outside = 0.0;
            for (k, cycle) in cycles.iter().enumerate() {
                let values: Vec<f64> = runs.iter().map(|run| run.histories[output][k]).collect();
                let stated: Vec<f64> = runs.iter().map(|run| run.errors[output][k]).collect();
                let n = values.len() as f64;
                let mean = values.iter().sum::<f64>() / n;
                let scatter =
                    (values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0)).sqrt();
                let ratios: Vec<f64> =
                    values.iter().zip(&stated).map(|(x, s)| (x - mean).abs() / s).collect();
                let within = ratios.iter().filter(|ratio| **ratio <= 1.0).count();
                let half = ratios.iter().filter(|ratio| **ratio <= 0.5).count();
                let ten = stated.iter().zip(&values).filter(|(s, x)| **s < 0.1 * **x).count();
                let rms = (ratios.iter().map(|ratio| ratio * ratio).sum::<f64>() / n).sqrt();
                let error = stated.iter().sum::<f64>() / n;
                println!(
                    "{cycle:6} {mean:.4e} {:5.1} % {:5.1} % {half:3} {within:3} {rms:.2}, {ten:3}",
                    100.0 * scatter / mean,
                    100.0 * error / mean
                );
                outside += (n - within as f64) / (n * cycles.len() as f64);
            }
            // The stated errors hold in 95 of 100 runs; the checkpoints of a run depend on each other.
            assert!(
                outside < 0.08,
                "output {output}: {outside} of the values are outside their stated error"
            );
        }
    }
}
