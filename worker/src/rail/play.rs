//! Play of a slider between the worn faces of its guide.
//!
//! With the offset a [m] and the tilt b [rad] of the slider, whose nodes lie at the distances x_i from its middle, and the gaps z_i [m] there,
//! clearance and wear depths together, the slider is free where
//!
//!   a + b x_i <= z_i on the left face,   - a - b x_i <= z_i on the right one.
//!
//! The largest value of lambda_0 a + lambda_1 b over this polygon is, by the duality of linear programs, the smallest mu_p z_p + mu_q z_q over all
//! pairs of nodes whose constraints give (lambda_0, lambda_1) with weights mu >= 0: the reactions of the faces to the load (lambda_0, lambda_1).
//!
//! # Source
//! Duality: Nocedal, Wright (2006), Numerical Optimization, chapter 13.

use super::faces::RailFaces;

/// Determinant of two constraints below which they are parallel, over the slider's length [1].
const PARALLEL: f64 = 1e-12;

/// Range of `lambda[0]` a + `lambda[1]` b of a slider with its middle at `s` [m] and the `clearance` [m] on each side.
pub(crate) fn play(faces: &RailFaces, clearance: f64, lambda: [f64; 2], s: f64) -> f64 {
    let layout = faces.layout();
    let constraints: Vec<([f64; 2], f64)> = [(0, 1.0), (1, -1.0)]
        .into_iter()
        .flat_map(|(face, sign)| {
            (0..layout.nodes()).map(move |node| {
                let x = layout.node(node);
                let worn = faces.guide_depth(face, s + x).w + faces.slider_depth(face, node);
                ([sign, sign * x], clearance + worn)
            })
        })
        .collect();
    let least = PARALLEL * layout.half_length;
    largest(&constraints, lambda, least) + largest(&constraints, lambda.map(|x| -x), least)
}

/// Largest value of `lambda` . z over the z with n . z <= r for all `constraints` (n, r).
fn largest(constraints: &[([f64; 2], f64)], lambda: [f64; 2], least: f64) -> f64 {
    let mut smallest = f64::INFINITY;
    for (p, (np, rp)) in constraints.iter().enumerate() {
        for (nq, rq) in &constraints[p + 1..] {
            let determinant = np[0] * nq[1] - np[1] * nq[0];
            if determinant.abs() <= least {
                continue;
            }
            let mu = [
                (lambda[0] * nq[1] - lambda[1] * nq[0]) / determinant,
                (np[0] * lambda[1] - np[1] * lambda[0]) / determinant,
            ];
            if mu[0] >= 0.0 && mu[1] >= 0.0 {
                smallest = smallest.min(mu[0] * rp + mu[1] * rq);
            }
        }
    }
    smallest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rail::RailLayout;

    const CLEARANCE: f64 = 1e-4;
    const HALF: f64 = 0.025;

    fn faces() -> RailFaces {
        RailFaces::new(RailLayout {
            points: 11,
            reach: [-0.1, 0.1],
            elements: 5,
            half_length: HALF,
            width: 0.02,
            slider_wears: true,
        })
    }

    /// Between flat faces both ends of the slider have the play 2 c: 2 c (|lambda_0 / 2 + lambda_1 / l| + |lambda_0 / 2 - lambda_1 / l|).
    #[test]
    fn between_flat_faces_the_ends_have_the_play_of_the_clearance() {
        let faces = faces();
        for lambda in [[1.0, 0.0], [0.0, 1.0], [0.7, -0.01], [-2.0, 0.3]] {
            let (half, couple) = (0.5 * lambda[0], lambda[1] / (2.0 * HALF));
            let expected = 2.0 * CLEARANCE * ((half + couple).abs() + (half - couple).abs());
            let found = play(&faces, CLEARANCE, lambda, 0.01);
            assert!((found / expected - 1.0).abs() < 1e-12, "{lambda:?}: {found} {expected}");
        }
    }

    /// A face worn evenly adds its depth; a trough into which the slider does not fit adds nothing to its offset, a worn corner lets it turn.
    #[test]
    fn wear_adds_the_play_that_the_slider_can_use() {
        let mut faces = faces();
        let layout = *faces.layout();
        let mut depth = vec![0.0; layout.depths()];
        depth[..11].fill(6e-6);
        faces.set_depth(&depth);
        let offset = |faces: &RailFaces| play(faces, CLEARANCE, [1.0, 0.0], 0.0);
        assert!((offset(&faces) - 2.06e-4).abs() < 1e-15);
        // 20 mm between control points, slider 50 mm long: between its ends only.
        depth[..11].fill(0.0);
        depth[5] = 6e-6;
        faces.set_depth(&depth);
        assert!((offset(&faces) - 2e-4).abs() < 1e-15);
        depth[5] = 0.0;
        // The right end of the left face: tilted by a couple the slider turns on the left end of the right face.
        depth[22 + 10] = 6e-6;
        faces.set_depth(&depth);
        assert!((offset(&faces) - 2e-4).abs() < 1e-15);
        let turn = play(&faces, CLEARANCE, [0.0, 1.0], 0.0);
        // One way 2 c / l, the other way by the next node, 5 mm inside, (2 c) / (l - 5 mm), at most (2 c + 6 um) / l.
        let expected = 2e-4 / 0.05 + (2e-4_f64 / 0.045).min(2.06e-4 / 0.05);
        assert!((turn / expected - 1.0).abs() < 1e-12, "{turn} {expected}");
    }
}
