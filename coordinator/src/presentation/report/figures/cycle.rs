//! Figures of the nominal mechanism over a cycle: forces and motion, on the unworn and on the worn bores; and before anything is
//! simulated the loads that vary by curves over the angle of the crank: a table that acts at the wrong angle is seen.

use super::{file_name, range, words};
use crate::presentation::report::format::{fixed, fixed_with_unit, joined, three_digits, unit_scale};
use crate::presentation::report::mechanism::{Pose, place};
use crate::presentation::report::{Axis, Figure, Ink, Plot, Points, ReportInput, Series, Shape};
use common::outputs::{BodyTrace, CycleHistory};
use common::scene::monotone::monotone_value;
use common::scene::{Load, Motion, Output, OutputKind, OutputUnit, Over, Scene};
use std::collections::BTreeSet;

/// Named curves over time [ms].
type Traces = Vec<(String, Points)>;

/// A quantity of a body over a cycle: its values, its unit and its name.
type BodyQuantity = (fn(&BodyTrace) -> &[f64], OutputUnit, &'static str);

static SPEED: BodyQuantity = (|body| &body.speed, OutputUnit::AngularVelocity, "angular velocity");
static ANGLE: BodyQuantity = (|body| &body.angle, OutputUnit::Angle, "angle");

/// Joint forces, angles and angular velocities of the first measured cycle of the unworn nominal mechanism.
pub fn first_cycle(input: &ReportInput) -> Vec<Figure> {
    let Some(cycle) = input.first_cycle() else { return vec![] };
    let units = &input.scene.units;
    let [angle, speed] = [&ANGLE, &SPEED].map(|(_, unit, _)| units.of(unit.clone()));
    let extremes = cycle.bodies.iter().map(|body| {
        let (low, high) = range(body.angle.iter().map(|value| angle.to_shown(*value)));
        let [low, high] = [low, high].map(|value| angle.after(&fixed(value, 3)).replace(" deg", "°"));
        format!("{}: {low} to {high}", body.label)
    });
    let condition = input.scene.conditions.first();
    let under = condition.map_or(String::new(), |condition| format!(" under condition {}", condition.name));
    let since = if input.scene.life.is_single_cycle() { "from its start" } else { "settled" };
    let (state, of) = if input.scene.simulator.is_some() {
        let state = format!("Unworn surfaces{under}, as the program gives it.");
        (state, "Journal's body relative to the bushing's, by joint: ")
    } else {
        (format!("Unworn nominal mechanism{under}, {since}."), "")
    };
    let extremes = format!("{of}{}.", joined(extremes, "; "));
    let traces = |(values, ..): &BodyQuantity, unit: &OutputUnit| -> Traces {
        let trace = |body: &BodyTrace| (body.label.clone(), trace(cycle, values(body), unit));
        cycle.bodies.iter().map(trace).collect()
    };
    let title = "Joint forces of the first cycle";
    let of_angles = ["angles", "Angles of the first cycle", &axis(&angle, ANGLE.2)];
    let of_speeds = ["angular-velocities", "Angular velocities of the first cycle", &axis(&speed, SPEED.2)];
    let force = units.of(OutputUnit::Force);
    let symbol = units.symbol("mm");
    let length = OutputUnit::Shown {
        usual: Box::new(OutputUnit::Length),
        symbol: symbol.to_owned(),
        si: unit_scale(symbol),
    };
    let stroke = |(joint, position): &(String, Vec<f64>)| {
        let (low, high) = range(position.iter().copied());
        format!("joint {joint} {}", fixed_with_unit(&length, high - low, 2))
    };
    let strokes = joined(cycle.slider_position.iter().map(stroke), ", ");
    let of_sliders = ["slider-positions", "Sliders in the first cycle", &axis(&length, "position")];
    let position =
        |(joint, position): &(String, Vec<f64>)| (format!("joint {joint}"), trace(cycle, position, &length));
    let positions = cycle.slider_position.iter().map(position).collect();
    let figures = [
        forces(cycle, &force, ["joint-forces", title, &state]),
        torques(cycle, &units.of(OutputUnit::Torque)),
        over_time(cycle, of_angles, traces(&ANGLE, &angle), &extremes),
        over_time(cycle, of_speeds, traces(&SPEED, &speed), "As the angles above, with the same signs."),
        over_time(
            cycle,
            of_sliders,
            positions,
            &format!("Middle of the slider along its guide. Stroke: {strokes}."),
        ),
    ];
    figures.into_iter().flatten().collect()
}

/// The effect of wear: the joint forces of the last cycle, and for every output that compares two bodies their difference
/// in the first and in the last cycle.
pub fn last_cycle(input: &ReportInput) -> Vec<Figure> {
    let Some((first, last)) = input.first_cycle().zip(input.last_cycle()) else { return vec![] };
    let of_output = |output: &Output| {
        let (a, b, (values, usual, quantity)) = match &output.kind {
            OutputKind::AngularVelocityDifference { a, b } => (a, b, &SPEED),
            OutputKind::AngleDifference { a, b } => (a, b, &ANGLE),
            _ => return None,
        };
        let unit = input.scene.units.of(usual.clone());
        let difference = |cycle: &CycleHistory| -> Option<Points> {
            let values = |label: &str| cycle.bodies.iter().find(|body| body.label == label).map(values);
            let pairs = values(&a.label)?.iter().zip(values(&b.label)?);
            Some(trace(cycle, &pairs.map(|(a, b)| a - b).collect::<Vec<f64>>(), &unit))
        };
        let cycles = [("first cycle", first), ("last cycle", last)];
        let pair = |(name, cycle): (&str, &CycleHistory)| Some((name.to_owned(), difference(cycle)?));
        let traces: Traces = cycles.into_iter().filter_map(pair).collect();
        let caption = format!(
            "{quantity} of {} minus that of {}, with unworn bores and with the bores at the end of life. The output {} is its \
             largest magnitude.",
            a.label,
            b.label,
            words(&output.name)
        );
        let name = &format!("difference-{}", file_name(&output.name));
        let title = &format!("{} against {}", super::capital(&a.label), b.label);
        let label = &axis(&unit, "difference");
        over_time(first, [name, title, label], traces, &super::capital(&caption))
    };
    let (title, state) = ("Joint forces of the last cycle", "Surfaces worn to the end of life.");
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
        let largest = force.iter().fold(0.0, |a: f64, force| a.max(force.abs()));
        format!("{name}: {}", fixed_with_unit(unit, largest, 2))
    };
    let caption = format!("{state} Peaks of joints {}.", joined(cycle.joint_force.iter().map(peak), ", "));
    over_time(cycle, [name, title, &axis(unit, "joint force")], forces, &caption)
}

/// Torque of every driven body over the first cycle.
fn torques(cycle: &CycleHistory, unit: &OutputUnit) -> Option<Figure> {
    let of_bodies = &cycle.driving_torque;
    let extremes = |(body, torque): &(String, Vec<f64>)| {
        let [low, high] = <[f64; 2]>::from(range(torque.iter().copied())).map(|si| unit.to_shown(si));
        format!("{body}: {} to {}", three_digits(low), unit.after(&three_digits(high)))
    };
    let caption = format!(
        "What moves the driven bodies as given, positive counter-clockwise. {}.",
        joined(of_bodies.iter().map(extremes), "; ")
    );
    let curves = of_bodies.iter().map(|(body, torque)| (body.clone(), trace(cycle, torque, unit))).collect();
    let names = ["driving-torque", "Driving torque of the first cycle", &axis(unit, "torque")];
    over_time(cycle, names, curves, &caption)
}

/// Values over the time [ms] of a cycle in the unit shown.
fn trace(cycle: &CycleHistory, values: &[f64], unit: &OutputUnit) -> Points {
    cycle.time.iter().zip(values).map(|(t, v)| (t * 1e3, unit.to_shown(*v))).collect()
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

/// Loads that vary over a cycle, by curves or as directional springs.
pub struct VaryingLoads {
    /// What they vary over, with its unit, e.g. `angle of crank [deg]`.
    over: String,
    /// Name, unit and values of each over the angle [deg], or the time [s] without a driven body.
    loads: Vec<(String, String, Points)>,
}

impl VaryingLoads {
    /// The loads of a scene through the poses of a cycle `(n, bodies)` at these times `(n,)` [s]; `None` without such loads, or for a single
    /// pose.
    pub fn new(scene: &Scene, cycle: &[Vec<Pose>], times: &[f64]) -> Option<Self> {
        let crank = scene.bodies.iter().position(|body| matches!(body.motion, Motion::Driven { .. }));
        let angle = |poses: &[Pose], body: usize| poses[body].1;
        let at = |k: usize| crank.map_or(times[k], |body| angle(&cycle[k], body).to_degrees());
        let shown = |name: String, si: &str, value: &dyn Fn(usize) -> f64| {
            let unit = scene.units.symbol(si);
            let points = (0..cycle.len()).map(|k| (at(k), value(k) / unit_scale(unit))).collect();
            (name, unit.to_owned(), points)
        };
        let loads = scene.loads.iter().filter_map(|load| {
            if let Load::DirectionalSpring { name, at, anchor, direction: [dx, dy], stiffness, free_length } =
                load
            {
                let pull = |k: usize| {
                    let [p, a] = [at, anchor].map(|point| place(&cycle[k], point));
                    -stiffness * (dx * (p[0] - a[0]) + dy * (p[1] - a[1]) - free_length)
                };
                return Some(shown(name.clone(), "N", &pull));
            }
            let (name, _, curve, kind) = load.curve()?;
            let value = |k: usize| match curve.over {
                Over::Time => monotone_value(&curve.table, times[k]),
                Over::Angle(body) => monotone_value(&curve.table, angle(&cycle[k], body)),
            };
            Some(shown(name, kind.si, &value))
        });
        let loads: Vec<_> = loads.filter(|_| cycle.len() > 1).collect();
        let of_crank = |body: usize| format!("angle of {} [deg]", scene.bodies[body].name);
        (!loads.is_empty()).then(|| Self { over: crank.map_or("time [s]".to_owned(), of_crank), loads })
    }

    /// A line for each load.
    pub fn lines(&self) -> Vec<String> {
        self.loads.iter().map(|load| self.line(load)).collect()
    }

    /// The range of a load, and where it is first largest in size, but for rounding.
    fn line(&self, (name, unit, points): &(String, String, Points)) -> String {
        let (low, high) = range(points.iter().map(|point| point.1));
        let largest = (1.0 - 1e-9) * low.abs().max(high.abs());
        let place = points.iter().find(|point| point.1.abs() >= largest).map_or(0.0, |point| point.0);
        let (what, of) = self.over.split_once(" [").unwrap_or((&self.over, ""));
        let place = format!("{} {}", fixed(place, if of == "s]" { 4 } else { 0 }), of.trim_end_matches(']'));
        let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
        let [low, high] = [low, high].map(three_digits);
        format!("load {name}: {low} to {high}{unit}, largest at {place}, {what}")
    }

    /// A figure for each unit of the loads.
    pub fn figures(&self) -> Vec<Figure> {
        let units: BTreeSet<&str> = self.loads.iter().map(|load| load.1.as_str()).collect();
        let figure = |(k, unit): (usize, &&str)| {
            let of_unit = self.loads.iter().filter(|load| load.1 == *unit);
            let points = of_unit.clone().flat_map(|load| &load.2);
            let line = |(k, (name, _, points)): (usize, &(String, _, Points))| {
                Series::new(name, Ink::Series(k), Shape::Line(points.clone()))
            };
            let lines = joined(of_unit.clone().map(|load| self.line(load)), "; ");
            let series: Vec<Series> = of_unit.enumerate().map(line).collect();
            let (low, high) = range(points.clone().map(|point| point.1));
            let margin = 0.04 * (high - low).max(f64::MIN_POSITIVE);
            let label = if unit.is_empty() { "factor".to_owned() } else { format!("load [{unit}]") };
            let x = Axis::linear(&self.over, range(points.map(|point| point.0)));
            let y = Axis::linear(&label, ((low - margin).min(0.0), (high + margin).max(0.0)));
            let figure = &if k == 0 { "loads".to_owned() } else { format!("loads-{}", k + 1) };
            let (what, _) = self.over.split_once(" [").unwrap_or((&self.over, ""));
            let caption =
                format!("By their curves, or by the motion; of springs along their direction. {lines}.");
            Plot { figure, x, y, series: &series }.figure(&format!("Loads over the {what}"), &caption)
        };
        units.iter().enumerate().map(figure).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::{Condition, SceneSource};
    use std::collections::BTreeMap;

    #[test]
    fn a_table_over_the_crank_is_shown_at_the_angles_at_which_it_acts() {
        let load = |name: &str, of: &str, at: &str, unit: &str, values: &str| {
            format!(
                "\n[[loads]]\nname = \"{name}\"\n{of} = {{ over = {{ angle = \"crank\" }}, at = {{ unit = \"deg\", values = {at} }}, \
                 value = {{ unit = \"{unit}\", values = {values} }} }}\n"
            )
        };
        let torque = "type = \"torque\"\nbody = \"rocker\"\ntorque";
        let force =
            "type = \"force\"\nat = { body = \"rocker\", point = \"coupler_pin\" }\ndirection = [1, 0]\nsize";
        let loads = [
            load("card", torque, "[0, 90, 360]", "N m", "[1, -4, 1]"),
            // Largest from 60 to 120 deg.
            load("cut", force, "[0, 60, 120, 360]", "N", "[0, 3, 3, 0]"),
            load("brake", torque, "[0, 180, 360]", "N m", "[0, 2, 0]"),
        ];
        // 1 N - 2 N sin(angle): against twice its free length at the top of the crank's circle.
        let spring = "\n[[loads]]\nname = \"lift\"\ntype = \"directional-spring\"\nat = { body = \"crank\", point = \"pin\" }\n\
            anchor = { body = \"frame\", point = \"rocker_pin\" }\ndirection = [0, 1]\nstiffness = \"100 N/m\"\nfree_length = \"10 mm\"\n";
        let text = format!("{}{}{spring}", SceneSource::builtin("four-bar").unwrap().text(), loads.concat());
        let source = SceneSource::parse(&text, "scene.toml").unwrap();
        let scene = source.nominal();
        let crank = scene.bodies.iter().position(|body| body.name == "crank").unwrap();
        let degrees: Vec<f64> = (0..=36).map(|k| 10.0 * f64::from(k)).collect();
        let pose = |degrees: &f64| {
            let mut poses = vec![([0.0; 2], 0.0); scene.bodies.len()];
            poses[crank].1 = degrees.to_radians();
            poses
        };
        let cycle: Vec<_> = degrees.iter().map(pose).collect();
        let found = VaryingLoads::new(scene, &cycle, &degrees).unwrap();
        let lines = [
            "load card: −4.00 to 1.00 N m, largest at 90 deg, angle of crank",
            "load cut: 0 to 3.00 N, largest at 60 deg, angle of crank",
            "load brake: 0 to 2.00 N m, largest at 180 deg, angle of crank",
            "load lift: −1.00 to 3.00 N, largest at 270 deg, angle of crank",
        ];
        assert_eq!(found.lines(), lines);
        // One figure for each unit, each with its loads.
        let [forces, torques] = &found.figures()[..] else { panic!("a figure for each unit") };
        assert_eq!([&*forces.name, &*torques.name], ["loads", "loads-2"]);
        let from = "By their curves, or by the motion; of springs along their direction.";
        assert_eq!(forces.caption, format!("{from} {}; {}.", lines[1], lines[3]));
        assert_eq!(torques.caption, format!("{from} {}; {}.", lines[0], lines[2]));
        // Half way between two points of equal slope, zero: the mean of their values.
        assert!((found.loads[0].2.iter().find(|p| (p.0 - 45.0).abs() < 5.1).unwrap().1 + 1.0).abs() < 1.0);
        assert!(VaryingLoads::new(scene, &cycle[..1], &degrees).is_none());
    }

    #[test]
    fn torques_of_driven_bodies_have_their_range() {
        let mut input = crate::tests::test_study::report_input();
        let cycle = input.nominal.as_mut().unwrap().first_cycle.as_mut().unwrap();
        let n = cycle.time.len();
        let torque = |k: usize| 0.1 - 0.3 * (std::f64::consts::TAU * k as f64 / (n - 1) as f64).cos();
        cycle.driving_torque = vec![("crank".into(), (0..n).map(torque).collect())];
        let figures = first_cycle(&input);
        let found = figures.iter().find(|figure| figure.name == "driving-torque").unwrap();
        let caption = found.caption.replace('\u{a0}', " ");
        assert!(caption.ends_with("counter-clockwise. crank: \u{2212}0.200 to 0.400 N m."), "{caption}");
        assert!(found.drawing.content.contains("torque [N m]"));
    }

    #[test]
    fn sliders_of_a_program_have_their_positions() {
        let mut input = crate::tests::test_study::report_input();
        let cycle = input.nominal.as_mut().unwrap().first_cycle.as_mut().unwrap();
        let n = cycle.time.len();
        let place = |k: usize| 0.1 + 0.02 * (std::f64::consts::TAU * k as f64 / (n - 1) as f64).sin();
        cycle.slider_position = vec![("rail".into(), (0..n).map(place).collect())];
        let figures = first_cycle(&input);
        let found = figures.iter().find(|figure| figure.name == "slider-positions").unwrap();
        assert!(
            found.caption.replace('\u{a0}', " ").ends_with("Stroke: joint rail 40.00 mm."),
            "{}",
            found.caption
        );
        assert!(found.drawing.content.contains("position [mm]"));
        assert!(figures.iter().all(|figure| figure.name != "driving-torque"));
        // A motion seen once has not settled.
        assert!(figures[0].caption.starts_with("Unworn nominal mechanism, settled. "));
        (input.scene.life.cycles, input.scene.life.settle_cycles) = (1, 0);
        assert!(first_cycle(&input)[0].caption.starts_with("Unworn nominal mechanism, from its start. "));
        let (scene, parameters) = (input.scene.clone(), BTreeMap::new());
        input.scene.conditions = vec![Condition { name: "fast".into(), share: 1.0, scene, parameters }];
        let caption = &first_cycle(&input)[0].caption;
        assert!(caption.starts_with("Unworn nominal mechanism under condition fast, from its start. "));
    }
}
