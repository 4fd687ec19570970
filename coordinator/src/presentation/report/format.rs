//! Numbers as text for people; a value that is not finite is a dash.

/// Text of an unknown value.
pub const UNKNOWN: &str = "–";

/// A count with its thousands apart, e.g. `64 000`.
pub fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push('\u{a0}');
        }
        text.push(digit);
    }
    text
}

/// A life in whole cycles, e.g. `63 215`.
pub fn whole(life: f64) -> String {
    count(life.round().max(0.0) as u64)
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

/// A number with three significant digits, in powers of ten where it is far from one.
pub fn three_digits(value: f64) -> String {
    let size = value.abs();
    if !value.is_finite() {
        UNKNOWN.to_string()
    } else if value == 0.0 {
        "0".to_string()
    } else if (1e-3..1e5).contains(&size) {
        fixed(value, (2 - size.log10().floor() as i32).max(0) as usize)
    } else {
        format!("{value:.2e}").replace('-', "\u{2212}")
    }
}

/// A share in per cent.
pub fn percent(share: f64) -> String {
    let value = 100.0 * share;
    if !value.is_finite() {
        UNKNOWN.to_string()
    } else if value != 0.0 && value.abs() < 0.1 {
        if value.abs() < 0.005 {
            "<\u{a0}0.01\u{a0}%".to_string()
        } else {
            format!("{}\u{a0}%", fixed(value, 2))
        }
    } else {
        format!("{}\u{a0}%", fixed(value, 1))
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
    let (hours, minutes, rest) = (whole / 3600, whole / 60 % 60, whole % 60);
    if hours > 0 {
        format!("{hours}\u{a0}h {minutes:02}\u{a0}min")
    } else {
        format!("{minutes}\u{a0}min {rest:02}\u{a0}s")
    }
}

/// A share in percent with two or three digits, e.g. `1 %`, `0.13 %`, `26 %`.
pub fn short_percent(share: f64) -> String {
    let percent = 100.0 * share;
    let decimals = if percent > 0.0 { (1.0 - percent.log10().floor()).clamp(0.0, 9.0) as usize } else { 0 };
    let text = format!("{percent:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} %")
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
        assert_eq!(count(1_234_567), "1\u{a0}234\u{a0}567");
        assert_eq!(fixed(-0.0001, 2), "0.00");
        assert_eq!(fixed(-1.25, 1), "\u{2212}1.2");
        assert_eq!(three_digits(0.012345), "0.0123");
        assert_eq!(three_digits(2.5e-7), "2.50e\u{2212}7");
        assert_eq!(percent(0.9653), "96.5\u{a0}%");
        assert_eq!(percent(0.0003), "0.03\u{a0}%");
        assert_eq!(duration(3725.0), "1\u{a0}h 02\u{a0}min");
        assert_eq!(duration(125.0), "2\u{a0}min 05\u{a0}s");
    }

    #[test]
    fn shares_are_written_as_people_read_them() {
        let found = [0.01, 0.0013, 0.26, 0.0, 0.12345, 1e-9].map(short_percent);
        assert_eq!(found, ["1 %", "0.13 %", "26 %", "0 %", "12 %", "0.0000001 %"]);
    }
}
