//! What is read from finished studies.

use coordinator::presentation::report::SUMMARY_DOCUMENT;
use coordinator::results::life_summary::LifeRow;
use coordinator::results::store::CampaignFile;
use coordinator::results::summary::{ReliabilityRow, SensitivityRow, StudySummary};
use std::error::Error;
use std::path::Path;

/// A study and what it is called.
pub struct Finished {
    pub name: String,
    pub summary: StudySummary,
}

impl Finished {
    pub fn open(name: &str, dir: &str) -> Result<Self, Box<dyn Error>> {
        let summary = CampaignFile::open(Path::new(dir))?.document(SUMMARY_DOCUMENT)?;
        let summary = summary.ok_or_else(|| format!("{dir}: the study is not finished"))?;
        Ok(Self { name: name.to_owned(), summary })
    }

    /// R of a limit state, or of `total`.
    pub fn reliability(&self, key: &str, cycles: u32) -> Option<f64> {
        let row = self.summary.reliability.iter().find(|row| row.cycles == cycles)?;
        row.reliability.get(key).copied()
    }

    /// Life at which R of the system reaches `level` [1] and the bounds of its interval, in thousands of cycles.
    pub fn life(&self, level: f64) -> Option<[f64; 3]> {
        let is_it = |row: &&LifeRow| row.limit_state == "total" && row.reliability == level;
        let row = self.summary.lives.iter().find(is_it)?;
        let interval = row.whole_interval();
        Some([row.cycles?, interval.lower, interval.upper?].map(|cycles| cycles / 1e3))
    }

    /// Checkpoints [cycles] and R of the system there, where it falls from 0.999 to 0.001.
    pub fn fall(&self) -> impl Iterator<Item = (f64, f64)> {
        let rows = self.summary.reliability.iter();
        let values = rows.map(|row| (f64::from(row.cycles), row.reliability["total"]));
        values.filter(|(_, r)| (0.001..=0.999).contains(r))
    }

    /// One of the moments, by its key in `summary.json`.
    pub fn moment(&self, key: &str, cycles: u32) -> Option<f64> {
        let row = self.summary.moments.iter().find(|row| row.cycles == cycles)?;
        row.moments.get(key).copied()
    }

    /// Last checkpoint up to which the system is as reliable as the wear alone, to 0.01 [cycles].
    pub fn wear_alone_until(&self) -> Option<f64> {
        let alone = |row: &&ReliabilityRow| row.reliability["wear"] - row.reliability["total"] < 0.01;
        self.summary.reliability.iter().take_while(alone).last().map(|row| f64::from(row.cycles))
    }

    /// Life from which the asymmetry is the less reliable of the two, between the checkpoints on either side [cycles].
    pub fn asymmetry_leads_from(&self) -> Option<f64> {
        let gap = |row: &ReliabilityRow| row.reliability["asymmetry"] - row.reliability["wear"];
        let failing = |row: &&ReliabilityRow| row.reliability["total"] < 0.999;
        let rows: Vec<&ReliabilityRow> = self.summary.reliability.iter().filter(failing).collect();
        let at = rows.windows(2).find(|pair| gap(pair[0]) > 0.0 && gap(pair[1]) <= 0.0)?;
        let (before, after) = (gap(at[0]), gap(at[1]));
        let width = f64::from(at[1].cycles - at[0].cycles);
        Some(f64::from(at[0].cycles) + width * before / (before - after))
    }

    /// The checkpoint where a limit state's R is nearest to a half [cycles].
    pub fn half_life(&self, limit_state: &str) -> u32 {
        let distance = |row: &&ReliabilityRow| (row.reliability[limit_state] - 0.5).abs();
        let nearest = self.summary.reliability.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.map_or(0, |row| row.cycles)
    }

    /// Sensitivities of a limit state, the largest by this measure first.
    pub fn ranking(
        &self,
        limit_state: &str,
        cycles: u32,
        scaled: fn(&SensitivityRow) -> f64,
    ) -> Vec<&SensitivityRow> {
        let here = |row: &&SensitivityRow| row.cycles == cycles && row.limit_state == limit_state;
        let mut rows: Vec<&SensitivityRow> = self.summary.sensitivity.iter().filter(here).collect();
        rows.sort_by(|a, b| scaled(b).abs().total_cmp(&scaled(a).abs()));
        rows
    }
}
