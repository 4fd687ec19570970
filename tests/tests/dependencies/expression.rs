//! SPDX licence expressions: `MIT OR (Apache-2.0 AND ISC)`. The old form `MIT/Apache-2.0` is a choice too.

use std::iter::Peekable;
use std::vec::IntoIter;

/// Whether the expression can be satisfied with licences for which `allowed` is true. `None` if it is no expression.
pub fn is_satisfied(expression: &str, allowed: &mut dyn FnMut(&str) -> bool) -> Option<bool> {
    let spaced = expression.replace('(', " ( ").replace(')', " ) ").replace('/', " OR ");
    let words: Vec<String> = spaced.split_whitespace().map(str::to_owned).collect();
    let mut words = words.into_iter().peekable();
    let satisfied = choice(&mut words, allowed)?;
    words.next().is_none().then_some(satisfied)
}

type Words = Peekable<IntoIter<String>>;

/// `TERM OR TERM ...`
fn choice(words: &mut Words, allowed: &mut dyn FnMut(&str) -> bool) -> Option<bool> {
    let mut satisfied = all_of(words, allowed)?;
    while words.next_if(|word| word == "OR").is_some() {
        satisfied |= all_of(words, allowed)?;
    }
    Some(satisfied)
}

/// `LICENCE AND LICENCE ...`
fn all_of(words: &mut Words, allowed: &mut dyn FnMut(&str) -> bool) -> Option<bool> {
    let mut satisfied = licence(words, allowed)?;
    while words.next_if(|word| word == "AND").is_some() {
        satisfied &= licence(words, allowed)?;
    }
    Some(satisfied)
}

/// A name, a name with an exception, or a choice in parentheses.
fn licence(words: &mut Words, allowed: &mut dyn FnMut(&str) -> bool) -> Option<bool> {
    match words.next()?.as_str() {
        "(" => {
            let satisfied = choice(words, allowed)?;
            words.next_if(|word| word == ")").map(|_| satisfied)
        }
        ")" | "OR" | "AND" | "WITH" => None,
        name => match words.next_if(|word| word == "WITH") {
            Some(_) => Some(allowed(&format!("{name} WITH {}", words.next()?))),
            None => Some(allowed(name)),
        },
    }
}

#[test]
fn expressions_are_read_as_spdx_defines_them() {
    let of = |expression: &str| is_satisfied(expression, &mut |name| ["MIT", "A WITH E"].contains(&name));
    for satisfied in ["MIT", "GPL OR MIT", "GPL/MIT", "A WITH E AND MIT", "(GPL OR MIT) AND (MIT)"] {
        assert_eq!(of(satisfied), Some(true), "{satisfied}");
    }
    // AND binds more strongly than OR.
    for refused in ["GPL", "MIT AND GPL", "GPL AND MIT OR A", "A", "GPL OR MIT AND GPL"] {
        assert_eq!(of(refused), Some(false), "{refused}");
    }
    for nonsense in ["", "MIT OR", "(MIT", "MIT)", "MIT ISC", "A WITH"] {
        assert_eq!(of(nonsense), None, "{nonsense}");
    }
}
