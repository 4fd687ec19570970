//! `coordinator draw`: the mechanism of a scene as a drawing, before anything is simulated.

use super::output::{check_destination, file_of, unusable};
use super::scenes::warn_of;
use super::{CommandError, Done, SceneArguments, check_linkage, print, to_json, value};
use clap::Args;
use common::scene::{Body, Motion, Scene, SceneSource};
use coordinator::presentation::report::drawing::{self, DrawnMechanism, SHARE_OF_CYCLE};
use coordinator::presentation::report::{Figure, VaryingLoads, standalone};
use coordinator::results::result_files::write_text;
use std::path::{Path, PathBuf};
use worker::mechanism::Prescribed;

pub const EXAMPLES: &str = "\
Without --out the drawing is a sketch in the terminal. It shows bodies and joints with their names, supports, sliders on their \
rails, drives with the angle of the crank, and loads; as SVG in true proportions, with a scale; as DXF (R12) in true dimensions. Loads that vary are drawn over the angle \
of the crank, to SCENE-loads.svg. With --json it is printed as data: outlines of bodies, positions of joints, loads and drives in m and deg.

Examples:
  coordinator draw four-bar
  coordinator draw slider-crank --out slider-crank.dxf
  coordinator draw my.toml --set parameters.crank='25 mm' --phase 0.5 --out my.svg --json";

/// Instants of the cycle at which sliders are followed for the length of their rails.
const INSTANTS: usize = 201;

/// Arguments of `coordinator draw`.
#[derive(Debug, Clone, Args)]
pub struct DrawArguments {
    #[command(flatten)]
    pub scene: SceneArguments,
    /// Write the picture SCENE.svg to this folder, created if missing; a path with an ending is the file
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Position that is drawn, as a share of the cycle from 0 to 1
    #[arg(long, alias = "at", value_name = "SHARE", default_value_t = SHARE_OF_CYCLE, value_parser = share)]
    pub phase: f64,
}

/// Reads a share from 0 to 1.
fn share(text: &str) -> Result<f64, String> {
    value(text, "a number from 0 to 1", |x| (0.0..=1.0).contains(x))
}

/// Runs the command.
///
/// # Errors
/// [`CommandError::Scene`], [`CommandError::BadInput`] for a scene without a mechanism or one without extent, the failure of a linkage that does
/// not close, or the error of a file that cannot be written.
pub fn draw(arguments: &DrawArguments, as_json: bool) -> Done {
    let source = arguments.scene.load()?;
    let scene = source.nominal();
    let out = arguments.out.as_deref().map(|out| file_of(out, &format!("{}.svg", scene.name))).transpose()?;
    check_picture(out.as_deref())?;
    warn_of(&check_linkage(source.origin(), &source, scene)?);
    let (drawn, loads) = drawn(source.origin(), scene, arguments.phase)?;
    let written = out.as_ref().map(|file| write_figures(scene, &drawn, loads.as_ref(), file));
    let files = written.transpose()?.unwrap_or_default();
    match (as_json, &out) {
        (true, _) => print(&to_json(&drawn)?),
        (false, Some(_)) => {
            print(&files.iter().map(|file| format!("{}\n", file.display())).collect::<String>())
        }
        (false, None) => {
            let loads = loads.iter().flat_map(VaryingLoads::lines).map(|line| format!("{line}\n"));
            let loads: String = loads.collect();
            print(&format!("{}: {}\n\n{}{loads}", scene.name, scene.title, drawing::sketch(&drawn)))
        }
    }
}

/// Writes the drawing to `file`, and the loads that vary next to it; returns the files.
///
/// # Errors
/// The error of a file that cannot be written.
fn write_figures(
    scene: &Scene,
    drawn: &DrawnMechanism,
    loads: Option<&VaryingLoads>,
    file: &Path,
) -> Done<Vec<PathBuf>> {
    let of_loads = loads.map_or(vec![], VaryingLoads::figures);
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let beside = |figure: Figure| (file.with_file_name(format!("{stem}-{}.svg", figure.name)), figure);
    let drawing = (file.to_owned(), drawing::figure(drawn, scene));
    let all: Vec<(PathBuf, Figure)> = [drawing].into_iter().chain(of_loads.into_iter().map(beside)).collect();
    for (file, figure) in &all {
        let text = if ending(file) == "dxf" { drawing::dxf(drawn) } else { standalone(figure) };
        write_text(file, &text)?;
    }
    Ok(all.into_iter().map(|(file, _)| file).collect())
}

/// Checks that a picture can be written under this name.
///
/// # Errors
/// [`CommandError::BadInput`].
pub fn check_picture(file: Option<&Path>) -> Done {
    check_destination(file)?;
    let Some(file) = file else { return Ok(()) };
    match ending(file).as_str() {
        "" | "svg" | "dxf" => Ok(()),
        other => Err(unusable(file, format!("pictures are written as .svg or .dxf, not as .{other}"))),
    }
}

/// The ending of a file's name in small letters.
fn ending(file: &Path) -> String {
    file.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Lines about the loads of a mechanism that vary, after its drawing was written to `file`, if any; with the files.
///
/// # Errors
/// As those of [`draw`].
pub fn look(source: &SceneSource, file: Option<&Path>) -> Done<(Vec<String>, Vec<PathBuf>)> {
    let scene = source.nominal();
    let (drawn, loads) = match drawn(source.origin(), scene, SHARE_OF_CYCLE) {
        Err(_) if file.is_none() => return Ok((vec![], vec![])),
        found => found?,
    };
    let files = file.map_or(Ok(vec![]), |file| write_figures(scene, &drawn, loads.as_ref(), file))?;
    Ok((loads.map_or(vec![], |loads| loads.lines()), files))
}

/// The drawing of a mechanism as a figure; none for an external simulator, or where nothing can be drawn.
pub fn drawing_figure(origin: &str, scene: &Scene) -> Option<Figure> {
    if scene.simulator.is_some() {
        return None;
    }
    let (drawn, _) = drawn(origin, scene, SHARE_OF_CYCLE).ok()?;
    Some(drawing::figure(&drawn, scene))
}

/// The mechanism with ideal joints at a share of its cycle; at its start, where drives and joints do not determine the motion. With its loads
/// that vary over the cycle.
///
/// # Errors
/// [`CommandError::BadInput`] for a mechanism without extent, or the failure of a linkage that does not close.
fn drawn(origin: &str, scene: &Scene, share: f64) -> Done<(DrawnMechanism, Option<VaryingLoads>)> {
    let ideal = worker::mechanism::ideal_cycle(scene, INSTANTS, &mut 0)
        .map_err(|failure| CommandError::of_simulation(origin, scene, failure))?;
    let place = |time: f64, body: &Body, q: &Option<[f64; 3]>| match (&body.motion, q) {
        (Motion::Free { centre_of_mass: [a, b], .. }, Some([x, y, angle])) => {
            let (sin, cos) = angle.sin_cos();
            ([x - cos * a + sin * b, y - sin * a - cos * b], *angle)
        }
        (Motion::Driven { position, .. }, _) => {
            (*position, Prescribed::from_body(body).map_or(0.0, |motion| motion.angle(time)))
        }
        _ => ([0.0; 2], 0.0),
    };
    let cycle = ideal
        .iter()
        .map(|pose| scene.bodies.iter().zip(&pose.q).map(|(body, q)| place(pose.time, body, q)).collect());
    let cycle: Vec<Vec<([f64; 2], f64)>> = cycle.collect();
    let drawn =
        DrawnMechanism::new(scene, &cycle, drawing::instant(cycle.len(), share)).ok_or_else(|| {
            CommandError::refused(origin, "not modelled yet: a mechanism whose points all coincide")
        })?;
    let times: Vec<f64> = ideal.iter().map(|pose| pose.time).collect();
    Ok((drawn, VaryingLoads::new(scene, &cycle, &times)))
}

#[cfg(test)]
mod tests {
    use super::*;
    fn of(name: &str) -> (DrawnMechanism, Scene) {
        let scene = SceneSource::builtin(name).expect("built in").nominal().clone();
        (drawn(name, &scene, SHARE_OF_CYCLE).expect("it closes").0, scene)
    }

    #[test]
    fn joints_are_closed_in_every_built_in_scene() {
        for name in SceneSource::builtin_names() {
            let (drawn, scene) = of(name);
            let [low, high] = drawn.extent();
            let size = (high[0] - low[0]).max(high[1] - low[1]);
            for (joint, of_scene) in drawn.joints.iter().zip(&scene.joints) {
                let ends = &drawn.bodies[of_scene.bushing.body].outline_m;
                let near = ends.iter().map(|p| (p[0] - joint.at_m[0]).hypot(p[1] - joint.at_m[1]));
                let gap = near.fold(f64::INFINITY, f64::min);
                assert!(
                    joint.rail_m.is_some() || gap < 1e-6 * size,
                    "{name}, joint {}: gap {gap} m",
                    joint.name
                );
            }
        }
    }

    #[test]
    fn a_dxf_file_has_the_pins_and_the_lengths_of_the_scene() {
        let (drawn, _) = of("four-bar");
        let text = drawing::dxf(&drawn);
        let pairs: Vec<&str> = text.lines().map(str::trim).collect();
        let mut entities: Vec<Vec<(&str, &str)>> = Vec::new();
        for pair in pairs.chunks_exact(2) {
            if pair[0] == "0" {
                entities.push(vec![]);
            }
            entities.last_mut().into_iter().for_each(|entity| entity.push((pair[0], pair[1])));
        }
        let of_kind = |kind: &str, layer: &str, codes: &[&str]| -> Vec<Vec<f64>> {
            let number = |entity: &Vec<(&str, &str)>, code: &str| {
                let found = entity.iter().find(|(known, _)| *known == code).expect(code);
                found.1.parse::<f64>().expect(code)
            };
            let chosen = entities.iter().filter(|e| e[0] == ("0", kind) && e.contains(&("8", layer)));
            chosen.map(|entity| codes.iter().map(|code| number(entity, code)).collect()).collect()
        };
        let lines = of_kind("LINE", "BODY", &["10", "20", "11", "21"]);
        let lengths = lines.iter().map(|e| (e[2] - e[0]).hypot(e[3] - e[1]));
        for (length, exact) in lengths.zip([20.0, 60.0, 50.0]) {
            assert!((length - exact).abs() < 1e-6, "{lines:?}");
        }
        let circles = of_kind("CIRCLE", "CLEARANCE", &["10", "20", "40"]);
        for (k, circle) in circles.iter().enumerate() {
            let [x, y] = drawn.joints[k / 2].at_m;
            let radius = [4.0, 4.03][k % 2];
            assert!((circle[2] - radius).abs() < 1e-6, "{circles:?}");
            assert!((circle[0] - 1e3 * x).hypot(circle[1] - 1e3 * y) < 1e-6, "{circles:?}");
        }
        assert_eq!((lines.len(), circles.len()), (3, 6));
        assert_eq!(of_kind("ARC", "DRIVE", &["50", "51"]), [[-30.0, 210.0]]);
        assert!(pairs.contains(&"lengths in mm") && pairs.ends_with(&["0", "EOF"]));
    }

    #[test]
    fn labels_do_not_overlap_in_any_position_of_any_built_in_scene() {
        for name in SceneSource::builtin_names() {
            let source = SceneSource::builtin(name).expect("built in");
            for eighth in 0..8 {
                let share = f64::from(eighth) / 8.0;
                let (drawn, _) = drawn(name, source.nominal(), share).expect("it closes");
                let labels = drawing::sheet(&drawn).labels;
                assert!(
                    labels.len() >= drawn.joints.len() + drawn.loads.len() + drawn.drives.len(),
                    "{name}"
                );
                for (k, a) in labels.iter().enumerate() {
                    let over = labels[k + 1..].iter().find(|b| a.area.overlaps(&b.area));
                    assert!(over.is_none(), "{name}, {share}: {a:?} and {over:?}");
                }
            }
        }
    }

    #[test]
    fn a_crank_is_an_eighth_of_a_turn_ahead() {
        let (drawn, _) = of("four-bar");
        assert!((drawn.drives[0].angle_deg - 45.0).abs() < 1e-9, "{:?}", drawn.drives[0]);
        let [x, y] = drawn.joints[0].at_m;
        assert!((x - 0.02 * 0.5f64.sqrt()).abs() < 1e-9 && (x - y).abs() < 1e-9, "{x} {y}");
    }

    #[test]
    fn a_slider_has_a_rail_as_long_as_its_stroke() {
        let (drawn, _) = of("slider-crank");
        let guide = drawn.joints.iter().find(|joint| joint.kind == "prismatic").expect("a guide");
        let [[from, _], [to, _]] = guide.rail_m.expect("a rail");
        // Two crank radii of 50 mm: both dead centres are among the 201 instants.
        assert!((to - from - 0.1).abs() < 1e-9, "{from} to {to}");
        assert!(guide.on_ground);
    }
}
