//! Studies of a wear that is a product of powers of lognormal variables, w(n) = (n / 1000) x_1^2 x_2 / x_3, against closed forms.
//!
//! ln w(n) is normal with the mean ln(n / 1000) and the variance 4 s_1^2 + s_2^2 + s_3^2, with s_k the standard deviation of ln x_k, and the
//! life L = 1000 w_limit / (x_1^2 x_2 / x_3) is lognormal.

use super::{
    CampaignResult, LifeModel, Observed, Settings, StoredOutcome, StudyResult, learn_from_results, run,
};
use crate::farm::evaluate::{Request, local::LocalEvaluator};
use crate::results::journal::InMemoryJournal;
use crate::results::progress::Silent;
use crate::statistics::design::{InputModel, Population};
use crate::statistics::surrogate::ResponseScale;
use common::outputs::Evaluation;
use common::random::{standard_normal_cdf, standard_normal_quantile};
use common::scene::{Scene, SceneSource};
use faer::Mat;

/// Standard deviations of the logarithms of the variables [1], whose medians are 1, and their exponents.
const SPREADS: [f64; 3] = [0.3, 0.4, 0.25];
const POWERS: [f64; 3] = [2.0, 1.0, -1.0];
const LIMIT: f64 = 2.0;

fn scene() -> Scene {
    let variable = |(k, spread): (usize, &f64)| {
        let mean = (0.5 * spread * spread).exp();
        let std = mean * (spread * spread).exp_m1().sqrt();
        format!("{{ name = \"x{k}\", mean = {mean}, std = {std}, distribution = \"lognormal\" }}")
    };
    let variables: Vec<String> = SPREADS.iter().enumerate().map(variable).collect();
    let text = format!(
        "scene = {{ name = \"s\" }}\nsimulator = {{ program = [\"s\"] }}\nlife = {{ cycles = 3000, checkpoint_every = 100 }}\n\
         outputs = [{{ name = \"wear\" }}]\nlimit_states = [{{ name = \"worn\", output = \"wear\", threshold = {LIMIT} }}]\n\
         variables = [{}]",
        variables.join(", ")
    );
    SceneSource::parse(&text, "s").unwrap_or_else(|faults| panic!("{faults}")).nominal().clone()
}

fn wear(x: &[f64], n: f64) -> f64 {
    n / 1000.0 * x.iter().zip(POWERS).map(|(x, power)| x.powf(power)).product::<f64>()
}

/// Standard deviation of the logarithm of the wear [1].
fn spread() -> f64 {
    SPREADS.iter().zip(POWERS).map(|(s, power)| (s * power).powi(2)).sum::<f64>().sqrt()
}

fn study() -> StudyResult {
    let scene = scene();
    let settings = Settings { samples: 20_000, seed: 3, ..Settings::from(&scene) };
    let checkpoints = scene.life.checkpoints();
    let simulate = |request: &Request| {
        let history = checkpoints.iter().map(|n| wear(&request.sample, f64::from(*n))).collect();
        let mut evaluation = Evaluation::from_histories(checkpoints.clone(), vec![history]);
        evaluation.start = vec![Some(0.0)];
        Ok(evaluation)
    };
    let mut evaluator = LocalEvaluator::new(1, simulate);
    run(&scene, &settings, &mut evaluator, &mut InMemoryJournal::default(), &mut Silent).unwrap()
}

#[test]
fn a_product_is_learned_by_its_logarithm_and_stated_in_its_own_unit() {
    let result = study();
    let summary = &result.summary;
    let [surrogate] = &summary.surrogates[..] else { panic!("one limit state") };
    assert!(surrogate.logarithms && surrogate.q2 > 0.999_999, "{surrogate:?}");
    // 30 simulations at least, and those over which the rule must hold.
    assert!(summary.evaluations.total <= 50, "{:?}", summary.evaluations);
    for row in &summary.reliability {
        let exact = standard_normal_cdf((LIMIT * 1000.0 / f64::from(row.cycles)).ln() / spread());
        let (r, error) = (row.reliability["worn"], row.standard_error["worn"]);
        assert!((r - exact).abs() < 4.0 * error + 1e-4, "{}: {r} {error} {exact}", row.cycles);
    }
    for life in summary.lives.iter().filter(|life| life.limit_state == "total" && life.cycles.is_some()) {
        let exact = LIMIT * 1000.0 * (spread() * standard_normal_quantile(1.0 - life.reliability)).exp();
        let (lower, upper) = (life.interval.lower, life.interval.upper.unwrap());
        let slack = 0.01 * exact;
        assert!((lower - slack..=upper + slack).contains(&exact), "{life:?} {exact}");
    }
    // Values as simulated, and Sobol indices of the wear itself: with b^2 = exp(v) - 1 the first-order index of a factor of a product of
    // lognormals is that of its own over that of all.
    let [predictions] = &summary.predictions[..] else { panic!("one limit state") };
    for (simulated, predicted) in predictions.simulated.iter().zip(&predictions.predicted) {
        assert!((predicted / simulated - 1.0).abs() < 1e-3, "{simulated} {predicted}");
    }
    let whole = (spread() * spread()).exp_m1();
    for row in &summary.sobol {
        let k = scene().variables.iter().position(|variable| variable.name == row.variable).unwrap();
        let exact = (SPREADS[k] * POWERS[k]).powi(2).exp_m1() / whole;
        let reach = 5.0 * row.standard_error.first_order + 0.02;
        assert!((row.first_order - exact).abs() < reach, "{row:?} {exact}");
    }
    let moments = &summary.moments[9];
    let (exact, found) = ((0.5 * spread() * spread()).exp(), moments.moments["worn_mean"]);
    assert!((found / exact - 1.0).abs() < 0.03, "{found} {exact}");
}

/// What 40 simulations teach, whose wear is raised by `offset`.
fn learned(offset: f64) -> (Scene, CampaignResult) {
    let scene = scene();
    let settings = Settings { samples: 2000, initial: 40, max_evaluations: 40, ..Settings::from(&scene) };
    let population = Population::draw(InputModel::from_scene(&scene), 40, 9);
    let cycles = scene.life.checkpoints();
    let simulate = |j: usize| {
        let sample = population.physical(j);
        let history = cycles.iter().map(|n| offset + wear(&sample, f64::from(*n))).collect();
        let outcome = Ok(Observed { start: vec![Some(offset)], ..Observed::exact(vec![history]) });
        StoredOutcome { sample, outcome }
    };
    let stored: Vec<StoredOutcome> = (0..40).map(simulate).collect();
    let learned = learn_from_results(&scene, &scene, &settings, &stored).unwrap();
    (scene, learned)
}

#[test]
fn single_points_have_lives_and_values_of_the_product() {
    let (scene, learned) = learned(0.0);
    assert_eq!(learned.assessment.surrogates[0].scale, ResponseScale::Logarithms);
    let model = LifeModel::new(&scene, &learned);
    let samples = [[1.0, 1.0, 1.0], [1.3, 0.8, 1.1], [0.9, 1.4, 0.8]];
    let z: Vec<Vec<f64>> = samples.iter().map(|x| model.inputs.standardise(x)).collect();
    let points = Mat::from_fn(3, 3, |k, j| z[j][k]);
    assert_eq!(model.beginning(0), 0.0);
    let responses = model.respond(points.as_ref(), &[0.0; 3], &[0]);
    for (j, x) in samples.iter().enumerate() {
        let exact = 1000.0 * LIMIT / wear(x, 1000.0);
        assert!((responses.lives[j] / exact - 1.0).abs() < 1e-3, "{x:?} {} {exact}", responses.lives[j]);
        for n in [50.0, 150.0, 1000.0, 2950.0] {
            let value = model.value_at(0, &responses.histories[0], j, n);
            assert!((value / wear(x, n) - 1.0).abs() < 2e-3, "{x:?} {n} {value} {}", wear(x, n));
        }
    }
}

#[test]
fn values_with_another_sign_are_learned_themselves() {
    let (_, learned) = learned(-0.5);
    assert_eq!(learned.assessment.surrogates[0].scale, ResponseScale::Values);
}
