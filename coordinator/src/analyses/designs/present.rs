//! The design that the scene itself has, and how the distributions of its random variables follow the design variables.

use super::space::{DesignSpace, DesignVariable};
use common::scene::{Faults, Scene, SceneSource};

/// Relative deviation of a moment from a straight line over the range of a design variable that counts as none [1].
const STRAIGHT: f64 = 1e-6;

/// A random variable whose mean or standard deviation follows a design variable.
#[derive(Debug, Clone, PartialEq)]
pub struct Follower {
    /// Index of the random variable that stands for the design variable.
    pub leader: usize,
    /// Index of the random variable that follows it.
    pub variable: usize,
    /// Change of its mean over that of the design variable [SI/SI].
    pub mean: f64,
    /// Change of its standard deviation over that of the design variable [SI/SI].
    pub std: f64,
    /// Whether mean and standard deviation follow along straight lines.
    pub is_straight: bool,
}

impl DesignSpace {
    /// The design of the scene itself, with the values of `settings` (`KEY=VALUE`) at those keys that are design variables and
    /// quantities of the scene; and the other settings.
    ///
    /// # Errors
    /// Values that cannot be read, and the faults of the design.
    pub fn present(&self, settings: &[String]) -> Result<(SceneSource, Vec<String>), Faults> {
        let space = self.only_quantities();
        let mut others = settings.to_vec();
        let value = |variable: &DesignVariable| {
            let is_own =
                |setting: &String| setting.split_once('=').is_some_and(|(key, _)| key.trim() == variable.key);
            let si = match others.iter().position(is_own).map(|i| others.remove(i)) {
                Some(setting) => Some(self.base.parse_setting(&setting)?.1),
                None => self.base.quantity(&variable.key),
            };
            // Units have factors; none has an offset.
            let (_, unit) = self.base.parse_setting(&variable.setting(1.0))?;
            let value = si.map_or_else(|| variable.at(0.5), |si| si / unit);
            Ok(format!("{value:.12e}").parse().unwrap_or(value))
        };
        let values: Vec<f64> = space.variables.iter().map(value).collect::<Result<_, Faults>>()?;
        Ok((space.with_constants(&values)?, others))
    }

    /// The space of those design variables alone that are quantities of the scene.
    fn only_quantities(&self) -> Self {
        let kept = self.variables.iter().filter(|variable| variable.added.is_some()).cloned();
        Self { base: self.base.clone(), variables: kept.collect() }
    }

    /// The keys of those design variables that are quantities of the scene, with the random variable, an index and a name, that
    /// stands for each in the augmented scene, and the range.
    pub fn quantities(&self) -> Vec<(&DesignVariable, usize, &str)> {
        let first = self.base.variables().len();
        let named = self.variables.iter().filter_map(|variable| Some((variable, variable.added.as_deref()?)));
        named.enumerate().map(|(i, (variable, name))| (variable, first + i, name)).collect()
    }

    /// The random variables that follow design variables.
    ///
    /// # Errors
    /// Faults of designs at the ends of the ranges.
    pub fn followers(&self) -> Result<Vec<Follower>, Faults> {
        let space = self.only_quantities();
        let middle = space.scene_at(&space.middle())?;
        let moments = |scene: &Scene, k: usize| {
            let law = &scene.variables[k].distribution;
            [law.parent_mean(), law.given_std()]
        };
        let mut found = Vec::new();
        for ((_, leader, _), [low, high]) in space.quantities().into_iter().zip(space.ends()?) {
            let range = moments(&high, leader)[0] - moments(&low, leader)[0];
            for variable in 0..space.base.variables().len() {
                let [a, b, c] = [&low, &middle, &high].map(|scene| moments(scene, variable));
                let [along_mean, along_std] = [0, 1].map(|i| {
                    let (a, b, c) = (a[i], b[i], c[i]);
                    let least = STRAIGHT * a.abs().max(c.abs());
                    ((c - a) / range, (0.5 * (a + c) - b).abs() <= least, (c - a).abs() > least)
                });
                if along_mean.2 || along_std.2 {
                    let (mean, std, is_straight) = (along_mean.0, along_std.0, along_mean.1 && along_std.1);
                    found.push(Follower { leader, variable, mean, std, is_straight });
                }
            }
        }
        Ok(found)
    }
}
