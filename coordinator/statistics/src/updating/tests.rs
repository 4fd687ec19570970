use super::*;
use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Measured values that are linear in the state, and a life that falls with its first coordinate.
struct Linear {
    dimension: usize,
    /// Rows of coefficients `(k)(D,)`.
    rows: Vec<Vec<f64>>,
}

impl UnitModel for Linear {
    fn predict(&self, states: &[f64]) -> Predictions {
        let (n, k) = (states.len() / self.dimension, self.rows.len());
        let product = |v: &[f64], row: &[f64]| v.iter().zip(row).map(|(a, b)| a * b).sum::<f64>();
        let values = states
            .chunks_exact(self.dimension)
            .flat_map(|v| self.rows.iter().map(move |row| product(v, row)).collect::<Vec<_>>());
        Predictions {
            values_of_state: k,
            limit_states: 1,
            values: values.collect(),
            errors: vec![0.0; n * k],
            lives: states.chunks_exact(self.dimension).map(|v| 1000.0 - 100.0 * v[0]).collect(),
        }
    }
}

fn prior(model: &Linear, n: usize, rng: &mut ChaCha12Rng) -> Particles {
    let states: Vec<f64> = (0..n * model.dimension).map(|_| StandardNormal.sample(rng)).collect();
    let predictions = model.predict(&states);
    Particles::equal(model.dimension, states, predictions)
}

/// Posterior mean and standard deviation of the first coordinate for one value a'v measured as y with error s.
fn conjugate(row: &[f64], y: f64, s: f64) -> (f64, f64) {
    let variance = row.iter().map(|a| a * a).sum::<f64>() + s * s;
    (row[0] * y / variance, (1.0 - row[0] * row[0] / variance).sqrt())
}

fn moments(posterior: &UnitPosterior, k: usize) -> (f64, f64) {
    let particles = &posterior.particles;
    let mean = particles.mean(|i| particles.state(i)[k]);
    (mean, particles.mean(|i| (particles.state(i)[k] - mean).powi(2)).sqrt())
}

#[test]
fn weights_have_the_conjugate_closed_form() {
    let model = Linear { dimension: 2, rows: vec![vec![2.0, 1.0]] };
    let mut rng = ChaCha12Rng::seed_from_u64(1);
    let prior = prior(&model, 200_000, &mut rng);
    let settings = SequentialMonteCarlo { particles: 1000, least: 500.0 };
    let evidence = [Evidence::Measured { index: 0, value: 3.0, std: 1.0 }];
    let posterior = settings.update(prior, &evidence, &model, &mut rng).unwrap();
    let (mean, std) = moments(&posterior, 0);
    let exact = conjugate(&model.rows[0], 3.0, 1.0);
    assert_eq!(posterior.stages, 0);
    assert!(
        (mean / exact.0 - 1.0).abs() < 0.01 && (std / exact.1 - 1.0).abs() < 0.01,
        "{mean} {std} {exact:?}"
    );
    // Two-sided probability of 3 under N(0, 6).
    assert!((posterior.probabilities[0] - 0.2207).abs() < 0.005, "{:?}", posterior.probabilities);
    // Life 1000 - 100 v: quantiles of the posterior normal.
    let lives = posterior.particles.quantiles(&[0.05, 0.5], |i| posterior.particles.predictions.life(i));
    let expected = [1.644_854, 0.0].map(|z| 1000.0 - 100.0 * (exact.0 + z * exact.1));
    let off =
        lives.iter().zip(expected).map(|(found, exact)| (found / exact - 1.0).abs()).fold(0.0, f64::max);
    assert!(off < 0.01, "{lives:?} {expected:?}");
}

#[test]
fn moved_particles_have_the_conjugate_closed_form() {
    // A measurement that is a hundred times as exact as the prior, far out, in twenty coordinates.
    let row: Vec<f64> = (0..20).map(|k| 1.0 / f64::from(k + 1)).collect();
    let model = Linear { dimension: 20, rows: vec![row.clone()] };
    let mut rng = ChaCha12Rng::seed_from_u64(2);
    let prior = prior(&model, 5000, &mut rng);
    let settings = SequentialMonteCarlo { particles: 10_000, least: 500.0 };
    let evidence = [Evidence::Measured { index: 0, value: 4.0, std: 0.01 }];
    let posterior = settings.update(prior, &evidence, &model, &mut rng).unwrap();
    assert!(posterior.stages > 0 && posterior.effective_size > 4000.0, "{}", posterior.effective_size);
    let (mean, std) = moments(&posterior, 0);
    let exact = conjugate(&row, 4.0, 0.01);
    assert!(
        (mean / exact.0 - 1.0).abs() < 0.01 && (std / exact.1 - 1.0).abs() < 0.03,
        "{mean} {std} {exact:?}"
    );
    let value = posterior.particles.mean(|i| posterior.particles.predictions.value(i, 0).0);
    assert!((value / 4.0 - 1.0).abs() < 1e-3, "{value}");
}

#[test]
fn rare_survival_is_a_truncated_normal() {
    // Life beyond 1350 means v < -3.5, a probability of 2.3e-4.
    let model = Linear { dimension: 3, rows: vec![] };
    let mut rng = ChaCha12Rng::seed_from_u64(3);
    let prior = prior(&model, 4000, &mut rng);
    let settings = SequentialMonteCarlo { particles: 8000, least: 500.0 };
    let posterior = settings.update(prior, &[Evidence::Survived(1350.0)], &model, &mut rng).unwrap();
    let (mean, _) = moments(&posterior, 0);
    // -phi(3.5) / Phi(-3.5)
    assert!((mean / -3.751_368 - 1.0).abs() < 0.01, "{mean}");
    assert!(posterior.particles.quantiles(&[0.0], |i| posterior.particles.predictions.life(i))[0] > 1350.0);
}

#[test]
fn issue_survival_was_impossible_where_some_states_fail_unworn() {
    let model = Linear { dimension: 1, rows: vec![] };
    let mut rng = ChaCha12Rng::seed_from_u64(7);
    let mut prior = prior(&model, 4000, &mut rng);
    // Lives are 1000 - 100 v; those of one state in six, with v > 1, end at once.
    prior.predictions.lives.iter_mut().filter(|life| **life < 900.0).for_each(|life| *life = 0.0);
    let settings = SequentialMonteCarlo { particles: 500, least: 300.0 };
    for survived in [0.0, 500.0, 899.0] {
        let posterior =
            settings.update(prior.clone(), &[Evidence::Survived(survived)], &model, &mut rng).unwrap();
        let (mean, _) = moments(&posterior, 0);
        // -phi(1) / Phi(1)
        assert!((mean + 0.2876).abs() < 0.03 && posterior.stages == 0, "{survived}: {mean}");
        assert!((posterior.probabilities[0] - 0.8413).abs() < 0.02, "{:?}", posterior.probabilities);
    }
}

#[test]
fn observations_in_sequence_are_those_at_once() {
    let model = Linear { dimension: 2, rows: vec![vec![1.0, 0.0], vec![0.0, 1.0]] };
    let mut rng = ChaCha12Rng::seed_from_u64(4);
    let measured = |index, value, std| Evidence::Measured { index, value, std };
    let evidence = [
        measured(0, 1.0, 0.2),
        Evidence::Failed { life: 950.0, by: None },
        measured(1, -2.0, 0.05),
        measured(1, -2.0, 0.05),
    ];
    let prior = prior(&model, 20_000, &mut rng);
    let settings = SequentialMonteCarlo { particles: 8000, least: 500.0 };
    let posterior = settings.update(prior, &evidence, &model, &mut rng).unwrap();
    assert!(posterior.stages > 0);
    // Two equal measurements count as one of half the variance.
    let (mean, std) = moments(&posterior, 1);
    let exact = conjugate(&[1.0], -2.0, 0.05 / 2f64.sqrt());
    assert!(
        (mean / exact.0 - 1.0).abs() < 0.01 && (std / exact.1 - 1.0).abs() < 0.05,
        "{mean} {std} {exact:?}"
    );
    // A repeated value is what the first has made probable; a failure by 950 needs v > 0.5.
    assert!(
        posterior.probabilities[3] > 0.9 && posterior.probabilities[1] > 0.9,
        "{:?}",
        posterior.probabilities
    );
}

#[test]
fn what_cannot_be_is_said() {
    let model = Linear { dimension: 1, rows: vec![] };
    let mut rng = ChaCha12Rng::seed_from_u64(5);
    let prior = prior(&model, 1000, &mut rng);
    let settings = SequentialMonteCarlo { particles: 500, least: 300.0 };
    let evidence = [Evidence::Survived(1100.0), Evidence::Failed { life: 1050.0, by: None }];
    let Unsupported { place, resolution } = settings.update(prior, &evidence, &model, &mut rng).unwrap_err();
    assert!(place == 1 && resolution > 0.0 && resolution < 0.01, "{place} {resolution}");
}
