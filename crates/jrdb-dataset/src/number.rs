//! Numbers as data files spell them: bare, as text, in lists, or many in one text.

use std::fmt;
use std::path::Path;

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};
use serde_json::Value;

/// A number, or a text that holds one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Real(pub(crate) f64);

impl<'de> Deserialize<'de> for Real {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Reals(numbers) = Reals::deserialize(deserializer)?;
        match numbers[..] {
            [number] => Ok(Self(number)),
            _ => Err(D::Error::invalid_length(numbers.len(), &"one number")),
        }
    }
}

/// Numbers in reading order: a list (of lists), or a text with spaces between them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Reals(pub(crate) Vec<f64>);

impl<'de> Deserialize<'de> for Reals {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(RealsVisitor)
    }
}

struct RealsVisitor;

impl<'de> Visitor<'de> for RealsVisitor {
    type Value = Reals;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("numbers")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Reals, E> {
        Ok(Reals(vec![value]))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Reals, E> {
        Ok(Reals(vec![value as f64]))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Reals, E> {
        Ok(Reals(vec![value as f64]))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Reals, E> {
        let number = |word: &str| {
            word.parse().map_err(|_| E::invalid_value(serde::de::Unexpected::Str(word), &self))
        };
        text.split_whitespace().map(number).collect::<Result<_, E>>().map(Reals)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Reals, A::Error> {
        let mut numbers = Vec::new();
        while let Some(Reals(more)) = list.next_element()? {
            numbers.extend(more);
        }
        Ok(Reals(numbers))
    }
}

/// The numbers of a key, if they are as many as expected and finite.
pub(crate) fn exactly<const N: usize>(
    reals: &Reals,
    key: &str,
    path: &Path,
) -> Result<[f64; N], crate::Error> {
    let numbers = reals.0.as_slice();
    <[f64; N]>::try_from(numbers)
        .ok()
        .filter(|numbers| numbers.iter().all(|n| n.is_finite()))
        .ok_or_else(|| {
            let expected = format!("{N} finite numbers as {key}");
            crate::Error::content(path, expected, format!("{numbers:?}"))
        })
}

/// The same of a value that may be anything, or nothing.
pub(crate) fn exactly_in<const N: usize>(
    value: Option<&Value>,
    key: &str,
    path: &Path,
) -> Result<[f64; N], crate::Error> {
    match value.map(Reals::deserialize) {
        Some(Ok(reals)) => exactly(&reals, key, path),
        _ => {
            let found = value.map_or_else(|| "no such key".into(), Value::to_string);
            Err(crate::Error::content(path, format!("{N} finite numbers as {key}"), found))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_texts_and_single_numbers_are_the_same() {
        let reals = |json: &str| serde_json::from_str::<Reals>(json).map(|r| r.0);
        assert_eq!(reals("[1, 2.5, -3]").unwrap(), [1.0, 2.5, -3.0]);
        assert_eq!(reals(r#""1 2.5\n-3e0\n""#).unwrap(), [1.0, 2.5, -3.0]);
        assert_eq!(reals(r#"[[1, "2.5"], [-3]]"#).unwrap(), [1.0, 2.5, -3.0]);
        assert_eq!(reals("7").unwrap(), [7.0]);
    }

    #[test]
    fn what_is_not_a_number_is_named() {
        let error = serde_json::from_str::<Reals>(r#""1 two""#).unwrap_err().to_string();
        assert!(error.starts_with(r#"invalid value: string "two", expected numbers"#), "{error}");
        assert!(serde_json::from_str::<Real>("[1, 2]").is_err());
        assert!(serde_json::from_str::<Real>("true").is_err());
        assert_eq!(serde_json::from_str::<Real>(r#""-1.5""#).unwrap(), Real(-1.5));
    }
}
