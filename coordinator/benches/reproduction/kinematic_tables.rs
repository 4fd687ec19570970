//! The tables of a kinematic asymmetry: what clearance and wear can give without a vibration.

use super::drive::thousands;
use super::kinematics::{Linkage, clearances};
use super::nominal::{KINEMATIC, Run};
use super::sensitivity::written;
use super::tables::{Tables, cell, head};
use common::random::standard_normal_quantile;
use common::scene::{Scene, SceneSource, published_results};
use std::error::Error;
use std::f64::consts::{PI, TAU};

/// [rad/s] to [r/min].
const RPM: f64 = 30.0 / PI;

/// Length by which lengths are changed for a difference [m].
const STEP: f64 = 1e-6;

/// A variable of the published sensitivities: name, published sign, and the length that it changes.
const VARIABLES: [(&str, f64, Length); 6] = [
    ("bushing_radius_1", 1.0, Length::Offset(0)),
    ("bushing_radius_2", 1.0, Length::Offset(1)),
    ("bushing_radius_5", 1.0, Length::Offset(4)),
    ("bushing_radius_6", 1.0, Length::Offset(5)),
    ("rocker_front_length", 1.0, Length::Front),
    ("rod_length", -1.0, Length::Rod),
];

#[derive(Debug, Clone, Copy)]
enum Length {
    Offset(usize),
    Front,
    Rod,
}

/// Change of the largest difference of the angular velocities per length [rad/s/m].
fn slope(linkage: &Linkage, offsets: &[f64; 6], length: Length) -> f64 {
    let at = |step: f64| {
        let (mut linkage, mut offsets) = (*linkage, *offsets);
        match length {
            Length::Offset(joint) => offsets[joint] += step,
            Length::Front => linkage.front += step,
            Length::Rod => linkage.rod += step,
        }
        linkage.difference(&offsets)
    };
    (at(STEP) - at(-STEP)) / (2.0 * STEP)
}

/// Deepest wear of each bore at the end of life [m].
fn deepest(run: &Run) -> [f64; 6] {
    let mut found = [0.0; 6];
    for (place, joint) in found.iter_mut().zip(&run.evaluation.joints) {
        *place = joint.wear_depth.iter().copied().fold(0.0, f64::max);
    }
    found
}

/// The tables. Links have no mass and journals keep contact ([`super::kinematics`]): a rod is shorter by the distances of its two
/// journals from the bore centres if it is pushed, longer if it is pulled, and a rocker gives way by that of its hinge.
pub fn write(tables: &mut Tables, nominal: &Run) -> Result<(), Box<dyn Error>> {
    let source = SceneSource::builtin("flapping-wing")?;
    let scene = source.nominal();
    let of = |load: f64| Linkage::of(scene, load).ok_or("not the linkage of the drive");
    let (down, up) = (of(-1.0)?, of(1.0)?);
    let mut moved = up;
    moved.pivot = [up.pivot[0] - 0.1e-3, up.pivot[1] + 0.05e-3];
    let linkages = [down, up, moved];
    let clearance = clearances(scene);
    let worn: [f64; 6] = std::array::from_fn(|joint| clearance[joint] + deepest(nominal)[joint]);
    let row = |what: &str, sign: &str, values: [String; 3], unit: &str| {
        [vec![what.to_owned(), sign.to_owned()], values.to_vec(), vec![unit.to_owned()]].concat()
    };
    let mut rows: Vec<Vec<String>> = VARIABLES
        .iter()
        .map(|(name, sign, length)| {
            let changes = linkages.map(|linkage| slope(&linkage, &clearance, *length) * RPM * 1e-6);
            row(name, written(*sign), changes.map(|change| format!("{change:+.4}")), "r/min per um")
        })
        .collect();
    for (what, offsets) in
        [("difference, unworn", &clearance), ("difference, worn as after 72 000 cycles", &worn)]
    {
        let differences = linkages.map(|linkage| cell(Some(linkage.difference(offsets) * RPM), 2));
        rows.push(row(what, "", differences, "r/min"));
    }
    let heads = [
        "quantity",
        "published sign",
        "load downwards",
        "load upwards",
        "load upwards and frame pins moved",
        "unit",
    ];
    tables.write("kinematics", &head(heads), &rows)?;
    bounds(tables, scene, &source, &linkages, &worn)?;
    reconstructions(tables)
}

/// Bounds of the mean and of the spread that a kinematic difference can have.
fn bounds(
    tables: &mut Tables,
    scene: &Scene,
    source: &SceneSource,
    linkages: &[Linkage; 3],
    worn: &[f64; 6],
) -> Result<(), Box<dyn Error>> {
    let published = published_results("flapping-wing")?;
    let wear = ["64000", "66000", "68000"].map(|life| published[&format!("wear_mean_{life}")]);
    let mean = ["64000", "66000", "68000"].map(|life| published[&format!("asymmetry_mean_{life}")] * RPM);
    let limit = scene.limit_states[1].threshold * RPM;
    let growth = wear[2] - wear[0];
    let most = (mean[0] + limit) * wear[2] / wear[0] - limit;
    let spacing = TAU / 36.0;
    let any = linkages.iter().map(|linkage| linkage.bound(worn, growth, spacing)).fold(0.0, f64::max) * RPM;
    let clearance = clearances(scene);
    let steepest = linkages
        .iter()
        .flat_map(|linkage| (0..6).map(|joint| slope(linkage, &clearance, Length::Offset(joint)).abs()))
        .fold(0.0, f64::max)
        * RPM;
    let needed = (limit - mean[0]) / standard_normal_quantile(published["asymmetry_reliability_64000"]);
    let spread = |scene: &SceneSource| {
        let std = |name: &str| {
            let variable = scene.variables().iter().find(|variable| variable.name == name);
            variable.map_or(0.0, |variable| variable.distribution.given_std())
        };
        let of = |linkage: &Linkage| {
            let offsets =
                (0..6).map(|joint| (format!("bushing_radius_{}", joint + 1), Length::Offset(joint)));
            let lengths = [("rod_length", Length::Rod), ("rocker_front_length", Length::Front)];
            let all = offsets.chain(lengths.map(|(name, length)| (name.to_owned(), length)));
            let squares = all.map(|(name, length)| (slope(linkage, &clearance, length) * std(&name)).powi(2));
            squares.sum::<f64>().sqrt() * RPM
        };
        linkages.iter().map(of).fold(0.0, f64::max)
    };
    let workshop = SceneSource::builtin("flapping-wing-tolerances")?;
    let rpm = "r/min";
    let mut derive = |what: &str, value: f64, decimals: usize, unit: &str| {
        tables.derive(what, (value, decimals), unit);
    };
    derive("largest kinematic mean at 68 000 cycles", most, 1, rpm);
    derive("the same without a change of sign", mean[0] * wear[2] / wear[0], 2, rpm);
    derive("published growth of the wear", 1e6 * growth, 1, "um");
    derive("published growth of the mean", mean[2] - mean[0], 2, rpm);
    derive("largest kinematic growth by any wear", any, 1, rpm);
    derive("standard deviation needed", needed, 2, rpm);
    derive("standard deviation by the spreads of flapping-wing", spread(source), 4, rpm);
    derive("standard deviation by the spreads of a workshop", spread(&workshop), 4, rpm);
    derive("spread of the bores needed", needed / steepest * 1e6, 0, "um");
    derive("clearance", 1e6 * clearance[0], 1, "um");
    Ok(())
}

/// Whole lives of reconstructions that were meant to be kinematic: a load upwards (free length 20 mm instead of -20 mm) and frame pins
/// moved, so that the signs are the published ones.
fn reconstructions(tables: &Tables) -> Result<(), Box<dyn Error>> {
    const WEAR: [u32; 2] = [64_000, 68_000];
    const DIFFERENCE: [u32; 4] = [1_000, 64_000, 66_000, 68_000];
    let heads = [
        vec!["reconstruction".to_owned()],
        WEAR.map(|life| format!("wear at {} [mm]", thousands(life))).to_vec(),
        DIFFERENCE.map(|life| format!("difference at {} [r/min]", thousands(life))).to_vec(),
    ];
    let row = |variant| -> Result<Vec<String>, Box<dyn Error>> {
        let run = Run::of(variant)?;
        let wear = WEAR.map(|life| cell(Some(1e3 * run.value(0, life)), 4));
        let difference = DIFFERENCE.map(|life| cell(Some(run.value(1, life) * RPM), 2));
        Ok([vec![run.variant.name.to_owned()], wear.to_vec(), difference.to_vec()].concat())
    };
    let rows = KINEMATIC.into_iter().map(row).collect::<Result<Vec<_>, _>>()?;
    tables.write("reconstructions", &heads.concat(), &rows)
}
