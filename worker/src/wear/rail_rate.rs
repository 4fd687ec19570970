//! Archard's law over one cycle for a guide and its slider: wear rate of every control point of their faces under a frozen contact history.
//!
//! A sample of the history (`rail_history.rs`) holds the load F, M of the two faces, the position s of the slider, the sum N of the normal forces
//! and the work W = integral of the sum of P |ds/dt| dt: the slider has slid by S = W / N. On the present faces the slider takes the pose in which the foundation carries that load (`rail_equilibrium.rs`).
//! With the forces P_i at the nodes of the slider there, and the pressure per length p of which they are the shares of hat functions, the slider
//! and the guide wear by
//!
//!   dh_i/dn = K_s S P_i / A_i,   dh_j/dn = K_g S (integral of p phi_j) / A_j   [m per cycle],
//!
//! with the wear coefficients K [1/Pa], the areas A [m^2] of the control points, and the hat function phi_j of a control point of the guide, at the
//! places s + x along it. The integral is exact for the linear pressure of an element. Both surfaces wear by Archard's volume
//! K S sum of P for every sample, whatever the spacing of the control points; that is K W as long as one face bears. Two corners that bear a couple are pressed
//! harder as their facets grow inwards.
//!
//! Samples of nearly the same contact are replaced by their mean, weighted with their work: those with the same halves of faces in contact, F / N and M / (N l / 2), N = max(|F|, |M| / (l / 2)), in the
//! same cell of [`PLACE`], N between two powers of [`LEVEL`], and where the guide wears s in the same quarter of the distance of two control points.
//!
//! Valid for mild sliding wear with a constant K; wear never decreases.
//!
//! # Source
//! Archard (1953), J. Appl. Phys. 24, 981-988. Wear of a foundation under a rigid surface: as in `conformal.rs`.

use super::amounts::{SurfaceSizes, WearLaw};
use super::equilibrium::NoEquilibrium;
use super::rail_equilibrium::{RailGaps, SliderPose};
use super::rail_history::{RailHistory, RailSample};
use crate::rail::{RailFaces, RailLayout};
use std::collections::BTreeMap;

/// Ratio of the largest to the smallest load of a group of samples [1].
const LEVEL: f64 = 1.1;
/// Cells of F / N and of M / (N l / 2) of a group [1].
const PLACE: f64 = 1.0 / 32.0;
/// Groups of positions within the distance of two control points [1].
const MOVES: f64 = 4.0;

/// Wear rate of one guide and its slider under a frozen contact history.
#[derive(Debug, Clone)]
pub struct RailWearRate {
    /// Wear coefficients K of guide and slider [1/Pa].
    coefficients: [f64; 2],
    /// Clearance on each side [m].
    clearance: f64,
    faces: RailFaces,
    gaps: RailGaps,
    /// Means of the groups of samples, each with the pose of the slider found last, none before the first.
    pub(super) samples: Vec<(RailSample, Option<SliderPose>)>,
}

impl RailWearRate {
    /// Rate of a guide with these control points, wear coefficients, `clearance` on each side [m] and `stiffness` of a whole face [N/m].
    pub(crate) fn new(coefficients: [f64; 2], layout: RailLayout, clearance: f64, stiffness: f64) -> Self {
        RailWearRate {
            coefficients,
            clearance,
            faces: RailFaces::new(layout),
            gaps: RailGaps::new(layout, stiffness),
            samples: vec![],
        }
    }

    /// Group of a sample.
    fn group(&self, sample: &RailSample) -> (u8, i32, [i32; 2], i32) {
        let layout = &self.faces.layout;
        let moment = sample.moment / layout.half_length;
        let size = sample.force.abs().max(moment.abs()).max(f64::MIN_POSITIVE);
        let cell = |load: f64| (load / size / PLACE).round() as i32;
        let level = (libm::log(size) / libm::log(LEVEL)).floor() as i32;
        let place = (sample.position / layout.spacing() * MOVES).floor() as i32;
        // An unworn guide is the same everywhere.
        let place = if layout.guide_wears { place } else { 0 };
        (sample.touching, level, [cell(sample.force), cell(moment)], place)
    }

    /// Gaps of both faces with the slider at the position `s` along the guide [m].
    fn set_gaps(&mut self, s: f64) {
        let layout = self.faces.layout;
        for (face, gaps) in self.gaps.gap.iter_mut().enumerate() {
            for (node, gap) in gaps.iter_mut().enumerate() {
                let of_guide = self.faces.guide_depth(face, s + layout.node(node))[0];
                *gap = self.clearance + of_guide + self.faces.slider[face][node];
            }
        }
    }

    /// Adds `scale` times the hat functions' shares of the pressure on a face of the guide, with the slider at `s` [m], to `shares` `(points,)`.
    fn add_guide_shares(&self, face: usize, s: f64, scale: f64, shares: &mut [f64]) {
        let layout = &self.faces.layout;
        let modulus = scale * self.gaps.modulus();
        for (k, g) in self.gaps.overlap[face].windows(2).enumerate() {
            if g[0] <= 0.0 && g[1] <= 0.0 {
                continue;
            }
            // The part of the element that touches, between the fractions u and v of it.
            let root = g[0] / (g[0] - g[1]);
            let (u, v) = if g[0] < 0.0 {
                (root, 1.0)
            } else if g[1] < 0.0 {
                (0.0, root)
            } else {
                (0.0, 1.0)
            };
            let start = s + layout.node(k);
            let pressure = |t: f64| modulus * (g[0] + t * (g[1] - g[0])).max(0.0);
            add_hats(layout, [start, layout.element()], [u, v], pressure, shares);
        }
    }
}

/// Adds the integrals of `pressure`, linear over an element that begins at a place and has a length [m], times the hat functions to `shares`: over
/// the fractions from `from` to `to` of the element, in parts that end at the control points.
fn add_hats(
    layout: &RailLayout,
    [start, length]: [f64; 2],
    [from, to]: [f64; 2],
    pressure: impl Fn(f64) -> f64,
    shares: &mut [f64],
) {
    let cells = length / layout.spacing();
    let mut u = from;
    while u < to {
        let middle_of_rest = start + length * (u + 1e-9 * (to - u));
        let (k, fraction) = layout.place(middle_of_rest);
        // Up to the next control point; the last part takes what is left, also beyond the end of the guide.
        let is_last = k + 2 == layout.points;
        let v = if is_last { to } else { to.min(u + ((1.0 - fraction) / cells).max(1e-9)) };
        let hat = |t: f64| {
            let along = ((start + t * length - layout.reach[0]) / layout.spacing()) - k as f64;
            along.clamp(0.0, 1.0)
        };
        // Simpson's rule is exact for the product of two straight lines.
        let middle = 0.5 * (u + v);
        let sixth = length * (v - u) / 6.0;
        let (a, m, b) = (sixth * pressure(u), 4.0 * sixth * pressure(middle), sixth * pressure(v));
        let after = a * hat(u) + m * hat(middle) + b * hat(v);
        shares[k] += a + m + b - after;
        shares[k + 1] += after;
        u = v;
    }
}

impl WearLaw for RailWearRate {
    type History = RailHistory;

    fn freeze(&mut self, history: &RailHistory) {
        let mut groups: BTreeMap<_, RailSample> = BTreeMap::new();
        for sample in history.samples.iter().filter(|sample| sample.work > 0.0) {
            let of_group = groups.entry(self.group(sample));
            of_group.and_modify(|mean| *mean = joined(mean, sample)).or_insert(*sample);
        }
        self.samples = groups.into_values().map(|sample| (sample, None)).collect();
    }

    fn sizes(&self) -> SurfaceSizes {
        SurfaceSizes::Rail(self.faces.layout)
    }

    fn rate(&mut self, depth: &[f64], rate: &mut [f64]) -> Result<(), NoEquilibrium> {
        self.faces.set_depth(depth);
        rate.fill(0.0);
        let layout = self.faces.layout;
        let [wears_guide, wears_slider] = self.coefficients.map(|coefficient| coefficient > 0.0);
        // A sample without a pose begins with that of the group before, whose load is much the same.
        let mut near = [0.0; 2];
        for index in 0..self.samples.len() {
            let (sample, found) = self.samples[index];
            self.set_gaps(sample.position);
            let load = [sample.force, sample.moment / layout.half_length];
            if load == [0.0; 2] || sample.normal <= 0.0 {
                continue;
            }
            let (pose, heavier) = self.gaps.equilibrium(load, found.unwrap_or(near))?;
            self.samples[index].1 = Some(pose);
            near = pose;
            let scale = sample.work / (sample.normal * heavier);
            let (of_guide, of_slider) = rate.split_at_mut(layout.guide_depths());
            for face in 0..2 {
                if wears_guide {
                    let shares = &mut of_guide[face * layout.points..(face + 1) * layout.points];
                    self.add_guide_shares(face, sample.position, scale, shares);
                }
                if wears_slider {
                    let shares = &mut of_slider[face * layout.nodes()..(face + 1) * layout.nodes()];
                    shares.iter_mut().zip(&self.gaps.force[face]).for_each(|(share, p)| *share += scale * p);
                }
            }
        }
        for (k, rate) in rate.iter_mut().enumerate() {
            *rate *= self.coefficients[usize::from(k >= layout.guide_depths())] / layout.area(k);
        }
        Ok(())
    }
}

/// The mean of two samples with their work as weight, and the sum of their work.
fn joined(a: &RailSample, b: &RailSample) -> RailSample {
    let work = a.work + b.work;
    let share = b.work / work;
    let mean = |a: f64, b: f64| a + share * (b - a);
    RailSample {
        force: mean(a.force, b.force),
        moment: mean(a.moment, b.moment),
        position: mean(a.position, b.position),
        normal: mean(a.normal, b.normal),
        work,
        touching: a.touching,
    }
}
