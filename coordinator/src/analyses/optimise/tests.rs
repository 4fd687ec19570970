//! Optima of known truth, from studies that a closure simulates.

use super::problem::Grade;
use super::result::TargetState::{Met, MetWithinErrors, NotMet};
use super::*;
use crate::analyses::designs::DesignSpace;
use crate::analyses::quantity::ShownUnit;
use crate::results::reliability_summary::ErrorParts;
use crate::statistics::design::InputModel;
use crate::statistics::learning::Mode;
use crate::statistics::optimisation::CostModel;
use crate::statistics::reliability::LineSampling;
use crate::study::{Campaign, Observed, Plan, Problem, Settings};
use common::random::{Distribution, standard_normal_cdf, standard_normal_quantile};
use common::scene::{InputFile, SceneSource};
use faer::{Mat, MatRef};
use std::sync::LazyLock;

/// The result as Markdown.
fn markdown(found: &OptimisationResult) -> String {
    answer(found, "", vec![]).markdown()
}

/// A finished study of the margins of `f` (failure where one is not negative) at one checkpoint.
fn study(
    variables: &[Distribution],
    modes: usize,
    initial: usize,
    f: &dyn Fn(&[f64]) -> Vec<f64>,
) -> StudyBasis {
    let settings = Settings {
        samples: 10_000,
        initial,
        max_evaluations: initial,
        batch: 1,
        seed: 3,
        ..Settings::default()
    };
    let problem = Problem {
        inputs: InputModel::from(&variables.to_vec()),
        outputs: modes,
        modes: (0..modes).map(|output| Mode { output, threshold: 0.0 }).collect(),
        checkpoints: vec![1],
    };
    let plan = Plan {
        targets: settings.targets(),
        largest_population: 10_000,
        retry: false,
        is_exact: true,
        settings: settings.clone(),
    };
    let mut outcomes = Vec::new();
    let simulate = |sample: &[f64]| {
        let outcome = Ok(Observed::exact(f(sample).into_iter().map(|y| vec![y]).collect()));
        outcomes.push((sample.to_vec(), outcome.clone()));
        outcome
    };
    Campaign::new(problem.clone(), plan).learn_from(simulate, |_| {}).unwrap();
    StudyBasis { problem, settings, outcomes }
}

fn run(
    study: &StudyBasis,
    problem: &DesignProblem,
    budget: usize,
    f: &dyn Fn(&[f64]) -> Vec<f64>,
) -> OptimisationResult {
    let mut simulate = |requests: &[SampleRequest]| -> Result<Vec<ObservedOutcome>, AnalysisError> {
        let outcome = |request: &SampleRequest| {
            let observed = Observed::exact(f(&request.sample).into_iter().map(|y| vec![y]).collect());
            // With the errors that the study states.
            let of_study = study.outcomes.iter().find_map(|(_, outcome)| outcome.as_ref().ok());
            Ok(Observed { errors: of_study.expect("a result").errors.clone(), ..observed })
        };
        Ok(requests.iter().map(outcome).collect())
    };
    optimise(study, problem, budget, &mut simulate, &mut |_| {}).unwrap()
}

fn quantity(k: usize, kind: QuantityKind, bounds: (f64, f64), cost: CostModel) -> DesignQuantity {
    DesignQuantity {
        name: format!("x{k}"),
        variables: vec![k],
        kind,
        lower: bounds.0,
        upper: bounds.1,
        unit: ShownUnit::of(""),
        cost,
        cost_unit: 1.0,
        grades: vec![],
    }
}

fn target(limit_state: Option<usize>, reliability: f64) -> ReliabilityTarget {
    ReliabilityTarget {
        name: "R".into(),
        limit_state,
        checkpoint: 0,
        cycles: 1,
        reliability,
        confidence: None,
    }
}

/// Their problem from a study at the means 5 and 5, for reliability indices of 2, and its optimum.
static YOUN_CHOI: LazyLock<(StudyBasis, DesignProblem, OptimisationResult)> = LazyLock::new(|| {
    let (study, problem) = (youn_choi_study([5.0, 5.0]), youn_choi_problem(2.0));
    let found = run(&study, &problem, 70, &youn_choi);
    (study, problem, found)
});

/// Youn and Choi's margins: failed where g < 0.
fn youn_choi(x: &[f64]) -> Vec<f64> {
    let (a, b) = (x[0], x[1]);
    vec![
        1.0 - a * a * b / 20.0,
        1.0 - (a + b - 5.0).powi(2) / 30.0 - (a - b - 12.0).powi(2) / 120.0,
        1.0 - 80.0 / (a * a + 8.0 * b + 5.0),
    ]
}

#[test]
fn the_optimum_of_youn_and_choi_is_found_and_confirmed() {
    let (study, problem, found) = &*YOUN_CHOI;
    assert!(found.feasible && found.confirmed, "{}", markdown(found));
    // The true reliabilities of the active targets are as targeted.
    let inputs = problem.inputs(&study.problem.inputs, &found.values).unwrap();
    for g in 0..2 {
        let margins = |v: MatRef<'_, f64>| {
            let at = |j: usize| youn_choi(&inputs.from_independent_normals(&[v[(0, j)], v[(1, j)]]))[g];
            Mat::from_fn(1, v.ncols(), |_, j| at(j))
        };
        let lines = LineSampling::new(2, 1000, 1);
        let exact = lines.estimate(&lines.directions(1, &margins), &margins).probability;
        assert!((-standard_normal_quantile(exact) - 2.0).abs() < 0.02, "{g}: {exact} {}", markdown(found));
    }
    assert!(found.evaluations.study + found.evaluations.added <= 80, "{:?}", found.evaluations);
    let active: Vec<bool> = found.targets.iter().map(|target| target.active).collect();
    assert_eq!(active, [true, true, false]);
    // Stricter targets cost more.
    let costs: Vec<f64> = found.front.iter().filter_map(|point| point.cost).collect();
    assert!(costs.len() == 5 && costs.windows(2).all(|pair| pair[0] < pair[1]), "{costs:?}");
}

/// The sum of three lengths with weights; it fails above 1.
const WEIGHTS: [f64; 3] = [1.0, -2.0, 0.5];

fn stack(x: &[f64]) -> Vec<f64> {
    vec![x.iter().zip(WEIGHTS).map(|(x, w)| w * x).sum::<f64>() - 1.0]
}

fn stack_problem(reliability: f64) -> DesignProblem {
    let cost = |c1| CostModel::ReciprocalPower { c0: 0.0, c1, k: 1.0 };
    DesignProblem {
        quantities: (0..3)
            .map(|k| quantity(k, QuantityKind::Std, (0.02, 0.8), cost([1.0, 0.5, 2.0][k])))
            .collect(),
        targets: vec![target(None, reliability)],
        ..DesignProblem::default()
    }
}

#[test]
fn the_optimum_of_a_stack_is_that_of_the_closed_form() {
    let variables = vec![Distribution::normal(0.0, 0.2).unwrap(); 3];
    let study = study(&variables, 1, 12, &stack);
    let mut problem = stack_problem(0.98);
    let found = run(&study, &problem, 60, &stack);
    // sigma_k = K (c_k / w_k^2)^(1/3) with sum w^2 sigma^2 = 1 / beta^2.
    let beta = -standard_normal_quantile(0.02);
    let costs = [1.0, 0.5, 2.0];
    let shape = |k: usize| (costs[k] / WEIGHTS[k].powi(2)).cbrt();
    let length = (0..3).map(|k| (WEIGHTS[k] * shape(k)).powi(2)).sum::<f64>().sqrt();
    let exact: f64 = (0..3).map(|k| costs[k] * beta * length / shape(k)).sum();
    assert!(found.confirmed && (found.cost / exact - 1.0).abs() < 5e-3, "{exact} {}", markdown(&found));
    // The cost is proportional to beta: the multiplier is cost / beta.
    let multiplier = found.targets[0].multiplier;
    assert!((multiplier / (exact / beta) - 1.0).abs() < 0.02, "{multiplier}");

    // With grades, each quantity takes one of three widths, and the cheapest combination is that of trying all.
    let widths = [0.05, 0.1, 0.2, 0.4];
    for quantity in &mut problem.quantities {
        quantity.grades =
            widths.iter().map(|width| Grade { name: format!("{width}"), width: *width }).collect();
        (quantity.lower, quantity.upper) = (widths[0], widths[3]);
    }
    let all = (0..64usize).map(|i| [i % 4, i / 4 % 4, i / 16].map(|o| widths[o]));
    let feasible = |s: &[f64; 3]| (0..3).map(|k| (WEIGHTS[k] * s[k]).powi(2)).sum::<f64>() <= beta.powi(-2);
    let cost = |s: [f64; 3]| (0..3).map(|k| costs[k] / s[k]).sum::<f64>();
    let best = all.filter(feasible).map(cost).fold(f64::INFINITY, f64::min);
    let graded = run(&study, &problem, 60, &stack);
    assert!((graded.cost / best - 1.0).abs() < 1e-9, "{best} {}", markdown(&graded));
    assert!(graded.grades.is_some_and(|grades| grades.proved && grades.relaxed_cost < best));
}

#[test]
fn a_target_holds_with_its_confidence_at_a_price() {
    let variables = vec![Distribution::normal(0.0, 0.2).unwrap(); 3];
    let mut study = study(&variables, 1, 12, &stack);
    let error = 0.05;
    study.outcomes.iter_mut().for_each(|(_, outcome)| outcome.as_mut().unwrap().errors = vec![vec![error]]);
    let mut problem = stack_problem(0.98);
    let estimated = run(&study, &problem, 0, &stack);
    assert!(!estimated.targets[0].met && estimated.confidence_cost.is_none());
    problem.targets[0].confidence = Some(0.9);
    // The stated error is the reach of 95 %, and the cost in proportion to the reliability index.
    let price =
        estimated.cost * error * standard_normal_quantile(0.9) / crate::statistics::reliability::REACH;
    for budget in [60, 0] {
        let found = run(&study, &problem, budget, &stack);
        let text = markdown(&found);
        let own = &found.targets[0];
        assert!(own.met && own.state == Met && own.at_least.unwrap() >= 0.98, "{text}");
        let length = (0..3).map(|k| (WEIGHTS[k] * found.values[k]).powi(2)).sum::<f64>().sqrt();
        assert!(own.at_least.unwrap() < standard_normal_cdf(1.0 / length), "{text}");
        assert_eq!(found.confirmed, budget > 0, "{text}");
        let more = found.cost - estimated.cost;
        assert!(more > 0.9 * price && more < 2.0 * price, "{more} {price} {text}");
        assert!((found.confidence_cost.unwrap() / more - 1.0).abs() < 0.1, "{text}");
        assert!(
            text.contains("with 90.0\u{a0}% confidence") && text.contains("Price of the confidence"),
            "{text}"
        );
    }
    // Bounds within which only the estimate meets the target.
    problem.quantities.iter_mut().for_each(|q| q.lower = 0.2124);
    let found = run(&study, &problem, 0, &stack);
    assert!(!found.feasible && found.targets[0].state == NotMet, "{}", markdown(&found));
}

#[test]
fn without_a_feasible_design_the_nearest_one_is_named() {
    let variables = vec![Distribution::normal(0.0, 0.3).unwrap(); 3];
    let study = study(&variables, 1, 12, &stack);
    let mut problem = stack_problem(0.995);
    problem.quantities.iter_mut().for_each(|quantity| quantity.lower = 0.2);
    let found = run(&study, &problem, 60, &stack);
    let reached = standard_normal_cdf(1.0 / (0.2 * (1.0 + 4.0 + 0.25_f64).sqrt()));
    assert!(!found.feasible && found.confirmed, "{}", markdown(&found));
    assert!((found.targets[0].reliability - reached).abs() < 3.0 * found.targets[0].standard_error + 1e-4);
    assert!(found.values.iter().all(|value| (value - 0.2).abs() < 1e-3), "{:?}", found.values);
}

#[test]
fn a_design_variable_is_optimised_with_the_dimensions_that_follow_it() {
    let space = DesignSpace::new(
        SceneSource::builtin("four-bar").unwrap(),
        &["parameters.clearance=16 um..30 um".to_owned()],
    )
    .unwrap();
    let augmented = space.augmented().unwrap();
    // Fails where the clearance of the crank and half of the nominal one exceed 36 um, whatever the other variables.
    let margin = |x: &[f64]| vec![(x[2] + 0.5 * x[4]) / 36e-6 - 1.0];
    let scene = augmented.nominal();
    let laws: Vec<Distribution> =
        scene.variables.iter().map(|variable| variable.distribution.clone()).collect();
    let mut study = study(&laws, 1, 20, &margin);
    let (present, _) = space.present(&[]).unwrap();
    let own = Problem::of_changed_scene(present.nominal(), scene);
    study.problem = Problem { inputs: own.inputs, ..study.problem };
    let text = "[[quantities]]\nchange = \"parameters.clearance\"\nlower = \"16 um\"\nupper = \"30 um\"\n\
        cost = { model = \"reciprocal-power\", c1 = 100, k = 1, unit = \"um\" }\n\
        [[targets]]\nreliability = 0.99";
    let read = |text: &str| {
        let file = InputFile::parse(text, "p.toml")?;
        read_problem(&file, &present, Some((&space, scene)))
    };
    let mut problem = read(text).unwrap();
    problem.targets = vec![target(Some(0), 0.99)];
    let found = run(&study, &problem, 60, &margin);
    assert!(found.feasible && found.confirmed, "{}", markdown(&found));
    // The 0.99 quantile of the clearance lies at a fixed distance from its mean, which is the nominal one.
    let law = present.variables()[2].distribution.clone();
    let exact = (36e-6 - (law.quantile(0.99) - law.parent_mean())) / 1.5;
    assert!((found.values[0] / exact - 1.0).abs() < 2e-3, "{} {exact}", found.values[0]);
    assert_eq!(problem.changed_variables(), [2, 4]);

    let beyond = text.replace("\"30 um\"", "\"32 um\"");
    let said = read(&beyond).unwrap_err().to_string();
    assert!(said.contains("16 um to 30 um"), "{said}");
}

/// Two means of standard deviation 0.3 with equal linear costs, and the three targets of Youn and Choi.
fn youn_choi_problem(beta: f64) -> DesignProblem {
    let linear = || CostModel::Linear { c0: 0.0, c1: 1.0 };
    DesignProblem {
        quantities: (0..2).map(|k| quantity(k, QuantityKind::Mean, (0.5, 9.5), linear())).collect(),
        targets: (0..3).map(|g| target(Some(g), standard_normal_cdf(beta))).collect(),
        ..DesignProblem::default()
    }
}

/// A study at these means.
fn youn_choi_study(means: [f64; 2]) -> StudyBasis {
    study(&means.map(|mean| Distribution::normal(mean, 0.3).unwrap()), 3, 10, &youn_choi)
}

#[test]
fn issue_the_edge_of_the_trust_region_is_not_the_end_of_the_bounds() {
    let problem = youn_choi_problem(3.0);
    // From a design that misses the targets: the feasible ones lie beyond what its simulations support.
    let far = youn_choi_study([2.2, 1.8]);
    let found = run(&far, &problem, 0, &youn_choi);
    assert!(!found.confirmed && !found.supports_all() && !found.feasible, "{found:?}");
    // Both estimates of a reliability are those of the surrogates at the design found.
    for target in &found.targets {
        let error = target.standard_error.hypot(target.counted_standard_error);
        assert!((target.reliability - target.counted).abs() < 4.0 * error + 1e-4, "{target:?}");
    }
    let text = markdown(&found);
    assert!(text.contains("Within what the simulations support, no design meets every target"), "{text}");
    assert!(text.contains("trust region of x") && !text.contains("within the bounds**"), "{text}");
}

#[test]
fn a_design_that_misses_its_targets_leads_to_the_optimum_beyond_its_simulations() {
    let found = run(&youn_choi_study([2.2, 1.8]), &youn_choi_problem(3.0), 100, &youn_choi);
    // By quadrature.
    assert!(found.confirmed && (found.cost - 6.7289).abs() < 0.01, "{}", markdown(&found));
}

#[test]
fn issue_the_edge_of_the_trust_region_is_no_optimum() {
    // From a design with a reserve, the cheapest supported design is none that the targets decide.
    let found = run(&YOUN_CHOI.0, &youn_choi_problem(3.0), 0, &youn_choi);
    let text = markdown(&found);
    assert!(found.feasible && found.is_held() && found.front.is_empty(), "{text}");
    let edge = "8.200 on the edge of what the simulations support, which is no optimum";
    assert!(text.contains(edge), "{text}");
    assert!(text.contains("The search was stopped by the trust region of x0 (4.100 to 5.900)"), "{text}");
}

#[test]
fn issue_wide_bounds_are_crossed_by_visits_that_spread_over_them() {
    // A short column in logarithms of its sides, of spread 1e-4, between 5 x 15 and 15 x 25; published optimum 8.668 x 25.
    let column = |x: &[f64]| {
        let (b, h) = (x[0].exp(), x[1].exp());
        vec![4.0 * x[2] / (b * h * h * x[4]) + (x[3] / (b * h * x[4])).powi(2) - 1.0]
    };
    let normal = |mean: f64, std: f64| Distribution::normal(mean, std).unwrap();
    let laws = [
        normal(10_f64.ln(), 1e-4),
        normal(20_f64.ln(), 1e-4),
        normal(2000.0, 400.0),
        normal(500.0, 100.0),
        Distribution::lognormal(5.0, 0.5).unwrap(),
    ];
    let mut study = study(&laws, 1, 16, &column);
    let correlation = common::random::Correlation { first: 2, second: 3, coefficient: 0.5 };
    let copula = common::random::GaussianCopula::new(5, &[correlation]).unwrap();
    study.problem.inputs = InputModel::new(laws.to_vec(), copula);
    let linear = || CostModel::Linear { c0: 0.0, c1: 1.0 };
    let bounds = [(5_f64.ln(), 15_f64.ln()), (15_f64.ln(), 25_f64.ln())];
    let problem = DesignProblem {
        quantities: (0..2).map(|k| quantity(k, QuantityKind::Mean, bounds[k], linear())).collect(),
        targets: vec![target(None, standard_normal_cdf(2.5))],
        ..DesignProblem::default()
    };
    let found = run(&study, &problem, 100, &column);
    let sides: Vec<f64> = found.values.iter().map(|side| side.exp()).collect();
    assert!(found.feasible, "{sides:?} {}", markdown(&found));
    let off = (sides[0] - 8.668).abs().max((sides[1] - 25.0).abs());
    assert!(off < 0.05, "{sides:?} {}", markdown(&found));
}

#[test]
fn issue_a_target_is_met_only_by_the_whole_interval_with_the_numerical_errors() {
    let found = &YOUN_CHOI.2;
    let states = |found: &OptimisationResult| found.targets.iter().map(|t| t.state).collect::<Vec<_>>();
    // The optimum lies on two of the targets.
    assert_eq!(states(found), [MetWithinErrors, MetWithinErrors, Met], "{}", markdown(found));
    assert!(markdown(found).contains("Met within the stated errors only"), "{}", markdown(found));
    // Numerical errors that reach below the target of the third.
    let mut summary = crate::tests::test_study::study().summary;
    let row = &mut summary.reliability[0];
    row.cycles = 1;
    summary.limit_states = ["a", "b", "c"].map(str::to_owned).to_vec();
    row.reliability.insert("c".to_owned(), 0.999);
    let parts = ErrorParts { numerical: 0.26, ..ErrorParts::default() };
    row.parts.insert("c".to_owned(), parts);
    let reliability = found.targets[2].reliability;
    let judged = found.clone().with_errors_of(&summary, 0.0);
    assert_eq!(states(&judged), [MetWithinErrors; 3]);
    let [lower, upper] = judged.targets[2].interval;
    assert!(lower < reliability - 0.498 && upper >= reliability && !judged.targets[2].met, "{lower} {upper}");
    // Nine of ten units outside of what was simulated, of which all or none may fail.
    let unknown = found.clone().with_errors_of(&summary, 0.9).targets.swap_remove(2);
    assert!(unknown.interval == [(lower - 0.9).max(0.0), 1.0] && unknown.state == MetWithinErrors);
}
