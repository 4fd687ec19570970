//! What was meant by a unit that does not exist.

use super::quantity::{FORCE, UNITS, unit};

/// Names under which units are known elsewhere.
const ELSEWHERE: [(&str, &str); 22] = [
    ("inch", "in"),
    ("inches", "in"),
    ("foot", "ft"),
    ("feet", "ft"),
    ("thou", "mil"),
    ("micron", "um"),
    ("meter", "m"),
    ("metre", "m"),
    ("gm", "g"),
    ("lbs", "lb"),
    ("lbm", "lb"),
    ("lbft", "lbf ft"),
    ("lbin", "lbf in"),
    ("sec", "s"),
    ("hr", "h"),
    ("newton", "N"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("turn", "r"),
    ("turns", "r"),
    ("Hz", "r/s"),
    ("kHz", "r/ms"),
];

/// The unit that is most likely meant by a name that is none.
pub fn nearest_unit(name: &str) -> Option<String> {
    let known = |name: &str| unit(name).is_some();
    if let Some((_, symbol)) = ELSEWHERE.iter().find(|(other, _)| *other == name) {
        return Some((*symbol).to_owned());
    }
    // `mm2`, and with superscripts.
    let plain = name.replace('\u{b2}', "2").replace('\u{b3}', "3");
    if let Some((symbol, power)) = plain.char_indices().next_back().map(|(at, _)| plain.split_at(at))
        && ["2", "3", "4"].contains(&power)
        && known(symbol)
    {
        return Some(format!("{symbol}^{power}"));
    }
    // `Nm`: a force, or a kilogram, and what follows it.
    let split = (1..name.len()).filter(|at| name.is_char_boundary(*at)).map(|at| name.split_at(at));
    let is_first =
        |name: &str| unit(name).is_some_and(|unit| unit.dimension == FORCE.dimension) || name == "kg";
    if let Some((one, other)) = split.clone().find(|(one, other)| is_first(one) && known(other)) {
        return Some(format!("{one} {other}"));
    }
    let symbols = || UNITS.iter().map(|(symbol, _)| *symbol);
    if let Some(symbol) = symbols().find(|symbol| symbol.eq_ignore_ascii_case(name)) {
        return Some(symbol.to_owned());
    }
    let first = name.chars().next();
    let near = symbols()
        .filter(|symbol| symbol.chars().count() > 1 && strsim::damerau_levenshtein(name, symbol) == 1);
    near.min_by_key(|symbol| (symbol.chars().next() != first, symbol.len())).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::super::expression::read_unit;
    use super::*;

    #[test]
    fn what_was_meant_by_a_name() {
        for (name, meant) in [
            ("mmm", Some("mm")),
            ("Nm", Some("N m")),
            ("Nmm", Some("N mm")),
            ("kNm", Some("kN m")),
            ("lbft", Some("lbf ft")),
            ("inch", Some("in")),
            ("Mpa", Some("MPa")),
            ("KG", Some("kg")),
            ("PSI", Some("psi")),
            ("mm2", Some("mm^2")),
            ("mm\u{b2}", Some("mm^2")),
            ("degs", Some("deg")),
            ("Hz", Some("r/s")),
            ("furlong", None),
            ("x", None),
        ] {
            assert_eq!(nearest_unit(name).as_deref(), meant, "{name}");
        }
    }

    #[test]
    fn names_from_elsewhere_lead_to_units() {
        for (name, symbol) in ELSEWHERE {
            assert!(read_unit(symbol).is_ok() && unit(name).is_none(), "{name}: {symbol}");
        }
    }
}
