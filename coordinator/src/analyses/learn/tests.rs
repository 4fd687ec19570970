use super::result::LearnedParameter;
use super::*;
use crate::analyses::error::RefusedQuestion;
use crate::analyses::update::{FleetData, parse_fleet};
use crate::farm::evaluate::{Request, local::LocalEvaluator};
use crate::results::journal::InMemoryJournal;
use crate::results::progress::Silent;
use crate::statistics::design::{InputModel, Population};
use crate::study::{FurtherLearning, LifeModel, Observed, Settings, StoredOutcome, learn_from_results};
use common::outputs::Evaluation;
use common::random::Family;
use common::scene::{Scene, SceneSource};

/// A wear that grows in proportion to time, from an offset.
pub(super) const WEAR: &str = r#"
scene = { name = "bushing" }
simulator = { program = ["closure"] }
life = { cycles = 2000, checkpoint_every = 100 }
outputs = [{ name = "wear", unit = "um" }]
limit_states = [{ name = "worn", output = "wear", threshold = 30 }]
variables = [
    { name = "rate", distribution = "normal", mean = 25, std = 3 },
    { name = "offset", distribution = "normal", mean = 2, std = 0.5 },
]
"#;

/// A part whose life is exponential.
const LIFE: &str = r#"
scene = { name = "part" }
simulator = { program = ["closure"] }
life = { cycles = 6000, checkpoint_every = 200 }
outputs = [{ name = "excess" }]
limit_states = [{ name = "worn", output = "excess", threshold = 0 }]
variables = [{ name = "life", distribution = "exponential", mean = 1000, lower = 0 }]
"#;

pub(super) fn wear(x: &[f64], n: f64) -> f64 {
    x[1] + x[0] * n / 1000.0
}

fn excess(x: &[f64], n: f64) -> f64 {
    n - x[0]
}

/// The study of a closure from 40 simulations.
pub(super) fn study(text: &str, response: fn(&[f64], f64) -> f64) -> (SceneSource, LifeModel) {
    let source = SceneSource::parse(text, "scene").unwrap();
    let (settings, stored) = simulated(source.nominal(), response);
    let learned = learn_from_results(source.nominal(), source.nominal(), &settings, &stored).unwrap();
    let model = LifeModel::new(source.nominal(), &learned);
    (source, model)
}

/// Its settings and simulations.
fn simulated(scene: &Scene, response: fn(&[f64], f64) -> f64) -> (Settings, Vec<StoredOutcome>) {
    let settings = Settings { samples: 2000, initial: 40, max_evaluations: 40, ..Settings::from(scene) };
    let population = Population::draw(InputModel::from_scene(scene), 40, 9);
    let outcome = |j: usize| {
        let sample = population.physical(j);
        let outcome = Ok(Observed::from_evaluation(evaluation(scene, response, &sample)));
        StoredOutcome { sample, outcome }
    };
    (settings, (0..40).map(outcome).collect())
}

fn evaluation(scene: &Scene, response: fn(&[f64], f64) -> f64, sample: &[f64]) -> Evaluation {
    let cycles = scene.life.checkpoints();
    // Output k is the response to the variables from k on.
    let outputs = 0..scene.outputs.len();
    let history = |k: usize| cycles.iter().map(|n| response(&sample[k..], f64::from(*n))).collect();
    let start = outputs.clone().map(|k| Some(response(&sample[k..], 0.0))).collect();
    let histories = outputs.map(history).collect();
    Evaluation { start, ..Evaluation::from_histories(cycles, histories) }
}

pub(super) fn learned(
    (source, model): (SceneSource, LifeModel),
    text: &str,
    change: impl FnOnce(&mut LearnSettings),
) -> Result<LearnReport, RefusedQuestion> {
    let data: FleetData = parse_fleet(text, "fleet.csv", &source, &model, Some(&[])).unwrap();
    let mut settings = LearnSettings::new(3);
    settings.ranks = false;
    // Enough where single variables were measured.
    (settings.units.monte_carlo.particles, settings.units.population) = (400, 6000);
    change(&mut settings);
    let summary = crate::tests::test_study::study().summary;
    learn(source.nominal(), &summary, model, &data, &[], &[], &settings)
}

/// Sets of parameters of the closed forms: with 6000 all means agree within 1 %.
const SETS: usize = 500;

/// True if a posterior mean and standard deviation are exact within three of their standard errors by the effective number of
/// sets, and half a per cent for the points.
pub(super) fn agrees(parameter: &LearnedParameter, mean: f64, std: f64, sets: f64) -> bool {
    let of_mean = (parameter.mean - mean).abs() < 3.0 * std / sets.sqrt() + 0.005 * mean;
    of_mean && (parameter.std / std - 1.0).abs() < 3.0 / (2.0 * sets).sqrt() + 0.03
}

/// Measured offsets of twelve units [um].
const OFFSETS: [f64; 12] = [2.31, 1.62, 2.84, 2.05, 1.44, 2.63, 2.22, 1.91, 2.74, 2.38, 1.79, 2.57];

fn measured_offsets() -> String {
    (1..).zip(OFFSETS).map(|(k, x)| format!("U{k},,offset,{x},0.01\n")).collect()
}

fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt())
}

/// Wear is rate + offset after 1000 cycles: with a spread s of the rate and an error e that of the wear is sqrt(s^2 + 0.5^2 + e^2) [um], and the
/// flat prior of ln s is integrated on a grid. The last unit lies in the tail, where rate and offset share what is unusual.
#[test]
fn a_unit_in_the_tail_leaves_the_exact_spread() {
    let wears = [27.1, 26.2, 28.0, 26.9, 27.6, 25.9, 27.8, 26.5, 27.2, 28.1, 26.3, 30.6];
    let error = |y: f64| -> f64 { if y > 30.0 { 0.02 } else { 0.1 } };
    let rows: String =
        (1..).zip(wears).map(|(k, y)| format!("U{k},1000,wear,{y} um,{} um\n", error(y))).collect();
    let text = format!("population,,rate.mean\npopulation,,rate.std\n{rows}");
    let exact = |of: fn(f64) -> f64| {
        let (mut total, mut sum) = (0.0, 0.0);
        for i in 0..400 {
            let spread: f64 = 0.6 * 25_f64.powf(f64::from(i) / 399.0);
            for mean in (0..400).map(|j| 25.0 + 5.0 * (f64::from(j) / 200.0 - 1.0)) {
                let log = |y: &f64| {
                    let variance = spread * spread + 0.25 + error(*y).powi(2);
                    -0.5 * (y - mean - 2.0).powi(2) / variance - 0.5 * variance.ln()
                };
                let weight = (wears.iter().map(log).sum::<f64>() + 8.0).exp();
                total += weight;
                sum += weight * of(spread);
            }
        }
        sum / total
    };
    let (mean, square) = (exact(|s| s), exact(|s| s * s));
    let std = (square - mean * mean).sqrt();
    // The points count R alone.
    let change =
        |s: &mut LearnSettings| *s = LearnSettings { ranks: false, points: 3000, ..LearnSettings::new(3) };
    let report = learned(study(WEAR, wear), &text, change).unwrap();
    let found = &report.parameters[1];
    assert!(agrees(found, mean, std, report.effective_size), "{found:?}; exact {mean} {std}");
}

/// The offset is a design variable whose value is not known; flat within its range, it is normal about the mean wear less 25 um, with the
/// standard deviation 3 um / sqrt(6) that the rates leave.
#[test]
fn the_value_of_a_design_variable_has_its_closed_form() {
    let text = WEAR.replace("\"normal\", mean = 2, std = 0.5", "\"uniform\", lower = -3, upper = 9");
    let (source, model) = study(&text, wear);
    let wears = [27.1, 31.2, 24.0, 29.9, 22.7, 33.1];
    let rows: String = (1..).zip(wears).map(|(k, y)| format!("U{k},1000,wear,{y} um,0.1 um\n")).collect();
    let data = parse_fleet(&format!("population,,offset\n{rows}"), "fleet.csv", &source, &model, Some(&[1]))
        .unwrap();
    let mut settings = LearnSettings { ranks: false, points: 4000, ..LearnSettings::new(3) };
    settings.units.population = 8000;
    let summary = crate::tests::test_study::study().summary;
    let report = learn(source.nominal(), &summary, model, &data, &[1], &[], &settings).unwrap();
    let [found] = &report.parameters[..] else { panic!("{:?}", report.parameters) };
    assert_eq!(found.name, "offset");
    let (mean, _) = moments(&wears);
    assert!(agrees(found, mean - 25.0, (9.01_f64 / 6.0).sqrt(), report.effective_size), "{found:?} {mean}");
}

#[test]
fn issue_a_known_design_variable_scattered_over_its_range() {
    let text = WEAR.replace("\"normal\", mean = 2, std = 0.5", "\"uniform\", lower = -3, upper = 9");
    let constant = text.replace("\"uniform\", lower = -3, upper = 9", "\"constant\", mean = 2");
    let [(studied, model), (present, _)] = [&text, &constant].map(|text| study(text, wear));
    let unknown = |rows: &str| parse_fleet(rows, "fleet.csv", &studied, &model, Some(&[1])).unwrap().unknown;
    for (row, left) in [("population,,rate.mean\n", vec![]), ("population,,offset\n", vec![1]), ("", vec![1])]
    {
        let rows = format!("{row}U1,1000,wear,27 um,0.1 um\n");
        let mut scene = studied.nominal().clone();
        assert_eq!(hold_known(&mut scene, present.nominal(), &[1], &unknown(&rows)), left, "{row}");
        assert_eq!(scene.variables[1].distribution.is_constant(), left.is_empty(), "{row}");
    }
}

#[test]
fn a_normal_mean_has_the_conjugate_closed_form() {
    let text = format!("population,,offset.mean,1.5,0.2\n{}", measured_offsets());
    let report = learned(study(WEAR, wear), &text, |s| (s.sets, s.points) = (SETS, 3000)).unwrap();
    let (mean, _) = moments(&OFFSETS);
    let (prior, data) = (1.0 / 0.04, 12.0 / (0.25 + 1e-4));
    let exact = ((1.5 * prior + mean * data) / (prior + data), (prior + data).powf(-0.5));
    let found = &report.parameters[0];
    assert!(agrees(found, exact.0, exact.1, report.effective_size), "{found:?} {exact:?}");
}

#[test]
fn a_normal_mean_and_spread_have_the_conjugate_closed_form() {
    // Flat in mean and ln std: (mean - m) / (s / sqrt n) is Student's t of n - 1 degrees of freedom, (n - 1) s^2 / std^2 is chi-squared.
    let report =
        learned(study(WEAR, wear), &measured_offsets(), |s| (s.sets, s.points) = (SETS, 3000)).unwrap();
    assert!(report.chosen_by_default && report.parameters.len() == 2, "{:?}", report.parameters);
    let ((mean, std), n) = (moments(&OFFSETS), 12.0);
    let [m, s] = [&report.parameters[0], &report.parameters[1]];
    let spread = std / f64::sqrt(n) * ((n - 1.0) / (n - 3.0)).sqrt();
    // E[1 / chi] = Gamma(5) / (Gamma(5.5) sqrt 2) of 11 degrees of freedom.
    let ratio = 24.0 / 52.342_777_784_553_52 / 2f64.sqrt();
    let exact = std * f64::sqrt(n - 1.0) * ratio;
    assert!(agrees(m, mean, spread, report.effective_size), "{m:?} {mean} {spread}");
    let error = 3.0 * s.std / report.effective_size.sqrt() + 0.005 * exact;
    assert!((s.mean - exact).abs() < error, "{s:?} {exact}");
}

#[test]
fn an_exponential_mean_with_suspensions_has_the_conjugate_closed_form() {
    let failed = [310.0, 640.0, 1250.0, 150.0, 920.0, 1830.0];
    let running = [500.0, 1000.0, 1500.0, 2000.0];
    let lines = |(k, n): (usize, &f64)| format!("F{k},{n},failed,worn,2\n");
    let suspended = |(k, n): (usize, &f64)| format!("S{k},{n},survived\n");
    let text: String =
        failed.iter().enumerate().map(lines).chain(running.iter().enumerate().map(suspended)).collect();
    // The tail of the inverse gamma distribution is heavy.
    let report = learned(study(LIFE, excess), &text, |s| s.sets = 6 * SETS).unwrap();
    // Flat in ln mean: the mean is inverse gamma with r failures and the total time T.
    let (r, total) = (6.0, failed.iter().chain(&running).sum::<f64>());
    let (mean, std) = (total / (r - 1.0), total / (r - 1.0) / f64::sqrt(r - 2.0));
    let found = &report.parameters[0];
    assert!(agrees(found, mean, std, report.effective_size), "{found:?} {mean} {std}");
    // The one-sided 90 % bound of the life at R = 0.9: -ln 0.9 times the 10 % quantile of the mean, 2 T / chi2(0.9, 12).
    let bound = -0.9f64.ln() * 2.0 * total / 18.549_35;
    let life = report.confident.lives[1].at_least.unwrap();
    assert!((life / bound - 1.0).abs() < 0.05, "{life} {bound}");
}

#[test]
fn units_that_no_population_explains_are_named() {
    // The life is exponential and ends at 6000 cycles in the study; a wear of 90 um at 100 cycles is beyond every point.
    let mut text = "population,,offset.mean,2,0.05\npopulation,,offset.std,0.5,0.01\n".to_owned();
    text += &measured_offsets();
    let odd = format!("{text}X,,offset,3.9,0.01\n");
    let report = learned(study(WEAR, wear), &odd, |s| s.points = 8000).unwrap();
    assert_eq!(report.checks.len(), 1, "{:?}", report.checks);
    let check = &report.checks[0];
    assert!(check.unit == "X" && check.warning.contains("line 15) is improbable"), "{check:?}");
    let none = format!("{text}Y,100,wear,90,0.001\n");
    let error = learned(study(WEAR, wear), &none, |_| {}).unwrap_err().to_string();
    assert!(error.contains("line 15: wear of unit Y agrees with no point"), "{error}");
}

#[test]
fn competing_modes_and_intervals_teach_the_rate_and_rank_further_data() {
    // Ten units whose wear rate is near 28 um per 1000 cycles: found failed between two inspections, or failed at a known life.
    let text: String = (0..10)
        .map(|k| {
            let life = 1000.0 * 28.0 / (27.0 + 0.3 * f64::from(k));
            if k % 2 == 0 {
                let (before, after) = ((life / 50.0).floor() * 50.0, (life / 50.0).ceil() * 50.0);
                format!("U{k},{before},survived\nU{k},{after},failed,worn\n")
            } else {
                format!("U{k},{life:.0},failed,,5\n")
            }
        })
        .collect();
    let report = learned(study(WEAR, wear), &text, |s| s.ranks = true).unwrap();
    let rate = &report.parameters[0];
    assert!(rate.name == "rate.mean" && report.parameters[1].name == "rate.std", "{:?}", report.parameters);
    assert!((27.5..29.0).contains(&rate.median) && rate.interval[0] > 26.0, "{rate:?}");
    // Half of such units fail near 1000 cycles, with a bound below the median.
    let half = report.confident.lives[2];
    let (bound, median) = (half.at_least.unwrap(), half.median.unwrap());
    assert!(bound < median && (950.0..1050.0).contains(&median), "{half:?}");
    let best = &report.values[0];
    assert!(best.narrowing > 0.1 && best.narrowing > 2.0 * best.standard_error, "{:?}", report.values);
    assert!(report.values.windows(2).all(|pair| pair[0].narrowing >= pair[1].narrowing));
    // With prices the narrowing for them counts; what has none comes last.
    let priced = format!("{text}price,,failed,1000\nprice,,wear,2\n");
    let priced = learned(study(WEAR, wear), &priced, |s| (s.ranks, s.sets) = (true, 150)).unwrap();
    let costs: Vec<Option<f64>> = priced.values.iter().map(|value| value.cost).collect();
    assert_eq!(costs, [Some(10.0), Some(10.0), Some(5000.0), None], "{:?}", priced.values);
    assert!(answer(&priced).text().contains("narrowing over cost"));
    let text = answer(&report).text();
    for expected in
        ["Life at R = 0.99 with C = 90", "rate.mean", "more units run to failure", "no unknown parameter"]
    {
        assert!(text.contains(expected), "{expected}: {text}");
    }
}

#[test]
fn simulations_where_the_population_has_gone_improve_what_was_learned() {
    // Severe wear above a rate of 33, which the study, of rates of 25 with a spread of 3, has not simulated; the units have rates near 35.
    let steep: fn(&[f64], f64) -> f64 = |x, n| x[1] + (x[0] + 2.0 * (x[0] - 33.0).max(0.0)) * n / 1000.0;
    let life = |rate: f64| 28_000.0 / (rate + 2.0 * (rate - 33.0));
    let row = |k: u32| format!("U{k},{:.1},failed,,3\n", life(33.25 + 0.5 * f64::from(k)));
    let text = format!("population,,rate.mean\n{}", (0..8).map(row).collect::<String>());
    // Values beyond the bounds of the study's distribution count as simulated.
    let bounded = WEAR.replacen("\"normal\"", "\"truncated-normal\"", 1);
    let (source, model) = study(&bounded, steep);
    let scene = source.nominal();
    let inputs = InputModel::from_scene(scene);
    let before = learned((source.clone(), model), &text, |_| {}).unwrap();
    assert_eq!(before.left.len(), 1, "{:?}", before.left);
    let (settings, stored) = simulated(scene, steep);
    let changed = &before.scene_of_one_more(scene);
    let learning = FurtherLearning {
        correction: None,
        changed,
        studied: scene,
        settings: &settings,
        stored: &stored,
        further: 20,
    };
    let mut evaluator =
        LocalEvaluator::new(1, |request: &Request| Ok(evaluation(scene, steep, &request.sample)));
    let campaign = learning.learn(&mut evaluator, &mut InMemoryJournal::default(), &mut Silent).unwrap();
    assert!(campaign.evaluations > 40 && campaign.evaluations <= 60, "{}", campaign.evaluations);
    let model = LifeModel::new(scene, &campaign).redistributed(inputs);
    let after = learned((source, model), &text, |_| {}).unwrap();
    let [error, narrower] = [&before, &after].map(|report| {
        let rate = &report.parameters[0];
        ((rate.median - 35.0).abs(), rate.interval[1] - rate.interval[0])
    });
    assert!(narrower.0 < 0.7 && narrower.0 < 0.5 * error.0, "{error:?} {narrower:?}");
    assert!(after.left.is_empty(), "{:?}", after.left);
    // With one more unit far from the study, half of the population fails near the life of the middle one.
    let half = after.confident.lives[2].median.unwrap();
    assert!((half / life(35.0) - 1.0).abs() < 0.1, "{half} {}", life(35.0));
    let caution = Some("Caution: the study only bounds P_f".to_owned());
    let answered = LearnReport { evaluations: 7, before: Some(before.confident), caution, ..after };
    let text = answer(&answered).text();
    assert!(text.contains("only bounds P_f"), "{text}");
    assert!(text.contains("Before 7 simulations were added: Life at R = 0.99"), "{text}");
}

#[test]
fn every_fault_of_the_population_is_named_with_line_and_column() {
    let (source, model) = study(LIFE, excess);
    let faults = |text: &str| {
        crate::tests::located(parse_fleet(text, "fleet.csv", &source, &model, Some(&[])).unwrap_err())
    };
    for [row, expected] in crate::tests::rows("every_fault_of_the_population_is_named_with_line_and_column") {
        let said = faults(row);
        assert!(said.contains(expected), "{row}: {said}");
    }
}

/// The lower 90 % bound of the life at R = 0.9 of a lognormal life with parameters from n samples; the truth for the frequency
/// with which it holds. The closed form is the tolerance bound by the noncentral t: 87 to 93 % of 200 data sets.
#[test]
fn bounds_from_few_samples_hold_as_often_as_stated() {
    use crate::statistics::updating::{CurveDraws, Reweighting, fitted_draws};
    use common::random::Distribution;
    use rand::RngExt;
    use rand_chacha::ChaCha12Rng;
    use rand_chacha::rand_core::SeedableRng;
    let truth = Distribution::lognormal(1000.0, 300.0).unwrap();
    let exact = truth.quantile(0.1);
    for n in [5, 30] {
        let mut rng = ChaCha12Rng::seed_from_u64(n);
        let mut held = 0;
        for _ in 0..200 {
            let samples: Vec<f64> = (0..n).map(|_| truth.quantile(rng.random::<f64>())).collect();
            let fitted = Family::Lognormal.fit(&samples).unwrap();
            let laws = fitted_draws(Some(Family::Lognormal), &fitted, &samples, 100, &mut rng);
            let sets: Vec<(f64, [f64; 2])> = laws.iter().map(|law| (1.0, [law.mean(), law.std()])).collect();
            let points_of = space::proposal(&fitted, None, &sets);
            let reweighting = Reweighting::new(vec![0], std::slice::from_ref(&points_of));
            let states: Vec<f64> = (0..200)
                .map(|j| common::random::standard_normal_quantile((f64::from(j) + 0.5) / 200.0))
                .collect();
            let lives: Vec<f64> = states.iter().map(|u| points_of.from_standard_normal(*u)).collect();
            let points: Vec<f64> = reweighting.points(&states, 1);
            let order = CurveDraws::order(&lives);
            let mut draws = CurveDraws::new(vec![], vec![0.9]);
            for law in &laws {
                draws.add(
                    1.0,
                    &lives,
                    &order,
                    &reweighting.weights(&InputModel::from(std::slice::from_ref(law)), &points),
                );
            }
            held += usize::from(draws.at_confidence(0.9).lives[0].at_least.unwrap() <= exact);
        }
        // Three standard errors of a share of 0.9 over 200 data sets, and the resolution of 100 draws.
        assert!((167..=193).contains(&held), "{n}: {held}");
    }
}
