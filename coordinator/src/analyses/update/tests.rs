use super::result::FleetReport;
use super::*;
use crate::statistics::design::Population;
use crate::study::{LifeModel, Observed, Settings, StoredOutcome, learn_from_results};
use common::scene::{Faults, SceneSource};
use std::sync::LazyLock;

/// A wear that grows in proportion to time, from an offset, and another output that no limit state watches.
const SCENE: &str = r#"
scene = { name = "bushing" }
simulator = { program = ["closure"] }
life = { cycles = 2000, checkpoint_every = 100 }
outputs = [{ name = "wear", unit = "um" }, { name = "play", unit = "um" }]
limit_states = [{ name = "worn", output = "wear", threshold = 30 }]
variables = [
    { name = "rate", mean = 25, std = 3 },
    { name = "offset", mean = 2, std = 0.5 },
]
"#;

fn wear(x: &[f64], n: f64) -> f64 {
    x[1] + x[0] * n / 1000.0
}

/// The scene, the summary's settings and the predictor of the study, from 40 simulations.
static STUDY: LazyLock<(SceneSource, Settings, LifeModel)> = LazyLock::new(|| studied(SCENE));

fn studied(text: &str) -> (SceneSource, Settings, LifeModel) {
    let source = SceneSource::parse(text, "bushing").unwrap();
    let scene = source.nominal();
    let settings = Settings { samples: 2000, initial: 40, max_evaluations: 40, ..Settings::from(scene) };
    let inputs = crate::statistics::design::InputModel::from_scene(scene);
    let population = Population::draw(inputs, 40, 9);
    let cycles = scene.life.checkpoints();
    let simulate = |j: usize| {
        let sample = population.physical(j);
        let history =
            |of: &dyn Fn(f64) -> f64| cycles.iter().map(|n| of(f64::from(*n))).collect::<Vec<f64>>();
        let histories = vec![history(&|n| wear(&sample, n)), history(&|n| 2.0 * sample[1] - n / 1000.0)];
        let start = vec![Some(sample[1]), Some(2.0 * sample[1])];
        let outcome = Ok(Observed { start, ..Observed::exact(histories) });
        StoredOutcome { sample, outcome }
    };
    let stored: Vec<StoredOutcome> = (0..40).map(simulate).collect();
    let learned = learn_from_results(scene, scene, &settings, &stored).unwrap();
    let model = LifeModel::new(scene, &learned);
    (source, settings, model)
}

fn updated(text: &str, particles: usize) -> FleetReport {
    let (source, settings, model) = &*STUDY;
    let units = unit_file::parse(text, "units.csv", source, model, None).unwrap().units;
    let summary = crate::tests::test_study::study().summary;
    let mut fleet = FleetSettings::new(settings.seed);
    fleet.population = 20_000;
    fleet.monte_carlo.particles = particles;
    update(source.nominal(), &summary, model, &units, &fleet)
}

/// Posterior of rate and offset under one measurement of the wear at n cycles: mean, and covariance (rr, ro, oo).
fn conjugate(n: f64, y: f64, error: f64) -> ([f64; 2], [f64; 3]) {
    let (t, vr, vo) = (n / 1000.0, 9.0, 0.25);
    let variance = t * t * vr + vo + error * error;
    let (gr, go) = (t * vr / variance, vo / variance);
    let off = y - (2.0 + 25.0 * t);
    ([25.0 + gr * off, 2.0 + go * off], [vr - gr * t * vr, -gr * vo, vo - go * vo])
}

#[test]
fn a_measured_wear_has_the_conjugate_closed_form() {
    let report =
        updated("unit,cycles,quantity,value,error\nA, 400, wear, 14.0, 1 um\nB,400,wear,12,0.01", 8000);
    for (unit, (y, error)) in report.units.iter().zip([(14.0, 1.0), (12.0, 0.01)]) {
        let (mean, covariance) = conjugate(400.0, y, error);
        let [rate, offset] = [&unit.variables[0], &unit.variables[1]];
        assert!((rate.mean / mean[0] - 1.0).abs() < 0.01, "{rate:?} {mean:?}");
        assert!((offset.mean / mean[1] - 1.0).abs() < 0.01, "{offset:?} {mean:?}");
        let error = 4.0 / (2.0 * unit.effective_size).sqrt();
        assert!((rate.std / covariance[0].sqrt() - 1.0).abs() < error, "{rate:?} {covariance:?}");
        assert!((offset.std / covariance[2].sqrt() - 1.0).abs() < error, "{offset:?} {covariance:?}");
        // The wear at 900 cycles is normal, and R(900) the probability that it is below 30.
        let (mean_900, t) = (mean[1] + 0.9 * mean[0], 0.9);
        let std = (covariance[2] + 2.0 * t * covariance[1] + t * t * covariance[0]).sqrt();
        let exact = common::random::standard_normal_cdf((30.0 - mean_900) / std);
        let row = unit.reliability.iter().find(|row| row.cycles == 900).unwrap();
        let bound = 4.0 * row.standard_error["total"];
        assert!((row.reliability["total"] - exact).abs() < bound, "{row:?} {exact}");
        assert!(unit.warning.is_none() && unit.reliability[0].reliability["total"] > 0.99, "{unit:?}");
    }
    assert_eq!(report.units[0].stages, 0);
    assert!(report.units[1].stages > 0 && report.units[1].acceptance.unwrap() > 0.2);
    let answer = answer(&report);
    let text = answer.text();
    assert!(text.contains("sequential Monte Carlo") && text.contains("rate"), "{text}");
    assert_eq!(answer.files[0].1.lines().count(), 3);
    let figures = |report: &FleetReport| {
        let drawn = super::answer(report).figures;
        drawn.into_iter().map(|figure| figure.name).collect::<Vec<_>>()
    };
    assert_eq!(figures(&report), ["remaining-life", "updated-reliability"]);
    let many = FleetReport { units: vec![report.units[0].clone(); 20], ..report };
    assert_eq!(figures(&many), ["remaining-life"]);
}

#[test]
fn survival_lengthens_and_an_improbable_value_is_warned_of() {
    let report = updated(
        "A,1100,survived\nB,400,wear,25,0.1\nC,,offset,1.0,0.01\nC,500,play,1.5,0.1\nD,900,failed\nE,1650,survived\nF,2000,survived\n",
        1200,
    );
    let rate = |k: usize| report.units[k].variables[0].mean;
    // Survival means slow wear, failure by 900 cycles fast wear.
    assert!(rate(0) < 24.5 && rate(4 - 1) > 28.0, "{} {}", rate(0), rate(3));
    let warning = report.units[1].warning.as_ref().unwrap();
    assert!(warning.contains("wear at 400 cycles (line 2) is improbable"), "{warning}");
    assert!((report.units[2].variables[1].mean - 1.0).abs() < 0.01 && report.units[2].warning.is_none());
    assert_eq!(report.units[3].failed_by, Some(900.0));
    // Survival of 1650 cycles is rare: moved particles, none of which has failed; the least rate, 16, fails at 1781 cycles.
    let rare = &report.units[4];
    assert!(rare.stages > 0 && 1.0 - rare.reliability[0].reliability["total"] < 1e-12, "{rare:?}");
    assert!(rare.remaining.p95.is_some_and(|left| left < 150.0), "{:?}", rare.remaining);
    // No unit lives 2000 cycles, which a number of points cannot show.
    let warning = report.units[5].warning.as_ref().unwrap();
    assert!(warning.contains("line 7) "), "{warning}");
    let bound = warning.split("below ").nth(1).and_then(|rest| rest.split([' ', ',']).next()).unwrap();
    assert!(bound.parse::<f64>().unwrap() >= 1.4e-4 && !warning.contains("impossible"), "{warning}");
}

#[test]
fn every_fault_of_a_file_is_named_with_line_and_column() {
    let (source, _, model) = &*STUDY;
    let faults = |text: &str| {
        crate::tests::located(unit_file::parse(text, "units.csv", source, model, None).unwrap_err())
    };
    for [row, expected] in crate::tests::rows("every_fault_of_a_file_is_named_with_line_and_column") {
        let said = faults(row);
        assert!(said.contains(expected), "{row}: {said}");
    }
    let both = faults("A,400,depth,1,1\n# a comment\n\nB,x,wear,1,1");
    assert!(both.contains("line 1") && both.contains("line 4"), "{both}");
    // A comma within a number shifts what follows, which is not judged.
    let shifted = faults("A,400,wear,9,000,1");
    assert!(
        shifted.starts_with("line 1, column error: 6 cells") && shifted.lines().count() == 1,
        "{shifted}"
    );
    // All faults of a row, and of what was meant.
    let row = faults(",4000,waer,1 N,0");
    for column in ["unit", "cycles", "quantity", "value", "error"] {
        assert!(row.contains(&format!("line 1, column {column}: ")), "{column} {row}");
    }
}

#[test]
fn issue_no_quantile_is_stated_from_a_fraction_of_a_point() {
    let mut too_few = 0;
    for error in ["1e-4", "1e-6", "1e-8"] {
        let report = updated(&format!("A,400,wear,12,{error}\n"), 500);
        let unit = &report.units[0];
        // Without a point that agrees there is no result; with ten, it is one.
        if unit.reliability.is_empty() || unit.effective_size >= 10.0 {
            continue;
        }
        too_few += 1;
        assert!(
            !unit.resolved
                && unit.remaining.p50.is_none()
                && unit.lives.iter().all(|life| life.cycles.is_none())
        );
        let said = answer(&report).text();
        assert!(
            said.contains("not resolved") && said.contains("warning: unit A: the effective sample size"),
            "{said}"
        );
    }
    assert!(too_few > 0);
}

#[test]
fn ten_units_that_cannot_be_are_named_in_one_go() {
    // With bounds of the variables.
    let lognormal = "distribution = \"lognormal\", mean = 25, std = 3";
    let bounded = "distribution = \"truncated-normal\", mean = 2, std = 0.5, lower = 0.5, upper = 3.5";
    let text = SCENE.replace("mean = 25, std = 3", lognormal).replace("mean = 2, std = 0.5", bounded);
    let (source, _, model) = studied(&text);
    let rows = "A,400,failed,worn\nA,500,wear,15,1\n\
        B,400,failed,worn,5\nB,600,survived\n\
        C,400,wear,10,0.1\nC,400,wear,11,0.1\n\
        D,,offset,2,0.01\nD,,offset,2.2,0.01\n\
        E,,offset,4,0.1\n\
        F,,rate,-3,0.5\n\
        G,700,wear,33,0.5\nG,900,survived\n\
        H,400,failed\nH,700,failed\n\
        I,5000,survived\n\
        J,300,play,1,0.1\nJ,300,play,4,0.1\nJ,300,survived\n";
    for designs in [None, Some(&[][..])] {
        let Faults(faults) = unit_file::parse(rows, "units.csv", &source, &model, designs).unwrap_err();
        let said: Vec<String> = faults
            .iter()
            .map(|fault| format!("{}: {}", fault.location.as_ref().unwrap().line, fault.kind))
            .collect();
        let all = said.join("\n");
        assert_eq!(said.len(), 10, "{all}");
        for (line, what) in [
            (2, "unit A had failed by 400 cycles (line 1)"),
            (4, "unit B had failed by 400 cycles (line 3)"),
            (6, "wear of unit C contradicts line 5"),
            (8, "offset of unit D contradicts line 7"),
            (9, "unit E is of another population; allowed: 0.5 to 3.5"),
            (10, "unit F is of another population; allowed: 0 to inf"),
            (11, "wear of unit G is beyond the threshold of worn"),
            (14, "unit H had failed by 400 cycles (line 13)"),
            (15, "allowed: a number of cycles from 0 to 2000"),
            (17, "play of unit J contradicts line 16"),
        ] {
            let found = said.iter().any(|one| one.starts_with(&format!("{line}: ")) && one.contains(what));
            assert!(found, "{line}: {what}: {all}");
        }
    }
}

#[test]
fn issue_a_probability_that_no_simulation_has_tested_was_left_out() {
    use crate::results::summary::UntestedRow;
    let (source, settings, model) = &*STUDY;
    let units = unit_file::parse("A,1000,survived\n", "units.csv", source, model, None).unwrap().units;
    let mut summary = crate::tests::test_study::study().summary;
    let fleet = FleetSettings { population: 2000, ..FleetSettings::new(settings.seed) };
    let caution = |summary: &_| {
        let report = update(source.nominal(), summary, model, &units, &fleet);
        (report.caution.clone(), answer(&report).text())
    };
    assert_eq!(caution(&summary).0, None);
    let curves = vec!["worn".to_owned(), "total".to_owned()];
    summary.untested = Some(UntestedRow { curves, samples: 11, bound: 0.2384, predicted: 1e-9 });
    let (said, text) = caution(&summary);
    assert!(
        said.as_ref().is_some_and(|said| said.contains("P_f < 0.238 (95 %)") && text.contains(said)),
        "{text}"
    );
}
