//! Scenes with settings: what each means, and what is refused.

use super::*;
use common::scene::Scene;
use common::scene::quantity::{AngleUnit, Quantity};
use std::collections::BTreeSet;

const SCENE: &str = r#"
scene = { name = "bar" }
simulator = { program = ["closure"] }
life = { cycles = 300, checkpoint_every = 100 }
outputs = [{ name = "stress", unit = "MPa" }]
limit_states = [{ name = "yield", output = "stress", threshold = 250 }]
variables = [
  { name = "force", mean = "20 kN", std = "10 %" },
  { name = "gap", distribution = "uniform", lower = "1 um", upper = "3 um" },
  { name = "area", distribution = "normal", mean = "100 mm^2", std = "2 mm^2", unit = "mm^2" },
  { name = "fixed", distribution = "constant", mean = 3 },
]
correlations = [{ variables = ["force", "area"], coefficient = 0.3 }]
"#;

fn source() -> SceneSource {
    SceneSource::parse(SCENE, "bar").unwrap()
}

fn changed(settings: &[&str]) -> Result<SceneSource, Faults> {
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    changed_scene(&source(), &settings)
}

/// Mean, standard deviation and bounds of a variable of the changed scene.
fn law(settings: &[&str], variable: usize) -> (f64, f64, (f64, f64)) {
    let scene = changed(settings).unwrap();
    let law = scene.variables()[variable].distribution.clone();
    (law.parent_mean(), law.given_std(), law.support())
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs().max(1e-9)
}

#[test]
fn changes_have_the_meaning_that_they_have_in_a_scene_file() {
    // A relative standard deviation and bounds that are not named follow the mean.
    let (mean, std, (lower, _)) = law(&["force.mean = 30 kN"], 0);
    assert!(near(mean, 3e4) && near(std, 3e3) && near(lower, 3e4 - 9e3), "{mean} {std} {lower}");
    let (mean, std, _) = law(&["variables.force.std=1 kN"], 0);
    assert!(near(mean, 2e4) && near(std, 1e3));
    let (_, _, (lower, upper)) = law(&["force.lower=15 kN", "force.upper=\"25 kN\""], 0);
    assert!(near(lower, 1.5e4) && near(upper, 2.5e4));
    let scene = changed(&["yield.threshold=260", "correlation(area, force)=-0.2"]).unwrap();
    assert_eq!(scene.nominal().limit_states[0].threshold, 260.0);
    assert_eq!(scene.nominal().correlations.len(), 1);
    assert_eq!(scene.nominal().correlations[0].coefficient, -0.2);
    let ranked = changed(&["rank_correlation(gap,area)=0.5"]).unwrap();
    assert_eq!(ranked.nominal().correlations.len(), 2);
    assert_eq!(changed(&[]).unwrap().nominal(), source().nominal());
}

#[test]
fn keys_that_exclude_each_other_are_replaced() {
    // A uniform variable by its moments instead of its bounds: the mean stays.
    let (mean, std, _) = law(&["gap.std=0.5 um"], 1);
    assert!(near(mean, 2e-6) && near(std, 0.5e-6), "{mean} {std}");
    let (_, _, (lower, upper)) = law(&["gap.upper=4 um"], 1);
    assert!(near(lower, 1e-6) && near(upper, 4e-6));
    // Another distribution keeps mean and standard deviation.
    let (mean, std, _) = law(&["force.distribution=lognormal"], 0);
    assert!(near(mean, 2e4) && near(std, 2e3));
    let (mean, std, (lower, _)) = law(&["gap.distribution=normal"], 1);
    assert!(near(mean, 2e-6) && near(std, 2e-6 / 12f64.sqrt()) && lower == f64::NEG_INFINITY);
    let (mean, std, _) = law(&["area.distribution=uniform"], 2);
    assert!(near(mean, 1e-4) && near(std, 2e-6));
    let held = changed(&["area.distribution=constant", "correlation(force,area)=0"]);
    // A constant cannot be correlated, whatever the coefficient.
    assert!(held.unwrap_err().to_string().contains("is constant and cannot be correlated"));
    let (lower, upper) = law(
        &["area.distribution=triangular", "area.lower=95 mm^2", "area.mode=100 mm^2", "area.upper=105 mm^2"],
        2,
    )
    .2;
    assert!(near(lower, 9.5e-5) && near(upper, 1.05e-4));
}

#[test]
fn bounds_with_a_mode_and_samples_move_with_the_moments() {
    let row = "{ name = \"fixed\", distribution = \"constant\", mean = 3 },";
    let rows = "{ name = \"skew\", distribution = \"triangular\", lower = \"1 um\", mode = \"2 um\", upper = \"6 um\" },
        { name = \"bore\", samples = { unit = \"um\", values = [3, 4, 4, 9] } },";
    let source = SceneSource::parse(&SCENE.replace(row, rows), "bar").unwrap();
    let (before, sets) = (source.variables(), ["skew.mean=4 um", "skew.std=50 %", "bore.mean=8 um"]);
    let changed = changed_scene(&source, &sets.map(str::to_owned)).unwrap();
    for (k, mean, std) in [(3, 4e-6, 2e-6), (4, 8e-6, before[4].distribution.std())] {
        let (law, own) = (&changed.variables()[k].distribution, &before[k].distribution);
        assert_eq!(law.name(), own.name());
        assert!(near(law.mean(), mean) && near(law.std(), std), "{law:?}");
        for p in [0.01, 0.3, 0.9] {
            let moved = mean + (own.quantile(p) - own.mean()) / own.std() * std;
            assert!((law.quantile(p) - moved).abs() < 1e-15, "{law:?} at {p}");
        }
    }
    let refused = |set: &str| changed_scene(&source, &[set.to_owned()]).unwrap_err().to_string();
    assert!(
        refused("bore.std=-1 um").contains("> 0") && refused("bore.mean=1 N").contains("expected a force")
    );
}

#[test]
fn every_fault_is_reported_and_names_what_is_allowed() {
    let refused = |settings: &[&str]| changed(settings).unwrap_err().to_string();
    let all =
        refused(&["forze.std=1 kN", "force.sd=1 kN", "yeld.threshold=3", "area=3", "speed", "force.std="]);
    for part in [
        "--set: forze.std=1 kN: there is no variable \"forze\", did you mean \"force\"?",
        "\"sd\" is no key of a random variable; allowed: distribution, mean, std",
        "there is no limit state \"yeld\", did you mean \"yield\"?; there are: yield",
        "e.g. area.mean=... or area.std=...",
        "expected KEY=VALUE",
        "expected a value after =",
    ] {
        assert!(all.contains(part), "{part}\n{all}");
    }
    assert!(refused(&["force.std=-1 kN", "area.std=0 mm^2"]).starts_with("2 faults"));
    assert!(
        refused(&["force.std=1 mm"]).contains("variables.force.std: \"1 mm\" is a length"),
        "{}",
        refused(&["force.std=1 mm"])
    );
    assert!(refused(&["force.std=1 kN", "force.std=2 kN"]).contains("set twice"));
    assert!(refused(&["fixed.mean=4"]).contains("was constant in all simulations"));
    assert!(refused(&["correlation(force,force)=0.5"]).contains("two different random variables"));
    assert!(refused(&["force.distribution=gauss"]).contains("is unknown"));
    let four_bar = SceneSource::builtin("four-bar").unwrap();
    let found =
        changed_scene(&four_bar, &["parameters.crank_length=21 mm".to_owned()]).unwrap_err().to_string();
    assert!(found.contains("changes what is simulated"), "{found}");
}

fn set(settings: &[&str]) -> Result<SceneSource, Faults> {
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    scene_with(&SceneSource::builtin("four-bar").unwrap(), &settings)
}

/// A value as a scene writes it, in SI base units.
fn written(quantity: &Quantity, value: f64) -> String {
    let unit = quantity.dimension.base_units();
    match (quantity.angle, unit.as_str()) {
        (AngleUnit::Present, "") => format!("{value:e} rad"),
        (AngleUnit::Present, unit) if unit.starts_with("1/") => format!("{value:e} rad{}", &unit[1..]),
        _ => format!("{value:e} {unit}").trim_end().to_owned(),
    }
}

#[test]
fn issue_set_of_every_key_of_every_scene_is_the_edited_scene() {
    let (mut compared, mut refused) = (0, 0);
    // One key of a kind, such as the radial clearances of all joints of all scenes; every parameter.
    let mut seen = BTreeSet::new();
    for name in SceneSource::builtin_names() {
        let source = SceneSource::builtin(name).unwrap();
        for (key, quantity) in &source.quantities {
            let changed = |change: &String| change == key;
            if source.variables().iter().any(|variable| variable.changes.iter().any(changed)) {
                continue; // Refused: its random variable is to be set.
            }
            let words: Vec<&str> = key.split('.').collect();
            let kind = if words[0] == "parameters" {
                key.clone()
            } else {
                [words[0], words[words.len() - 1]].concat()
            };
            if !seen.insert(kind) {
                continue;
            }
            let setting = format!("{key}={}", written(quantity, quantity.value * 1.001));
            let Ok(edited) = scene_with(&source, std::slice::from_ref(&setting)) else {
                refused += 1;
                continue;
            };
            let set = source.resolve_with(&[source.parse_setting(&setting).unwrap()]).unwrap();
            // A limit is shown in the unit in which it is written, which changes nothing else.
            let edited = Scene { units: set.units.clone(), ..edited.nominal().clone() };
            assert_eq!(set, edited, "{name}: {setting}");
            compared += 1;
        }
    }
    assert!(compared > 60 && refused < compared / 10, "{compared} compared, {refused} refused");
}

#[test]
fn issue_a_set_scene_lost_its_comments() {
    let source = SceneSource::builtin("four-bar").unwrap();
    let found = set(&["parameters.width=11 mm", "friction.std=4 %", "wear.threshold=9 um"]).unwrap();
    let differ = found.text().lines().zip(source.text().lines()).filter(|(a, b)| a != b);
    assert_eq!(differ.count(), 3, "{}", found.text());
    assert_eq!(set(&["parameters.width=10 mm"]).unwrap().digest(), source.digest());
}

#[test]
fn variables_and_thresholds_are_set_by_their_names() {
    let found =
        set(&["friction=0.06", "wear.threshold=9 um", "load_torque.std=5 %", "parameters.width=11 mm"])
            .unwrap();
    let scene = found.nominal();
    let law = |name: &str| scene.variables.iter().find(|v| v.name == name).unwrap().distribution.clone();
    assert!((law("friction").parent_mean() - 0.06).abs() < 1e-12);
    assert!((law("load_torque").given_std() - 0.04).abs() < 1e-12);
    assert!((scene.limit_states[0].threshold - 9e-6).abs() < 1e-15);
}

#[test]
fn every_fault_of_every_setting_is_reported() {
    let said = set(&[
        "parameters.friction=0.06",
        "parameters.width=3 kg",
        "nothing=1",
        "wear.threshhold=2",
        "friction=x",
        "parameters.clearence=25 um",
    ])
    .unwrap_err()
    .to_string();
    for part in [
        "did you mean \"parameters.clearance\"",
        "set friction or friction.mean instead",
        "parameters.width=3 kg",
        "nothing=1",
        "wear.threshhold=2",
    ] {
        assert!(said.contains(part), "{part}\n{said}");
    }
    assert!(set(&["friction=x"]).is_err() && set(&["parameters.width=-3 mm"]).is_err());
}

#[test]
fn issue_a_spread_could_not_be_set_where_a_fit_gave_it() {
    let fitted = |document: &mut Table| {
        let row = row(document, "clearance_crank").unwrap();
        row.retain(|key, _| key != "std" && key != "mean");
        row.extend(
            [("fit", "H7/e8"), ("diameter", "10 mm")].map(|(key, value)| (key.to_owned(), value.into())),
        );
    };
    let source = SceneSource::builtin("four-bar").unwrap().edited("fitted", fitted).unwrap();
    let k = source.variable("clearance_crank").unwrap();
    let law = |source: &SceneSource| source.variables()[k].distribution.clone();
    let found = redistributed(&source, &["clearance_crank.std=1 um".to_owned()]).unwrap();
    assert!(near(law(&found).given_std(), 1e-6));
    assert!(near(law(&found).parent_mean(), law(&source).parent_mean()));
}
