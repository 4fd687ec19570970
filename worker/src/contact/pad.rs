//! Half a face of a slider on the flat face of its guide: an elastic foundation under a straight edge.
//!
//! With the overlap g(x) [m], which is linear between its values g_0 and g_1 at the ends of a pad of the length l [m], and the modulus
//! kappa [Pa] of the foundation times its width, the pressure per length is kappa g where g > 0. Its potential is
//!
//!   U = (kappa / 2) integral of g^2 over g > 0 = (kappa l / 6) (a^2 x + b (a + b)) [J],
//!
//! with the larger overlap a > 0 and the smaller one, b = max(g, 0), x = a / (a - min(g, 0)) being the share of the pad that touches. The
//! forces at the two ends that are equivalent to the pressure are dU/dg_0 and dU/dg_1 [N]: they are continuous with their first derivatives
//! but for the stiffness where the contact begins flat, and being a gradient they are conservative for every motion of the edge.
//!
//! The damping of Hunt and Crossley multiplies the pressure of the whole pad by one factor,
//!
//!   phi = max(0, 1 + D rho), rho = (dU/dt) / N = (U_0 g_0' + U_1 g_1') / (U_0 + U_1) [m/s],
//!
//! with the damping factor D [s/m] and the rate rho of the overlap where the pressure acts: the pad pushes and never pulls, and loses the power
//! (phi - 1) N rho >= 0. Flat on its face, N = kappa l g, and an impact has the restitution of the equation in `surface.rs`.
//!
//! # Source
//! Winkler foundation: Johnson (1985), Contact Mechanics, chapter 4. Damping: Hunt, Crossley (1975), J. Appl. Mech. 42, 440-445. Corners of a
//! slider as separate contacts: Flores, Ambrosio, Claro, Lankarani (2008), J. Comput. Nonlinear Dyn. 3, 011007. The pad's potential is derived here.
//!
//! # A guide at one instant
//! What a guide with clearance does at one instant: forces on its faces, overlaps of its pads, energy. `mechanism/guide.rs` has its equations.

use crate::lanes::{Real, in_lane};

/// Forces at the ends of a pad, with their derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PadForce<R = f64> {
    /// Force at each end, at least zero `(2,)` [N].
    pub force: [R; 2],
    /// Derivatives of these forces to the overlaps of both ends `(2, 2)` [N/m].
    pub to_overlap: [[R; 2]; 2],
    /// Derivatives to the rates of the overlaps `(2, 2)` [N s/m].
    pub to_rate: [[R; 2]; 2],
    /// Potential U [J].
    pub stored: R,
    /// Power lost to the damping [W].
    pub lost: R,
}

/// Potential U [J] of a pad of the stiffness `unit` = kappa l / 6 [N/m] whose ends overlap by `g` [m], and its first and second derivatives to
/// them `(2,)` [N], `(2, 2)` [N/m]; zero where neither end touches.
#[inline(always)]
pub(crate) fn foundation<R: Real>(unit: R, g: [R; 2]) -> (R, [R; 2], [[R; 2]; 2]) {
    let (zero, one) = (unit.zero(), unit.like(1.0));
    let (a, b) = (g[0].larger(g[1]), g[0].smaller(g[1]));
    let touches = zero.below(a);
    let safe = R::select(touches, a, one);
    let unit = R::select(touches, unit, zero);
    let beyond = b.smaller(zero);
    let inside = R::select(touches, b.larger(zero), zero);
    let x = safe / (safe - beyond);
    let stored = unit * (safe * safe * x + inside * (safe + inside));
    // To the larger overlap and to the smaller one.
    let large = unit * (safe * x * (x.like(3.0) - x) + inside);
    let small = unit * (safe * x * x + inside * 2.0);
    let both = unit * x * x * (x * -2.0 + 3.0);
    let (large_2, small_2) = (unit * x * ((x - 3.0) * x * 2.0 + 6.0), unit * x * x * x * 2.0);
    let first_is_large = g[1].below(g[0]);
    let pick = |large: R, small: R| {
        [R::select(first_is_large, large, small), R::select(first_is_large, small, large)]
    };
    let own = pick(large_2, small_2);
    (stored, pick(large, small), [[own[0], both], [both, own[1]]])
}

/// Forces of a pad of the stiffness `unit` = kappa l / 6 [N/m] and damping factor `damping` [s/m], whose ends overlap by `g` [m], growing
/// at `rate` [m/s]; zero where neither end touches.
#[inline(always)]
pub(crate) fn pad_force<R: Real>(unit: R, damping: R, g: [R; 2], rate: [R; 2]) -> PadForce<R> {
    let (zero, one) = (unit.zero(), unit.like(1.0));
    let touches = zero.below(g[0].larger(g[1]));
    let (stored, u, second) = foundation(unit, g);
    let normal = u[0] + u[1];
    let per_normal = one / R::select(touches, normal, one);
    let share = [u[0] * per_normal, u[1] * per_normal];
    let rho = share[0] * rate[0] + share[1] * rate[1];
    let factor = damping * rho + 1.0;
    let pushes = zero.below(factor);
    let factor = R::select(pushes, factor, zero);
    let damping = R::select(pushes, damping, zero);
    let off = [rate[0] - rho, rate[1] - rho];
    let mut out = PadForce {
        force: [u[0] * factor, u[1] * factor],
        to_overlap: [[zero; 2]; 2],
        to_rate: [[zero; 2]; 2],
        stored,
        lost: normal * rho * (factor - 1.0),
    };
    for j in 0..2 {
        // N drho/dg_j.
        let turned = second[0][j] * off[0] + second[1][j] * off[1];
        for i in 0..2 {
            out.to_overlap[i][j] = second[i][j] * factor + share[i] * damping * turned;
            out.to_rate[i][j] = u[i] * damping * share[j];
        }
    }
    out
}

/// Pads of a guide: halves of the two faces of its slider.
pub const PADS: usize = 4;

/// What a guide does at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GuideReaction<R = f64> {
    /// Normal force on each face of the guide, left and right of its axis `(2,)` [N].
    pub normal: [R; 2],
    /// Friction on the slider along the axis at each face `(2,)` [N].
    pub friction: [R; 2],
    /// Largest overlap of each pad, negative in free flight `(4,)` [m].
    pub penetration: [R; PADS],
    /// Rate of that overlap `(4,)` [m/s].
    pub approach: [R; PADS],
    /// Length by which the slider stands out of the guide, negative inside [m].
    pub beyond: R,
    /// Moment of the normal forces on each face about the slider's middle, from their distances along the slider; zero unless the guide
    /// wears `(2,)` [N m].
    pub moment: [R; 2],
    /// Power of sliding at each face, the sum of P |ds/dt|; zero unless the guide wears `(2,)` [W].
    pub rubbing: [R; 2],
    /// Position of the slider's middle along the guide; zero unless the guide wears [m].
    pub position: R,
    /// Energy of the foundation [J].
    pub stored: R,
    /// Power lost to friction and damping [W].
    pub lost: R,
}

in_lane!(GuideReaction {
    normal,
    friction,
    penetration,
    approach,
    beyond,
    moment,
    rubbing,
    position,
    stored,
    lost
});

impl GuideReaction {
    /// Sum of the sizes of the forces on the two faces [N].
    pub(crate) fn force(&self) -> f64 {
        (0..2).map(|face| libm::hypot(self.normal[face], self.friction[face])).sum()
    }
}

impl<R: Real> GuideReaction<R> {
    /// No force; `like` sets the number of lanes.
    #[inline(always)]
    pub(crate) fn none(like: R) -> Self {
        let zero = like.zero();
        GuideReaction {
            normal: [zero; 2],
            friction: [zero; 2],
            penetration: [zero; PADS],
            approach: [zero; PADS],
            beyond: zero,
            moment: [zero; 2],
            rubbing: [zero; 2],
            position: zero,
            stored: zero,
            lost: zero,
        }
    }

    /// Largest overlap of all pads [m].
    #[inline(always)]
    pub(crate) fn deepest(&self) -> R {
        let [a, b, c, d] = self.penetration;
        a.larger(b).larger(c.larger(d))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: f64 = 3e6;

    /// Potential of the pad by the midpoint rule.
    fn potential([a, b]: [f64; 2]) -> f64 {
        const CELLS: i32 = 100_000;
        let g = |k: i32| a + (b - a) * (f64::from(k) + 0.5) / f64::from(CELLS);
        3.0 * UNIT * (0..CELLS).map(|k| g(k).max(0.0).powi(2)).sum::<f64>() / f64::from(CELLS)
    }

    #[test]
    fn the_forces_are_the_gradient_of_the_integral_over_the_pad() {
        for g in [[2e-6, 1e-6], [1e-6, 4e-6], [3e-6, -5e-6], [-8e-6, 2e-7], [1e-6, 1e-6], [-1e-6, -2e-6]] {
            let at = |g| pad_force(UNIT, 0.0, g, [0.0; 2]);
            let exact = at(g);
            let whole = potential(g);
            assert!((exact.stored - whole).abs() <= 1e-6 * whole, "{g:?}: {} {whole}", exact.stored);
            for j in 0..2 {
                let h = 1e-10;
                let moved = |h: f64| {
                    let mut g = g;
                    g[j] += h;
                    at(g)
                };
                let (low, high) = (moved(-h), moved(h));
                let slope = (high.stored - low.stored) / (2.0 * h);
                assert!((exact.force[j] - slope).abs() <= 1e-6 * UNIT * 8e-6, "{g:?} {j}");
                for i in 0..2 {
                    let slope = (high.force[i] - low.force[i]) / (2.0 * h);
                    assert!((exact.to_overlap[i][j] - slope).abs() <= 1e-4 * UNIT, "{g:?} {i} {j}");
                }
            }
        }
    }

    #[test]
    fn damping_has_exact_derivatives_never_pulls_and_never_gives_energy() {
        for g in [[2e-6, 1e-6], [3e-6, -5e-6], [-8e-6, 2e-7]] {
            for rate in [[0.1, 0.3], [-0.2, 0.05], [-0.4, -0.1], [-2.0, -1.5]] {
                let at = |g, rate| pad_force(UNIT, 1.7, g, rate);
                let exact = at(g, rate);
                assert!(exact.lost >= 0.0 && exact.force[0] + exact.force[1] >= 0.0);
                // The power of the two forces is that of the foundation and of the damping.
                let h = 1e-12;
                let along = |t: f64| potential_at([g[0] + t * rate[0], g[1] + t * rate[1]]);
                let stored = (along(h) - along(-h)) / (2.0 * h);
                let power = exact.force[0] * rate[0] + exact.force[1] * rate[1];
                assert!((power - stored - exact.lost).abs() < 1e-4 * (UNIT * 3e-6), "{g:?} {rate:?}");
                for j in 0..2 {
                    let shift = |x: [f64; 2], h: f64| {
                        let mut x = x;
                        x[j] += h;
                        x
                    };
                    for i in 0..2 {
                        let h = 1e-10;
                        let (low, high) = (at(shift(g, -h), rate), at(shift(g, h), rate));
                        let slope = (high.force[i] - low.force[i]) / (2.0 * h);
                        assert!(
                            (exact.to_overlap[i][j] - slope).abs() <= 1e-3 * UNIT,
                            "{g:?} {rate:?} {i} {j}"
                        );
                        let h = 1e-6;
                        let (low, high) = (at(g, shift(rate, -h)), at(g, shift(rate, h)));
                        let slope = (high.force[i] - low.force[i]) / (2.0 * h);
                        assert!(
                            (exact.to_rate[i][j] - slope).abs() <= 1e-6 * UNIT * 3e-6,
                            "{g:?} {rate:?} {i} {j}"
                        );
                    }
                }
            }
        }
    }

    fn potential_at(g: [f64; 2]) -> f64 {
        pad_force(UNIT, 0.0, g, [0.0; 2]).stored
    }
}
