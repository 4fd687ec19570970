//! The form of a surrogate: the kernel of its correlation and its trend.

use super::{Kernel, Trend};
use crate::named;
use serde::{Deserialize, Serialize};

/// Kernel and trend of a surrogate; by default the Gaussian kernel and a constant trend.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct Form {
    /// Kernel of the correlation.
    pub kernel: Kernel,
    /// Trend by generalised least squares.
    pub trend: Trend,
}

/// The forms that are allowed; by default all of them. In files, `auto` stands for a choice by
/// cross-validation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct FormSettings {
    /// The kernel; `None` lets cross-validation choose.
    #[serde(default, with = "named")]
    pub kernel: Option<Kernel>,
    /// The trend; `None` lets cross-validation choose.
    #[serde(default, with = "named")]
    pub trend: Option<Trend>,
}

impl FormSettings {
    /// The allowed forms for `n` points in `d` variables, the smoothest kernel and the simplest trend first.
    /// A trend that the points cannot carry is replaced by the constant one.
    pub fn candidates(&self, d: usize, n: usize) -> Vec<Form> {
        let mut candidates = Vec::new();
        for kernel in Kernel::ALL.into_iter().filter(|kernel| self.kernel.is_none_or(|k| k == *kernel)) {
            for trend in Trend::ALL.into_iter().filter(|trend| self.trend.is_none_or(|t| t == *trend)) {
                let form = Form { kernel, trend: trend.carried_by(d, n) };
                if !candidates.contains(&form) {
                    candidates.push(form);
                }
            }
        }
        candidates
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn candidates_are_the_allowed_forms_that_the_points_can_carry() {
        let all = FormSettings::default();
        assert_eq!(all.candidates(10, 30).len(), 6);
        let carried = all.candidates(20, 30);
        assert_eq!(carried.len(), 3);
        assert!(carried.iter().all(|form| form.trend == Trend::Constant));
        assert_eq!(carried[0], Form::default());
        let linear = Form { kernel: Kernel::Matern32, trend: Trend::Linear };
        let fixed = FormSettings { kernel: Some(linear.kernel), trend: Some(linear.trend) };
        assert_eq!(fixed.candidates(10, 30), [linear]);
        assert_eq!(fixed.candidates(20, 30)[0].trend, Trend::Constant);
        let kernel = FormSettings { kernel: Some(Kernel::Matern52), trend: None };
        assert_eq!(kernel.candidates(10, 30).len(), 2);
    }
}
