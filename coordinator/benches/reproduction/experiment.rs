//! The drive in the wind tunnel: its bores, the load that each joint would need for the published bore, and what other loads give.

use common::accuracy::Accuracy;
use common::outputs::Evaluation;
use common::scene::{SceneSource, published_results};
use coordinator::presentation::nominal_life::{Reached, nominal_lives};
use std::error::Error;
use std::f64::consts::PI;
use worker::simulate::{SimulateOptions, simulate};

/// The scene of the experiment.
pub const SCENE: &str = "flapping-wing-experiment";

/// Life at which the bore was measured [cycles].
pub const MEASURED: f64 = 72_000.0;

/// Joint to whose bore the load was fitted.
pub const JOINT: usize = 0;

/// Names of the joints, in the order of the scene.
pub const JOINTS: [&str; 6] = ["1", "2", "3", "4", "5", "6"];

/// Worn places of a bore, the deepest first: angle in the frame of the bushing, counter-clockwise [deg], and depth [m].
pub type Places = Vec<(f64, f64)>;

/// Angles [deg] and depths [m] of the published bore, counter-clockwise from +x as seen.
pub fn published() -> [(f64, f64); 2] {
    let results = published_results("flapping-wing").expect("a built-in scene");
    ["first", "second"].map(|place| {
        let clockwise_from_the_left = results[&format!("specimen_{place}_angle")];
        ((PI - clockwise_from_the_left).to_degrees(), results[&format!("specimen_{place}_peak")])
    })
}

/// An angle from -180 to 180 deg.
pub fn wrapped(degrees: f64) -> f64 {
    (degrees + 180.0).rem_euclid(360.0) - 180.0
}

/// Angle from the deepest place to the second one, clockwise [deg]; none for a bore with one place.
pub fn clockwise(places: &Places) -> Option<f64> {
    (places.len() > 1).then(|| (places[0].0 - places[1].0).rem_euclid(360.0))
}

/// The turn of the bushing by which its two places are nearest to the published ones, and the largest distance left of either [deg].
pub fn turned(places: &Places) -> Option<(f64, f64)> {
    let seen = published();
    let [first, second] = [0, 1].map(|k| places.get(k).map(|place| seen[k].0 - place.0));
    let apart = wrapped(second? - first?);
    Some((wrapped(first? + 0.5 * apart), 0.5 * apart.abs()))
}

/// Worn places of each bore at the end of life, between control points by parabolas.
fn places(evaluation: &Evaluation) -> Vec<Places> {
    let of = |depth: &Vec<f64>| {
        let m = depth.len();
        let mut found: Places = (0..m)
            .filter_map(|i| {
                let (before, here, after) = (depth[(i + m - 1) % m], depth[i], depth[(i + 1) % m]);
                let off = 0.5 * (before - after) / (before - 2.0 * here + after);
                (here > before && here >= after && here > 1e-7)
                    .then(|| ((i as f64 + off) * 360.0 / m as f64, here - 0.25 * (before - after) * off))
            })
            .map(|(angle, depth)| (angle.rem_euclid(360.0), depth))
            .collect();
        found.sort_by(|a, b| b.1.total_cmp(&a.1));
        found
    };
    evaluation.joints.iter().map(|joint| of(&joint.wear_depth)).collect()
}

/// A drive in the wind tunnel after the 72 000 cycles at which the bore was measured.
pub struct Measured {
    /// Factor of the load per speed of the air [N s/m] and the flow [m/s], for the load of the scene.
    pub load: [f64; 2],
    /// Worn places of each bore.
    pub places: Vec<Places>,
    /// Wear depths of each bore [m].
    pub depths: Vec<Vec<f64>>,
    /// Largest force in any joint in the first cycle [N].
    pub force: f64,
}

/// The scene of the experiment until its bore was measured, with further lines of TOML; `without` continues its table `[scene]`.
fn source(without: &str, lines: &str) -> Result<SceneSource, Box<dyn Error>> {
    let head = format!(
        "[scene]\nname = \"measured\"\nextends = \"{SCENE}\"\n{without}\n[life]\ncycles = {MEASURED:.0}\n"
    );
    Ok(SceneSource::parse(&format!("{head}{lines}"), "measured")?)
}

fn measured(source: &SceneSource, load: Option<[f64; 2]>) -> Result<Measured, Box<dyn Error>> {
    let scene = source.resolve_with(&settings(load))?;
    let evaluation = simulate(&scene, &Accuracy::draft(), SimulateOptions::default())?;
    Ok(Measured {
        load: load.unwrap_or([0.0; 2]),
        places: places(&evaluation),
        depths: evaluation.joints.iter().map(|joint| joint.wear_depth.clone()).collect(),
        force: evaluation.joints.iter().map(|joint| joint.peak_force).fold(0.0, f64::max),
    })
}

/// The load of the scene: factor per speed [N s/m] and flow [m/s].
pub fn load_of_the_scene() -> Result<[f64; 2], Box<dyn Error>> {
    let source = SceneSource::builtin(SCENE)?;
    let mean = |name: &str| {
        let variable = source.variables().iter().find(|variable| variable.name == name);
        variable.map(|variable| variable.distribution.parent_mean()).ok_or("a load without its variable")
    };
    Ok([mean("load_drag")?, mean("load_flow")?])
}

/// The drive of the scene after 72 000 cycles.
pub fn as_it_stands() -> Result<Measured, Box<dyn Error>> {
    measured(&source("", "")?, Some(load_of_the_scene()?))
}

/// The nominal drive of the scene through its whole life.
pub struct WholeLife {
    /// Life at which the wear reaches its limit [cycles].
    pub worn: Option<f64>,
    /// Least and largest difference of the angular velocities of the wings [r/min].
    pub speeds: [f64; 2],
    /// Largest difference of their angles [deg].
    pub angle: f64,
    /// Power of the cycles with which the deepest wear grows from the measured bore to the end of life [1].
    pub power: f64,
}

/// A load of one sign that gives joint 1 the depth of the scene after 72 000 cycles: `load_drag` [N s/m] and `load_flow` [m/s].
pub const ONE_SIGN: [f64; 2] = [1.324, 1.0];

/// The whole life of the scene, with its own load or another one.
pub fn whole_life(load: Option<[f64; 2]>) -> Result<WholeLife, Box<dyn Error>> {
    let source = SceneSource::builtin(SCENE)?;
    let scene = source.resolve_with(&settings(load))?;
    let evaluation = simulate(&scene, &scene.accuracy.accuracy, SimulateOptions::default())?;
    let history = |name: &str| {
        let place =
            scene.outputs.iter().position(|output| output.name == name).ok_or("an output is missing")?;
        Ok::<&Vec<f64>, Box<dyn Error>>(&evaluation.histories[place])
    };
    let worn = match nominal_lives(&scene, &evaluation)[0].reached {
        Reached::After(life) => Some(life),
        Reached::FromTheStart | Reached::Beyond(_) => None,
    };
    let speeds = history("angular_velocity_difference")?.iter().map(|speed| speed * 30.0 / PI);
    let depths = history("max_wear_depth")?;
    let last = evaluation.cycles.len() - 1;
    let measured =
        evaluation.cycles.iter().position(|cycles| f64::from(*cycles) == MEASURED).ok_or("no checkpoint")?;
    let cycles = [measured, last].map(|n| f64::from(evaluation.cycles[n]));
    Ok(WholeLife {
        power: (depths[last] / depths[measured]).ln() / (cycles[1] / cycles[0]).ln(),
        worn,
        speeds: [speeds.clone().fold(f64::INFINITY, f64::min), speeds.fold(0.0, f64::max)],
        angle: history("angle_difference")?.iter().copied().fold(0.0, f64::max).to_degrees(),
    })
}

fn settings(load: Option<[f64; 2]>) -> Vec<(String, f64)> {
    let named = |[drag, flow]: [f64; 2]| vec![("load_drag".to_owned(), drag), ("load_flow".to_owned(), flow)];
    load.map_or(vec![], named)
}

/// The load with which the bore of a joint has the two published depths, by Newton's method in logarithms.
pub fn fitted(joint: usize) -> Result<Measured, Box<dyn Error>> {
    const STEP: f64 = 0.03;
    let source = source("", "")?;
    let wanted = published();
    let mut x = load_of_the_scene()?.map(f64::ln);
    for _ in 0..8 {
        let off = |x: [f64; 2]| -> Result<([f64; 2], Measured), Box<dyn Error>> {
            let run = measured(&source, Some(x.map(f64::exp)))?;
            let found = &run.places[joint];
            let off = [0, 1].map(|k| found.get(k).map_or(f64::NAN, |place| (place.1 / wanted[k].1).ln()));
            Ok((off, run))
        };
        let (here, run) = off(x)?;
        if here.iter().all(|off| off.abs() < 0.004) {
            return Ok(run);
        }
        let (a, b) = (off([x[0] + STEP, x[1]])?.0, off([x[0], x[1] + STEP])?.0);
        let slope = |k: usize| [(a[k] - here[k]) / STEP, (b[k] - here[k]) / STEP];
        let ([p, q], [r, s]) = (slope(0), slope(1));
        let determinant = p * s - q * r;
        x[0] -= (s * here[0] - q * here[1]) / determinant;
        x[1] -= (p * here[1] - r * here[0]) / determinant;
        if !x.iter().all(|x| x.is_finite()) {
            break;
        }
    }
    Err(format!("no load gives joint {} the published depths", JOINTS[joint]).into())
}

/// A load of another kind.
pub struct OtherLoad {
    pub name: &'static str,
    /// Keys of each of the two loads, in TOML; `SIDE` stands for the side of the wing.
    keys: &'static str,
    /// Further lines of the scene.
    lines: &'static str,
}

const fn drag(name: &'static str, keys: &'static str) -> OtherLoad {
    OtherLoad { name, keys, lines: "" }
}

/// Loads that change their sign over the stroke: with the speed of the wing, its square or its position, and with the crank turning
/// the other way.
pub const OTHERS: [OtherLoad; 10] = [
    drag("by the speed, flow 0.1 m/s", "type = \"drag\"\nlinear = \"load_drag\"\nflow = \"0.1 m/s\""),
    drag("by the speed, 0.2 m/s", "type = \"drag\"\nlinear = \"load_drag\"\nflow = \"0.2 m/s\""),
    drag("by the speed, 0.4 m/s", "type = \"drag\"\nlinear = \"load_drag\"\nflow = \"0.4 m/s\""),
    drag("by the speed, 0.6 m/s", "type = \"drag\"\nlinear = \"load_drag\"\nflow = \"0.6 m/s\""),
    OtherLoad {
        name: "by the speed, 0.31 m/s, crank clockwise",
        keys: "type = \"drag\"\nlinear = \"load_drag\"\nflow = \"0.31 m/s\"",
        lines: "[parameters]\ncrank_speed = \"-500 r/min\"\n",
    },
    drag("by its square, 0.1 m/s", "type = \"drag\"\nquadratic = \"3 N s^2/m^2\"\nflow = \"0.1 m/s\""),
    drag("by its square, 0.2 m/s", "type = \"drag\"\nquadratic = \"3 N s^2/m^2\"\nflow = \"0.2 m/s\""),
    drag("by its square, 0.4 m/s", "type = \"drag\"\nquadratic = \"3 N s^2/m^2\"\nflow = \"0.4 m/s\""),
    OtherLoad {
        name: "by the position, zero 3 mm above the hinge",
        keys: SPRING,
        lines: "[parameters]\nzero = \"3 mm\"\n",
    },
    OtherLoad { name: "by the position, 6 mm", keys: SPRING, lines: "[parameters]\nzero = \"6 mm\"\n" },
];

const SPRING: &str = "type = \"directional-spring\"\nanchor = { body = \"frame\", point = \"SIDE_pin\" }\n\
                      stiffness = \"160 N/m\"\nfree_length = \"zero\"";

/// The drive of the scene under another load after 72 000 cycles.
pub fn under(other: &OtherLoad) -> Result<Measured, Box<dyn Error>> {
    let row = |side: &str| {
        let keys = other.keys.replace("SIDE", side);
        format!(
            "[[loads]]\nname = \"{side}\"\ndirection = [0, 1]\n{keys}\n\
             [loads.at]\nbody = \"{side}_rocker\"\npoint = \"wing\"\n"
        )
    };
    let without = "without = [\"loads.right_air\", \"loads.left_air\"]";
    measured(&source(without, &format!("{}{}{}", other.lines, row("right"), row("left")))?, None)
}
