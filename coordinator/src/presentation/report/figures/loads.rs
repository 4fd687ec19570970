//! Loads that vary by curves over the angle of the crank, before anything is simulated: a table that acts at the wrong angle is seen.

use super::range;
use crate::presentation::report::format::{fixed, three_digits, unit_scale};
use crate::presentation::report::mechanism::Pose;
use crate::presentation::report::{Axis, Figure, Ink, Plot, Points, Series, Shape};
use common::scene::monotone::monotone_value;
use common::scene::{Load, Motion, Over, Scene};

/// Loads that vary by curves over a cycle.
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
        let loads = scene.loads.iter().filter_map(Load::curve).map(|(name, _, curve, kind)| {
            let value = |k: usize| match curve.over {
                Over::Time => monotone_value(&curve.table, times[k]),
                Over::Angle(body) => monotone_value(&curve.table, angle(&cycle[k], body)),
            };
            let unit = scene.units.symbol(kind.si);
            let shown = |k: usize| (at(k), value(k) / unit_scale(unit));
            (name, unit.to_owned(), (0..cycle.len()).map(shown).collect())
        });
        let loads: Vec<_> = loads.filter(|_| cycle.len() > 1).collect();
        let of_crank = |body: usize| format!("angle of {} [deg]", scene.bodies[body].name);
        (!loads.is_empty()).then(|| Self { over: crank.map_or("time [s]".to_owned(), of_crank), loads })
    }

    /// A line for each load: its range, and where it is largest in size.
    pub fn lines(&self) -> Vec<String> {
        let line = |(name, unit, points): &(String, String, Points)| {
            let (low, high) = range(points.iter().map(|point| point.1));
            let largest = points.iter().copied().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
            let place = largest.map_or(0.0, |point| point.0);
            let (what, of) = self.over.split_once(" [").unwrap_or((&self.over, ""));
            let place =
                format!("{} {}", fixed(place, if of == "s]" { 4 } else { 0 }), of.trim_end_matches(']'));
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            format!(
                "load {name}: {} to {}{unit}, largest at {place}, {what}",
                three_digits(low),
                three_digits(high)
            )
        };
        self.loads.iter().map(line).collect()
    }

    /// A figure for each unit of the loads.
    pub fn figures(&self) -> Vec<Figure> {
        let mut units: Vec<&str> = self.loads.iter().map(|load| load.1.as_str()).collect();
        units.dedup();
        let figure = |(k, unit): (usize, &&str)| {
            let of_unit = self.loads.iter().filter(|load| load.1 == *unit);
            let series: Vec<Series> = of_unit
                .enumerate()
                .map(|(k, (name, _, points))| Series::new(name, Ink::Series(k), Shape::Line(points.clone())))
                .collect();
            let points = self.loads.iter().filter(|load| load.1 == *unit).flat_map(|load| &load.2);
            let (low, high) = range(points.clone().map(|point| point.1));
            let margin = 0.04 * (high - low).max(f64::MIN_POSITIVE);
            let label = if unit.is_empty() { "factor".to_owned() } else { format!("load [{unit}]") };
            let x = Axis::linear(&self.over, range(points.map(|point| point.0)));
            let y = Axis::linear(&label, ((low - margin).min(0.0), (high + margin).max(0.0)));
            let figure = &if k == 0 { "loads".to_owned() } else { format!("loads-{}", k + 1) };
            let (what, _) = self.over.split_once(" [").unwrap_or((&self.over, ""));
            let (title, lines) = (format!("Loads over the {what}"), self.lines().join("; "));
            let caption = format!("By their curves. {lines}.");
            Plot { figure, x, y, series: &series }.figure(&title, &caption)
        };
        units.iter().enumerate().map(figure).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;

    #[test]
    fn a_table_over_the_crank_is_shown_at_the_angles_at_which_it_acts() {
        let load = "\n[[loads]]\nname = \"card\"\ntype = \"torque\"\nbody = \"rocker\"\ntorque = { over = { angle = \"crank\" }, \
                    at = { unit = \"deg\", values = [0, 90, 360] }, value = { unit = \"N m\", values = [1, -4, 1] } }\n";
        let text = format!("{}{load}", SceneSource::builtin("four-bar").unwrap().text());
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
        assert_eq!(found.lines(), ["load card: −4.00 to 1.00 N m, largest at 90 deg, angle of crank"]);
        let figures = found.figures();
        assert_eq!((figures.len(), figures[0].name.as_str()), (1, "loads"));
        // Half way between two points of equal slope, zero: the mean of their values.
        assert!((found.loads[0].2.iter().find(|p| (p.0 - 45.0).abs() < 5.1).unwrap().1 + 1.0).abs() < 1.0);
        assert!(VaryingLoads::new(scene, &cycle[..1], &degrees).is_none());
    }
}
