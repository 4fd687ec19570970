//! The contacts of one cycle as a program gives them: read from JSON or CSV, closed over the period, and checked by name and field.
//!
//! | field | value | unit |
//! |---|---|---|
//! | `time` | instants of all joints, or of one under its name, ascending `(n,)` | s |
//! | `force_x`, `force_y` | normal force of the journal on the bushing, in the bushing's frame `(n,)` each | N |
//! | `angle` | angle of the journal's body minus that of the bushing's, continuous `(n,)` | rad |
//! | `sliding` | sliding speed of the journal's surface over the bushing's `(n,)`; without it R1 times the rate of the angle | m/s |
//! | `eccentricity_x`, `eccentricity_y` | centre of the journal from that of the bushing, in the bushing's frame `(n,)` each; optional | m |
//!
//! | field of a guide | value | unit |
//! |---|---|---|
//! | `force` | normal force of the slider on the guide, positive to the left of its axis `(n,)` | N |
//! | `moment` | moment of that force on the guide about the slider's middle `(n,)` | N m |
//! | `position` | of the slider's middle along the guide `(n,)` | m |
//! | `sliding` | sliding speed `(n,)`; without it the rate of `position` | m/s |
//! | `normal` | sum of the normal forces on both faces `(n,)`; without it max(|F|, 2 |M| / l) of an ideal slider of length l | N |
//!
//! Instants need not be equal. The last one may be missing where the first one repeats after the period.
//!
//! One cycle as a table of comma-separated values: `time`, `JOINT.FIELD` as a reply names them, and the outputs, whose last value counts.

use super::joint_cycle::{
    CycleContacts, CycleJoint, CycleSurfaces, JointCycle, check_joint, sampling_error, slopes,
};
use super::reply::{NoResult, by_name, is_non_finite_word, number, object, shown};
use crate::evaluation_shape::LARGEST;
use crate::scene::{Joint, JointKind, Output, Scene};
use serde_json::{Map, Value};

/// Longest gap between the last instant and the end of the cycle, in the longest steps between instants [1].
const LONGEST_GAP: f64 = 1.5;
/// Rounding of times, as a share of the period [1].
const ROUNDING: f64 = 1e-6;

/// What a reply has to give.
#[derive(Debug, Clone, PartialEq)]
pub struct ExpectedCycle {
    /// Joints with clearance, then the guides that wear, each in the order of the scene.
    pub joints: Vec<CycleJoint>,
    /// Names of the outputs that the program gives; `None` for those of the wear `(outputs,)`.
    pub outputs: Vec<Option<String>>,
    /// Length of a cycle [s].
    pub period: f64,
}

/// One cycle of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleReply {
    /// Contacts of the joints, joints with clearance first, then the guides that wear.
    pub joints: Vec<JointCycle>,
    /// Outputs of the motion, in the order of the scene; zero in the place of those of the wear `(outputs,)`.
    pub outputs: Vec<f64>,
    /// Largest relative error of the work of a joint that the distance of the instants leaves [1].
    pub sampling_error: f64,
}

impl ExpectedCycle {
    /// Joints, outputs and period of a scene whose simulator gives cycles.
    pub fn from_scene(scene: &Scene) -> Self {
        let joint = |joint: &Joint| {
            let surfaces = match &joint.kind {
                JointKind::Clearance(clearance) => CycleSurfaces::Bore {
                    journal_radius: clearance.journal_radius,
                    has_worn_journal: clearance.wear_coefficients()[1] > 0.0,
                },
                JointKind::Guide(guide) if guide.wear_coefficients() != [0.0; 2] => {
                    CycleSurfaces::Guide { half_length: 0.5 * guide.length }
                }
                _ => return None,
            };
            Some(CycleJoint { name: joint.name.clone(), surfaces })
        };
        let given = |output: &Output| output.kind.wear().is_none().then(|| output.name.clone());
        let mut joints: Vec<CycleJoint> = scene.joints.iter().filter_map(joint).collect();
        joints.sort_by_key(|joint| matches!(joint.surfaces, CycleSurfaces::Guide { .. }));
        ExpectedCycle {
            joints,
            outputs: scene.outputs.iter().map(given).collect(),
            period: scene.life.period,
        }
    }

    /// The cycle of the life that begins at `cycle`, from the text of a reply: an object, or a table of a results file.
    ///
    /// # Errors
    /// [`NoResult`].
    pub fn read(&self, text: &str, cycle: u32) -> Result<CycleReply, NoResult> {
        let text = text.trim_start_matches('\u{feff}').trim();
        self.of_object(&object(text)?.map_or_else(|| of_table(text), Ok)?, cycle)
    }

    /// [`ExpectedCycle::read`] of a reply that is an object.
    ///
    /// # Errors
    /// [`NoResult`].
    pub fn of_object(&self, reply: &Map<String, Value>, cycle: u32) -> Result<CycleReply, NoResult> {
        let field =
            |name: &str| by_name(reply, name)?.ok_or_else(|| NoResult::Fault(format!("{name} is missing")));
        let given = field("joints")?;
        let mut joints = Vec::with_capacity(self.joints.len());
        for joint in &self.joints {
            let Some(Value::Object(of_joint)) = given.get(&joint.name) else {
                let found: Vec<&str> = given.keys().map(String::as_str).collect();
                return Err(format!("joints.{} is missing; found: {}", joint.name, found.join(", ")).into());
            };
            let fields = Fields { place: format!("joints.{}", joint.name), values: of_joint, cycle };
            let shared = Fields { place: String::new(), values: reply, cycle };
            let time =
                fields.list("time", None).transpose().or_else(|| shared.list("time", None).transpose());
            let time = time.ok_or_else(|| format!("{}.time is missing", fields.place))??;
            joints.push(self.joint(joint, &fields, time)?);
        }
        let mut outputs = vec![0.0; self.outputs.len()];
        for (value, name) in outputs.iter_mut().zip(&self.outputs) {
            let Some(name) = name else { continue };
            let number = field("outputs")?.get(name).ok_or_else(|| format!("outputs.{name} is missing"))?;
            *value = number_of(&format!("outputs.{name}"), number, cycle)?;
        }
        let sampling_error = joints.iter().map(sampling_error).fold(0.0, f64::max);
        Ok(CycleReply { joints, outputs, sampling_error })
    }

    /// The first of the sizes of input and output vectors that no model of this cycle with this many `inputs` has, and what is expected; `None`
    /// if both fit.
    pub(super) fn misfit(&self, inputs: usize, sizes: &[Vec<usize>; 2]) -> Option<(Vec<usize>, String)> {
        let (joints, outputs) = (self.joints.len(), self.outputs.iter().flatten().count());
        let [taken, given] = sizes;
        let count = 1 + 2 * joints;
        if taken.len() != count || taken[0] != inputs {
            let expected =
                format!("{inputs} inputs, then radii of bushing and journal of each joint: {count} vectors");
            return Some((taken.clone(), expected));
        }
        let of_cycle = match given.split_first() {
            Some((first, rest)) if outputs > 0 && *first == outputs => rest,
            _ if outputs > 0 => &[],
            _ => given,
        };
        // The first 3, the first 4 or all fields of every joint.
        let fields = |most| {
            self.joints.iter().map(move |joint| joint.surfaces.fields().len().min(most)).sum::<usize>()
        };
        let counts = [3, 4, 6].map(fields);
        if counts.contains(&of_cycle.len().saturating_sub(1))
            && of_cycle.iter().all(|size| *size == of_cycle[0])
        {
            return None;
        }
        let vectors = counts.map(|count| usize::from(outputs > 0) + 1 + count);
        let expected = format!(
            "{outputs} outputs if there are any, the instants, then of each joint the first 3, the first 4 or all of {}: {vectors:?} vectors",
            self.joints[0].surfaces.fields().join(", ")
        );
        Some((given.clone(), expected))
    }

    /// The object of a reply from the output vectors of a model, whose sizes fit.
    pub(super) fn object_of(&self, vectors: Vec<Vec<Value>>) -> Map<String, Value> {
        let mut vectors = vectors.into_iter();
        let mut outputs = Map::new();
        let mut names = self.outputs.iter().flatten().cloned().peekable();
        if names.peek().is_some() {
            outputs.extend(names.zip(vectors.next().into_iter().flatten()));
        }
        let time = vectors.next().unwrap_or_default();
        // As many of the longest list as there are on the average, none of them less than three.
        let most = vectors.len().div_ceil(self.joints.len());
        let joint = |joint: &CycleJoint| {
            let fields = joint.surfaces.fields();
            let columns = fields[..most.min(fields.len())].iter().zip(vectors.by_ref());
            let columns = columns.map(|(field, column)| ((*field).to_owned(), Value::from(column)));
            (joint.name.clone(), Value::Object(columns.collect()))
        };
        let joints = self.joints.iter().map(joint).collect();
        reply_object(Some(time.into()), joints, outputs)
    }

    /// The contacts of a joint at the instants `time` [s].
    fn joint(&self, joint: &CycleJoint, fields: &Fields, time: Vec<f64>) -> Result<JointCycle, NoResult> {
        let place = &fields.place;
        let is_closed = self.is_closed(place, &time)?;
        let n = Some(time.len());
        let required = |name: &str| {
            fields.list(name, n)?.ok_or_else(|| NoResult::Fault(format!("{place}.{name} is missing")))
        };
        let sliding = fields.list("sliding", n)?;
        let pairs = |x: Vec<f64>, y: Vec<f64>| x.into_iter().zip(y).map(<[f64; 2]>::from).collect::<Vec<_>>();
        let (normal, contacts) = match joint.surfaces {
            CycleSurfaces::Bore { has_worn_journal, .. } => {
                let force = pairs(required("force_x")?, required("force_y")?);
                let angle = fields.list("angle", n)?;
                let eccentricity =
                    match (fields.list("eccentricity_x", n)?, fields.list("eccentricity_y", n)?) {
                        (Some(x), Some(y)) => Some(pairs(x, y)),
                        (None, None) => None,
                        _ => {
                            return Err(format!(
                                "{place}: eccentricity_x and eccentricity_y need each other"
                            )
                            .into());
                        }
                    };
                if angle.is_none() && has_worn_journal {
                    let fault =
                        format!("{place}.angle is missing: the journal wears at places that turn with it");
                    return Err(fault.into());
                }
                let normal = force.iter().map(|[x, y]| x.hypot(*y)).collect();
                (normal, CycleContacts::Bore { force, angle, eccentricity })
            }
            CycleSurfaces::Guide { half_length } => {
                let load = pairs(required("force")?, required("moment")?);
                let least: Vec<f64> =
                    load.iter().map(|[force, moment]| force.abs().max(moment.abs() / half_length)).collect();
                let given = fields.list("normal", n)?;
                if let Some(k) =
                    given.iter().flatten().zip(&least).position(|(n, least)| *n < (1.0 - ROUNDING) * least)
                {
                    let fault = format!(
                        "{place}.normal[{k}] is less than the faces need for force and moment: it is the sum of the forces on both"
                    );
                    return Err(fault.into());
                }
                (given.unwrap_or(least), CycleContacts::Guide { load, position: required("position")? })
            }
        };
        let mut cycle = JointCycle { time, normal, sliding: vec![], contacts };
        if !is_closed {
            cycle.close(self.period);
        }
        let of_motion: Option<Vec<f64>> = match (&cycle.contacts, joint.surfaces) {
            (CycleContacts::Bore { angle, .. }, CycleSurfaces::Bore { journal_radius, .. }) => {
                let rates = angle.as_ref().map(|angle| slopes(&cycle.time, angle));
                rates.map(|rates| rates.into_iter().map(|rate| journal_radius * rate).collect())
            }
            (CycleContacts::Guide { position, .. }, _) => Some(slopes(&cycle.time, position)),
            _ => None,
        };
        let neither = || format!("{place}: neither sliding nor angle is given");
        cycle.sliding = sliding.or_else(|| of_motion.clone()).ok_or_else(neither)?;
        cycle.sliding.resize(cycle.time.len(), cycle.sliding[0]);
        check_joint(joint, &cycle, of_motion.as_deref()).map_err(|fault| format!("{place}.{fault}"))?;
        Ok(cycle)
    }

    /// True if the last of these instants is the first one of the next cycle.
    ///
    /// # Errors
    /// They do not ascend, or do not cover the cycle.
    fn is_closed(&self, place: &str, time: &[f64]) -> Result<bool, String> {
        let period = self.period;
        if time.len() < 3 {
            return Err(format!("{place}.time has {} instants, expected at least 3", time.len()));
        }
        if let Some(k) = time.windows(2).position(|pair| pair[1] <= pair[0]) {
            let (before, after) = (time[k], time[k + 1]);
            return Err(format!("{place}.time[{}] is {after} s after {before} s: instants ascend", k + 1));
        }
        let covered = time[time.len() - 1] - time[0];
        let longest = time.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
        let gap = period - covered;
        if gap.abs() <= ROUNDING * period {
            return Ok(true);
        }
        if gap < 0.0 || gap > LONGEST_GAP * longest {
            return Err(format!("{place}.time covers {covered} s of a cycle of {period} s"));
        }
        Ok(false)
    }
}

/// Fields of an object at a `place` of the reply.
struct Fields<'a> {
    place: String,
    values: &'a Map<String, Value>,
    cycle: u32,
}

impl Fields<'_> {
    /// The numbers of a field, `n` of them if that is known; `None` without the field.
    fn list(&self, name: &str, n: Option<usize>) -> Result<Option<Vec<f64>>, NoResult> {
        let field = if self.place.is_empty() { name.to_owned() } else { format!("{}.{name}", self.place) };
        let list = match self.values.get(name) {
            None => return Ok(None),
            Some(Value::Array(list)) => list,
            Some(other) => {
                return Err(format!("{field} is {}, expected a list", shown(&other.to_string())).into());
            }
        };
        if let Some(n) = n.filter(|n| *n != list.len()) {
            return Err(format!("{field} has {} values, expected {n} as time", list.len()).into());
        }
        // A name for every number would take longer than the number.
        let number =
            |(k, value): (usize, &Value)| match value.as_f64().filter(|number| number.abs() <= LARGEST) {
                Some(number) => Ok(number),
                None => number_of(&format!("{field}[{k}]"), value, self.cycle),
            };
        list.iter().enumerate().map(number).collect::<Result<_, _>>().map(Some)
    }
}

fn number_of(field: &str, value: &Value, cycles: u32) -> Result<f64, NoResult> {
    number(value, field, cycles, || format!("{field} is {} instead of a number", shown(&value.to_string())))
}

/// The object of a reply that the table stands for.
///
/// # Errors
/// The line and the column that is no number.
pub fn of_table(text: &str) -> Result<Map<String, Value>, String> {
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default();
    let names: Vec<&str> = header.split(',').map(|name| name.trim().trim_matches('"')).collect();
    if !names.contains(&"time") && !names.iter().any(|name| name.ends_with(".time")) {
        return Err(format!("line 1: \"{}\" has no column time", shown(header)));
    }
    let mut columns: Vec<Vec<Value>> = vec![vec![]; names.len()];
    for (k, line) in lines.enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        if cells.len() != names.len() {
            return Err(format!("line {}: {} values, expected {}", k + 2, cells.len(), names.len()));
        }
        for ((cell, column), name) in cells.into_iter().zip(&mut columns).zip(&names) {
            let number = cell.parse().ok().and_then(serde_json::Number::from_f64).map(Value::Number);
            let word = is_non_finite_word(cell).then(|| Value::from(cell));
            let value = number.or(word);
            column.push(
                value.ok_or_else(|| format!("line {}, column {name}: \"{cell}\" is no number", k + 2))?,
            );
        }
    }
    let (mut time, mut joints, mut outputs) = (None, Map::new(), Map::new());
    for (name, mut column) in names.into_iter().zip(columns) {
        if name == "time" {
            time = Some(column.into());
        } else if let Some((joint, field)) = name.split_once('.') {
            let of_joint = joints.entry(joint).or_insert_with(|| Value::Object(Map::new()));
            of_joint[field] = column.into();
        } else if let Some(last) = column.pop() {
            outputs.insert(name.into(), last);
        }
    }
    Ok(reply_object(time, joints, outputs))
}

/// A reply of these parts.
fn reply_object(
    time: Option<Value>,
    joints: Map<String, Value>,
    outputs: Map<String, Value>,
) -> Map<String, Value> {
    let time = time.map(|time| ("time", time));
    let parts = time.into_iter().chain([("joints", joints.into()), ("outputs", outputs.into())]);
    parts.map(|(key, value)| (key.to_owned(), value)).collect()
}
