//! What a scene determines of a study, as written to `summary.json`: random variables, limit states and the hash of the text.

use common::random::RandomVariable;
use common::scene::expression::read_unit;
use common::scene::quantity::{AngleUnit, Dimension};
use common::scene::{Fails, LimitState, OutputUnit, Scene};
use ring::digest::{SHA256, digest};
use serde::{Deserialize, Serialize};

/// A random variable of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct VariableRow {
    /// Name of the variable.
    pub name: String,
    /// Word of its distribution in scenes, e.g. `truncated-normal`.
    pub distribution: String,
    /// Mean; of the parent for a truncated normal [unit of the row].
    pub mean: f64,
    /// Standard deviation; of the parent for a truncated normal, 0 for a constant [unit of the row].
    pub std: f64,
    /// Smallest value; absent without a bound [unit of the row].
    pub lower: Option<f64>,
    /// Largest value; absent without a bound [unit of the row].
    pub upper: Option<f64>,
    /// SI unit of the values; an input of a simulator with a unit that is only displayed has that one.
    pub unit: String,
}

/// A limit state of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LimitRow {
    /// Name of the limit state.
    pub name: String,
    /// Name of its output.
    pub output: String,
    /// Threshold, the upper one of two [unit of the row].
    pub threshold: f64,
    /// Lower threshold of two; absent if there is one threshold [unit of the row].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lower: Option<f64>,
    /// Unit of the threshold, that of the output in all files, e.g. `m` or `rpm`.
    pub unit: String,
    /// Side of the threshold on which failure lies: `above` or `below`, or `outside` of two.
    pub fails: String,
}

/// Units of a random variable or an output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct UnitRow {
    /// Name of the variable or output.
    pub name: String,
    /// Unit of its values in `samples.csv`, if it is a variable, and in the tables of `campaign.db`.
    pub unit: String,
    /// Unit that the scene chooses for readers.
    pub shown: String,
    /// Number of the shown units in one unit [1].
    pub per_unit: f64,
}

/// The units of the variables and outputs of a scene, in its order.
pub fn unit_rows(scene: &Scene) -> Vec<UnitRow> {
    let variables = scene.variables.iter().map(|variable| UnitRow {
        name: variable.name.clone(),
        unit: si_unit(&variable.unit),
        shown: variable.unit.clone(),
        per_unit: read_unit(&variable.unit).map_or(1.0, |unit| unit.divide / unit.multiply),
    });
    let outputs = scene.outputs.iter().map(|output| {
        let unit = scene.unit_of(output);
        let (shown, per_unit) = (unit.symbol().to_owned(), unit.to_shown(1.0));
        let own = if matches!(unit, OutputUnit::External(_)) { &shown } else { unit.kind().si };
        UnitRow { name: output.name.clone(), unit: own.to_owned(), shown, per_unit }
    });
    variables.chain(outputs).collect()
}

/// The random variables of a scene, in its order.
pub fn variable_rows(scene: &Scene) -> Vec<VariableRow> {
    let row = |RandomVariable { name, distribution: law, unit, .. }: &RandomVariable| {
        let (lower, upper) = law.support();
        let [lower, upper] = [lower, upper].map(|bound| bound.is_finite().then_some(bound));
        let (mean, std) = (law.parent_mean(), law.given_std());
        let (name, distribution, unit) = (name.clone(), law.word().to_owned(), si_unit(unit));
        VariableRow { name, distribution, mean, std, lower, upper, unit }
    };
    scene.variables.iter().map(row).collect()
}

/// The SI unit of values that are displayed in `unit`.
fn si_unit(unit: &str) -> String {
    match read_unit(unit) {
        Ok(read) if read.dimension == Dimension::NONE && read.angle == AngleUnit::Present => "rad".to_owned(),
        Ok(read) => read.dimension.si_unit(),
        // The unit of an external simulator, which is only displayed.
        Err(_) => unit.to_owned(),
    }
}

/// The limit states of a scene, in its order.
pub fn limit_rows(scene: &Scene) -> Vec<LimitRow> {
    let row = |limit: &LimitState| {
        let output = &scene.outputs[limit.output];
        let unit = output.kind.unit();
        let (fails, lower) = match limit.fails {
            Fails::Above => ("above", None),
            Fails::Below => ("below", None),
            Fails::Outside { lower } => ("outside", Some(unit.to_file(lower))),
        };
        let (threshold, fails) = (unit.to_file(limit.threshold), fails.to_owned());
        let (name, output, unit) = (limit.name.clone(), output.name.clone(), unit.suffix().to_owned());
        LimitRow { name, output, threshold, lower, unit, fails }
    };
    scene.limit_states.iter().map(row).collect()
}

/// SHA-256 of a text in hexadecimal digits.
pub fn sha256(text: &str) -> String {
    digest(&SHA256, text.as_bytes()).as_ref().iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;

    #[test]
    fn the_hash_is_that_of_the_standard() {
        // FIPS 180-2, appendix B.1.
        assert_eq!(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }

    #[test]
    fn rows_have_the_values_of_the_scene_in_si() {
        let scene = SceneSource::builtin("four-bar").unwrap().nominal().clone();
        let variables = variable_rows(&scene);
        let units: Vec<&str> = variables.iter().map(|row| row.unit.as_str()).collect();
        assert_eq!(units, ["1/Pa", "N m", "m", "1"]);
        let clearance = &variables[2];
        assert_eq!(
            (clearance.name.as_str(), clearance.distribution.as_str()),
            ("clearance_crank", "truncated-normal")
        );
        assert!((clearance.mean - 30e-6).abs() < 1e-18 && (clearance.std - 2e-6).abs() < 1e-18);
        assert!((clearance.lower.unwrap() - 24e-6).abs() < 1e-18, "{clearance:?}");
        let [limit] = &limit_rows(&scene)[..] else { panic!("one limit state") };
        assert_eq!(
            (limit.output.as_str(), limit.unit.as_str(), limit.fails.as_str()),
            ("max_wear_depth", "m", "above")
        );
        assert!((limit.threshold - 8e-6).abs() < 1e-18);
        let of = |row: &UnitRow| format!("{}: {:.2} {} in a {}", row.name, row.per_unit, row.shown, row.unit);
        let units: Vec<String> = unit_rows(&scene).iter().skip(2).map(of).collect();
        let said = [
            "clearance_crank: 1000000.00 um in a m",
            "friction: 1.00 1 in a 1",
            "max_wear_depth: 1000000.00 µm in a m",
        ];
        assert_eq!(units[..3], said);
        assert_eq!(units[3], "coupler_joint_speed: 9.55 r/min in a rad/s");
        assert_eq!(["deg", "mm", "r/min", "kN", "lumens"].map(si_unit), ["rad", "m", "rad/s", "N", "lumens"]);
    }

    /// The word is the one that the scene language reads.
    #[test]
    fn every_distribution_has_its_word() {
        let everything = include_str!("../../../common/tests/scenes/everything.toml");
        let source = SceneSource::parse(everything, "everything").unwrap();
        let written = source.document["variables"].as_array().unwrap().iter().map(|row| {
            row.get("distribution").map_or("truncated-normal", |word| word.as_str().unwrap()).to_owned()
        });
        let rows = variable_rows(source.nominal());
        let words: Vec<String> = rows.iter().map(|row| row.distribution.clone()).collect();
        assert_eq!(words, written.collect::<Vec<_>>());
        assert!(rows.iter().any(|row| row.lower.is_none()) && rows.iter().any(|row| row.lower.is_some()));
    }
}
