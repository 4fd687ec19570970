//! Limits, clearances and their spread from the tolerance classes of ISO 286, e.g. `H7/e8` at a diameter.
//!
//! A class gives the limits of a diameter as deviations from the nominal one [m]: its letter the limit nearer to the
//! nominal diameter, its grade the width T of the zone between them. For a process of capability C_p the zone is 6 C_p
//! standard deviations wide, with the mean in its middle. Hole and shaft are independent:
//!
//! ```text
//! mean = (lower + upper) / 2,   std = T / (6 C_p)
//! clearance: mean = mean_hole - mean_shaft,   std^2 = std_hole^2 + std_shaft^2
//! ```
//!
//! Valid for diameters up to 500 mm, grades 5 to 11 and the letters below.
//!
//! # Source
//! ISO 286-1:2010, tables 1 (grades), 2 and 3 (holes), 4 and 5 (shafts).

use thiserror::Error;

/// Upper ends of the ranges of nominal sizes, included [mm].
const SIZES: [f64; 13] = [3.0, 6.0, 10.0, 18.0, 30.0, 50.0, 80.0, 120.0, 180.0, 250.0, 315.0, 400.0, 500.0];

/// Widths of the tolerance zone for the grades IT5 to IT11, by range of sizes [um].
const GRADES: [[f64; 13]; 7] = [
    [4.0, 5.0, 6.0, 8.0, 9.0, 11.0, 13.0, 15.0, 18.0, 20.0, 23.0, 25.0, 27.0],
    [6.0, 8.0, 9.0, 11.0, 13.0, 16.0, 19.0, 22.0, 25.0, 29.0, 32.0, 36.0, 40.0],
    [10.0, 12.0, 15.0, 18.0, 21.0, 25.0, 30.0, 35.0, 40.0, 46.0, 52.0, 57.0, 63.0],
    [14.0, 18.0, 22.0, 27.0, 33.0, 39.0, 46.0, 54.0, 63.0, 72.0, 81.0, 89.0, 97.0],
    [25.0, 30.0, 36.0, 43.0, 52.0, 62.0, 74.0, 87.0, 100.0, 115.0, 130.0, 140.0, 155.0],
    [40.0, 48.0, 58.0, 70.0, 84.0, 100.0, 120.0, 140.0, 160.0, 185.0, 210.0, 230.0, 250.0],
    [60.0, 75.0, 90.0, 110.0, 130.0, 160.0, 190.0, 220.0, 250.0, 290.0, 320.0, 360.0, 400.0],
];
/// The first grade of the table.
const LEAST_GRADE: u8 = 5;

/// Shafts below the nominal size: minus their upper deviation [um].
const BELOW: [(&str, [f64; 13]); 5] = [
    ("d", [20.0, 30.0, 40.0, 50.0, 65.0, 80.0, 100.0, 120.0, 145.0, 170.0, 190.0, 210.0, 230.0]),
    ("e", [14.0, 20.0, 25.0, 32.0, 40.0, 50.0, 60.0, 72.0, 85.0, 100.0, 110.0, 125.0, 135.0]),
    ("f", [6.0, 10.0, 13.0, 16.0, 20.0, 25.0, 30.0, 36.0, 43.0, 50.0, 56.0, 62.0, 68.0]),
    ("g", [2.0, 4.0, 5.0, 6.0, 7.0, 9.0, 10.0, 12.0, 14.0, 15.0, 17.0, 18.0, 20.0]),
    ("h", [0.0; 13]),
];

/// Shafts above the nominal size: their lower deviation [um]. That of k holds for IT4 to IT7; for others it is 0.
const ABOVE: [(&str, [f64; 13]); 4] = [
    ("k", [0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.0, 3.0, 4.0, 4.0, 4.0, 5.0]),
    ("m", [2.0, 4.0, 6.0, 7.0, 8.0, 9.0, 11.0, 13.0, 15.0, 17.0, 20.0, 21.0, 23.0]),
    ("n", [4.0, 8.0, 10.0, 12.0, 15.0, 17.0, 20.0, 23.0, 27.0, 31.0, 34.0, 37.0, 40.0]),
    ("p", [6.0, 12.0, 15.0, 18.0, 22.0, 26.0, 32.0, 37.0, 43.0, 50.0, 56.0, 62.0, 68.0]),
];

/// Upper ends of the ranges of sizes for r and s, which are finer above 50 mm [mm].
const FINE_SIZES: [f64; 22] = [
    3.0, 6.0, 10.0, 18.0, 30.0, 50.0, 65.0, 80.0, 100.0, 120.0, 140.0, 160.0, 180.0, 200.0, 225.0, 250.0,
    280.0, 315.0, 355.0, 400.0, 450.0, 500.0,
];

/// Lower deviations of r and s [um].
const FAR_ABOVE: [(&str, [f64; 22]); 2] = [("r", R), ("s", S)];
/// Those of r [um].
const R: [f64; 22] = [
    10.0, 15.0, 19.0, 23.0, 28.0, 34.0, 41.0, 43.0, 51.0, 54.0, 63.0, 65.0, 68.0, 77.0, 80.0, 84.0, 94.0,
    98.0, 108.0, 114.0, 126.0, 132.0,
];
/// Those of s [um].
const S: [f64; 22] = [
    14.0, 19.0, 23.0, 28.0, 35.0, 43.0, 53.0, 59.0, 71.0, 79.0, 92.0, 100.0, 108.0, 122.0, 130.0, 140.0,
    158.0, 170.0, 190.0, 208.0, 232.0, 252.0,
];

/// Letters of holes.
const HOLES: &str = "D, E, F, G, H, JS";
/// Letters of shafts.
const SHAFTS: &str = "d, e, f, g, h, js, k, m, n, p, r, s";

/// Micrometres per metre.
const MICRO: f64 = 1e6;
/// Millimetres per metre.
const MILLI: f64 = 1e3;

/// The part that a tolerance class belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feature {
    /// A hole; its class has a capital letter.
    Hole,
    /// A shaft; its class has a small letter.
    Shaft,
}

/// Faults of a class, a fit or a diameter.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ToleranceError {
    /// A text that is not a letter and a grade of the tables. Holds the class as written.
    #[error(
        "\"{0}\" is not a tolerance class, allowed: a letter of a hole ({HOLES}) or of a shaft ({SHAFTS}) and a grade 5 to 11, e.g. H7"
    )]
    Class(String),
    /// A text that is not the classes of a hole and a shaft. Holds the fit as written.
    #[error("\"{0}\" is not a fit, allowed: a hole and a shaft, e.g. H7/e8")]
    Fit(String),
    /// A diameter outside the tables. Holds the nominal diameter [mm].
    #[error("a diameter of {0} mm is outside the tables, allowed: > 0 and <= 500 mm")]
    Diameter(f64),
    /// A fit whose shaft may be as large as its hole. Holds the fit as written, the nominal diameter [mm], and the mean and three standard
    /// deviations of the diametral clearance [um].
    #[error(
        "{0} at {1} mm has a clearance of {2:.1} +- {3:.1} um (three standard deviations): the shaft may be larger than the hole; use a looser fit, e.g. H7/e8"
    )]
    NoClearance(String, f64, f64, f64),
}

/// A tolerance class, e.g. `H7`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ToleranceClass {
    /// The part that the class belongs to.
    pub feature: Feature,
    /// The letter, in lower case.
    letter: String,
    grade: u8,
}

impl ToleranceClass {
    /// Reads a class: D, E, F, G, H or JS for holes, d, e, f, g, h, js, k, m, n, p, r or s for shafts; grades 5 to 11.
    ///
    /// # Errors
    /// [`ToleranceError::Class`] for any other text.
    pub fn parse(class: &str) -> Result<Self, ToleranceError> {
        let refused = || ToleranceError::Class(class.to_owned());
        let split = class.find(|c: char| c.is_ascii_digit()).ok_or_else(refused)?;
        let (letter, grade) = class.split_at(split);
        let is = |list: &str| list.split(", ").any(|known| known == letter);
        let feature = match (is(HOLES), is(SHAFTS)) {
            (true, _) => Feature::Hole,
            (_, true) => Feature::Shaft,
            _ => return Err(refused()),
        };
        let grade = grade.parse().map_err(|_| refused())?;
        if !(LEAST_GRADE..LEAST_GRADE + GRADES.len() as u8).contains(&grade) {
            return Err(refused());
        }
        Ok(Self { feature, letter: letter.to_lowercase(), grade })
    }

    /// Lower and upper limit deviation from a nominal `diameter` [m], in (0, 0.5] m: `(lower, upper)` [m].
    ///
    /// # Errors
    /// [`ToleranceError::Diameter`].
    pub fn deviations(&self, diameter: f64) -> Result<(f64, f64), ToleranceError> {
        let size = diameter * MILLI;
        let outside = || ToleranceError::Diameter(size);
        // A size that exceeds the end of a range by a rounding error belongs to that range.
        let range =
            |ends: &[f64]| ends.iter().position(|end| size <= end * (1.0 + 1e-12)).ok_or_else(outside);
        if !(size > 0.0 && size.is_finite()) {
            return Err(outside());
        }
        let i = range(&SIZES)?;
        let width = GRADES[usize::from(self.grade - LEAST_GRADE)][i];
        let in_table =
            |table: &[(&str, [f64; 13])]| table.iter().find(|row| row.0 == self.letter).map(|row| row.1[i]);
        let (lower, upper) = if self.letter == "js" {
            (-0.5 * width, 0.5 * width)
        } else if let Some(gap) = in_table(&BELOW) {
            (-gap - width, -gap)
        } else {
            let fine = range(&FINE_SIZES)?;
            let far = FAR_ABOVE.iter().find(|row| row.0 == self.letter).map(|row| row.1[fine]);
            let above = in_table(&ABOVE).or(far).expect("every letter of a shaft has a table");
            let above = if self.letter == "k" && self.grade > 7 { 0.0 } else { above };
            (above, above + width)
        };
        // Holes D to H mirror the shafts of their letter.
        Ok(match self.feature {
            Feature::Hole => (-upper / MICRO, -lower / MICRO),
            Feature::Shaft => (lower / MICRO, upper / MICRO),
        })
    }

    /// Mean deviation from the nominal `diameter` [m] and standard deviation, `(mean, std)` [m], for a process of the
    /// `capability` C_p [1].
    ///
    /// # Errors
    /// [`ToleranceError::Diameter`].
    pub fn moments(&self, diameter: f64, capability: f64) -> Result<(f64, f64), ToleranceError> {
        let (lower, upper) = self.deviations(diameter)?;
        Ok((0.5 * (lower + upper), (upper - lower) / (6.0 * capability)))
    }
}

/// Mean and standard deviation of the diametral clearance, hole minus shaft, of a `fit` such as `H7/e8`, the classes of a hole and a shaft
/// separated by `/`, at a nominal `diameter` [m], for processes of the `capability` C_p [1]: `(mean, std)` [m].
///
/// # Errors
/// [`ToleranceError`]; [`ToleranceError::NoClearance`] if mean - 3 std <= 0.
pub fn clearance_of_fit(fit: &str, diameter: f64, capability: f64) -> Result<(f64, f64), ToleranceError> {
    let refused = || ToleranceError::Fit(fit.to_owned());
    let (hole, shaft) = fit.split_once('/').ok_or_else(refused)?;
    let (hole, shaft) = (ToleranceClass::parse(hole.trim())?, ToleranceClass::parse(shaft.trim())?);
    if (hole.feature, shaft.feature) != (Feature::Hole, Feature::Shaft) {
        return Err(refused());
    }
    let (hole, hole_std) = hole.moments(diameter, capability)?;
    let (shaft, shaft_std) = shaft.moments(diameter, capability)?;
    let (mean, std) = (hole - shaft, hole_std.hypot(shaft_std));
    if mean - 3.0 * std <= 0.0 {
        let (diameter, spread) = (diameter * MILLI, 3.0 * std * MICRO);
        return Err(ToleranceError::NoClearance(fit.to_owned(), diameter, mean * MICRO, spread));
    }
    Ok((mean, std))
}

#[cfg(test)]
mod tests;
