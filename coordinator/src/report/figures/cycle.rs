//! Figures of the nominal mechanism: forces and motion over its first cycle, its bores at the end of life.

use super::{Figure, figure, file_name, range};
use crate::report::bore;
use crate::report::format::fixed;
use crate::report::input::ReportInput;
use crate::report::palette::Ink;
use crate::report::plot::{Plot, PlotError, Series, Shape, short};

/// Joint forces, angles and angular velocities of the settled first cycle of the unworn nominal mechanism.
///
/// # Errors
/// [`PlotError`].
pub fn first_cycle(input: &ReportInput) -> Result<Vec<Figure>, PlotError> {
    let Some(cycle) = input.nominal.as_ref().and_then(|nominal| nominal.first_cycle.as_ref()) else {
        return Ok(vec![]);
    };
    let time: Vec<f64> = cycle.time.iter().map(|t| t * 1e3).collect();
    let trace = |values: &[f64], factor: f64| -> Vec<(f64, f64)> {
        thinned(time.iter().zip(values).map(|(t, v)| (*t, v * factor)).collect())
    };
    let forces: Vec<_> =
        cycle.joint_force.iter().map(|(n, f)| (format!("joint {n}"), trace(f, 1.0))).collect();
    let degrees = 180.0 / std::f64::consts::PI;
    let rpm = 30.0 / std::f64::consts::PI;
    let angles = cycle.bodies.iter().map(|body| (body.label.clone(), trace(&body.angle, degrees))).collect();
    let speeds = cycle.bodies.iter().map(|body| (body.label.clone(), trace(&body.speed, rpm))).collect();
    let peaks: Vec<String> = cycle
        .joint_force
        .iter()
        .map(|(name, force)| format!("{name}: {} N", fixed(force.iter().copied().fold(0.0, f64::max), 2)))
        .collect();
    let extremes: Vec<String> = cycle
        .bodies
        .iter()
        .map(|body| {
            let (low, high) = range(body.angle.iter().map(|angle| angle * degrees));
            format!("{}: {}° to {}°", body.label, fixed(low, 3), fixed(high, 3))
        })
        .collect();
    type Traces = Vec<(String, Vec<(f64, f64)>)>;
    let sides: [(&str, &str, &str, Traces, String); 3] = [
        (
            "joint-forces",
            "Joint forces of the first cycle",
            "joint force [N]",
            forces,
            format!("Unworn nominal mechanism, settled. Peaks of joints {}.", peaks.join(", ")),
        ),
        ("angles", "Angles of the first cycle", "angle [°]", angles, format!("{}.", extremes.join("; "))),
        (
            "angular-velocities",
            "Angular velocities of the first cycle",
            "angular velocity [r/min]",
            speeds,
            "Of the bodies above, in the same sense.".into(),
        ),
    ];
    let mut figures = Vec::new();
    for (name, title, y_label, traces, caption) in sides {
        if traces.is_empty() || time.len() < 2 {
            continue;
        }
        let (low, high) = range(traces.iter().flat_map(|(_, points)| points.iter().map(|p| p.1)));
        // Traces of mirrored halves nearly coincide: every second one is broken, so that both are seen.
        let series: Vec<_> = traces
            .into_iter()
            .enumerate()
            .map(|(k, (label, points))| {
                let shape = if k % 2 == 1 { Shape::Dashed(points) } else { Shape::Line(points) };
                Series::new(label, Ink::Series(k), shape)
            })
            .collect();
        let margin = 0.04 * (high - low);
        let svg = Plot {
            figure: name,
            x_label: "time [ms]",
            y_label,
            x: (time[0], time[time.len() - 1]),
            y: (if low >= 0.0 { 0.0 } else { low - margin }, high + margin),
            x_text: &short,
            y_text: &short,
            series: &series,
        }
        .svg()?;
        figures.push(figure(name, title, &caption, svg));
    }
    Ok(figures)
}

/// One polar figure per joint of the nominal mechanism with wear, all on one scale.
pub fn bores(input: &ReportInput) -> Vec<Figure> {
    let Some(nominal) = &input.nominal else { return vec![] };
    let deepest = |wear: &[f64]| wear.iter().copied().fold(0.0, f64::max);
    let largest = nominal.joints.iter().map(|joint| deepest(&joint.wear_depth)).fold(0.0, f64::max);
    let full = bore::full_scale(largest);
    let worn = nominal.joints.iter().filter(|joint| !joint.wear_depth.is_empty());
    worn.map(|joint| {
        let wear = &joint.wear_depth;
        let place = (0..wear.len()).max_by(|a, b| wear[*a].total_cmp(&wear[*b])).unwrap_or(0);
        let caption = format!(
            "Deepest {} µm at {}°; peak force {} N.",
            fixed(1e6 * deepest(wear), 2),
            fixed(360.0 * place as f64 / wear.len() as f64, 0),
            fixed(joint.peak_force, 2)
        );
        let name = format!("bore-{}", file_name(&joint.name));
        figure(&name, &format!("Bore of joint {}", joint.name), &caption, bore::svg(&joint.name, wear, full))
    })
    .collect()
}

/// Buckets a dense trace is thinned to: more than a figure has pixels across.
const BUCKETS: usize = 700;

/// A trace with its lowest and highest point of every bucket alone, so that no peak is lost; traces of few points
/// stay as they are.
fn thinned(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
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
