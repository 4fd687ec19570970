//! A page of updated units: remaining lives, curves of reliability, and a table.

use super::figure::Figure;
use super::format::{UNKNOWN, count, fixed};
use super::page::{self, wrapped};
use super::palette::{Ink, SERIES};
use super::plot::{Axis, Plot, PlotError, Points, Series, Shape};
use super::tables::table;
use maud::{Render, html as markup};

/// Units to show.
#[derive(Debug, Clone, PartialEq)]
pub struct FleetPage {
    /// Name of the scene.
    pub scene: String,
    /// Last checkpoint [cycles].
    pub end: f64,
    /// R of a unit of which nothing is known, over cycles.
    pub before: Points,
    /// Units in the order of their file.
    pub units: Vec<DrawnUnit>,
}

/// A unit after its observations.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnUnit {
    /// Name of the unit.
    pub name: String,
    /// Life up to which it was observed [cycles].
    pub observed_until: f64,
    /// True if it has no remaining life to show.
    pub failed: bool,
    /// Remaining lives that 5, 50 and 95 % do not reach; `None` beyond the study [cycles].
    pub remaining: [Option<f64>; 3],
    /// R from that life on, over cycles.
    pub curve: Points,
    /// Effective sample size [1].
    pub effective_size: f64,
    /// What is to be checked.
    pub warning: Option<String>,
}

/// The page; a function of the units alone.
///
/// # Errors
/// [`PlotError`].
pub fn html(fleet: &FleetPage) -> Result<String, PlotError> {
    let title = format!("Units of {}", fleet.scene);
    let mut figures = vec![remaining(fleet)?];
    if fleet.units.len() <= SERIES {
        figures.push(curves(fleet)?);
    }
    let life = |life: Option<f64>, unit: &DrawnUnit| match life {
        Some(life) => count(life.round() as u64),
        None => format!("> {}", count((fleet.end - unit.observed_until).max(0.0) as u64)),
    };
    let rows = fleet.units.iter().map(|unit| {
        let r = unit.curve.first().map_or(UNKNOWN.to_owned(), |(_, r)| fixed(*r, 3));
        let lives = unit.remaining.map(|l| if unit.failed { UNKNOWN.to_owned() } else { life(l, unit) });
        let observed = count(unit.observed_until as u64);
        let warning = unit.warning.clone().unwrap_or_default();
        let first = [unit.name.clone(), observed, r].into_iter();
        let last = [count(unit.effective_size as u64), warning].into_iter();
        first.chain(lives).chain(last).map(|cell| cell.render()).collect()
    });
    let head = [
        "unit",
        "observed until [cycles]",
        "R up to then",
        "remaining life [cycles], 5 % quantile",
        "median",
        "95 % quantile",
        "effective sample size",
        "to be checked",
    ];
    let body = markup! {
        header { p.brand { "Hingewise" } h1 { (title) } }
        h2 { "Remaining life" }
        (page::figures(&figures, "three"))
        h2 { "Units" }
        (table(&head, rows))
        p.none {
            "Intervals contain the errors of measurement and surrogates. The numerical error of the simulations widens the \
             likelihood of a measurement but does not shift the lives."
        }
    };
    Ok(wrapped(&title, &body))
}

/// Median and 5 to 95 % of the remaining life of every unit, in order of the median.
fn remaining(fleet: &FleetPage) -> Result<Figure, PlotError> {
    let mut units: Vec<&DrawnUnit> = fleet.units.iter().filter(|unit| !unit.failed).collect();
    let end = |unit: &DrawnUnit| fleet.end - unit.observed_until;
    let life = |unit: &DrawnUnit, k: usize| unit.remaining[k].unwrap_or(end(unit));
    units.sort_by(|a, b| life(a, 1).total_cmp(&life(b, 1)));
    let points: Vec<[f64; 4]> = units
        .iter()
        .enumerate()
        .map(|(place, unit)| [place as f64 + 1.0, life(unit, 1), life(unit, 0), life(unit, 2)])
        .collect();
    let most = points.iter().map(|point| point[3]).fold(1.0, f64::max);
    let series = [Series::new("median, 5 to 95 %", Ink::Series(0), Shape::Measured(points))];
    let plot = Plot {
        figure: "remaining-life",
        x: Axis::linear("unit, in order of its remaining life", (0.0, units.len() as f64 + 1.0)),
        y: Axis::linear("remaining life [cycles]", (0.0, 1.05 * most)),
        series: &series,
    };
    plot.figure(
        "Remaining life",
        "Dot: median; bar: 5 to 95 %. Lives beyond the end of the study are drawn at its end.",
    )
}

/// R of every unit from the life up to which it was observed, and of a unit of which nothing is known.
fn curves(fleet: &FleetPage) -> Result<Figure, PlotError> {
    let mut series = vec![Series::new("nothing measured", Ink::Muted, Shape::Dashed(fleet.before.clone()))];
    for (k, unit) in fleet.units.iter().enumerate() {
        series.push(Series::new(&unit.name, Ink::Series(k), Shape::Line(unit.curve.clone())));
    }
    let plot = Plot {
        figure: "updated-reliability",
        x: Axis::linear("life [cycles]", (0.0, fleet.end)),
        y: Axis::linear("reliability R", (0.0, 1.0)),
        series: &series,
    };
    plot.figure(
        "Reliability",
        "Probability of no failure up to this life, given what was observed of each unit.",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unit_stands_on_the_page() {
        let unit = |name: &str, failed: bool| DrawnUnit {
            name: name.to_owned(),
            observed_until: 400.0,
            failed,
            remaining: [Some(100.0), Some(300.0), None],
            curve: vec![(400.0, 0.98), (1000.0, 0.4)],
            effective_size: 812.0,
            warning: failed.then(|| "is improbable".to_owned()),
        };
        let before = vec![(500.0, 1.0), (1000.0, 0.3)];
        let mut fleet = FleetPage {
            scene: "press".to_owned(),
            end: 1000.0,
            before,
            units: vec![unit("A & 7", false), unit("B", true)],
        };
        let page = html(&fleet).unwrap();
        let body = &page[page.find("<body>").unwrap()..page.find("</html>").unwrap()];
        roxmltree::Document::parse(body).unwrap();
        assert!(page.contains("A &amp; 7") && page.contains("&gt; 600") && page.contains("is improbable"));
        assert!(page.contains("updated-reliability"));
        fleet.units = (0..20).map(|k| unit(&k.to_string(), false)).collect();
        assert!(!html(&fleet).unwrap().contains("updated-reliability"));
    }
}
