//! Contacts of one joint over a cycle that closes.

use std::f64::consts::TAU;

/// Largest distance of the next angle of a cycle, extrapolated from its last two, from a whole turn [rad].
const NEARLY_WHOLE: f64 = 0.3;

/// A joint as its program knows it.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleJoint {
    /// Name in the scene.
    pub name: String,
    /// Radius of the journal R1 [m].
    pub journal_radius: f64,
    /// True if the journal wears, at places that depend on its angle.
    pub has_worn_journal: bool,
}

/// Contacts of one joint over a closed cycle: the last instant is the first one of the next cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct JointCycle {
    /// Instants `(n,)` [s].
    pub time: Vec<f64>,
    /// Normal force of the journal on the bushing, in the bushing's frame `(n, 2)` [N].
    pub force: Vec<[f64; 2]>,
    /// Sliding speed `(n,)` [m/s].
    pub sliding: Vec<f64>,
    /// Angle of the journal's body minus that of the bushing's `(n,)` [rad].
    pub angle: Option<Vec<f64>>,
    /// Eccentricity in the bushing's frame `(n, 2)` [m].
    pub eccentricity: Option<Vec<[f64; 2]>>,
}

impl JointCycle {
    /// Repeats the first instant after the `period` [s]; an angle has gone on by whole turns.
    pub(super) fn close(&mut self, period: f64) {
        self.time.push(self.time[0] + period);
        self.force.push(self.force[0]);
        if let Some(angle) = &mut self.angle {
            let n = angle.len();
            let next = angle[n - 1] + (angle[n - 1] - angle[n - 2]);
            let whole = angle[0] + TAU * ((next - angle[0]) / TAU).round();
            // Of an angle that is not in radians the next one is kept, for the check of its turns.
            angle.push(if (whole - next).abs() < NEARLY_WHOLE { whole } else { next });
        }
        if let Some(eccentricity) = &mut self.eccentricity {
            eccentricity.push(eccentricity[0]);
        }
    }
}

/// Slopes of the parabolas through every three of the values at the instants `time` of a closed cycle `(n,)` [1/s].
pub fn slopes(time: &[f64], values: &[f64]) -> Vec<f64> {
    let n = time.len();
    let slope = |k: usize| (values[k + 1] - values[k]) / (time[k + 1] - time[k]);
    let at = |k: usize| {
        let (before, after) = if k == 0 || k == n - 1 { (n - 2, 0) } else { (k - 1, k) };
        let (h, g) = (time[before + 1] - time[before], time[after + 1] - time[after]);
        (g * slope(before) + h * slope(after)) / (h + g)
    };
    (0..n).map(at).collect()
}

/// Part of a turn by which an angle may miss a whole number of turns over a cycle [1]: motions that have not quite settled.
const WHOLE_TURNS: f64 = 0.05;
/// Largest relative change of the work if every other instant is left out [1].
const JUMPING: f64 = 0.2;

/// Checks the contacts of a joint; `of_angle` is the sliding speed that follows from its angle `(n,)` [m/s].
///
/// # Errors
/// The field and what is wrong with it.
pub fn check_joint(joint: &CycleJoint, cycle: &JointCycle, of_angle: Option<&[f64]>) -> Result<(), String> {
    if let Some(angle) = &cycle.angle {
        let turns = (angle[angle.len() - 1] - angle[0]) / TAU;
        if (turns - turns.round()).abs() > WHOLE_TURNS {
            let turns = (1e4 * turns).round() / 1e4;
            return Err(format!(
                "angle advances by {turns} turns over the cycle, not by whole ones: it is in radians"
            ));
        }
    }
    let weight = |k: usize| length(cycle.force[k]) * cycle.sliding[k].abs();
    // A sliding speed without any sign is its size.
    if let Some(of_angle) = of_angle
        && cycle.sliding.iter().any(|speed| *speed < 0.0)
        && integral(cycle, |k| length(cycle.force[k]) * cycle.sliding[k] * of_angle[k]) < 0.0
    {
        return Err("sliding is against the rate of angle: the bushing's frame turns the wrong way, or one of them is bushing minus \
                    journal"
            .to_owned());
    }
    if let Some(e) = &cycle.eccentricity {
        let farthest = e.iter().copied().map(length).fold(0.0, f64::max);
        if farthest > joint.journal_radius {
            return Err(format!(
                "eccentricity_x and eccentricity_y reach {} m, beyond the journal's radius of {} m: they are in metres",
                (1e3 * farthest).round() / 1e3,
                joint.journal_radius
            ));
        }
        let along = |k: usize| weight(k) * (e[k][0] * cycle.force[k][0] + e[k][1] * cycle.force[k][1]);
        if integral(cycle, along) < 0.0 {
            return Err("force_x and force_y point against the eccentricity: they are the force of the journal on the bushing, in the \
                        bushing's frame"
                .to_owned());
        }
    }
    let error = 3.0 * sampling_error(cycle);
    if error > JUMPING {
        return Err(format!(
            "force_x and force_y jump between instants: without every other one the work of the joint is {} % another; give more \
             instants where they change",
            (100.0 * error).round()
        ));
    }
    Ok(())
}

/// Relative error of the work of a joint by the trapezoidal rule: a third of what leaving out every other instant changes [1].
///
/// # Source
/// Richardson extrapolation of a rule of second order: Davis, Rabinowitz, Methods of Numerical Integration (1984).
pub fn sampling_error(cycle: &JointCycle) -> f64 {
    let work = |k: usize| length(cycle.force[k]) * cycle.sliding[k].abs();
    let all = integral(cycle, work);
    let last = cycle.time.len() - 1;
    let mut kept: Vec<usize> = (0..last).step_by(2).collect();
    kept.push(last);
    let half: f64 = kept
        .windows(2)
        .map(|k| 0.5 * (cycle.time[k[1]] - cycle.time[k[0]]) * (work(k[0]) + work(k[1])))
        .sum();
    if all > 0.0 { (half - all).abs() / (3.0 * all) } else { 0.0 }
}

/// Integral over the cycle by the trapezoidal rule.
fn integral(cycle: &JointCycle, value: impl Fn(usize) -> f64) -> f64 {
    let steps = cycle.time.windows(2).enumerate();
    steps.map(|(k, time)| 0.5 * (time[1] - time[0]) * (value(k) + value(k + 1))).sum()
}

fn length(v: [f64; 2]) -> f64 {
    v[0].hypot(v[1])
}
