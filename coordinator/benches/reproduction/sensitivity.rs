//! Signs and order of the sensitivities.

use super::study::Finished;
use super::tables::{Tables, head};
use coordinator::results::summary::SensitivityRow;
use std::error::Error;

/// A figure of the publication: which variables mattered, and which way failure goes when their mean or their spread grows.
struct Figure {
    limit_state: &'static str,
    parameter: &'static str,
    scaled: fn(&SensitivityRow) -> f64,
    error: fn(&SensitivityRow) -> f64,
    signs: &'static [(&'static str, f64)],
}

const FIGURES: [Figure; 4] = [
    Figure {
        limit_state: "wear",
        parameter: "mean",
        scaled: |row| row.scaled.d_pf_d_mean,
        error: |row| row.standard_error.d_pf_d_mean / row.d_pf_d_mean,
        signs: &[
            ("wear_coefficient_12", 1.0),
            ("bushing_radius_1", 1.0),
            ("bushing_radius_2", 1.0),
            ("rod_length", 1.0),
            ("journal_modulus_12", -1.0),
            ("rocker_front_length", -1.0),
        ],
    },
    Figure {
        limit_state: "wear",
        parameter: "standard deviation",
        scaled: |row| row.scaled.d_pf_d_std,
        error: |row| row.standard_error.d_pf_d_std / row.d_pf_d_std,
        signs: &[
            ("wear_coefficient_12", -1.0),
            ("bushing_radius_1", -1.0),
            ("bushing_radius_2", -1.0),
            ("rod_length", -1.0),
            ("journal_modulus_12", -1.0),
            ("rocker_front_length", -1.0),
        ],
    },
    Figure {
        limit_state: "asymmetry",
        parameter: "mean",
        scaled: |row| row.scaled.d_pf_d_mean,
        error: |row| row.standard_error.d_pf_d_mean / row.d_pf_d_mean,
        signs: &[
            ("bushing_radius_1", 1.0),
            ("bushing_radius_2", 1.0),
            ("bushing_radius_5", 1.0),
            ("bushing_radius_6", 1.0),
            ("rocker_front_length", 1.0),
            ("rod_length", -1.0),
        ],
    },
    Figure {
        limit_state: "asymmetry",
        parameter: "standard deviation",
        scaled: |row| row.scaled.d_pf_d_std,
        error: |row| row.standard_error.d_pf_d_std / row.d_pf_d_std,
        signs: &[("bushing_radius_5", -1.0), ("bushing_radius_6", -1.0), ("rod_length", -1.0)],
    },
];

/// Twice its standard error from zero.
const CLEAR: f64 = 2.0;

/// Variables of ours that are shown whether they are published or not.
const STRONGEST: usize = 6;

/// Change of the failure probability if the mean grows by one standard deviation, or if the standard deviation doubles (both
/// linearised), at the life where R of the mode is nearest to one half: of the published variables and of our six strongest.
pub fn write(tables: &Tables, study: &Finished) -> Result<(), Box<dyn Error>> {
    let mut table = Vec::new();
    for figure in &FIGURES {
        let cycles = study.half_life(figure.limit_state);
        let rows = study.ranking(figure.limit_state, cycles, figure.scaled);
        for (place, row) in rows.iter().enumerate() {
            let published = figure.signs.iter().find(|(variable, _)| row.variable == *variable);
            if published.is_none() && place >= STRONGEST {
                continue;
            }
            let value = (figure.scaled)(row);
            let error = (value * (figure.error)(row)).abs();
            let (sign, verdict) = match published {
                None => ("", ""),
                Some((_, sign)) if value.abs() < CLEAR * error => (written(*sign), "no sign"),
                Some((_, sign)) if value * sign > 0.0 => (written(*sign), "same sign"),
                Some((_, sign)) => (written(*sign), "OTHER SIGN"),
            };
            table.push(vec![
                figure.limit_state.to_owned(),
                figure.parameter.to_owned(),
                cycles.to_string(),
                row.variable.clone(),
                sign.to_owned(),
                format!("{value:+.4}"),
                format!("{error:.4}"),
                (place + 1).to_string(),
                verdict.to_owned(),
            ]);
        }
    }
    let heads = [
        "limit state",
        "parameter",
        "cycles",
        "variable",
        "published sign",
        "ours",
        "standard error",
        "place",
        "verdict",
    ];
    tables.write("sensitivity", &head(heads), &table)
}

/// A sign as written.
pub fn written(sign: f64) -> &'static str {
    if sign > 0.0 { "+" } else { "-" }
}
