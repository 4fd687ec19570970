//! `coordinator explain`: the model of a scene, the reasons for it, and its expected cost.

use super::external::{self, failed};
use super::measured::MeasuredFinding;
use super::model::Model;
use super::nominal::{findings, nominal_evaluation};
use super::shared::cores;
use super::{
    AccuracyArguments, CommandError, Done, SceneArguments, Verbosity, check_linkage, count, print, to_json,
};
use common::random::Correlation;
use common::scene::*;
use coordinator::presentation::report::format::{seven_digits, unit_scale};
use coordinator::presentation::terminal::while_waiting;
use coordinator::study::Settings;
use std::fmt::Write;
use std::sync::Arc;

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn explain(
    scene: &SceneArguments,
    accuracy: &AccuracyArguments,
    quick: bool,
    verbosity: Verbosity,
) -> Done {
    let source = scene.load()?;
    let scene = source.nominal();
    if let Some(simulator) = &scene.simulator {
        external::check_accuracy(&source, accuracy)?;
        let json = verbosity.json.then(|| serde_json::to_value(scene)).transpose()?;
        let text = json.map(|value| to_json(&value)).transpose()?;
        return print(&text.unwrap_or_else(|| without_mechanism(&source, simulator)));
    }
    worker::mechanism::islands(scene)
        .map_err(|failure| CommandError::of_simulation(source.origin(), scene, failure))?;
    let is_given = *accuracy != AccuracyArguments::default();
    let accuracy = accuracy.for_study(&source, scene.study.seed, cores(), verbosity.quiet, Arc::default())?;
    let model = Model::new(scene, &accuracy.setting);
    if !verbosity.json {
        print(&text(&source, &model))?;
    }
    let doing = "simulating the nominal mechanism until every limit is passed".to_owned();
    let given = is_given.then_some(&accuracy.setting.accuracy);
    let evaluate = |say: &dyn Fn(String)| nominal_evaluation(scene, given, say);
    let evaluated = if quick { Ok(None) } else { while_waiting(verbosity.quiet, doing, evaluate) };
    let mut found = findings(&source, evaluated.as_ref().ok().and_then(Option::as_ref));
    // A mechanism that cannot be assembled is described, too.
    found.warnings.extend(check_linkage(source.origin(), &source, scene).unwrap_or_default());
    if let Err(failure) = &evaluated {
        let message = format!("the nominal mechanism cannot be simulated: {failure}");
        found.warnings.push(Warning { key: "scene".to_owned(), message });
    }
    if verbosity.json {
        let mut value = serde_json::to_value(scene)?;
        value["model"] = model.to_json();
        value["nominal"] = found.lives_json();
        value["measured"] = serde_json::to_value(&found.measured)?;
        value["warnings"] = serde_json::to_value(&found.warnings)?;
        return print(&to_json(&value)?);
    }
    let warnings = found.warnings.iter().map(|warning| format!("Warning: {warning}\n"));
    let measured = found.measured.iter().map(MeasuredFinding::lines);
    print(&measured.chain([found.lines("Nominal")]).chain(warnings).collect::<String>())
}

fn text(source: &SceneSource, model: &Model) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = explain_into(&mut out, source, model);
    out
}

fn explain_into(out: &mut String, source: &SceneSource, model: &Model) -> std::fmt::Result {
    let scene = source.nominal();
    writeln!(out, "{}: {}\n", scene.name, scene.title)?;
    motion(out, scene)?;
    joints(out, scene)?;
    loads(out, scene)?;
    outputs(out, scene)?;
    model.write(out, scene)?;
    variables(out, scene)?;
    for choice in scene.wear.chosen() {
        writeln!(out, "Wear: {choice}.")?;
    }
    let life = &scene.life;
    let cycles = |n: u32| count(n as usize, "cycle");
    let every = if life.checkpoint_every == 1 { "cycle".to_owned() } else { cycles(life.checkpoint_every) };
    writeln!(out, "Life: {} of {:.6} s, reported every {every}.", cycles(life.cycles), life.period)?;
    conditions(out, source)?;
    study(out, scene)
}

/// The operating conditions with what is simulated under each.
fn conditions(out: &mut String, source: &SceneSource) -> std::fmt::Result {
    let (variables, overridden) = (&source.nominal().variables, source.overridden_variables());
    for Condition { name, share, scene, .. } in &source.nominal().conditions {
        let here = overridden.iter().filter(|(_, conditions)| conditions.contains(&name.as_str()));
        let here: Vec<&str> = here.map(|(k, _)| &*variables[*k].name).collect();
        let without = match &here[..] {
            [] => String::new(),
            names => format!("; without effect under it: {}", names.join(", ")),
        };
        let (share, period) = (share * 100.0, scene.life.period);
        writeln!(out, "  {name}: {share:.4} % of the cycles, of {period:.6} s each{without}")?;
    }
    Ok(())
}

/// The description of a scene that names its own simulator.
fn without_mechanism(source: &SceneSource, simulator: &ExternalSimulator) -> String {
    let scene = source.nominal();
    let mut out = format!("{}: {}\n\n", scene.name, scene.title);
    // Writing to a String cannot fail.
    let _ = external::explain(&mut out, scene, simulator).and_then(|()| variables(&mut out, scene));
    let life = &scene.life;
    if life.cycles > 1 {
        let _ = writeln!(out, "Life: {} cycles, reported every {}.", life.cycles, life.checkpoint_every);
    }
    let _ = conditions(&mut out, source).and_then(|()| study(&mut out, scene));
    out
}

fn study(out: &mut String, scene: &Scene) -> std::fmt::Result {
    if scene.variables.is_empty() {
        return Ok(());
    }
    let study = &scene.study;
    writeln!(
        out,
        "Study: {} Monte Carlo points, {} simulated first, then {} at a time, {} at most; seed {}.",
        study.population, study.initial, study.batch, study.max_evaluations, study.seed
    )?;
    let finer = Settings::from(scene).finer_levels(scene);
    let finer: Vec<&str> = finer.iter().map(|level| level.name.as_str()).collect();
    if finer.is_empty() {
        Ok(())
    } else {
        writeln!(out, "Pairs at finer levels correct its results: {}.", finer.join(", "))
    }
}

fn motion(out: &mut String, scene: &Scene) -> std::fmt::Result {
    writeln!(out, "Bodies")?;
    for body in &scene.bodies {
        let what = match body.motion {
            Motion::Fixed => "fixed, no unknowns".to_owned(),
            Motion::Driven { drive: Drive::ConstantSpeed { speed, .. }, .. } => {
                let unit = scene.units.of(OutputUnit::AngularVelocity);
                let speed = unit.after(&format!("{:.1}", unit.to_shown(speed)));
                format!("turns at {speed}, prescribed, no unknowns")
            }
            Motion::Driven { drive: Drive::Angle(_), .. } => {
                "angle by a table over time, prescribed, no unknowns".to_owned()
            }
            Motion::Driven { .. } => "speed by a table over time, prescribed, no unknowns".to_owned(),
            Motion::Free { mass, .. } => format!("rigid, {}, three unknowns", scene.units.text(mass, "g", 4)),
        };
        writeln!(out, "  {}: {what}", body.name)?;
    }
    writeln!(out)
}

fn joints(out: &mut String, scene: &Scene) -> std::fmt::Result {
    writeln!(out, "Joints")?;
    for joint in &scene.joints {
        let (journal, bushing) =
            (&scene.bodies[joint.journal.body].name, &scene.bodies[joint.bushing.body].name);
        let what = match &joint.kind {
            JointKind::Revolute => {
                format!("{journal} turns on {bushing}, {}", ideal(scene, joint, "a pin of radius"))
            }
            JointKind::Prismatic { .. } => {
                format!("{journal} slides on {bushing}, {}", ideal(scene, joint, "a guide of length"))
            }
            JointKind::Fixed { .. } => format!("{journal} is fixed to {bushing}, no wear"),
            JointKind::Clearance(clearance) => {
                let wide = scene.units.text(clearance.radial_clearance(), "um", 2);
                let (wear, contact) = (wear(clearance), contact(clearance));
                format!(
                    "journal of {journal} in bushing of {bushing}, clearance {wide}, {wear}\n     {contact}"
                )
            }
            JointKind::Guide(guide) => {
                let wear = guide.wear.as_ref().map_or("does not wear".to_owned(), guide_wear);
                let (wide, damping) =
                    (scene.units.text(guide.clearance, "um", 2), damping(&guide.contact_damping));
                format!(
                    "{journal} slides in a guide of {bushing}, {wide} of clearance on each side, {wear}\n     corners and \
                     faces on an elastic foundation, {damping}, friction {}",
                    guide.friction
                )
            }
            kind => {
                let coupling = kind.coupling(&scene.units).unwrap_or_default();
                format!("{journal} and {bushing}, {coupling}, ideal, no wear")
            }
        };
        writeln!(out, "  {}: {what}", joint.name)?;
    }
    writeln!(out)
}

/// What is modelled of an ideal joint; its friction acts on `on`, a pin or guide.
fn ideal(scene: &Scene, joint: &Joint, on: &str) -> String {
    match joint.friction {
        None => "ideal, no wear".to_owned(),
        Some(IdealFriction { coefficient, size, .. }) => {
            let size = match scene.units.symbol("mm") {
                "mm" => format!("{} mm", size * 1e3),
                _ => scene.units.text(size, "mm", 3),
            };
            format!("ideal, friction {coefficient} on {on} {size}, no wear")
        }
    }
}

fn wear(clearance: &Clearance) -> String {
    let points = match clearance.control_points {
        ControlPoints::Number(number) => format!("{number} control points"),
        ControlPoints::ByArc => "control points by the contact arc".to_owned(),
    };
    worn(clearance.wear_coefficients(), ["bore", "journal"], &points)
}

fn guide_wear(wear: &GuideWear) -> String {
    let points = format!("{} control points on each face", wear.control_points);
    worn(wear.coefficients(), ["guide", "slider"], &points)
}

/// The surfaces that wear, with their coefficients [1/Pa].
fn worn(coefficients: [f64; 2], [first, second]: [&str; 2], points: &str) -> String {
    match coefficients {
        [0.0, 0.0] => "does not wear".to_owned(),
        [k, 0.0] => format!("the {first} wears (Archard, K_H = {k:e} 1/Pa, {points})"),
        [0.0, k] => format!("the {second} wears (Archard, K_H = {k:e} 1/Pa, {points})"),
        [a, b] => format!("{first} and {second} wear (Archard, K_H = {a:e} and {b:e} 1/Pa, each: {points})"),
    }
}

fn damping(damping: &ContactDamping) -> String {
    match *damping {
        ContactDamping::None => "no contact damping".to_owned(),
        ContactDamping::HuntCrossley { factor } => format!("Hunt-Crossley damping {factor} s/m"),
        ContactDamping::Restitution { law, coefficient, .. } => {
            format!("damping for a restitution of {coefficient} ({})", law.explanation())
        }
    }
}

fn contact(clearance: &Clearance) -> String {
    let damping = damping(&clearance.contact_damping);
    let Clearance { contact_law: law, film_damping, friction, .. } = clearance;
    let (name, meaning) = (law.word(), law.explanation());
    format!("{name}: {meaning}; {damping}; film {film_damping} N s/m; friction {friction}")
}

fn loads(out: &mut String, scene: &Scene) -> std::fmt::Result {
    writeln!(out, "Loads")?;
    for load in &scene.loads {
        writeln!(out, "  {}", load.explanation(scene))?;
    }
    match scene.gravity {
        [0.0, 0.0] => writeln!(out, "  no gravity\n"),
        [x, y] => writeln!(out, "  gravity ({x}, {y}) m/s^2\n"),
    }
}

fn outputs(out: &mut String, scene: &Scene) -> std::fmt::Result {
    writeln!(out, "Outputs at every checkpoint, and the limit states")?;
    for (i, output) in scene.outputs.iter().enumerate() {
        let unit = scene.unit_of(output);
        // As scenes write it.
        let symbol = unit.symbol().replace('\u{b5}', "u");
        let (description, local) = (output.kind.description(scene), local_pressures(scene, output));
        writeln!(out, "  {}: {description}{local}", output.name)?;
        for limit in scene.limit_states.iter().filter(|limit| limit.output == i) {
            let shown = |value: f64| format!("{:.4} {symbol}", unit.to_shown(value));
            writeln!(out, "     limit state {}: {}", limit.name, failed(limit, shown))?;
        }
    }
    writeln!(out)
}

/// What wears the volume of an output beyond the force, if any of its joints has an elastic foundation.
fn local_pressures(scene: &Scene, output: &Output) -> &'static str {
    let on_foundation = |joint: &usize| matches!(&scene.joints[*joint].kind, JointKind::Clearance(clearance) if clearance.contact_law == ContactLaw::Foundation);
    match output.kind.wear() {
        Some((WearQuantity::Volume, joints)) if joints.iter().any(on_foundation) => {
            "; under foundation by the local pressures, whose sum on a wide arc exceeds the force: more than K F s"
        }
        _ => "",
    }
}

/// The random variables: distribution, mean, standard deviation and bounds, in the unit of the scene file.
fn variables(out: &mut String, scene: &Scene) -> std::fmt::Result {
    if scene.variables.is_empty() {
        return writeln!(out, "No random variables: a study of this scene has nothing to vary.\n");
    }
    let dependence =
        if scene.correlations.is_empty() { "independent" } else { "dependent by a Gaussian copula" };
    writeln!(out, "Random variables: {dependence}")?;
    let width = scene.variables.iter().map(|variable| variable.name.len()).max().unwrap_or(0);
    for variable in &scene.variables {
        let law = &variable.distribution;
        // The unit was read when the scene was checked; "1" denotes a plain number.
        let scale = unit_scale(&variable.unit);
        let shown = |value: f64| digits(value / scale);
        let unit = if variable.unit == "1" { String::new() } else { format!(" {}", variable.unit) };
        let (mean, std) = (shown(law.parent_mean()), shown(law.given_std()));
        let bounds = match law.support() {
            _ if law.is_constant() => String::new(),
            (lower, upper) if lower.is_finite() && upper.is_finite() => {
                format!(", from {} to {}", shown(lower), shown(upper))
            }
            (lower, _) if lower.is_finite() => format!(", from {}", shown(lower)),
            (_, upper) if upper.is_finite() => format!(", to {}", shown(upper)),
            _ => String::new(),
        };
        let spread = if law.is_constant() { String::new() } else { format!(", std {std}") };
        writeln!(out, "  {:width$}  {}, mean {mean}{spread}{bounds}{unit}", variable.name, law.name())?;
    }
    let name = |k: usize| &scene.variables[k].name;
    for Correlation { first, second, coefficient } in &scene.correlations {
        let coefficient = digits(*coefficient);
        writeln!(out, "  correlation of {} and {}, as normals: {coefficient}", name(*first), name(*second))?;
    }
    writeln!(out)
}

/// The value with seven digits, in the signs of a keyboard.
fn digits(value: f64) -> String {
    seven_digits(value).replace('\u{2212}', "-")
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::accuracy::NamedAccuracy;

    /// A scene with every key of the language: each joint, load and output has its own line.
    #[test]
    fn every_part_of_a_scene_is_explained() {
        let source = include_str!("../../../common/tests/scenes/everything.toml");
        let source = SceneSource::parse(source, "everything").unwrap();
        let found = text(&source, &Model::new(source.nominal(), &NamedAccuracy::default()));
        for line in [
            "wheel: speed by a table over time, prescribed, no unknowns",
            "hinge: rod turns on crank, ideal, friction 0.1 on a pin of radius 5 mm, no wear",
            "guide: slider slides on frame, ideal, friction 0.15 on a guide of length 10 mm, no wear",
            "plain_guide: slider slides on frame, ideal, no wear",
            "weld: rod is fixed to slider, no wear",
            "unworn: journal of rod in bushing of slider, clearance 30.00 um, does not wear",
            "damping for a restitution of 0.9 (Lankarani-Nikravesh)",
            "spring: spring of 2000 N/m, 4 N s/m between rod and frame, slack at 30.000 mm",
            "torsion: torsion spring of 0.5 N m/rad, 0.01 N m s/rad between rod and frame, slack at 20.000 deg",
            "push: force on slider along (0.6, 0.8), 1 to 5.5 N by a table over time, repeated",
            "twist: torque on slider, 0 to 2 N m by a table over the angle of rod, once",
            "motor: motor on rod, -0.3 N m at rest, none at -3000.0 r/min",
            "air: drag of 0.2 N s/m and 1.5 N s^2/m^2 on rod along (0, 1) in a flow of -20 m/s, times 0.25 to 1 by a table over the \
             angle of crank, repeated",
            "plain_fan: drag of 0.0001 N m s/rad and 0 N m s^2/rad^2 on slider",
            "wear: largest wear depth of joint worn",
            "all_wear: largest wear depth of 4 joints",
            "angle: largest difference of angle, rod against slider",
            "hinge_force: largest force in 2 joints",
            "error: largest distance of a point of slider from its position with ideal joints",
            "stroke_error: r.m.s. distance of a point of slider from its wanted position",
            "rod_error: largest difference of the angle of rod from that with ideal joints",
            "jolt: largest acceleration of a point of rod",
            "strokes: number of impacts per cycle in 6 joints",
            "hardest_blow: energy of the hardest impact in 2 joints",
            "torque: largest torque that drives crank",
            "limit state too_weak: failed from 0.1000 mJ down",
            "limit state out_of_range: failed from 2.0000 um down and from 9.0000 um on",
            "limit state too_loud: failed from 20.0000 mJ on",
            "limit state too_askew: failed from 3.0000 deg on",
            "limit state too_far: failed from 0.5000 mm on",
            "Random variables: dependent by a Gaussian copula",
            "truncated normal, mean 5500, std 100, from 5000 to 6000 mN",
            "lognormal, mean 0.05, std 0.01, from 0",
            "Gumbel of minima, mean 95, std 2.85 N/m",
            "triangular, mean 10.03333, std 0.06236096, from 9.9 to 10.2 mm",
            "constant, mean 0.5 N m",
            "correlation of brake and friction_worn, as normals: 0.4",
            "full: 30.0000 % of the cycles, of 0.100000 s each; without effect under it: brake, friction_worn",
        ] {
            assert!(found.contains(line), "no \"{line}\" in:\n{found}");
        }
    }
}
