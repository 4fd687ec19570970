//! Figures of the nominal mechanism over a cycle: forces and motion, on the unworn and on the worn bores.

use super::{file_name, range, words};
use crate::presentation::report::format::fixed;
use crate::presentation::report::{Axis, Figure, Ink, Plot, Points, ReportInput, Series, Shape};
use common::outputs::{BodyTrace, CycleHistory};
use common::scene::{Output, OutputKind, OutputUnit};

/// Named curves over time [ms].
type Traces = Vec<(String, Points)>;

/// A quantity of a body over a cycle.
struct BodyQuantity {
    values: fn(&BodyTrace) -> &[f64],
    unit: OutputUnit,
    name: &'static str,
}

static SPEED: BodyQuantity =
    BodyQuantity { values: |body| &body.speed, unit: OutputUnit::AngularVelocity, name: "angular velocity" };
static ANGLE: BodyQuantity =
    BodyQuantity { values: |body| &body.angle, unit: OutputUnit::Angle, name: "angle" };

/// Joint forces, angles and angular velocities of the settled first cycle of the unworn nominal mechanism.
pub fn first_cycle(input: &ReportInput) -> Vec<Figure> {
    let Some(cycle) = input.nominal.as_ref().and_then(|nominal| nominal.first_cycle.as_ref()) else {
        return vec![];
    };
    let units = &input.scene.units;
    let [angle, speed] = [&ANGLE, &SPEED].map(|quantity| units.of(quantity.unit.clone()));
    let extremes = cycle.bodies.iter().map(|body| {
        let (low, high) = range(body.angle.iter().map(|value| angle.to_shown(*value)));
        let [low, high] = [low, high].map(|value| angle.after(&fixed(value, 3)).replace(" deg", "°"));
        format!("{}: {low} to {high}", body.label)
    });
    let extremes = format!("{}.", extremes.collect::<Vec<_>>().join("; "));
    let traces = |shown: &BodyQuantity, unit: &OutputUnit| -> Traces {
        let trace = |body: &BodyTrace| (body.label.clone(), trace(cycle, (shown.values)(body), unit));
        cycle.bodies.iter().map(trace).collect()
    };
    let title = "Joint forces of the first cycle";
    let of_angles = ["angles", "Angles of the first cycle", &axis(&angle, ANGLE.name)];
    let of_speeds =
        ["angular-velocities", "Angular velocities of the first cycle", &axis(&speed, SPEED.name)];
    let force = units.of(OutputUnit::Force);
    let figures = [
        forces(cycle, &force, ["joint-forces", title, "Unworn nominal mechanism, settled."]),
        over_time(cycle, of_angles, traces(&ANGLE, &angle), &extremes),
        over_time(cycle, of_speeds, traces(&SPEED, &speed), "Of the bodies above, with the same signs."),
    ];
    figures.into_iter().flatten().collect()
}

/// The effect of wear: the joint forces of the last cycle, and for every output that compares two bodies their difference
/// in the first and in the last cycle.
pub fn last_cycle(input: &ReportInput) -> Vec<Figure> {
    let Some(nominal) = &input.nominal else { return vec![] };
    let (Some(first), Some(worn)) = (&nominal.first_cycle, &nominal.worn) else { return vec![] };
    let Some(last) = &worn.last_cycle else { return vec![] };
    let of_output = |output: &Output| {
        let (a, b, quantity) = match &output.kind {
            OutputKind::AngularVelocityDifference { a, b } => (a, b, &SPEED),
            OutputKind::AngleDifference { a, b } => (a, b, &ANGLE),
            _ => return None,
        };
        let unit = input.scene.units.of(quantity.unit.clone());
        let difference = |cycle: &CycleHistory| -> Option<Points> {
            let values =
                |label: &str| cycle.bodies.iter().find(|body| body.label == label).map(quantity.values);
            let pairs = values(&a.label)?.iter().zip(values(&b.label)?);
            Some(trace(cycle, &pairs.map(|(a, b)| a - b).collect::<Vec<f64>>(), &unit))
        };
        let cycles = [("first cycle", first), ("last cycle", last)];
        let pair = |(name, cycle): (&str, &CycleHistory)| Some((name.to_owned(), difference(cycle)?));
        let traces: Traces = cycles.into_iter().filter_map(pair).collect();
        let caption = format!(
            "{} of {} minus that of {}, with unworn bores and with the bores at the end of life. The output {} is its \
             largest magnitude.",
            quantity.name,
            a.label,
            b.label,
            words(&output.name)
        );
        let name = &format!("difference-{}", file_name(&output.name));
        let title = &format!("{} against {}", super::capital(&a.label), b.label);
        let label = &axis(&unit, "difference");
        over_time(first, [name, title, label], traces, &super::capital(&caption))
    };
    let (title, state) =
        ("Joint forces of the last cycle", "Nominal mechanism, bores worn to the end of life.");
    let forces = forces(last, &input.scene.units.of(OutputUnit::Force), ["joint-forces-worn", title, state]);
    input.scene.outputs.iter().filter_map(of_output).chain(forces).collect()
}

/// Label of an axis with its unit, degrees with their sign.
fn axis(unit: &OutputUnit, what: &str) -> String {
    unit.axis(what).replace("[deg]", "[°]")
}

/// Force of every joint over a cycle, with their peaks; `[name, title, what it is of]`.
fn forces(cycle: &CycleHistory, unit: &OutputUnit, [name, title, state]: [&str; 3]) -> Option<Figure> {
    let force = |(joint, force): &(String, Vec<f64>)| (format!("joint {joint}"), trace(cycle, force, unit));
    let forces = cycle.joint_force.iter().map(force).collect();
    let peak = |(name, force): &(String, Vec<f64>)| {
        let largest = force.iter().copied().fold(0.0, f64::max);
        format!("{name}: {}", unit.after(&fixed(unit.to_shown(largest), 2)))
    };
    let peaks: Vec<String> = cycle.joint_force.iter().map(peak).collect();
    let caption = format!("{state} Peaks of joints {}.", peaks.join(", "));
    over_time(cycle, [name, title, &axis(unit, "joint force")], forces, &caption)
}

/// Values over the time [ms] of a cycle in the unit shown.
fn trace(cycle: &CycleHistory, values: &[f64], unit: &OutputUnit) -> Points {
    thinned(cycle.time.iter().zip(values).map(|(t, v)| (t * 1e3, unit.to_shown(*v))).collect())
}

/// Curves over the time of a cycle; `[name, title, label of the vertical axis]`.
fn over_time(
    cycle: &CycleHistory,
    [name, title, label]: [&str; 3],
    traces: Traces,
    caption: &str,
) -> Option<Figure> {
    let time = &cycle.time;
    if traces.is_empty() || time.len() < 2 {
        return None;
    }
    let (low, high) = range(traces.iter().flat_map(|(_, points)| points.iter().map(|p| p.1)));
    // Traces of mirrored halves nearly coincide: every second one is dashed, so that both are visible.
    let line = |(k, (label, points)): (usize, (String, Points))| {
        let shape = if k % 2 == 1 { Shape::Dashed(points) } else { Shape::Line(points) };
        Series::new(label, Ink::Series(k), shape)
    };
    let series: Vec<Series> = traces.into_iter().enumerate().map(line).collect();
    let margin = 0.04 * (high - low);
    let x = Axis::linear("time [ms]", (time[0] * 1e3, time[time.len() - 1] * 1e3));
    let y = Axis::linear(label, (if low >= 0.0 { 0.0 } else { low - margin }, high + margin));
    Some(Plot { figure: name, x, y, series: &series }.figure(title, caption))
}

/// Number of buckets to which a dense trace is thinned: more than the width of a figure in pixels.
const BUCKETS: usize = 700;

/// A trace reduced to the lowest and the highest point of every bucket, which keeps all peaks; traces of few points are
/// unchanged.
fn thinned(points: Points) -> Points {
    let size = points.len().div_ceil(BUCKETS);
    if size <= 2 {
        return points;
    }
    let mut kept = Vec::with_capacity(2 * BUCKETS + 2);
    for bucket in points.chunks(size) {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let ends = [bucket.iter().min_by(by_value), bucket.iter().max_by(by_value)];
        let mut ends: Vec<_> = ends.into_iter().flatten().copied().collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        kept.extend(ends);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dense_trace_keeps_its_peaks() {
        let mut points: Vec<_> = (0..100_000).map(|k| (f64::from(k), 1.0)).collect();
        points[54_321].1 = 9.0;
        points[54_322].1 = -9.0;
        let kept = thinned(points);
        assert!(kept.len() <= 2 * BUCKETS && kept.is_sorted_by(|a, b| a.0 <= b.0));
        assert_eq!(range(kept.iter().map(|p| p.1)), (-9.0, 9.0));
    }
}
