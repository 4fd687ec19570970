//! Contacts of one joint over a cycle that closes.

use std::f64::consts::TAU;

/// Largest distance of the next angle of a cycle, extrapolated from its last two, from a whole turn [rad].
const NEARLY_WHOLE: f64 = 0.3;

/// A joint as its program knows it.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleJoint {
    /// Name in the scene.
    pub name: String,
    /// The surfaces that touch in it.
    pub surfaces: CycleSurfaces,
}

/// Surfaces of a joint of which a cycle gives the contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CycleSurfaces {
    /// A journal in a bore.
    Bore {
        /// Radius of the journal R1 [m].
        journal_radius: f64,
        /// True if the journal wears, at places that depend on its angle.
        has_worn_journal: bool,
    },
    /// A slider in a guide.
    Guide {
        /// Half the length of the slider [m].
        half_length: f64,
    },
}

impl CycleSurfaces {
    /// Fields of a reply besides the instants, in the order of the vectors of a model; the first three are needed.
    pub(super) fn fields(&self) -> &'static [&'static str] {
        match self {
            Self::Bore { .. } => {
                &["force_x", "force_y", "angle", "sliding", "eccentricity_x", "eccentricity_y"]
            }
            Self::Guide { .. } => &["force", "moment", "position", "sliding", "normal"],
        }
    }
}

/// Contacts of one joint over a closed cycle: the last instant is the first one of the next cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct JointCycle {
    /// Instants `(n,)` [s].
    pub time: Vec<f64>,
    /// Sum of the sizes of the normal forces `(n,)` [N].
    pub normal: Vec<f64>,
    /// Sliding speed `(n,)` [m/s].
    pub sliding: Vec<f64>,
    /// Where they act.
    pub contacts: CycleContacts,
}

/// Places of the contacts of a joint over a cycle.
#[derive(Debug, Clone, PartialEq)]
pub enum CycleContacts {
    /// Of a journal in its bore.
    Bore {
        /// Normal force of the journal on the bushing, in the bushing's frame `(n, 2)` [N].
        force: Vec<[f64; 2]>,
        /// Angle of the journal's body minus that of the bushing's `(n,)` [rad].
        angle: Option<Vec<f64>>,
        /// Eccentricity in the bushing's frame `(n, 2)` [m].
        eccentricity: Option<Vec<[f64; 2]>>,
    },
    /// Of a slider in its guide.
    Guide {
        /// Normal force of the slider on the guide towards the left of its axis, and its moment about the slider's middle `(n, 2)` [N, N m].
        load: Vec<[f64; 2]>,
        /// Position of the slider's middle along the guide `(n,)` [m].
        position: Vec<f64>,
    },
}

impl JointCycle {
    /// Repeats the first instant after the `period` [s]; an angle has gone on by whole turns.
    pub(super) fn close(&mut self, period: f64) {
        self.time.push(self.time[0] + period);
        self.normal.push(self.normal[0]);
        match &mut self.contacts {
            CycleContacts::Bore { force, angle, eccentricity } => {
                force.push(force[0]);
                if let Some(angle) = angle {
                    let n = angle.len();
                    let next = angle[n - 1] + (angle[n - 1] - angle[n - 2]);
                    let whole = angle[0] + TAU * ((next - angle[0]) / TAU).round();
                    // Of an angle that is not in radians the next one is kept, for the check of its turns.
                    angle.push(if (whole - next).abs() < NEARLY_WHOLE { whole } else { next });
                }
                eccentricity.iter_mut().for_each(|e| e.push(e[0]));
            }
            CycleContacts::Guide { load, position } => {
                load.push(load[0]);
                position.push(position[0]);
            }
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

/// Checks the contacts of a joint; `of_motion` is the sliding speed that follows from its angle or position `(n,)` [m/s].
///
/// # Errors
/// The field and what is wrong with it.
pub fn check_joint(joint: &CycleJoint, cycle: &JointCycle, of_motion: Option<&[f64]>) -> Result<(), String> {
    if let CycleContacts::Bore { angle: Some(angle), .. } = &cycle.contacts {
        let turns = (angle[angle.len() - 1] - angle[0]) / TAU;
        if (turns - turns.round()).abs() > WHOLE_TURNS {
            let turns = (1e4 * turns).round() / 1e4;
            return Err(format!(
                "angle advances by {turns} turns over the cycle, not by whole ones: it is in radians"
            ));
        }
    }
    let weight = |k: usize| cycle.normal[k] * cycle.sliding[k].abs();
    // A sliding speed without any sign is its size.
    if let Some(of_motion) = of_motion
        && cycle.sliding.iter().any(|speed| *speed < 0.0)
        && integral(cycle, |k| cycle.normal[k] * cycle.sliding[k] * of_motion[k]) < 0.0
    {
        return Err(match joint.surfaces {
            CycleSurfaces::Bore { .. } => {
                "sliding is against the rate of angle: the bushing's frame turns the wrong way, or one of them is bushing minus journal"
            }
            CycleSurfaces::Guide { .. } => {
                "sliding is against the rate of position: both are those of the slider along the guide"
            }
        }
        .to_owned());
    }
    if let (
        CycleSurfaces::Bore { journal_radius, .. },
        CycleContacts::Bore { force, eccentricity: Some(e), .. },
    ) = (joint.surfaces, &cycle.contacts)
    {
        let farthest = e.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
        if farthest > journal_radius {
            return Err(format!(
                "eccentricity_x and eccentricity_y reach {} m, beyond the journal's radius of {journal_radius} m: they are in metres",
                (1e3 * farthest).round() / 1e3,
            ));
        }
        let along = |k: usize| weight(k) * (e[k][0] * force[k][0] + e[k][1] * force[k][1]);
        if integral(cycle, along) < 0.0 {
            return Err("force_x and force_y point against the eccentricity: they are the force of the journal on the bushing, in the \
                        bushing's frame"
                .to_owned());
        }
    }
    let error = 3.0 * sampling_error(cycle);
    if error > JUMPING {
        let [first, second, ..] = joint.surfaces.fields() else { unreachable!("fields of a force") };
        return Err(format!(
            "{first} and {second} jump between instants: without every other one the work of the joint is {} % another; give more \
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
    let work = |k: usize| cycle.normal[k] * cycle.sliding[k].abs();
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
