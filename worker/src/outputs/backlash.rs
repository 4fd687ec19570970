//! Free play of a body with a drive held at an angle, from the clearances and the worn bores.
//!
//! To first order in the gaps a coordinate moves by the sum over the joints with clearance of g_j . e_j (`gap_influences`), and the
//! eccentricities e_j [m] are free within their bores, independently of each other. A round journal of radius R1 [m] fits into a bore
//! of radius R(psi) [m] where
//!
//!   e . u(psi) <= R(psi) - R1   for every direction u(psi),
//!
//! up to the square of the clearance over R1. The free play is the range that this leaves,
//!
//!   sum over j of h_j(g_j) + h_j(-g_j),      h_j(g) = max g . e over the eccentricities that fit;
//!
//! of an unworn bore with clearance c it is 2 c |g_j|. The maximum is that of a linear program in the plane; its dual is where the ray along
//! g leaves the convex hull of the points u(psi) / (R(psi) - R1). Elastic deformation does not count.
//!
//! # Source
//! Duality of support function and hull: Rockafellar, Convex Analysis (1970), section 14. Convex hull by the monotone chain: Andrew (1979),
//! Information Processing Letters 9, 216-219.

use crate::bore::Profile;
use crate::mechanism::gap_influences;
use crate::plane::{cross, length};
use common::failure::SimulationFailure;
use common::scene::{JointKind, OutputKind, Scene};
use std::f64::consts::TAU;

/// Directions in which a bore bounds its journal, besides that of the play itself: 8e-6 of the clearance are cut off.
const DIRECTIONS: usize = 720;

/// The output `angle-backlash` [rad] or `position-backlash` [m].
#[derive(Debug, Clone, PartialEq)]
pub struct Backlash {
    joints: Vec<Play>,
}

/// One joint with clearance.
#[derive(Debug, Clone, PartialEq)]
struct Play {
    /// Index into the scene's joints.
    joint: usize,
    /// g_j in the bushing's frame `(2,)` [1 or 1/m].
    influence: [f64; 2],
    /// Radius of the journal [m].
    journal: f64,
    /// The unworn bore.
    bore: Profile,
}

impl Backlash {
    /// The backlash of an output of the scene; `None` for an output of another kind.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the mechanism cannot be moved to the angle.
    pub(crate) fn new(
        scene: &Scene,
        kind: &OutputKind,
        iterations: &mut u64,
    ) -> Result<Option<Self>, SimulationFailure> {
        let OutputKind::Backlash { of, drive, angle } = kind else { return Ok(None) };
        let influences = gap_influences(scene, of, *drive, *angle, iterations)?;
        let play = |(joint, influence): (usize, [f64; 2])| match &scene.joints[joint].kind {
            JointKind::Clearance(clearance) => Some(Play {
                joint,
                influence,
                journal: clearance.journal_radius,
                bore: Profile::round(clearance.bushing_radius, clearance.control_points),
            }),
            _ => None,
        };
        Ok(Some(Backlash { joints: influences.into_iter().filter_map(play).collect() }))
    }

    /// Range of the coordinate with bores worn by `depths` at their control points `(joints, points)` [m], empty where nothing wears.
    pub(crate) fn value(&self, depths: &[Vec<f64>]) -> f64 {
        self.joints.iter().map(|play| play.range(&depths[play.joint])).sum()
    }

    /// Error that errors of the depths of all joints `(joints,)` [m] cause.
    pub(crate) fn error(&self, depth: impl Fn(usize) -> f64) -> f64 {
        self.joints.iter().map(|play| 2.0 * length(play.influence) * depth(play.joint)).sum()
    }
}

impl Play {
    /// h(g) + h(-g) with this depth at the control points.
    fn range(&self, depth: &[f64]) -> f64 {
        let mut bore = self.bore.clone();
        if depth.len() == bore.points() {
            bore.set_depth(depth);
        }
        let size = length(self.influence);
        if size == 0.0 {
            return 0.0;
        }
        let forth = self.influence.map(|x| x / size);
        let gap = |psi: f64| bore.radius_at(psi.rem_euclid(TAU)).r - self.journal;
        size * (reach(forth, gap) + reach(forth.map(|x| -x), gap))
    }
}

/// Largest e . d along the unit vector `d` over the e with e . u(psi) <= gap(psi) for all directions [m].
fn reach(d: [f64; 2], gap: impl Fn(f64) -> f64) -> f64 {
    let straight = libm::atan2(d[1], d[0]);
    let mut points: Vec<[f64; 2]> = (0..DIRECTIONS)
        .map(|k| {
            let psi = straight + TAU * k as f64 / DIRECTIONS as f64;
            let (sin, cos) = libm::sincos(psi);
            let gap = gap(psi);
            [cos / gap, sin / gap]
        })
        .collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let hull = convex_hull(&points);
    // The edge that the ray crosses: its ends lie on either side of it, and ahead.
    let leaves = |(a, b): (&[f64; 2], &[f64; 2])| {
        let (left, right) = (cross(d, *b), cross(d, *a));
        let along = cross(d, [b[0] - a[0], b[1] - a[1]]);
        let distance = cross(*a, *b) / along;
        (right <= 0.0 && left >= 0.0 && along > 0.0 && distance > 0.0).then_some(distance)
    };
    let edges = hull.iter().zip(hull.iter().cycle().skip(1));
    let distance = edges.filter_map(leaves).fold(0.0, f64::max);
    // The origin lies within the hull, whose edges surround it.
    if distance > 0.0 { 1.0 / distance } else { gap(straight) }
}

/// Corners of the convex hull of points sorted by x, then y, counter-clockwise.
fn convex_hull(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let chain = |points: &mut dyn Iterator<Item = &[f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && cross([b[0] - a[0], b[1] - a[1]], [p[0] - b[0], p[1] - b[1]]) <= 0.0
            {
                chain.pop();
            }
            chain.push(*p);
        }
        chain.pop();
        chain
    };
    [chain(&mut points.iter()), chain(&mut points.iter().rev())].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn direction(angle: f64) -> [f64; 2] {
        [angle.cos(), angle.sin()]
    }

    #[test]
    fn a_round_bore_reaches_its_clearance_and_a_shifted_one_its_shift() {
        let c = 30e-6;
        for angle in [0.0, 0.4, 2.0, 3.1, -1.7] {
            let d = direction(angle);
            assert!((reach(d, |_| c) / c - 1.0).abs() < 1e-12);
            // Moved by 10 um along x, the journal reaches as far as before from there.
            let found = reach(d, |psi| c + 10e-6 * psi.cos());
            assert!((found - c - 10e-6 * d[0]).abs() < 1e-12, "{angle}: {found}");
        }
    }

    #[test]
    fn a_slot_is_reached_by_what_is_beside_it() {
        // Unbounded but for a square of half the width a: along the diagonal the corner is at a sqrt 2.
        let a = 20e-6;
        let square = |psi: f64| a * (psi.cos().abs() + psi.sin().abs());
        assert!((reach(direction(0.0), square) / a - 1.0).abs() < 1e-9);
        let corner = reach(direction(std::f64::consts::FRAC_PI_4), square);
        assert!((corner / (a * 2.0_f64.sqrt()) - 1.0).abs() < 1e-9, "{corner}");
        // A deep groove a degree wide holds no round journal.
        let grooved = |psi: f64| if psi.rem_euclid(TAU).abs() < 0.009 { 1e-3 } else { a };
        let found = reach(direction(0.0), grooved);
        assert!((found / a - 1.0).abs() < 2e-4, "{found}");
    }
}
