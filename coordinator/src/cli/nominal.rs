//! The nominal mechanism against its limits, for `coordinator check`: expected lives, and warnings about limits that it has passed before
//! the first checkpoint or is far from.

use super::measured::{MeasuredFinding, measured_findings};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::{Fails, JointKind, Life, Scene, SceneSource, Warning};
use coordinator::presentation::motion_cautions::cautions;
use coordinator::presentation::nominal_life::{NominalLife, Reached, nominal_lives};
use coordinator::presentation::report::format::{count as grouped, three_digits};
use serde_json::Value;
use worker::simulate::{SimulateOptions, simulate};

/// Longest block of wear that an accuracy may have [cycles].
const LONGEST_BLOCK: u32 = 1_000_000;

/// Checkpoints up to the life of the nominal mechanism that resolve the lives of others: their spread is some tens of per cent.
const CHECKPOINTS_WITHIN_LIFE: f64 = 10.0;

/// Share of a limit below which the nominal mechanism is far from it, so that a unit or the life is likely to be wrong: no spread of
/// a machine makes a response ten times larger.
const FAR_FROM_LIMIT: f64 = 0.1;

/// Largest pressure on the projected area of a bearing as a share of the elastic modulus: hardened steel yields at 1 %.
const LARGEST_PRESSURE: f64 = 0.02;

/// Blocks of wear of a life that is simulated at once without an `accuracy`, and of a longer one where an answer is within its error; a life of
/// more is simulated in parts, from its beginning on only as far as it takes to pass every limit, each of [`FEW_BLOCKS`].
const BLOCKS: u32 = 24;

/// Blocks of a part. With the graded first one, a needle drive that rattles has the life of 24 blocks to 1.3 %, with a stated error of 3 %.
const FEW_BLOCKS: u32 = 4;

/// Most of a life that is simulated after its first cycle, which shows the order of magnitude.
const FIRST_PART: f64 = 1.0 / 16.0;

/// Life that is simulated next over the life at which the last limit is expected to be passed: from the first cycle on, after which wear
/// slows down, and later; and the least one over that simulated last.
const FIRST_RESERVE: f64 = 4.0;
const RESERVE: f64 = 1.3;
const LEAST_GROWTH: f64 = 2.0;

/// Simulates the nominal mechanism at an accuracy, or without one at `draft`, or where that fails at the accuracy of the scene; none for
/// a scene with its own simulator. The life ends where every limit is passed by more than its error; `say` is told how far it is.
///
/// # Errors
/// [`SimulationFailure`] if all fail.
pub fn nominal_evaluation(
    scene: &Scene,
    accuracy: Option<&Accuracy>,
    say: &dyn Fn(String),
) -> Result<Option<Evaluation>, SimulationFailure> {
    if scene.simulator.is_some() {
        return Ok(None);
    }
    let found = match accuracy {
        Some(accuracy) => until_failed(scene, accuracy, false, say),
        None => until_failed(scene, &Accuracy::draft(), true, say)
            .or_else(|_| until_failed(scene, &scene.accuracy.accuracy, false, say)),
    };
    found.map(Some)
}

/// Simulates the life of a mechanism as far as it takes to pass every limit by more than its error, or for [`MOST_BEYOND`] lives; in blocks no
/// shorter than it takes for their number if it `is_coarse`.
fn until_failed(
    scene: &Scene,
    accuracy: &Accuracy,
    is_coarse: bool,
    say: &dyn Fn(String),
) -> Result<Evaluation, SimulationFailure> {
    let life = &scene.life;
    let jump_of = |cycles: u32, blocks: u32| {
        accuracy.cycle_jump.max(if is_coarse { (cycles / blocks).min(LONGEST_BLOCK) } else { 0 })
    };
    let simulated = |part: &Life, blocks: u32| {
        let accuracy = Accuracy { cycle_jump: jump_of(part.cycles, blocks), ..*accuracy };
        simulate(&with_life(scene, part), &accuracy, SimulateOptions::WITH_FIRST_CYCLE)
    };
    // Blocks end at checkpoints: these are no farther apart than a block is long.
    let part_of = |cycles: f64| {
        let checkpoints = (cycles / f64::from(BLOCKS)).ceil() as u32;
        let every = life.checkpoint_every.min(checkpoints).min(jump_of(cycles as u32, BLOCKS));
        let cycles = (cycles / f64::from(every)).ceil() * f64::from(every);
        let is_part = cycles < f64::from(life.cycles);
        if is_part { Life { cycles: cycles as u32, checkpoint_every: every, ..*life } } else { *life }
    };
    if scene.limit_states.is_empty() || life.cycles / accuracy.cycle_jump.max(1) <= BLOCKS {
        return simulated(life, BLOCKS);
    }
    // A single cycle without any before it would be a motion that is seen once.
    let first_cycles = if life.settle_cycles == 0 { 2 } else { 1 };
    let (mut part, mut shorter) = (part_of(f64::from(first_cycles)), None);
    loop {
        let evaluation = match (simulated(&part, FEW_BLOCKS), shorter.take()) {
            (Err(_), Some(life)) => {
                part = life;
                continue;
            }
            (found, _) => found?,
        };
        let cycles = part.cycles;
        let lives = nominal_lives(scene, &evaluation);
        let is_open = |life: &NominalLife| !life.doubt(life.last, life.errors[1]).is_empty();
        let wanted = |life: &NominalLife| {
            let (expected, here) = (life.reached.expected(), f64::from(cycles));
            if is_open(life) && MOST_BEYOND * expected > here { expected.max(here) } else { expected }
        };
        let expected = lives.iter().map(wanted).fold(0.0, f64::max);
        if cycles == life.cycles || expected < f64::from(cycles) {
            let is_decided = !is_coarse || !lives.iter().any(is_open);
            return if is_decided { Ok(evaluation) } else { simulated(&part, BLOCKS).or(Ok(evaluation)) };
        }
        // Longer than the part before in any case, so that parts come to an end.
        let least = LEAST_GROWTH * f64::from(cycles);
        let all = f64::from(life.cycles);
        part = if cycles == first_cycles {
            let within = |reserve: f64| part_of((reserve * expected).min(FIRST_PART * all).max(least));
            let longer = within(FIRST_RESERVE);
            shorter = Some(within(RESERVE)).filter(|life| life.cycles < longer.cycles);
            longer
        } else {
            // No more than a part again, or all of it.
            let next = (RESERVE * expected).max(least);
            if next < 0.5 * all { part_of(next) } else { *life }
        };
        let each = |life: &NominalLife| {
            format!("{} {} of {}", life.limit.name, life.shown(life.last), life.thresholds())
        };
        let each: Vec<String> = lives.iter().map(each).collect();
        let [done, next, all] = [cycles, part.cycles, life.cycles].map(|cycles| grouped(cycles.into()));
        say(format!("{done} of {all} cycles simulated, next {next}: {}", each.join(", ")));
    }
}

/// Lives of a limit after which it counts as passed whatever its error is.
const MOST_BEYOND: f64 = 2.0;

/// The scene with a shorter life, under every condition.
fn with_life(scene: &Scene, part: &Life) -> Scene {
    let mut scene = scene.clone();
    let shorten =
        |life: &mut Life| (life.cycles, life.checkpoint_every) = (part.cycles, part.checkpoint_every);
    shorten(&mut scene.life);
    scene.conditions.iter_mut().for_each(|condition| shorten(&mut condition.scene.life));
    scene
}

/// Expected lives of the nominal mechanism from its `evaluation`, and warnings about its limits and contacts.
pub fn findings<'s>(source: &'s SceneSource, evaluation: Option<&Evaluation>) -> SceneFindings<'s> {
    let scene = source.nominal();
    let (lives, of_limits) = evaluation.map(|found| nominal_check(scene, found)).unwrap_or_default();
    let mut warnings = source.warnings();
    warnings.extend(of_limits);
    let measured = measured_findings(source);
    warnings.extend(measured.iter().filter_map(MeasuredFinding::warning));
    let last = evaluation.and_then(|found| found.cycles.last().copied()).unwrap_or(scene.life.cycles);
    SceneFindings { lives, last, measured, warnings }
}

impl SceneFindings<'_> {
    /// A line per life, which `word` begins.
    pub fn lines(&self, word: &str) -> String {
        self.lives.iter().map(|life| format!("{word} {}", life.line(self.last))).collect()
    }

    /// The lives for programs.
    pub fn lives_json(&self) -> Value {
        self.lives.iter().map(NominalLife::to_json).collect()
    }
}

/// The lives of the nominal mechanism, and what is wrong with it.
fn nominal_check<'s>(scene: &'s Scene, evaluation: &Evaluation) -> (Vec<NominalLife<'s>>, Vec<Warning>) {
    let lives = nominal_lives(scene, evaluation);
    let warnings = lives.iter().filter_map(|life| {
        Some(Warning { key: format!("limit_states.{}", life.limit.name), message: warning(scene, life)? })
    });
    let of_simulation = cautions(scene, evaluation);
    let warnings = warnings.chain(of_hinges(scene, evaluation)).chain(of_simulation).collect();
    (lives, warnings)
}

/// What is known of a scene before it is studied.
pub struct SceneFindings<'s> {
    /// Life of the nominal mechanism per limit state; empty if it was not simulated.
    pub lives: Vec<NominalLife<'s>>,
    /// Number of cycles simulated.
    pub last: u32,
    /// Laws of the variables with measured samples.
    pub measured: Vec<MeasuredFinding>,
    /// Warnings of the scene, of its nominal mechanism and of its measured samples.
    pub warnings: Vec<Warning>,
}

/// Warnings about hinges that are never in contact, and about pressures that no material bears.
fn of_hinges(scene: &Scene, evaluation: &Evaluation) -> Vec<Warning> {
    let mut found = Vec::new();
    for joint in &scene.joints {
        let (clearance, sides) = match &joint.kind {
            JointKind::Clearance(clearance) => (Some(clearance), "journal and bore"),
            JointKind::Guide(_) => (None, "slider and guide"),
            _ => continue,
        };
        let warning = |message| Warning { key: format!("joints.{}", joint.name), message };
        let free = &evaluation.diagnostics.free_flight_fraction;
        if free.iter().any(|(name, share)| *name == joint.name && *share >= 1.0) {
            found.push(warning(format!(
                "{sides} are never in contact in the first cycle, so that nothing is transmitted and nothing wears: check which bodies and points it \
                 joins, the clearance, and the loads"
            )));
        }
        let peak = evaluation.joints.iter().find(|summary| summary.name == joint.name);
        let Some((clearance, force)) = clearance.zip(peak.map(|summary| summary.peak_force)) else {
            continue;
        };
        let pressure = force / (2.0 * clearance.journal_radius * clearance.width);
        let modulus =
            clearance.journal_material.elastic_modulus.min(clearance.bushing_material.elastic_modulus);
        if pressure > LARGEST_PRESSURE * modulus {
            found.push(warning(format!(
                "the largest force of {} N is {:.0} MPa on the projected area of the bearing, {:.0} % of the elastic modulus: any material \
                 yields before; check the units of loads, masses, speeds, radius and width",
                three_digits(force).replace('\u{a0}', " "),
                pressure / 1e6,
                100.0 * pressure / modulus
            )));
        }
    }
    found
}

/// The warning about a limit that is passed before the first checkpoint, or far away at the end of life.
fn warning(scene: &Scene, life: &NominalLife) -> Option<String> {
    let (threshold, every) = (life.limit.threshold, scene.life.checkpoint_every);
    let limit = life.thresholds();
    match life.reached {
        Reached::FromTheStart => Some(format!(
            "the nominal mechanism has {} in its first cycle, unworn, and has failed from the start: the limit is {limit}{}",
            life.shown(life.unworn?),
            life.doubt(life.unworn?, life.errors[0]),
        )),
        Reached::After(cycles) if cycles < f64::from(every) => {
            life.unworn?;
            let remedy = match finer_checkpoints(scene.life.cycles, cycles) {
                Some(finer) if finer < every => format!("checkpoint_every = {finer} resolves its life"),
                _ => "no distance between checkpoints resolves that".to_owned(),
            };
            Some(format!(
                "the nominal mechanism reaches the limit of {limit} after about {cycles:.0} cycles, before the first checkpoint at \
                 {every}: {remedy}{}",
                life.doubt(life.first, life.errors[0])
            ))
        }
        Reached::Beyond(_)
            if life.limit.fails == Fails::Above && life.largest < FAR_FROM_LIMIT * threshold =>
        {
            Some(format!(
                "the nominal mechanism has at most {} in {} cycles, {:.1} % of the limit of {limit}: no failure will be seen; check the \
             limit and its unit, or study a longer life",
                life.shown(life.largest),
                scene.life.cycles,
                100.0 * life.largest / threshold,
            ))
        }
        _ => None,
    }
}

/// The longest distance between checkpoints of 1, 2 or 5 times a power of ten [cycles] that divides `cycles` and has
/// [`CHECKPOINTS_WITHIN_LIFE`] checkpoints within `life` [cycles]; none if the life is shorter than a cycle each.
fn finer_checkpoints(cycles: u32, life: f64) -> Option<u32> {
    let powers = (0..9).rev().map(|k| 10_u32.pow(k));
    let mut candidates = powers.flat_map(|power| [5, 2, 1].map(|digit: u32| digit.saturating_mul(power)));
    candidates
        .find(|every| f64::from(*every) <= life / CHECKPOINTS_WITHIN_LIFE && cycles.is_multiple_of(*every))
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::outputs::JointSummary;
    use common::scene::{LimitState, SceneSource};

    #[test]
    fn issue_a_mechanism_past_its_limit_before_the_first_checkpoint_passed_without_a_word() {
        let mut scene = SceneSource::builtin("four-bar").expect("built in").nominal().clone();
        let found = |scene: &Scene| {
            let evaluation =
                nominal_evaluation(scene, None, &|_| {}).expect("simulated").expect("by the worker");
            let (lives, warnings) = nominal_check(scene, &evaluation);
            (lives[0].reached, warnings)
        };
        let (reached, warnings) = found(&scene);
        assert_eq!(warnings, []);
        assert!(matches!(reached, Reached::After(life) if (5000.0..7000.0).contains(&life)), "{reached:?}");
        // 2.2 um are worn at the first checkpoint, after 1000 cycles.
        scene.limit_states[0].threshold = 1e-6;
        let (_, warnings) = found(&scene);
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        let message = &warnings[0].message;
        assert_eq!(warnings[0].key, "limit_states.wear");
        assert!(message.contains("before the first checkpoint at 1000"), "{message}");
        assert!(message.ends_with("checkpoint_every = 20 resolves its life"), "{message}");
        // The joint turns at 424 r/min from the first cycle on.
        scene.limit_states[0] = LimitState { output: 1, threshold: 40.0, ..scene.limit_states[0].clone() };
        let (_, warnings) = found(&scene);
        assert!(warnings[0].message.contains("has failed from the start"), "{warnings:?}");
        // Millimetres instead of micrometres.
        scene.limit_states[0] = LimitState { output: 0, threshold: 8e-3, ..scene.limit_states[0].clone() };
        let (_, warnings) = found(&scene);
        assert!(
            warnings[0].message.contains("0.1 % of the limit of 8000 µm: no failure will be seen"),
            "{warnings:?}"
        );
    }

    #[test]
    fn issue_a_life_far_beyond_every_limit_was_simulated_to_its_end() {
        let mut scene = SceneSource::builtin("four-bar").expect("built in").nominal().clone();
        // Worn by 8 um after some 6 000 cycles of 2 000 000.
        scene.limit_states.truncate(1);
        scene.life.cycles = 2_000_000;
        scene.life.checkpoint_every = 2000;
        let parts = std::cell::Cell::new(1);
        let count = |_| parts.set(parts.get() + 1);
        let evaluation = nominal_evaluation(&scene, None, &count).expect("simulated").expect("by the worker");
        let lives = nominal_lives(&scene, &evaluation);
        assert!(
            matches!(lives[0].reached, Reached::After(life) if (5000.0..7000.0).contains(&life)),
            "{lives:?}"
        );
        let last = *evaluation.cycles.last().expect("checkpoints");
        assert!(last <= 126_000, "{last}");
        // A cycle, then four blocks and the graded first one: it was ten cycles, then twice 24 blocks.
        assert!(parts.get() <= 2, "{}", parts.get());
        assert!(evaluation.diagnostics.simulated_cycles < 40, "{:?}", evaluation.diagnostics);
        // Checkpoints that lie farther apart than the life, and at a distance that nothing divides.
        scene.life.cycles = 300_000_007;
        scene.life.checkpoint_every = 300_000_007;
        let evaluation =
            nominal_evaluation(&scene, None, &|_| {}).expect("simulated").expect("by the worker");
        let last = *evaluation.cycles.last().expect("checkpoints");
        assert!(last <= 126_000, "{last}");
        assert!(evaluation.diagnostics.simulated_cycles < 200, "{:?}", evaluation.diagnostics);
    }

    #[test]
    fn hinges_without_contact_and_impossible_pressures_are_pointed_out() {
        let scene = SceneSource::builtin("four-bar").expect("built in").nominal().clone();
        let mut evaluation = Evaluation::from_histories(vec![1000], vec![vec![1e-6], vec![40.0]]);
        let summary = |name: &str, peak_force| JointSummary {
            name: name.to_owned(),
            peak_force,
            wear_depth: Vec::new(),
            journal_wear_depth: Vec::new(),
        };
        evaluation.joints = vec![summary("crank", 0.0), summary("coupler", 30.0), summary("rocker", 9e6)];
        evaluation.diagnostics.free_flight_fraction =
            vec![("crank".to_owned(), 1.0), ("coupler".to_owned(), 0.3)];
        let found = of_hinges(&scene, &evaluation);
        let keys: Vec<&str> = found.iter().map(|warning| warning.key.as_str()).collect();
        assert_eq!(keys, ["joints.crank", "joints.rocker"]);
        assert!(found[0].message.contains("never in contact"), "{found:?}");
        // 9 MN on 8 mm times 10 mm.
        assert!(found[1].message.contains("112500 MPa"), "{found:?}");
        let needle = include_str!("../../../common/tests/scenes/needle.toml");
        let guided = SceneSource::parse(needle, "needle").expect("valid");
        evaluation.diagnostics.free_flight_fraction = vec![("bush".to_owned(), 1.0)];
        let found = of_hinges(guided.nominal(), &evaluation);
        assert!(found.len() == 1 && found[0].message.starts_with("slider and guide are never"), "{found:?}");
    }

    #[test]
    fn checkpoints_divide_the_life_and_resolve_it() {
        assert_eq!(finer_checkpoints(8000, 450.0), Some(20));
        assert_eq!(finer_checkpoints(100_000, 3000.0), Some(200));
        assert_eq!(finer_checkpoints(7, 100.0), Some(1));
        assert_eq!(finer_checkpoints(8000, 5.0), None);
    }
}
