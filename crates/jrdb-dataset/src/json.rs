//! JSON as programs write it: with `NaN` and `Infinity`, which are no JSON.

use std::borrow::Cow;
use std::path::Path;

use serde::de::DeserializeOwned;

use crate::{Error, file};

/// Words for numbers that JSON has not, as Python, JavaScript and C write them.
const WORDS: [&str; 8] = ["NaN", "nan", "-nan", "-NaN", "Infinity", "-Infinity", "inf", "-inf"];

/// Reads a JSON file; a number that is none is a text with its name, so that it costs what it stands in and not the file.
pub(crate) fn read<T: DeserializeOwned>(path: &Path, expected: &'static str) -> Result<T, Error> {
    parse(&file::read_text(path)?, path, expected)
}

/// The same of a text.
pub(crate) fn parse<T: DeserializeOwned>(
    text: &str,
    path: &Path,
    expected: &'static str,
) -> Result<T, Error> {
    let parsed = serde_json::from_str(text).or_else(|error| match tolerant(text) {
        Cow::Borrowed(_) => Err(error),
        Cow::Owned(text) => serde_json::from_str(&text),
    });
    parsed.map_err(|source| Error::Json { expected, path: path.into(), source })
}

/// The text with such numbers in quotes; as it is where there are none.
pub(crate) fn tolerant(text: &str) -> Cow<'_, str> {
    let mut out = String::new();
    let (mut copied, mut at) = (0, 0);
    let bytes = text.as_bytes();
    while at < bytes.len() {
        match bytes[at] {
            b'"' => at = end_of_text(bytes, at),
            byte if byte == b'-' || byte.is_ascii_alphabetic() => {
                let end = at + word_length(&bytes[at..]);
                let word = text.get(at..end).filter(|word| WORDS.contains(word));
                if let Some(word) = word {
                    out.push_str(&text[copied..at]);
                    out.push('"');
                    out.push_str(if word.ends_with(['n', 'N']) { "NaN" } else { word });
                    out.push('"');
                    copied = end;
                }
                at = end;
            }
            _ => at += 1,
        }
    }
    if copied == 0 {
        return Cow::Borrowed(text);
    }
    out.push_str(&text[copied..]);
    Cow::Owned(out)
}

/// Where the text that starts here with a quote ends.
fn end_of_text(bytes: &[u8], start: usize) -> usize {
    let mut at = start + 1;
    while at < bytes.len() && bytes[at] != b'"' {
        at += if bytes[at] == b'\\' { 2 } else { 1 };
    }
    (at + 1).min(bytes.len())
}

/// Length of a word at the start: a sign and letters.
fn word_length(bytes: &[u8]) -> usize {
    let letters = bytes[1..].iter().take_while(|byte| byte.is_ascii_alphabetic());
    1 + letters.count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_are_none_become_texts() {
        let text = r#"{"a": NaN, "NaN, -1": [-Infinity, 1, -2], "b\\\": NaN": inf, "é": null}"#;
        let value: serde_json::Value = parse(text, Path::new("x"), "x").unwrap();
        assert_eq!(value["a"], "NaN");
        assert_eq!(value["NaN, -1"], serde_json::json!(["-Infinity", 1, -2]));
        assert_eq!(value["b\\\": NaN"], "inf");
        assert_eq!(tolerant(r#"{"NaN": -1, "t": true}"#), r#"{"NaN": -1, "t": true}"#);
        assert_eq!(tolerant("[-nan]"), r#"["NaN"]"#);
    }
}
