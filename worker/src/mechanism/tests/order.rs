//! Observed order of the integration with ideal joints.

use crate::integrate::{Dynamics, Rosenbrock, Stepped};
use crate::mechanism::{Island, ideal_cycle, islands};
use common::scene::SceneSource;

/// State of the island after 0.7 s in equal steps, closed after each.
fn end(island: &mut Island, start: &[f64; 6], steps: usize) -> Vec<f64> {
    let mut at = island.linearised();
    let mut scheme = Rosenbrock::new(0.0, &at.band);
    let (mut q, mut v) = (start[..3].to_vec(), start[3..].to_vec());
    let h = 0.7 / steps as f64;
    for k in 0..steps {
        let t = k as f64 * h;
        island.linearise(t, &q, &v, &mut at);
        assert_eq!(scheme.step(island, &at, t, h, &q, &v), 1.0);
        q.copy_from_slice(&scheme.new_q);
        v.copy_from_slice(&scheme.new_v);
        island.close(t + h, &mut q, &mut v).expect("it can be closed");
    }
    q.extend(v);
    q
}

#[test]
fn order_four_is_observed_with_ideal_joints() {
    let scene = SceneSource::builtin("pendulum").expect("it is built in").nominal().clone();
    let pose = ideal_cycle(&scene, 2, &mut 0).expect("it closes").swap_remove(0);
    let mut found = islands(&scene).expect("it is modelled");
    let island = &mut found[0];
    let body = island.bodies[0];
    let (q, v) = (pose.q[body].expect("free"), pose.v[body].expect("free"));
    let start = [q[0], q[1], q[2], v[0], v[1], v[2]];
    let fine = end(island, &start, 1024);
    let mut error = |steps: usize| {
        end(island, &start, steps).iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let order = (error(32) / error(128)).log2() / 2.0;
    assert!((3.7..4.5).contains(&order), "observed order {order}");
}
