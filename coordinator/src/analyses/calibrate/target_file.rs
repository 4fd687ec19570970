//! Targets of a calibration, quantities with the values to be met and their tolerances, and the reader of their file with the free
//! parameters, TOML; every fault is reported at once.

use super::space::{FreeParameter, ParameterKind};
use crate::analyses::quantity::{ShownUnit, checkpoint, limit_state};
use common::random::RandomVariable;
use common::scene::quantity::{ANGLE, FORCE, Kind, LENGTH, NUMBER};
use common::scene::{
    Fault, Faults, InputFile, JointKind, Range, Scene, SceneSource, Section, csv_rows, number_and_unit,
    read_text,
};
use std::path::Path;
use toml::{Table, Value};

/// Statistic of an output over the random variables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OutputStatistic {
    /// Mean over the random variables.
    Mean,
    /// Standard deviation over the random variables.
    Std,
    /// Its value at the means of the random variables.
    Nominal,
}

/// Quantity of a target.
#[derive(Debug, Clone, PartialEq)]
pub enum TargetQuantity {
    /// Statistic of an output at checkpoint `n`.
    Output {
        /// What of its values.
        statistic: OutputStatistic,
        /// Index of the output.
        output: usize,
        /// Index of the checkpoint.
        n: usize,
    },
    /// R at checkpoint `n` by one limit state, or by all if `limit_state` is `None`.
    Reliability {
        /// Index of the limit state.
        limit_state: Option<usize>,
        /// Index of the checkpoint.
        n: usize,
    },
    /// Largest force in a joint in the first cycle of the nominal mechanism.
    PeakForce {
        /// Index of the joint.
        joint: usize,
    },
    /// Wear depth of the nominal mechanism's bore at the end of its life.
    Depth {
        /// Index of the joint.
        joint: usize,
        /// Angle on the bore [rad].
        angle: f64,
    },
}

/// One number to be met by the fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Name in the report.
    pub name: String,
    /// Quantity to be compared with the value.
    pub quantity: TargetQuantity,
    /// Value to be met [SI].
    pub value: f64,
    /// Standard deviation of the measurement, or of the deviation to be accepted [SI].
    pub tolerance: f64,
    /// Unit in the report.
    pub unit: ShownUnit,
}

impl Target {
    /// The target with the sampling error of `points` samples in its tolerance: that of a reliability, which is a share of
    /// them, sqrt(R (1 - R) / N), an upper bound for a Latin hypercube.
    #[must_use]
    pub fn counted_over(mut self, points: usize) -> Self {
        if matches!(self.quantity, TargetQuantity::Reliability { .. }) {
            let variance = (self.value * (1.0 - self.value)).max(0.0) / points as f64;
            self.tolerance = self.tolerance.hypot(variance.sqrt());
        }
        self
    }
}

/// Free parameters and targets of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationTargets {
    /// Parameters to be fitted, at least one.
    pub free: Vec<FreeParameter>,
    /// Numbers to be met, at least one.
    pub targets: Vec<Target>,
}

/// Keys of a row of targets, of which each statistic needs some.
const KEYS: [[&str; 5]; 2] = [
    ["name", "output", "limit_state", "joint", "statistic"],
    ["angle", "cycles", "value", "profile", "tolerance"],
];

/// The words of `statistic`: three of outputs, and others.
const STATISTICS: [&str; 6] = ["mean", "std", "nominal", "reliability", "peak-force", "depth"];

/// Reads a file of targets for a scene; paths in it are relative to its folder.
///
/// # Errors
/// All faults.
pub fn read(file: &InputFile, source: &SceneSource) -> Result<CalibrationTargets, Faults> {
    let folder = Path::new(file.origin()).parent().unwrap_or(Path::new("."));
    file.read(|file| {
        let published = published(file, folder);
        let reader = TargetReader { folder, source, scene: source.nominal(), published };
        for key in ["parameters", "targets"] {
            if file.get(key).and_then(Value::as_array).is_none_or(Vec::is_empty) {
                file.inconsistent(key, format!("at least one [[{key}]] is needed"));
            }
        }
        let (free, mut targets) = (file.rows("parameters"), file.unnamed_rows("targets"));
        CalibrationTargets {
            free: free.into_iter().filter_map(|(name, mut row)| reader.free(name, &mut row)).collect(),
            targets: targets.iter_mut().filter_map(|row| reader.target(row)).flatten().collect(),
        }
    })
}

/// The error of a space of free parameters; a fault of the variable that represents one is that of the parameter in its file.
pub fn of_parameters(file: &InputFile, targets: &CalibrationTargets, Faults(faults): Faults) -> Faults {
    let of_parameter = |fault: &Fault| {
        let mut names = targets.free.iter().map(|free| &free.name);
        let name = names.find(|name| fault.key.contains(&format!("variables.{name}")))?;
        Some((format!("parameters.{name}"), fault.kind.to_string()))
    };
    let own = file.refuse_for(faults.iter().filter_map(of_parameter)).err().map_or(vec![], |Faults(own)| own);
    let others = faults.into_iter().filter(|fault| of_parameter(fault).is_none());
    Faults(own.into_iter().chain(others).collect())
}

/// The table `[published]` of the reference file that a file of targets may name.
fn published(file: &mut Section, folder: &Path) -> Table {
    let name = file.get("reference").and_then(|_| file.text("reference", "a file with a table [published]"));
    let Some(name) = name else { return Table::new() };
    let read = InputFile::load(&folder.join(name)).map_err(|Faults(faults)| faults[0].to_string());
    let table = read.and_then(|read| match read.document.get("published") {
        Some(Value::Table(published)) => Ok(published.clone()),
        _ => Err(format!("{name} has no table [published]")),
    });
    table.map_err(|what| file.inconsistent("reference", what)).unwrap_or_default()
}

struct TargetReader<'a> {
    folder: &'a Path,
    source: &'a SceneSource,
    scene: &'a Scene,
    /// Results that targets may name.
    published: Table,
}

impl TargetReader<'_> {
    fn free(&self, name: &str, row: &mut Section) -> Option<FreeParameter> {
        let mut given = vec!["changes", "mean_of", "spread_of"];
        given.retain(|key| row.get(key).is_some());
        let written = ["lower", "upper"].map(|key| row.get(key));
        let (kind, of) = match given.as_slice() {
            ["changes"] => {
                let keys = row.texts("changes", "a list of keys of the scene").unwrap_or_default();
                let of = self.check_keys(name, row, &keys);
                (ParameterKind::Keys(keys.into_iter().map(str::to_owned).collect()), of)
            }
            ["mean_of"] => (ParameterKind::Mean(self.variables(row, "mean_of")), Some(NUMBER)),
            ["spread_of"] => (ParameterKind::Spread(self.variables(row, "spread_of")), Some(NUMBER)),
            _ => {
                let what = "expected exactly one of changes (keys of the scene), mean_of and spread_of (names of variables)";
                row.inconsistent("name", what);
                row.finish();
                return None;
            }
        };
        // A factor is above 0.
        let range = if let ParameterKind::Keys(_) = kind { Range::Any } else { Range::Positive };
        let [lower, upper] = ["lower", "upper"].map(|key| row.quantity(key, of?, range));
        if let (Some(from), Some(to)) = (lower, upper)
            && from >= to
        {
            let [from, to] = written.map(|value| value.map(Value::to_string).unwrap_or_default());
            row.out_of_range("lower", from, format!("below upper, {to}"));
        }
        row.finish();
        let (lower, upper, of) = (lower?, upper?, of?);
        let unit = match kind {
            ParameterKind::Keys(_) if of.si.is_empty() => of.dimension.si_unit(),
            ParameterKind::Keys(_) => of.si.to_owned(),
            _ => String::new(),
        };
        Some(FreeParameter { name: name.to_owned(), kind, lower, upper, unit })
    }

    /// The random variables named at a key.
    fn variables(&self, row: &mut Section, key: &'static str) -> Vec<usize> {
        let known = self.scene.variables.iter().map(|variable| variable.name.as_str());
        let names = row.texts(key, "a list of random variables");
        if names.as_ref().is_some_and(Vec::is_empty) {
            row.inconsistent(key, "is empty, expected the names of random variables");
        }
        let names = names.unwrap_or_default();
        names.iter().filter_map(|name| row.reference(key, "variable", name, known.clone())).collect()
    }

    /// The kind of the quantity at `keys` of the scene, which the parameter `name` sets. The parameter becomes a variable.
    fn check_keys(&self, name: &str, row: &Section, keys: &[&str]) -> Option<Kind> {
        let variables = &self.scene.variables;
        if variables.iter().any(|variable| variable.name == name) {
            let what = "is the name of a random variable of the scene: give the parameter another name, or use mean_of";
            row.inconsistent("name", format!("\"{name}\" {what}"));
        }
        if keys.is_empty() {
            row.inconsistent("changes", "is empty, expected keys of the scene");
        }
        let known = &self.source.quantities;
        for key in keys {
            row.reference("changes", "quantity", key, known.keys().map(String::as_str));
            let owner = variables.iter().find(|variable| variable.changes.iter().any(|other| other == key));
            if let Some(RandomVariable { name, .. }) = owner {
                let what = format!("the random variable \"{name}\" changes: use mean_of = [\"{name}\"]");
                row.inconsistent("changes", format!("\"{key}\" is what {what}"));
            }
        }
        keys.iter().find_map(|key| Some(known.get(*key)?.kind()))
    }

    /// The targets of a row: one, or one per line of its profile.
    fn target(&self, row: &mut Section) -> Option<Vec<Target>> {
        // Known keys, whatever statistic needs them.
        for key in KEYS.into_iter().flatten() {
            let _ = row.get(key);
        }
        row.finish();
        let name = row.get("name").and_then(|_| row.text("name", "a name"));
        if row.get("profile").is_some() {
            return self.profile(name, row);
        }
        let found = self.quantity(row);
        let kind = found.as_ref().map(|(_, kind, _)| *kind);
        let value = self.number(row, "value", kind, Range::Any);
        let tolerance = self.number(row, "tolerance", kind, Range::Positive);
        let ((quantity, _, mut label), (value, unit), (tolerance, _)) = (found?, value?, tolerance?);
        if let Some(cycles) = row.get("cycles").and_then(Value::as_integer) {
            label += &format!(" at {cycles}");
        }
        Some(vec![Target { name: name.map_or(label, str::to_owned), quantity, value, tolerance, unit }])
    }

    /// Quantity, kind of unit, and default name of a row without profile.
    fn quantity(&self, row: &mut Section) -> Option<(TargetQuantity, Kind, String)> {
        let words = STATISTICS.map(|word| (word, word));
        let statistic = match row.get("limit_state") {
            Some(_) => row.word_or("statistic", &words, "reliability"),
            None => row.word("statistic", &words),
        };
        let Scene { joints, outputs, life, .. } = self.scene;
        // After a fault it is read on with any checkpoint.
        let at = |row: &mut Section| checkpoint(row, life, None).map_or(0, |(n, _)| n);
        Some(match statistic? {
            "reliability" => {
                let (limit, n) = (limit_state(row, self.scene), at(row));
                let (name, limit_state) = limit?;
                (TargetQuantity::Reliability { limit_state, n }, NUMBER, format!("R {name}"))
            }
            "peak-force" => {
                let joint = self.joint(row)?;
                let label = format!("peak force in joint {}", joints[joint].name);
                (TargetQuantity::PeakForce { joint }, FORCE, label)
            }
            "depth" => {
                let (joint, angle) = (self.bore(row), row.quantity("angle", ANGLE, Range::Any));
                let (joint, angle) = (joint?, angle?);
                let label = format!("depth of bore {} at {:.0} deg", joints[joint].name, angle.to_degrees());
                (TargetQuantity::Depth { joint, angle }, LENGTH, label)
            }
            word => {
                let statistic = match word {
                    "mean" => OutputStatistic::Mean,
                    "std" => OutputStatistic::Std,
                    _ => OutputStatistic::Nominal,
                };
                let name = row.text("output", "the name of an output");
                let names = outputs.iter().map(|output| output.name.as_str());
                let output = name.and_then(|name| row.meant("output", "output", name, names));
                let (n, output) = (at(row), output?);
                let (unit, name) = (outputs[output].kind.unit(), &outputs[output].name);
                (TargetQuantity::Output { statistic, output, n }, unit.kind(), format!("{word} of {name}"))
            }
        })
    }

    /// Targets of a measured profile: per line of the file an angle [deg] and a depth in the unit of the tolerance. Lines
    /// that do not begin with a number are skipped as headings.
    fn profile(&self, name: Option<&str>, row: &mut Section) -> Option<Vec<Target>> {
        let joint = self.bore(row);
        let tolerance = self.number(row, "tolerance", Some(LENGTH), Range::Positive);
        let path = self.folder.join(row.text("profile", "a CSV file of angles and depths")?);
        let text = read_text(&path).map_err(|faults| row.inconsistent("profile", faults.to_string())).ok()?;
        let (joint, (tolerance, unit)) = (joint?, tolerance?);
        let file = path.display().to_string();
        let name = name.map_or_else(|| format!("bore {}", self.scene.joints[joint].name), str::to_owned);
        let (mut targets, mut faults) = (Vec::new(), Vec::new());
        let rows = csv_rows(&text);
        for cells in rows.iter().map(|row| &row.cells) {
            let Ok(angle) = cells[0].text.parse::<f64>() else { continue };
            let depth = cells.get(1).and_then(|cell| cell.text.parse::<f64>().ok());
            let Some(depth) = depth.filter(|depth| depth.is_finite() && angle.is_finite()) else {
                let message = format!("expected an angle in degrees and a depth in {}", unit.symbol);
                let span = cells[0].span.start..cells[cells.len() - 1].span.end;
                faults.push(Fault::at(&file, &text, span, "profile", message));
                continue;
            };
            targets.push(Target {
                name: format!("{name} at {angle} deg"),
                quantity: TargetQuantity::Depth { joint, angle: angle.to_radians() },
                value: depth * unit.si,
                tolerance,
                unit: unit.clone(),
            });
        }
        if targets.is_empty() && faults.is_empty() {
            row.inconsistent("profile", format!("{file} has no line with an angle and a depth"));
        }
        row.faults_elsewhere(Faults(faults));
        Some(targets)
    }

    fn joint(&self, row: &mut Section) -> Option<usize> {
        let name = row.text("joint", "the name of a joint")?;
        row.meant("joint", "joint", name, self.scene.joints.iter().map(|joint| joint.name.as_str()))
    }

    /// A joint with a bore.
    fn bore(&self, row: &mut Section) -> Option<usize> {
        let joint = self.joint(row)?;
        let has_bore = matches!(self.scene.joints[joint].kind, JointKind::Clearance(_));
        if !has_bore {
            row.inconsistent("joint", format!("joint \"{}\" has no bore", self.scene.joints[joint].name));
        }
        has_bore.then_some(joint)
    }

    /// A quantity in SI, and the unit in which it was written; a text may be the name of a published result.
    fn number(
        &self,
        row: &mut Section,
        key: &'static str,
        kind: Option<Kind>,
        range: Range,
    ) -> Option<(f64, ShownUnit)> {
        let written = row.get(key);
        if written.is_none() {
            let or = if key == "value" { ", or a profile instead of it" } else { "" };
            let what = kind.map_or_else(|| "a quantity".to_owned(), |kind| kind.in_words());
            row.missing(key, what + or);
        }
        let (written, kind) = (written?, kind?);
        let value = written.as_str().and_then(|name| self.published.get(name)).unwrap_or(written);
        let found = row.as_quantity(key, value, kind, range)?;
        let symbol = value.as_str().and_then(number_and_unit).map_or("", |(_, unit)| unit);
        Some((found, ShownUnit::of(symbol)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issue_the_sampling_error_of_a_reliability_is_part_of_its_tolerance() {
        let unit = ShownUnit::of("");
        let reliability = TargetQuantity::Reliability { limit_state: None, n: 3 };
        let target =
            |quantity| Target { name: "R".into(), quantity, value: 0.5, tolerance: 0.02, unit: unit.clone() };
        let widened = target(reliability).counted_over(1000).tolerance;
        assert!((widened - (0.02_f64.powi(2) + 2.5e-4).sqrt()).abs() < 1e-15, "{widened}");
        assert_eq!(
            target(TargetQuantity::Output { statistic: OutputStatistic::Mean, output: 0, n: 3 })
                .counted_over(1000)
                .tolerance,
            0.02
        );
    }
}
