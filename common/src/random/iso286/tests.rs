//! Published limits, and the tables against the formulae that the standard made them by.

use super::*;

/// Limits in um at a diameter in mm.
fn limits(class: &str, diameter: f64) -> (f64, f64) {
    let (lower, upper) = ToleranceClass::parse(class).unwrap().deviations(diameter / MILLI).unwrap();
    let round = |deviation: f64| (deviation * MICRO * 10.0).round() / 10.0;
    (round(lower), round(upper))
}

#[test]
fn published_limits() {
    for (class, diameter, lower, upper) in [
        ("H7", 25.0, 0.0, 21.0),
        ("e8", 25.0, -73.0, -40.0),
        ("g6", 40.0, -25.0, -9.0),
        ("k6", 10.0, 1.0, 10.0),
        ("p6", 100.0, 37.0, 59.0),
        ("f7", 25.0, -41.0, -20.0),
        ("h6", 30.0, -13.0, 0.0),
        ("H8", 50.0, 0.0, 39.0),
        ("F8", 25.0, 20.0, 53.0),
        ("G7", 40.0, 9.0, 34.0),
        ("D10", 20.0, 65.0, 149.0),
        ("E9", 3.0, 14.0, 39.0),
        ("s6", 60.0, 53.0, 72.0),
        ("r6", 70.0, 43.0, 62.0),
        ("n6", 25.0, 15.0, 28.0),
        ("m6", 25.0, 8.0, 21.0),
        ("k8", 25.0, 0.0, 33.0),
        ("js7", 25.0, -10.5, 10.5),
        ("JS6", 10.0, -4.5, 4.5),
        ("H11", 500.0, 0.0, 400.0),
        ("d9", 18.0, -93.0, -50.0),
        ("d9", 18.1, -117.0, -65.0),
    ] {
        assert_eq!(limits(class, diameter), (lower, upper), "{diameter} {class}");
    }
}

/// The geometric mean of the ends of every range, as the standard's formulae want it [mm], but of the first range,
/// whose values the standard rounded in ways of its own.
fn middles(ends: &[f64]) -> impl Iterator<Item = (usize, f64)> + '_ {
    (1..ends.len()).map(|i| (i, (ends[i - 1] * ends[i]).sqrt()))
}

/// A value and its formula differ by rounding and smoothing: 3 %, or 1.2 um.
fn near(letter: &str, range: usize, found: f64, exact: f64) {
    let within = 1.2_f64.max(0.03 * exact);
    assert!((found - exact).abs() <= within, "{letter}, range {range}: {found} for {exact}");
}

/// ISO 286-1:1988, annex A: IT6 = 10 i, ..., IT11 = 100 i with i = 0.45 D^(1/3) + 0.001 D [um], IT5 = 7 i, then rounded.
#[test]
fn grades_follow_the_tolerance_unit() {
    for (g, factor) in [7.0, 10.0, 16.0, 25.0, 40.0, 64.0, 100.0].into_iter().enumerate() {
        for (range, d) in middles(&SIZES) {
            near(&format!("IT{}", g + 5), range, GRADES[g][range], factor * (0.45 * d.cbrt() + 0.001 * d));
        }
    }
}

/// ISO 286-1:1988, annex A: d = 16 D^0.44, e = 11 D^0.41, f = 5.5 D^0.41, g = 2.5 D^0.34, k = 0.6 D^(1/3), m = IT7 - IT6,
/// n = 5 D^0.34, p = IT7 + 0 to 5, s = IT8 + 1 to 4 up to 50 mm, then IT7 + 0.4 D, r the geometric mean of p and s.
#[test]
fn deviations_follow_their_formulae() {
    let row = |letter: &str| BELOW.iter().chain(&ABOVE).find(|row| row.0 == letter).unwrap().1;
    for (range, d) in middles(&SIZES) {
        let powers =
            [("d", 16.0, 0.44), ("e", 11.0, 0.41), ("f", 5.5, 0.41), ("g", 2.5, 0.34), ("n", 5.0, 0.34)];
        for (letter, factor, power) in powers {
            near(letter, range, row(letter)[range], factor * d.powf(power));
        }
        assert!((row("k")[range] - 0.6 * d.cbrt()).abs() < 0.5, "k, range {range}");
        assert_eq!(row("m")[range], GRADES[2][range] - GRADES[1][range], "m, range {range}");
        let over = row("p")[range] - GRADES[2][range];
        assert!((0.0..=5.0).contains(&over), "p, range {range}: {over}");
    }
    for (fine, d) in middles(&FINE_SIZES) {
        let range = SIZES.iter().position(|end| d <= *end).unwrap();
        let (r, s) = (FAR_ABOVE[0].1[fine], FAR_ABOVE[1].1[fine]);
        if d <= 50.0 {
            let over = s - GRADES[3][range];
            assert!((1.0..=4.0).contains(&over), "s, range {fine}: {over}");
        } else {
            near("s", fine, s, GRADES[2][range] + 0.4 * d);
        }
        near("r", fine, r, (row("p")[range] * s).sqrt());
    }
}

#[test]
fn a_fit_has_the_clearance_of_its_limits() {
    let (mean, std) = clearance_of_fit("H7/e8", 0.025, 1.0).unwrap();
    assert!((mean * MICRO - (10.5 + 56.5)).abs() < 1e-9);
    assert!((std * MICRO - (3.5_f64.powi(2) + 5.5_f64.powi(2)).sqrt()).abs() < 1e-9);
    let (same, finer) = clearance_of_fit("H7/e8", 0.025, 1.33).unwrap();
    assert!((same - mean).abs() < 1e-18 && (finer * 1.33 / std - 1.0).abs() < 1e-12);
}

#[test]
fn what_is_no_fit_is_refused() {
    for (fit, expected) in [
        ("H7", "\"H7\" is not a fit"),
        ("e8/H7", "\"e8/H7\" is not a fit"),
        ("H7/e12", "\"e12\" is not a tolerance class"),
        ("H7/e", "\"e\" is not a tolerance class"),
        ("K7/e8", "\"K7\" is not a tolerance class"),
        ("H4/e8", "grade 5 to 11"),
    ] {
        let found = clearance_of_fit(fit, 0.025, 1.0).unwrap_err().to_string();
        assert!(found.contains(expected), "{fit}: {found}");
    }
    for (fit, diameter, expected) in [
        ("H7/e8", 0.6, "a diameter of 600 mm is outside the tables"),
        ("H7/e8", 0.0, "a diameter of 0 mm"),
        ("H7/p6", 0.1, "H7/p6 at 100 mm has a clearance of -30.5 +- 20.7 um"),
    ] {
        let found = clearance_of_fit(fit, diameter, 1.0);
        assert!(found.unwrap_err().to_string().contains(expected), "{fit} {diameter}");
    }
    // Limits that touch, but three standard deviations that do not.
    let (mean, std) = clearance_of_fit("H7/h6", 0.025, 1.0).unwrap();
    assert!((mean * MICRO - 17.0).abs() < 1e-9 && (3.0 * std * MICRO - 12.35).abs() < 0.01);
}
