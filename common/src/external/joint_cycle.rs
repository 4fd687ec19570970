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
