//! Orbits of the journals in their bores over a cycle, unworn and worn.

use super::file_name;
use crate::presentation::report::figure::{Figure, csv};
use crate::presentation::report::format::fixed;
use crate::presentation::report::input::ReportInput;
use crate::presentation::report::mechanism::{Pose, eccentricity, poses};
use crate::presentation::report::palette::Ink;
use crate::presentation::report::polar::{Polar, Stroke, freest, full_scale};
use crate::results::csv_table::number;
use common::outputs::CycleHistory;
use common::scene::{Joint, JointKind};

/// Directions in which the extent of the orbit is determined, to place the labels.
const DIRECTIONS: usize = 36;

/// One joint's orbits.
struct Orbits<'a> {
    joint: &'a Joint,
    /// Radial clearance [m].
    clearance: f64,
    /// Wear depth at the end of life at equal angles `(control_points,)` [m].
    wear: &'a [f64],
    /// Name (first or last), history, and orbit `(n, 2)` [m] of each cycle.
    cycles: Vec<(&'static str, &'a CycleHistory, Vec<[f64; 2]>)>,
}

/// One polar figure per joint with clearance whose motion the nominal evaluation includes, all at one scale.
pub fn orbits(input: &ReportInput) -> Vec<Figure> {
    let Some(nominal) = &input.nominal else { return vec![] };
    let last = nominal.worn.as_ref().and_then(|worn| worn.last_cycle.as_ref());
    let known =
        [("first", nominal.first_cycle.as_ref()), ("last", last)].into_iter().filter_map(|(name, cycle)| {
            let poses = poses(&input.scene, cycle?).filter(|poses| !poses.is_empty())?;
            Some((name, cycle?, poses))
        });
    let known: Vec<_> = known.collect();
    let orbits = input.scene.joints.iter().enumerate().filter_map(|(index, joint)| {
        let JointKind::Clearance(clearance) = &joint.kind else { return None };
        let orbit = |poses: &Vec<Vec<Pose>>| poses.iter().map(|poses| eccentricity(poses, joint)).collect();
        let cycles = known.iter().map(|(name, cycle, poses)| (*name, *cycle, orbit(poses))).collect();
        let wear = nominal.joints.get(index).map_or(&[][..], |joint| &joint.wear_depth);
        Some(Orbits { joint, clearance: clearance.radial_clearance(), wear, cycles })
    });
    let all: Vec<Orbits<'_>> = if known.is_empty() { vec![] } else { orbits.collect() };
    let reach = |orbits: &Orbits<'_>| {
        let far = orbits.cycles.iter().flat_map(|(.., orbit)| orbit).map(|e| e[0].hypot(e[1]));
        far.chain(orbits.wear.iter().map(|depth| orbits.clearance + depth)).fold(orbits.clearance, f64::max)
    };
    let full = full_scale(all.iter().map(reach).fold(0.0, f64::max), 1e-6);
    all.iter().map(|orbits| figure(orbits, full)).collect()
}

fn figure(orbits: &Orbits<'_>, full: f64) -> Figure {
    let name = &orbits.joint.name;
    let mut polar = Polar::new(0.0, full);
    polar.circle(orbits.clearance, Stroke { ink: Ink::Muted, width: 1.4, opacity: 1.0 });
    let worn: Vec<f64> = orbits.wear.iter().map(|depth| orbits.clearance + depth).collect();
    polar.closed(&worn, Stroke { ink: Ink::Muted, width: 1.4, opacity: 0.6 });
    let mut reached = vec![orbits.clearance; DIRECTIONS];
    for (cycle, _, orbit) in &orbits.cycles {
        let ink = Ink::Series(usize::from(*cycle == "last"));
        polar.curve(orbit, Stroke { ink, width: 3.0, opacity: 1.0 });
        for [x, y] in orbit.iter().filter(|[x, y]| x.is_finite() && y.is_finite()) {
            let turn = y.atan2(*x).rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU;
            let farthest = &mut reached[(turn * DIRECTIONS as f64) as usize % DIRECTIONS];
            *farthest = farthest.max(x.hypot(*y));
        }
    }
    let farthest = |cycle: &str| {
        let orbit = orbits.cycles.iter().find(|(name, ..)| *name == cycle)?;
        let far = orbit.2.iter().map(|e| e[0].hypot(e[1])).fold(0.0, f64::max);
        Some(format!("{cycle} cycle {} µm", fixed(1e6 * far, 1)))
    };
    let far: Vec<String> = ["first", "last"].into_iter().filter_map(farthest).collect();
    let caption = format!(
        "Radial clearance {} µm; largest eccentricity: {}.",
        fixed(1e6 * orbits.clearance, 1),
        far.join(", ")
    );
    let rows = orbits.cycles.iter().flat_map(|(cycle, history, orbit)| {
        history.time.iter().zip(orbit).map(move |(time, [x, y])| {
            vec![cycle.to_string(), number(1e3 * time), number(1e6 * x), number(1e6 * y)]
        })
    });
    Figure {
        name: format!("orbit-{}", file_name(name)),
        title: format!("Orbit of journal {name}"),
        caption,
        drawing: polar.finish(&format!("joint {name}"), freest(&reached)),
        csv: csv(&["cycle", "time [ms]", "x [um]", "y [um]"], rows),
    }
}
