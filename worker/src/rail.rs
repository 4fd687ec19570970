//! Worn faces of a straight guide and of the slider in it: wear depths of control points along both.
//!
//! Each of the two faces of the guide has N control points at equal distances D = (s_1 - s_0) / (N - 1) over its reach [s_0, s_1] [m]. Between
//! them the depth w(s) is the monotone cubic of Fritsch and Butland, level beyond both ends: continuous with its slope, and without a dip or a
//! hump that the control points do not have.
//!
//! Each face of the slider, of the length l [m], has a node at the middle and m elements of the length l / (2 m) on either side of it, whose
//! nodes are its control points; its depth is linear in between, as is the overlap of both faces. Where the guide wears, m is the smallest number
//! whose elements are no longer than D.
//!
//! Depths of a pair are stored as (left face of the guide, right face, left face of the slider, right face), without the latter two unless the
//! slider wears.
//!
//! # Source
//! Fritsch, Butland (1984), SIAM J. Sci. Stat. Comput. 5, 300-304.
//!
//! # Play
//! Play of a slider between the worn faces of its guide.
//!
//! With the offset a [m] and the tilt b [rad] of the slider, whose nodes lie at the distances x_i from its middle, and the gaps z_i [m] there,
//! clearance and wear depths together, the slider is free where
//!
//!   a + b x_i <= z_i on the left face,   - a - b x_i <= z_i on the right one.
//!
//! The largest value of lambda_0 a + lambda_1 b over this polygon is, by the duality of linear programs, the smallest mu_p z_p + mu_q z_q over all
//! pairs of nodes whose constraints give (lambda_0, lambda_1) with weights mu >= 0: the reactions of the faces to the load (lambda_0, lambda_1).
//!
//! Source:
//! Duality: Nocedal, Wright (2006), Numerical Optimization, chapter 13.

use crate::interpolate::Cubic;
use common::scene::monotone::fritsch_butland;
use common::scene::{GuideClearance, GuideWear};

/// Fewest and most elements of half a face of a slider. The fewest show a facet at a corner at all; with the most a control point lies at each
/// hundredth of the slider.
const ELEMENTS: (usize, usize) = (4, 64);
/// Most nodes of half a face of a slider.
pub const MOST_NODES: usize = ELEMENTS.1 + 1;

/// Where the control points of both faces of a guide and of its slider are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RailLayout {
    /// Control points N of each face of the guide.
    pub points: usize,
    /// Ends of the guide along its axis `(2,)` [m].
    pub reach: [f64; 2],
    /// Elements m of each half of a face of the slider.
    pub elements: usize,
    /// Half of the slider's length [m].
    pub half_length: f64,
    /// Width of the contact [m].
    pub width: f64,
    /// True if the guide wears, and if the slider does and has depths.
    pub guide_wears: bool,
    pub slider_wears: bool,
}

impl RailLayout {
    /// Control points of a checked guide that wears.
    pub(crate) fn new(guide: &GuideClearance, wear: &GuideWear) -> Self {
        let [of_guide, of_slider] = wear.coefficients();
        let points = wear.control_points;
        let spacing = (guide.reach[1] - guide.reach[0]) / (points - 1) as f64;
        let half_length = 0.5 * guide.length;
        let elements =
            if of_guide > 0.0 { (half_length / spacing).ceil() as usize } else { points.div_ceil(2) };
        RailLayout {
            points,
            reach: guide.reach,
            elements: elements.clamp(ELEMENTS.0, ELEMENTS.1),
            half_length,
            width: guide.width,
            guide_wears: of_guide > 0.0,
            slider_wears: of_slider > 0.0,
        }
    }

    /// A layout of this guide with half the distance between control points.
    pub(crate) fn finer(&self) -> Self {
        RailLayout { points: 2 * self.points - 1, elements: 2 * self.elements, ..*self }
    }

    /// Distance D between the control points of the guide [m].
    pub(crate) fn spacing(&self) -> f64 {
        (self.reach[1] - self.reach[0]) / (self.points - 1) as f64
    }

    /// Length of an element of the slider [m].
    pub(crate) fn element(&self) -> f64 {
        self.half_length / self.elements as f64
    }

    /// Nodes of a face of the slider.
    pub(crate) fn nodes(&self) -> usize {
        2 * self.elements + 1
    }

    /// Distance of a node from the slider's middle, along it [m].
    #[inline(always)]
    pub(crate) fn node(&self, node: usize) -> f64 {
        self.half_length * (node as f64 / self.elements as f64 - 1.0)
    }

    /// Number of depths of the guide.
    pub(crate) fn guide_depths(&self) -> usize {
        2 * self.points
    }

    /// Number of all depths.
    pub(crate) fn depths(&self) -> usize {
        self.guide_depths() + if self.slider_wears { 2 * self.nodes() } else { 0 }
    }

    /// Area of the control point with this index among the depths: half at the ends of a face [m^2].
    pub(crate) fn area(&self, depth: usize) -> f64 {
        let (within, points, length) = match depth.checked_sub(self.guide_depths()) {
            None => (depth % self.points, self.points, self.spacing()),
            Some(of_slider) => (of_slider % self.nodes(), self.nodes(), self.element()),
        };
        let share = if within == 0 || within + 1 == points { 0.5 } else { 1.0 };
        share * length * self.width
    }

    /// Index of a control point before the place `s` along the guide [m], and the fraction of the distance to the next one, in [0, 1].
    #[inline(always)]
    pub(crate) fn place(&self, s: f64) -> (usize, f64) {
        let intervals = (self.points - 1) as f64;
        let u = ((s - self.reach[0]) / (self.reach[1] - self.reach[0]) * intervals).clamp(0.0, intervals);
        let k = (u as usize).min(self.points - 2);
        (k, u - k as f64)
    }
}

/// The faces of a guide and of its slider as worn so far.
#[derive(Debug, Clone, PartialEq)]
pub struct RailFaces {
    pub(crate) layout: RailLayout,
    /// Cubics between the control points of both faces of the guide `(2, points - 1)` [m].
    guide: [Vec<Cubic>; 2],
    /// Depth at the nodes of both faces of the slider `(2, nodes)` [m].
    pub(crate) slider: [Vec<f64>; 2],
}

impl RailFaces {
    /// Faces without any wear.
    pub(crate) fn new(layout: RailLayout) -> Self {
        let guide = vec![Cubic([0.0; 4]); layout.points - 1];
        let slider = vec![0.0; layout.nodes()];
        RailFaces { layout, guide: [guide.clone(), guide], slider: [slider.clone(), slider] }
    }

    /// Replaces the depths `(depths,)` [m].
    pub(crate) fn set_depth(&mut self, depth: &[f64]) {
        let (of_guide, of_slider) = depth.split_at(self.layout.guide_depths());
        for (cubics, depth) in self.guide.iter_mut().zip(of_guide.chunks_exact(self.layout.points)) {
            let last = depth.len() - 1;
            let slope = |k: usize| {
                if k == 0 || k == last {
                    return 0.0;
                }
                fritsch_butland([1.0; 2], [depth[k] - depth[k - 1], depth[k + 1] - depth[k]])
            };
            for (k, cubic) in cubics.iter_mut().enumerate() {
                *cubic = Cubic::hermite([depth[k], depth[k + 1]], [slope(k), slope(k + 1)]);
            }
        }
        for (to, from) in self.slider.iter_mut().zip(of_slider.chunks_exact(self.layout.nodes())) {
            to.copy_from_slice(from);
        }
    }

    /// Depth of a face of the guide at the place `s` along it [m], and its first and second derivative along it [1, 1/m].
    #[inline(always)]
    pub(crate) fn guide_depth(&self, face: usize, s: f64) -> [f64; 3] {
        if !self.layout.guide_wears {
            return [0.0; 3];
        }
        let (k, fraction) = self.layout.place(s);
        let cubic = &self.guide[face][k];
        let per_spacing = 1.0 / self.layout.spacing();
        let inside = s > self.layout.reach[0] && s < self.layout.reach[1];
        let per_spacing = if inside { per_spacing } else { 0.0 };
        [
            cubic.value(fraction),
            cubic.slope(fraction) * per_spacing,
            cubic.curvature(fraction) * per_spacing * per_spacing,
        ]
    }
}

/// Determinant of two constraints below which they are parallel, over the slider's length [1].
const PARALLEL: f64 = 1e-12;

/// Range of `lambda[0]` a + `lambda[1]` b of a slider with its middle at `s` [m] and the `clearance` [m] on each side.
pub(crate) fn play(faces: &RailFaces, clearance: f64, lambda: [f64; 2], s: f64) -> f64 {
    let layout = &faces.layout;
    let constraints: Vec<([f64; 2], f64)> = [(0, 1.0), (1, -1.0)]
        .into_iter()
        .flat_map(|(face, sign)| {
            (0..layout.nodes()).map(move |node| {
                let x = layout.node(node);
                let worn = faces.guide_depth(face, s + x)[0] + faces.slider[face][node];
                ([sign, sign * x], clearance + worn)
            })
        })
        .collect();
    let least = PARALLEL * layout.half_length;
    largest(&constraints, lambda, least) + largest(&constraints, lambda.map(|x| -x), least)
}

/// Largest value of `lambda` . z over the z with n . z <= r for all `constraints` (n, r).
fn largest(constraints: &[([f64; 2], f64)], lambda: [f64; 2], least: f64) -> f64 {
    let mut smallest = f64::INFINITY;
    for (p, (np, rp)) in constraints.iter().enumerate() {
        for (nq, rq) in &constraints[p + 1..] {
            let determinant = np[0] * nq[1] - np[1] * nq[0];
            if determinant.abs() <= least {
                continue;
            }
            let mu = [
                (lambda[0] * nq[1] - lambda[1] * nq[0]) / determinant,
                (np[0] * lambda[1] - np[1] * lambda[0]) / determinant,
            ];
            if mu[0] >= 0.0 && mu[1] >= 0.0 {
                smallest = smallest.min(mu[0] * rp + mu[1] * rq);
            }
        }
    }
    smallest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout() -> RailLayout {
        RailLayout {
            points: 11,
            reach: [-0.1, 0.15],
            elements: 4,
            half_length: 0.025,
            width: 0.02,
            guide_wears: true,
            slider_wears: true,
        }
    }

    #[test]
    fn a_trough_has_its_depths_at_the_control_points_and_neither_dips_nor_humps() {
        let layout = layout();
        let mut faces = RailFaces::new(layout);
        let mut depth = vec![0.0; layout.depths()];
        depth[3..8].copy_from_slice(&[2e-6, 5e-6, 5e-6, 4e-6, 1e-6]);
        depth[layout.guide_depths() + 2] = 7e-6;
        faces.set_depth(&depth);
        assert_eq!((faces.slider[0][2], faces.slider[1][2]), (7e-6, 0.0));
        for (k, depth) in depth[..11].iter().enumerate() {
            let s = -0.1 + 0.025 * k as f64;
            assert!((faces.guide_depth(0, s)[0] - depth).abs() < 1e-18, "{k}");
            assert_eq!(faces.guide_depth(1, s)[0], 0.0);
        }
        let h = 1e-6;
        for i in 0..2600 {
            let s = -0.105 + 1e-4 * f64::from(i) + 3.7e-5;
            let [w, slope, bend] = faces.guide_depth(0, s);
            let (k, fraction) = layout.place(s);
            let (low, high) = (depth[k].min(depth[k + 1]), depth[k].max(depth[k + 1]));
            assert!(w >= low - 1e-18 && w <= high + 1e-18, "{s} {fraction}");
            let (before, after) = (faces.guide_depth(0, s - h), faces.guide_depth(0, s + h));
            assert!((slope - (after[0] - before[0]) / (2.0 * h)).abs() < 1e-8, "{s}: {slope}");
            if (layout.place(s - h).0, layout.place(s + h).0) == (k, k) {
                assert!((bend - (after[1] - before[1]) / (2.0 * h)).abs() < 1e-6, "{s}: {bend}");
            }
        }
    }

    #[test]
    fn areas_are_those_of_the_faces() {
        let layout = layout();
        let of_guide: f64 = (0..layout.guide_depths()).map(|k| layout.area(k)).sum();
        let of_slider: f64 = (layout.guide_depths()..layout.depths()).map(|k| layout.area(k)).sum();
        assert!((of_guide / (2.0 * 0.25 * 0.02) - 1.0).abs() < 1e-14);
        assert!((of_slider / (2.0 * 0.05 * 0.02) - 1.0).abs() < 1e-14);
        assert_eq!((layout.node(0), layout.node(4), layout.node(8)), (-0.025, 0.0, 0.025));
    }
}

#[cfg(test)]
mod play_tests {
    use super::*;
    use crate::rail::RailLayout;

    const CLEARANCE: f64 = 1e-4;
    const HALF: f64 = 0.025;

    fn faces() -> RailFaces {
        RailFaces::new(RailLayout {
            points: 11,
            reach: [-0.1, 0.1],
            elements: 5,
            half_length: HALF,
            width: 0.02,
            guide_wears: true,
            slider_wears: true,
        })
    }

    /// Between flat faces both ends of the slider have the play 2 c: 2 c (|lambda_0 / 2 + lambda_1 / l| + |lambda_0 / 2 - lambda_1 / l|).
    #[test]
    fn between_flat_faces_the_ends_have_the_play_of_the_clearance() {
        let faces = faces();
        for lambda in [[1.0, 0.0], [0.0, 1.0], [0.7, -0.01], [-2.0, 0.3]] {
            let (half, couple) = (0.5 * lambda[0], lambda[1] / (2.0 * HALF));
            let expected = 2.0 * CLEARANCE * ((half + couple).abs() + (half - couple).abs());
            let found = play(&faces, CLEARANCE, lambda, 0.01);
            assert!((found / expected - 1.0).abs() < 1e-12, "{lambda:?}: {found} {expected}");
        }
    }

    /// A face worn evenly adds its depth; a trough into which the slider does not fit adds nothing to its offset, a worn corner lets it turn.
    #[test]
    fn wear_adds_the_play_that_the_slider_can_use() {
        let mut faces = faces();
        let layout = faces.layout;
        let mut depth = vec![0.0; layout.depths()];
        depth[..11].fill(6e-6);
        faces.set_depth(&depth);
        let offset = |faces: &RailFaces| play(faces, CLEARANCE, [1.0, 0.0], 0.0);
        assert!((offset(&faces) - 2.06e-4).abs() < 1e-15);
        // 20 mm between control points, slider 50 mm long: between its ends only.
        depth[..11].fill(0.0);
        depth[5] = 6e-6;
        faces.set_depth(&depth);
        assert!((offset(&faces) - 2e-4).abs() < 1e-15);
        depth[5] = 0.0;
        // The right end of the left face: tilted by a couple the slider turns on the left end of the right face.
        depth[22 + 10] = 6e-6;
        faces.set_depth(&depth);
        assert!((offset(&faces) - 2e-4).abs() < 1e-15);
        let turn = play(&faces, CLEARANCE, [0.0, 1.0], 0.0);
        // One way 2 c / l, the other way by the next node, 5 mm inside, (2 c) / (l - 5 mm), at most (2 c + 6 um) / l.
        let expected = 2e-4 / 0.05 + (2e-4_f64 / 0.045).min(2.06e-4 / 0.05);
        assert!((turn / expected - 1.0).abs() < 1e-12, "{turn} {expected}");
    }
}
