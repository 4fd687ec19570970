//! The chapter "What was studied": drawing, random variables, limit states, settings and assumptions; and, for the appendix, bodies, joints,
//! loads and formulas.
//!
//! | file | content |
//! |---|---|
//! | `mechanism_tables` | bodies, drives, joints, loads, gravity, curves |
//! | `clearance_tables` | hinges and guides with clearance, their materials and wear |
//! | `variable_tables` | random variables, correlations, outputs, limit states, life, settings of the study |
//! | `exact` | values with as few digits as give the same number |

mod clearance_tables;
mod exact;
mod mechanism_tables;
mod variable_tables;

use super::drawing::{self, DrawnMechanism, SHARE_OF_CYCLE};
use super::mechanism::poses;
use super::page::{beside, mark, refer_table};
use super::tables;
use super::{Figure, Page, ReportInput, VaryingLoads, WrittenScene, captioned};
use crate::results::scene_summary::limit_rows;
use common::scene::{ContactLaw, CycleTier, JointKind, Scene, SimulatorKind, WearingSurfaces};
use maud::{Markup, PreEscaped, Render, html};

/// Random variables beyond this number are listed in the appendix.
const VARIABLES_IN_CHAPTER: usize = 12;

/// The drawing of the nominal mechanism; `None` without the motion of every body.
pub fn figure(input: &ReportInput) -> Option<Figure> {
    let poses = poses(&input.scene, input.first_cycle()?)?;
    let drawn = DrawnMechanism::new(&input.scene, &poses, drawing::instant(poses.len(), SHARE_OF_CYCLE))?;
    Some(drawing::figure(&drawn, &input.scene))
}

/// Loads that vary by curves, over the angle of the crank.
pub fn loads(input: &ReportInput) -> Vec<Figure> {
    let scene = &input.scene;
    let cycle = input.first_cycle();
    let varying = cycle.and_then(|cycle| VaryingLoads::new(scene, &poses(scene, cycle)?, &cycle.time));
    varying.map_or(vec![], |varying| varying.figures())
}

/// The chapter with its figure, as it was `drawn`; long tables are left to the [`appendix`].
pub fn chapter(input: &ReportInput, drawn: &Markup) -> Markup {
    let scene = &input.scene;
    let many = scene.variables.len() > VARIABLES_IN_CHAPTER;
    html! {
        p {
            "Every value is nominal and in the scene file " code { "scene.toml" } " next to this page, which is listed in the appendix"
            @if !drawn.0.is_empty() { "; the mechanism is drawn in " (mark("see-figure", drawing::NAME)) }
            "."
            @if !input.written.formulas.is_empty() {
                " Values that follow from parameters, which random variables may set, have their formulas in "
                (refer_table("formulas")) "."
            }
        }
        (beside(drawn, variable_tables::study_settings(scene, &input.summary, &input.meta.settings)))
        @if let Some(simulator) = &scene.simulator {
            p {
                @if simulator.cycles.is_some() { "The wear is computed by this program around the cycles of " }
                @else { "Responses are computed by an external simulator, " }
                @match &simulator.kind {
                    SimulatorKind::Program(program) => { "the program " code { (program.command.join(" ")) } }
                    SimulatorKind::UmBridge(model) => { "the model " (model.model) " of the server " code { (model.url) } }
                }
                "."
            }
        }
        @if many {
            p { "The " (scene.variables.len()) " random variables are listed in " (refer_table("variables")) "." }
        } @else {
            (variable_tables::variables(scene, &input.summary))
        }
        (variable_tables::limits(scene, &input.summary.limits, &input.written))
        h3 { "Assumptions and limits of the model" }
        ul { @for assumption in assumptions(input) { li { (assumption) } } }
    }
}

/// Bodies, joints, loads, outputs and limit states of a scene, from its text `source`.
pub fn mechanism(scene: &Scene, source: &str) -> Markup {
    let written = WrittenScene::new(source);
    html! {
        (elements(scene, &written))
        (variable_tables::limits(scene, &limit_rows(scene), &written))
    }
}

/// Bodies, joints and loads of a mechanism; for a simulator that gives cycles its joints.
fn elements(scene: &Scene, written: &WrittenScene) -> Markup {
    let is_mechanism = scene.simulator.is_none();
    let tables = html! {
        @if is_mechanism {
            (mechanism_tables::bodies(scene, written))
            (mechanism_tables::starts(scene, written))
            (mechanism_tables::joints(scene, written))
        }
        (clearance_tables::hinges(scene, written))
        (clearance_tables::materials(scene, written))
        (clearance_tables::guides(scene, written))
        (clearance_tables::guide_wear(scene, written))
        @if is_mechanism { (mechanism_tables::loads(scene, written)) }
    };
    // Their heads name usual units.
    PreEscaped(written.units.head(&tables.into_string()))
}

/// Adds the chapters of the appendix with what is too long for that chapter.
pub fn appendix(page: &mut Page, input: &ReportInput) {
    page.begin("Inputs in full");
    let loads = page.draw(loads(input), "two");
    page.add(html! {
        (elements(&input.scene, &input.written))
        (loads)
        @if input.scene.variables.len() > VARIABLES_IN_CHAPTER {
            (variable_tables::variables(&input.scene, &input.summary))
        }
        (formulas(&input.written))
    });
}

/// What the model does not contain.
fn assumptions(input: &ReportInput) -> Vec<String> {
    let scene = &input.scene;
    let mut text = of_mechanism(scene);
    let variables = if scene.correlations.is_empty() {
        "Random variables are independent and constant over life."
    } else {
        "Random variables depend on each other by a Gaussian copula and are constant over life."
    };
    let always = [
        variables,
        "Failure is final: a limit state that was reached once counts as failed from then on. Checkpoints are the only lives at \
         which responses are known; between them crossing times are interpolated.",
        "The intervals contain sampling, surrogates, interpolation and, where it is known, the numerical error of the simulations. \
         The error of the model itself, and of its coefficients, is in none of them: results calibrated to measurements describe \
         these, and are no prediction for other conditions.",
    ];
    let of_surrogates = (!input.summary.is_direct()).then(|| unseen(input.summary.largest_gap));
    text.extend(always.into_iter().map(str::to_owned).chain(of_surrogates));
    text
}

/// What surrogates cannot know, with the share of the population in the largest ball without a simulation [1].
fn unseen(largest_gap: Option<f64>) -> String {
    let gap = largest_gap.map_or(String::new(), |share| {
        format!(
            " The largest ball around a sample of the population without a simulation holds {:.1} % of the population: so much a separate \
             region could add to P_f without having been seen.",
            100.0 * share
        )
    });
    format!(
        "A region of failures that no simulation came near is in no interval: surrogates state the errors of what they predict, and a \
         region of which no result gives a sign is predicted to be safe.{gap}"
    )
}

/// What the model of a mechanism, or of the wear around a program, does not contain.
fn of_mechanism(scene: &Scene) -> Vec<String> {
    let mut text = match &scene.simulator {
        None => vec!["The mechanism is planar and its bodies are rigid.".to_owned()],
        Some(simulator) => {
            simulator.cycles.iter().map(|of| format!("The program {}.", of.tier.explanation())).collect()
        }
    };
    let mut clearances = Vec::new();
    let mut has_worn_guides = false;
    for joint in &scene.joints {
        match &joint.kind {
            JointKind::Clearance(clearance) => clearances.push(clearance),
            JointKind::Guide(guide) => has_worn_guides |= guide.wear.is_some(),
            _ => {}
        }
    }
    if !clearances.is_empty() || has_worn_guides {
        let journals = clearances.iter().any(|clearance| clearance.wears != WearingSurfaces::Bushing);
        let several = "The surfaces with a wear coefficient wear";
        let surfaces = if journals || has_worn_guides { several } else { "Only bushings wear" };
        text.push(format!(
            "{surfaces}, by Archard's law with a constant coefficient, evenly over their width. Temperature, debris and running-in \
             are not modelled."
        ));
    }
    let is_used = |law: &ContactLaw| clearances.iter().any(|clearance| clearance.contact_law == *law);
    let laws = ContactLaw::ALL.into_iter().filter(is_used);
    let tier = scene.simulator.as_ref().and_then(|simulator| Some(simulator.cycles.as_ref()?.tier));
    text.extend(laws.map(|law| match tier {
        None => format!("Contact by the law {}: {}.", law.word(), law.explanation()),
        Some(CycleTier::Contact) => format!("Depth and arc of the contact for the wear by the law {}.", law.word()),
        Some(CycleTier::Reaction) => format!(
            "Place, depth and arc of the contact follow from the force by the law {}; impacts, and the effect of wear on the motion, \
             are not contained.",
            law.word()
        ),
    }));
    if scene.joints.iter().any(|joint| !joint.kind.has_clearance()) {
        text.push("Ideal joints have neither clearance nor wear.".to_owned());
    }
    text
}

/// Parameters, and formulas of the keys that depend on them; nothing for a scene without parameters.
fn formulas(written: &WrittenScene) -> Markup {
    let table = |name: &str, title: &str, head: [&str; 2], all: &[(String, String)]| {
        let rows = all.iter().map(|(name, text)| [name.render(), html! { code { (text) } }]);
        html! { @if !all.is_empty() { (captioned(name, title, tables::table_of_text(&head, rows))) } }
    };
    let follow = "Quantities that follow from parameters, with the values above where all variables are at their means";
    html! {
        (table("parameters", "Parameters of the scene", ["parameter", "value"], &written.parameters))
        (table("formulas", follow, ["quantity", "formula"], &written.formulas))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::test_study;
    use common::scene::SceneSource;

    /// The chapter and the appendix of a scene.
    fn text_of(source: &str) -> (Scene, String) {
        let scene = SceneSource::parse(source, "everything").unwrap().nominal().clone();
        let mut input = test_study::report_input();
        input.scene = scene.clone();
        input.written = WrittenScene::new(source);
        input.summary.identify(&scene, source, "");
        let mut page = Page::new("", chapter(&input, &html! {}));
        appendix(&mut page, &input);
        (scene, page.html(None).replace('\u{a0}', " "))
    }

    /// The scene with every word of the language.
    const EVERYTHING: &str = include_str!("../../../../../common/tests/scenes/everything.toml");

    #[test]
    fn quantities_are_shown_in_the_units_of_the_scene() {
        let units = ["in", "mil", "lbf", "lbf in", "in/s", "psi", "lb", "ft/s^2", "in^3"];
        let keys =
            ["length", "depth", "force", "torque", "speed", "pressure", "mass", "acceleration", "volume"];
        let (head, rest) = EVERYTHING.split_once("[units]\n").unwrap();
        let chosen: String =
            keys.iter().zip(units).map(|(key, unit)| format!("{key} = \"{unit}\"\n")).collect();
        let (_, rest) = rest.split_once("\n\n").unwrap();
        let (_, text) = text_of(&format!("{head}[units]\n{chosen}\n{rest}"));
        for said in
            ["points [in]", "centre of mass [in]", " lb</td>", " psi</td>", "lbf in", " in/s", " ft/s²"]
        {
            assert!(text.contains(said), "{said} in {text}");
        }
        let tables = text.split_once("Bodies; inertia").unwrap().1;
        let written = ["parameters", "formulas", "variables", "<code>"];
        for line in tables.split("<tr>").filter(|line| !written.iter().any(|name| line.contains(name))) {
            for unit in [
                " mm<", " mm,", " mm;", "[mm]", " µm<", " N<", " N,", " N m<", " GPa", " g<", "[m/s]",
                " m/s<", " m/s,",
            ] {
                assert!(!line.contains(unit), "{unit} in {line}");
            }
        }
    }

    #[test]
    fn issue_the_contact_of_the_mechanics_was_stated_of_a_program() {
        let (_, text) = text_of(include_str!("../../../../../deploy/python/examples/four-bar/mujoco.toml"));
        assert!(text.contains("follow from the force by the law local-hertz"), "{text}");
        assert!(!text.contains("feeds energy"), "{text}");
    }

    /// Every name of the scene with every word of the language is in the chapter or in the appendix.
    #[test]
    fn every_part_of_a_scene_is_listed() {
        let (scene, text) = text_of(EVERYTHING);
        let names = scene.bodies.iter().map(|body| &body.name);
        let names = names.chain(scene.joints.iter().map(|joint| &joint.name));
        let names = names.chain(scene.variables.iter().map(|variable| &variable.name));
        let names = names.chain(scene.limit_states.iter().map(|limit| &limit.name));
        for name in names.chain(scene.outputs.iter().map(|output| &output.name)) {
            assert!(text.contains(&format!("<td>{name}</td>")), "{name} in {text}");
        }
        for said in [
            "<td>200 g</td>",
            "<td>far (20, 0); near (0, 0)</td>",
            "≥ 0.5 mm</td>",
            "flores, e = 1",
            "hunt-crossley, 7.5 s/m",
            "206 GPa",
            "gumbel-minima",
            "parameters.arm",
            "Gaussian copula",
            "stiffness 2000 N/m",
            "0.01 s: 5.5 N",
            "stall torque −0.3 N m, no-load speed −3000 r/min",
            "<td>bodies.rod.start_position.x</td><td><code>arm</code></td>",
            "gravity",
            "<td>full</td><td>0.3</td><td>joints.worn.friction = 0.06; loads.brake.torque = 1.5 * full_torque</td>",
        ] {
            assert!(text.to_lowercase().contains(&said.to_lowercase()), "{said} in {text}");
        }
    }
}
