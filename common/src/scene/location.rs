//! Place of a key or value in the text of a scene, in the form of compilers: file, line, column and the line itself.

use std::fmt::Write;
use std::ops::Range;

/// A piece of one line of a scene file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Location {
    /// The file, or the name of a built-in scene.
    pub file: String,
    /// Number of the line, from 1.
    pub line: usize,
    /// Column of the first character, in characters from 1.
    pub column: usize,
    /// Column after the last character; at least one more than `column`.
    pub end_column: usize,
    /// Text of the line, without its end.
    pub text: String,
}

impl Location {
    /// The piece `span` [bytes] of a text; of a piece over several lines the part on the first one.
    pub(super) fn new(file: &str, text: &str, span: Range<usize>) -> Self {
        let boundary = |at: usize| (0..=at.min(text.len())).rev().find(|at| text.is_char_boundary(*at));
        let (start, end) = (boundary(span.start).unwrap_or(0), boundary(span.end).unwrap_or(0));
        let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |at| start + at);
        let column = text[line_start..start].chars().count() + 1;
        let length = text[start..end.clamp(start, line_end)].trim_end().chars().count().max(1);
        Location {
            file: file.to_owned(),
            line: text[..start].matches('\n').count() + 1,
            column,
            end_column: column + length,
            text: text[line_start..line_end].trim_end_matches('\r').to_owned(),
        }
    }

    /// The line under its place, with carets under the piece:
    ///
    /// ```text
    ///   --> press.toml:12:9
    ///    |
    /// 12 | width = "10 N"
    ///    |         ^^^^^^
    /// ```
    pub fn excerpt(&self) -> String {
        let Location { line, column, end_column, text, .. } = self;
        let number = line.to_string();
        let margin = " ".repeat(number.len());
        // Tabs stay tabs, so that the carets stand under the piece however wide a tab is.
        let indent: String =
            text.chars().take(column - 1).map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
        let carets = "^".repeat(end_column - column);
        let mut excerpt = format!("{margin}--> {self}\n{margin} |\n{number} | {text}\n");
        // Writing to a String cannot fail.
        let _ = write!(excerpt, "{margin} | {indent}{carets}");
        excerpt
    }
}

/// As `file:line:column`, the form that editors follow.
impl std::fmt::Display for Location {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_and_carets_stand_under_them() {
        let text = "a = 1\n\tb = \"µm²\" # x\r\nc = [\n 1,\n]\n";
        let start = text.find("\"µ").unwrap();
        let found = Location::new("my.toml", text, start..start + "\"µm²\"".len());
        assert_eq!((found.line, found.column, found.end_column), (2, 6, 11));
        assert_eq!(found.to_string(), "my.toml:2:6");
        assert_eq!(found.excerpt(), " --> my.toml:2:6\n  |\n2 | \tb = \"µm²\" # x\n  | \t    ^^^^^");
        // Only the first line of a list; the end of the text; a span beyond it.
        let list = text.find('[').unwrap();
        assert_eq!(Location::new("f", text, list..text.len()).end_column, 6);
        for end in [text.len(), text.len() + 9] {
            let at_end = Location::new("f", text, end..end);
            assert_eq!((at_end.line, at_end.column, at_end.end_column), (6, 1, 2));
        }
    }
}
