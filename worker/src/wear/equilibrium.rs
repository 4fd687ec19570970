//! Equilibrium eccentricity of a given force on a worn bore with an elastic foundation.
//!
//! Solves dU/de = F for the eccentricity e [m], with the force F [N] and the foundation's potential U(e) [J].
//! U is convex in e: V, half the integral of the squared gap, is a sum of squares of positive parts of
//! functions linear in e, and U grows with V at an increasing rate (the modulus dU/dV grows). So U(e) - F.e
//! has one minimum, and there dU/de = F. Newton's method finds it from nearby; along its direction the slope
//! of that function only increases, so that a step too long shows by the slope's sign and is cut back to a
//! lower value.
//!
//! Far off, the arc of a light contact is too narrow to predict the next one, and Newton's method creeps.
//! Then the equilibrium is followed from a load heavy enough for a wide arc down to the load wanted.
//!
//! # Source
//! Damped Newton method for a convex function: Nocedal, Wright (2006), Numerical Optimization, chapters 3 and
//! 6. Potential: `contact/foundation.rs`.

use crate::contact::{Foundation, FoundationLoad, FoundationWithJournal, Surface, equivalent_penetration};
use crate::plane::{dot, length};

/// Relative residual below which a force counts as carried.
pub const BALANCED: f64 = 1e-6;
/// Relative residual from which one more step of Newton's method, which converges quadratically, is the last one. What it leaves is not
/// evaluated: [`LEFT`] at most on bores with spikes between their points.
const NEARLY: f64 = 3e-4;
#[cfg(test)]
pub const LEFT: f64 = 2e-5;
/// Rounding of a gap, over the journal's radius. Its effect on the force exceeds BALANCED for forces with a
/// penetration below about 1e-12 m: means of an interval in which the journal struck both sides of its bore.
pub const RESOLVED: f64 = 4.0 * f64::EPSILON;
/// Least penetration that is solved for, in such roundings; a lighter force gets the same equilibrium.
const LEAST: f64 = 16.0;
/// Contact below this share of the force sought counts as too weak to linearise.
const WEAK: f64 = 0.2;
/// Evaluations of the contact from nearby, and at each load on the way down from a heavy one: of 120 000
/// forces on bores with spikes between their points, ten took more than 60 at one load, none more than 400.
pub const NEARBY: u32 = 12;
const EACH: u32 = 400;
/// Factor by which the load falls from one equilibrium to the next: the penetration of a round bore falls to
/// a quarter, and Newton's method follows without a step cut back.
const LET_OFF: f64 = 0.125;
/// Energy differences below this share of the energies are rounding.
const ROUNDING: f64 = 1e-15;

/// An elastic foundation with the surfaces as they are.
pub(super) trait ElasticSurfaces {
    /// Constants of the joint.
    fn surface(&self) -> &Surface;
    /// Gap function in the direction of the eccentricity `e` itself [m].
    fn gap_along(&self, e: [f64; 2]) -> f64;
    /// Load at the eccentricity `e` [m].
    fn load(&self, e: [f64; 2]) -> FoundationLoad;
}

impl ElasticSurfaces for Foundation {
    fn surface(&self) -> &Surface {
        &self.surface
    }
    #[inline(always)]
    fn gap_along(&self, e: [f64; 2]) -> f64 {
        self.arc.gap_along(e)
    }
    #[inline(always)]
    fn load(&self, e: [f64; 2]) -> FoundationLoad {
        Foundation::load(self, e)
    }
}

/// A foundation with a worn journal, and the angle of the journal's body from the bushing's [rad].
impl ElasticSurfaces for (FoundationWithJournal<'_>, f64) {
    fn surface(&self) -> &Surface {
        &self.0.surface
    }
    #[inline(always)]
    fn gap_along(&self, e: [f64; 2]) -> f64 {
        self.0.arc.gap_along(e, self.1)
    }
    #[inline(always)]
    fn load(&self, e: [f64; 2]) -> FoundationLoad {
        self.0.load_at(e, self.1)
    }
}

/// Eccentricity at which a force is in equilibrium with the foundation `(2,)` [m], and the evaluations of the contact that the search took.
pub type Equilibrium = ([f64; 2], u32);

/// The search found no equilibrium. Holds the remaining force over its bound, or the penetration over its
/// bound where the force is beyond the law's range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoEquilibrium(pub f64);

/// Eccentricity at which the elastic force of `law` on the bushing is `force` `(2,)`, not zero [N]; `start`
/// is an eccentricity nearby `(2,)` [m].
///
/// # Errors
/// [`NoEquilibrium`] if the force is beyond the law's range, or the bore has radii that are not finite.
#[inline(always)]
pub(super) fn equilibrium(
    law: &impl ElasticSurfaces,
    force: [f64; 2],
    start: [f64; 2],
) -> Result<Equilibrium, NoEquilibrium> {
    let surface = law.surface();
    let wanted = libm::hypot(force[0], force[1]);
    let direction = [force[0] / wanted, force[1] / wanted];
    let depth = equivalent_penetration(wanted, surface.stiffness);
    if depth > surface.deepest() {
        return Err(NoEquilibrium(depth / surface.deepest()));
    }
    let least = LEAST * RESOLVED * surface.journal_radius;
    let size = wanted.max(surface.stiffness * least * least.sqrt());
    let force = [size * direction[0], size * direction[1]];
    let mut spent = 0;
    if let Ok(found) = descend(law, force, start, NEARBY, &mut spent) {
        return Ok(found);
    }
    // At a penetration equal to the play in that direction, the arc of a round bore spans a third of it.
    let c = surface.clearance;
    let play = c - law.gap_along([c * direction[0], c * direction[1]]);
    let mut load = f64::max(1.0, surface.stiffness * play * play.sqrt() / size);
    let reach = play + equivalent_penetration(load * size, surface.stiffness);
    let mut e = [reach * direction[0], reach * direction[1]];
    loop {
        let found = descend(law, [load * force[0], load * force[1]], e, EACH, &mut spent)?;
        if load <= 1.0 {
            return Ok(found);
        }
        e = found.0;
        load = (LET_OFF * load).max(1.0);
    }
}

/// One point of the search.
#[derive(Clone, Copy)]
struct Point {
    e: [f64; 2],
    load: FoundationLoad,
    /// Gradient of U - F.e [N].
    miss: [f64; 2],
    /// U - F.e [J].
    height: f64,
}

impl Point {
    /// The point at eccentricity `e` [m] for the force `force` [N].
    #[inline(always)]
    fn new(law: &impl ElasticSurfaces, force: [f64; 2], e: [f64; 2]) -> Self {
        let load = law.load(e);
        let miss = [load.force[0] - force[0], load.force[1] - force[1]];
        Point { e, load, miss, height: load.energy - dot(force, e) }
    }
}

/// Minimum of U - F.e from `start` [m] by a damped Newton method, with at most `most` evaluations of the
/// contact, which are added to `spent`. From no contact, or almost none, the journal moves outward along the
/// load, by the penetration of that force on an unworn bore at a time.
#[inline(always)]
fn descend(
    law: &impl ElasticSurfaces,
    force: [f64; 2],
    start: [f64; 2],
    most: u32,
    spent: &mut u32,
) -> Result<Equilibrium, NoEquilibrium> {
    let wanted = length(force);
    let outward = equivalent_penetration(wanted, law.surface().stiffness) / wanted;
    let resolved = RESOLVED * law.surface().journal_radius;
    let last = *spent + most;
    let mut now = Point::new(law, force, start);
    *spent += 1;
    loop {
        let Point { e, load, miss, height } = now;
        let [a, b, d] = load.stiffness;
        if length(miss) <= f64::max(BALANCED * wanted, resolved * (a + d)) {
            return Ok((e, *spent));
        }
        let det = a * d - b * b;
        let step = if length(load.force) < WEAK * wanted || det <= 0.0 {
            [outward * force[0], outward * force[1]]
        } else {
            [-(d * miss[0] - b * miss[1]) / det, -(a * miss[1] - b * miss[0]) / det]
        };
        if length(miss) <= NEARLY * wanted && det > 0.0 {
            return Ok(([e[0] + step[0], e[1] + step[1]], *spent));
        }
        let slope = dot(miss, step);
        let noise = ROUNDING * (load.energy + dot(force, e).abs());
        let mut share = 1.0;
        now = loop {
            if *spent >= last {
                return Err(NoEquilibrium(length(miss) / wanted / BALANCED));
            }
            *spent += 1;
            let trial = Point::new(law, force, [e[0] + share * step[0], e[1] + share * step[1]]);
            let beyond = dot(trial.miss, step);
            if beyond <= 0.0 || trial.height <= height + noise {
                break trial;
            }
            // Zero of the slope, taken as linear.
            share *= (slope / (slope - beyond)).clamp(0.1, 0.7);
        };
    }
}
