//! Predictions in closed forms, and against dense inverses.

use super::*;
use crate::surrogate::Kernel;
use crate::surrogate::correlation::tests::cross_correlation;
use faer::linalg::solvers::DenseSolveCore;

fn points(n: usize) -> Mat<f64> {
    Mat::from_fn(2, n, |k, i| 4.0 * ((i + 1) as f64 * [0.754_877_666, 0.569_840_296][k]).fract() - 2.0)
}

fn values(x: &Mat<f64>) -> Mat<f64> {
    Mat::from_fn(x.ncols(), 2, |i, o| 7.0 + x[(0, i)].sin() + (1.0 + o as f64) * x[(0, i)] * x[(1, i)])
}

#[test]
fn interpolates_its_data_without_a_nugget() {
    let x = points(25);
    let y = values(&x);
    let correlation =
        Correlation { kernel: Kernel::Gaussian, theta: vec![0.8, 0.8], nugget: 0.0, stated: 0.0 };
    let model = Kriging::condition(x.as_ref(), y.as_ref(), &correlation).unwrap();
    assert_eq!(model.raised, 0);
    let prediction = model.predict(x.as_ref());
    for i in 0..25 {
        assert!(prediction.variance_factor[i] < 1e-9);
        for o in 0..2 {
            assert!((prediction.mean[(o, i)] - y[(i, o)]).abs() < 1e-8);
        }
    }
}

#[test]
fn far_from_the_data_it_returns_to_the_trend_with_the_full_variance() {
    let x = points(25);
    let correlation =
        Correlation { kernel: Kernel::Gaussian, theta: vec![1.0, 1.0], nugget: 1e-8, stated: 0.0 };
    let model = Kriging::condition(x.as_ref(), values(&x).as_ref(), &correlation).unwrap();
    let far = model.predict(Mat::from_fn(2, 1, |_, _| 100.0).as_ref());
    let mean = model.shift[0] + model.coefficients[(0, 0)];
    assert!((far.mean[(0, 0)] - mean).abs() < 1e-12);
    assert!((far.variance_factor[0] - (1.0 + 1.0 / model.trend.squares[0])).abs() < 1e-12);
}

#[test]
fn means_alone_agree_with_the_whole_prediction() {
    let x = points(30);
    let correlation =
        Correlation { kernel: Kernel::Gaussian, theta: vec![0.5, 0.9], nugget: 1e-6, stated: 0.0 };
    let model = Kriging::condition(x.as_ref(), values(&x).as_ref(), &correlation).unwrap();
    let at = Mat::from_fn(2, 7, |k, i| (i as f64 + 2.0 * k as f64).cos());
    let (whole, alone) =
        (model.predict(at.as_ref()).mean, model.predict_means(at.as_ref(), &model.dual(), 0..2));
    assert!((&whole - &alone).norm_max() < 1e-7);
}

#[test]
fn noisy_values_of_one_place_are_weighted_by_their_precision() {
    // Four simulations of the same point. The trend is unknown, so they are all there is to know: the mean is
    // that weighted by precision, the variance over sigma2 the inverse of the summed precisions.
    let x = Mat::from_fn(2, 4, |k, _| 0.3 * k as f64);
    let y = Mat::from_fn(4, 1, |i, _| [1.0, 2.0, 4.0, 8.0][i]);
    let correlation =
        Correlation { kernel: Kernel::Gaussian, theta: vec![1.0, 1.0], nugget: 0.05, stated: 0.2 };
    let weights = [0.1, 0.5, 1.4, 2.0];
    let model =
        Kriging::condition_noisy(x.as_ref(), y.as_ref(), &correlation, Trend::Constant, Some(&weights))
            .unwrap();
    let precision = weights.map(|w| 1.0 / (0.05 + 0.2 * w));
    let sum: f64 = precision.iter().sum();
    let mean = precision.iter().zip(y.col_as_slice(0)).map(|(p, y)| p * y).sum::<f64>() / sum;
    let prediction = model.predict(x.subcols(0, 1));
    assert!((prediction.mean[(0, 0)] - mean).abs() < 1e-12);
    assert!((prediction.variance_factor[0] - 1.0 / sum).abs() < 1e-12, "{}", prediction.variance_factor[0]);
    assert_eq!(model.raised, 0);
}

#[test]
fn coincident_points_raise_the_nugget_and_say_so() {
    let x = Mat::from_fn(2, 12, |k, i| (i / 2) as f64 + k as f64);
    let y = values(&x);
    let correlation =
        Correlation { kernel: Kernel::Gaussian, theta: vec![0.01, 0.01], nugget: 0.0, stated: 0.0 };
    let model = Kriging::condition(x.as_ref(), y.as_ref(), &correlation).unwrap();
    assert!(model.raised > 0 && model.correlation.nugget >= NUGGET.0);
    assert!(model.predict(x.as_ref()).mean.norm_max().is_finite());
}

#[test]
fn a_linear_function_is_known_everywhere_by_a_linear_trend() {
    // The limit state of Rackwitz in 40 standardised lognormal variables is linear in them.
    let (d, n) = (40, 90);
    let x = Mat::from_fn(d, n, |k, i| 4.0 * (4e4 * ((i * d + k + 1) as f64).sin()).fract());
    let function = |x: faer::ColRef<'_, f64>| {
        40.0 + 3.0 * 0.2 * 40f64.sqrt() - x.iter().map(|x| 1.0 + 0.2 * x).sum::<f64>()
    };
    let y = Mat::from_fn(n, 1, |i, _| function(x.col(i)));
    let at = Mat::from_fn(d, 20, |k, i| 5.0 * ((i * 41 + k) as f64).sin());
    for kernel in Kernel::ALL {
        let correlation = Correlation { kernel, theta: vec![0.01; d], nugget: 1e-10, stated: 0.0 };
        let conditioned =
            |trend| Kriging::condition_noisy(x.as_ref(), y.as_ref(), &correlation, trend, None).unwrap();
        let model = conditioned(Trend::Linear);
        let mean = model.predict(at.as_ref()).mean;
        let far = (0..20).map(|i| (mean[(0, i)] - function(at.col(i))).abs()).fold(0.0, f64::max);
        assert!(far < 1e-10 && model.sigma2[0] < 1e-20, "{kernel:?} {far}");
        // Which a constant trend is far from, so the test can fail.
        let mean = conditioned(Trend::Constant).predict(at.as_ref()).mean;
        assert!((0..20).any(|i| (mean[(0, i)] - function(at.col(i))).abs() > 0.1));
    }
}

#[test]
fn the_trend_enters_the_variance_as_in_universal_kriging() {
    let x = points(30);
    let correlation =
        Correlation { kernel: Kernel::Matern52, theta: vec![0.5, 0.9], nugget: 1e-3, stated: 0.0 };
    let model =
        Kriging::condition_noisy(x.as_ref(), values(&x).as_ref(), &correlation, Trend::Linear, None).unwrap();
    // c0 - r' C^-1 r + (f - F' C^-1 r)' (F' C^-1 F)^-1 (f - F' C^-1 r) by dense inverses.
    let at = Mat::from_fn(2, 6, |k, i| 3.0 * (i as f64 + 2.0 * k as f64).cos());
    let mut c = crate::surrogate::correlation_matrix(&correlation, x.as_ref());
    correlation.add_noise(c.as_mut(), None);
    let c_inverse = c.partial_piv_lu().inverse();
    let r = cross_correlation(&correlation, x.as_ref(), at.as_ref());
    let basis = |x: &Mat<f64>| Trend::Linear.basis(x.as_ref()).transpose().to_owned();
    let f = basis(&x);
    let u = basis(&at).transpose() - f.transpose() * &c_inverse * &r;
    let gram = (f.transpose() * &c_inverse * &f).partial_piv_lu().inverse();
    let explained = r.transpose() * &c_inverse * &r;
    let extrapolated = u.transpose() * gram * &u;
    let found = model.predict(at.as_ref()).variance_factor;
    for (i, found) in found.into_iter().enumerate() {
        let expected = 1.0 - explained[(i, i)] + extrapolated[(i, i)];
        assert!((found / expected - 1.0).abs() < 1e-9, "{found} {expected}");
    }
}
