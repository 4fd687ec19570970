//! Designs of a made-up response whose reliability is known in closed form, and of a mechanism's scene.

use super::*;
use crate::analyses::error::AnalysisError;
use crate::farm::evaluate::Request;
use crate::farm::evaluate::local::LocalEvaluator;
use crate::results::journal::InMemoryJournal;
use crate::results::progress::Silent;
use crate::study::{FurtherLearning, Settings, run};
use common::outputs::Evaluation;
use common::random::standard_normal_cdf;
use common::scene::SceneSource;

fn four_bar(ranges: &[&str]) -> Result<DesignSpace, common::scene::Faults> {
    let ranges: Vec<String> = ranges.iter().map(ToString::to_string).collect();
    DesignSpace::new(SceneSource::builtin("four-bar").unwrap(), &ranges)
}

#[test]
fn dimensions_that_follow_a_design_variable_cover_its_range_and_are_correlated_with_it() {
    let space = four_bar(&["parameters.clearance=18 um..30 um"]).unwrap();
    let augmented = space.augmented().unwrap();
    let scene = augmented.nominal();
    let base = SceneSource::builtin("four-bar").unwrap();
    assert_eq!(scene.variables.len(), base.variables().len() + 1);
    let at = |name: &str| scene.variables.iter().position(|v| v.name == name).unwrap();
    let (own, design) = (at("clearance_crank"), at("clearance"));
    let law = scene.variables[own].distribution.clone();
    // Half of the range is 6 um, the variable's own standard deviation 2 um.
    let std = (2e-6f64.powi(2) + 6e-6f64.powi(2) / 3.0).sqrt();
    assert!((law.parent_mean() - 24e-6).abs() < 1e-12 && (law.given_std() / std - 1.0).abs() < 1e-9);
    assert_eq!(scene.variables[design].distribution.support(), (18e-6, 30e-6));
    let [pair] = scene.correlations.as_slice() else { panic!("{:?}", scene.correlations) };
    assert_eq!([pair.first, pair.second], [own, design]);
    assert!((pair.coefficient / (0.99 * 6e-6 / 3f64.sqrt() / std) - 1.0).abs() < 1e-9);
    // Variables that no design changes keep their distributions.
    let friction = at("friction");
    assert_eq!(scene.variables[friction], base.variables()[friction]);
    // A design is the scene with this value, its design variable constant.
    let design = space.scene_at(&[20.0]).unwrap();
    let set = space.source_at(&[20.0]).unwrap();
    assert_eq!(design.variables[..4], set.nominal().variables[..]);
    assert!((design.variables[own].distribution.parent_mean() - 20e-6).abs() < 1e-15);
    assert_eq!(design.variables[4].distribution.support(), (20e-6, 20e-6));
}

#[test]
fn spreads_and_thresholds_need_no_further_variable() {
    let space = four_bar(&["friction.std=2 %..10 %", "wear.threshold=7 um..9 um"]).unwrap();
    let augmented = space.augmented().unwrap();
    assert_eq!(augmented.variables().len(), 4);
    let friction = |source: &SceneSource| source.variables()[3].distribution.given_std();
    assert!((friction(&augmented) / (0.1 * 0.05) - 1.0).abs() < 1e-9, "{}", friction(&augmented));
    let design = space.scene_at(&[4.0, 7.5]).unwrap();
    assert!((design.limit_states[0].threshold - 7.5e-6).abs() < 1e-15);
    assert_eq!(space.grid(3).len(), 9);
    assert_eq!(space.grid(3)[1], [2.0, 8.0]);
    assert_eq!(DesignSpace::from_stored(space.stored(), "study").unwrap().variables, space.variables);
}

#[test]
fn ranges_and_designs_that_cannot_be_are_named() {
    for (ranges, part) in [
        (vec!["parameters.clearence=18 um..30 um"], "clearence"),
        (vec!["parameters.clearance=18..30"], "expected a length"),
        (vec!["parameters.clearance=-5 um..30 um"], "radial_clearance"),
        (vec!["friction=0.04..0.06", "friction=0.04..0.06"], "two ranges"),
        (vec!["joints.crank.radial_clearance=18 um..30 um"], "clearance_crank"),
        (vec!["a", "b=1"], "b=1"),
    ] {
        let said = four_bar(&ranges).unwrap_err().to_string();
        assert!(said.contains(part), "{ranges:?}: {said}");
    }
    let space = four_bar(&["parameters.clearance=18 um..30 um"]).unwrap();
    let at = |text: &str| space.design(&[text.to_owned()]);
    assert_eq!(at("parameters.clearance=21 um"), Ok(vec![21.0]));
    for wrong in ["clearance=21 um", "parameters.clearance=31 um", "parameters.clearance=21 mm", "x"] {
        assert!(at(wrong).is_err(), "{wrong}");
    }
    assert!(space.design(&[]).is_err());
}

/// Wear w = t (1 + 0.1 a + 2 (m - 0.4)^2) at the share t of the life, with a standard normal a and the mean m of the variable
/// b, whose own scatter is small; it fails from 1 on. The best mean is 0.4.
fn bowl(range: &str) -> DesignSpace {
    let text = "scene = { name = \"bowl\" }\nsimulator = { program = [\"closure\"] }\n\
        life = { cycles = 1000, checkpoint_every = 100 }\noutputs = [{ name = \"w\" }]\n\
        limit_states = [{ name = \"wear\", output = \"w\", threshold = 1 }]\n\
        variables = [{ name = \"a\", distribution = \"normal\", mean = 0, std = 1 },\n\
        { name = \"b\", distribution = \"normal\", mean = 0, std = 0.02 }]";
    DesignSpace::new(SceneSource::parse(text, "bowl").unwrap(), &[range.to_owned()]).unwrap()
}

fn histories(x: &[f64]) -> Vec<Vec<f64>> {
    let at = |k: u32| f64::from(k) / 10.0 * (1.0 + 0.1 * x[0] + 2.0 * (x[1] - 0.4).powi(2));
    vec![(1..=10).map(at).collect()]
}

#[test]
fn a_design_at_the_limit_of_the_scene_is_not_answered_with_that_of_another() {
    let space = bowl("wear.threshold=0.8..1");
    let augmented = space.augmented().unwrap();
    let scene = augmented.nominal();
    let cycles = scene.life.checkpoints();
    let settings =
        Settings { samples: 10_000, initial: 12, max_evaluations: 30, seed: 5, ..Settings::from(scene) };
    let mut journal = InMemoryJournal::default();
    let evaluate =
        |request: &Request| Ok(Evaluation::from_histories(cycles.clone(), histories(&request.sample)));
    run(scene, &settings, &mut LocalEvaluator::new(1, evaluate), &mut journal, &mut Silent).unwrap();
    let outcomes = crate::tests::stored(&journal);
    let study = DesignStudy { space: &space, augmented: scene, settings: &settings };
    // 0.32 + 2 std^2 is the mean of 2 (b - 0.4)^2, 1.6 std its spread.
    let exact = |limit: f64, t: f64| standard_normal_cdf((limit / t - 1.3208) / 0.1_f64.hypot(0.032));
    for answer in answers(&study, &space.grid(5), &outcomes).unwrap() {
        for row in &answer.summary.reliability[4..9] {
            let (r, limit) = (row.reliability["total"], answer.values[0]);
            let exact = exact(limit, f64::from(row.cycles) / 1000.0);
            assert!((r - exact).abs() < 4.0 * row.standard_error["total"] + 0.004, "{limit}: {r} {exact}");
        }
    }
}

#[test]
fn one_study_answers_for_every_design_and_finds_the_best() {
    let space = bowl("b.mean=-0.5..1");
    let augmented = space.augmented().unwrap();
    let scene = augmented.nominal();
    let cycles = scene.life.checkpoints();
    let settings =
        Settings { samples: 10_000, initial: 12, max_evaluations: 30, seed: 5, ..Settings::from(scene) };
    let evaluate =
        |request: &Request| Ok(Evaluation::from_histories(cycles.clone(), histories(&request.sample)));
    let mut journal = InMemoryJournal::default();
    let mut evaluator = LocalEvaluator::new(1, evaluate);
    run(scene, &settings, &mut evaluator, &mut journal, &mut Silent).unwrap();
    let study = DesignStudy { space: &space, augmented: scene, settings: &settings };
    let grid = space.grid(7);
    let outcomes = crate::tests::stored(&journal);
    let before = outcomes.len();
    let mut reported = Vec::new();
    let mut simulate = |learning: &FurtherLearning<'_>| -> Result<_, AnalysisError> {
        learning.learn(&mut evaluator, &mut journal, &mut Silent)?;
        Ok(crate::tests::stored(&journal))
    };
    let mut progress = |error: f64, added: usize| reported.push((error, added));
    let refined = refine(&study, &grid, outcomes, 40, &mut simulate, &mut progress).unwrap();
    let outcomes = crate::tests::stored(&journal);
    assert_eq!(outcomes.len(), before + refined.added);
    assert!(refined.is_reached(), "{refined:?}");
    assert_eq!(reported.last(), Some(&(refined.largest_error, refined.added)));
    let found = answers(&study, &grid, &outcomes).unwrap();
    for answer in &found {
        let m = answer.values[0];
        for row in &answer.summary.reliability {
            // The scatter of b moves the wear by less than 0.002 on average: 2 std^2 = 0.0008 and its square.
            let t = f64::from(row.cycles) / 1000.0;
            let limit =
                |shift: f64| standard_normal_cdf((1.0 / t - 1.0 - 2.0 * (m - 0.4).powi(2) - shift) / 0.1);
            let r = row.reliability["total"];
            let slope = 4.0 * (m - 0.4).abs() * 0.02;
            let spread = standard_normal_cdf((1.0 / t - 1.0 - 2.0 * (m - 0.4).powi(2)) / 0.1f64.hypot(slope));
            let allowed = 4.0 * row.standard_error["total"] + (limit(0.0) - limit(0.004)).abs() + 0.002;
            assert!((r - spread).abs() <= allowed, "{m} {t}: {r} {spread} +- {allowed}");
        }
    }
    let best = Best::among(&found, Objective::Reliability { cycles: 900 }).unwrap();
    // The nearest designs of the grid are 0.25 and 0.5.
    assert_eq!(found[best.index].values, [0.5], "{best:?}");
    assert!(best.equal.contains(&best.index) && best.equal.len() < 4, "{best:?}");
    let life = Best::among(&found, Objective::Life { level: 0.5 }).unwrap();
    assert_eq!(found[life.index].values, [0.5], "{life:?}");

    let report = DesignReport {
        space: &space,
        answers: &found,
        objective: Objective::Life { level: 0.5 },
        best: Some(life),
        refined,
        simulations: (outcomes.len(), refined.added),
        command: "coordinator designs bowl".to_owned(),
    };
    let answer = answer(&report);
    let said = answer.text();
    assert!(said.contains("Longest life at R = 0.5") && said.contains("b.mean = 0.5"), "{said}");
    let document = json(&report);
    assert_eq!(document["best"]["design"]["b.mean"], 0.5);
    assert_eq!(document["designs"].as_array().unwrap().len(), 7);
    let names: Vec<String> = answer.all_figures().iter().map(|f| f.name.clone()).collect();
    assert!(names.starts_with(&["design-life".to_owned(), "design-reliability".to_owned()]), "{names:?}");
    assert_eq!(answer.files[0].1.lines().count(), 1 + 7 * 2 * 10);
}

#[test]
fn the_present_design_and_what_follows_a_design_variable() {
    let space = four_bar(&["parameters.clearance=18 um..28 um", "friction.mean=0.04..0.06"]).unwrap();
    // The scene itself has 30 um, outside of the range.
    let (present, others) = space.present(&["wear.threshold=9 um".to_owned()]).unwrap();
    assert_eq!(others, ["wear.threshold=9 um"]);
    let constant = present.variables()[4].distribution.clone();
    assert!(constant.is_constant() && (constant.mean() - 30e-6).abs() < 1e-18);
    let (set, others) = space.present(&["parameters.clearance=20 um".to_owned()]).unwrap();
    assert!(others.is_empty() && (set.variables()[4].distribution.mean() - 20e-6).abs() < 1e-18);
    let [own] = space.followers().unwrap().try_into().unwrap();
    // The mean of the random clearance is the nominal one; its standard deviation is given in um.
    assert_eq!((own.leader, own.variable, own.is_straight), (4, 2, true));
    assert!((own.mean - 1.0).abs() < 1e-9 && own.std.abs() < 1e-9, "{own:?}");
}
