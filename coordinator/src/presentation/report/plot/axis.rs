//! An axis of a chart and the text of its ticks.

/// A linear axis.
#[derive(Clone, Copy)]
pub struct Axis<'a> {
    /// Quantity with its unit.
    pub label: &'a str,
    /// First and last number drawn.
    pub range: (f64, f64),
    /// Text of a tick.
    pub text: fn(f64) -> String,
    /// Value of a drawn number: the number itself, or the power of ten whose logarithm is drawn.
    pub value: fn(f64) -> f64,
}

impl<'a> Axis<'a> {
    /// An axis of the numbers themselves.
    pub fn linear(label: &'a str, range: (f64, f64)) -> Self {
        Self { label, range, text: tick_label, value: |number| number }
    }
}

/// A number with at most three decimals and no trailing zeros.
pub fn tick_label(value: f64) -> String {
    let text = format!("{value:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.replace('-', "\u{2212}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_no_trailing_zeros() {
        let found = [tick_label(0.5), tick_label(-0.0), tick_label(20.0), tick_label(-1.25)];
        assert_eq!(found, ["0.5", "0", "20", "\u{2212}1.25"]);
    }
}
