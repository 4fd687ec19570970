//! Own samples of the random variables of a scene, from a CSV file: a column for every variable under its name, in the unit of its head, or in SI
//! without one. Further columns are left out.

use super::csv_file::{CsvColumn, CsvFile};
use super::expression::read_unit;
use super::faults::{Fault, Faults};
use crate::random::RandomVariable;

/// The samples `(n, d)` [SI] in the text of a CSV file, in the order of its rows.
///
/// # Errors
/// A variable without a column, and cells that are no values of their variable, each with its place.
pub fn samples_of(variables: &[RandomVariable], file: &str, text: &str) -> Result<Vec<Vec<f64>>, Faults> {
    let csv = CsvFile::read(file, text, "samples")?;
    let (mut faults, mut columns) = (Vec::new(), Vec::new());
    for variable in variables {
        match values(&csv, variable, (file, text)) {
            Ok(values) => columns.push(values),
            Err(Faults(more)) => faults.extend(more),
        }
    }
    if !faults.is_empty() {
        return Err(Faults(faults));
    }
    let count = columns.first().map_or(0, Vec::len);
    Ok((0..count).map(|row| columns.iter().map(|column| column[row]).collect()).collect())
}

/// The values of a variable [SI].
fn values(csv: &CsvFile, variable: &RandomVariable, (file, text): (&str, &str)) -> Result<Vec<f64>, Faults> {
    let RandomVariable { name, distribution, unit: own, .. } = variable;
    let column = csv.find(name).map_err(|kind| Faults::one(file, name, kind))?;
    let CsvColumn { unit, unit_span, numbers, spans, .. } = csv.column(column, name)?;
    let si = match &unit {
        None => 1.0,
        Some(unit) => match (read_unit(unit), read_unit(own)) {
            (Ok(found), Ok(own)) if found.dimension == own.dimension => found.multiply / found.divide,
            // A text that is no unit of this program leaves the number as it is.
            (_, Err(_)) if unit == own => 1.0,
            _ => {
                let what = format!("is in {unit}, which is no unit of variable {name} ({own})");
                return Err(Faults(vec![Fault::at(file, text, unit_span, name, what)]));
            }
        },
    };
    let (lower, upper) = distribution.support();
    let values: Vec<f64> = numbers.into_iter().map(|number| number * si).collect();
    let outside = values.iter().zip(&spans).filter(|(value, _)| !(lower..=upper).contains(*value));
    let fault = |(value, span): (&f64, &std::ops::Range<usize>)| {
        // Nine digits, without those of the conversion.
        let shown = |of: f64| format!("{:.8e}", of / si).parse().unwrap_or(of);
        let [value, lower, upper] = [*value, lower, upper].map(shown);
        let unit = match &unit {
            Some(unit) => format!(" {unit}"),
            None if own == "1" || read_unit(own).is_err() => String::new(),
            None => " in SI".to_owned(),
        };
        let what = format!("{value}{unit} lies outside of the distribution, {lower} to {upper}{unit}");
        Fault::at(file, text, span.clone(), name, what)
    };
    let faults: Vec<Fault> = outside.map(fault).collect();
    if faults.is_empty() { Ok(values) } else { Err(Faults(faults)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneSource;

    #[test]
    fn samples_have_the_units_of_their_heads() {
        let text = "scene = { name = \"s\" }\nsimulator = { program = [\"s\"] }\noutputs = [{ name = \"a\" }]\n\
            variables = [{ name = \"gap\", distribution = \"uniform\", lower = \"10 um\", upper = \"50 um\" }, \
            { name = \"x\", distribution = \"uniform\", lower = 0, upper = 1, unit = \"m/year\" }]\n\
            limit_states = [{ name = \"w\", output = \"a\", threshold = 1 }]";
        let source = SceneSource::parse(text, "s").unwrap_or_else(|faults| panic!("{faults}"));
        let read =
            |csv: &str| samples_of(source.variables(), "doe.csv", csv).map_err(|faults| faults.to_string());
        let close = |x: f64, y: f64| (x / y - 1.0).abs() < 1e-12;
        let found = read("x,note,gap [um]\n0.25,1,30\n0.5,2,31\n").unwrap();
        assert!(
            close(found[0][0], 30e-6)
                && close(found[1][0], 31e-6)
                && [found[0][1], found[1][1]] == [0.25, 0.5]
        );
        for head in ["gap,x", "gap,x [m/year]"] {
            assert_eq!(read(&format!("{head}\n3e-5,0.25\n")).unwrap(), [[3e-5, 0.25]]);
        }
        for (csv, said) in [
            ("x;gop\n0.25;30\n", "there is no column \"gap\", did you mean \"gop\"?"),
            ("x,gap [N]\n0.25,30\n", "is in N, which is no unit of variable gap"),
            ("x,gap [um]\n0.25,30\n1.5,30\n", "1.5 lies outside of the distribution, 0 to 1"),
            ("x,gap [um]\n0.25,51\n", "51 um lies outside of the distribution, 10 to 50 um"),
            ("x,gap\n0.25,51\n", "51 in SI lies outside of the distribution, 0.00001 to 0.00005 in SI"),
        ] {
            let found = read(csv).unwrap_err();
            assert!(found.contains(said) && found.contains("doe.csv"), "{found}");
        }
    }
}
