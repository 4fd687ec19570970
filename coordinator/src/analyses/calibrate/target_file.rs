//! Reader of the file of free parameters and targets, TOML.

use super::CalibrationError;
use super::space::{FreeParameter, ParameterKind};
use super::targets::{CalibrationTargets, ShownUnit, Target, TargetQuantity};
use common::scene::expression::{ExpressionError, evaluate};
use common::scene::quantity::{ANGLE, Dimension, FORCE, Kind, LENGTH, NUMBER};
use common::scene::{JointKind, Scene};
use serde::Deserialize;
use std::path::Path;
use toml::{Table, Value};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    /// File with a table `[published]`, whose values targets may name.
    reference: Option<String>,
    #[serde(default)]
    parameters: Vec<ParameterRow>,
    #[serde(default)]
    targets: Vec<TargetRow>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ParameterRow {
    name: String,
    #[serde(default)]
    changes: Vec<String>,
    #[serde(default)]
    mean_of: Vec<String>,
    #[serde(default)]
    spread_of: Vec<String>,
    lower: Value,
    upper: Value,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TargetRow {
    name: Option<String>,
    output: Option<String>,
    limit_state: Option<String>,
    joint: Option<String>,
    statistic: Option<String>,
    angle: Option<Value>,
    cycles: Option<u32>,
    value: Option<Value>,
    profile: Option<String>,
    tolerance: Value,
}

/// Reads a file of targets for a scene.
///
/// # Errors
/// [`CalibrationError::Targets`] with the first fault.
pub fn read(path: &Path, scene: &Scene) -> Result<CalibrationTargets, CalibrationError> {
    let text = std::fs::read_to_string(path).map_err(|error| fault(path, "", unreadable(&error)))?;
    parse(&text, path, scene)
}

/// Reads the text of such a file; paths of profiles are relative to the folder of `path`.
///
/// # Errors
/// [`CalibrationError::Targets`] with the first fault.
pub fn parse(text: &str, path: &Path, scene: &Scene) -> Result<CalibrationTargets, CalibrationError> {
    let file: File =
        toml::from_str(text).map_err(|error| fault(path, "", error.to_string().trim_end().to_owned()))?;
    if file.parameters.is_empty() || file.targets.is_empty() {
        let what = "at least one [[parameters]] and one [[targets]] are needed";
        return Err(fault(path, "", what.to_owned()));
    }
    let published =
        file.reference.as_deref().map(|file| published(path, file)).transpose()?.unwrap_or_default();
    let reader = Reader { path, scene, published };
    let free = file.parameters.iter().map(|row| reader.free(row)).collect::<Result<Vec<_>, _>>()?;
    let targets: Vec<Vec<Target>> = file
        .targets
        .iter()
        .enumerate()
        .map(|(place, row)| reader.target(place, row))
        .collect::<Result<_, _>>()?;
    Ok(CalibrationTargets { free, targets: targets.into_iter().flatten().collect() })
}

fn fault(path: &Path, key: &str, what: String) -> CalibrationError {
    let key = if key.is_empty() { "file".to_owned() } else { key.to_owned() };
    CalibrationError::Targets { file: path.display().to_string(), key, what }
}

/// Why a file cannot be read, in the words of the reader of scenes.
fn unreadable(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "cannot be read: there is no such file".to_owned(),
        _ => format!("cannot be read: {error}"),
    }
}

/// Reads the table `[published]` of a reference file in the folder of the file of targets.
fn published(path: &Path, file: &str) -> Result<Table, CalibrationError> {
    let refuse = |what: String| fault(path, "reference", format!("{file}: {what}"));
    let text = std::fs::read_to_string(path.parent().unwrap_or(Path::new(".")).join(file))
        .map_err(|error| refuse(unreadable(&error)))?;
    let mut table: Table = text.parse().map_err(|error: toml::de::Error| refuse(error.to_string()))?;
    match table.remove("published") {
        Some(Value::Table(published)) => Ok(published),
        _ => Err(refuse("has no table [published]".to_owned())),
    }
}

struct Reader<'a> {
    path: &'a Path,
    scene: &'a Scene,
    /// Results that targets may name.
    published: Table,
}

impl Reader<'_> {
    fn free(&self, row: &ParameterRow) -> Result<FreeParameter, CalibrationError> {
        let key = |key: &str| format!("parameters.{}.{key}", row.name);
        let variables = |names: &[String], list: &str| -> Result<Vec<usize>, CalibrationError> {
            names.iter().map(|name| self.find(&key(list), name, "variable", self.variables())).collect()
        };
        let kind = match (row.changes.as_slice(), row.mean_of.as_slice(), row.spread_of.as_slice()) {
            (keys @ [_, ..], [], []) => ParameterKind::Keys(keys.to_vec()),
            ([], names @ [_, ..], []) => ParameterKind::Mean(variables(names, "mean_of")?),
            ([], [], names @ [_, ..]) => ParameterKind::Spread(variables(names, "spread_of")?),
            _ => {
                let what = "expected exactly one of changes (keys of the scene), mean_of and spread_of (names of \
                            variables)";
                return Err(fault(self.path, &format!("parameters.{}", row.name), what.to_owned()));
            }
        };
        let (lower, upper) = (text_of(&row.lower), text_of(&row.upper));
        let mut free = FreeParameter {
            name: row.name.clone(),
            kind,
            lower: 0.0,
            upper: 0.0,
            unit: String::new(),
            bounds: [lower, upper],
        };
        if !matches!(free.kind, ParameterKind::Keys(_)) {
            free.lower = self.number(&key("lower"), &row.lower, NUMBER)?.0;
            free.upper = self.number(&key("upper"), &row.upper, NUMBER)?.0;
            if !(free.lower > 0.0 && free.lower < free.upper) {
                let what =
                    format!("a factor from {} to {}: expected 0 < lower < upper", free.lower, free.upper);
                return Err(fault(self.path, &key("lower"), what));
            }
        }
        Ok(free)
    }

    /// The targets of a row: one, or one per line of its profile. `place`: number of the row, from 0.
    fn target(&self, place: usize, row: &TargetRow) -> Result<Vec<Target>, CalibrationError> {
        let path = match &row.name {
            Some(name) => format!("targets.{name}"),
            None => format!("targets[{}]", place + 1),
        };
        if let Some(profile) = &row.profile {
            return self.profile(&path, profile, row);
        }
        let key = |key: &str| format!("{path}.{key}");
        let Some(value) = &row.value else {
            return Err(fault(self.path, &key("value"), "is missing, or a profile instead of it".to_owned()));
        };
        let (quantity, kind, label) = self.quantity(&key, row)?;
        let (value, unit) = self.number(&key("value"), value, kind)?;
        let (tolerance, _) = self.number(&key("tolerance"), &row.tolerance, kind)?;
        if tolerance <= 0.0 {
            return Err(fault(self.path, &key("tolerance"), "expected above zero".to_owned()));
        }
        let label = row.cycles.map_or(label.clone(), |cycles| format!("{label} at {cycles}"));
        Ok(vec![Target { name: row.name.clone().unwrap_or(label), quantity, value, tolerance, unit }])
    }

    /// Quantity, kind of unit, and default name of a row without profile.
    fn quantity(
        &self,
        key: &dyn Fn(&str) -> String,
        row: &TargetRow,
    ) -> Result<(TargetQuantity, Kind, String), CalibrationError> {
        let default = if row.limit_state.is_some() { "reliability" } else { "" };
        let statistic = row.statistic.as_deref().unwrap_or(default);
        match statistic {
            "mean" | "std" | "nominal" => {
                let (output, n) = (self.output(&key("output"), row)?, self.checkpoint(&key("cycles"), row)?);
                let quantity = match statistic {
                    "mean" => TargetQuantity::Mean { output, n },
                    "std" => TargetQuantity::Std { output, n },
                    _ => TargetQuantity::Nominal { output, n },
                };
                let label = format!("{statistic} of {}", self.scene.outputs[output].name);
                Ok((quantity, self.kind(output), label))
            }
            "reliability" => {
                let name = row.limit_state.as_deref().unwrap_or("total");
                let limit_state = if name == "total" {
                    None
                } else {
                    let names = self.scene.limit_states.iter().map(|limit| limit.name.as_str()).collect();
                    Some(self.find(&key("limit_state"), name, "limit state", names)?)
                };
                let n = self.checkpoint(&key("cycles"), row)?;
                Ok((TargetQuantity::Reliability { limit_state, n }, NUMBER, format!("R {name}")))
            }
            "peak-force" => {
                let joint = self.joint(&key("joint"), row)?;
                let label = format!("peak force in joint {}", self.scene.joints[joint].name);
                Ok((TargetQuantity::PeakForce { joint }, FORCE, label))
            }
            "depth" => {
                let joint = self.bore(&key("joint"), row)?;
                let Some(angle) = &row.angle else {
                    let what = "is missing, expected the angle on the bore in the frame of the bushing";
                    return Err(fault(self.path, &key("angle"), what.to_owned()));
                };
                let (angle, _) = self.number(&key("angle"), angle, ANGLE)?;
                let label = format!(
                    "depth of bore {} at {:.0} deg",
                    self.scene.joints[joint].name,
                    angle.to_degrees()
                );
                Ok((TargetQuantity::Depth { joint, angle }, LENGTH, label))
            }
            other => {
                let what =
                    format!("{other:?}: allowed are mean, std, nominal, reliability, peak-force and depth");
                Err(fault(self.path, &key("statistic"), what))
            }
        }
    }

    /// Targets of a measured profile: per line of the file an angle [deg] and a depth in the unit of the tolerance. Lines
    /// that do not begin with a number are skipped as headings.
    fn profile(&self, path: &str, file: &str, row: &TargetRow) -> Result<Vec<Target>, CalibrationError> {
        let key = format!("{path}.profile");
        let joint = self.bore(&format!("{path}.joint"), row)?;
        let (tolerance, unit) = self.number(&format!("{path}.tolerance"), &row.tolerance, LENGTH)?;
        let name = row.name.clone().unwrap_or_else(|| format!("bore {}", self.scene.joints[joint].name));
        let location = self.path.parent().unwrap_or(Path::new(".")).join(file);
        let text = std::fs::read_to_string(&location)
            .map_err(|error| fault(self.path, &key, format!("{file}: {}", unreadable(&error))))?;
        let mut targets = Vec::new();
        for (number, line) in text.lines().enumerate() {
            let cells: Vec<&str> = line.split([',', ';', '\t']).map(str::trim).collect();
            let Some(Ok(angle)) = cells.first().map(|cell| cell.parse::<f64>()) else { continue };
            let depth =
                cells.get(1).and_then(|cell| cell.parse::<f64>().ok()).filter(|depth| depth.is_finite());
            let Some(depth) = depth.filter(|_| angle.is_finite()) else {
                let what = format!(
                    "{file}, line {}: expected an angle in degrees and a depth in {}",
                    number + 1,
                    unit.symbol
                );
                return Err(fault(self.path, &key, what));
            };
            targets.push(Target {
                name: format!("{name} at {angle} deg"),
                quantity: TargetQuantity::Depth { joint, angle: angle.to_radians() },
                value: depth * unit.si,
                tolerance,
                unit: unit.clone(),
            });
        }
        if targets.is_empty() {
            return Err(fault(self.path, &key, format!("{file} has no line with an angle and a depth")));
        }
        Ok(targets)
    }

    fn variables(&self) -> Vec<&str> {
        self.scene.variables.iter().map(|variable| variable.name.as_str()).collect()
    }

    fn find(&self, key: &str, name: &str, what: &str, known: Vec<&str>) -> Result<usize, CalibrationError> {
        known.iter().position(|other| *other == name).ok_or_else(|| {
            fault(self.path, key, format!("there is no {what} {name:?}; there are {}", known.join(", ")))
        })
    }

    fn output(&self, key: &str, row: &TargetRow) -> Result<usize, CalibrationError> {
        let names: Vec<&str> = self.scene.outputs.iter().map(|output| output.name.as_str()).collect();
        self.find(key, row.output.as_deref().unwrap_or_default(), "output", names)
    }

    fn joint(&self, key: &str, row: &TargetRow) -> Result<usize, CalibrationError> {
        let names: Vec<&str> = self.scene.joints.iter().map(|joint| joint.name.as_str()).collect();
        self.find(key, row.joint.as_deref().unwrap_or_default(), "joint", names)
    }

    /// A joint with a bore.
    fn bore(&self, key: &str, row: &TargetRow) -> Result<usize, CalibrationError> {
        let joint = self.joint(key, row)?;
        if matches!(self.scene.joints[joint].kind, JointKind::Clearance(_)) {
            return Ok(joint);
        }
        let what = format!("joint \"{}\" has no bore", self.scene.joints[joint].name);
        Err(fault(self.path, key, what))
    }

    fn checkpoint(&self, key: &str, row: &TargetRow) -> Result<usize, CalibrationError> {
        let all = self.scene.life.checkpoints();
        let found = row.cycles.and_then(|cycles| all.iter().position(|other| *other == cycles));
        found.ok_or_else(|| {
            let (first, last) = (all.first().unwrap_or(&0), all.last().unwrap_or(&0));
            let what = format!(
                "expected a checkpoint of the life: {first} to {last} by {}",
                self.scene.life.checkpoint_every
            );
            fault(self.path, key, what)
        })
    }

    fn kind(&self, output: usize) -> Kind {
        self.scene.outputs[output].kind.unit().kind()
    }

    /// A quantity in SI, and the unit in which it was written.
    fn number(&self, key: &str, value: &Value, kind: Kind) -> Result<(f64, ShownUnit), CalibrationError> {
        let refuse = |what: String| Err(fault(self.path, key, what));
        let value = value.as_str().and_then(|name| self.published.get(name)).unwrap_or(value);
        let text = match value {
            Value::Float(_) | Value::Integer(_) if kind.dimension != Dimension::NONE => {
                return refuse(format!("{value} has no unit, expected {}", kind.in_words()));
            }
            other => text_of(other),
        };
        let mut nothing =
            |name: &str| Err(ExpressionError::UnknownName { name: name.to_owned(), nearest: None });
        match evaluate(&text, &mut nothing) {
            Err(error) => refuse(format!("{text:?}: {error}")),
            Ok(found) if found.dimension != kind.dimension => {
                refuse(format!("{text:?} is {}, expected {}", found.dimension, kind.in_words()))
            }
            Ok(found) if !found.value.is_finite() => refuse(format!("{text:?} is not finite")),
            Ok(found) => {
                let unit =
                    text.trim_start_matches(|c: char| c.is_ascii_digit() || "+-.eE ".contains(c)).trim();
                let one = evaluate(&format!("1 {unit}"), &mut nothing).map_or(1.0, |one| one.value);
                Ok((found.value, ShownUnit { symbol: unit.to_owned(), si: one }))
            }
        }
    }
}

/// Text of a quantity in TOML.
fn text_of(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}
