//! Scores of distributions whose support would move with their mean or standard deviation.
//!
//! Where the support depends on a parameter (uniform, shifted exponential), the derivative of a probability has a
//! term at the moving end, which no score function carries; where the density vanishes there (triangular), the score
//! exists but has no variance. For these distributions the support is held fixed, and mean and standard deviation
//! change by the least change of the density: of all densities with the new moments, the one nearest to f in the sense
//! of Kullback and Leibler, f_new(x) ~ f(x) exp(c1 x + c2 x^2). To first order, with t = (x - mean) / std, skewness
//! g = E[t^3], kurtosis k = E[t^4] and D = k - 1 - g^2:
//!
//! ```text
//! s_mean = ((k - 1) t - g (t^2 - 1)) / (D std),   s_std = 2 ((t^2 - 1) - g t) / (D std)   [1/unit of the variable]
//! ```
//!
//! They satisfy E[s] = 0, E[s_mean X] = 1, E[s_mean (X - mean)^2] = 0, E[s_std X] = 0, E[s_std (X - mean)^2] = 2 std,
//! and are the ordinary scores if f is normal. Valid for any f with finite fourth moment and D > 0.
//!
//! # Source
//! Lemaitre, Sergienko, Arnaud, Bousquet, Gamboa, Iooss (2015), Density modification-based reliability sensitivity
//! analysis, Journal of Statistical Computation and Simulation; the derivative at no change is derived here.

/// Combines t and t^2 - 1 at a point into the two scores, or their integrals over the density into dF/dmean and dF/dstd
/// `(2,)` [1/unit of the variable]; `std` [unit of the variable].
pub(super) fn tilted(linear: f64, quadratic: f64, std: f64, skewness: f64, kurtosis: f64) -> [f64; 2] {
    let g = skewness;
    let scale = 1.0 / ((kurtosis - 1.0 - g * g) * std);
    [((kurtosis - 1.0) * linear - g * quadratic) * scale, 2.0 * (quadratic - g * linear) * scale]
}
