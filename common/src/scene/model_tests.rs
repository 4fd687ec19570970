//! Limit states and defaults of a study.

use super::output::{Fails, LimitState};
use crate::scene::SceneSource;

#[test]
fn failure_lies_beyond_the_thresholds_and_at_them() {
    let limit = |fails| LimitState { name: "l".into(), output: 0, threshold: 3.0, fails };
    let fails = |limit: &LimitState| [-2.0, -1.0, 0.0, 3.0, 4.0].map(|value| limit.is_reached(value));
    let (above, below) = (limit(Fails::Above), limit(Fails::Below));
    let outside = limit(Fails::Outside { lower: -1.0 });
    assert_eq!(fails(&above), [false, false, false, true, true]);
    assert_eq!(fails(&below), [true, true, true, true, false]);
    assert_eq!(fails(&outside), [true, true, false, true, true]);
    for limit in [above, below, outside.clone()] {
        for value in [-2.0, -1.0, 0.0, 2.0, 3.0, 4.0] {
            let reached = limit.response(value) >= limit.response_threshold();
            assert_eq!(reached, limit.is_reached(value), "{limit:?} {value}");
        }
        assert!(!limit.is_reached(f64::NAN));
    }
    assert_eq!((outside.thresholds(), outside.middle(), outside.scale()), (vec![-1.0, 3.0], Some(1.0), 2.0));
}

#[test]
fn a_study_grows_with_the_variables_of_its_scene() {
    let study = |d: usize, own: &str| {
        let variables: String =
            (0..d).map(|k| format!("{{ name = \"x{k}\", mean = 0, std = 1 }},")).collect();
        let text = format!(
            "scene = {{ name = \"s\" }}\nsimulator = {{ program = [\"s\"] }}\noutputs = [{{ name = \"a\" }}]\n\
             limit_states = [{{ name = \"high\", output = \"a\", threshold = 5 }}]\nvariables = [{variables}]\n{own}"
        );
        let study = SceneSource::parse(&text, "s").unwrap().nominal().study;
        (study.initial, study.batch, study.max_evaluations)
    };
    let found = [1, 8, 9, 30, 100].map(|d| study(d, ""));
    assert_eq!(found, [(12, 4, 600), (30, 6, 600), (30, 6, 600), (45, 10, 600), (150, 28, 1000)]);
    // What a scene sets stays.
    assert_eq!(study(30, "study = { initial = 60, batch = 16 }"), (60, 16, 600));
}
