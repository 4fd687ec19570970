//! Bars of the sensitivities, longest first.

use super::figures::{Figure, file_name, words};
use super::format::count;
use super::input::ReportInput;
use super::palette::Ink;
use super::plot::{PlotError, draw, letters, px, short, stroke};
use crate::summary::SensitivityRow;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Bars shown per figure.
const SHOWN: usize = 12;

/// Height of one variable's two bars [CSS pixels].
const ROW: f64 = 24.0;

/// The rows of one limit state at the checkpoint nearest to the governing one, longest bar first.
pub fn rows_at_governing<'a>(input: &'a ReportInput, limit_state: &str) -> Vec<&'a SensitivityRow> {
    let all = input.summary.sensitivity.iter().filter(|row| row.limit_state == limit_state);
    let governing = super::life::governing(&input.summary).map_or(0, |row| row.cycles);
    let Some(cycles) = all.clone().map(|row| row.cycles).min_by_key(|cycles| cycles.abs_diff(governing))
    else {
        return vec![];
    };
    let length = |row: &SensitivityRow| {
        let longest = row.scaled.d_pf_d_mean.abs().max(row.scaled.d_pf_d_std.abs());
        if longest.is_finite() { longest } else { 0.0 }
    };
    let mut rows: Vec<_> = all.filter(|row| row.cycles == cycles).collect();
    rows.sort_by(|a, b| length(b).total_cmp(&length(a)));
    rows
}

/// One figure per limit state with sensitivities.
///
/// # Errors
/// [`PlotError`].
pub fn figures(input: &ReportInput) -> Result<Vec<Figure>, PlotError> {
    let mut figures = Vec::new();
    for state in &input.limit_states {
        let rows = rows_at_governing(input, &state.name);
        let Some(first) = rows.first() else { continue };
        let name = format!("sensitivity-{}", file_name(&state.name));
        let caption = format!(
            "Change of the probability of failure by {} at {} cycles per standard deviation that the mean (full) \
             or the standard deviation (pale) of a variable is moved; to the right: more failures. The {} largest \
             of {}.",
            state.name,
            count(first.cycles.into()),
            rows.len().min(SHOWN),
            rows.len()
        );
        let title = format!("What drives failure by {}", state.name);
        let svg = bars(&name, &rows[..rows.len().min(SHOWN)])?;
        figures.push(Figure { name, title, caption, svg });
    }
    Ok(figures)
}

fn bars(figure: &str, rows: &[&SensitivityRow]) -> Result<String, PlotError> {
    let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
    let longest = rows
        .iter()
        .flat_map(|row| [row.scaled.d_pf_d_mean, row.scaled.d_pf_d_std])
        .map(|value| finite(value).abs())
        .fold(0.0, f64::max);
    let longest = if longest > 0.0 { 1.08 * longest } else { 1.0 };
    let height = ROW * rows.len() as f64 + 52.0;
    draw(figure, height, |root| {
        let mut chart = ChartBuilder::on(root)
            .margin_top(px(6.0))
            .margin_right(px(14.0))
            .margin_left(px(152.0))
            .x_label_area_size(px(44.0))
            .build_cartesian_2d(-longest..longest, 0.0..rows.len() as f64)?;
        chart
            .configure_mesh()
            .disable_y_mesh()
            .disable_y_axis()
            .x_labels(4)
            .max_light_lines(0)
            .bold_line_style(stroke(Ink::Grid, 1.0))
            .axis_style(stroke(Ink::Muted, 1.0))
            .label_style(letters(13.5, Ink::Muted))
            .axis_desc_style(letters(13.5, Ink::Ink))
            .set_all_tick_mark_size(px(4.0))
            .x_label_formatter(&|value| short(*value))
            .x_desc("change of failure probability")
            .draw()?;
        let right = letters(13.5, Ink::Ink).pos(Pos::new(HPos::Right, VPos::Center));
        for (k, row) in rows.iter().enumerate() {
            let top = (rows.len() - k) as f64;
            let mean = finite(row.scaled.d_pf_d_mean);
            let std = finite(row.scaled.d_pf_d_std);
            let colour = Ink::Series(0).rgb();
            chart.draw_series([Rectangle::new([(0.0, top - 0.14), (mean, top - 0.52)], colour.filled())])?;
            let pale = [(0.0, top - 0.56), (std, top - 0.86)];
            chart.draw_series([Rectangle::new(pale, colour.mix(0.35).filled())])?;
            let middle = px(6.0 + ROW * (k as f64 + 0.5));
            root.draw(&Text::new(words(&row.variable), (px(146.0), middle), right.clone()))?;
        }
        let axis = [(0.0, 0.0), (0.0, rows.len() as f64)];
        chart.draw_series([PathElement::new(axis, stroke(Ink::Muted, 1.0))])?;
        Ok(())
    })
}
