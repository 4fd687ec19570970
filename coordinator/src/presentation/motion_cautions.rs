//! Cautions about the simulated motion of a mechanism: work that no real contact does, an energy balance that does not close, a motion that has
//! not settled, and forces that a cam, teeth or a belt cannot transmit.
//!
//! On a worn bore the elastic force of `local-hertz` has no potential: over a cycle it does the work W [J] beside the work of drives and loads. Where
//! W is not small against the energy that goes through the mechanism, it maintains a vibration that no real contact would, which changes
//! forces, wear and lives; finer time steps show the same. What the balance leaves beside that work is the numerical error of the cycle.

use super::format::{count, three_digits};
use crate::results::summary_rows::{ControlPointsRow, control_points_rows};
use common::outputs::{CycleHistory, Diagnostics, EnergyBalance, Evaluation, UnsettledMotion};
use common::scene::{Attachment, Joint, JointKind, Mesh, MeshForm, Scene, Warning};
use std::f64::consts::{PI, TAU};

/// Share of the energy of a cycle from which on such work is pointed out [1]: the nominal `flapping-wing` has 0.001.
const NOTABLE: f64 = 0.01;
/// Share of all powers over a cycle below which a residual counts as rounding of the balance, whatever goes through [1].
const NEGLIGIBLE: f64 = 1e-4;
/// Share of the largest force of all joints below which a force is one of rounding [1].
const ROUNDING: f64 = 1e-9;
/// Angle by which a rack or the line between the centres of two wheels may turn [rad].
const LARGEST_TURN: f64 = 0.01;

/// All cautions about the simulation of one mechanism, each with the key of the scene that it belongs to: about its motion, and about outputs
/// that depend on the number of control points.
pub fn cautions(scene: &Scene, evaluation: &Evaluation) -> Vec<Warning> {
    let of_points = control_points_notes(&control_points_rows(scene, &evaluation.diagnostics)).into_iter();
    let of_points = of_points.map(|message| Warning { key: "joints".to_owned(), message });
    motion_cautions(scene, evaluation).into_iter().chain(of_points).collect()
}

/// The cautions about the motion of an evaluation, each with the key of the scene that it belongs to; none if there is nothing to point out.
pub fn motion_cautions(scene: &Scene, evaluation: &Evaluation) -> Vec<Warning> {
    let of_couplings = evaluation.first_cycle.iter().flat_map(|cycle| of_couplings(scene, cycle));
    of_diagnostics(&evaluation.diagnostics).into_iter().chain(of_couplings).collect()
}

/// The cams, gears, racks and belts whose contact cannot transmit a force of a cycle, and those whose line of action turns.
fn of_couplings(scene: &Scene, cycle: &CycleHistory) -> Vec<Warning> {
    let angle_of = |body: usize| {
        let name = &scene.bodies[body].name;
        cycle.motion.iter().find(|motion| motion.body == *name).map(|motion| &motion.angle)
    };
    let largest = |force: &[f64]| force.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let of_all = cycle.joint_force.iter().map(|(_, force)| largest(force)).fold(0.0, f64::max);
    let pulled = |joint: &Joint| {
        let (what, remedy) = words_of_pull(joint)?;
        let force = &cycle.joint_force.iter().find(|(name, _)| *name == joint.name)?.1;
        let (at, least) = force.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1))?;
        let body =
            [joint.bushing.body, joint.journal.body].into_iter().find(|body| angle_of(*body).is_some())?;
        let degrees = angle_of(body)?.get(at)?.to_degrees().rem_euclid(360.0);
        let body = &scene.bodies[body].name;
        let pull = three_digits(-least);
        let message = format!("{what} with up to {pull} N, at {degrees:.0} deg of {body}: {remedy}");
        (-least > (NEGLIGIBLE * largest(force)).max(ROUNDING * of_all)).then_some(message)
    };
    let motion_of = |body: usize| cycle.motion.iter().find(|motion| motion.body == scene.bodies[body].name);
    let place = |at: &Attachment, k: usize| {
        let Some(motion) = motion_of(at.body) else { return at.position };
        let ([x, y], (sin, cos), [px, py]) = (motion.position[k], motion.angle[k].sin_cos(), at.position);
        [x + cos * px - sin * py, y + sin * px + cos * py]
    };
    let turned = |joint: &Joint| {
        let JointKind::Mesh(Mesh { form, .. }) = joint.kind else { return None };
        let is_rack = form == MeshForm::Rack;
        let direction = |k: usize| match (is_rack, motion_of(joint.journal.body)) {
            (true, motion) => motion.map_or(0.0, |motion| motion.angle[k]),
            (false, _) => {
                let (a, b) = (place(&joint.journal, k), place(&joint.bushing, k));
                (b[1] - a[1]).atan2(b[0] - a[0])
            }
        };
        let off = |k: usize| (direction(k) - direction(0) + PI).rem_euclid(TAU) - PI;
        let turn = (0..cycle.time.len()).map(|k| off(k).abs()).fold(0.0, f64::max);
        let what = if is_rack { "the rack" } else { "the line of centres of" };
        let message = || {
            let (name, turn) = (&joint.name, turn.to_degrees());
            format!(
                "{what} {name} turns by {turn:.1} deg, but its line of action stays that of the start: the forces of its bearings are others"
            )
        };
        (turn > LARGEST_TURN).then(message)
    };
    let of_joint = |joint: &Joint| {
        let key = format!("joints.{}", joint.name);
        let messages = [pulled(joint), turned(joint)].into_iter().flatten();
        let warning = |message: String| Warning { key: key.clone(), message: message.replace('\u{a0}', " ") };
        messages.map(warning).collect::<Vec<_>>()
    };
    scene.joints.iter().flat_map(of_joint).collect()
}

/// What a coupling does whose force has the sign that its contact cannot transmit, and what follows; none for other joints, and for teeth whose
/// two flanks have one line of action.
fn words_of_pull(Joint { name, kind, .. }: &Joint) -> Option<(String, &'static str)> {
    match kind {
        JointKind::Cam { .. } => Some((
            format!("the cam {name} pulls its follower"),
            "without a groove on both sides of the follower it lifts off; give the follower a spring or a slower drive",
        )),
        JointKind::Mesh(Mesh { form: MeshForm::Belt, .. }) => Some((
            format!("the strand of {name} on the left of the line from a to b pushes"),
            "the other one is taut then, and the forces of the bearings have another direction; exchange a and b if it is so all the time",
        )),
        JointKind::Mesh(Mesh { pressure_angle, .. }) if *pressure_angle != 0.0 => Some((
            format!("the teeth of {name} are loaded on the flank that pressure_angle does not name"),
            "the forces of the bearings have another direction then; give pressure_angle the other sign if it is so all the time",
        )),
        _ => None,
    }
}

/// The cautions about energy balance and settling of an evaluation, each with its key.
fn of_diagnostics(diagnostics: &Diagnostics) -> Vec<Warning> {
    let balance = match (&diagnostics.worn_energy, &diagnostics.energy) {
        (Some(worn), _) => Some((worn, "last")),
        (None, first) => first.as_ref().map(|first| (first, "first")),
    };
    let of_energy = balance.into_iter().flat_map(|(energy, cycle)| of_energy(energy, cycle));
    let unsettled = diagnostics.unsettled.iter().map(|motion| ("life.settle_cycles", unsettled(motion)));
    let all = of_energy.chain(unsettled);
    all.map(|(key, message)| Warning { key: key.to_owned(), message: message.replace('\u{a0}', " ") })
        .collect()
}

/// The cautions about the energy of a cycle, with their keys: work of the contact law that no real contact does, and a balance that does not
/// close.
fn of_energy(energy: &EnergyBalance, cycle: &str) -> Vec<(&'static str, String)> {
    // What is put in, or what is lost if that is more.
    let through = energy.input.abs().max(energy.dissipated.abs());
    let notable = |part: f64| {
        let share = part.abs() / through;
        let words = || [three_digits(part.abs()), format!("{:.0}", 100.0 * share), three_digits(through)];
        (share.is_finite() && share > NOTABLE).then(words)
    };
    let unphysical = notable(energy.unphysical).map(|[work, share, through]| {
        let message = format!(
            "in the {cycle} cycle of the nominal mechanism the contact law local-hertz does {work} J of work that no real contact does, {share} % of the \
             {through} J that go through it: this law is not conservative on a worn bore, and the vibration that it maintains changes forces, wear \
             and lives, whatever the accuracy; compare with contact_law = \"foundation\""
        );
        ("joints", message)
    });
    let is_open = energy.residual().abs() > NEGLIGIBLE * energy.turnover;
    let residual = notable(energy.residual()).filter(|_| is_open).map(|[left, share, through]| {
        let message = format!(
            "in the {cycle} cycle of the nominal mechanism the energy balance leaves {left} J, {share} % of the {through} J that go through it: the time \
             steps do not resolve the motion, often a vibration of the contacts in a slow mechanism; compare with shorter ones \
             (--accuracy step-x0.5), or give the joints contact_damping or film_damping"
        );
        ("accuracy", message)
    });
    unphysical.into_iter().chain(residual).collect()
}

/// The caution about a motion that has not settled.
fn unsettled(motion: &UnsettledMotion) -> String {
    let UnsettledMotion { output, change, further_cycles, turning } = motion;
    let turns = turning.as_ref().map_or_else(String::new, |(body, angle)| {
        let angle = angle.to_degrees().abs();
        format!(
            ". {body} turns {angle:.1} deg a cycle, not a whole turn: with period = \"turn of {body}\" in [life] a cycle ends when it has turned once"
        )
    });
    format!(
        "the motion has not settled after {further_cycles} further cycles: {output} still changes by {} % from one cycle to the next, which its \
         stated error contains; give settle_cycles more, or the mechanism more damping{turns}",
        three_digits(100.0 * change)
    )
}

/// A sentence for each output whose error is left out of the stated ones, or that does not converge.
pub fn control_points_notes(rows: &[ControlPointsRow]) -> Vec<String> {
    rows.iter().filter_map(note).collect()
}

fn note(row: &ControlPointsRow) -> Option<String> {
    let ControlPointsRow { output, unit, value, with_twice, with_four_times, error, .. } = row;
    let cycles = count(row.cycles.into());
    let [own, twice, four_times, of_points] =
        [value, with_twice, with_four_times, error].map(|value| three_digits(*value));
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let values = format!(
        "after {cycles} cycles of the nominal mechanism it is {own}{unit}, and {twice} and {four_times}{unit} on surfaces with twice and four times \
         the control points"
    );
    let text = if !row.stated {
        format!(
            "the stated errors of {output} leave out the number of control points, which this scene declares a part of its model: {values}"
        )
    } else if !row.converges && *error > NOTABLE * value.abs() {
        format!(
            "{output} does not converge with the number of control points: {values}; its stated error contains {of_points}{unit} for that, which no \
             accuracy lessens: compare with another contact_law"
        )
    } else {
        return None;
    };
    Some(text.replace('\u{a0}', " "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::outputs::BodyMotion;
    use common::scene::SceneSource;

    fn messages(diagnostics: &Diagnostics) -> Vec<String> {
        of_diagnostics(diagnostics).into_iter().map(|caution| caution.message).collect()
    }

    #[test]
    fn issue_a_quarter_of_the_energy_came_from_the_contact_law_without_a_word() {
        let energy = |unphysical: f64| EnergyBalance {
            input: 6.478,
            stored: 0.0,
            dissipated: 6.478 + unphysical,
            unphysical,
            turnover: 20.0,
        };
        let said = |first: f64, worn: Option<f64>| {
            messages(&Diagnostics {
                energy: Some(energy(first)),
                worn_energy: worn.map(energy),
                ..Diagnostics::default()
            })
        };
        let [text] = &said(0.0, Some(1.532))[..] else { panic!("one caution") };
        assert!(
            text.starts_with("in the last cycle")
                && text.contains("1.53 J")
                && text.contains("19 % of the 8.01 J"),
            "{text}"
        );
        assert!(said(0.2, None)[0].starts_with("in the first cycle"));
        // An unworn bore does no such work, and that of a worn one may be small.
        assert!(said(0.2, Some(0.01)).is_empty() && said(0.0, None).is_empty());
        assert!(messages(&Diagnostics::default()).is_empty());
    }

    #[test]
    fn issue_an_energy_residual_of_more_than_all_that_goes_through_passed_without_a_word() {
        // A slider-crank at 1 r/min: -0.123 J put in, 0.089 J dissipated.
        let energy = |input: f64, turnover: f64| {
            let energy = EnergyBalance { input, dissipated: 0.089, turnover, ..EnergyBalance::default() };
            messages(&Diagnostics { energy: Some(energy), ..Diagnostics::default() })
        };
        let [text] = &energy(-0.123, 60.0)[..] else { panic!("one caution") };
        assert!(text.contains("leaves 0.212 J, 172 % of the 0.123 J"), "{text}");
        assert!(energy(0.0895, 60.0).is_empty() && energy(0.094, 60.0).is_empty());
        assert_eq!(energy(0.094, 0.2).len(), 1);
    }

    #[test]
    fn issue_a_motion_that_had_not_settled_entered_the_life_without_a_word() {
        let turning = Some(("crank".to_owned(), 329.5_f64.to_radians()));
        let unsettled = UnsettledMotion { output: "F".into(), change: 0.0321, further_cycles: 12, turning };
        let text = &messages(&Diagnostics { unsettled: Some(unsettled), ..Diagnostics::default() })[0];
        for said in [
            "after 12 further cycles",
            "F still changes by 3.21 %",
            "crank turns 329.5 deg",
            "\"turn of crank\"",
        ] {
            assert!(text.contains(said), "{said}: {text}");
        }
    }

    #[test]
    fn couplings_whose_contact_cannot_transmit_their_force_are_named() {
        let text = include_str!("../../../common/tests/scenes/geared-cam.toml");
        let belt = text.replace("type = \"gear\"", "type = \"belt\"").replace("\"25 mm\"", "\"10 mm\"");
        let rack = text.replace(
            "type = \"gear\"\na = { body = \"pinion\", point = \"centre\" }",
            "type = \"rack\"\na = { body = \"follower\", point = \"foot\" }",
        );
        let rack = rack.replace("radius_a = \"25 mm\"\nradius_b", "radius");
        let said = |text: &str, teeth: [f64; 3], lift: [f64; 3], turn: f64| -> Vec<String> {
            let source = SceneSource::parse(text, "coupled").unwrap_or_else(|faults| panic!("{faults}"));
            let motion = |body: &str, angles: [f64; 3]| BodyMotion {
                body: body.into(),
                position: vec![[0.075, 0.0], [0.075, 0.075 * turn], [0.075, 0.0]],
                angle: angles.into(),
                ..BodyMotion::default()
            };
            let cycle = CycleHistory {
                time: vec![0.0, 1.0, 2.0],
                joint_force: vec![
                    ("teeth".into(), teeth.into()),
                    ("lift".into(), lift.into()),
                    ("bearing".into(), vec![1e6; 3]),
                ],
                motion: vec![motion("camshaft", [0.0, -0.5, -1.0]), motion("follower", [0.0, turn, 0.0])],
                ..CycleHistory::default()
            };
            let evaluation =
                Evaluation { first_cycle: Some(cycle), ..Evaluation::from_histories(vec![], vec![]) };
            motion_cautions(source.nominal(), &evaluation)
                .into_iter()
                .map(|caution| caution.message)
                .collect()
        };
        let (pushes, rounding) = ([5.0, 9.0, 2.0], [-1e-7, -9e-4, 2e-4]);
        assert!(said(text, pushes, rounding, 0.005).is_empty());
        for (text, teeth, lift, turn, words) in [
            (
                text,
                pushes,
                [3.0, -2.0, 5.0],
                0.0,
                "the cam lift pulls its follower with up to 2.00 N, at 331 deg of camshaft",
            ),
            (
                text,
                [5.0, -4.0, 2.0],
                pushes,
                0.0,
                "the teeth of teeth are loaded on the flank that pressure_angle does not name with up to 4.00 N",
            ),
            (
                &belt,
                [5.0, -4.0, 2.0],
                pushes,
                0.0,
                "the strand of teeth on the left of the line from a to b pushes with up to 4.00 N",
            ),
            (&rack, pushes, pushes, 0.1, "the rack teeth turns by 5.7 deg"),
            (text, pushes, pushes, 0.1, "the line of centres of teeth turns by 5.7 deg"),
        ] {
            let found = said(text, teeth, lift, turn);
            assert!(found.len() == 1 && found[0].starts_with(words), "{words}: {found:?}");
        }
    }

    fn row(stated: bool, converges: bool, error: f64) -> ControlPointsRow {
        ControlPointsRow {
            output: "asymmetry".into(),
            unit: "r/min".into(),
            cycles: 66_000,
            value: 24.58,
            with_twice: 26.37,
            with_four_times: 34.39,
            error,
            converges,
            stated,
        }
    }

    #[test]
    fn outputs_that_do_not_converge_and_errors_left_out_are_named_with_their_size() {
        let said = |row| control_points_notes(&[row]).pop();
        let text = said(row(true, false, 19.6)).expect("a note");
        assert!(
            text.starts_with(
                "asymmetry does not converge with the number of control points: after 66 000 cycles"
            ),
            "{text}"
        );
        assert!(text.contains("it is 24.6 r/min, and 26.4 and 34.4 r/min on surfaces"), "{text}");
        assert!(text.contains("its stated error contains 19.6 r/min"), "{text}");
        assert_eq!((said(row(true, true, 19.6)), said(row(true, false, 0.1))), (None, None));
        let text = said(row(false, true, 0.1)).expect("a note");
        assert!(
            text.starts_with("the stated errors of asymmetry leave out the number of control points"),
            "{text}"
        );
    }
}
