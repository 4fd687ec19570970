//! Cost of a quantity of a design: of a tolerance, of a spread or of a mean.
//!
//! | model | cost of t | |
//! |---|---|---|
//! | reciprocal power | c0 + c1 / t^k | c1 > 0, k > 0: a tolerance costs more the narrower it is |
//! | exponential | c0 + c1 exp(-k t) | c1 > 0, k > 0 |
//! | linear | c0 + c1 t | of a mean, e.g. the mass of a dimension |
//! | table | between given points by a monotone cubic | constant beyond its ends |
//!
//! # Source
//! Reciprocal power and exponential: Chase, Greenwood, Loosli, Hauglund (1990), Least cost tolerance allocation for
//! mechanical assemblies with automated process selection, Manufacturing Review 3(1). Table: Fritsch, Carlson (1980),
//! Monotone piecewise cubic interpolation, SIAM Journal on Numerical Analysis 17(2), with the weighted harmonic mean of
//! Fritsch, Butland (1984), SIAM Journal on Scientific and Statistical Computing 5(2).

use common::scene::monotone::fritsch_butland;

/// Cost as a function of a quantity t [chosen unit].
#[derive(Debug, Clone, PartialEq)]
pub enum CostModel {
    /// c0 + c1 / t^k.
    ReciprocalPower {
        /// Fixed cost c0.
        c0: f64,
        /// Cost c1 at t = 1, above the fixed one.
        c1: f64,
        /// Exponent k [1].
        k: f64,
    },
    /// c0 + c1 exp(-k t).
    Exponential {
        /// Fixed cost c0.
        c0: f64,
        /// Cost c1 at t = 0, above the fixed one.
        c1: f64,
        /// Rate k [1/unit of t].
        k: f64,
    },
    /// c0 + c1 t.
    Linear {
        /// Fixed cost c0.
        c0: f64,
        /// Cost c1 per unit of t.
        c1: f64,
    },
    /// A monotone cubic through points.
    Table(CostTable),
}

/// Points (t, cost) joined by a cubic that has no extremum between them.
#[derive(Debug, Clone, PartialEq)]
pub struct CostTable {
    t: Vec<f64>,
    cost: Vec<f64>,
    slope: Vec<f64>,
}

impl CostTable {
    /// A table of `points` (t, cost) with ascending t.
    ///
    /// # Errors
    /// Why the points give no cost, in words.
    pub fn new(points: &[(f64, f64)]) -> Result<Self, String> {
        if points.len() < 2 {
            return Err(format!("{} points, expected at least 2", points.len()));
        }
        if let Some(pair) = points.windows(2).find(|pair| pair[1].0 <= pair[0].0 || pair[1].0.is_nan()) {
            return Err(format!("{} follows {}, expected places in ascending order", pair[1].0, pair[0].0));
        }
        let (t, cost): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        let width: Vec<f64> = t.windows(2).map(|t| t[1] - t[0]).collect();
        let chord: Vec<f64> = cost.windows(2).zip(&width).map(|(c, h)| (c[1] - c[0]) / h).collect();
        let last = chord.len() - 1;
        // Slope at a point: weighted harmonic mean of the chords beside it; zero at an extremum of the points.
        let inner = |i: usize| fritsch_butland([width[i - 1], width[i]], [chord[i - 1], chord[i]]);
        let slope = [chord[0]].into_iter().chain((1..=last).map(inner)).chain([chord[last]]).collect();
        Ok(Self { t, cost, slope })
    }

    fn at(&self, t: f64) -> (f64, f64) {
        let last = self.t.len() - 1;
        if t <= self.t[0] {
            return (self.cost[0], if t == self.t[0] { self.slope[0] } else { 0.0 });
        }
        if t >= self.t[last] {
            return (self.cost[last], if t == self.t[last] { self.slope[last] } else { 0.0 });
        }
        let i = self.t.partition_point(|place| *place <= t) - 1;
        let h = self.t[i + 1] - self.t[i];
        let s = (t - self.t[i]) / h;
        let (a, b) = (self.cost[i], self.cost[i + 1]);
        let (da, db) = (self.slope[i] * h, self.slope[i + 1] * h);
        let (p, q) = (3.0 * (b - a) - 2.0 * da - db, da + db - 2.0 * (b - a));
        (a + s * (da + s * (p + s * q)), (da + s * (2.0 * p + 3.0 * s * q)) / h)
    }
}

impl CostModel {
    /// Cost at `t` and its derivative [1/unit of t].
    pub fn at(&self, t: f64) -> (f64, f64) {
        match self {
            Self::ReciprocalPower { c0, c1, k } => {
                let varied = c1 / t.powf(*k);
                (c0 + varied, -k * varied / t)
            }
            Self::Exponential { c0, c1, k } => {
                let varied = c1 * (-k * t).exp();
                (c0 + varied, -k * varied)
            }
            Self::Linear { c0, c1 } => (c0 + c1 * t, *c1),
            Self::Table(table) => table.at(t),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_costs() {
        let table = CostTable::new(&[(1.0, 9.0), (2.0, 4.0), (3.0, 3.5), (5.0, 1.0)]).unwrap();
        let models = [
            CostModel::ReciprocalPower { c0: 1.0, c1: 2.0, k: 1.5 },
            CostModel::Exponential { c0: 1.0, c1: 2.0, k: 0.5 },
            CostModel::Linear { c0: 1.0, c1: -2.0 },
            CostModel::Table(table.clone()),
        ];
        for model in models {
            for t in [1.3, 2.7, 4.9] {
                let h = 1e-6;
                let numerical = (model.at(t + h).0 - model.at(t - h).0) / (2.0 * h);
                assert!((model.at(t).1 - numerical).abs() < 1e-7, "{model:?} {t}");
            }
        }
        // A table passes through its points, falls between them and is constant beyond.
        let cost = |t: f64| table.at(t).0;
        assert_eq!([cost(0.5), cost(2.0), cost(9.0)], [9.0, 4.0, 1.0]);
        assert!((0..400).all(|i| cost(1.0 + 0.01 * f64::from(i + 1)) < cost(1.0 + 0.01 * f64::from(i))));
    }

    #[test]
    fn tables_need_ascending_points() {
        assert_eq!(CostTable::new(&[(1.0, 2.0)]), Err("1 points, expected at least 2".to_owned()));
        let twice = CostTable::new(&[(1.0, 2.0), (1.0, 1.0)]);
        assert_eq!(twice, Err("1 follows 1, expected places in ascending order".to_owned()));
    }
}
