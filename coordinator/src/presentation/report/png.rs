//! A figure as a picture of pixels, in the colours of the light page.

use super::figure::Figure;
use maud::html;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::fontdb::Database;
use resvg::usvg::{Options, Tree};
use std::sync::Arc;
use thiserror::Error;

/// Width of a picture [pixels]: twice the width that figures are designed for.
const WIDTH: f32 = 960.0;

/// Families of which one is taken for the letters, the first that is installed.
const FAMILIES: [&str; 7] =
    ["DejaVu Sans", "Liberation Sans", "Arial", "Helvetica", "Noto Sans", "Segoe UI", "Open Sans"];

/// Reasons why a figure has no picture.
#[derive(Debug, Error)]
pub enum PngError {
    /// No font for the letters.
    #[error(
        "no PNG: this machine has no sans-serif font ({} are looked for); the SVG files in figures/ need none",
        FAMILIES.join(", ")
    )]
    NoFont,
    /// A picture that cannot be made.
    #[error("no PNG of the figure {figure}: {reason}")]
    Picture {
        /// Name of the figure.
        figure: String,
        /// Reason of the failure.
        reason: String,
    },
}

/// Makes pictures of figures with the fonts of this machine.
#[derive(Debug)]
pub struct PngMaker {
    fonts: Arc<Database>,
    family: String,
}

impl PngMaker {
    /// Finds the fonts of this machine.
    ///
    /// # Errors
    /// [`PngError::NoFont`]: letters would be missing without a word.
    pub fn new() -> Result<Self, PngError> {
        let mut fonts = Database::new();
        fonts.load_system_fonts();
        Self::with(fonts)
    }

    fn with(mut fonts: Database) -> Result<Self, PngError> {
        let installed =
            |family: &&&str| fonts.faces().any(|face| face.families.iter().any(|(name, _)| name == **family));
        let family = (*FAMILIES.iter().find(installed).ok_or(PngError::NoFont)?).to_owned();
        fonts.set_sans_serif_family(&family);
        Ok(Self { fonts: Arc::new(fonts), family })
    }

    /// A figure as a PNG file. Its SVG has colours as numbers; an SVG file of the figure has a style sheet with variables, which this
    /// renderer shows as black.
    ///
    /// # Errors
    /// [`PngError`].
    pub fn png(&self, figure: &Figure) -> Result<Vec<u8>, PngError> {
        let failed = |reason: String| PngError::Picture { figure: figure.name.clone(), reason };
        let options =
            Options { fontdb: self.fonts.clone(), font_family: self.family.clone(), ..Options::default() };
        let tree = Tree::from_str(&figure.drawing.document(&html! {}), &options)
            .map_err(|error| failed(error.to_string()))?;
        let scale = WIDTH / tree.size().width();
        let height = (scale * tree.size().height()).ceil() as u32;
        let mut picture = Pixmap::new(WIDTH as u32, height)
            .ok_or_else(|| failed("a picture of this size cannot be made".to_owned()))?;
        resvg::render(&tree, Transform::from_scale(scale, scale), &mut picture.as_mut());
        picture.encode_png().map_err(|error| failed(error.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::report::plot::{Axis, Plot};

    fn figure(label: &str) -> Figure {
        let plot = Plot {
            figure: "f",
            x: Axis::linear(label, (0.0, 1.0)),
            y: Axis::linear("y", (0.0, 1.0)),
            series: &[],
        };
        plot.figure("t", "c").unwrap()
    }

    /// Share of dark pixels in the lowest twentieth of the picture, where the label of the horizontal axis stands.
    fn dark_share(picture: &[u8]) -> f64 {
        let picture = Pixmap::decode_png(picture).unwrap();
        let (width, height) = (picture.width() as usize, picture.height() as usize);
        let lowest = &picture.pixels()[width * (height - height / 20)..];
        lowest.iter().filter(|pixel| pixel.red() < 120).count() as f64 / lowest.len() as f64
    }

    #[test]
    fn letters_appear_where_a_font_is_installed() {
        let Ok(maker) = PngMaker::new() else {
            eprintln!("left out: letters of PNG files (this machine has no font)");
            return;
        };
        let [with, without] = ["a label of some length", ""].map(|label| maker.png(&figure(label)).unwrap());
        assert!(
            dark_share(&with) > 0.01 + dark_share(&without),
            "{} {}",
            dark_share(&with),
            dark_share(&without)
        );
        assert_eq!(Pixmap::decode_png(&with).unwrap().width(), 960);
    }

    #[test]
    fn without_a_font_there_is_a_sentence() {
        let said = PngMaker::with(Database::new()).unwrap_err().to_string();
        assert!(said.starts_with("no PNG: this machine has no sans-serif font (DejaVu Sans, "), "{said}");
    }
}
