//! Colours of the report by meaning, each in a light and a dark shade. Figures are drawn in the light shades;
//! a style sheet made from this table replaces them where the reader's system is dark, so that one SVG serves
//! both, inside the page and alone.

use plotters::style::RGBColor;

/// A colour by meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    /// Background of page and figures.
    Paper,
    /// Text and the whole system.
    Ink,
    /// Axis labels and other secondary text.
    Muted,
    /// Grid lines and fills of fixed parts.
    Grid,
    /// Thresholds and failures.
    Limit,
    /// The n-th limit state, joint, checkpoint; counted modulo [`SERIES`].
    Series(usize),
}

/// Number of distinct series colours.
pub const SERIES: usize = 6;

/// Name of the CSS variable, light shade, dark shade. The tests require that both shades of a series have one hue, that the series differ
/// for every kind of colour vision, and that all but the grid contrast with the paper.
const SHADES: [(&str, u32, u32); 5 + SERIES] = [
    ("paper", 0xFFFFFF, 0x14181D),
    ("ink", 0x1B1F24, 0xE8EBEE),
    ("muted", 0x57616D, 0xA3AEBA),
    ("grid", 0xE1E5EA, 0x2C333B),
    ("limit", 0x9B031F, 0xFB2E4D),
    ("series-1", 0x273D83, 0x4B80FE),
    ("series-2", 0xDE0276, 0xE593A7),
    ("series-3", 0x0D755E, 0x95FED7),
    ("series-4", 0xAF52AE, 0xA471A5),
    ("series-5", 0x6C7E00, 0xDEF044),
    ("series-6", 0x0A72ED, 0x8BBAFF),
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

    type Rgb = [f64; 3];

    /// What is seen of linear red, green and blue without one kind of cone.
    ///
    /// # Source
    /// Machado, Oliveira, Fernandes (2009), A physiologically-based model for simulation of color vision
    /// deficiency, severity 1.0.
    const VISIONS: [(&str, [Rgb; 3]); 4] = [
        ("normal", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
        (
            "protanopia",
            [
                [0.152286, 1.052583, -0.204868],
                [0.114503, 0.786281, 0.099216],
                [-0.003882, -0.048116, 1.051998],
            ],
        ),
        (
            "deuteranopia",
            [
                [0.367322, 0.860646, -0.227968],
                [0.280085, 0.672501, 0.047413],
                [-0.011820, 0.042940, 0.968881],
            ],
        ),
        (
            "tritanopia",
            [
                [1.255528, -0.076749, -0.178779],
                [-0.078411, 0.930809, 0.147602],
                [0.004733, 0.691367, 0.303900],
            ],
        ),
    ];

    fn linear(shade: u32) -> Rgb {
        let [_, rgb @ ..] = shade.to_be_bytes();
        rgb.map(|c| f64::from(c) / 255.0)
            .map(|c| if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) })
    }

    fn times(matrix: &[Rgb; 3], v: Rgb) -> Rgb {
        [0, 1, 2].map(|row: usize| matrix[row].iter().zip(v).map(|(a, b)| a * b).sum())
    }

    /// Coordinates in Oklab, whose distances correspond to perceived differences.
    ///
    /// # Source
    /// Ottosson (2020), A perceptual color space for image processing.
    fn oklab(rgb: Rgb) -> Rgb {
        let cones = times(
            &[
                [0.4122214708, 0.5363325363, 0.0514459929],
                [0.2119034982, 0.6806995451, 0.1073969566],
                [0.0883024619, 0.2817188376, 0.6299787005],
            ],
            rgb.map(|c| c.clamp(0.0, 1.0)),
        );
        times(
            &[
                [0.2104542553, 0.7936177850, -0.0040720468],
                [1.9779984951, -2.4285922050, 0.4505937099],
                [0.0259040371, 0.7827717662, -0.8086757660],
            ],
            cones.map(f64::cbrt),
        )
    }

    /// Contrast by WCAG 2, from 1 to 21.
    fn contrast(a: u32, b: u32) -> f64 {
        let luminance = |shade| times(&[[0.2126, 0.7152, 0.0722]; 3], linear(shade))[0] + 0.05;
        let (a, b) = (luminance(a), luminance(b));
        (a / b).max(b / a)
    }

    /// 0.02 is just seen between two fields side by side; lines need more.
    #[test]
    fn series_are_told_apart_by_every_kind_of_colour_vision() {
        for night in [false, true] {
            let shades: Vec<_> = SHADES[4..]
                .iter()
                .map(|(name, light, dark)| (*name, if night { *dark } else { *light }))
                .collect();
            for (vision, matrix) in &VISIONS {
                for (k, (a, first)) in shades.iter().enumerate() {
                    for (b, second) in &shades[k + 1..] {
                        let [p, q] = [*first, *second].map(|shade| oklab(times(matrix, linear(shade))));
                        let apart = p.iter().zip(q).map(|(p, q)| (p - q).powi(2)).sum::<f64>().sqrt();
                        let least = if *a == "limit" { 0.08 } else { 0.09 };
                        assert!(apart > least, "{vision}, night {night}: {a} and {b} are {apart} apart");
                    }
                }
            }
        }
    }

    #[test]
    fn light_and_dark_shades_have_one_hue() {
        for (name, light, dark) in &SHADES[4..] {
            let [light, dark] = [light, dark].map(|shade| {
                let [_, a, b] = oklab(linear(*shade));
                b.atan2(a).to_degrees()
            });
            let apart = (light - dark).rem_euclid(360.0);
            assert!(apart.min(360.0 - apart) < 5.0, "{name}: {light} and {dark} degrees");
        }
    }

    #[test]
    fn all_that_is_read_stands_out_from_the_paper() {
        for (name, light, dark) in SHADES.iter().filter(|(name, ..)| !["paper", "grid"].contains(name)) {
            let found = [contrast(*light, SHADES[0].1), contrast(*dark, SHADES[0].2)];
            assert!(found.iter().all(|contrast| *contrast >= 4.5), "{name}: {found:?}");
        }
    }

    #[test]
    fn plotters_and_the_style_sheet_name_the_same_colour() {
        let RGBColor(r, g, b) = Ink::Series(7).rgb();
        assert_eq!(format!("#{r:02X}{g:02X}{b:02X}"), Ink::Series(1).hex());
        assert!(css().contains(&format!("[stroke=\"{}\"]", Ink::Series(1).hex())));
    }
}
