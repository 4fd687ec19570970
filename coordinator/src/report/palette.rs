//! Colours of the report by meaning, each in a light and a dark shade. Figures are drawn in the light shades;
//! a style sheet made from this table replaces them where the reader's system is dark, so that one SVG serves
//! both, inside the page and alone.

use plotters::style::RGBColor;

/// A colour by meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    /// Background.
    Paper,
    /// Text and the whole system.
    Ink,
    /// Axis labels.
    Muted,
    /// Grid lines.
    Grid,
    /// Thresholds and failures.
    Limit,
    /// The n-th limit state, joint, checkpoint; counted modulo [`SERIES`].
    Series(usize),
}

/// Number of distinct series colours.
pub const SERIES: usize = 6;

/// Name of the CSS variable, light shade, dark shade.
const SHADES: [(&str, u32, u32); 5 + SERIES] = [
    ("paper", 0xFFFFFF, 0x14181D),
    ("ink", 0x1B1F24, 0xE8EBEE),
    ("muted", 0x57616D, 0xA3AEBA),
    ("grid", 0xE1E5EA, 0x2C333B),
    ("limit", 0xB3261E, 0xFF8A80),
    ("series-1", 0x1F6FB4, 0x62ADE8),
    ("series-2", 0xC4541A, 0xF2935A),
    ("series-3", 0x2B8055, 0x62C690),
    ("series-4", 0x7548B0, 0xB594EA),
    ("series-5", 0x8A6D00, 0xD9BC4A),
    ("series-6", 0xB0336F, 0xF07FB4),
];

impl Ink {
    fn row(self) -> (&'static str, u32, u32) {
        match self {
            Self::Paper => SHADES[0],
            Self::Ink => SHADES[1],
            Self::Muted => SHADES[2],
            Self::Grid => SHADES[3],
            Self::Limit => SHADES[4],
            Self::Series(n) => SHADES[5 + n % SERIES],
        }
    }

    /// The light shade, for plotters.
    pub fn rgb(self) -> RGBColor {
        let [_, r, g, b] = self.row().1.to_be_bytes();
        RGBColor(r, g, b)
    }

    /// The light shade, for SVG written by hand.
    pub fn hex(self) -> String {
        format!("#{:06X}", self.row().1)
    }
}

/// Style sheet: the CSS variables of both shades, and the rules that lay them over the colours in the figures.
pub fn css() -> String {
    let variables = |dark: bool| {
        SHADES
            .iter()
            .map(|(name, light, night)| format!("--{name}:#{:06X};", if dark { *night } else { *light }))
            .collect::<String>()
    };
    let mut css = format!(
        ":root{{color-scheme:light dark;{}}}\n@media (prefers-color-scheme:dark){{:root{{{}}}}}\n",
        variables(false),
        variables(true)
    );
    for (name, light, _) in SHADES {
        css += &format!(
            "svg [fill=\"#{light:06X}\"]{{fill:var(--{name})}}svg [stroke=\"#{light:06X}\"]{{stroke:var(--{name})}}\n"
        );
    }
    css
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plotters_and_the_style_sheet_name_the_same_colour() {
        let RGBColor(r, g, b) = Ink::Series(7).rgb();
        assert_eq!(format!("#{r:02X}{g:02X}{b:02X}"), Ink::Series(1).hex());
        assert!(css().contains(&format!("[stroke=\"{}\"]", Ink::Series(1).hex())));
    }
}
