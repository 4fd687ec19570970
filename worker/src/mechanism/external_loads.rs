//! Loads between prescribed bodies alone: they act on no free body, but the drives carry them.

use super::frame::Frame;
use super::island_frames::IslandFrames;
use super::load::IslandLoad;
use common::scene::{Load, Motion, Scene};

/// Moment of the loads on the prescribed `body` of a scene that act on no free body, about its axis at a time [s] [N m].
pub(crate) fn external_moment(scene: &Scene, body: usize) -> impl Fn(f64) -> f64 {
    let mut frames = IslandFrames::new(scene, vec![]);
    let own = frames.frame(body);
    let is_prescribed = |b: &usize| !matches!(scene.bodies[*b].motion, Motion::Free { .. });
    let acts = |load: &&Load| load.bodies().contains(&body) && load.bodies().iter().all(is_prescribed);
    let loads: Vec<IslandLoad> =
        scene.loads.iter().filter(acts).map(|load| IslandLoad::new(load, &mut frames)).collect();
    let prescribed = frames.prescribed();
    move |t| {
        if loads.is_empty() {
            return 0.0;
        }
        let frames: Vec<Frame> = prescribed.iter().map(|p| p.frame(t)).collect();
        let on_body = |load: &IslandLoad| -> f64 {
            let force = load.force(t, &frames);
            let sides = force.frames.iter().enumerate().filter(|&(_, &frame)| frame == own);
            sides.map(|(side, _)| force.f[3 * side + 2]).sum()
        };
        loads.iter().map(on_body).sum()
    }
}
