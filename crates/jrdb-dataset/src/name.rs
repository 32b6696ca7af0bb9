//! Names that become folders and files.

use crate::Error;

/// Longest name, bytes: file systems allow 255, and endings are added.
const BYTES_MAX: usize = 200;

/// Checks that a sequence's name can be the name of a folder and of a file, and of nothing outside of them.
///
/// # Errors
/// [`Error::Name`] for a name that is empty, `.`, `..` or over 200 bytes, or has a slash, a backslash or a control
/// character in it.
pub fn check_sequence_name(name: &str) -> Result<(), Error> {
    let is_separator = |c: char| matches!(c, '/' | '\\') || c.is_control();
    let is_plain = !matches!(name, "" | "." | "..") && name.len() <= BYTES_MAX;
    if is_plain && !name.contains(is_separator) {
        return Ok(());
    }
    Err(Error::Name { found: name.into() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_plain() {
        for good in ["plaza_0", "bytes-cafe-2019-02-07_0", "Straße 7", "...", "a.b"] {
            assert!(check_sequence_name(good).is_ok(), "{good:?}");
        }
        let long = "x".repeat(BYTES_MAX + 1);
        for bad in ["", ".", "..", "/tmp/x", "../x", "a/b", "a\\b", "a\nb", "a\0b", "\u{7f}", &long]
        {
            let error = check_sequence_name(bad).unwrap_err().to_string();
            assert!(error.starts_with("expected a sequence name"), "{error}");
        }
    }
}
