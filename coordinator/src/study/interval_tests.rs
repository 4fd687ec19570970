//! Campaigns whose intervals must contain what their surrogates do not know: outputs with steps, regions where simulations fail,
//! failures that no simulation has met.

use super::campaign_tests::{learn_by, learn_from};
use super::stopped::targets_met;
use super::{CampaignResult, Observed, Settings, StopReason};
use crate::results::summary::ReliabilityRange;
use crate::statistics::design::InputModel;
use crate::statistics::learning::StoppingTargets;
use common::failure::SimulationFailure;
use common::random::{Distribution, standard_normal_cdf};

fn normals() -> InputModel {
    InputModel::from(&vec![Distribution::normal(0.0, 1.0).unwrap(); 2])
}

fn learn(output: impl Fn(&[f64]) -> f64, threshold: f64, seed: u64) -> CampaignResult {
    learn_from(normals(), output, (threshold, (20_000, 400_000)), 12, seed, StoppingTargets::default())
}

/// The interval of the failure probability of the system, as a study states it.
fn interval(learned: &CampaignResult) -> (f64, f64) {
    let rows = learned.shares.rows(&["f".to_owned(), "total".to_owned()], &[1]);
    let ReliabilityRange { lower, upper } = rows[0].interval["total"];
    (1.0 - upper, 1.0 - lower)
}

#[test]
fn issue_half_a_plateau_at_the_limit_was_stated_as_safe() {
    // floor(2 y) >= 4 of a normal y with standard deviation sqrt(2).
    let learned = learn(|x| (2.0 * (x[0] + x[1])).floor(), 4.0, 1);
    let (truth, (least, most)) = (standard_normal_cdf(-(2f64.sqrt())), interval(&learned));
    let found = learned.assessment.curves[0][0];
    assert!(least <= truth && truth <= most, "{least} {truth} {most}");
    assert!((found / truth - 1.0).abs() < 0.12, "{found} {truth}");
}

#[test]
fn issue_a_flag_took_542_simulations() {
    // 1 where a normal sum exceeds 2, P = Phi(-sqrt(2)): the interval is wide, and learning ends once its errors are small beside that.
    let learned = learn(|x| f64::from(u8::from(x[0] + x[1] > 2.0)), 0.5, 1);
    let ((least, most), truth) = (interval(&learned), standard_normal_cdf(-(2f64.sqrt())));
    eprintln!("{} calls, {least} to {most}, truth {truth}, {:?}", learned.evaluations, learned.stop);
    assert!(least <= truth && truth <= most, "{least} {truth} {most}");
    assert!(learned.evaluations < 250, "{}", learned.evaluations);
}

#[test]
fn issue_a_failing_half_space_ended_the_study() {
    // No result beyond two standard deviations on the side of the failures, or on the other one; failures at 2.6.
    for (side, seed) in [(1.0, 1), (-1.0, 2)] {
        let simulate = |x: &[f64]| {
            if side * x[0] > 2.0 {
                return Err(SimulationFailure::NotModelled { what: "no equilibrium".into() });
            }
            Ok(Observed::exact(vec![vec![x[0] + 0.3 * x[1]]]))
        };
        let limits = (2.6, (20_000, 400_000));
        let learned = learn_by(normals(), simulate, limits, 12, seed, StoppingTargets::default()).unwrap();
        assert!(matches!(learned.stop, StopReason::Rule(_)), "{side} {seed}: {:?}", learned.stop);
        // Failing requests are few, and the interval contains that all or none of the region fails.
        let (failed, barred) = (learned.failed.len(), learned.shares.missing);
        assert!(failed * 2 < learned.evaluations, "{side} {seed}: {failed} of {}", learned.evaluations);
        let (least, most) = interval(&learned);
        assert!(barred < 4.0 * standard_normal_cdf(-2.0), "{side} {seed}: {barred}");
        let truth = if side > 0.0 { 0.0 } else { standard_normal_cdf(-2.6 / 1.09f64.sqrt()) };
        assert!(least <= truth && most >= truth + 0.9 * barred, "{side} {seed}: {least} {most} {barred}");
    }
}

#[test]
fn issue_a_linear_response_far_from_its_limit_had_a_bound_by_accident() {
    let learned = learn(|x| x[0] + x[1], 3500.0, 1);
    let (least, most) = interval(&learned);
    assert!(least == 0.0 && (most - (1.0 - 0.05f64.powf(1.0 / 11.0))).abs() < 1e-9, "{most}");
    // A rare event that simulations have met keeps its sharp interval: P = Phi(-5).
    let learned = learn(|x| (x[0] + x[1]) / 2f64.sqrt(), 5.0, 1);
    let ((least, most), truth) = (interval(&learned), standard_normal_cdf(-5.0));
    assert!(least < truth && truth < most && most < 1.5 * truth, "{least} {truth} {most}");
    // It meets a half width that it has, and no smaller one.
    let settings = |h| Settings { target_error: Some(h), ..Settings::default() };
    let met = [1e-6, 1e-12].map(|h| targets_met(&learned, &settings(h)));
    assert_eq!(met, [true, false]);
}
