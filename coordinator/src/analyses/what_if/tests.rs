//! Answers to what-ifs against studies of the changed scene and against the truth.

use super::*;
use crate::farm::evaluate::{Request, local::LocalEvaluator};
use crate::results::journal::InMemoryJournal;
use crate::results::progress::Silent;
use crate::results::store::{CampaignFile, CampaignMeta, FurtherEvaluations, StoredEvaluation};
use crate::results::summary::StudySummary;
use crate::study::{FurtherLearning, Observed, Settings, StoredOutcome, run};
use common::outputs::Evaluation;
use common::scene::{Scene, SceneSource};
use std::sync::LazyLock;

/// Two competing limit states of a bar: yield under a force of which the section loses a part, and deflection.
const SCENE: &str = r#"
scene = { name = "bar" }
simulator = { program = ["closure"] }
life = { cycles = 1000, checkpoint_every = 100 }
outputs = [{ name = "stress" }, { name = "deflection" }]
limit_states = [
  { name = "yield", output = "stress", threshold = 1.5 },
  { name = "sag", output = "deflection", threshold = 2.0 },
]
variables = [
  { name = "force", distribution = "normal", mean = 1, std = 0.1 },
  { name = "loss", distribution = "lognormal", mean = 0.3, std = 0.05 },
  { name = "stiffness", distribution = "normal", mean = 1, std = 0.08 },
]
"#;

fn histories(x: &[f64]) -> Vec<Vec<f64>> {
    let left = |k: i32| 1.0 - x[1] * f64::from(k) / 10.0;
    let stress = (1..=10).map(|k| x[0] / left(k)).collect();
    let deflection = (1..=10).map(|k| x[0] / (left(k).powi(2) * x[2])).collect();
    vec![stress, deflection]
}

fn settings(scene: &Scene) -> Settings {
    Settings { samples: 5000, initial: 15, max_evaluations: 40, ..Settings::from(scene) }
}

fn study(source: &SceneSource) -> (StudySummary, Vec<StoredOutcome>) {
    let scene = source.nominal();
    let cycles = scene.life.checkpoints();
    let simulate =
        |request: &Request| Ok(Evaluation::from_histories(cycles.clone(), histories(&request.sample)));
    let mut journal = InMemoryJournal::default();
    let mut evaluator = LocalEvaluator::new(1, simulate);
    let result = run(scene, &settings(scene), &mut evaluator, &mut journal, &mut Silent).unwrap();
    (result.summary, crate::tests::stored(&journal))
}

/// The study of the scene, which every question asks.
static STUDY: LazyLock<(StudySummary, Vec<StoredOutcome>)> =
    LazyLock::new(|| study(&SceneSource::parse(SCENE, "bar").unwrap()));

fn answer(sets: &[&str]) -> WhatIf {
    let source = SceneSource::parse(SCENE, "bar").unwrap();
    let (summary, outcomes) = &*STUDY;
    let sets: Vec<String> = sets.iter().map(ToString::to_string).collect();
    let changed = changed_scene(&source, &sets).unwrap();
    let settings = settings(source.nominal());
    let finished = FinishedStudy {
        scene: source.nominal(),
        settings: &settings,
        simulated: source.nominal(),
        outcomes,
        summary: Some(summary),
    };
    ask(&finished, changed.nominal()).unwrap()
}

#[test]
fn without_a_change_nothing_changes() {
    let found = answer(&[]);
    assert!(found.changes.is_empty() && !found.region.is_left());
    let agreement = found.agreement.clone().unwrap();
    assert!(agreement.largest_difference <= agreement.stated, "{agreement:?}");
    for row in &found.reliability {
        assert!(row.change.values().all(|change| change.value == 0.0), "{row:?}");
    }
    assert_eq!(found.before.lives, found.after.lives);
    let source = SceneSource::parse(SCENE, "bar").unwrap();
    let text = super::answer(&found, &[], 0, source.nominal(), "coordinator what-if x").text();
    assert!(text.starts_with("What if: nothing changes\n") && text.contains("none of them new"), "{text}");
}

/// R of the system for a changed scene, by counting over a large population of another seed.
fn truth(source: &SceneSource) -> Vec<f64> {
    use crate::statistics::design::{InputModel, Population};
    let scene = source.nominal();
    let (n, limits) = (50_000, [scene.limit_states[0].threshold, scene.limit_states[1].threshold]);
    let population = Population::draw(InputModel::from_scene(scene), n, 99);
    let mut alive = vec![0.0; 10];
    for j in 0..n {
        let found = histories(&population.physical(j));
        let fails = |k: &usize| found.iter().zip(limits).any(|(history, limit)| history[*k] >= limit);
        let first = (0..10).find(fails).unwrap_or(10);
        alive[..first].iter_mut().for_each(|r| *r += 1.0 / n as f64);
    }
    alive
}

#[test]
fn answers_are_true_within_their_errors_and_changes_too() {
    let base = SceneSource::parse(SCENE, "bar").unwrap();
    let before = truth(&base);
    for sets in [
        &["force.std=0.2"][..],
        &["loss.mean=0.4", "stiffness.mean=0.9"],
        &["yield.threshold=1.4", "correlation(force,loss)=0.5"],
        &["force.distribution=gumbel", "loss.std=0.025"],
        // Far outside of what was simulated.
        &["force.mean=1.5"],
    ] {
        let found = answer(sets);
        let changed =
            changed_scene(&base, &sets.iter().map(ToString::to_string).collect::<Vec<_>>()).unwrap();
        for (n, after) in truth(&changed).iter().enumerate() {
            let row = &found.after.reliability[n];
            let error = (after * (1.0 - after) / 50_000.0).sqrt() + 2e-5;
            let (r, stated) = (row.reliability["total"], row.standard_error["total"]);
            assert!((r - after).abs() < 4.0 * stated.hypot(error), "{sets:?} {n}: {r} {stated} {after}");
            let change = found.reliability[n].change["total"];
            let width = 0.5 * (change.upper.unwrap() - change.lower.unwrap());
            let difference = change.value - (after - before[n]);
            assert!(difference.abs() < 2.0 * width + 6.0 * error, "{sets:?} {n}: {change:?} {difference}");
        }
    }
}

#[test]
fn a_population_outside_of_the_simulations_is_named() {
    let inside = answer(&["force.std=0.05"]);
    assert!(!inside.region.is_left(), "{:?}", inside.region);
    let outside = answer(&["force.mean=1.6"]);
    assert!(outside.region.is_left() && outside.region.variables[0].name == "force");
    assert!(outside.region.outside_after > 0.9, "{:?}", outside.region);
    let json = json(&outside, 0);
    for key in
        ["reliability", "lives", "evaluations", "before", "changes", "change", "region", "first_failure"]
    {
        assert!(json.get(key).is_some(), "{key}");
    }
    let scene = SceneSource::parse(SCENE, "bar").unwrap();
    let sets = ["force.mean=1.6".to_owned()];
    let answer = super::answer(&outside, &sets, 0, scene.nominal(), "coordinator what-if x");
    let text = answer.text();
    let change = "force  normal, mean 1, std 0.1  normal, mean 1.6, std 0.1";
    for part in ["What if: force.mean=1.6", change, "Caution: "] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    assert_eq!(answer.all_figures().len(), 3);
}

/// Every outcome that a campaign file holds.
fn known(file: &CampaignFile) -> Vec<StoredOutcome> {
    let mut all = Vec::new();
    file.for_each_known(false, |StoredEvaluation { sample, outcome, .. }| {
        all.push(StoredOutcome { sample, outcome: outcome.map(Observed::from_evaluation) });
    })
    .unwrap();
    all
}

#[test]
fn further_simulations_reduce_the_error_and_leave_the_study_as_it_is() {
    let source = SceneSource::parse(SCENE, "bar").unwrap();
    let scene = source.nominal();
    let cycles = scene.life.checkpoints();
    let simulate =
        |request: &Request| Ok(Evaluation::from_histories(cycles.clone(), histories(&request.sample)));
    let settings = Settings { max_evaluations: 20, ..settings(scene) };
    let meta = CampaignMeta {
        scene: "bar".into(),
        scene_source: SCENE.into(),
        settings: serde_json::to_value(&settings).unwrap(),
        command: String::new(),
        version: String::new(),
    };
    let dir = tempfile::tempdir().unwrap();
    let mut file = CampaignFile::create(dir.path(), &meta, scene).unwrap();
    let mut evaluator = LocalEvaluator::new(1, simulate);
    let summary = run(scene, &settings, &mut evaluator, &mut file, &mut Silent).unwrap().summary;
    let of_study = known(&file);

    let changed = changed_scene(&source, &["force.mean=1.6".to_owned(), "loss.std=0.1".to_owned()]).unwrap();
    let asked = |outcomes: &[StoredOutcome]| {
        let study =
            FinishedStudy { scene, simulated: scene, settings: &settings, outcomes, summary: Some(&summary) };
        ask(&study, changed.nominal()).unwrap()
    };
    let further = FurtherLearning {
        correction: None,
        changed: changed.nominal(),
        studied: scene,
        settings: &settings,
        stored: &of_study,
        further: 8,
    };
    let mut journal = FurtherEvaluations(&mut file);
    further.learn(&mut evaluator, &mut journal, &mut Silent).unwrap();
    let all = known(&file);
    assert!((of_study.len() + 1..=of_study.len() + 8).contains(&all.len()), "{}", all.len());
    assert!(asked(&all).surrogate_error < asked(&of_study).surrogate_error);
    assert_eq!(file.count().unwrap(), of_study.len());
    // The study goes on as if they were not there: its requests find their outcomes, and the result is the same.
    let refuse = |_: &Request| panic!("every outcome is known");
    let again = run(scene, &settings, &mut LocalEvaluator::new(1, refuse), &mut file, &mut Silent).unwrap();
    assert_eq!(again.summary.reliability, summary.reliability);
    assert_eq!(known(&file).len(), all.len());
}

#[test]
fn common_random_numbers_narrow_the_interval_of_a_change() {
    let found = answer(&["force.mean=1.01"]);
    let n = found.before.reliability.iter().position(|row| row.reliability["total"] < 0.8).unwrap();
    let width = |range: crate::results::summary::ReliabilityRange| range.upper - range.lower;
    let both = [&found.before, &found.after].map(|s| width(s.reliability[n].interval["total"]));
    let change = found.reliability[n].change["total"];
    let of_change = change.upper.unwrap() - change.lower.unwrap();
    assert!(of_change < 0.7 * both[0].hypot(both[1]), "{of_change} {both:?}");
}

#[test]
fn issue_a_population_far_outside_of_the_simulations_had_narrow_intervals() {
    // Six standard deviations of the force beyond its mean: nothing was simulated there.
    let found = answer(&["force.mean=1.6", "yield.threshold=2.2", "sag.threshold=3"]);
    assert!(found.region.unknown_share() > 0.9, "{:?}", found.region);
    for row in &found.after.reliability {
        let range = row.interval_of("total").unwrap();
        assert!(range.upper - range.lower > 0.9, "{row:?}");
        let change =
            &found.reliability.iter().find(|change| change.cycles == row.cycles).unwrap().change["total"];
        let (lower, upper) = (change.lower.unwrap(), change.upper.unwrap());
        assert!(upper - lower > 0.9, "{change:?}");
    }
    for life in found.after.lives.iter().filter(|life| life.cycles.is_some()) {
        let cycles = life.cycles.unwrap();
        assert!(
            life.interval.lower <= cycles && life.interval.upper.is_none_or(|upper| upper >= cycles),
            "{life:?}"
        );
    }
    let source = SceneSource::parse(SCENE, "bar").unwrap();
    let text = super::answer(&found, &[], 0, source.nominal(), "coordinator what-if x").text();
    assert!(text.contains("allow that all or none of these"), "{text}");
    // A moderate change keeps the intervals of the surrogates.
    let near = answer(&["force.std=0.12"]);
    assert_eq!(near.region.unknown_share(), 0.0);
}

#[test]
fn issue_a_question_about_rare_failures_was_answered_by_a_plain_count() {
    let text = r#"
scene = { name = "bar" }
simulator = { program = ["closure"] }
life = { cycles = 100, checkpoint_every = 50 }
outputs = [{ name = "stress" }]
limit_states = [{ name = "yield", output = "stress", threshold = 1.6 }]
variables = [{ name = "force", distribution = "normal", mean = 1, std = 0.1 }]
"#;
    let source = SceneSource::parse(text, "bar").unwrap();
    let scene = source.nominal();
    let outcome = |k: i32| {
        let force = 1.0 + 0.1 * f64::from(k) + 0.02 * f64::from(k * k % 7);
        let outcome = Ok(Observed::exact(vec![vec![0.5 * force, force]]));
        StoredOutcome { sample: vec![force], outcome }
    };
    let outcomes: Vec<StoredOutcome> = (-7..=8).map(outcome).collect();
    let settings = Settings { is_rare: true, ..settings(scene) };
    let study =
        FinishedStudy { scene, settings: &settings, simulated: scene, outcomes: &outcomes, summary: None };
    // P_f = Phi(-6), Phi(-5) and one half.
    for (sets, pf, is_rare) in [("1.6", 9.866e-10, true), ("1.5", 2.867e-7, true), ("1", 0.5, false)] {
        let changed = changed_scene(&source, &[format!("yield.threshold={sets}")]).unwrap();
        let found = ask(&study, changed.nominal()).unwrap();
        assert_eq!(found.after.conditional.is_some(), is_rare, "{sets}");
        assert_eq!(found.after.unconditional_points() > found.after.population, is_rare, "{sets}");
        assert!(found.after.untested.is_none(), "{:?}", found.after.untested);
        let range = found.after.reliability[1].interval_of("total").unwrap();
        let (least, most) = (1.0 - range.upper, 1.0 - range.lower);
        assert!(least < 1.05 * pf && 0.95 * pf < most && most - least < 0.3 * pf, "{sets}: {least} {most}");
        let change = found.reliability[1].change["total"];
        let truth = 9.866e-10 - pf;
        let is_within =
            change.lower.unwrap() < 0.95 * truth + 1e-10 && change.upper.unwrap() > 1.05 * truth - 1e-10;
        assert!(is_within && change.upper.unwrap() - change.lower.unwrap() < 0.4 * pf, "{sets}: {change:?}");
        assert!(sets != "1.6" || change.value == 0.0 && change.upper == Some(0.0), "{change:?}");
    }
}
