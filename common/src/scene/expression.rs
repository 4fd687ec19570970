//! Evaluates a quantity as written in a scene: a number with its unit, or an expression over parameters and such
//! numbers, with its dimension.
//!
//! Grammar: `sum = product (("+" | "-") product)*`, `product = signed (("*" | "/") signed)*`,
//! `signed = "-"* power`, `power = primary ("^" integer)?`, `primary = number unit? | name | name "(" sum ")" |
//! "(" sum ")"`. A unit belongs to its number and binds tightest: `1 / 2 mm` is 1/(2 mm). Units multiply by a space
//! or `*` and divide by `/`, as in `6.55 N s/m`, `9.81 m/s^2`, `1.3e-13 1/Pa`. Since no parameter may be called
//! like a unit, `2 mm * width` and `2 N * s` cannot be confused. Functions: sin, cos, tan, sqrt, abs; constant: pi.
//! Sine and cosine come from `libm`, so that a scene has the same bits on every machine.

use super::expression_error::DEPTH_LIMIT;
pub use super::expression_error::ExpressionError;
use super::quantity::{AngleUnit, Dimension, Quantity, Unit, unit};

/// Largest exponent of a power.
const EXPONENT_LIMIT: f64 = 12.0;

/// Names of the functions and of the constant.
pub const RESERVED: [&str; 6] = ["sin", "cos", "tan", "sqrt", "abs", "pi"];

/// Evaluates `text`; `lookup` gives the value of a parameter by name.
///
/// # Errors
/// [`ExpressionError`]; whatever `lookup` returns as an error is passed on.
pub fn evaluate(
    text: &str,
    lookup: &mut dyn FnMut(&str) -> Result<Quantity, ExpressionError>,
) -> Result<Quantity, ExpressionError> {
    let tokens = tokens(text)?;
    if tokens.is_empty() {
        return Err(ExpressionError::Empty);
    }
    let mut parser = Parser { tokens: &tokens, next: 0, depth: 0, lookup };
    let quantity = parser.sum()?;
    if let Some(token) = parser.peek() {
        let expected = "an operator; a unit follows a number, as in 2 * 1 mm";
        return Err(ExpressionError::Unexpected(token.to_string(), expected));
    }
    if quantity.value.is_finite() { Ok(quantity) } else { Err(ExpressionError::NotFinite) }
}

/// Reads a unit alone, e.g. `N s/m`.
///
/// # Errors
/// [`ExpressionError`] if the text is not a unit.
pub fn read_unit(text: &str) -> Result<Unit, ExpressionError> {
    let one = evaluate(&format!("1 {text}"), &mut |name| {
        Err(ExpressionError::UnknownName { name: name.to_owned(), nearest: None })
    })?;
    Ok(Unit { multiply: one.value, divide: 1.0, dimension: one.dimension, angle: one.angle })
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Token<'t> {
    Number(f64, &'t str),
    Name(&'t str),
    Sign(char),
}

impl std::fmt::Display for Token<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Token::Number(_, text) | Token::Name(text) => f.write_str(text),
            Token::Sign(sign) => write!(f, "{sign}"),
        }
    }
}

fn tokens(text: &str) -> Result<Vec<Token<'_>>, ExpressionError> {
    let mut tokens = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let is_number = first.is_ascii_digit() || first == '.';
        let length = if is_number {
            number_length(rest.as_bytes())
        } else if first.is_alphabetic() || first == '_' {
            rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())
        } else {
            first.len_utf8()
        };
        let (piece, after) = rest.split_at(length);
        tokens.push(match (first, tokens.last()) {
            _ if is_number => {
                Token::Number(piece.parse().map_err(|_| ExpressionError::Character(first))?, piece)
            }
            ('%' | '_', _) => Token::Name(piece),
            _ if first.is_alphabetic() => Token::Name(piece),
            ('+' | '-' | '*' | '/' | '^' | '(' | ')', _) => Token::Sign(first),
            (',', Some(Token::Number(_, before))) if after.starts_with(|c: char| c.is_ascii_digit()) => {
                return Err(ExpressionError::Comma((*before).to_owned(), after.to_owned()));
            }
            _ => return Err(ExpressionError::Character(first)),
        });
        rest = after.trim_start();
    }
    Ok(tokens)
}

/// Length of the number at the start: digits, a point, an exponent only if digits follow it.
fn number_length(bytes: &[u8]) -> usize {
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut length = digits(0);
    if bytes.get(length) == Some(&b'.') {
        length += 1 + digits(length + 1);
    }
    if matches!(bytes.get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(length + 1), Some(b'+' | b'-')));
        let exponent = bytes.get(length + 1 + sign..).map_or(0, |_| digits(length + 1 + sign));
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    length
}

struct Parser<'p, 't> {
    tokens: &'p [Token<'t>],
    next: usize,
    depth: usize,
    lookup: &'p mut dyn FnMut(&str) -> Result<Quantity, ExpressionError>,
}

impl<'t> Parser<'_, 't> {
    fn peek(&self) -> Option<Token<'t>> {
        self.tokens.get(self.next).copied()
    }

    fn accept(&mut self, sign: char) -> bool {
        let found = self.peek() == Some(Token::Sign(sign));
        self.next += usize::from(found);
        found
    }

    fn sum(&mut self) -> Result<Quantity, ExpressionError> {
        let mut left = self.product()?;
        loop {
            let (verb, sign) = match self.peek() {
                Some(Token::Sign('+')) => ("add", 1.0),
                Some(Token::Sign('-')) => ("subtract", -1.0),
                _ => return Ok(left),
            };
            self.next += 1;
            let right = self.product()?;
            if left.dimension != right.dimension {
                return Err(ExpressionError::Mixed(verb, left.dimension, right.dimension));
            }
            left.value += sign * right.value;
            left.angle = left.angle.plus(right.angle);
        }
    }

    fn product(&mut self) -> Result<Quantity, ExpressionError> {
        let mut left = self.signed()?;
        loop {
            let power = match self.peek() {
                Some(Token::Sign('*')) => 1,
                Some(Token::Sign('/')) => -1,
                _ => return Ok(left),
            };
            self.next += 1;
            let right = self.signed()?;
            let value = if power < 0 { left.value / right.value } else { left.value * right.value };
            let dimension = left.dimension.times(right.dimension.power(power));
            left = Quantity { value, dimension, angle: angle_of_product(&left, &right) };
        }
    }

    fn signed(&mut self) -> Result<Quantity, ExpressionError> {
        let mut sign = 1.0;
        while let Some(Token::Sign(found @ ('-' | '+'))) = self.peek() {
            self.next += 1;
            sign = if found == '-' { -sign } else { sign };
        }
        let mut quantity = self.power()?;
        quantity.value *= sign;
        Ok(quantity)
    }

    fn power(&mut self) -> Result<Quantity, ExpressionError> {
        let base = self.primary()?;
        if !self.accept('^') {
            return Ok(base);
        }
        let n = self.exponent()?;
        // Repeated multiplication: the same bits everywhere, unlike a library's pow.
        let product = (0..n.unsigned_abs()).fold(1.0, |product, _| product * base.value);
        let value = if n < 0 { 1.0 / product } else { product };
        let angle = if base.is_plain_number() { AngleUnit::Absent } else { AngleUnit::Open };
        Ok(Quantity { value, dimension: base.dimension.power(n), angle })
    }

    fn exponent(&mut self) -> Result<i16, ExpressionError> {
        let negative = self.accept('-');
        match self.peek() {
            Some(Token::Number(n, _)) if n.fract() == 0.0 && n <= EXPONENT_LIMIT => {
                self.next += 1;
                Ok(if negative { -(n as i16) } else { n as i16 })
            }
            _ => Err(ExpressionError::Exponent),
        }
    }

    fn primary(&mut self) -> Result<Quantity, ExpressionError> {
        const EXPECTED: &str = "a number, a parameter or a parenthesis";
        let token = self.peek().ok_or(ExpressionError::Incomplete(EXPECTED))?;
        self.next += 1;
        match token {
            Token::Number(value, _) => self.with_unit(value),
            Token::Sign('(') => self.parenthesis(),
            Token::Sign(sign) => Err(ExpressionError::Unexpected(sign.to_string(), EXPECTED)),
            Token::Name("pi") => {
                Ok(Quantity { angle: AngleUnit::Open, ..Quantity::plain(std::f64::consts::PI) })
            }
            Token::Name(name) if self.accept('(') => function(name, self.parenthesis()?),
            Token::Name(name) if unit(name).is_some() => {
                Err(ExpressionError::Unexpected(name.to_owned(), "a number before the unit"))
            }
            Token::Name(name) => (self.lookup)(name),
        }
    }

    /// What follows an opening parenthesis.
    fn parenthesis(&mut self) -> Result<Quantity, ExpressionError> {
        self.depth += 1;
        if self.depth > DEPTH_LIMIT {
            return Err(ExpressionError::TooDeep);
        }
        let inside = self.sum()?;
        self.depth -= 1;
        if self.accept(')') {
            return Ok(inside);
        }
        match self.peek() {
            Some(token) => Err(ExpressionError::Unexpected(token.to_string(), "`)`")),
            None => Err(ExpressionError::Incomplete("`)`")),
        }
    }

    fn unit_at(&self, position: usize) -> Option<Unit> {
        let Some(Token::Name(name)) = self.tokens.get(position) else { return None };
        unit(name)
    }

    /// The unit after a number, if there is one.
    fn with_unit(&mut self, number: f64) -> Result<Quantity, ExpressionError> {
        let (mut multiply, mut divide, mut dimension) = (1.0, 1.0, Dimension::NONE);
        let mut angle = AngleUnit::Absent;
        // `2 1/Pa`: the 1 only carries the fraction bar.
        let bare_one = matches!(self.peek(), Some(Token::Number(1.0, _)));
        let has_parenthesis = self.tokens.get(self.next + 2) == Some(&Token::Sign('('));
        if bare_one
            && self.tokens.get(self.next + 1) == Some(&Token::Sign('/'))
            && self.unit_at(self.next + 2 + usize::from(has_parenthesis)).is_some()
        {
            self.next += 1;
        }
        let mut after_bar = false;
        let mut times = |factor: Unit, n: i16| {
            let (above, under) =
                if n < 0 { (factor.divide, factor.multiply) } else { (factor.multiply, factor.divide) };
            for _ in 0..n.unsigned_abs() {
                multiply *= above;
                divide *= under;
            }
            dimension = dimension.times(factor.dimension.power(n));
            if factor.angle == AngleUnit::Present {
                angle = AngleUnit::Present;
            }
        };
        loop {
            if let Some(below) = self.units_in_parenthesis()? {
                below.into_iter().for_each(|(factor, n)| times(factor, -n));
                after_bar = true;
                continue;
            }
            let (below, skip) = match self.peek() {
                Some(Token::Sign('/')) => (true, 1),
                Some(Token::Sign('*')) => (false, 1),
                _ => (false, 0),
            };
            let Some(factor) = self.unit_at(self.next + skip) else { break };
            if after_bar && skip == 0 {
                let name = self.tokens[self.next].to_string();
                return Err(ExpressionError::AmbiguousUnit(name));
            }
            after_bar |= below;
            self.next += skip + 1;
            let n = if self.accept('^') { self.exponent()? } else { 1 };
            times(factor, if below { -n } else { n });
        }
        self.refuse_unknown_unit()?;
        Ok(Quantity { value: number * multiply / divide, dimension, angle })
    }

    /// Units with their exponents in a parenthesis behind a fraction bar, as in `mm^3/(N m)`; nothing is read if that holds anything else.
    fn units_in_parenthesis(&mut self) -> Result<Option<Vec<(Unit, i16)>>, ExpressionError> {
        let start = self.next;
        let mut found = Vec::new();
        if self.accept('/') && self.accept('(') {
            loop {
                // Before a further factor there may be a sign of multiplication.
                let skip = usize::from(!found.is_empty() && self.peek() == Some(Token::Sign('*')));
                let Some(factor) = self.unit_at(self.next + skip) else { break };
                self.next += skip + 1;
                found.push((factor, if self.accept('^') { self.exponent()? } else { 1 }));
            }
            if !found.is_empty() && self.accept(')') {
                return Ok(Some(found));
            }
        }
        self.next = start;
        Ok(None)
    }

    /// Refuses a name after a number that is neither a unit nor the name of a parameter, function or constant.
    fn refuse_unknown_unit(&mut self) -> Result<(), ExpressionError> {
        if let Some(Token::Name(name)) = self.peek()
            && unit(name).is_none()
            && !RESERVED.contains(&name)
            && let Err(ExpressionError::UnknownName { nearest: None, .. }) = (self.lookup)(name)
        {
            return Err(ExpressionError::UnknownUnit(name.to_owned()));
        }
        Ok(())
    }
}

/// That of a product or quotient: a plain number changes nothing; of two units of angle, or of none among units that may cancel to
/// an angle, it is open.
fn angle_of_product(left: &Quantity, right: &Quantity) -> AngleUnit {
    match (left.is_plain_number(), right.is_plain_number()) {
        (true, _) => right.angle,
        (_, true) => left.angle,
        _ => AngleUnit::Open,
    }
}

fn function(name: &str, x: Quantity) -> Result<Quantity, ExpressionError> {
    let angle = |function, f: fn(f64) -> f64| {
        if x.dimension != Dimension::NONE {
            return Err(ExpressionError::Argument(function, x.dimension, "an angle or a plain number"));
        }
        Ok(Quantity::plain(f(x.value)))
    };
    match name {
        "sin" => angle("sin", libm::sin),
        "cos" => angle("cos", libm::cos),
        "tan" => angle("tan", libm::tan),
        "abs" => Ok(Quantity { value: x.value.abs(), ..x }),
        "sqrt" => match x.dimension.square_root() {
            Some(dimension) => Ok(Quantity { value: x.value.sqrt(), dimension, angle: AngleUnit::Open }),
            None => {
                let expected = "a quantity whose dimension is a square";
                Err(ExpressionError::Argument("sqrt", x.dimension, expected))
            }
        },
        _ => Err(ExpressionError::UnknownName { name: name.to_owned(), nearest: None }),
    }
}
