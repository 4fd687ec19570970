//! The tables of the comparison, a CSV file each in one folder.

use std::error::Error;
use std::path::PathBuf;

/// The folder of the tables, and the single numbers that follow from them.
pub struct Tables {
    folder: PathBuf,
    derived: Vec<Vec<String>>,
}

impl Tables {
    /// Tables of a folder, which is created if it is missing.
    pub fn in_folder(folder: &str) -> Result<Self, Box<dyn Error>> {
        std::fs::create_dir_all(folder)?;
        Ok(Self { folder: PathBuf::from(folder), derived: Vec::new() })
    }

    /// Writes the table `NAME.csv`.
    pub fn write(&self, name: &str, head: &[String], rows: &[Vec<String>]) -> Result<(), Box<dyn Error>> {
        let mut file = csv::Writer::from_path(self.folder.join(format!("{name}.csv")))?;
        file.write_record(head)?;
        for row in rows {
            file.write_record(row)?;
        }
        Ok(file.flush()?)
    }

    /// A single number of the table `derived.csv`, which [`Tables::finish`] writes.
    pub fn derive(&mut self, quantity: &str, (value, decimals): (f64, usize), unit: &str) {
        self.derived.push(vec![quantity.to_owned(), format!("{value:.decimals$}"), unit.to_owned()]);
    }

    /// Writes the single numbers.
    pub fn finish(self) -> Result<(), Box<dyn Error>> {
        self.write("derived", &head(["quantity", "value", "unit"]), &self.derived)
    }
}

/// Heads of columns.
pub fn head<const N: usize>(names: [&str; N]) -> Vec<String> {
    names.map(str::to_owned).to_vec()
}

/// A number with decimals; an empty cell for none.
pub fn cell(value: Option<f64>, decimals: usize) -> String {
    value.map_or(String::new(), |value| format!("{value:.decimals$}"))
}
