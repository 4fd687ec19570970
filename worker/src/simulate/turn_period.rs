//! The period of a machine whose cycle is one turn of a free body, such as a crank under a motor: the time that a turn takes once the motion
//! has settled.
//!
//! The machine runs from its start; the instants at which the body has turned by 2 pi n are those on the cubic through angle and speed at the
//! time steps, of fourth order like the steps. The times tau_n of successive turns decay geometrically to the period: with the ratio
//! r = (tau_n - tau_(n-1)) / (tau_(n-1) - tau_(n-2))
//!
//!   T = tau_n + r / (1 - r) (tau_n - tau_(n-1))        [s].
//!
//! # Source
//! Aitken's method: Stoer, Bulirsch, Introduction to Numerical Analysis (2002), section 5.10.

use super::conditions::condition_scenes;
use super::{LaneQueue, Run, Simulated};
use crate::outputs::BodyTrack;
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::scene::Scene;
use std::f64::consts::TAU;

/// Most turns that are simulated; slower machines have the last estimate.
const MOST_TURNS: usize = 200;
/// Change of the period from one estimate to the next up to which it is settled [1].
const SETTLED: f64 = 1e-9;
/// Most cycles of the start's period within which a body has to turn once.
const LONGEST_TURN: f64 = 20.0;

/// The scene with the settled period, all its conditions included; `None` if its cycle is a given time.
///
/// # Errors
/// [`SimulationFailure`] if the integration stops, or the body does not turn.
pub(crate) async fn with_period_of_turn(
    queue: &LaneQueue,
    scene: &Scene,
    accuracy: &Accuracy,
) -> Simulated<Option<Scene>> {
    if scene.life.turn_of.is_none() {
        return Ok(None);
    }
    let mut timed = scene.clone();
    let mut periods = Vec::new();
    for (scene, _) in condition_scenes(scene) {
        periods.push(period_of_turn(queue, scene, accuracy).await?);
    }
    timed.life.period = periods[0];
    let conditions = timed.conditions.iter_mut().zip(&periods);
    conditions.for_each(|(condition, period)| condition.scene.life.period = *period);
    Ok(Some(timed))
}

/// Time of a turn of the settled motion [s].
async fn period_of_turn(queue: &LaneQueue, scene: &Scene, accuracy: &Accuracy) -> Simulated<f64> {
    let (Some(body), guess) = (scene.life.turn_of, scene.life.period) else { return Ok(scene.life.period) };
    let mut run = Run::assemble(queue.clone(), scene, accuracy)?;
    let (mut first, mut times) = (None, vec![]);
    let mut last = f64::NAN;
    for cycle in 0.. {
        run.measure().await?;
        let track = run.islands.iter().find_map(|state| state.recorder.body(&state.island, body));
        let Some(track) = track else { break };
        add_turns(&mut first, &mut times, f64::from(cycle) * guess, track);
        let found = settled_period(&times);
        let enough = found.is_some_and(|period| (period - last).abs() <= SETTLED * period);
        if enough || times.len() > MOST_TURNS {
            break;
        }
        last = found.unwrap_or(f64::NAN);
        if f64::from(cycle) > LONGEST_TURN * (times.len() as f64 + 1.0) {
            let name = &scene.bodies[body].name;
            let what = format!(
                "period = \"turn of {name}\", which does not turn once in {:.3} s: give it a start_speed and a motor that keep it turning",
                LONGEST_TURN * guess
            );
            return Err(SimulationFailure::NotModelled { what });
        }
    }
    Ok(settled_period(&times).unwrap_or(guess))
}

/// Adds the track of a cycle that begins at `start` [s] to the instants at which a body has turned by whole turns, the start included [s]; `first` is the
/// angle at the first instant [rad].
fn add_turns(first: &mut Option<f64>, times: &mut Vec<f64>, start: f64, track: &BodyTrack) {
    let Some((&from, &time)) = track.values[0].first().zip(track.time.first()) else { return };
    let first = *first.get_or_insert(from);
    if times.is_empty() {
        times.push(start + time);
    }
    for k in 0..track.time.len() - 1 {
        let turned = |k: usize| (track.values[0][k] - first).abs() / TAU;
        let next = times.len() as f64;
        if turned(k) < next && turned(k + 1) >= next {
            times.push(start + instant(track, k, |angle| (angle - first).abs() / TAU - next));
        }
    }
}

/// Period of the settled motion with these instants [s], from four on.
fn settled_period(times: &[f64]) -> Option<f64> {
    let [.., a, b, c, d] = times[..] else { return None };
    let taus = [b - a, c - b, d - c];
    let (before, change) = (taus[1] - taus[0], taus[2] - taus[1]);
    let ratio = change / before;
    let rest = if ratio.abs() < 1.0 { change * ratio / (1.0 - ratio) } else { 0.0 };
    Some(taus[2] + rest)
}

/// Time in interval `k` of the track at which `off` of the angle passes zero from below [s].
fn instant(track: &BodyTrack, k: usize, off: impl Fn(f64) -> f64) -> f64 {
    let piece = track.angle_in(k);
    let (mut low, mut high) = (track.time[k], track.time[k + 1]);
    while high - low > 1e-15 * high.abs().max(1e-3 * (track.time[k + 1] - track.time[k])) {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if off(piece.at(middle).0) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_of_a_speed_that_settles_have_the_settled_period() {
        // omega = 10 + 2 exp(-t), the angle its integral, in cycles of 0.4 s.
        let angle = |t: f64| 10.0 * t + 2.0 * (1.0 - (-t).exp());
        let (mut first, mut times) = (None, vec![]);
        let mut period = None;
        for cycle in 0..60 {
            let mut track = BodyTrack::default();
            for k in 0..=200 {
                let local = 0.4 * f64::from(k) / 200.0;
                let t = 0.4 * f64::from(cycle) + local;
                track.push(local, [angle(t), 10.0 + 2.0 * (-t).exp(), -2.0 * (-t).exp()]);
            }
            add_turns(&mut first, &mut times, 0.4 * f64::from(cycle), &track);
            period = settled_period(&times);
        }
        let settled = TAU / 10.0;
        assert!((period.expect("turned") / settled - 1.0).abs() < 1e-9, "{period:?}");
        assert_eq!(times.len(), 39);
        assert!((angle(times[1]) / TAU - 1.0).abs() < 1e-6, "{}", times[1]);
    }
}
