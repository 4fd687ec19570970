//! Contact histories of one island, recorded alone and in lanes: they must be the same, and hold the work of the trapezoidal rule.

use super::{ContactLanes, Recorder, recording_request};
use crate::integrate::Stepped;
use crate::mechanism::islands;
use common::scene::SceneSource;

#[test]
fn contacts_in_a_lane_are_those_of_one_recorder() {
    let scene = SceneSource::builtin("four-bar").expect("built in").nominal().clone();
    let island = islands(&scene).expect("assembled").remove(0);
    assert!(!island.scales().0.is_empty());
    let mut alone = Recorder::new(&island, &scene, &recording_request(&scene.outputs), 40);
    let (mut in_lane, mut at) = (alone.clone(), island.linearised());
    let mut lanes = ContactLanes::new(0.0, island.joints.len());
    lanes.load(0, &in_lane, 0.0);
    let (mut trapezoid, mut before) = (0.0, (0.0, 0.0));
    for k in 0..=500_u32 {
        // Steps of unequal length, with free flight now and then.
        let t = scene.life.period * (f64::from(k) / 500.0).powf(1.3);
        let pressed = (40.0 * t / scene.life.period).sin().max(0.0);
        let (y, x) = (2.0 * t).sin_cos();
        at.e[0] = [1e-5 * x, 1e-5 * y];
        at.joints[0].normal = pressed;
        at.joints[0].sliding = 0.1 + 0.01 * f64::from(k % 7);
        at.joints[0].direction = if pressed > 0.0 { [x, y] } else { [0.0; 2] };
        at.joints[0].penetration = 1e-7 * pressed;
        let density = pressed * at.joints[0].sliding;
        trapezoid += 0.5 * (t - before.0) * (density + before.1);
        before = (t, density);
        alone.record_contacts(&island, t, &at);
        // The state is linearised again after a refused step.
        for _ in 0..=k % 2 {
            lanes.record(t, &at, &mut |joint, _, sample| {
                in_lane.histories[joint].bore_mut().expect("a bore").samples.push(sample);
            });
        }
        if k == 200 {
            // The second part of a cycle begins at the end of the first.
            lanes.unload(0, &mut in_lane);
            lanes.load(0, &in_lane, t);
        }
    }
    lanes.unload(0, &mut in_lane);
    alone.finish();
    in_lane.finish();
    assert_eq!(alone.histories, in_lane.histories);
    let history = alone.histories[0].bore().expect("a bore");
    assert!(history.samples.len() > 20, "{}", history.samples.len());
    let work = history.samples.iter().map(|sample| sample.work).sum::<f64>();
    assert!((work / trapezoid - 1.0).abs() < 1e-12, "{work} {trapezoid}");
}
