//! Reader of the file of units, CSV: one observation a line, `unit, cycles, quantity, value, error`. The quantity is an output
//! or a random variable of the scene, with value and standard deviation of its error, or `survived` without both, or `failed` with the
//! limit state as value and the standard deviation of the life's error, where they are known.
//!
//! In the data of a fleet rows of the unit `population` name what is not known of it: `VARIABLE.mean`, `VARIABLE.std`,
//! `correlation(A B)` or a design variable, with value and standard deviation of its prior, or without both for a flat one; rows of the unit `price` what one more unit
//! run to failure (`failed`), or one measured value of an output or variable, costs.
//!
//! A first line that begins with `unit` is a heading; lines that begin with `#` are comments.

use super::contradictions::{CONTRADICTION, contradictions};
use super::observation::{
    FleetData, Moment, Observable, Observation, ObservedUnit, Quantity, UnknownParameter,
};
use crate::analyses::quantity::{output_quantity, positive};
use crate::analyses::setting::pair_of;
use crate::presentation::format::shortest;
use crate::statistics::design::fixed_bounds;
use crate::statistics::updating::is_positive_family;
use crate::study::LifeModel;
use common::random::Distribution;
use common::scene::quantity::{Kind, NUMBER};
use common::scene::{Faults, Scene, SceneSource, Section, read_quantity, read_rows, read_text};
use std::path::Path;

/// Columns of the file.
const COLUMNS: [&str; 5] = ["unit", "cycles", "quantity", "value", "error"];

/// Reads a file of the units of a fleet. With `designs`, the indices of the random variables that stand for design variables, rows of the
/// unit `population` name what is not known of their population.
///
/// # Errors
/// All faults.
pub fn read(
    path: &Path,
    source: &SceneSource,
    model: &LifeModel,
    designs: Option<&[usize]>,
) -> Result<FleetData, Faults> {
    parse(&read_text(path)?, &path.display().to_string(), source, model, designs)
}

/// The unit whose rows name what is not known of all.
const POPULATION: &str = "population";

/// Bounds of what a study says of a mean [its standard deviations], and of a spread, up and down [factor].
pub const WIDE: f64 = 5.0;

/// Standard deviations of a stated prior that have to reach these bounds [1].
const BEYOND: f64 = 3.0;

/// The unit whose rows name the prices of further observations.
const PRICE: &str = "price";

/// Reads the text of a file; only with `designs` it may have rows of the population and prices.
///
/// # Errors
/// All faults.
pub fn parse(
    text: &str,
    file: &str,
    source: &SceneSource,
    model: &LifeModel,
    designs: Option<&[usize]>,
) -> Result<FleetData, Faults> {
    let reader = UnitReader { source, scene: source.nominal(), model, designs };
    read_rows(text, file, &COLUMNS, |rows| {
        let FleetData { mut units, mut unknown, mut prices } = FleetData::default();
        for (line, row) in rows.iter_mut() {
            match (row.get("unit").and_then(|name| name.as_str()), designs) {
                (Some(PRICE), Some(_)) => {
                    let Some(read) = reader.price(row) else { continue };
                    if prices.iter().any(|(of, _)| *of == read.0) {
                        row.inconsistent("quantity", "this observation has a price already");
                    }
                    prices.push(read);
                }
                (Some(POPULATION), Some(designs)) => {
                    let Some(read) = reader.unknown(row, designs) else { continue };
                    let of = |parameter: &UnknownParameter| (parameter.variable, parameter.moment);
                    if unknown.iter().any(|other| of(other) == of(&read)) {
                        row.inconsistent("quantity", "this parameter has a row already");
                    }
                    unknown.push(read);
                }
                _ => {
                    let Some((name, observation)) = reader.observation(*line, row) else { continue };
                    match units.iter_mut().find(|unit| unit.name == name) {
                        Some(unit) => unit.observations.push(observation),
                        None => units.push(ObservedUnit { name, observations: vec![observation] }),
                    }
                }
            }
        }
        for unit in &mut units {
            let rank = |o: &Observation| o.quantity.rank();
            unit.observations.sort_by(|a, b| a.cycles.total_cmp(&b.cycles).then(rank(a).cmp(&rank(b))));
            for (line, column, what) in contradictions(unit, source.nominal()) {
                let row = rows.iter().find(|(other, _)| *other == line);
                row.expect("observations are those of rows").1.inconsistent(column, what);
            }
        }
        FleetData { units, unknown, prices }
    })
}

struct UnitReader<'a> {
    source: &'a SceneSource,
    scene: &'a Scene,
    model: &'a LifeModel,
    /// Indices of the design variables where what is not known of the population is learned.
    designs: Option<&'a [usize]>,
}

impl UnitReader<'_> {
    /// Unit and observation of a row; `None` with a fault.
    fn observation(&self, line: u64, row: &mut Section) -> Option<(String, Observation)> {
        let before = row.fault_count();
        let unit = row.text("unit", "the name of the unit");
        let name = row.text("quantity", "an output, a random variable, survived or failed");
        let quantity = name.and_then(|name| self.quantity(name, row));
        let cycles = self.cycles(row, quantity.as_ref());
        let (cycles, name, quantity) = (cycles?, name?.to_owned(), quantity?);
        let observation = Observation { line, cycles, name, quantity };
        (row.fault_count() == before).then_some((unit?.to_owned(), observation))
    }

    /// The output, the random variable (`None` for one of `words`) that a row names, as it is written in the scene.
    fn named<'s>(
        &'s self,
        row: &Section,
        name: &str,
        words: &[&'s str],
    ) -> Option<(&'s str, Option<Observable>)> {
        let Scene { outputs, variables, .. } = self.scene;
        let outputs = outputs.iter().zip(0..).map(|(o, k)| (o.name.as_str(), Some(Observable::Output(k))));
        let variables =
            variables.iter().zip(0..).map(|(v, k)| (v.name.as_str(), Some(Observable::Variable(k))));
        let all: Vec<_> = outputs.chain(variables).chain(words.iter().map(|word| (*word, None))).collect();
        row.meant("quantity", "quantity", name, all.iter().map(|(name, _)| *name)).map(|place| all[place])
    }

    /// The price of one observation of a kind.
    fn price(&self, row: &mut Section) -> Option<(Option<Observable>, f64)> {
        for column in ["cycles", "error"] {
            if row.get(column).is_some() {
                row.inconsistent(column, format!("a price has no {column}"));
            }
        }
        let name = row.text("quantity", "failed, an output or a random variable")?;
        let (_, of) = self.named(row, name, &["failed"])?;
        let text = row.text_or("value", "a price", "")?;
        Some((of, positive(row, "value", text, f64::INFINITY, "a number above 0")?))
    }

    fn quantity(&self, name: &str, row: &mut Section) -> Option<Quantity> {
        let (word, of) = self.named(row, name, &["survived", "failed"])?;
        let Some(of) = of else {
            if word == "failed" {
                return self.failure(row);
            }
            for column in ["value", "error"] {
                if let Some(cell) = row.get(column) {
                    row.inconsistent(column, format!("{cell}: {word} has no {column}"));
                }
            }
            return Some(Quantity::Survived);
        };
        if let Observable::Variable(k) = of
            && self.scene.variables[k].distribution.is_constant()
        {
            let what = format!("{name} is constant in this study: there is nothing to learn");
            row.inconsistent("quantity", what);
        }
        let [value, error] = ["value", "error"].map(|column| {
            let text = row.text_or(column, "a quantity", "").unwrap_or_default();
            let read = if let Observable::Output(k) = of {
                output_quantity(&self.scene.outputs[k], text)
            } else {
                read_quantity(text, self.source.kind_of(word)?).map_err(|fault| fault.to_string())
            };
            read.map_err(|what| row.inconsistent(column, what)).ok()
        });
        if error.is_some_and(|error| error <= 0.0) {
            row.inconsistent("error", "allowed: a standard deviation above 0");
        }
        let (value, error) = (value?, error?);
        if let Observable::Variable(k) = of {
            let (lower, upper) = self.bounds(k);
            if value + CONTRADICTION * error < lower || value - CONTRADICTION * error > upper {
                let (unit, [lower, upper]) =
                    (row.text("unit", "the name of the unit")?, [lower, upper].map(|x| shortest(x, 4)));
                let what = format!(
                    "no unit has this {word}, not even {CONTRADICTION} standard deviations of the error from it, so that unit \
                                    {unit} is of another population; allowed: {lower} to {upper} [SI]"
                );
                row.inconsistent("value", what);
            }
        }
        Some(Quantity::Measured { of, value, error })
    }

    /// Values that random variable `k` has in any unit, whatever is learned [SI].
    fn bounds(&self, k: usize) -> (f64, f64) {
        let law = &self.model.inputs.variables()[k];
        let (lower, upper) = law.support();
        let is_learned = self.designs.is_some_and(|designs| !designs.contains(&k));
        let stays = match law {
            // What a constant is in this study is refused as such.
            Distribution::Constant(_) => [false; 2],
            Distribution::Uniform(_) => [!is_learned; 2],
            Distribution::TruncatedNormal(_) if is_learned => {
                fixed_bounds(self.source).get(k).copied().unwrap_or_default()
            }
            _ => [true; 2],
        };
        (if stays[0] { lower } else { f64::NEG_INFINITY }, if stays[1] { upper } else { f64::INFINITY })
    }

    /// A failure: by which limit state, and how exactly its life is known.
    fn failure(&self, row: &mut Section) -> Option<Quantity> {
        let by = row.text_or("value", "a limit state", "")?;
        let names = self.scene.limit_states.iter().map(|limit| limit.name.as_str());
        let by = if by.is_empty() { None } else { Some(row.meant("value", "limit state", by, names)?) };
        let error = Some(row.text_or("error", "a number of cycles", "")?).filter(|error| !error.is_empty());
        let allowed = "the standard deviation of the life at which it failed, a number of cycles above 0, or nothing if \
                       it failed at some life until then";
        let error = error.and_then(|error| positive(row, "error", error, f64::INFINITY, allowed));
        Some(Quantity::Failed { by, error })
    }

    /// An unknown parameter of the population.
    fn unknown(&self, row: &mut Section, designs: &[usize]) -> Option<UnknownParameter> {
        let before = row.fault_count();
        if row.get("cycles").is_some() {
            row.inconsistent("cycles", "a parameter of the population has no life");
        }
        let words = "VARIABLE.mean, VARIABLE.std, correlation(A B) or a design variable";
        let name = row.text("quantity", words)?;
        let laws = self.model.inputs.variables();
        if let Some(pair) = name.strip_prefix("correlation(").and_then(|rest| rest.strip_suffix(')')) {
            let [a, b] = match pair_of(self.source, pair) {
                Ok([a, b]) => [a.min(b), a.max(b)],
                Err(fault) => return row.fault("quantity", fault).and(None),
            };
            if [a, b].iter().any(|k| designs.contains(k) || laws[*k].is_constant()) {
                row.inconsistent(
                    "quantity",
                    "allowed: the correlation of variables that differ between units",
                );
            }
            let moment = Moment::CorrelationWith(b);
            let prior = self.prior(row, NUMBER, (a, moment), false);
            return (row.fault_count() == before).then_some(UnknownParameter { variable: a, moment, prior });
        }
        let (variable, word) = name.rsplit_once('.').unwrap_or((name, ""));
        let variables = self.scene.variables.iter().map(|variable| variable.name.as_str());
        let k = row.meant("quantity", "random variable", variable, variables)?;
        let is_design = designs.contains(&k);
        let moment = match (word, is_design) {
            ("mean", false) | ("", true) => Moment::Mean,
            ("std", false) => Moment::Std,
            _ => {
                let of_design = format!("{variable} is a design variable: its row is {variable}");
                let of_law = format!("allowed: {variable}.mean or {variable}.std");
                row.inconsistent("quantity", if is_design { of_design } else { of_law });
                return None;
            }
        };
        let refused = match &laws[k] {
            _ if is_design => None,
            Distribution::Constant(_) => Some("is constant in this study, which shows no influence of it"),
            Distribution::Beta(_) | Distribution::Triangular(_) | Distribution::Empirical(_) => Some(
                "has a distribution whose parameters are not learned; allowed: the families with mean and std alone",
            ),
            Distribution::Exponential(_) if moment == Moment::Std => {
                Some("is exponential: its mean is its one parameter")
            }
            _ => None,
        };
        if let Some(why) = refused {
            row.inconsistent("quantity", format!("{variable} {why}"));
        }
        let prior = self.prior(row, self.source.kind_of(variable)?, (k, moment), is_design);
        (row.fault_count() == before).then_some(UnknownParameter { variable: k, moment, prior })
    }

    /// Value and standard deviation of the prior of a parameter of variable `k`; `None` for a flat one.
    fn prior(
        &self,
        row: &mut Section,
        kind: Kind,
        (k, moment): (usize, Moment),
        is_design: bool,
    ) -> Option<(f64, f64)> {
        let cells = ["value", "error"]
            .map(|column| (column, row.text_or(column, "a quantity", "").unwrap_or_default()));
        if cells.iter().all(|(_, cell)| cell.is_empty()) {
            return None;
        }
        let read = |(column, cell): (&'static str, &str)| {
            read_quantity(cell, kind).unwrap_or_else(|fault| {
                row.inconsistent(column, fault.to_string());
                0.0
            })
        };
        let [value, error] = cells.map(read);
        if error <= 0.0 {
            row.inconsistent("error", "allowed: the standard deviation of the prior, above 0; nothing in both columns for a flat one");
        }
        let (law, name) = (&self.model.inputs.variables()[k], &self.scene.variables[k].name);
        let ((lower, upper), mean, std) = (law.support(), law.parent_mean(), law.given_std());
        let (least, most) = match moment {
            Moment::Std => (std / WIDE, std * WIDE),
            Moment::Mean => (mean - WIDE * std, mean + WIDE * std),
            Moment::CorrelationWith(_) => (-1.0, 1.0),
        };
        let is_positive = moment == Moment::Std || moment == Moment::Mean && is_positive_family(law);
        if is_positive && value <= 0.0 {
            row.inconsistent("value", "allowed: above 0");
        }
        if is_design && !(lower < value && value < upper) {
            let range = format!("{lower} to {upper} [SI]");
            row.inconsistent("value", format!("allowed: within the range of the study, {range}"));
        } else if matches!(moment, Moment::CorrelationWith(_)) && value.abs() >= 1.0 {
            row.inconsistent("value", "allowed: between -1 and 1");
        } else if !is_design && (value + BEYOND * error < least || value - BEYOND * error > most) {
            let range = format!("{} to {}", shortest(least, 4), shortest(most, 4));
            let fault =
                format!("allowed: near {range} [SI], by the {name} of the study; it knows nothing of others");
            row.inconsistent("value", fault);
        }
        Some((value, error))
    }

    fn cycles(&self, row: &mut Section, quantity: Option<&Quantity>) -> Option<f64> {
        let text = row.text_or("cycles", "a number of cycles", "")?;
        let first = match quantity {
            None | Some(Quantity::Measured { of: Observable::Variable(_), .. }) if text.is_empty() => {
                return Some(0.0);
            }
            Some(Quantity::Measured { of: Observable::Output(output), .. }) => self.model.beginning(*output),
            _ => 0.0,
        };
        let last = self.model.end();
        let read = text.parse::<f64>().ok().filter(|n| (first..=last).contains(n));
        if read.is_none() {
            let why = ", the first checkpoint (the value at the start of life is not known),";
            let why = if first > 0.0 { why } else { "" };
            let allowed =
                format!("a number of cycles from {first:.0}{why} to {last:.0}, the end of the study");
            row.inconsistent("cycles", format!("{text:?}: allowed: {allowed}"));
        }
        read
    }
}
