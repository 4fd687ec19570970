//! A slider with clearance in a straight guide: force of the four halves of its two faces on the flat faces of the guide.
//!
//! The slider is a rectangle on body a, the guide a pair of parallel faces on body b at the distance H = h/2 + c from its axis, with the height h
//! of the slider and the clearance c on each side [m]. Each half face of the slider is a pad (`contact/pad.rs`) between a corner and the middle
//! of the face. With the arm a from the reference point of body a to such an end, d = x_a + a - x_b, the outward normal n of a face and the
//! direction t of the axis, turned with body b, the end overlaps by g = n . d - (n . p + H) and slides at ds/dt, s = t . (d - p), p being the
//! guide's point in body b. With the gradients G = (n, a x n, -n, -d x n) and T = (t, a x t, -t, -d x t) to the six coordinates (x, y, angle) of both
//! bodies, the force P of a pad at its end and its friction P mu tanh((ds/dt) / v_0), the generalised force is
//!
//!   Q = - sum over the ends of P (G + mu tanh(..) T) [N, N m].
//!
//! Both bodies feel the contact at the same point, so that momentum is kept. One corner, two corners of one face, two opposite corners, and the
//! whole face are the same equations. A pad keeps the damping factor of its impact, at most that of
//! the other half of its face where that touches. All derivatives are exact.
//!
//! The modulus of the foundation is that for which the whole face, length l and width w, has the stiffness of a flat punch under even pressure,
//! K = sqrt(l w) / (0.95 (s_a + s_b)), s = (1 - nu^2) / E. The number 0.95 holds for a square; the exact one falls to 0.92 at l = 2 w and 0.71 at 10 w.
//!
//! Valid as long as the slider is between the ends of its guide, and for overlaps up to a twentieth of its height.
//!
//! # Source
//! Contact situations and corners: Flores, Ambrosio, Claro, Lankarani (2008), J. Comput. Nonlinear Dyn. 3, 011007. Stiffness of a flat
//! contact: Timoshenko, Goodier (1970), Theory of Elasticity, section 139. Friction as in `contact/surface.rs`.

use super::frame::{End, Frame};
use super::load::LoadForce;
use crate::contact::{GuideReaction, PADS, PadForce, Restitution, coulomb, initial_damping, pad_force};
use crate::lanes::{Real, lanewise};
use crate::plane::{cross, dot, left, length, scaled};
use common::scene::GuideClearance;

/// Slider and guide with the constants of their contact.
#[derive(Debug, Clone, PartialEq)]
pub struct Guide<R = f64> {
    /// Index into the scene's joints.
    pub scene_joint: usize,
    /// Centre of the slider on its body, point of the guide on its body.
    pub ends: [End<R>; 2],
    /// Direction of the guide in its body's frame, and of the slider's length in that of its body `(2,)` each [1].
    pub(super) axis: [R; 2],
    pub(super) along: [R; 2],
    /// Half of the slider's length and of its height [m].
    pub(super) half_length: R,
    pub(super) half_height: R,
    /// Distance of each face of the guide from its axis [m].
    pub(super) half_gap: R,
    /// Ends of the guide along its axis, from its point `(2,)` [m].
    pub(super) reach: [R; 2],
    /// kappa l / 6 of a pad [N/m].
    pub(super) unit: R,
    /// Damping factor in effect of each pad `(4,)` [s/m].
    pub damping: [R; PADS],
    /// How it follows from the speed of approach; `None` if it is constant.
    pub restitution: Option<Restitution<R>>,
    /// Coefficient of friction mu [1] and inverse of its regularisation speed v_0 [s/m].
    pub(super) friction: R,
    pub(super) per_friction_speed: R,
}

lanewise!(Guide {
    scene_joint,
    ends,
    axis,
    along,
    half_length,
    half_height,
    half_gap,
    reach,
    unit,
    damping,
    restitution,
    friction,
    per_friction_speed
});

impl Guide {
    /// Joint number `scene_joint` of a checked scene, with its ends on the frames of an island.
    pub(crate) fn new(scene_joint: usize, guide: &GuideClearance, ends: [End; 2]) -> Self {
        let direction = |angle: f64| {
            let (sin, cos) = libm::sincos(angle);
            [cos, sin]
        };
        let compliance =
            |m: &common::scene::Material| (1.0 - m.poisson_ratio * m.poisson_ratio) / m.elastic_modulus;
        let soft = compliance(&guide.slider_material) + compliance(&guide.guide_material);
        let stiffness = (guide.length * guide.width).sqrt() / (0.95 * soft);
        let (damping, restitution) = initial_damping(&guide.contact_damping);
        Guide {
            scene_joint,
            ends,
            axis: direction(guide.axis),
            along: direction(guide.axis - guide.angle),
            half_length: 0.5 * guide.length,
            half_height: 0.5 * guide.height,
            half_gap: 0.5 * guide.height + guide.clearance,
            reach: guide.reach,
            // Half of the stiffness of the whole face, which is kappa times the length of a pad.
            unit: stiffness / 12.0,
            damping: [damping; PADS],
            restitution,
            friction: guide.friction,
            per_friction_speed: 1.0 / guide.friction_speed,
        }
    }

    /// Stiffness of a whole face [N/m].
    pub(crate) fn stiffness(&self) -> f64 {
        12.0 * self.unit
    }

    /// Distance of the farthest point of contact from the centre of its body, on the bodies of slider and guide `(2,)` [m].
    pub(crate) fn arms(&self) -> [f64; 2] {
        let farthest = self.reach[0].abs().max(self.reach[1].abs());
        [
            length(self.ends[0].arm) + libm::hypot(self.half_length, self.half_height),
            length(self.ends[1].arm) + libm::hypot(farthest, self.half_gap),
        ]
    }

    /// Clearance on each side [m].
    pub(crate) fn clearance(&self) -> f64 {
        self.half_gap - self.half_height
    }
}

/// A guide as the forces of an island need it: with flat faces, in lanes one per lane, or with worn ones.
pub(super) trait Guiding<R: Real> {
    /// Ends on the bodies of slider and guide.
    fn ends(&self) -> [End<R>; 2];

    /// Generalised force on the bodies in `frames`, with `JACOBIAN` also its derivatives, and what the guide does.
    fn force<const JACOBIAN: bool>(&self, frames: &[Frame<R>]) -> (LoadForce<R>, GuideReaction<R>);

    /// Size of the generalised impulse `(6,)` [N s, N m s] of the pads that touch with the bodies in `frames` and did not where the guide
    /// did `before`, `h` [s] earlier: the time since they began to touch, at most g / (dg/dt), times half the present force.
    fn begun(&self, frames: &[Frame<R>], before: &GuideReaction<R>, h: R) -> [R; 6];
}

/// A face of the slider and the wall of its guide, in global axes.
pub(super) struct GuideFace<R> {
    pub(super) face: usize,
    /// Outward normal n of the slider's face and axis t of the guide.
    pub(super) n: [R; 2],
    pub(super) t: [R; 2],
    /// Distances of the wall along n, and of the guide's point along t, from the guide's body [m].
    wall: R,
    pub(super) base: R,
    /// Way from the middle of the slider to its face, in the axes of its body [m].
    across: [R; 2],
}

/// One end of a pad at one instant.
#[derive(Clone, Copy)]
pub(super) struct PadEnd<R> {
    /// Arm on the slider's body and vector from the reference point of the guide's body, in global axes [m].
    pub(super) a: [R; 2],
    pub(super) d: [R; 2],
    /// Overlap [m], its rate and the sliding speed [m/s].
    pub(super) overlap: R,
    pub(super) rate: R,
    pub(super) sliding: R,
}

/// Overlap and its rate at the deeper end of a pad.
#[inline(always)]
fn deeper<R: Real>([a, b]: &[PadEnd<R>; 2]) -> [R; 2] {
    let first = b.overlap.below(a.overlap);
    [R::select(first, a.overlap, b.overlap), R::select(first, a.rate, b.rate)]
}

/// Gradient of u . d to the six coordinates, for a direction `u` of the guide's body in global axes.
#[inline(always)]
pub(super) fn gradient<R: Real>(u: [R; 2], a: [R; 2], d: [R; 2]) -> [R; 6] {
    [u[0], u[1], cross(a, u), -u[0], -u[1], -cross(d, u)]
}

/// Second derivative of u . d to the six coordinates times their rates: the gradient of its rate.
#[inline(always)]
pub(super) fn turning<R: Real>(u: [R; 2], at: &PadEnd<R>, [fa, fb]: [&Frame<R>; 2]) -> [R; 6] {
    let (su, along) = (left(u), dot(u, at.a));
    let v = [fa.v[0] - fb.v[0], fa.v[1] - fb.v[1]];
    [
        su[0] * fb.omega,
        su[1] * fb.omega,
        along * (fb.omega - fa.omega),
        -su[0] * fb.omega,
        -su[1] * fb.omega,
        dot(su, v) + along * fa.omega - dot(u, at.d) * fb.omega,
    ]
}

/// Adds `factor` times the second derivatives of u . d to `k`.
#[inline(always)]
pub(super) fn add_second<R: Real>(k: &mut [[R; 6]; 6], factor: R, u: [R; 2], at: &PadEnd<R>) {
    let su = left(u);
    let along = factor * dot(u, at.a);
    for r in 0..2 {
        let across = factor * su[r];
        k[r][5] += across;
        k[5][r] += across;
        k[3 + r][5] -= across;
        k[5][3 + r] -= across;
    }
    k[2][2] -= along;
    k[2][5] += along;
    k[5][2] += along;
    k[5][5] -= factor * dot(u, at.d);
}

impl<R: Real> Guide<R> {
    /// Largest overlap in the range of the model: a twentieth of the slider's height [m].
    #[inline(always)]
    pub(crate) fn deepest(&self) -> R {
        self.half_height * 0.1
    }

    /// Sets the damping factors of the pads that do not touch from their speeds of approach, at most that of the other half of the face where it
    /// touches; no effect for constant ones.
    #[inline(always)]
    pub(crate) fn follow_approach(&mut self, now: &GuideReaction<R>) {
        if let Some(restitution) = self.restitution {
            let zero = self.half_gap.zero();
            let present = self.damping;
            for pad in 0..PADS {
                let next = restitution.damping(now.approach[pad]);
                // The halves of a face are the pads 0 and 1, 2 and 3.
                let other = pad ^ 1;
                let shared =
                    R::select(zero.below(now.penetration[other]), next.smaller(present[other]), next);
                self.damping[pad] = R::select(zero.below(now.penetration[pad]), present[pad], shared);
            }
        }
    }

    /// A face: 0 to the left of the axis `t` in global axes, 1 to the right.
    #[inline(always)]
    pub(super) fn side(&self, face: usize, t: [R; 2]) -> GuideFace<R> {
        let (side, at) = (self.unit.like(if face == 0 { 1.0 } else { -1.0 }), self.ends[1].arm);
        GuideFace {
            face,
            n: scaled(left(t), side),
            t,
            wall: dot(left(self.axis), at) * side + self.half_gap,
            base: dot(self.axis, at),
            across: scaled(left(self.along), side * self.half_height),
        }
    }

    /// The point of a face that lies `ahead` of its middle [m].
    #[inline(always)]
    pub(super) fn point(&self, face: &GuideFace<R>, ahead: R, [fa, fb]: [&Frame<R>; 2]) -> PadEnd<R> {
        let GuideFace { n, t, wall, across, .. } = *face;
        let mut arm = self.ends[0].arm;
        for k in 0..2 {
            arm[k] = arm[k] + across[k] + self.along[k] * ahead;
        }
        let a = fa.turn(arm);
        let d = [fa.x[0] + a[0] - fb.x[0], fa.x[1] + a[1] - fb.x[1]];
        // Velocity of the point against the guide's body.
        let w = [
            fa.v[0] - fa.omega * a[1] - fb.v[0] + fb.omega * d[1],
            fa.v[1] + fa.omega * a[0] - fb.v[1] - fb.omega * d[0],
        ];
        PadEnd { a, d, overlap: dot(n, d) - wall, rate: dot(n, w), sliding: dot(t, w) }
    }

    /// Outward normal of a face in global axes, where the axis is `t`, and its corner, middle and corner.
    #[inline(always)]
    pub(super) fn face(&self, face: usize, t: [R; 2], bodies: [&Frame<R>; 2]) -> ([R; 2], [PadEnd<R>; 3]) {
        let (face, half) = (self.side(face, t), self.half_length);
        let (corner, middle) =
            (self.point(&face, half * -1.0, bodies), self.point(&face, half * 0.0, bodies));
        (face.n, [corner, middle, self.point(&face, half, bodies)])
    }

    /// Force of a pad between these ends.
    #[inline(always)]
    fn pressed(&self, pad: usize, ends: &[PadEnd<R>; 2]) -> PadForce<R> {
        let (overlap, rate) = ([ends[0].overlap, ends[1].overlap], [ends[0].rate, ends[1].rate]);
        pad_force(self.unit, self.damping[pad], overlap, rate)
    }

    /// Adds the forces of a pad at its ends, with friction, normal `n` and axis `t` in global axes.
    #[allow(clippy::too_many_arguments)]
    #[inline(always)]
    fn add_pad<const JACOBIAN: bool>(
        &self,
        load: &mut LoadForce<R>,
        done: &mut GuideReaction<R>,
        face: usize,
        pressed: &PadForce<R>,
        ends: &[PadEnd<R>; 2],
        [n, t]: [[R; 2]; 2],
        bodies: [&Frame<R>; 2],
    ) {
        let to_overlap = [gradient(n, ends[0].a, ends[0].d), gradient(n, ends[1].a, ends[1].d)];
        for i in 0..2 {
            let (end, p) = (&ends[i], pressed.force[i]);
            let (ratio, slope) = coulomb(self.friction, self.per_friction_speed, end.sliding);
            done.normal[face] += p;
            done.friction[face] = done.friction[face].minus_product(p, ratio);
            done.lost = done.lost.plus_product(p * ratio, end.sliding);
            let u = [n[0].plus_product(ratio, t[0]), n[1].plus_product(ratio, t[1])];
            let acting = gradient(u, end.a, end.d);
            for r in 0..6 {
                load.f[r] = load.f[r].minus_product(p, acting[r]);
            }
            if JACOBIAN {
                let (mut to_q, mut to_v) = ([p.zero(); 6], [p.zero(); 6]);
                for j in 0..2 {
                    let turned = turning(n, &ends[j], bodies);
                    for c in 0..6 {
                        to_q[c] +=
                            to_overlap[j][c] * pressed.to_overlap[i][j] + turned[c] * pressed.to_rate[i][j];
                        to_v[c] += to_overlap[j][c] * pressed.to_rate[i][j];
                    }
                }
                let (along, slid) = (gradient(t, end.a, end.d), turning(t, end, bodies));
                let rubbed = p * slope;
                for r in 0..6 {
                    for c in 0..6 {
                        load.k[r][c] -= acting[r] * to_q[c] + rubbed * along[r] * slid[c];
                        load.d[r][c] -= acting[r] * to_v[c] + rubbed * along[r] * along[c];
                    }
                }
                add_second(&mut load.k, -p, u, end);
            }
        }
    }
}

impl<R: Real> Guiding<R> for Guide<R> {
    #[inline(always)]
    fn ends(&self) -> [End<R>; 2] {
        self.ends
    }

    #[inline(always)]
    fn force<const JACOBIAN: bool>(&self, frames: &[Frame<R>]) -> (LoadForce<R>, GuideReaction<R>) {
        let [i, j] = &self.ends;
        let (fa, fb) = (&frames[i.frame], &frames[j.frame]);
        let zero = self.unit.zero();
        let (mut load, mut done) = (LoadForce::none([i.frame, j.frame], zero), GuideReaction::none(zero));
        let t = fb.turn(self.axis);
        let base = dot(self.axis, j.arm);
        done.beyond = self.unit.like(f64::NEG_INFINITY);
        for face in 0..2 {
            let (n, at) = self.face(face, t, [fa, fb]);
            for point in 0..3 {
                let s = dot(t, at[point].d) - base;
                done.beyond = done.beyond.larger(s - self.reach[1]).larger(self.reach[0] - s);
            }
            for half in 0..2 {
                let (pad, ends) = (2 * face + half, [at[half], at[half + 1]]);
                [done.penetration[pad], done.approach[pad]] = deeper(&ends);
                if !R::any(zero.below(done.penetration[pad])) {
                    continue;
                }
                let pressed = self.pressed(pad, &ends);
                done.stored += pressed.stored;
                done.lost += pressed.lost;
                self.add_pad::<JACOBIAN>(&mut load, &mut done, face, &pressed, &ends, [n, t], [fa, fb]);
            }
        }
        (load, done)
    }

    #[inline(always)]
    fn begun(&self, frames: &[Frame<R>], before: &GuideReaction<R>, h: R) -> [R; 6] {
        let (fa, fb) = (&frames[self.ends[0].frame], &frames[self.ends[1].frame]);
        let zero = h.zero();
        let (t, mut impulse) = (fb.turn(self.axis), [zero; 6]);
        for face in 0..2 {
            let (n, at) = self.face(face, t, [fa, fb]);
            for half in 0..2 {
                let (pad, ends) = (2 * face + half, [at[half], at[half + 1]]);
                let [overlap, rate] = deeper(&ends);
                let begins =
                    R::both(before.penetration[pad].below(h.like(f64::MIN_POSITIVE)), zero.below(overlap));
                if !R::any(begins) {
                    continue;
                }
                // The smaller of h and g / rate, of h alone where it does not approach.
                let since = R::select((rate * h).below(overlap), h, overlap / rate);
                let half_time = R::select(begins, since * 0.5, zero);
                let pressed = self.pressed(pad, &ends);
                for i in 0..2 {
                    let (g, p) = (gradient(n, ends[i].a, ends[i].d), pressed.force[i] * half_time);
                    for r in 0..6 {
                        impulse[r] = impulse[r].plus_product(p, g[r].abs());
                    }
                }
            }
        }
        impulse
    }
}
