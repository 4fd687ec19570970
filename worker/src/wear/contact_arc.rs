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
//! # Source
//! Two intersecting circles; the mean is chosen here.

use super::interval::ContactHistory;
use std::f64::consts::PI;

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
