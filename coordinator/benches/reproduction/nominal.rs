//! The mechanism with every random variable at its mean, as it stands and with one choice of the model changed.

use common::accuracy::NamedAccuracy;
use common::outputs::Evaluation;
use common::scene::{
    BlockStep, BoreSpline, Clearance, ContactLaw, ControlPoints, JointKind, Output, OutputKind, Scene,
    SceneSource, WearDistribution, WearModel,
};
use std::error::Error;
use std::f64::consts::PI;
use worker::simulate::{SimulateOptions, simulate};

/// One choice.
#[derive(Debug, Clone, Copy)]
pub struct Variant {
    /// In the table.
    pub name: &'static str,
    change: Change,
    /// Numerical effort, other than the scene's.
    pub accuracy: Option<&'static str>,
}

#[derive(Debug, Clone, Copy)]
enum Change {
    Nothing,
    Hinges(fn(&mut Clearance)),
    /// Number of control points of every bore.
    Points(usize),
    Wear(fn(&mut WearModel)),
    /// Another output: the difference of the angles.
    Angle,
    Value(&'static str),
    /// Values, and the contact law of every joint.
    Rebuilt(&'static [&'static str], ContactLaw),
}

pub const AS_IT_STANDS: Variant = Variant { name: "as it stands", change: Change::Nothing, accuracy: None };

/// With the difference of the angles of the wings as the last output, which changes the time steps a little.
pub const WITH_ANGLES: Variant = changed("difference of the angles", Change::Angle);

/// The experiment ran a little faster.
const EXPERIMENT: Variant = Variant {
    name: "500 r/min, as in the experiment",
    change: Change::Value("parameters.crank_speed=500 r/min"),
    accuracy: None,
};

const fn changed(name: &'static str, change: Change) -> Variant {
    Variant { name, change, accuracy: None }
}

const fn computed(name: &'static str, accuracy: &'static str) -> Variant {
    Variant { name, change: Change::Nothing, accuracy: Some(accuracy) }
}

const UPWARDS: [&str; 3] = [
    "parameters.load_free_length=20 mm",
    "parameters.pivot_offset=15.435 mm",
    "parameters.pivot_height=40.001 mm",
];
const UPWARDS_WORN: [&str; 6] = [
    UPWARDS[0],
    UPWARDS[1],
    UPWARDS[2],
    "wear_coefficient_12=3.9e-13 1/Pa",
    "wear_coefficient_34=3.9e-13 1/Pa",
    "wear_coefficient_56=3.9e-13 1/Pa",
];

const fn rebuilt(name: &'static str, values: &'static [&'static str], law: ContactLaw) -> Variant {
    Variant { name, change: Change::Rebuilt(values, law), accuracy: Some("balanced") }
}

/// Reconstructions in which the asymmetry was meant to be kinematic.
pub const KINEMATIC: [Variant; 3] = [
    rebuilt("local-hertz", &UPWARDS, ContactLaw::LocalHertz),
    rebuilt("foundation", &UPWARDS, ContactLaw::Foundation),
    rebuilt("foundation, three times the wear coefficient", &UPWARDS_WORN, ContactLaw::Foundation),
];

/// What the table shows.
pub const VARIANTS: [Variant; 23] = [
    changed("contact law foundation", Change::Hinges(|hinge| hinge.contact_law = ContactLaw::Foundation)),
    changed("72 control points", Change::Points(72)),
    changed("144 control points", Change::Points(144)),
    changed("film damping 5 % less", Change::Hinges(|hinge| hinge.film_damping *= 0.95)),
    changed("film damping 1 % less", Change::Hinges(|hinge| hinge.film_damping *= 0.99)),
    changed("film damping 1 % more", Change::Hinges(|hinge| hinge.film_damping *= 1.01)),
    changed("film damping 5 % more", Change::Hinges(|hinge| hinge.film_damping *= 1.05)),
    changed("friction 20 % less", Change::Hinges(|hinge| hinge.friction *= 0.8)),
    changed("friction 20 % more", Change::Hinges(|hinge| hinge.friction *= 1.2)),
    EXPERIMENT,
    changed("no film damping", Change::Hinges(|hinge| hinge.film_damping = 0.0)),
    changed(
        "h_l as printed, without pi",
        Change::Hinges(|hinge| {
            for material in [&mut hinge.journal_material, &mut hinge.bushing_material] {
                material.elastic_modulus /= PI;
            }
        }),
    ),
    changed("explicit steps of 1000 cycles", Change::Wear(explicit)),
    changed("explicit steps, wear at the points inside the arc", Change::Wear(inside)),
    changed("approximating spline", Change::Wear(|wear| wear.spline = BoreSpline::Approximating)),
    changed(
        "wear as published: explicit steps, points inside, approximating spline",
        Change::Wear(|wear| {
            inside(wear);
            wear.spline = BoreSpline::Approximating;
        }),
    ),
    computed("draft", "draft"),
    computed("balanced", "balanced"),
    computed("balanced, blocks of 1000 cycles", "balanced+jump-1000"),
    computed("as it stands, time steps 0.5 times as long", "balanced+jump-2000+step-x0.5"),
    computed("as it stands, time steps 0.25 times as long", "balanced+jump-2000+step-x0.25"),
    computed("as it stands, 1200 instants of wear a cycle", "balanced+jump-2000+samples-1200"),
    computed("reference", "reference"),
];

fn explicit(wear: &mut WearModel) {
    wear.explicit_step = BlockStep::Explicit(1000);
}

fn inside(wear: &mut WearModel) {
    explicit(wear);
    wear.distribution = WearDistribution::PointsInside;
}

/// Changes every joint with clearance.
fn hinges(scene: &mut Scene, change: impl Fn(&mut Clearance)) {
    for joint in &mut scene.joints {
        if let JointKind::Clearance(hinge) = &mut joint.kind {
            change(hinge);
        }
    }
}

/// Adds the difference of the angles of the bodies whose angular velocities are compared, as the last output.
fn add_angle(scene: &mut Scene) {
    let of_speeds = scene.outputs.iter().find_map(|output| match &output.kind {
        OutputKind::AngularVelocityDifference { a, b } => Some((a.clone(), b.clone())),
        _ => None,
    });
    if let Some((a, b)) = of_speeds {
        let kind = OutputKind::AngleDifference { a, b };
        scene.outputs.push(Output { name: "angle_difference".to_owned(), kind });
    }
}

/// A variant's life.
pub struct Run {
    pub variant: Variant,
    pub evaluation: Evaluation,
}

impl Run {
    pub fn of(variant: Variant) -> Result<Self, Box<dyn Error>> {
        let source = SceneSource::builtin("flapping-wing")?;
        let mut scene = source.nominal().clone();
        match variant.change {
            Change::Nothing => {}
            Change::Angle => add_angle(&mut scene),
            Change::Wear(change) => change(&mut scene.wear),
            Change::Hinges(change) => hinges(&mut scene, change),
            Change::Points(points) => {
                hinges(&mut scene, |hinge| hinge.control_points = ControlPoints::Number(points));
            }
            Change::Value(setting) => scene = source.resolve_with(&[source.parse_setting(setting)?])?,
            Change::Rebuilt(values, law) => {
                let set =
                    values.iter().map(|value| source.parse_setting(value)).collect::<Result<Vec<_>, _>>()?;
                scene = source.resolve_with(&set)?;
                hinges(&mut scene, |hinge| hinge.contact_law = law);
            }
        }
        let accuracy = match variant.accuracy {
            None => scene.accuracy.clone(),
            Some(name) => name.parse::<NamedAccuracy>()?,
        };
        let evaluation = simulate(&scene, &accuracy.accuracy, SimulateOptions::WITH_FIRST_CYCLE)
            .map_err(|failure| format!("{}: {failure}", variant.name))?;
        eprintln!("{}", variant.name);
        Ok(Self { variant, evaluation })
    }

    /// An output at a life [SI].
    pub fn value(&self, output: usize, cycles: u32) -> f64 {
        let column = self.evaluation.cycles.iter().position(|at| *at == cycles).expect("a checkpoint");
        self.evaluation.histories[output][column]
    }

    /// Life at which an output first passes `limit` [SI], on a straight line between two checkpoints, to a hundred cycles; none if it
    /// does not within the life.
    pub fn life_to(&self, output: usize, limit: f64) -> Option<f64> {
        let Evaluation { cycles, histories, .. } = &self.evaluation;
        let values = &histories[output];
        let k = values.iter().position(|value| *value > limit)?;
        let [from, to] = [k - 1, k].map(|k| f64::from(cycles[k]));
        let life = from + (to - from) * (limit - values[k - 1]) / (values[k] - values[k - 1]);
        Some((life / 100.0).round() * 100.0)
    }

    /// Largest difference of the rotations of two joints on one side each, whose rockers these are, over the unworn cycle [rad].
    pub fn rotation_difference(&self, [one, other]: [&str; 2]) -> Option<f64> {
        let cycle = self.evaluation.first_cycle.as_ref()?;
        let angle = |label| Some(&cycle.bodies.iter().find(|body| body.label == label)?.angle);
        let differences = angle(one)?.iter().zip(angle(other)?).map(|(one, other)| (one - other).abs());
        Some(differences.fold(0.0, f64::max))
    }

    /// An output where another one passes `limit`, to the nearest checkpoint before [SI].
    pub fn value_at(&self, output: usize, (other, limit): (usize, f64)) -> Option<f64> {
        let passed = self.evaluation.histories[other].iter().position(|value| *value > limit)?;
        self.evaluation.histories.get(output)?.get(passed.checked_sub(1)?).copied()
    }

    /// Largest force peak of these joints in the unworn mechanism [N].
    pub fn peak_force(&self, joints: &[&str]) -> f64 {
        let chosen = self.evaluation.joints.iter().filter(|joint| joints.contains(&joint.name.as_str()));
        chosen.map(|joint| joint.peak_force).fold(0.0, f64::max)
    }

    /// Time of the force peak in a joint [s].
    pub fn time_of_peak(&self, joint: &str) -> Option<f64> {
        let cycle = self.evaluation.first_cycle.as_ref()?;
        let (_, force) = cycle.joint_force.iter().find(|(name, _)| name == joint)?;
        let at = (0..force.len()).max_by(|&a, &b| force[a].total_cmp(&force[b]))?;
        cycle.time.get(at).copied()
    }

    /// Least and largest angle of a rocker in the unworn mechanism [rad].
    pub fn extremes(&self, label: &str) -> Option<(f64, f64)> {
        let cycle = self.evaluation.first_cycle.as_ref()?;
        let angle = &cycle.bodies.iter().find(|body| body.label == label)?.angle;
        let least = angle.iter().copied().fold(f64::INFINITY, f64::min);
        Some((least, angle.iter().copied().fold(f64::NEG_INFINITY, f64::max)))
    }

    /// Deepest points of each bore at the end of life, and the second-deepest local maximum where there is one: joint, angle in the
    /// bushing's frame [deg], depth [m].
    pub fn bores(&self) -> Vec<(&str, Vec<(f64, f64)>)> {
        self.evaluation
            .joints
            .iter()
            .map(|joint| {
                let depth = &joint.wear_depth;
                let m = depth.len();
                let peak = |&i: &usize| {
                    depth[i] > depth[(i + m - 1) % m] && depth[i] >= depth[(i + 1) % m] && depth[i] > 1e-7
                };
                let mut peaks: Vec<(f64, f64)> =
                    (0..m).filter(peak).map(|i| (360.0 * i as f64 / m as f64, depth[i])).collect();
                peaks.sort_by(|a, b| b.1.total_cmp(&a.1));
                peaks.truncate(2);
                (joint.name.as_str(), peaks)
            })
            .collect()
    }
}
