//! The worn bores of the nominal mechanism in polar form, over life where the bores were stored, the orbits of the journals in them, and the
//! forces of journals that another program gives.

use super::file_name;
use crate::presentation::report::format::{count, fixed, fixed_with_unit, joined};
use crate::presentation::report::mechanism::{eccentricity, poses};
use crate::presentation::report::polar::{Polar, Stroke, freest, full_scale};
use crate::presentation::report::{Figure, Ink, ReportInput, csv};
use crate::results::csv_table::number;
use common::outputs::CycleHistory;
use common::scene::{JointKind, OutputUnit};

/// Radius of the unworn bore, as a share of the outermost ring's.
const BORE: f64 = 0.5;

/// Largest number of curves per bore.
const LIVES: u32 = 6;

/// One polar figure per joint with wear: depth outward from the unworn bore, at one scale for all joints.
pub fn bores(input: &ReportInput) -> Vec<Figure> {
    let Some(nominal) = &input.nominal else { return vec![] };
    let deepest = |wear: &[f64]| wear.iter().copied().fold(0.0, f64::max);
    // The faces of guides are in a table.
    let is_bore = |index: usize| {
        let kind = input.scene.joints.get(index).map(|joint| &joint.kind);
        !matches!(kind, Some(JointKind::Guide(_)))
    };
    let bores = || nominal.joints.iter().enumerate().filter(|(index, _)| is_bore(*index));
    let largest = bores().map(|(_, joint)| deepest(&joint.wear_depth)).fold(0.0, f64::max);
    let [depth, force] = [OutputUnit::Length, OutputUnit::Force].map(|usual| input.scene.units.of(usual));
    let full = full_scale(&depth, largest);
    let worn = bores().filter(|(_, joint)| !joint.wear_depth.is_empty());
    worn.map(|(index, joint)| {
        let end = (nominal.cycles.last().copied().unwrap_or(0), joint.wear_depth.as_slice());
        let lives = Some(through_life(input, index)).filter(|lives| !lives.is_empty()).unwrap_or(vec![end]);
        let mut polar = Polar::new(BORE, full);
        for (k, (_, wear)) in lives.iter().enumerate() {
            let last = k + 1 == lives.len();
            let (ink, opacity) = (Ink::Series(0), 0.35 + 0.65 * (k + 1) as f64 / lives.len() as f64);
            if last {
                polar.filled(wear, ink);
            }
            polar.closed(wear, Stroke { ink, width: if last { 2.2 } else { 1.2 }, opacity });
        }
        polar.circle(0.0, Stroke { ink: Ink::Muted, width: 1.2, opacity: 1.0 });
        let wear = end.1;
        let deepest_point = (0..wear.len()).max_by(|a, b| wear[*a].total_cmp(&wear[*b])).unwrap_or(0);
        let degrees = |k: usize| 360.0 * k as f64 / wear.len() as f64;
        let caption = format!(
            "Largest depth {} at {}°; peak force {}.",
            fixed_with_unit(&depth, deepest(wear), 2),
            fixed(degrees(deepest_point), 0),
            fixed_with_unit(&force, joint.peak_force, 2)
        );
        let rows = lives.iter().flat_map(|(cycles, wear)| {
            wear.iter()
                .enumerate()
                .map(move |(k, depth)| vec![cycles.to_string(), number(degrees(k)), number(1e6 * depth)])
        });
        Figure {
            name: format!("bore-{}", file_name(&joint.name)),
            title: format!("Bore of joint {}", joint.name),
            caption,
            drawing: polar.finish(&format!("joint {}", joint.name), freest(wear), &depth),
            csv: csv(&["cycles", "angle [deg]", "wear depth [um]"], rows),
        }
    })
    .collect()
}

/// Bores of a joint at about equal steps over life, the last at its end, as (cycles, depths); empty if the nominal
/// evaluation stores only the end.
fn through_life(input: &ReportInput, joint: usize) -> Vec<(u32, &[f64])> {
    let Some(worn) = input.worn() else { return vec![] };
    lives(&worn.cycles)
        .into_iter()
        .filter_map(|k| Some((worn.cycles[k], worn.wear_depth.get(k)?.get(joint)?.as_slice())))
        .collect()
}

/// Indices into `cycles`, increasing from zero, nearest to equal steps of its last entry.
fn lives(cycles: &[u32]) -> Vec<usize> {
    let Some(end) = cycles.last() else { return vec![] };
    let nearest = |step: u32| {
        let wanted = u64::from(*end) * u64::from(step) / u64::from(LIVES);
        (0..cycles.len()).min_by_key(|k| u64::from(cycles[*k]).abs_diff(wanted)).unwrap_or(0)
    };
    let mut found: Vec<usize> = (1..=LIVES).map(nearest).filter(|k| cycles[*k] > 0).collect();
    found.dedup();
    found
}

/// Lives before its end at which bores are drawn, as text; empty if only the end is stored.
pub fn lives_in_words(input: &ReportInput) -> String {
    let cycles = input.worn().map_or(&[][..], |worn| &worn.cycles);
    let mut all: Vec<String> = lives(cycles).into_iter().map(|k| count(cycles[k].into())).collect();
    all.pop();
    all.join(", ")
}

/// Directions in which the extent of the orbit is determined, to place the labels.
const DIRECTIONS: usize = 36;

/// Of each cycle its name (first or last), its history, and the path of a vector over it `(n, 2)` [SI].
type Paths<'a> = Vec<(&'static str, &'a CycleHistory, Vec<[f64; 2]>)>;

/// Name of a joint, its radial clearance [m], radii of its worn bore at equal angles `(control_points,)` [m], and the orbits of its journal [m].
type Orbits<'a> = (&'a str, f64, Vec<f64>, Paths<'a>);

/// First and last cycle of the nominal evaluation, as far as they are known.
fn cycles(input: &ReportInput) -> impl Iterator<Item = (&'static str, &CycleHistory)> {
    let cycles = [("first", input.first_cycle()), ("last", input.last_cycle())];
    cycles.into_iter().filter_map(|(name, cycle)| Some((name, cycle?)))
}

/// One polar figure per joint with clearance whose orbits the nominal evaluation includes, all at one scale.
pub fn orbits(input: &ReportInput) -> Vec<Figure> {
    let Some(nominal) = &input.nominal else { return vec![] };
    let known: Vec<_> =
        cycles(input).map(|(name, cycle)| (name, cycle, poses(&input.scene, cycle))).collect();
    let orbits = input.scene.joints.iter().enumerate().filter_map(|(index, joint)| {
        let JointKind::Clearance(clearance) = &joint.kind else { return None };
        let orbits = known.iter().filter_map(|(name, cycle, poses)| {
            let orbit: Vec<[f64; 2]> = match poses {
                Some(poses) => poses.iter().map(|poses| eccentricity(poses, joint)).collect(),
                None => cycle.journal(&joint.name)?.eccentricity.clone(),
            };
            (!orbit.is_empty()).then_some((*name, *cycle, orbit))
        });
        let paths: Paths<'_> = orbits.collect();
        let wear = nominal.joints.get(index).map_or(&[][..], |joint| &joint.wear_depth);
        let clearance = clearance.radial_clearance();
        let worn = wear.iter().map(|depth| clearance + depth).collect();
        (!paths.is_empty()).then_some((joint.name.as_str(), clearance, worn, paths))
    });
    let all: Vec<Orbits<'_>> = orbits.collect();
    let reach = |(_, clearance, worn, paths): &Orbits<'_>| {
        paths.iter().map(farthest).chain(worn.iter().copied()).fold(*clearance, f64::max)
    };
    let depth = input.scene.units.of(OutputUnit::Length);
    let full = full_scale(&depth, all.iter().map(reach).fold(0.0, f64::max));
    let orbit = |(name, clearance, worn, paths): &Orbits<'_>| {
        let mut polar = Polar::new(0.0, full);
        polar.circle(*clearance, Stroke { ink: Ink::Muted, width: 1.4, opacity: 1.0 });
        polar.closed(worn, Stroke { ink: Ink::Muted, width: 1.4, opacity: 0.6 });
        let before =
            format!("Radial clearance {}; largest eccentricity: ", fixed_with_unit(&depth, *clearance, 1));
        let texts = ["orbit", "Orbit of journal", &before];
        of_paths(texts, name, (polar, *clearance), paths, (&depth, "um", 1e6))
    };
    all.iter().map(orbit).collect()
}

/// One polar figure per journal whose force another program gives, all at one scale.
pub fn journal_forces(input: &ReportInput) -> Vec<Figure> {
    let of_joint = |joint| {
        let paths = cycles(input);
        let paths =
            paths.filter_map(|(name, cycle)| Some((name, cycle, cycle.journal(joint)?.force.clone())));
        let paths: Paths<'_> = paths.collect();
        (!paths.is_empty()).then_some((joint, paths))
    };
    let names = input.scene.joints.iter().map(|joint| joint.name.as_str());
    let all: Vec<_> = names.filter_map(of_joint).collect();
    let force = input.scene.units.of(OutputUnit::Force);
    let full = full_scale(&force, all.iter().flat_map(|(_, paths)| paths).map(farthest).fold(0.0, f64::max));
    let texts = ["journal-force", "Force of journal", "Largest force: "];
    let figure = |(name, paths): &(&str, Paths<'_>)| {
        of_paths(texts, name, (Polar::new(0.0, full), 0.0), paths, (&force, "N", 1.0))
    };
    all.iter().map(figure).collect()
}

/// Largest size of the vector of a path [SI].
fn farthest((.., path): &(&str, &CycleHistory, Vec<[f64; 2]>)) -> f64 {
    path.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max)
}

/// The paths of the journal of a joint on the rings of `polar`, which are taken up to `least` in every direction; `[name, title, caption]` are
/// what they begin with, and values are shown in a unit, in the file in that of a symbol and a factor.
fn of_paths(
    [name, title, caption]: [&str; 3],
    joint: &str,
    (mut polar, least): (Polar, f64),
    paths: &Paths<'_>,
    (unit, symbol, factor): (&OutputUnit, &str, f64),
) -> Figure {
    let mut reached = vec![least; DIRECTIONS];
    for (cycle, _, path) in paths {
        let ink = Ink::Series(usize::from(*cycle == "last"));
        polar.curve(path, Stroke { ink, width: 3.0, opacity: 1.0 });
        for [x, y] in path.iter().filter(|[x, y]| x.is_finite() && y.is_finite()) {
            let turn = y.atan2(*x).rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU;
            let farthest = &mut reached[(turn * DIRECTIONS as f64) as usize % DIRECTIONS];
            *farthest = farthest.max(x.hypot(*y));
        }
    }
    let largest =
        |path: &(&str, _, _)| format!("{} cycle {}", path.0, fixed_with_unit(unit, farthest(path), 1));
    let rows = paths.iter().flat_map(|(cycle, history, path)| {
        history.time.iter().zip(path).map(move |(time, [x, y])| {
            vec![cycle.to_string(), number(1e3 * time), number(factor * x), number(factor * y)]
        })
    });
    Figure {
        name: format!("{name}-{}", file_name(joint)),
        title: format!("{title} {joint}"),
        caption: format!("{caption}{}.", joined(paths.iter().map(largest), ", ")),
        drawing: polar.finish(&format!("joint {joint}"), freest(&reached), unit),
        csv: csv(&["cycle", "time [ms]", &format!("x [{symbol}]"), &format!("y [{symbol}]")], rows),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::outputs::JournalPath;

    #[test]
    fn journals_of_a_program_have_orbits_and_forces_without_the_motion_of_bodies() {
        let mut input = crate::tests::test_study::report_input();
        let nominal = input.nominal.as_mut().unwrap();
        nominal.worn = None;
        let first = nominal.first_cycle.as_mut().unwrap();
        first.motion.clear();
        let n = first.time.len();
        let around = |size: f64| -> Vec<[f64; 2]> {
            let turn = |k: usize| std::f64::consts::TAU * k as f64 / n as f64;
            (0..n).map(|k| [size * turn(k).cos(), size * turn(k).sin()]).collect()
        };
        let [force, eccentricity] = [12.5, 2e-5].map(around);
        first.journals = vec![JournalPath { joint: "1".into(), force, eccentricity }];
        let [orbit] = &orbits(&input)[..] else { panic!("one orbit") };
        let [force] = &journal_forces(&input)[..] else { panic!("one force") };
        assert_eq!((orbit.name.as_str(), force.name.as_str()), ("orbit-1", "journal-force-1"));
        assert_eq!(force.caption.replace('\u{a0}', " "), "Largest force: first cycle 12.5 N.");
        assert!(force.csv.starts_with("cycle,time [ms],x [N],y [N]\nfirst,"), "{}", force.csv);
    }

    #[test]
    fn lives_are_about_equally_far_apart_and_end_with_the_last() {
        let cycles = [0, 250, 500, 1000, 2000, 4000, 8000, 12_000, 16_000, 20_000, 24_000];
        assert_eq!(lives(&cycles), [5, 6, 7, 8, 9, 10]);
        assert_eq!(lives(&[0, 10]), [1]);
        assert!(lives(&[]).is_empty() && lives(&[0]).is_empty());
    }
}
