use super::*;
use crate::farm::evaluate::{Request, local::LocalEvaluator};
use crate::results::journal::InMemoryJournal;
use crate::results::progress::Silent;
use crate::statistics::replacement::PolicyCosts;
use crate::study::{LifeModel, Observed, Settings, StoredOutcome, learn_from_results, run};
use common::outputs::Evaluation;
use common::scene::SceneSource;
use std::sync::Mutex;

/// A part whose life is a Weibull variable of mean 1000 and standard deviation 300 cycles (shape 3.7), simulated by a closure.
const SCENE: &str = r#"
scene = { name = "part" }
simulator = { program = ["closure"] }
life = { cycles = 2400, checkpoint_every = 100 }
outputs = [{ name = "excess" }]
limit_states = [{ name = "worn", output = "excess", threshold = 0 }]
variables = [{ name = "life", distribution = "weibull", mean = 1000, std = 300 }]
"#;

const COSTS: ReplacementCosts = ReplacementCosts { planned: 1.0, failure: 10.0 };

fn studied(text: &str) -> (SceneSource, Settings, StudySummary, Vec<StoredOutcome>) {
    let source = SceneSource::parse(text, "part").unwrap();
    let scene = source.nominal();
    let stored = Mutex::new(Vec::new());
    let simulate = |request: &Request| {
        let cycles = scene.life.checkpoints();
        let history: Vec<f64> = cycles.iter().map(|n| f64::from(*n) - request.sample[0]).collect();
        let mut evaluation = Evaluation::from_histories(cycles, vec![history]);
        evaluation.start = vec![Some(-request.sample[0])];
        let outcome = Ok(Observed::from_evaluation(evaluation.clone()));
        stored.lock().unwrap().push(StoredOutcome { sample: request.sample.clone(), outcome });
        Ok(evaluation)
    };
    let settings = Settings { samples: 40_000, initial: 6, max_evaluations: 20, ..Settings::from(scene) };
    let mut evaluator = LocalEvaluator::new(1, simulate);
    let result = run(scene, &settings, &mut evaluator, &mut InMemoryJournal::default(), &mut Silent).unwrap();
    drop(evaluator);
    let stored = stored.into_inner().unwrap();
    (source, settings, result.summary, stored)
}

/// The least cost per cycle and its age by a fine sum over the exact R.
fn exact(scene: &SceneSource, costs: &ReplacementCosts) -> (f64, f64) {
    let law = scene.variables()[0].distribution.clone();
    let (mut integral, mut best) = (0.0, (f64::INFINITY, 0.0));
    for k in 0..24_000 {
        let (from, to) = (0.1 * f64::from(k), 0.1 * f64::from(k + 1));
        integral += 0.05 * (law.survival(from) + law.survival(to));
        let rate = costs.of_renewal(law.survival(to)) / integral;
        if rate < best.0 {
            best = (rate, to);
        }
    }
    best
}

#[test]
fn a_weibull_life_is_replaced_at_its_age_and_by_its_level() {
    let (source, settings, summary, stored) = studied(SCENE);
    let scene = source.nominal();
    let report = replace(&summary, "total", &COSTS, None).unwrap();
    let (rate, age) = exact(&source, &COSTS);
    assert!((report.cost_rate.value / rate - 1.0).abs() < 5e-3, "{:?} {rate}", report.cost_rate);
    assert!(report.cost_rate.lower < rate && rate < report.cost_rate.upper, "{:?}", report.cost_rate);
    assert!(report.age.lower < age && age < report.age.upper, "{:?} {age}", report.age);
    assert!(!report.no_minimum && report.share_without_minimum < 0.01);
    assert!(report.mean_life.lower < 1000.0 && 1000.0 < report.mean_life.upper, "{:?}", report.mean_life);
    assert_eq!(report.lives.len(), 3);
    let last = report.rates[9];
    let law = source.variables()[0].distribution.clone();
    let hazard = (law.survival(900.0) / law.survival(1000.0)).ln() / 100.0;
    let found = last.hazard.unwrap();
    assert!(found.lower < hazard && hazard < found.upper, "{found:?} {hazard}");
    let text = answer(&report, scene).text();
    assert!(text.contains("replace at") && text.contains("B10") && text.contains("hazard"), "{text}");

    // The dearer a failure, the fewer points of the curve are left where the least cost lies.
    for failure in [100.0, 1e3, 1e4, 1e5] {
        let costs = ReplacementCosts { planned: 1.0, failure };
        let ((rate, age), found) =
            (exact(&source, &costs), replace(&summary, "total", &costs, None).unwrap());
        let (ages, rates) = (found.age, found.cost_rate);
        assert!(ages.lower <= age && age <= ages.upper, "{failure} {ages:?} {age}");
        assert!(rates.lower <= rate && rate <= rates.upper, "{failure} {rates:?} {rate}");
    }
    let mut unworn = summary.clone();
    let curve = unworn.curves.iter_mut().find(|curve| curve.limit_state == "total").unwrap();
    curve.reliability.fill(0.0);
    let refused = replace(&unworn, "total", &COSTS, None).unwrap_err().to_string();
    assert!(refused.contains("failed from the beginning"), "{refused}");

    // A demanded reliability moves the replacement to an earlier age, which costs more; one that holds longer changes nothing.
    let demanded = |reliability| {
        let demand = (reliability, 0.9);
        replace(&summary, "total", &COSTS, Some(demand)).unwrap().demanded.unwrap()
    };
    let (strict, loose) = (demanded(0.99), demanded(0.2));
    let first = report.lives.iter().find(|life| life.reliability.to_bits() == 0.99_f64.to_bits()).unwrap();
    assert!(
        first.interval.lower < strict.latest && strict.latest < first.cycles.unwrap(),
        "{strict:?} {first:?}"
    );
    assert!(strict.age == strict.latest && strict.cost_rate > report.cost_rate.value, "{strict:?}");
    assert!(loose.latest > age && loose.age == report.age.value, "{loose:?} {age}");

    // The measured excess tells the life exactly: with free inspections every 100 cycles hardly any unit fails.
    let learned = learn_from_results(scene, scene, &settings, &stored).unwrap();
    let model = LifeModel::new(scene, &learned);
    let costs = PolicyCosts { planned: 1.0, failure: 10.0, inspection: 0.0 };
    let plan = InspectionPlan {
        limit_state: None,
        output: 0,
        error: 0.0,
        schedules: vec![Schedule::Every(100.0), Schedule::Every(400.0)],
        costs,
    };
    let rows = inspect(scene, &model, &plan, 1).unwrap();
    // The mean of the last hundred before the life, 949 cycles at cost 1.
    assert!((rows[0].outcome.cost_rate * 949.0 - 1.0).abs() < 0.03, "{rows:?}");
    assert!(rows[0].level.is_some_and(|level| (-104.0..-96.0).contains(&level)), "{rows:?}");
    assert!(
        rows[1].outcome.cost_rate > rows[0].outcome.cost_rate
            && rows[0].outcome.cost_rate < report.cost_rate.value,
        "{rows:?}"
    );
    let at = |lives: &[f64]| InspectionPlan { schedules: vec![Schedule::At(lives.to_vec())], ..plan.clone() };
    let lives: Vec<f64> = (4..=12).map(|k| 100.0 * f64::from(k)).collect();
    let given = inspect(scene, &model, &at(&lives), 1).unwrap();
    // 3 % fail before the first of them.
    assert!(given[0].every.is_none() && given[0].outcome.cost_rate > rows[0].outcome.cost_rate, "{given:?}");
    assert!(given[0].outcome.cost_rate < report.cost_rate.value, "{given:?}");
    assert!(inspect(scene, &model, &at(&[900.0, 800.0]), 1).is_err());
    let beyond = InspectionPlan { schedules: vec![Schedule::Every(5000.0)], ..plan };
    assert!(inspect(scene, &model, &beyond, 1).unwrap_err().to_string().contains("allowed: "));
}

#[test]
fn issue_inspections_counted_the_failures_of_all_limit_states_whatever_the_curve() {
    // A second limit of the same output, exceeded 400 cycles earlier.
    let earlier = "{ name = \"loud\", output = \"excess\", threshold = -400 }, { name = \"worn\"";
    let (source, settings, _, stored) = studied(&SCENE.replacen("{ name = \"worn\"", earlier, 1));
    let scene = source.nominal();
    let learned = learn_from_results(scene, scene, &settings, &stored).unwrap();
    let model = LifeModel::new(scene, &learned);
    let cost = |limit_state: Option<usize>| {
        let costs = PolicyCosts { planned: 1.0, failure: 10.0, inspection: 0.0 };
        let schedules = vec![Schedule::Every(100.0)];
        let plan = InspectionPlan { limit_state, output: 0, error: 0.0, schedules, costs };
        inspect(scene, &model, &plan, 1).unwrap()[0].outcome.cost_rate
    };
    let [loud, worn, all] = [Some(0), Some(1), None].map(cost);
    // As if it were the only one.
    assert!((worn * 949.0 - 1.0).abs() < 0.03, "{worn}");
    assert!(loud == all && all > 1.5 * worn, "{loud} {worn} {all}");
}

#[test]
fn what_the_study_does_not_know_is_a_bound() {
    let mut summary = crate::tests::test_study::study().summary;
    let curve = LifeCurveRow {
        limit_state: "total".to_owned(),
        cycles: vec![0.0, 500.0, 1000.0],
        reliability: vec![1.0, 0.95, 0.9],
        lower: vec![1.0, 0.94, 0.88],
        upper: vec![1.0, 0.96, 0.92],
        ..LifeCurveRow::default()
    };
    summary.curves = vec![curve];
    let report = replace(&summary, "total", &COSTS, None).unwrap();
    assert!(report.mean_life_is_bound && report.no_minimum && report.age.value == 1000.0);
    let text = answer(&report, &crate::tests::test_study::scene()).text();
    assert!(text.contains("no best age") && text.contains("at least") && text.contains("at most"), "{text}");
    assert!(text.contains("study a longer life") && !text.contains("run to failure:"), "{text}");
    let known = replace(&summary, "wear", &COSTS, None).unwrap_err().to_string();
    assert!(known.contains("allowed: total"), "{known}");
    let cheap = ReplacementCosts { planned: 2.0, failure: 2.0 };
    assert_eq!(check_costs(&cheap).unwrap_err().option, "--failure-cost 2");
    summary.curves.clear();
    let none = replace(&summary, "total", &COSTS, None).unwrap_err().to_string();
    assert!(none.starts_with("this study has no reliability between checkpoints"), "{none}");
}

#[test]
fn issue_a_constant_hazard_has_no_best_age_and_runs_to_failure() {
    // Mean life 1000 cycles, checkpoints from 200 on, the fall before them not resolved: R(200) = 0.819.
    let cycles: Vec<f64> = std::iter::once(0.0).chain((20..=800).map(|k| 10.0 * f64::from(k))).collect();
    let exact = |t: &f64| (-t / 1000.0).exp();
    let around =
        |by: f64| cycles.iter().map(|t| (exact(t) + by * t.min(1.0)).clamp(0.0, 1.0)).collect::<Vec<f64>>();
    let curve = LifeCurveRow {
        limit_state: "total".to_owned(),
        reliability: around(0.0),
        lower: around(-0.003),
        upper: around(0.003),
        cycles,
        ..LifeCurveRow::default()
    };
    let mut summary = crate::tests::test_study::study().summary;
    let fall = crate::results::life_summary::UnresolvedFall { from: 0, to: 200, checkpoint_every: 40 };
    (summary.curves, summary.unresolved_fall) = (vec![curve], Some(fall));
    // The straight line from 1 to R(200) has its least cost before 200 cycles for no cost of a failure, its steps at no other.
    for failure in [2.0, 10.0, 100.0] {
        let costs = ReplacementCosts { planned: 1.0, failure };
        let report = replace(&summary, "total", &costs, None).unwrap();
        assert!(report.no_minimum, "{failure}: {:?} {:?}", report.age, report.cost_rate);
        let rate = report.run_to_failure;
        assert!((rate.value * 1000.0 / failure - 1.0).abs() < 5e-3, "{rate:?}");
        assert!(rate.lower * 1000.0 < failure && failure < rate.upper * 1000.0, "{rate:?}");
        let text = answer(&report, &crate::tests::test_study::scene()).text();
        assert!(text.contains("no best age") && text.contains("run to failure"), "{text}");
    }
}
