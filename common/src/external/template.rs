//! Templates: text files with values in the place of `{NAME}`, as pre-processors of other programs for design studies
//! use them.

use thiserror::Error;

/// A placeholder that names no input.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "line {line}: {{{name}}} is not an input; the inputs are {}; the text itself is written {{{{{name}}}}}",
    inputs.join(", ")
)]
pub struct UnknownPlaceholder {
    /// Line of the placeholder, from 1.
    pub line: usize,
    /// Name between the braces.
    pub name: String,
    /// Names of the inputs.
    pub inputs: Vec<String>,
}

/// Replaces each `{NAME}` by the value of that input, in the shortest decimal form that gives the same number, e.g. `0.02`
/// or `2.06e11`. `{{NAME}}` becomes `{NAME}`. Braces around anything but an input or a word (letters, digits and `_`, not
/// first a digit) stay as they are.
///
/// # Errors
/// [`UnknownPlaceholder`].
pub fn fill(template: &str, names: &[String], values: &[f64]) -> Result<String, UnknownPlaceholder> {
    let mut filled = String::with_capacity(template.len());
    let mut rest = template;
    while let Some(at) = rest.find('{') {
        filled.push_str(&rest[..at]);
        rest = &rest[at..];
        if let Some(name) = rest.strip_prefix('{').and_then(|inner| in_braces(inner, names))
            && rest[name.len() + 3..].starts_with('}')
        {
            filled.extend(["{", name, "}"]);
            rest = &rest[name.len() + 4..];
        } else if let Some(name) = in_braces(rest, names) {
            let Some(input) = names.iter().position(|input| input == name) else {
                let line = 1 + template[..template.len() - rest.len()].matches('\n').count();
                return Err(UnknownPlaceholder { line, name: name.to_owned(), inputs: names.to_vec() });
            };
            filled.push_str(&number(values[input]));
            rest = &rest[name.len() + 2..];
        } else {
            filled.push('{');
            rest = &rest[1..];
        }
    }
    filled.push_str(rest);
    Ok(filled)
}

/// The name in the braces at the start of `text`: an input, or a word.
fn in_braces<'t>(text: &'t str, names: &[String]) -> Option<&'t str> {
    let inside = text.strip_prefix('{')?;
    let name = &inside[..inside.find('}')?];
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let is_word = name.chars().all(word) && name.chars().next().is_some_and(|first| !first.is_ascii_digit());
    (is_word || names.iter().any(|input| input == name)).then_some(name)
}

/// The shortest decimal text of a number: plain where that is short, otherwise with an exponent.
fn number(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || (1e-4..1e7).contains(&magnitude) { format!("{value:?}") } else { format!("{value:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filled(template: &str) -> Result<String, UnknownPlaceholder> {
        fill(template, &["E".into(), "width_2".into()], &[2.06e11, 0.1 + 0.2])
    }

    #[test]
    fn values_take_the_place_of_names() {
        assert_eq!(
            filled("*ELASTIC\n{E}, 0.3\n{width_2}").unwrap(),
            "*ELASTIC\n2.06e11, 0.3\n0.30000000000000004"
        );
        // What is no name in braces stays.
        let code = "void f() { return {1}; } {} { E } {E.x} {-E}{";
        assert_eq!(filled(code).unwrap(), code);
        assert_eq!(filled("{{E}} = {E}, {{other}}").unwrap(), "{E} = 2.06e11, {other}");
    }

    #[test]
    fn numbers_keep_every_bit() {
        for value in [0.02, -1e-5, 5e-324, f64::MAX, 1.0 / 3.0, 123_456_789.0, -0.0] {
            assert_eq!(number(value).parse::<f64>().unwrap().to_bits(), value.to_bits(), "{}", number(value));
        }
    }

    #[test]
    fn a_misspelt_name_is_refused_with_its_line() {
        let error = filled("a\nb {Width} c").unwrap_err();
        assert_eq!((error.line, error.name.as_str()), (2, "Width"));
        let said = "line 2: {Width} is not an input; the inputs are E, width_2; the text itself is written {{Width}}";
        assert_eq!(error.to_string(), said);
    }
}
