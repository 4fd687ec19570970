//! Scenes that nobody would write: the text of the built-in scenes spoilt at random, and random small mechanisms.
//! Whatever parses is either refused with a message, or runs to a finite result or to a failure with a message,
//! within its bound of steps.

use common::accuracy::Accuracy;
use common::scene::SceneSource;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use toml::Value;
use worker::simulate::{SimulateOptions, simulate_counted};

/// A twentieth of what `draft` allows: nothing here need come to its end, but most of what is valid does.
const STEPS_BOUND: u64 = 20_000;

/// What became of a text.
#[derive(Debug, Clone, Copy, PartialEq)]
enum End {
    Refused,
    Failed,
    Simulated,
}

/// Parses and simulates; the assertions of this file.
fn survive(text: &str) -> End {
    let source = match SceneSource::parse(text, "fuzzed") {
        Ok(source) => source,
        Err(faults) => {
            assert!(!faults.0.is_empty() && faults.0.iter().all(|f| !f.to_string().is_empty()), "{text}");
            return End::Refused;
        }
    };
    let mut scene = source.nominal().clone();
    scene.life.checkpoint_every = scene.life.checkpoint_every.min(1000);
    scene.life.cycles = scene.life.checkpoint_every;
    scene.life.settle_cycles = scene.life.settle_cycles.min(1);
    let accuracy = Accuracy { steps_bound: STEPS_BOUND, ..Accuracy::draft() };
    let (result, steps) = simulate_counted(&scene, &accuracy, SimulateOptions::WITH_FIRST_CYCLE);
    let end = match result {
        Ok(evaluation) => {
            let numbers = evaluation.histories.iter().chain(&evaluation.errors).flatten();
            assert!(numbers.clone().all(|x| x.is_finite()), "{evaluation:?}\n{text}");
            assert!(evaluation.errors.iter().flatten().all(|x| *x >= 0.0), "{evaluation:?}\n{text}");
            End::Simulated
        }
        Err(failure) => {
            let message = failure.to_string();
            assert!(
                !message.is_empty() && !message.contains("NaN") && !message.contains("inf "),
                "{message}\n{text}"
            );
            End::Failed
        }
    };
    // Ten cycles at most in this life, of three spans each, two of them probed with up to four cycles at finer
    // steps; every island within the bound, and no step refused more often than tenfold shrinking allows.
    let islands = scene.bodies.len() as u64;
    assert!(steps <= 60 * islands * 10 * STEPS_BOUND, "{steps} steps\n{text}");
    end
}

#[test]
fn what_is_not_spoilt_is_simulated() {
    let ends = SceneSource::builtin_names().into_iter().map(|name| {
        let builtin = SceneSource::builtin(name).expect("built in");
        (name, survive(builtin.text()))
    });
    let ends: Vec<(&str, End)> = ends.collect();
    assert!(ends.iter().all(|(_, end)| *end == End::Simulated), "{ends:?}");
}

/// One way to spoil a document; which value it meets is told by a number.
#[derive(Debug, Clone)]
enum Spoil {
    Scale(i32),
    Negate,
    Replace(&'static str),
    Remove,
    Swap(usize),
    RemoveRow,
    RepeatRow,
}

fn spoil() -> impl Strategy<Value = (usize, Spoil)> {
    let kind = prop_oneof![
        6 => (-9..9_i32).prop_map(Spoil::Scale),
        2 => Just(Spoil::Negate),
        2 => prop::sample::select(vec!["0 mm", "0", "", "1e308 m", "inf", "nan", "-1", "1/0", "no such", "Grüße", "9e9 GPa"])
            .prop_map(Spoil::Replace),
        2 => Just(Spoil::Remove),
        2 => any::<usize>().prop_map(Spoil::Swap),
        1 => Just(Spoil::RemoveRow),
        1 => Just(Spoil::RepeatRow),
    ];
    (any::<usize>(), kind)
}

/// Every value of the document that holds no others, in order.
fn leaves<'v>(value: &'v mut Value, found: &mut Vec<&'v mut Value>) {
    match value {
        Value::Table(table) => table.iter_mut().for_each(|(_, v)| leaves(v, found)),
        Value::Array(rows) => rows.iter_mut().for_each(|v| leaves(v, found)),
        leaf => found.push(leaf),
    }
}

/// Every table and every array that is not empty, in order, each shown to `visit`.
fn containers(value: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    match value {
        Value::Table(table) => table.iter_mut().for_each(|(_, v)| containers(v, visit)),
        Value::Array(rows) => rows.iter_mut().for_each(|v| containers(v, visit)),
        _ => return,
    }
    visit(value);
}

/// The text with the number it starts with changed, e.g. `1.5 mm` or a plain number.
fn with_number(value: &Value, change: impl Fn(f64) -> f64) -> Option<Value> {
    match value {
        Value::Integer(n) => Some(Value::Integer(change(*n as f64) as i64)),
        Value::Float(x) => Some(Value::Float(change(*x))),
        Value::String(text) => {
            let number = text.split(' ').next()?;
            let changed = change(number.parse().ok()?);
            Some(Value::String(format!("{changed:e}{}", &text[number.len()..])))
        }
        _ => None,
    }
}

fn apply(document: &mut Value, at: usize, spoil: &Spoil) {
    match spoil {
        Spoil::Scale(_) | Spoil::Negate => {
            let factor = if let Spoil::Scale(power) = spoil { 10_f64.powi(*power) } else { -1.0 };
            let mut all = Vec::new();
            leaves(document, &mut all);
            let numbers: Vec<_> =
                all.into_iter().filter_map(|v| Some((with_number(v, |x| x * factor)?, v))).collect();
            let count = numbers.len().max(1);
            if let Some((new, old)) = numbers.into_iter().nth(at % count) {
                *old = new;
            }
        }
        Spoil::Replace(text) => {
            let mut all = Vec::new();
            leaves(document, &mut all);
            let count = all.len().max(1);
            if let Some(value) = all.into_iter().nth(at % count) {
                *value = Value::String((*text).to_owned());
            }
        }
        Spoil::Swap(other) => {
            let mut all = Vec::new();
            leaves(document, &mut all);
            let (a, b) = (at % all.len().max(1), other % all.len().max(1));
            if a != b {
                let kept = all[a].clone();
                *all[a] = all[b].clone();
                *all[b] = kept;
            }
        }
        Spoil::Remove | Spoil::RemoveRow | Spoil::RepeatRow => {
            let mut count = 0;
            containers(document, &mut |c| count += usize::from(fits(c, spoil)));
            let mut left = at % count.max(1);
            containers(document, &mut |c| {
                if !fits(c, spoil) {
                    return;
                }
                if left == 0 {
                    change_one(c, at, spoil);
                }
                left = left.wrapping_sub(1);
            });
        }
    }
}

fn fits(container: &Value, spoil: &Spoil) -> bool {
    match container {
        Value::Table(table) => matches!(spoil, Spoil::Remove) && !table.is_empty(),
        Value::Array(rows) => !matches!(spoil, Spoil::Remove) && !rows.is_empty(),
        _ => false,
    }
}

fn change_one(container: &mut Value, at: usize, spoil: &Spoil) {
    match container {
        Value::Table(table) => {
            let key = table.keys().nth(at % table.len()).cloned().expect("not empty");
            table.remove(&key);
        }
        Value::Array(rows) => {
            let row = at % rows.len();
            if matches!(spoil, Spoil::RepeatRow) {
                rows.push(rows[row].clone());
            } else {
                rows.remove(row);
            }
        }
        _ => {}
    }
}

/// A crank, a rod on its pin, and a spring or a weight that pulls at the rod; sizes over many decades.
fn small_scene() -> impl Strategy<Value = String> {
    let decades = |low: f64, high: f64| (low..high).prop_map(|power: f64| 10_f64.powf(power));
    let sizes =
        (decades(-3.0, 0.0), decades(-3.0, 0.0), decades(-6.0, 1.0), decades(-1.0, 3.0), decades(-3.5, -1.0));
    let hinge = (decades(-4.0, -2.0), decades(6.0, 12.0), 0.0..0.5_f64, decades(-16.0, -9.0), 4..60_usize);
    let words = (any::<bool>(), any::<bool>(), 0.0..360.0_f64, decades(-1.0, 5.0));
    (sizes, hinge, words).prop_map(|(sizes, hinge, words)| {
        let (crank, rod, mass, turns, clearance) = sizes;
        let (radius, modulus, friction, wear, points) = hinge;
        let clearance = clearance * radius;
        let (foundation, weight, angle, stiffness) = words;
        let law = if foundation { "foundation" } else { "local-hertz" };
        let gravity = if weight { "gravity = [\"0 m/s^2\", \"-9.81 m/s^2\"]" } else { "" };
        let numbers = [
            ("clearance", clearance),
            ("crank", crank),
            ("half", 0.5 * rod),
            ("inertia", mass * rod * rod / 12.0),
            ("mass", mass),
            ("modulus", modulus),
            ("radius", radius),
            ("reach", crank + rod),
            ("rod", rod),
            ("stiffness", stiffness),
            ("turns", turns),
            ("wear", wear),
        ];
        let text = include_str!("scenes/small.toml").replace("@law@", law).replace("@gravity@", gravity);
        let text = text.replace("@points@", &points.to_string()).replace("@friction@", &friction.to_string());
        let text = text.replace("@angle@", &angle.to_string());
        let replaced = |text: String, (name, value): &(&str, f64)| {
            text.replace(&format!("@{name}@"), &format!("{value:e}"))
        };
        numbers.iter().fold(text, replaced)
    })
}

/// A fixed seed: the same cases on every run.
fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(20),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(config(180))]

    #[test]
    fn spoilt_scenes_are_refused_or_survive(which in any::<usize>(), spoils in prop::collection::vec(spoil(), 1..4)) {
        let names = SceneSource::builtin_names();
        let builtin = SceneSource::builtin(names[which % names.len()]).expect("built in");
        let mut document = Value::Table(builtin.text().parse().expect("valid TOML"));
        spoils.iter().for_each(|(at, spoil)| apply(&mut document, *at, spoil));
        survive(&toml::to_string(&document).expect("a document"));
    }
}

proptest! {
    #![proptest_config(config(40))]

    #[test]
    fn small_random_scenes_survive(text in small_scene()) {
        survive(&text);
    }
}
