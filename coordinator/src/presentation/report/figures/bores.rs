//! The worn bores of the nominal mechanism in polar form, over life where the bores were stored, and the orbits of
//! the journals in them.

use super::file_name;
use crate::presentation::report::format::{count, fixed, fixed_with_unit, joined};
use crate::presentation::report::mechanism::{Pose, eccentricity, poses};
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

/// Name of a joint, its radial clearance [m], radii of its worn bore at equal angles `(control_points,)` [m], and of each cycle its name
/// (first or last), history, and orbit `(n, 2)` [m].
type Orbits<'a> = (&'a str, f64, Vec<f64>, Vec<(&'static str, &'a CycleHistory, Vec<[f64; 2]>)>);

/// One polar figure per joint with clearance whose motion the nominal evaluation includes, all at one scale.
pub fn orbits(input: &ReportInput) -> Vec<Figure> {
    let Some(nominal) = &input.nominal else { return vec![] };
    let cycles = [("first", input.first_cycle()), ("last", input.last_cycle())];
    let with_poses = |(name, cycle): (&'static str, Option<_>)| {
        let poses = poses(&input.scene, cycle?).filter(|poses| !poses.is_empty())?;
        Some((name, cycle?, poses))
    };
    let known: Vec<_> = cycles.into_iter().filter_map(with_poses).collect();
    let orbits = input.scene.joints.iter().enumerate().filter_map(|(index, joint)| {
        let JointKind::Clearance(clearance) = &joint.kind else { return None };
        let orbit = |poses: &Vec<Vec<Pose>>| poses.iter().map(|poses| eccentricity(poses, joint)).collect();
        let cycles = known.iter().map(|(name, cycle, poses)| (*name, *cycle, orbit(poses))).collect();
        let wear = nominal.joints.get(index).map_or(&[][..], |joint| &joint.wear_depth);
        let clearance = clearance.radial_clearance();
        let worn = wear.iter().map(|depth| clearance + depth).collect();
        Some((joint.name.as_str(), clearance, worn, cycles))
    });
    let all: Vec<Orbits<'_>> = if known.is_empty() { vec![] } else { orbits.collect() };
    let reach = |(_, clearance, worn, cycles): &Orbits<'_>| {
        let far = cycles.iter().flat_map(|(.., orbit)| orbit).map(|e| e[0].hypot(e[1]));
        far.chain(worn.iter().copied()).fold(*clearance, f64::max)
    };
    let depth = input.scene.units.of(OutputUnit::Length);
    let full = full_scale(&depth, all.iter().map(reach).fold(0.0, f64::max));
    all.iter().map(|orbits| orbit(orbits, full, &depth)).collect()
}

fn orbit((name, clearance, worn, cycles): &Orbits<'_>, full: f64, unit: &OutputUnit) -> Figure {
    let mut polar = Polar::new(0.0, full);
    polar.circle(*clearance, Stroke { ink: Ink::Muted, width: 1.4, opacity: 1.0 });
    polar.closed(worn, Stroke { ink: Ink::Muted, width: 1.4, opacity: 0.6 });
    let mut reached = vec![*clearance; DIRECTIONS];
    for (cycle, _, orbit) in cycles {
        let ink = Ink::Series(usize::from(*cycle == "last"));
        polar.curve(orbit, Stroke { ink, width: 3.0, opacity: 1.0 });
        for [x, y] in orbit.iter().filter(|[x, y]| x.is_finite() && y.is_finite()) {
            let turn = y.atan2(*x).rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU;
            let farthest = &mut reached[(turn * DIRECTIONS as f64) as usize % DIRECTIONS];
            *farthest = farthest.max(x.hypot(*y));
        }
    }
    let shown = |length: f64| fixed_with_unit(unit, length, 1);
    let farthest = cycles.iter().map(|(cycle, _, orbit)| {
        let far = orbit.iter().map(|e| e[0].hypot(e[1])).fold(0.0, f64::max);
        format!("{cycle} cycle {}", shown(far))
    });
    let far = joined(farthest, ", ");
    let caption = format!("Radial clearance {}; largest eccentricity: {far}.", shown(*clearance));
    let rows = cycles.iter().flat_map(|(cycle, history, orbit)| {
        history.time.iter().zip(orbit).map(move |(time, [x, y])| {
            vec![cycle.to_string(), number(1e3 * time), number(1e6 * x), number(1e6 * y)]
        })
    });
    Figure {
        name: format!("orbit-{}", file_name(name)),
        title: format!("Orbit of journal {name}"),
        caption,
        drawing: polar.finish(&format!("joint {name}"), freest(&reached), unit),
        csv: csv(&["cycle", "time [ms]", "x [um]", "y [um]"], rows),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lives_are_about_equally_far_apart_and_end_with_the_last() {
        let cycles = [0, 250, 500, 1000, 2000, 4000, 8000, 12_000, 16_000, 20_000, 24_000];
        assert_eq!(lives(&cycles), [5, 6, 7, 8, 9, 10]);
        assert_eq!(lives(&[0, 10]), [1]);
        assert!(lives(&[]).is_empty() && lives(&[0]).is_empty());
    }
}
