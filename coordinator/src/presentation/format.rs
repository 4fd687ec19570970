//! Numbers as text for people; a value that is not finite is a dash.

use common::scene::OutputUnit;
use common::scene::expression::read_unit;

/// Text of an unknown value.
pub const UNKNOWN: &str = "–";

/// A count with its thousands apart, e.g. `64 000`.
pub fn count(value: u64) -> String {
    let digits = value.to_string();
    let is_apart = |k: usize| k > 0 && (digits.len() - k).is_multiple_of(3);
    let with_space = |(k, digit): (usize, char)| is_apart(k).then_some('\u{a0}').into_iter().chain([digit]);
    digits.chars().enumerate().flat_map(with_space).collect()
}

/// A number of cycles with its unit, e.g. `64 000 cycles`, `1 cycle`.
pub fn number_of_cycles(cycles: u32) -> String {
    format!("{} cycle{}", count(cycles.into()), if cycles == 1 { "" } else { "s" })
}

/// A life in whole cycles, e.g. `63 215`.
pub fn whole(life: f64) -> String {
    count(life.round().max(0.0) as u64)
}

/// Width of an interval of lives below which decimals are shown [cycles].
const FRACTIONAL: f64 = 10.0;

/// A life in cycles with two digits of the half-width of its interval, e.g. `63 220` for 63 215 within 264 cycles.
pub fn rounded_cycles(life: f64, width: f64) -> String {
    if width > 0.0 && width < FRACTIONAL {
        return fixed(life, (1 - width.log10().floor() as i32).clamp(1, 3) as usize);
    }
    let step = if width > 100.0 { 10f64.powf(width.log10().floor() - 1.0) } else { 1.0 };
    whole((life / step).round() * step)
}

/// A value and the half-width of its interval, with two digits of the half-width, e.g. `0.3730 ± 0.0043`; the value alone where
/// the half-width is not known.
pub fn with_width(value: f64, width: f64) -> String {
    if !(width.is_finite() && width > 0.0 && value.is_finite()) {
        return three_digits(value);
    }
    let (size, last) = (value.abs().max(width), width.log10().floor() as i32 - 1);
    if (1e-3..1e5).contains(&size) && last >= -6 {
        let decimals = (-last).max(0) as usize;
        return format!("{} ± {}", fixed(value, decimals), fixed(width, decimals));
    }
    let decimals = (size.log10().floor() as i32 - last).max(0) as usize;
    format!("{} ± {}", power(value, decimals), power(width, 1))
}

/// A change with its sign and two digits of the half-width of its interval, e.g. `+1.97e−4 ± 6.2e−5`; `0` without either.
pub fn signed_with_width(value: f64, width: f64) -> String {
    if value == 0.0 {
        return if width > 0.0 { format!("0 ± {}", three_digits(width)) } else { "0".to_owned() };
    }
    let text = with_width(value, width);
    if value > 0.0 { format!("+{text}") } else { text }
}

/// A reliability with its 95 % interval: `0.3730 ± 0.0043`, or the limit alone where no failure, or no survivor, was seen.
pub fn reliability(r: f64, lower: f64, upper: f64) -> String {
    let (is_survival, distance) = match () {
        () if r >= 1.0 && lower < 1.0 => (true, 1.0 - lower),
        () if r <= 0.0 && upper > 0.0 => (false, upper),
        () => return share(r, lower, upper),
    };
    // Two digits of the distance from 1 or 0, rounded away from it.
    let distance = distance.max(1e-15);
    let decimals = (1.0 - distance.log10().floor()) as i32;
    let step = 10f64.powi(-decimals);
    let distance = (distance / step - 1e-9).ceil() * step;
    // More than six nines are not read but counted.
    match (is_survival, distance < 1e-6) {
        (true, true) => format!("> 1 \u{2212} {}", power(distance, 1)),
        (true, false) => format!("> {}", fixed(1.0 - distance, decimals as usize)),
        (false, true) => format!("< {}", power(distance, 1)),
        (false, false) => format!("< {}", fixed(distance, decimals as usize)),
    }
}

/// A probability within its 95 % interval: `0.3730 ± 0.0043`, or the ends of the interval where that would reach beyond 0 or 1,
/// e.g. `0.9995 (0.9983 to 0.9999)`.
pub fn share(value: f64, lower: f64, upper: f64) -> String {
    let width = (upper - value).max(value - lower);
    if !(width.is_finite() && width > 0.0) || (value - width >= 0.0 && value + width <= 1.0) {
        return with_width(value, width);
    }
    let last = width.log10().floor() as i32 - 1;
    let text = |x: f64| match x {
        0.0 => "0".to_owned(),
        1.0 => "1".to_owned(),
        x if upper >= 1e-3 && last >= -6 => fixed(x, (-last).max(0) as usize),
        x => power(x, 1),
    };
    format!("{} ({} to {})", text(value), text(lower), text(upper))
}

/// A number with this many decimals.
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return UNKNOWN.to_string();
    }
    let text = format!("{value:.decimals$}");
    let is_zero = text.bytes().all(|c| matches!(c, b'0' | b'.' | b'-'));
    text.replace('-', if is_zero { "" } else { "\u{2212}" })
}

/// A number with at most this many decimals and no trailing zeros.
pub fn plain(value: f64, decimals: usize) -> String {
    without_zeros(&fixed(value, decimals)).to_owned()
}

/// Digits without zeros at the end of their decimals.
pub fn without_zeros(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

/// A number in powers of ten with this many decimals, e.g. `1.97e−4`.
pub fn power(value: f64, decimals: usize) -> String {
    format!("{value:.decimals$e}").replace('-', "\u{2212}")
}

/// A reliability with these decimals; so near to one that they do not show its distance, with three digits of that.
pub fn near_one(r: f64, decimals: usize) -> String {
    let (distance, resolved) = (1.0 - r, 0.5 * 0.1f64.powi(decimals as i32));
    if distance > 0.0 && distance < resolved {
        format!("1 \u{2212} {}", power(distance, 2))
    } else {
        format!("{r:.decimals$}")
    }
}

/// A number with three significant digits, in powers of ten where it is far from one.
pub fn three_digits(value: f64) -> String {
    match value.abs() {
        size if !size.is_finite() => UNKNOWN.to_string(),
        0.0 => "0".to_string(),
        size if (1e-3..1e5).contains(&size) => {
            fixed(value, (2 - size.log10().floor() as i32).max(0) as usize)
        }
        _ => power(value, 2),
    }
}

/// A value [SI] in the unit that people read, with three significant digits.
pub fn with_unit(unit: &OutputUnit, value: f64) -> String {
    unit.after(&three_digits(unit.to_shown(value)))
}

/// A value [SI] in the unit that people read, with seven digits.
pub fn exactly_with_unit(unit: &OutputUnit, value: f64) -> String {
    unit.after(&seven_digits(unit.to_shown(value)))
}

/// A value [SI] in the unit that people read, with this many decimals.
pub fn fixed_with_unit(unit: &OutputUnit, value: f64, decimals: usize) -> String {
    unit.after(&fixed(unit.to_shown(value), decimals))
}

/// Texts with a separator between them.
pub fn joined(texts: impl IntoIterator<Item = String>, separator: &str) -> String {
    texts.into_iter().collect::<Vec<_>>().join(separator)
}

/// SI value of one unit; 1 of a unit that is not known.
pub fn unit_scale(unit: &str) -> f64 {
    read_unit(unit).map_or(1.0, |unit| unit.multiply / unit.divide)
}

/// A text followed by its unit, which `1` is not.
pub fn before_unit(text: &str, unit: &str) -> String {
    if unit == "1" { text.to_owned() } else { format!("{text} {unit}") }
}

/// A value of a scene with seven digits, e.g. `40.0549`, `1.293e−13`.
pub fn seven_digits(value: f64) -> String {
    shortest(value, 7)
}

/// A number with at most this many significant digits, without zeros at the end, e.g. `40.05`, `1.293e−13`.
pub fn shortest(value: f64, digits: usize) -> String {
    let rounded: f64 = format!("{value:.0$e}", digits - 1).parse().unwrap_or(value);
    let plain = (1e-3..1e6).contains(&rounded.abs()) || rounded == 0.0;
    let text = if plain { rounded.to_string() } else { format!("{rounded:e}") };
    text.replace('-', "\u{2212}")
}

/// A number with this many significant digits, e.g. `40.00`, `1.290e-13`.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let exponent = value.abs().log10().floor() as i32;
    if (-4..6).contains(&exponent) {
        let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
        format!("{value:.decimals$}")
    } else {
        format!("{value:.0$e}", digits - 1)
    }
}

/// A share in per cent.
pub fn percent(share: f64) -> String {
    let value = 100.0 * share;
    match value.abs() {
        size if !size.is_finite() => UNKNOWN.to_string(),
        0.0 => "0.0\u{a0}%".to_string(),
        size if size < 0.005 => "<\u{a0}0.01\u{a0}%".to_string(),
        size => format!("{}\u{a0}%", fixed(value, if size < 0.1 { 2 } else { 1 })),
    }
}

/// A duration in hours, minutes and seconds.
pub fn duration(seconds: f64) -> String {
    if !(seconds.is_finite() && seconds >= 0.0) {
        return UNKNOWN.to_string();
    }
    if seconds < 60.0 {
        return format!("{}\u{a0}s", fixed(seconds, 1));
    }
    let whole = seconds.round() as u64;
    match (whole / 3600, whole / 60 % 60, whole % 60) {
        (0, minutes, rest) => format!("{minutes}\u{a0}min {rest:02}\u{a0}s"),
        (hours, minutes, _) => format!("{hours}\u{a0}h {minutes:02}\u{a0}min"),
    }
}

/// A share in percent with two or three digits, e.g. `1 %`, `0.13 %`, `26 %`.
pub fn short_percent(share: f64) -> String {
    let percent = 100.0 * share;
    let decimals = if percent > 0.0 { (1.0 - percent.log10().floor()).clamp(0.0, 9.0) as usize } else { 0 };
    format!("{} %", plain(percent, decimals))
}

/// A name of a scene as part of a file's name.
pub fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '-' }).collect()
}

/// An identifier as words.
pub fn words(name: &str) -> String {
    name.replace('_', " ")
}

/// With a capital first letter.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// As a sentence: with a capital first letter and a full stop.
pub fn sentence(text: &str) -> String {
    capital(text.strip_suffix('.').unwrap_or(text)) + "."
}

/// The rows as lines. Columns stand to the right, those numbered in `to_the_left` to the left; a row may have fewer cells.
pub fn in_columns(rows: &[Vec<String>], to_the_left: &[usize]) -> String {
    let length = |text: &String| text.chars().count();
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |k: usize| rows.iter().filter_map(|row| row.get(k)).map(length).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).enumerate().map(|(k, (cell, width))| {
            let space = " ".repeat(width - length(cell));
            let gap = if k == 0 { "" } else { "  " };
            let (before, after) = if to_the_left.contains(&k) { ("", &*space) } else { (&*space, "") };
            format!("{gap}{before}{cell}{after}")
        });
        format!("{}\n", cells.collect::<String>().trim_end())
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_a_dash() {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let texts = [fixed(value, 2), three_digits(value), percent(value), duration(value)];
            assert_eq!(texts, [UNKNOWN; 4]);
        }
    }

    #[test]
    fn numbers_read_as_people_write_them() {
        assert_eq!(count(64_000), "64\u{a0}000");
        assert_eq!(count(999), "999");
        let near = [0.5, 0.9999, 0.99996, 1.0 - 1.46e-9, 1.0].map(|r| near_one(r, 4));
        assert_eq!(
            near,
            ["0.5000", "0.9999", "1 \u{2212} 4.00e\u{2212}5", "1 \u{2212} 1.46e\u{2212}9", "1.0000"]
        );
        assert_eq!([1, 2000].map(number_of_cycles), ["1 cycle", "2\u{a0}000 cycles"]);
        assert_eq!(count(1_234_567), "1\u{a0}234\u{a0}567");
        assert_eq!(fixed(-0.0001, 2), "0.00");
        assert_eq!(fixed(-1.25, 1), "\u{2212}1.2");
        assert_eq!(three_digits(0.012345), "0.0123");
        assert_eq!(three_digits(2.5e-7), "2.50e\u{2212}7");
        assert_eq!(
            [40.054_900_01, 1.293e-13, -95.0, 0.0].map(seven_digits),
            ["40.0549", "1.293e\u{2212}13", "\u{2212}95", "0"]
        );
        assert_eq!(percent(0.9653), "96.5\u{a0}%");
        assert_eq!(percent(0.0003), "0.03\u{a0}%");
        assert_eq!(duration(3725.0), "1\u{a0}h 02\u{a0}min");
        assert_eq!(duration(125.0), "2\u{a0}min 05\u{a0}s");
    }

    #[test]
    fn digits_follow_the_error() {
        assert_eq!(rounded_cycles(63_215.4, 264.0), "63\u{a0}220");
        assert_eq!(rounded_cycles(63_215.4, 14.0), "63\u{a0}215");
        assert_eq!([rounded_cycles(28.134, 0.21), rounded_cycles(3.04, 2.5)], ["28.13", "3.0"]);
        assert_eq!([5.676, 6.2743].map(|life| rounded_cycles(life, 3.1)), ["5.7", "6.3"]);
        assert_eq!(with_width(0.373_04, 0.004_31), "0.3730 ± 0.0043");
        assert_eq!(with_width(1.973e-4, 6.2e-6), "1.973e\u{2212}4 ± 6.2e\u{2212}6");
        assert_eq!(with_width(0.5, f64::NAN), "0.500");
        assert_eq!(signed_with_width(1.973e-7, 6.2e-9), "+1.973e\u{2212}7 ± 6.2e\u{2212}9");
        assert_eq!(signed_with_width(-0.0137, 0.0021), "\u{2212}0.0137 ± 0.0021");
        assert_eq!([(0.0, 0.0), (0.0, 0.01)].map(|(x, w)| signed_with_width(x, w)), ["0", "0 ± 0.0100"]);
        assert_eq!(reliability(1.0, 0.998_52, 1.0), "> 0.9985");
        assert_eq!(reliability(1.0, 0.99997, 1.0), "> 0.999970");
        assert_eq!(reliability(1.0, 1.0 - 1.95e-12, 1.0), "> 1 \u{2212} 2.0e\u{2212}12");
        assert_eq!(reliability(0.0, 0.0, 0.0015), "< 0.0015");
        assert_eq!(reliability(0.0, 0.0, 1e-30), "< 1.0e\u{2212}15");
        assert_eq!(reliability(0.4, 0.39, 0.41), "0.400 ± 0.010");
        // No range of a probability reaches beyond 0 or 1.
        assert_eq!(reliability(0.9995, 0.9983, 0.9999), "0.9995 (0.9983 to 0.9999)");
        assert_eq!(reliability(0.0004, 0.0001, 0.0012), "0.00040 (0.00010 to 0.00120)");
        assert_eq!(reliability(0.0004, 0.0, 0.0012), "0.00040 (0 to 0.00120)");
        assert_eq!(share(2e-5, 1e-6, 5e-5), "2.0e\u{2212}5 (1.0e\u{2212}6 to 5.0e\u{2212}5)");
    }

    #[test]
    fn shares_are_written_as_people_read_them() {
        let found = [0.01, 0.0013, 0.26, 0.0, 0.12345, 1e-9].map(short_percent);
        assert_eq!(found, ["1 %", "0.13 %", "26 %", "0 %", "12 %", "0.0000001 %"]);
    }

    #[test]
    fn issue_columns_of_long_numbers_touched_each_other() {
        let rows = [["cycles", "R wear", "form"], ["4", "0.999815 ± 0.000068", "a"]];
        let rows = rows.map(|row| row.map(str::to_owned).to_vec());
        assert_eq!(
            in_columns(&rows, &[2]),
            "cycles               R wear  form\n     4  0.999815 ± 0.000068  a\n"
        );
    }
}
