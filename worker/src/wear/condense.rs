//! Contact samples of a cycle in groups of nearly the same contact: their wear is found from group to group instead of from
//! sample to sample.
//!
//! A group holds the samples whose penetration delta [m] lies between a power of [`LEVEL`] and the next, and whose direction lies in
//! the same sector of the bore, and of a journal that wears. A sector is as wide as [`TURN`] of the half angle of their contact arc [rad]:
//! sqrt(2 delta / c) on a round bore, with the clearance c [m]. On a worn bore the arc is wider; where the journal wears too, and samples fall into
//! many more sectors, the half angle is that of the worn surfaces, between a power of [`WIDTH`] and the next. Sectors of very light contacts are [`NARROW`] of the spacing of the control points, below which
//! nothing of the arc's shape is left in the depths. A group is replaced by its mean, weighted with the work, so that what it leaves out
//! is of second order in its width.
//!
//! Used for the elastic foundation, whose equilibria are expensive. Under the local law groups would leave a fifth of the arcs and move the
//! drive's depth by 0.04 %, but the fewer samples share the work, the rougher is the bore they wear: the vibration that sets in late in the
//! drive's life depends on such details, and its asymmetry moves by up to 4 % of its limit, with groups half as wide as well.
//!
//! # Source
//! Chosen here.
//!
//! # Contact arc
//! Contact arc of a journal in its unworn bore: what the spacing of the control points has to resolve.
//!
//! A journal of radius r [m] whose centre lies e = c + delta off that of a bore of radius R = r + c, with the penetration delta [m], stands
//! outside the bore over the angle 2 beta about the centre of the bore,
//!
//!   cos beta = (R^2 + e^2 - r^2) / (2 R e).
//!
//! The arc of a joint is the mean of 2 beta over a cycle, weighted with the work F S of each contact sample [N m]: that of the contacts that wear.
//! With wear the arc becomes wider.
//!
//! Source:
//! Two intersecting circles; the mean is chosen here.

use super::interval::{ContactHistory, ContactSample};
use std::f64::consts::{PI, TAU};

/// Ratio of the largest to the smallest penetration of a group [1].
const LEVEL: f64 = 1.2;
/// Ratio of the largest to the smallest half angle of a group [1].
const WIDTH: f64 = 1.4;
/// Width of a sector over the half angle of the arc [1], and its least and largest one over the spacing of the control points.
const TURN: f64 = 0.35;
const NARROW: f64 = 0.05;
const WIDE: f64 = 0.5;

/// Levels of penetration and half angle, sectors of the bore and of the journal.
type SampleGroup = (i32, i32, u32, u32);

/// Groups samples of joints with one clearance and number of control points.
#[derive(Debug, Clone)]
pub struct Condenser {
    /// Radial clearance of the unworn joint [m].
    clearance: f64,
    /// Angle between control points [rad].
    spacing: f64,
    /// Group and index of every sample.
    order: Vec<(SampleGroup, u32)>,
}

impl Condenser {
    /// For a joint with this radial clearance [m] and number of control points.
    pub(super) fn new(clearance: f64, points: usize) -> Self {
        Condenser { clearance, spacing: TAU / points as f64, order: Vec::new() }
    }

    /// Group of a contact in the `direction` `(2,)`, of any length, with its `penetration` on a round bore [m]. Its half angle is that on the worn
    /// surfaces [rad], at least that on a round bore; `None`: that on a round bore. `turn_of_journal` is the angle of a journal that wears from the
    /// bushing [rad].
    fn group(
        &self,
        direction: [f64; 2],
        (penetration, half_angle): (f64, Option<f64>),
        turn_of_journal: Option<f64>,
    ) -> SampleGroup {
        let level = (libm::log(penetration) / libm::log(LEVEL)).floor();
        let round = (2.0 * libm::pow(LEVEL, level) / self.clearance).sqrt();
        // Of contacts with a known half angle those of one width share the sectors.
        let arc_level = match half_angle {
            Some(half_arc) => (libm::log(half_arc.max(round)) / libm::log(WIDTH)).floor(),
            None => 0.0,
        };
        let half_arc = if half_angle.is_some() { libm::pow(WIDTH, arc_level) } else { round };
        let width = (TURN * half_arc).clamp(NARROW * self.spacing, WIDE * self.spacing);
        let turn = libm::atan2(direction[1], direction[0]) / TAU + 0.5;
        let sectors = (TAU / width).ceil();
        let on_journal = turn_of_journal.map_or(0.0, |angle| (turn - angle / TAU).rem_euclid(1.0));
        (level as i32, arc_level as i32, (turn * sectors) as u32, (on_journal * sectors) as u32)
    }

    /// The means of the groups of `samples`, whose contacts have the penetration and half angle `touched` under a journal that wears or not, into
    /// `means`.
    pub(super) fn condense(
        &mut self,
        samples: &[ContactSample],
        touched: impl Fn(&ContactSample) -> (f64, Option<f64>),
        wears: bool,
        means: &mut Vec<ContactSample>,
    ) {
        self.order.clear();
        for (index, sample) in samples.iter().enumerate() {
            let turn = wears.then_some(sample.turn);
            self.order.push((self.group(sample.force, touched(sample), turn), index as u32));
        }
        self.order.sort_unstable();
        means.clear();
        for group in self.order.chunk_by(|a, b| a.0 == b.0) {
            let members = group.iter().map(|&(_, index)| &samples[index as usize]);
            means.push(if group.len() > 1 { mean(members) } else { samples[group[0].1 as usize] });
        }
    }
}

/// The mean of samples with their work as weight, and the sum of their work.
fn mean<'a>(samples: impl Iterator<Item = &'a ContactSample> + Clone) -> ContactSample {
    let work: f64 = samples.clone().map(|s| s.work).sum();
    // Angles of a group differ by whole turns and little more.
    let reference = samples.clone().next().map_or(0.0, |sample| sample.turn);
    let beyond = |turn: f64| (turn - reference) - TAU * ((turn - reference) / TAU).round();
    let turn = samples.clone().map(|s| s.work * beyond(s.turn)).sum::<f64>() / work;
    let of =
        |value: fn(&ContactSample) -> f64| samples.clone().map(|s| s.work * value(s)).sum::<f64>() / work;
    ContactSample {
        e: [of(|s| s.e[0]), of(|s| s.e[1])],
        penetration: of(|s| s.penetration),
        force: [of(|s| s.force[0]), of(|s| s.force[1])],
        work,
        turn: reference + turn,
    }
}

/// Mean contact arc of a history on an unworn bore [rad]; zero without contact. `radii` are those of bore and journal `(2,)` [m].
pub(crate) fn mean_contact_arc(history: &ContactHistory, [bore, journal]: [f64; 2]) -> f64 {
    let arc = |penetration: f64| {
        let e = bore - journal + penetration;
        let cosine = (bore * bore + e * e - journal * journal) / (2.0 * bore * e);
        2.0 * libm::acos(cosine.clamp(-1.0, 1.0)).min(PI)
    };
    let (work, arcs) = history.samples.iter().fold((0.0, 0.0), |(work, arcs), sample| {
        (work + sample.work, arcs + sample.work * arc(sample.penetration))
    });
    if work > 0.0 { arcs / work } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(angle: f64, penetration: f64, work: f64) -> ContactSample {
        let u = [angle.cos(), angle.sin()];
        ContactSample { e: u.map(|u| 25e-6 * u), penetration, force: u, work, turn: 0.0 }
    }

    fn condensed(samples: &[ContactSample]) -> Vec<ContactSample> {
        let mut means = vec![];
        Condenser::new(23.5e-6, 36).condense(samples, |s| (s.penetration, None), false, &mut means);
        means
    }

    #[test]
    fn work_is_kept_and_groups_are_narrow() {
        // Directions all around and penetrations over a decade, in no order.
        let samples: Vec<ContactSample> = (0..20_000)
            .map(|k| {
                let k = f64::from(k);
                sample((37.0 * k).sin() * 3.2, 1e-7 * 10f64.powf((k * 0.618_034).fract()), 1.0 + k % 3.0)
            })
            .collect();
        let means = condensed(&samples);
        assert!(means.len() < samples.len() / 4, "{}", means.len());
        let work = |samples: &[ContactSample]| samples.iter().map(|s| s.work).sum::<f64>();
        assert!((work(&means) / work(&samples) - 1.0).abs() < 1e-12);
        // The mean of unit vectors of a sector of 5 deg or less is nearly a unit vector.
        let shortest = means.iter().map(|s| crate::plane::length(s.force)).fold(1.0, f64::min);
        assert!(shortest > 0.999, "{shortest}");
    }

    #[test]
    fn a_sample_alone_stays_as_it_is_and_a_pair_becomes_its_mean() {
        let alone = [sample(0.4, 1e-7, 2.0), sample(2.0, 1e-7, 1.0), sample(0.4, 5e-7, 3.0)];
        assert_eq!(condensed(&alone).len(), 3);
        assert_eq!(condensed(&alone[..1]), alone[..1]);
        let pair = condensed(&[sample(0.4, 1.000e-7, 1.0), sample(0.4, 1.004e-7, 3.0)]);
        assert_eq!((pair.len(), pair[0].work), (1, 4.0));
        assert!((pair[0].penetration - 1.003e-7).abs() < 1e-18);
    }
}

#[cfg(test)]
mod contact_arc_tests {
    use super::*;
    use crate::wear::ContactSample;

    #[test]
    fn the_ends_of_the_arc_lie_on_both_circles_and_the_mean_is_by_work() {
        let (bore, journal) = (1.5235e-3, 1.5e-3);
        let arc = |samples: &[(f64, f64)]| {
            let mut history = ContactHistory::new(1.0, 10, false);
            for &(penetration, work) in samples {
                let at = ContactSample { e: [0.0; 2], penetration, force: [0.0; 2], work, turn: 0.0 };
                history.samples.push(at);
            }
            mean_contact_arc(&history, [bore, journal])
        };
        let (shallow, deep) = (arc(&[(1e-6, 2.0)]), arc(&[(3e-6, 1.0)]));
        for (arc, penetration) in [(shallow, 1e-6), (deep, 3e-6)] {
            let e = bore - journal + penetration;
            let [x, y] = [bore * (0.5 * arc).cos() - e, bore * (0.5 * arc).sin()];
            assert!((x.hypot(y) - journal).abs() < 1e-15 && arc > 0.0, "{arc}");
        }
        let both = arc(&[(1e-6, 2.0), (3e-6, 1.0)]);
        assert!((both - (2.0 * shallow + deep) / 3.0).abs() < 1e-15);
        assert_eq!(arc(&[]), 0.0);
    }
}
