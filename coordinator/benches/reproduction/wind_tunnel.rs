//! The tables of the experiment: the bore of the drive in the wind tunnel beside the published one.

use super::drive::{number_head, number_row};
use super::experiment::{
    self, JOINT, JOINTS, Measured, ONE_SIGN, OTHERS, Places, WholeLife, clockwise, published, turned, wrapped,
};
use super::kinematics::Linkage;
use super::published::{Goal, Number, Standing};
use super::tables::{Tables, cell, head};
use common::scene::{OutputUnit, SceneSource, published_results};
use coordinator::presentation::report::palette::Ink;
use coordinator::presentation::report::polar::{Polar, Stroke, freest, full_scale};
use std::error::Error;
use std::f64::consts::TAU;

/// Density of the air [kg/m^3], flow [m/s] and incidence [deg] of the wind tunnel; slope of the lift of a wing of aspect ratio 3 to 6 [1].
const AIR: f64 = 1.2;
const FLOW: f64 = 20.0;
const INCIDENCE: f64 = 10.0;
const SLOPE: f64 = 4.5;

/// The tables.
pub fn write(tables: &mut Tables, as_it_stands: &Measured) -> Result<(), Box<dyn Error>> {
    let life = experiment::whole_life(None)?;
    numbers(tables, as_it_stands, &life)?;
    joints(tables)?;
    other_loads(tables)?;
    wing(tables, as_it_stands.load)?;
    whole_lives(tables, &life)
}

fn numbers(tables: &Tables, run: &Measured, life: &WholeLife) -> Result<(), Box<dyn Error>> {
    use Standing::{Fitted, Free};
    let places = &run.places[JOINT];
    let (turn, _) = turned(places).ok_or("joint 1 has one worn place")?;
    let share = Goal::Relative(0.15);
    let near = Goal::Absolute(15.0);
    let depth = |k: usize| Some(1e3 * places[k].1);
    let seen = |k: usize| Some(180.0 - wrapped(places[k].0 + turn)).map(|a: f64| a.rem_euclid(360.0));
    let number = |what, place, goal, standing, why, ours| {
        number_row(&Number::new(what, place, goal, standing, why), ours)
    };
    const TURNED: &str = "the bushing turned so that both places are equally far off; its position in the published picture is not known";
    const OPPOSITE: &str =
        "in joints 1 and 2 always 180: a rod without load of its own transmits force along its line only";
    const SEEN: &str = "ours: the nominal drive reaches 0.03 mm; the end of the specimens was seen, not measured against that";
    let rows = [
        number("depth of the first place", ("specimen_first_peak", "mm", 4), share, Fitted, "", depth(0)),
        number("depth of the second place", ("specimen_second_peak", "mm", 4), share, Fitted, "", depth(1)),
        number("angle of the first place", ("specimen_first_angle", "deg", 0), near, Free, TURNED, seen(0)),
        number("angle of the second place", ("specimen_second_angle", "deg", 0), near, Free, "", seen(1)),
        number(
            "angle between them",
            ("specimen_angle", "deg", 0),
            Goal::None,
            Free,
            OPPOSITE,
            clockwise(places),
        ),
        number("life of the specimens", ("specimen_life", "cycles", 0), Goal::None, Free, SEEN, life.worn),
    ];
    tables.write("experiment", &number_head(), &rows)
}

/// Range of the angle of the bushing's body over a turn [deg], from its axis to +x, by the linkage without clearance.
fn positions(joint: usize) -> Result<(f64, f64), Box<dyn Error>> {
    let source = SceneSource::builtin(experiment::SCENE)?;
    let linkage = Linkage::of(source.nominal(), 1.0).ok_or("not the linkage of the drive")?;
    let angles = linkage.body_angles(if joint.is_multiple_of(2) { 1.0 } else { -1.0 }, joint < 2);
    let range = angles.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), angle| {
        (low.min(angle.to_degrees()), high.max(angle.to_degrees()))
    });
    Ok(range)
}

/// The load that gives each joint in turn the two published depths; angles counter-clockwise in the frame of the bushing. `turned by`:
/// turn of the bushing by which both places are nearest to the published ones, with the distance left; `position`: the turns that its
/// body has in the running drive, seen upright.
fn joints(tables: &Tables) -> Result<(), Box<dyn Error>> {
    let row = |(joint, name): (usize, &&str)| -> Result<Vec<String>, Box<dyn Error>> {
        let run = experiment::fitted(joint)?;
        eprintln!("joint {name}");
        let places = &run.places[joint];
        let (turn, left) = turned(places).ok_or("one worn place")?;
        let (low, high) = positions(joint)?;
        let deepest = run.places.iter().flatten().map(|place| place.1).fold(0.0, f64::max);
        let numbers = [
            (run.load[0], 2),
            (run.load[1], 3),
            (1e3 * places[0].1, 4),
            (places[0].0, 0),
            (1e3 * places[1].1, 4),
            (places[1].0, 0),
            (clockwise(places).unwrap_or(f64::NAN), 0),
            (turn, 0),
            (low, 0),
            (high, 0),
            (left, 0),
            (1e3 * deepest, 4),
            (run.force, 1),
        ];
        let cells = numbers.map(|(value, decimals)| cell(Some(value), decimals));
        Ok([vec![(*name).to_owned()], cells.to_vec()].concat())
    };
    let rows = JOINTS.iter().enumerate().map(row).collect::<Result<Vec<_>, _>>()?;
    let heads = [
        "joint",
        "load_drag [N s/m]",
        "load_flow [m/s]",
        "deeper place [mm]",
        "at [deg]",
        "other place [mm]",
        "at [deg]",
        "clockwise between [deg]",
        "turned by [deg]",
        "least position [deg]",
        "largest position [deg]",
        "left [deg]",
        "deepest bore [mm]",
        "largest force [N]",
    ];
    tables.write("joints", &head(heads), &rows)
}

/// The drive under other loads that change their sign, after 72 000 cycles: depth of the second place of each bore over that of the
/// first, and the clockwise angle from the deeper to the other; empty for a bore with one place.
fn other_loads(tables: &Tables) -> Result<(), Box<dyn Error>> {
    let row = |other: &experiment::OtherLoad| -> Result<Vec<String>, Box<dyn Error>> {
        let run = experiment::under(other)?;
        eprintln!("{}", other.name);
        let place = |places: &Places| {
            let angle = clockwise(places);
            [cell(angle.map(|_| places[1].1 / places[0].1), 2), cell(angle, 0)]
        };
        let name = std::iter::once(other.name.to_owned());
        Ok(name.chain(run.places.iter().flat_map(place)).collect())
    };
    let rows = OTHERS.iter().map(row).collect::<Result<Vec<_>, _>>()?;
    let of_joint = |name: &&str| {
        ["second over first depth", "clockwise between [deg]"].map(|what| format!("joint {name}: {what}"))
    };
    let heads: Vec<String> =
        std::iter::once("load".to_owned()).chain(JOINTS.iter().flat_map(of_joint)).collect();
    tables.write("loads", &heads, &rows)
}

/// Wings that have the load. A thin wing of length R and chord c, whose sections have the lift of their own incidence less that of
/// their own speed, has `load_drag = rho V^2 a c R^3 / (6 V f^2)` and `load_flow = 3/2 alpha V f / R`, f the arm of the load.
fn wing(tables: &mut Tables, [drag, flow]: [f64; 2]) -> Result<(), Box<dyn Error>> {
    let source = SceneSource::builtin(experiment::SCENE)?;
    let linkage = Linkage::of(source.nominal(), 1.0).ok_or("not the linkage of the drive")?;
    let row = |length: f64| {
        let chord = 6.0 * drag * linkage.rear.powi(2) / (AIR * FLOW * SLOPE * length * length * length);
        let incidence: f64 = flow * length / (1.5 * FLOW * linkage.rear);
        let numbers = [(1e3 * length, 0), (1e3 * chord, 0), (incidence.to_degrees(), 1)];
        numbers.map(|(value, decimals)| cell(Some(value), decimals)).to_vec()
    };
    let rows = [0.10, 0.12, 0.15, 0.20].map(row);
    tables.write("wing", &head(["length [mm]", "chord [mm]", "mean incidence [deg]"]), &rows)?;
    let rocker: f64 = linkage.fastest();
    let least = 1.5 * INCIDENCE.to_radians() * FLOW / rocker;
    tables.derive("least wing length for a sign change at 10 deg", (least, 2), "m");
    tables.derive("fastest rocker", (rocker, 0), "rad/s");
    Ok(())
}

/// What the nominal drive does through its whole life, under the load of the scene and under one of one sign that gives joint 1 the same
/// depth after 72 000 cycles.
fn whole_lives(tables: &mut Tables, life: &WholeLife) -> Result<(), Box<dyn Error>> {
    let results = published_results("flapping-wing")?;
    let one_sign = experiment::whole_life(Some(ONE_SIGN))?;
    let limit = SceneSource::builtin(experiment::SCENE)?.nominal().limit_states[0].threshold;
    for (load, life) in [("both signs", life), ("one sign", &one_sign)] {
        for (what, value) in ["least", "largest"].into_iter().zip(life.speeds) {
            tables.derive(&format!("difference over life, load of {load}, {what}"), (value, 1), "r/min");
        }
    }
    tables.derive("largest difference of the angles", (life.angle.max(one_sign.angle), 2), "deg");
    if let Some(worn) = life.worn {
        tables.derive("life to 0.03 mm", (worn, 0), "cycles");
    }
    let published = (limit / results["specimen_first_peak"]).ln()
        / (results["specimen_life"] / experiment::MEASURED).ln();
    for (what, power) in
        [("published", published), ("load of both signs", life.power), ("load of one sign", one_sign.power)]
    {
        tables.derive(&format!("power of the cycles, {what}"), (power, 2), "");
    }
    Ok(())
}

/// The figure: the bore of the fitted joint and the published depths.
pub fn figure(run: &Measured) -> Result<String, Box<dyn Error>> {
    let wear = &run.depths[JOINT];
    let (turn, _) = turned(&run.places[JOINT]).ok_or("one worn place")?;
    let mut polar =
        Polar::new(0.5, full_scale(&OutputUnit::Length, wear.iter().copied().fold(0.0, f64::max)));
    polar.filled(wear, Ink::Series(0));
    polar.closed(wear, Stroke { ink: Ink::Series(0), width: 2.2, opacity: 1.0 });
    polar.circle(0.0, Stroke { ink: Ink::Muted, width: 1.2, opacity: 1.0 });
    for (angle, depth) in published() {
        let angle = (angle - turn).to_radians();
        let ends = [1e-9, depth].map(|r| [r * angle.cos(), r * angle.sin()]);
        polar.curve(&ends, Stroke { ink: Ink::Limit, width: 3.0, opacity: 1.0 });
        let arc: Vec<[f64; 2]> = (-8..=8)
            .map(|k| angle + TAU * f64::from(k) / 360.0)
            .map(|angle| [depth * angle.cos(), depth * angle.sin()])
            .collect();
        polar.curve(&arc, Stroke { ink: Ink::Limit, width: 3.0, opacity: 1.0 });
    }
    Ok(polar.finish("joint 1", freest(wear), &OutputUnit::Length).document(&maud::html! {}))
}
