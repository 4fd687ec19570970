//! Eccentricities at which a journal does not touch its bore: the radial_gap of a joint, and the places of a worn bore that the journal bridges.
//!
//! The journal's circle is within the bore where the gap function of an elastic foundation is not above zero in any direction,
//!
//!   e . u(psi) <= G(psi),  G(psi) = R(psi) + h(psi - alpha) - R1 [m],
//!
//! with the eccentricity e [m], the unit vector u at angle psi [rad] in the bushing's frame, the worn bore R, the unworn radius R1 of the
//! journal and its depth h, turned by the angle alpha of its body from the bushing's [rad]. These half planes leave a convex region. Its
//! support function, the farthest that the journal gets along a direction, is
//!
//!   H(psi) = largest e . u(psi) <= G(psi),
//!
//! equal to G where the journal touches the bore on one side alone. Where it is smaller a groove is narrower than the journal, which then lies on
//! both edges and stays off the ground between by G(psi) - H(psi): there the radius of curvature of the bore, R + R'', is below that of
//! the journal.
//!
//! The corners of the region are found as the convex hull of the points u / G at equal angles, polar to the half planes: two
//! neighbours of the hull that are not neighbours of the table are the edges of a groove. Valid for eccentricities much smaller
//! than R1: the circle lies beyond its gap function by at most e^2 / (2 R1), off the contact.
//!
//! # Source
//! Support functions and polar bodies: Schneider, Convex Bodies: The Brunn-Minkowski Theory (2014), sections 1.6 and 1.7. Convex hull of points in
//! order of their angle: Graham (1972), Information Processing Letters 1, 132-133.

use super::journal_table::{Surfaces, within_a_turn};
use crate::plane::{cross, dot};
use std::f64::consts::TAU;

/// Fewest angles at which the bore is tabulated: half a degree apart, so that the edges of a groove are found within that.
const ANGLES: usize = 720;
/// Smallest gap that counts, as a share of the journal's radius [1]: a bore whose worn surface crosses the journal leaves a radial_gap of nothing.
const LEAST_GAP: f64 = 1e-12;

/// Eccentricities at which the surfaces of a joint do not touch.
#[derive(Debug, Clone)]
pub struct FreeRegion<'a> {
    surfaces: Surfaces<'a>,
    /// Unworn radius of the journal R1 [m].
    journal_radius: f64,
    /// Angle of the journal's body minus that of the bushing's [rad].
    turn: f64,
    /// G at equal angles from zero `(n,)` [m].
    gap: Vec<f64>,
    /// Unit vectors there `(n, 2)` [1].
    unit: Vec<[f64; 2]>,
    /// Indices of the angles at which the journal can touch, ascending.
    reached: Vec<usize>,
}

impl<'a> FreeRegion<'a> {
    /// The region between these `surfaces`, the journal of unworn radius `journal_radius` [m] turned by `turn` [rad] in its bushing.
    pub(crate) fn new(surfaces: Surfaces<'a>, journal_radius: f64, turn: f64) -> Self {
        let points = surfaces.bore.points();
        let n = points * ANGLES.div_ceil(points);
        let unit = |k: usize| {
            let (sin, cos) = libm::sincos(TAU * k as f64 / n as f64);
            [cos, sin]
        };
        let unit: Vec<[f64; 2]> = (0..n).map(unit).collect();
        let mut region = FreeRegion { surfaces, journal_radius, turn, gap: vec![], unit, reached: vec![] };
        region.gap = (0..n).map(|k| region.gap_at(TAU * k as f64 / n as f64)).collect();
        region.reached = hull(&region.gap, &region.unit);
        region
    }

    /// G at the angle `psi` in [0, 2 pi) [m].
    fn gap_at(&self, psi: f64) -> f64 {
        let worn = self
            .surfaces
            .journal
            .map_or(0.0, |journal| journal.unworn - journal.radius_at(within_a_turn(psi - self.turn)).r);
        let gap = self.surfaces.bore.radius_at(psi).r + worn - self.journal_radius;
        gap.max(LEAST_GAP * self.journal_radius)
    }

    /// Sum of the farthest ways along `a` and against it, times the length of `a`: the largest difference of a . e over all e of the
    /// region, in the unit of `a` times metres.
    pub(crate) fn width(&self, a: [f64; 2]) -> f64 {
        let size = libm::hypot(a[0], a[1]);
        if size == 0.0 {
            return 0.0;
        }
        let angle = libm::atan2(a[1], a[0]);
        size * (self.farthest(angle) + self.farthest(angle + 0.5 * TAU))
    }

    /// H at the angle `psi` [m].
    fn farthest(&self, psi: f64) -> f64 {
        let n = self.gap.len();
        let psi = psi.rem_euclid(TAU);
        let k = ((psi / TAU * n as f64) as usize).min(n - 1);
        let next = self.reached.partition_point(|&reached| reached <= k);
        let before = self.reached[if next == 0 { self.reached.len() - 1 } else { next - 1 }];
        let after = self.reached[if next == self.reached.len() { 0 } else { next }];
        if (before + 1) % n == after {
            return self.gap_at(psi);
        }
        let (sin, cos) = libm::sincos(psi);
        dot(self.corner(before, after), [cos, sin])
    }

    /// Eccentricity at which the journal touches at two angles of the table `(2,)` [m].
    fn corner(&self, i: usize, j: usize) -> [f64; 2] {
        let (u, v, a, b) = (self.unit[i], self.unit[j], self.gap[i], self.gap[j]);
        let sine = cross(u, v);
        [(a * v[1] - b * u[1]) / sine, (b * u[0] - a * v[0]) / sine]
    }

    /// The grooves that are narrower than the journal and whose ground it leaves open by more than `least` [m]: the angle
    /// of the middle of each in the bushing's frame, from 0 to one turn [rad], the angle between the two places at which the journal lies on its edges [rad], and
    /// the largest distance of the journal there from the ground [m].
    pub(crate) fn narrow_grooves(&self, least: f64) -> Vec<[f64; 3]> {
        let n = self.gap.len();
        let spacing = TAU / n as f64;
        let pairs = (0..self.reached.len()).map(|k| (k, (k + 1) % self.reached.len()));
        let groove = |(k, next): (usize, usize)| {
            let (i, j) = (self.reached[k], self.reached[next]);
            let between = (j + n - i) % n;
            if between < 2 {
                return None;
            }
            let corner = self.corner(i, j);
            let open_at = |m: usize| self.gap[(i + m) % n] - dot(corner, self.unit[(i + m) % n]);
            let open = (1..between).map(open_at).fold(0.0, f64::max);
            let angle = ((i as f64 + 0.5 * between as f64) * spacing).rem_euclid(TAU);
            (open > least).then_some([angle, between as f64 * spacing, open])
        };
        pairs.filter_map(groove).collect()
    }
}

/// Indices of the points u / G `(n,)` on their convex hull, ascending.
fn hull(gap: &[f64], unit: &[[f64; 2]]) -> Vec<usize> {
    let n = gap.len();
    let point = |k: usize| unit[k].map(|x| x / gap[k]);
    // The farthest point is on the hull.
    let first = (0..n).fold(0, |best, k| if gap[k] < gap[best] { k } else { best });
    let mut kept: Vec<usize> = vec![first];
    for k in (first + 1..=first + n).map(|k| k % n) {
        let at = point(k);
        while let [.., before, last] = kept[..] {
            let (a, b) = (point(before), point(last));
            if cross([b[0] - a[0], b[1] - a[1]], [at[0] - b[0], at[1] - b[1]]) > 0.0 {
                break;
            }
            kept.pop();
        }
        kept.push(k);
    }
    // The first point closes the hull.
    kept.pop();
    kept.sort_unstable();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bore::Profile;
    use crate::contact::Journal;

    const RADIUS: f64 = 10e-3;
    const CLEARANCE: f64 = 50e-6;

    fn bore(points: usize, depth: impl Fn(f64) -> f64) -> Profile {
        let mut bore = Profile::round(RADIUS + CLEARANCE, points);
        let angles = (0..points).map(|i| TAU * i as f64 / points as f64);
        bore.set_depth(&angles.map(depth).collect::<Vec<_>>());
        bore
    }

    fn region(bore: &Profile) -> FreeRegion<'_> {
        FreeRegion::new(Surfaces { bore, journal: None }, RADIUS, 0.0)
    }

    #[test]
    fn a_round_bore_leaves_the_clearance_in_every_direction() {
        let bore = bore(36, |_| 0.0);
        let region = region(&bore);
        for degrees in 0..360 {
            let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
            let width = region.width([3.0 * cos, 3.0 * sin]);
            assert!((width - 6.0 * CLEARANCE).abs() < 1e-14, "{width}");
        }
        assert_eq!(region.width([0.0; 2]), 0.0);
        assert!(region.narrow_grooves(0.0).is_empty());
    }

    #[test]
    fn a_bore_worn_as_by_a_moved_circle_has_the_play_of_that_circle() {
        // The bore reaches as far as before and as a circle whose centre is displaced by s along x: R = R2 + s max(0, cos psi). Its region
        // is the hull of both discs; across it the radial_gap is the old one, along it longer by s.
        let s = 40e-6;
        let bore = bore(144, |psi| s * psi.cos().max(0.0));
        let region = region(&bore);
        assert!((region.width([1.0, 0.0]) - 2.0 * CLEARANCE - s).abs() < 1e-9);
        assert!((region.width([0.0, 1.0]) - 2.0 * CLEARANCE).abs() < 0.01 * s);
        let oblique = region.width([0.5_f64.sqrt(); 2]);
        assert!((oblique - 2.0 * CLEARANCE - s * 0.5_f64.sqrt()).abs() < 1e-9, "{oblique}");
    }

    #[test]
    fn a_groove_narrower_than_the_journal_is_bridged() {
        // Width 40 deg, depth 20 um: R + R'' is below R1 on its ground. The journal lies on both edges.
        let half = 20.0_f64.to_radians();
        let middle = 100.0_f64.to_radians();
        let depth = 20e-6;
        let shape = |psi: f64| {
            let x = (psi - middle) / half;
            if x.abs() < 1.0 { depth * (1.0 - x * x).powi(2) } else { 0.0 }
        };
        let bore = bore(720, shape);
        let region = region(&bore);
        // Where the bore bends into the groove its spline ripples: the journal stays off these places by some nanometres.
        let grooves = region.narrow_grooves(0.01 * CLEARANCE);
        let [groove @ [angle, width, open]] = grooves[..] else { panic!("{grooves:?}") };
        assert!((angle - middle).abs() < 0.01, "{groove:?}");
        // Points of contact on its edges at +-x: e . u(x) = G and its derivative, by symmetry e = E along the middle, G' = -E sin x.
        let edge = |x: f64| {
            let z = x / half;
            let g = CLEARANCE + depth * (1.0 - z * z).powi(2);
            let slope = -4.0 * depth * z * (1.0 - z * z) / half;
            slope * x.cos() + g * x.sin()
        };
        let (mut low, mut high) = (0.3 * half, half);
        for _ in 0..60 {
            let mid = 0.5 * (low + high);
            if edge(mid) < 0.0 { low = mid } else { high = mid }
        }
        let z = low / half;
        let reach = (CLEARANCE + depth * (1.0 - z * z).powi(2)) / low.cos();
        assert!((width - 2.0 * low).abs() < 0.02, "{groove:?} against {}", 2.0 * low);
        assert!((open - (CLEARANCE + depth - reach)).abs() < 0.02e-6, "{groove:?} against {reach}");
        let across = [middle.cos(), middle.sin()];
        assert!((region.width(across) - CLEARANCE - reach).abs() < 0.02e-6);
    }

    #[test]
    fn a_groove_wider_than_the_journal_is_reached_everywhere() {
        // Depth 20 um over half a turn: R + R'' stays above R1.
        let bore = bore(144, |psi| 10e-6 * (1.0 + psi.cos()));
        let region = region(&bore);
        assert!(region.narrow_grooves(0.0).is_empty());
        assert!((region.width([1.0, 0.0]) - 2.0 * CLEARANCE - 20e-6).abs() < 1e-12);
    }

    #[test]
    fn a_worn_journal_has_play_where_it_is_turned_to() {
        let bore = bore(36, |_| 0.0);
        let mut journal = Journal::new(RADIUS, 36, None);
        let depth: Vec<f64> = (0..36).map(|i| 5e-6 * (1.0 + (TAU * f64::from(i) / 36.0).cos())).collect();
        journal.set_depth(&depth);
        for turn in [0.0, 1.0, 7.0] {
            let surfaces = Surfaces { bore: &bore, journal: Some(&journal) };
            let region = FreeRegion::new(surfaces, RADIUS, turn);
            // Worn at chi = 0, which lies at psi = turn.
            let far = region.farthest(turn) - CLEARANCE;
            let near = region.farthest(turn + 0.5 * TAU) - CLEARANCE;
            assert!((far - 10e-6).abs() < 1e-11 && near.abs() < 1e-11, "{far} {near}");
        }
    }
}
