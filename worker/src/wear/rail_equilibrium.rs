//! Equilibrium of a slider between the two worn faces of its guide.
//!
//! With the offset a [m] of the slider's middle from the axis of the guide towards its left face, its tilt b [rad], and the gap z_i [m] that it
//! has to cross at node i of a face, clearance and wear depths together, the overlaps at the distances x_i from the middle are
//!
//!   g_i = a + b x_i - z_i on the left face,   g_i = - a - b x_i - z_i on the right one.
//!
//! With the potential U of `contact/pad.rs` of all elements of both faces, the equilibrium of the force F and the moment M is the minimum of
//! U(a, b) - F a - M b. U is convex, being a sum of convex functions of what is linear in (a, b), and grows without bound in every direction, since
//! the slider has a face on either side: there is one for every load. One face carries a force within it, two opposite corners a couple; the tilt
//! of such a slider follows from the clearance and the wear.
//!
//! Newton's method with a search along its direction: there the slope of the function only grows, so that its sign shows whether a step was
//! too long. Where little or nothing touches, the direction is that of the load.
//!
//! # Source
//! Damped Newton method for a convex function: Nocedal, Wright (2006), Numerical Optimization, chapters 3 and 6.

use super::equilibrium::NoEquilibrium;
use crate::contact::foundation;
use crate::extremum::largest;
use crate::rail::RailLayout;

/// Relative residual below which a load counts as carried.
const BALANCED: f64 = 1e-7;
/// Least overlap of the whole face that is solved for, over the largest gap [1]: the rounding of the gaps is 3e-8 of it, below [`BALANCED`].
const LEAST: f64 = 3e7 * f64::EPSILON;
/// Share of the load below which the present contact is too weak to predict the next one.
const WEAK: f64 = 0.2;
/// Slope at the end of a step over that at its start [1].
const DESCENT: f64 = 0.5;
/// Most steps, and evaluations along one. On a face that the slider nearly fits, light loads touch one element after the other on their way.
const STEPS: usize = 1000;
const ALONG: usize = 80;

/// The slider between the faces at one position along the guide, where its stiffness is that of a pair of faces on an elastic foundation.
#[derive(Debug, Clone)]
pub struct RailGaps {
    layout: RailLayout,
    /// Stiffness of a whole face [N/m].
    stiffness: f64,
    /// Gap z_i of both faces `(2, nodes)` [m].
    pub gap: [Vec<f64>; 2],
    /// Overlap g_i and force at the nodes of both faces, of the state evaluated last `(2, nodes)` [m, N].
    pub overlap: [Vec<f64>; 2],
    pub force: [Vec<f64>; 2],
}

/// Offset a and tilt times half the length, b l / 2 `(2,)` [m].
pub type SliderPose = [f64; 2];

/// Force F, and moment over half the length, of the foundation at one pose `(2,)` [N], their derivatives to a and a, a and b l / 2, b l / 2 and b l / 2 [N/m], and
/// the sum of the normal forces on both faces [N].
type Carried = ([f64; 2], [f64; 3], f64);

impl RailGaps {
    /// A slider with no gap on either side, the face of which has the `stiffness` [N/m].
    pub(super) fn new(layout: RailLayout, stiffness: f64) -> Self {
        let nodes = [vec![0.0; layout.nodes()], vec![0.0; layout.nodes()]];
        RailGaps { layout, stiffness, gap: nodes.clone(), overlap: nodes.clone(), force: nodes }
    }

    /// Foundation modulus: force per length and overlap [Pa].
    pub(super) fn modulus(&self) -> f64 {
        0.5 * self.stiffness / self.layout.half_length
    }

    fn at(&mut self, pose: SliderPose) -> Carried {
        let RailLayout { elements, .. } = self.layout;
        let unit = self.stiffness / (12 * elements) as f64;
        let (mut load, mut slopes, mut normal) = ([0.0; 2], [0.0; 3], 0.0);
        let per_element = 1.0 / elements as f64;
        for (face, sign) in [(0, 1.0), (1, -1.0)] {
            let place = |node: usize| node as f64 * per_element - 1.0;
            let (gap, overlap, force) = (&self.gap[face], &mut self.overlap[face], &mut self.force[face]);
            let mut deepest = f64::NEG_INFINITY;
            for (node, (gap, overlap)) in gap.iter().zip(overlap.iter_mut()).enumerate() {
                *overlap = sign * (pose[0] + pose[1] * place(node)) - gap;
                deepest = if *overlap > deepest { *overlap } else { deepest };
            }
            force.fill(0.0);
            if deepest <= 0.0 {
                continue;
            }
            for k in 0..2 * elements {
                let g = [overlap[k], overlap[k + 1]];
                if g[0] <= 0.0 && g[1] <= 0.0 {
                    continue;
                }
                // Most elements touch all along: two thirds and one third of a trapezium each.
                let ([p, q], [[aa, ab], [_, bb]]) = if g[0] > 0.0 && g[1] > 0.0 {
                    let of = |near: f64, far: f64| unit * (2.0 * near + far);
                    ([of(g[0], g[1]), of(g[1], g[0])], [[2.0 * unit, unit], [unit, 2.0 * unit]])
                } else {
                    let (_, forces, seconds) = foundation(unit, g);
                    (forces, seconds)
                };
                let (x, y) = (place(k), place(k + 1));
                force[k] += p;
                force[k + 1] += q;
                normal += p + q;
                load[0] += sign * (p + q);
                load[1] += sign * (x * p + y * q);
                slopes[0] += aa + 2.0 * ab + bb;
                slopes[1] += (aa + ab) * x + (ab + bb) * y;
                slopes[2] += (aa * x + 2.0 * ab * y) * x + bb * y * y;
            }
        }
        (load, slopes, normal)
    }

    /// The equilibrium of the force `load[0]` and the moment `load[1]` times half the slider's length [N], sought from `start`: where the slider is, and the load that is
    /// carried over the one wanted, one but for the lightest loads [1]. Leaves overlaps and forces of that
    /// state. Lighter loads than one whose overlap can be resolved beside the gaps get the equilibrium of such a load.
    ///
    /// # Errors
    /// [`NoEquilibrium`] if the search does not converge.
    pub(super) fn equilibrium(
        &mut self,
        load: [f64; 2],
        start: SliderPose,
    ) -> Result<(SliderPose, f64), NoEquilibrium> {
        let widest = largest(self.gap.iter().flatten().copied());
        let size = load[0].abs() + load[1].abs();
        let least = LEAST * self.stiffness * widest;
        let heavier = if size < least { least / size } else { 1.0 };
        let load = load.map(|x| x * heavier);
        let size = size * heavier;
        let (mut pose, mut now) = (start, self.at(start));
        let mut residual = f64::INFINITY;
        for _ in 0..STEPS {
            let left = [load[0] - now.0[0], load[1] - now.0[1]];
            residual = left[0].abs().max(left[1].abs()) / size;
            if residual <= BALANCED {
                return Ok((pose, heavier));
            }
            (pose, now) = self.step(load, size, (pose, &now), left);
        }
        Err(NoEquilibrium(residual / BALANCED))
    }

    /// A step from the pose `from` with the load `left` that it does not carry.
    fn step(
        &mut self,
        load: [f64; 2],
        size: f64,
        (from, (_, slopes, normal)): (SliderPose, &Carried),
        left: [f64; 2],
    ) -> (SliderPose, Carried) {
        let is_weak = *normal < WEAK * size;
        let ridge = if is_weak { self.stiffness } else { 1e-12 * self.stiffness };
        let [aa, ab, bb] = [slopes[0] + ridge, slopes[1], slopes[2] + ridge];
        let per_determinant = 1.0 / (aa * bb - ab * ab);
        let direction = [
            (bb * left[0] - ab * left[1]) * per_determinant,
            (aa * left[1] - ab * left[0]) * per_determinant,
        ];
        let slope_to = |left: [f64; 2]| left[0] * direction[0] + left[1] * direction[1];
        let first = slope_to(left);
        let (mut low, mut high, mut length) = (0.0, f64::INFINITY, 1.0);
        let mut tried = 0;
        loop {
            let pose = [from[0] + length * direction[0], from[1] + length * direction[1]];
            let carried = self.at(pose);
            let slope = slope_to([load[0] - carried.0[0], load[1] - carried.0[1]]);
            tried += 1;
            if slope.abs() <= DESCENT * first || tried == ALONG {
                return (pose, carried);
            }
            if slope > 0.0 {
                low = length;
            } else {
                high = length;
            }
            length = if high < f64::INFINITY { 0.5 * (low + high) } else { 4.0 * length };
        }
    }
}
