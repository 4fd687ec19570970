//! Archard's law over one cycle: how fast each control point of a bore wears, given the cycle's contact history
//! and the profile as it is now.
//!
//! The history fixes forces and sliding; the contact is found again on the present profile, because the spot
//! that wears unloads itself. That feedback is what makes the wear step stiff.

use super::conformal::{Unbalanced, foundation_share};
use super::{ContactHistory, ContactSample};
use crate::bore::Profile;
use crate::contact::{Contact, Foundation};
use std::f64::consts::TAU;

/// Table intervals per control point for the search of the arc's ends: 1.25 deg at 36 control points; a linear
/// interpolation there misplaces the ends of a 20 deg arc by 0.2 %.
const SUBDIVISION: usize = 8;

/// Width over which a control point enters the arc [rad]: half a degree, below the distance the arc's end moves
/// between two samples, so that the wear rate is a smooth function of the profile.
const ENTRY: f64 = 0.5 * TAU / 360.0;

/// Intervals of the bore at which the foundation is found again: 1.25 deg at 36 control points. The pressure is
/// scaled to the force it carries, so its quadrature need not be that of the force: the volume test
/// (`foundation_wears_the_volume_its_pressure_asks_for`) finds it within 1e-4, and within 1.4e-5 with twice as many.
const CONFORMAL_INTERVALS: usize = 288;

/// Wear rate of one joint under a frozen contact history.
#[derive(Debug, Clone)]
pub struct WearRate {
    /// Wear coefficient K_H [1/Pa].
    coefficient: f64,
    /// Width L [m].
    width: f64,
    /// Journal radius R1 [m].
    journal_radius: f64,
    profile: Profile,
    /// R at equal angles `(SUBDIVISION * points,)` [m].
    radius: Vec<f64>,
    /// Unit vectors at those angles [1].
    direction: Vec<[f64; 2]>,
    samples: Vec<ContactSample>,
    foundation: Option<Foundation>,
    /// Evaluations of the foundation so far.
    evaluations: u64,
}

impl WearRate {
    /// Rate of a joint with wear coefficient `coefficient` [1/Pa], width `width` [m] and this contact law.
    pub fn new(coefficient: f64, width: f64, contact: &Contact, profile: &Profile) -> Self {
        let n = SUBDIVISION * profile.points();
        WearRate {
            coefficient,
            width,
            journal_radius: contact.surface().journal_radius,
            profile: profile.clone(),
            radius: vec![0.0; n],
            direction: (0..n)
                .map(|k| {
                    let (s, c) = libm::sincos(TAU * k as f64 / n as f64);
                    [c, s]
                })
                .collect(),
            samples: Vec::new(),
            evaluations: 0,
            foundation: match contact {
                Contact::LocalHertz(_) => None,
                Contact::Foundation(law) => {
                    Some(Foundation::with_intervals(*law.surface(), profile.points(), CONFORMAL_INTERVALS))
                }
            },
        }
    }

    /// Takes over the history of the cycle just simulated.
    pub fn freeze(&mut self, history: &ContactHistory) {
        self.samples.clear();
        self.samples.extend_from_slice(history.samples());
        if let Some(law) = &mut self.foundation {
            law.profile_changed(&self.profile);
            self.samples.iter_mut().for_each(|s| s.penetration = law.arc().gap_along(s.e));
        }
    }

    /// Evaluations of the foundation that finding the contact again has taken so far; none under the local law.
    pub fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// Wear per cycle at every control point, for a bore worn to `depth`: `(points,)` [m].
    ///
    /// # Errors
    /// [`Unbalanced`] if the frozen force finds no rest on that bore.
    pub fn rate(&mut self, depth: &[f64], rate: &mut [f64]) -> Result<(), Unbalanced> {
        rate.fill(0.0);
        self.profile.set_depth(depth);
        if let Some(law) = &mut self.foundation {
            law.profile_changed(&self.profile);
            for sample in &mut self.samples {
                self.evaluations += u64::from(foundation_share(law, sample, rate)?);
            }
            let cell = TAU / rate.len() as f64 * self.profile.initial_radius() * self.width;
            rate.iter_mut().for_each(|r| *r *= self.coefficient / cell);
        } else {
            self.profile.tabulate(&mut self.radius);
            for sample in &self.samples {
                self.arc_share(sample, rate);
            }
            rate.iter_mut().for_each(|r| *r *= self.coefficient / self.width);
        }
        Ok(())
    }

    /// Adds one sample's share under the local law, F S / |AB|, to every control point inside the contact arc.
    fn arc_share(&self, sample: &ContactSample, rate: &mut [f64]) {
        let psi = libm::atan2(sample.e[1], sample.e[0]);
        let (before, after) = self.arc(psi, sample.penetration);
        // Length of the arc along the worn bore, by Simpson's rule over its angle.
        let radius = |angle: f64| self.profile.at(within_turn(angle)).r;
        let mean = (radius(psi - before) + 4.0 * radius(psi) + radius(psi + after)) / 6.0;
        let share = sample.work / (mean * (before + after));
        let n = rate.len() as i64;
        let spacing = TAU / n as f64;
        let first = ((psi - before - ENTRY) / spacing).ceil() as i64;
        let last = ((psi + after + ENTRY) / spacing).floor() as i64;
        for i in first..=last.min(first + n - 1) {
            let at = i as f64 * spacing - psi;
            let inside =
                (0.5 + (after - at) / ENTRY).clamp(0.0, 1.0) * (0.5 + (at + before) / ENTRY).clamp(0.0, 1.0);
            rate[i.rem_euclid(n) as usize] += share * inside;
        }
    }

    /// Angles from the direction psi of the eccentricity to the two ends of the contact arc AB [rad].
    ///
    /// The journal's circle, seen from the bushing's centre at angle phi from psi, lies at
    /// e cos(phi) + sqrt(R1^2 - e^2 sin^2(phi)), e = delta + R(psi) - R1 (law of cosines); the arc ends where
    /// that is for the first time no longer beyond the profile.
    ///
    /// A place inside the arc that wears until the circle only grazes it ends the arc there from one instant to the
    /// next, and what lies behind it counts no more; a second patch behind the end is taken in again where the gap
    /// between them closes. There the end, and with it the wear rate, is not a continuous function of the profile.
    pub fn arc(&self, psi: f64, penetration: f64) -> (f64, f64) {
        let at = self.profile.at(psi);
        let e = penetration + at.r - self.journal_radius;
        let (sin, cos) = libm::sincos(psi);
        let n = self.radius.len();
        let per_radian = n as f64 / TAU;
        let mut position = psi * per_radian;
        if position < 0.0 {
            position += n as f64;
        }
        let below = position as usize;
        let lead = (position - below as f64) / per_radian;
        let below = below % n;
        let beyond = |k: usize| {
            let u = self.direction[k];
            let c = u[0] * cos + u[1] * sin;
            let s = u[1] * cos - u[0] * sin;
            // sqrt(R1^2 - e^2 s^2) to second order: the next term is (e/R1)^4 / 8, below 1e-11 m here.
            self.journal_radius + e * c - e * e * s * s / (2.0 * self.journal_radius) - self.radius[k]
        };
        let spacing = 1.0 / per_radian;
        // Towards smaller angles the first table angle is `below`, at distance `lead`; the slope changes sign.
        let walk = |first: usize, distance: f64, up: bool, slope: f64| {
            let mut k = first;
            let mut phi = distance;
            let mut p = beyond(k);
            if p <= 0.0 {
                return first_end(penetration, slope, phi, p);
            }
            for _ in 0..n / 2 {
                k = if up {
                    if k + 1 == n { 0 } else { k + 1 }
                } else if k == 0 {
                    n - 1
                } else {
                    k - 1
                };
                let next = beyond(k);
                if next <= 0.0 {
                    return phi + spacing * p / (p - next);
                }
                p = next;
                phi += spacing;
            }
            phi
        };
        let above = if below + 1 == n { 0 } else { below + 1 };
        (walk(below, lead, false, at.d1), walk(above, spacing - lead, true, -at.d1))
    }
}

/// The same direction as an angle in [0, 2 pi) [rad].
fn within_turn(angle: f64) -> f64 {
    if angle < 0.0 {
        angle + TAU
    } else if angle >= TAU {
        angle - TAU
    } else {
        angle
    }
}

/// End of the arc within the first table interval: positive root of delta + slope x + q x^2, where q makes the
/// parabola pass through (phi, p), p <= 0 < delta.
fn first_end(delta: f64, slope: f64, phi: f64, p: f64) -> f64 {
    if delta <= 0.0 || phi <= 0.0 {
        return phi.max(f64::MIN_POSITIVE);
    }
    let q = (p - delta - slope * phi) / (phi * phi);
    let root = (slope * slope - 4.0 * q * delta).max(0.0).sqrt();
    // q x^2 + slope x + delta = 0, the root that stays finite as q -> 0.
    let x = if slope >= 0.0 { (slope + root) / (-2.0 * q) } else { 2.0 * delta / (root - slope) };
    if x.is_finite() && x > 0.0 { x.min(phi) } else { phi }
}
