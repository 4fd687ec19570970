//! Force of a slider on the worn faces of its guide.
//!
//! Each pad of the slider, half a face, is a chain of m straight elements (`rail.rs`). With the depths w_g(s) of the guide and w_s,i of the slider
//! at node i, its overlap and the gradient and rate of that are
//!
//!   g_i = n . d_i - (n . p + H) - w_g(s_i) - w_s,i,   G_i = G(n) - w_g'(s_i) T_i,   dg_i/dt = G_i dq/dt,
//!
//! with the notation of `guide.rs`. Every element has the potential of `contact/pad.rs` at its two nodes; U is their sum, and U_i = dU/dg_i. One
//! damping factor phi = max(0, 1 + D rho), rho = sum of U_i dg_i/dt / sum of U_i, belongs to the whole pad. The generalised force is
//!
//!   Q = - sum of phi U_i (G_i + mu tanh((ds_i/dt) / v_0) T_i) [N, N m],
//!
//! which without damping and friction is the gradient of U: the contact is conservative on worn faces, too. All derivatives are exact.
//!
//! Depths count along the normal of the unworn face of the guide: valid for slopes of the worn faces and tilts of the slider small against one.
//!
//! # Source
//! As `guide.rs` and `contact/pad.rs`; the gradient on worn faces is derived here.

use super::frame::Frame;
use super::guide::{Guide, GuideFace, PadEnd, add_second, gradient, turning};
use super::load::LoadForce;
use crate::contact::{GuideReaction, coulomb, foundation};
use crate::plane::dot;
use crate::rail::{MOST_NODES, RailFaces};

/// Six coordinates: those of the slider's body, then those of the guide's.
type PairRow = [f64; 6];

/// A slider on worn faces.
pub(super) struct WornGuide<'a> {
    pub(super) flat: &'a Guide,
    pub(super) faces: &'a RailFaces,
}

/// A node of a face at one instant.
#[derive(Clone, Copy)]
struct Node {
    /// Place, overlap, rate and sliding speed, on the worn faces.
    at: PadEnd<f64>,
    /// Distance from the slider's middle along the slider [m].
    ahead: f64,
    /// Derivatives of the guide's depth there [1, 1/m].
    slope: f64,
    bend: f64,
}

/// The nodes of a pad and its elastic forces.
struct Pad {
    count: usize,
    nodes: [Node; MOST_NODES],
    /// U_i [N], and the second derivatives of U on the diagonal and between nodes i and i + 1 [N/m].
    force: [f64; MOST_NODES],
    diagonal: [f64; MOST_NODES],
    beside: [f64; MOST_NODES],
    stored: f64,
    /// Sum of U_i [N].
    normal: f64,
    /// phi [1], D where the pad pushes [s/m] and rho [m/s].
    factor: f64,
    damping: f64,
    rho: f64,
}

impl Pad {
    fn nodes(&self) -> &[Node] {
        &self.nodes[..self.count]
    }

    /// Adds the elements, each of the stiffness `unit` = kappa times a sixth of its length [N/m], and the `damping` factor D [s/m].
    fn press(&mut self, unit: f64, damping: f64) {
        for k in 0..self.count - 1 {
            let g = [self.nodes[k].at.overlap, self.nodes[k + 1].at.overlap];
            if g[0] <= 0.0 && g[1] <= 0.0 {
                continue;
            }
            let (stored, force, second) = foundation(unit, g);
            self.stored += stored;
            self.beside[k] = second[0][1];
            for end in 0..2 {
                self.force[k + end] += force[end];
                self.diagonal[k + end] += second[end][end];
            }
        }
        let forces = self.nodes().iter().zip(&self.force);
        let (normal, power) =
            forces.fold((0.0, 0.0), |(n, p), (node, force)| (n + force, p + force * node.at.rate));
        self.normal = normal;
        self.rho = if normal > 0.0 { power / normal } else { 0.0 };
        let factor = 1.0 + damping * self.rho;
        (self.factor, self.damping) = (factor.max(0.0), if factor > 0.0 { damping } else { 0.0 });
    }

    /// Sum over j of U_ij x_j.
    fn second(&self, i: usize, x: impl Fn(usize) -> f64) -> f64 {
        let mut sum = self.diagonal[i] * x(i);
        if i > 0 {
            sum += self.beside[i - 1] * x(i - 1);
        }
        if i + 1 < self.count {
            sum += self.beside[i] * x(i + 1);
        }
        sum
    }
}

impl WornGuide<'_> {
    /// Generalised force on the bodies in `frames`, with `JACOBIAN` also its derivatives, and what the guide does.
    pub(super) fn force<const JACOBIAN: bool>(&self, frames: &[Frame]) -> (LoadForce, GuideReaction) {
        let [i, j] = &self.flat.ends;
        let bodies = [&frames[i.frame], &frames[j.frame]];
        let (mut load, mut done) = (LoadForce::none([i.frame, j.frame], 0.0), GuideReaction::none(0.0));
        done.beyond = f64::NEG_INFINITY;
        for face in 0..2 {
            let side = self.flat.side(face, bodies[1].turn(self.flat.axis));
            for half in 0..2 {
                let index = 2 * face + half;
                let (ends, deepest) = self.deepest(&side, half, bodies);
                for end in ends {
                    done.beyond = done.beyond.max(end - self.flat.reach[1]).max(self.flat.reach[0] - end);
                }
                // The middle of both faces is the first node of the second half.
                if half == 1 {
                    done.position += 0.5 * ends[0];
                }
                [done.penetration[index], done.approach[index]] = deepest;
                if done.penetration[index] <= 0.0 {
                    continue;
                }
                let mut pad = self.pad(&side, half, bodies);
                pad.press(self.flat.unit / (pad.count - 1) as f64, self.flat.damping[index]);
                done.stored += pad.stored;
                done.lost += pad.normal * pad.rho * (pad.factor - 1.0);
                self.add_pad::<JACOBIAN>(&mut load, &mut done, &side, &pad, bodies);
            }
        }
        (load, done)
    }

    /// Size of the generalised impulse of the pads that begin to touch, as that of a flat guide.
    pub(super) fn begun(&self, frames: &[Frame], before: &GuideReaction, h: f64) -> PairRow {
        let bodies = self.flat.ends.map(|end| &frames[end.frame]);
        let mut impulse = [0.0; 6];
        for face in 0..2 {
            let side = self.flat.side(face, bodies[1].turn(self.flat.axis));
            for half in 0..2 {
                let index = 2 * face + half;
                let (_, [overlap, rate]) = self.deepest(&side, half, bodies);
                if before.penetration[index] > 0.0 || overlap <= 0.0 {
                    continue;
                }
                let mut pad = self.pad(&side, half, bodies);
                let since = if rate * h > overlap { overlap / rate } else { h };
                pad.press(self.flat.unit / (pad.count - 1) as f64, self.flat.damping[index]);
                for (node, force) in pad.nodes().iter().zip(&pad.force) {
                    let (g, p) = (self.to_overlap(&side, node), 0.5 * since * pad.factor * force);
                    for r in 0..6 {
                        impulse[r] += p * g[r].abs();
                    }
                }
            }
        }
        impulse
    }

    /// Places of the ends of half a face along the guide [m], and overlap and its rate at its deepest node [m, m/s]: before the depths of the two
    /// surfaces, all are straight lines from end to end.
    fn deepest(&self, side: &GuideFace<f64>, half: usize, bodies: [&Frame; 2]) -> ([f64; 2], [f64; 2]) {
        let layout = &self.faces.layout;
        let first = half * layout.elements;
        let ends = [first, first + layout.elements];
        let ends = ends.map(|node| self.flat.point(side, layout.node(node), bodies));
        let places = ends.map(|end| dot(side.t, end.d) - side.base);
        let per_element = 1.0 / layout.elements as f64;
        let line = |of: [f64; 2], k: usize| of[0] + (of[1] - of[0]) * (k as f64 * per_element);
        let (flat, depths) = (ends.map(|end| end.overlap), &self.faces.slider[side.face][first..]);
        let (mut deepest, mut largest) = (0, f64::NEG_INFINITY);
        for (k, depth) in depths[..=layout.elements].iter().enumerate() {
            let worn = self.faces.guide_depth(side.face, line(places, k))[0];
            let overlap = line(flat, k) - (worn + depth);
            if overlap >= largest {
                (deepest, largest) = (k, overlap);
            }
        }
        let [_, slope, _] = self.faces.guide_depth(side.face, line(places, deepest));
        let [rate, sliding] =
            [ends.map(|end| end.rate), ends.map(|end| end.sliding)].map(|of| line(of, deepest));
        (places, [largest, rate - slope * sliding])
    }

    /// The nodes of half a face, without forces.
    fn pad(&self, side: &GuideFace<f64>, half: usize, bodies: [&Frame; 2]) -> Pad {
        let layout = &self.faces.layout;
        let count = layout.elements + 1;
        let at = PadEnd { a: [0.0; 2], d: [0.0; 2], overlap: 0.0, rate: 0.0, sliding: 0.0 };
        let unset = Node { at, ahead: 0.0, slope: 0.0, bend: 0.0 };
        let none = [0.0; MOST_NODES];
        let mut pad = Pad {
            count,
            nodes: [unset; MOST_NODES],
            force: none,
            diagonal: none,
            beside: none,
            stored: 0.0,
            normal: 0.0,
            factor: 0.0,
            damping: 0.0,
            rho: 0.0,
        };
        for k in 0..count {
            let index = k + half * layout.elements;
            let ahead = layout.node(index);
            let mut at = self.flat.point(side, ahead, bodies);
            let s = dot(side.t, at.d) - side.base;
            let [worn, slope, bend] = self.faces.guide_depth(side.face, s);
            at.overlap -= worn + self.faces.slider[side.face][index];
            at.rate -= slope * at.sliding;
            pad.nodes[k] = Node { at, ahead, slope, bend };
        }
        pad
    }

    /// Gradient G_i of a node's overlap.
    fn to_overlap(&self, side: &GuideFace<f64>, node: &Node) -> PairRow {
        gradient(direction(side, -node.slope), node.at.a, node.at.d)
    }

    /// Adds the forces of a pad at its nodes, with friction.
    fn add_pad<const JACOBIAN: bool>(
        &self,
        load: &mut LoadForce,
        done: &mut GuideReaction,
        side: &GuideFace<f64>,
        pad: &Pad,
        bodies: [&Frame; 2],
    ) {
        let (to_q, to_v) = if JACOBIAN { self.rate_of_pad(side, pad, bodies) } else { ([0.0; 6], [0.0; 6]) };
        for (i, node) in pad.nodes().iter().enumerate().filter(|(i, _)| pad.force[*i] > 0.0) {
            let (at, p) = (&node.at, pad.factor * pad.force[i]);
            let (ratio, steepness) = coulomb(self.flat.friction, self.flat.per_friction_speed, at.sliding);
            done.normal[side.face] += p;
            done.friction[side.face] -= p * ratio;
            done.lost += p * ratio * at.sliding;
            done.moment[side.face] += p * node.ahead;
            done.rubbing[side.face] += p * at.sliding.abs();
            let u = direction(side, ratio - node.slope);
            let acting = gradient(u, at.a, at.d);
            for (f, acting) in load.f.iter_mut().zip(acting) {
                *f -= p * acting;
            }
            if JACOBIAN {
                let damping = pad.force[i] * pad.damping;
                let (mut p_to_q, p_to_v) = (to_q.map(|x| damping * x), to_v.map(|x| damping * x));
                for j in i.saturating_sub(1)..(i + 2).min(pad.count) {
                    let second = pad.factor * pad.second(i, |k| if k == j { 1.0 } else { 0.0 });
                    let g = self.to_overlap(side, &pad.nodes[j]);
                    for c in 0..6 {
                        p_to_q[c] += second * g[c];
                    }
                }
                let (along, slid) = (gradient(side.t, at.a, at.d), turning(side.t, at, bodies));
                for r in 0..6 {
                    for c in 0..6 {
                        load.k[r][c] -= acting[r] * p_to_q[c]
                            + p * along[r] * (steepness * slid[c] - node.bend * along[c]);
                        load.d[r][c] -= acting[r] * p_to_v[c] + p * steepness * along[r] * along[c];
                    }
                }
                add_second(&mut load.k, -p, u, at);
            }
        }
    }

    /// Derivatives of rho to the coordinates and to their rates.
    fn rate_of_pad(&self, side: &GuideFace<f64>, pad: &Pad, bodies: [&Frame; 2]) -> (PairRow, PairRow) {
        let (mut to_q, mut to_v) = ([0.0; 6], [0.0; 6]);
        if pad.damping == 0.0 || pad.normal <= 0.0 {
            return (to_q, to_v);
        }
        let per_normal = 1.0 / pad.normal;
        for (j, node) in pad.nodes().iter().enumerate() {
            let turned = per_normal * pad.second(j, |k| pad.nodes[k].at.rate - pad.rho);
            let share = per_normal * pad.force[j];
            if turned == 0.0 && share == 0.0 {
                continue;
            }
            let at = &node.at;
            let g = self.to_overlap(side, node);
            let along = gradient(side.t, at.a, at.d);
            let of_rate = turning(direction(side, -node.slope), at, bodies);
            let bent = node.bend * at.sliding;
            for c in 0..6 {
                to_q[c] += turned * g[c] + share * (of_rate[c] - bent * along[c]);
                to_v[c] += share * g[c];
            }
        }
        (to_q, to_v)
    }
}

/// n + `along` t, in global axes.
fn direction(side: &GuideFace<f64>, along: f64) -> [f64; 2] {
    [0, 1].map(|c| side.n[c] + along * side.t[c])
}
