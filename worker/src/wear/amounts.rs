//! What the depths of a joint amount to: largest depth of each surface, growth of the clearance and worn volume.
//!
//! The depths of a joint are those at the control points of its bore, then those of its journal if that wears. With the
//! unworn radii R2 of the bore and R1 of the journal, the width L [m] and the angle s between control points [rad], the
//! volume between worn and unworn surfaces is L s (sum of (R2 h + h^2 / 2) over the bore + sum of (R1 h - h^2 / 2)
//! over the journal) [m^3]: the control points' sectors, and to second order in h / R the integral over the splines.
//!
//! # Source
//! Derived here.
//!
//! # Wear law
//! Archard's law of a pair of surfaces under a frozen contact history, as the wear step and its finer copy need it.
//!
//! Source:
//! Archard (1953), J. Appl. Phys. 24, 981-988.

use super::equilibrium::NoEquilibrium;
use crate::extremum::largest;
use crate::rail::RailLayout;
use common::scene::WearQuantity;
use std::f64::consts::TAU;

/// Sizes of the two surfaces that wear each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SurfaceSizes {
    /// Bushing and journal.
    Bore(BoreSizes),
    /// Guide and slider.
    Rail(RailLayout),
}

impl SurfaceSizes {
    /// Amounts at a mark within a block: of the depths, none of them outside those at the ends of its sub-step, and as interpolated `(points,)`
    /// [m]. These may lie outside those ends: their sum is that of the rates, as the worn volume has to be.
    pub(crate) fn amounts_at(&self, [depth, free]: [&[f64]; 2]) -> WornAmounts {
        WornAmounts { volume: self.amounts(free).volume, ..self.amounts(depth) }
    }

    /// Amounts of the depths `depth` `(depths,)` [m].
    pub(crate) fn amounts(&self, depth: &[f64]) -> WornAmounts {
        match self {
            SurfaceSizes::Bore(sizes) => sizes.amounts(depth),
            SurfaceSizes::Rail(layout) => rail_amounts(layout, depth),
        }
    }

    /// Largest depth of a surface and its bound [m], if one of the depths `depth` `(depths,)` [m] has passed it: half the unworn radius of bore
    /// and journal, half the length of a slider. The radii of the contact laws and the small eccentricities are far off there.
    pub(crate) fn too_deep(&self, depth: &[f64]) -> Option<[f64; 2]> {
        let (first, bounds) = match self {
            SurfaceSizes::Bore(sizes) => (sizes.points, sizes.radii.map(|radius| 0.5 * radius)),
            SurfaceSizes::Rail(layout) => (layout.guide_depths(), [layout.half_length; 2]),
        };
        let (one, other) = depth.split_at(first.min(depth.len()));
        let deepest = [one, other].map(|depth| largest(depth.iter().copied()));
        deepest
            .into_iter()
            .zip(bounds)
            .find(|(depth, bound)| depth > bound)
            .map(|(depth, bound)| [depth, bound])
    }
}

/// Amounts of the depths `depth` `(depths,)` of a guide and its slider [m].
fn rail_amounts(layout: &RailLayout, depth: &[f64]) -> WornAmounts {
    let (of_guide, of_slider) = depth.split_at(layout.guide_depths());
    let of_face = |depth: &[f64], points: usize, face: usize| {
        depth.chunks_exact(points).nth(face).map_or(0.0, |depth| largest(depth.iter().copied()))
    };
    WornAmounts {
        depths: [0, 1]
            .map(|face| [of_face(of_guide, layout.points, face), of_face(of_slider, layout.nodes(), face)]),
        volume: depth.iter().enumerate().map(|(k, h)| h * layout.area(k)).sum(),
    }
}

/// Sizes of the two surfaces of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoreSizes {
    /// Number of control points of each.
    pub points: usize,
    /// Unworn radii of bore and journal `(2,)` [m].
    pub radii: [f64; 2],
    /// Width of the bushing [m].
    pub width: f64,
}

/// What the wear of a joint amounts to, or an error of that.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct WornAmounts {
    /// Largest depths of both surfaces that face each other: of bore and journal in the first row, the second one being zero, or of guide and
    /// slider on either face `(2, 2)` [m].
    pub depths: [[f64; 2]; 2],
    /// Volume worn from both [m^3].
    pub volume: f64,
}

impl BoreSizes {
    /// Amounts of the depths `depth` of a joint [m].
    pub(crate) fn amounts(&self, depth: &[f64]) -> WornAmounts {
        let (bore, journal) = depth.split_at(self.points);
        let sector = |radius: f64, sign: f64| move |h: &f64| h * (radius + sign * 0.5 * h);
        let [of_bore, of_journal] = self.radii;
        let sum = bore.iter().map(sector(of_bore, 1.0)).sum::<f64>()
            + journal.iter().map(sector(of_journal, -1.0)).sum::<f64>();
        WornAmounts {
            depths: [[bore, journal].map(|depth| largest(depth.iter().copied())), [0.0; 2]],
            volume: sum * TAU / self.points as f64 * self.width,
        }
    }
}

impl WornAmounts {
    /// Largest depth of one of the two surfaces [m].
    pub(crate) fn depth(&self, surface: usize) -> f64 {
        self.depths[0][surface].max(self.depths[1][surface])
    }

    /// These amounts with `f` of each and its namesake of `other`.
    pub(crate) fn with(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        WornAmounts {
            depths: [0, 1].map(|face| [0, 1].map(|k| f(self.depths[face][k], other.depths[face][k]))),
            volume: f(self.volume, other.volume),
        }
    }
}

/// The value of an output of the wear for joints with these amounts [m or m^3].
pub(crate) fn wear_output(quantity: WearQuantity, joints: impl Iterator<Item = WornAmounts>) -> f64 {
    let value = |worn: WornAmounts| match quantity {
        WearQuantity::LargestDepth => worn.depth(0).max(worn.depth(1)),
        WearQuantity::BushingDepth => worn.depth(0),
        WearQuantity::JournalDepth => worn.depth(1),
        WearQuantity::ClearanceGrowth => {
            let [first, second] = worn.depths.map(|[one, other]| one + other);
            first.max(second)
        }
        WearQuantity::Volume => worn.volume,
    };
    let values = joints.map(value);
    if quantity == WearQuantity::Volume { values.sum() } else { values.fold(0.0, f64::max) }
}

/// Wear rate of a pair of surfaces whose contact history is held fixed.
pub(crate) trait WearLaw {
    /// Contacts of a cycle.
    type History;

    /// Replaces the frozen history by that of the cycle just simulated.
    fn freeze(&mut self, history: &Self::History);

    /// Forgets the frozen history where it takes much memory: until it is frozen anew there are no rates.
    fn release(&mut self) {}

    /// Sizes of the surfaces.
    fn sizes(&self) -> SurfaceSizes;

    /// Wear rate dh/dN of surfaces worn to `depth` `(depths,)` [m]: `rate` of the same length [m/cycle].
    ///
    /// # Errors
    /// [`NoEquilibrium`] if a frozen force has no equilibrium on these surfaces.
    fn rate(&mut self, depth: &[f64], rate: &mut [f64]) -> Result<(), NoEquilibrium>;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_are_those_of_rings() {
        // A bore bored out by 10 um and a journal turned down by 4 um all round.
        let sizes = BoreSizes { points: 36, radii: [1.5e-3, 1.48e-3], width: 4e-3 };
        let depth: Vec<f64> = (0..72).map(|i| if i < 36 { 10e-6 } else { 4e-6 }).collect();
        let WornAmounts { depths, volume } = sizes.amounts(&depth);
        assert_eq!(depths, [[10e-6, 4e-6], [0.0; 2]]);
        let ring = |a: f64, b: f64| 0.5 * TAU * (b * b - a * a) * 4e-3;
        let expected = ring(1.5e-3, 1.51e-3) + ring(1.476e-3, 1.48e-3);
        assert!((volume / expected - 1.0).abs() < 1e-12, "{volume:e} against {expected:e}");
        let joints = || [sizes.amounts(&depth), sizes.amounts(&depth[..36])].into_iter();
        let value = |quantity| wear_output(quantity, joints());
        assert_eq!(value(WearQuantity::LargestDepth), 10e-6);
        assert_eq!(value(WearQuantity::JournalDepth), 4e-6);
        assert_eq!(value(WearQuantity::ClearanceGrowth), 10e-6 + 4e-6);
        assert!(value(WearQuantity::Volume) > volume);
    }

    #[test]
    fn the_clearance_of_a_guide_grows_where_one_face_and_its_slider_have_worn_most() {
        let layout = RailLayout {
            points: 3,
            reach: [0.0, 0.2],
            elements: 4,
            half_length: 0.02,
            width: 0.01,
            guide_wears: true,
            slider_wears: true,
        };
        let mut depth = vec![0.0; layout.depths()];
        // Guide 5 and 4 um deep on its faces, slider 1 and 3 um.
        (depth[1], depth[5], depth[6], depth[15 + 4]) = (5e-6, 4e-6, 1e-6, 3e-6);
        let value =
            |quantity| wear_output(quantity, [SurfaceSizes::Rail(layout).amounts(&depth)].into_iter());
        assert_eq!(value(WearQuantity::LargestDepth), 5e-6);
        assert_eq!(value(WearQuantity::BushingDepth), 5e-6);
        assert_eq!(value(WearQuantity::JournalDepth), 3e-6);
        assert_eq!(value(WearQuantity::ClearanceGrowth), 4e-6 + 3e-6);
        // Half of 100 mm at the ends of the guide, 5 mm between nodes of the slider and half of it at their ends.
        let volume = 0.01 * (0.1 * 5e-6 + 0.05 * 4e-6 + 0.0025 * 1e-6 + 0.005 * 3e-6);
        assert!((value(WearQuantity::Volume) / volume - 1.0).abs() < 1e-12);
    }
}
