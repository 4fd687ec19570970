//! Signs and order of the sensitivities.

use super::study::Finished;
use coordinator::results::summary::SensitivityRow;
use std::fmt::Write;

/// A figure of the publication: which variables mattered, and which way failure goes when their mean or their spread grows.
struct Figure {
    limit_state: &'static str,
    parameter: &'static str,
    scaled: fn(&SensitivityRow) -> f64,
    error: fn(&SensitivityRow) -> f64,
    signs: &'static [(&'static str, f64)],
    why: &'static str,
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
        why: "The largest wear is determined by the wear coefficient, the width and the load of joints 1 and \
              2; that wear coefficient has the \
              spread that the published curve of R asks for, so all other effects are small in comparison. The width is not among the published six.",
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
        why: "A wider spread lowers the failure probability where R is below a half and raises it above: the \
              sign belongs to the life, not to the \
              variable. The rest is no larger than the random scatter of thirty estimates around zero.",
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
        why: "The asymmetry of this reconstruction is a vibration of the left rocker that grows in joint 4: its \
              bore, the load and the friction decide when, and the lengths hardly matter. The published order is \
              that of the kinematic difference between the two sides, which exists from the first cycle. This is \
              the largest difference between the two models ([more](#could-the-asymmetry-be-kinematic)).",
    },
    Figure {
        limit_state: "asymmetry",
        parameter: "standard deviation",
        scaled: |row| row.scaled.d_pf_d_std,
        error: |row| row.standard_error.d_pf_d_std / row.d_pf_d_std,
        signs: &[("bushing_radius_5", -1.0), ("bushing_radius_6", -1.0), ("rod_length", -1.0)],
        why: "As above, the sign belongs to the life: more spread means more failures where R is above one half, and fewer where it is below.",
    },
];

/// Twice its standard error from zero.
const CLEAR: f64 = 2.0;

/// The section.
pub fn write(out: &mut String, study: &Finished) -> std::fmt::Result {
    writeln!(out, "## Sensitivity\n")?;
    writeln!(
        out,
        "Change of the failure probability if the mean grows by one standard deviation, or if the standard \
         deviation doubles (both linearised), at the life where R of the mode is nearest to one half, and \
         rank among the thirty variables. The publication lists six variables (three for the standard \
         deviations of the asymmetry) as the strongest, with their signs, without the life. Differences below two standard errors have no sign.\n"
    )?;
    for figure in &FIGURES {
        let cycles = study.half_life(figure.limit_state);
        let rows = study.ranking(figure.limit_state, cycles, figure.scaled);
        writeln!(out, "### {}, {}, at {cycles} cycles\n", capital(figure.limit_state), figure.parameter)?;
        writeln!(
            out,
            "| variable | published sign | ours | standard error | place | |\n|---|---|---|---|---|---|"
        )?;
        for (variable, sign) in figure.signs {
            let place = rows.iter().position(|row| row.variable == *variable).ok_or(std::fmt::Error)?;
            let value = (figure.scaled)(rows[place]);
            let error = (value * (figure.error)(rows[place])).abs();
            let verdict = if value.abs() < CLEAR * error {
                "no sign"
            } else if value * sign > 0.0 {
                "same sign"
            } else {
                "OTHER SIGN"
            };
            let sign = if *sign > 0.0 { "+" } else { "-" };
            writeln!(
                out,
                "| `{variable}` | {sign} | {value:+.4} | {error:.4} | {} | {verdict} |",
                place + 1
            )?;
        }
        let strongest: Vec<String> = rows
            .iter()
            .take(6)
            .map(|row| format!("`{}` ({:+.3})", row.variable, (figure.scaled)(row)))
            .collect();
        writeln!(out, "\nOurs in order: {}. {}\n", strongest.join(", "), figure.why)?;
    }
    Ok(())
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
