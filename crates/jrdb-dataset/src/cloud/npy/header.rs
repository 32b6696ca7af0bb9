//! The text in front of the numbers: a Python dictionary, `{'descr': '<f4', 'fortran_order': False, 'shape': (7, 3), }`.

use std::str::FromStr;

use super::error::{NpyError, bad};
use crate::cloud::columns::{ByteOrder, Scalar};

/// What the header says.
pub(super) struct Layout {
    pub(super) item: Item,
    pub(super) fortran_order: bool,
    pub(super) shape: Vec<usize>,
}

/// What the array is made of.
pub(super) enum Item {
    Number { scalar: Scalar, order: ByteOrder },
    Record { fields: Vec<Named>, bytes: usize },
}

/// A field of a record that is one number.
pub(super) struct Named {
    pub(super) name: String,
    pub(super) scalar: Scalar,
    pub(super) order: ByteOrder,
    /// Bytes of a record before this field.
    pub(super) offset: usize,
}

impl FromStr for Layout {
    type Err = NpyError;

    fn from_str(text: &str) -> Result<Self, NpyError> {
        let descr = value(text, "descr", "a key descr")?;
        let item = if descr.starts_with('[') { record(descr)? } else { number(descr)? };
        let order = value(text, "fortran_order", "a key fortran_order")?;
        let fortran_order = match order {
            _ if order.starts_with("True") => true,
            _ if order.starts_with("False") => false,
            _ => return Err(bad("fortran_order True or False", order)),
        };
        let shape = value(text, "shape", "a key shape")?;
        let numbers = numbers(shape).ok_or_else(|| bad("a shape (points, 3 to 16)", shape))?;
        Ok(Self { item, fortran_order, shape: numbers })
    }
}

const NUMBERS: &str = "descr of a float or an integer such as '<f4'";

fn number(descr: &str) -> Result<Item, NpyError> {
    let known = unquoted(descr).and_then(|(word, _)| scalar(word));
    let (scalar, order) = known.ok_or_else(|| bad(NUMBERS, descr))?;
    Ok(Item::Number { scalar, order })
}

/// `'<f4'` as a type and a byte order.
fn scalar(word: &str) -> Option<(Scalar, ByteOrder)> {
    let order = if word.starts_with('>') { ByteOrder::Big } else { ByteOrder::Little };
    let scalar = match word.trim_start_matches(['<', '>', '|', '=']) {
        "f2" => Scalar::F16,
        "f4" => Scalar::F32,
        "f8" => Scalar::F64,
        "i1" => Scalar::I8,
        "i2" => Scalar::I16,
        "i4" => Scalar::I32,
        "i8" => Scalar::I64,
        "u1" | "b1" => Scalar::U8,
        "u2" => Scalar::U16,
        "u4" => Scalar::U32,
        "u8" => Scalar::U64,
        _ => return None,
    };
    Some((scalar, order))
}

/// Bytes of a number of a type that need not be one that is read: `V12`, `S5`, `c8`, `M8[ns]`; a character of `U` takes four.
fn size(word: &str) -> Option<usize> {
    let word = word.trim_start_matches(['<', '>', '|', '=']);
    let word = word.split('[').next()?;
    let (letter, number) = word.split_at_checked(1)?;
    let number: usize = number.parse().ok()?;
    if letter == "U" { number.checked_mul(4) } else { Some(number) }
}

/// A list of `('name', '<f4')` and `('name', '<f4', (3,))`.
fn record(descr: &str) -> Result<Item, NpyError> {
    const EXPECTED: &str = "descr of fields, [('x', '<f4'), ..]";
    let (mut fields, mut offset, mut rest) = (Vec::new(), 0_usize, &descr[1..]);
    loop {
        rest = rest.trim_start_matches([' ', ',']);
        if rest.starts_with(']') {
            return Ok(Item::Record { fields, bytes: offset });
        }
        let (name, word, count, after) = field(rest).ok_or_else(|| bad(EXPECTED, descr))?;
        if let Some((scalar, order)) = scalar(word).filter(|_| count == 1) {
            fields.push(Named { name: name.into(), scalar, order, offset });
        }
        let bytes = size(word).and_then(|size| size.checked_mul(count));
        offset = bytes
            .and_then(|bytes| offset.checked_add(bytes))
            .ok_or_else(|| bad(EXPECTED, descr))?;
        rest = after;
    }
}

/// One field: its name, type and number of numbers, and what follows it.
fn field(text: &str) -> Option<(&str, &str, usize, &str)> {
    let text = text.strip_prefix('(')?.trim_start();
    // A field with a title is ((title, name), ..).
    let (titled, text) = match text.strip_prefix('(') {
        Some(inner) => (true, unquoted(inner.trim_start())?.1.trim_start_matches([' ', ','])),
        None => (false, text),
    };
    let (name, mut rest) = unquoted(text)?;
    if titled {
        rest = rest.trim_start().strip_prefix(')')?;
    }
    let (word, rest) = unquoted(rest.trim_start_matches([' ', ',']))?;
    let rest = rest.trim_start_matches([' ', ',']);
    if let Some(after) = rest.strip_prefix(')') {
        return Some((name, word, 1, after));
    }
    let count = numbers(rest)?.into_iter().try_fold(1_usize, usize::checked_mul)?;
    let after = rest.split_once(')')?.1.trim_start().strip_prefix(')')?;
    Some((name, word, count, after))
}

/// What follows a key of the dictionary.
fn value<'a>(header: &'a str, key: &str, expected: &'static str) -> Result<&'a str, NpyError> {
    let after = |quote: char| header.split_once(&format!("{quote}{key}{quote}"));
    let found = after('\'')
        .or_else(|| after('"'))
        .and_then(|(_, rest)| rest.trim_start().strip_prefix(':'));
    found.map(str::trim_start).ok_or_else(|| bad(expected, header))
}

/// The text in quotes at the start, and what follows it.
fn unquoted(text: &str) -> Option<(&str, &str)> {
    let quote = text.chars().next().filter(|first| matches!(first, '\'' | '"'))?;
    text[1..].split_once(quote)
}

/// The numbers of a tuple: `(7, 3)`, `(7,)`.
fn numbers(tuple: &str) -> Option<Vec<usize>> {
    let (inside, _) = tuple.strip_prefix('(')?.split_once(')')?;
    let inside = inside.trim().trim_end_matches(',');
    if inside.is_empty() {
        return Some(Vec::new());
    }
    inside.split(',').map(|number| number.trim().parse().ok()).collect()
}
