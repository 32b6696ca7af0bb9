//! Clouds in NumPy's `.npy` format (versions 1, 2 and 3): arrays of a row for each point.

use std::str::FromStr;

use jrdb_types::PointCloud;

use super::columns::{ByteOrder, Column, Columns, Scalar};
use super::fields::{Fields, excerpt, filled};

const MAGIC: &[u8] = b"\x93NUMPY";

/// Why bytes are not an array of points.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NpyError {
    /// The bytes do not start as an `.npy` file does, or end within its header.
    #[error("expected an npy header of version 1, 2 or 3, found {found}")]
    NoHeader {
        /// What was found instead.
        found: String,
    },
    /// A part of the header is absent or not what a cloud needs.
    #[error("expected {expected} in the npy header, found {found:?}")]
    BadHeader {
        /// What the header should say.
        expected: &'static str,
        /// The header, or the part of it.
        found: String,
    },
    /// The array takes more bytes than there are.
    #[error("expected {expected} bytes for {rows} x {columns} numbers, found {found}")]
    TooShort {
        /// Bytes that the shape asks for.
        expected: u128,
        /// Rows of the shape.
        rows: usize,
        /// Columns of the shape.
        columns: usize,
        /// Bytes after the header.
        found: usize,
    },
}

/// Parses an `.npy` file as the sweep of a sensor.
///
/// The array has a row `x y z`, or `x y z intensity` and more, for each point, in C or Fortran order, as `<f4` or
/// `<f8`. Columns after the fourth are passed over.
///
/// ```
/// let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 3), }\n";
/// let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
/// bytes.extend((header.len() as u16).to_le_bytes());
/// bytes.extend(header.bytes());
/// bytes.extend([1.0_f32, 2.0, 3.0].iter().flat_map(|v| v.to_le_bytes()));
/// let cloud = jrdb_dataset::cloud::npy::parse(&bytes, "top").unwrap();
/// assert_eq!((cloud.y[0], cloud.intensity.len()), (2.0, 0));
/// ```
///
/// # Errors
/// [`NpyError`] for any other array.
pub fn parse(bytes: &[u8], sensor: &str) -> Result<PointCloud, NpyError> {
    filled(sensor, |cloud| fill(bytes, Fields::All, cloud))
}

/// [`parse`], of some fields only, into a cloud.
pub(super) fn fill(bytes: &[u8], fields: Fields, cloud: &mut PointCloud) -> Result<(), NpyError> {
    let (header, body) = split_header(bytes)?;
    let Header { scalar, fortran_order, rows, columns } = header.parse()?;
    let expected = (rows as u128 * columns as u128).saturating_mul(scalar.size() as u128);
    if expected > body.len() as u128 {
        return Err(NpyError::TooShort { expected, rows, columns, found: body.len() });
    }
    let column = |index: usize| {
        let (start, stride) = if fortran_order { (index * rows, 1) } else { (index, columns) };
        Column {
            scalar,
            start: start * scalar.size(),
            stride: stride.saturating_mul(scalar.size()),
        }
    };
    let intensity = (columns > 3 && fields == Fields::All).then(|| column(3));
    let columns = Columns { xyz: [0, 1, 2].map(column), intensity };
    columns.fill(body, rows, ByteOrder::Little, cloud);
    Ok(())
}

/// The header's text, and what follows it.
fn split_header(bytes: &[u8]) -> Result<(&str, &[u8]), NpyError> {
    let none = |found: &str| NpyError::NoHeader { found: found.into() };
    let ends = || none("the end of the file");
    let after = bytes.strip_prefix(MAGIC).ok_or_else(|| none("another kind of file"))?;
    let (version, after) = after.split_first_chunk::<2>().ok_or_else(ends)?;
    let (length, after) = match version[0] {
        1 => {
            let (length, after) = after.split_first_chunk().ok_or_else(ends)?;
            (usize::from(u16::from_le_bytes(*length)), after)
        }
        2 | 3 => {
            let (length, after) = after.split_first_chunk().ok_or_else(ends)?;
            (u32::from_le_bytes(*length) as usize, after)
        }
        other => return Err(none(&format!("version {other}"))),
    };
    let (header, body) = after.split_at_checked(length).ok_or_else(ends)?;
    let header = std::str::from_utf8(header).map_err(|_| none("a header that is not text"))?;
    Ok((header, body))
}

struct Header {
    scalar: Scalar,
    fortran_order: bool,
    rows: usize,
    columns: usize,
}

/// The header is a Python dictionary: `{'descr': '<f4', 'fortran_order': False, 'shape': (7, 3), }`.
impl FromStr for Header {
    type Err = NpyError;

    fn from_str(text: &str) -> Result<Self, NpyError> {
        let descr = value(text, "descr", "a key descr")?;
        let scalar = match unquoted(descr) {
            Some("<f4") => Scalar::F32,
            Some("<f8") => Scalar::F64,
            _ => return Err(bad("descr '<f4' or '<f8'", descr)),
        };
        let order = value(text, "fortran_order", "a key fortran_order")?;
        let fortran_order = match order {
            _ if order.starts_with("True") => true,
            _ if order.starts_with("False") => false,
            _ => return Err(bad("fortran_order True or False", order)),
        };
        let shape = value(text, "shape", "a key shape")?;
        let (rows, columns) = rows_and_columns(shape)
            .filter(|&(_, columns)| columns >= 3)
            .ok_or_else(|| bad("a shape (points, 3 or more)", shape))?;
        Ok(Self { scalar, fortran_order, rows, columns })
    }
}

fn bad(expected: &'static str, found: &str) -> NpyError {
    NpyError::BadHeader { expected, found: excerpt(found.trim_end()) }
}

/// What follows a key of the dictionary.
fn value<'a>(header: &'a str, key: &str, expected: &'static str) -> Result<&'a str, NpyError> {
    let after = |quote: char| header.split_once(&format!("{quote}{key}{quote}"));
    let found = after('\'')
        .or_else(|| after('"'))
        .and_then(|(_, rest)| rest.trim_start().strip_prefix(':'));
    found.map(str::trim_start).ok_or_else(|| bad(expected, header))
}

fn unquoted(text: &str) -> Option<&str> {
    let quote = text.chars().next().filter(|first| matches!(first, '\'' | '"'))?;
    text[1..].split_once(quote).map(|(inside, _)| inside)
}

fn rows_and_columns(shape: &str) -> Option<(usize, usize)> {
    let (inside, _) = shape.strip_prefix('(')?.split_once(')')?;
    let mut numbers = inside.split(',').map(|number| number.trim().parse::<usize>());
    let (rows, columns) = (numbers.next()?.ok()?, numbers.next()?.ok()?);
    numbers.next().is_none().then_some((rows, columns))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn file(version: u8, header: &str, body: &[u8]) -> Vec<u8> {
        let mut bytes = [MAGIC, &[version, 0]].concat();
        match version {
            1 => bytes.extend((header.len() as u16).to_le_bytes()),
            _ => bytes.extend((header.len() as u32).to_le_bytes()),
        }
        [&bytes, header.as_bytes(), body].concat()
    }

    fn header(descr: &str, fortran_order: &str, shape: &str) -> String {
        format!(
            "{{'descr': '{descr}', 'fortran_order': {fortran_order}, 'shape': {shape}, }}      \n"
        )
    }

    fn floats(values: &[f32]) -> Vec<u8> {
        values.iter().flat_map(|value| value.to_le_bytes()).collect()
    }

    fn error(bytes: &[u8]) -> String {
        parse(bytes, "s").unwrap_err().to_string()
    }

    #[test]
    fn rows_may_lie_one_after_the_other_or_column_by_column() {
        let values = floats(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0]);
        for version in 1..=3 {
            let cloud =
                parse(&file(version, &header("<f4", "False", "(2, 5)"), &values), "s").unwrap();
            assert_eq!((cloud.y, cloud.intensity), (vec![2.0, 7.0], vec![4.0, 9.0]));
            let cloud =
                parse(&file(version, &header("<f4", "True", "(2, 5)"), &values), "s").unwrap();
            assert_eq!((cloud.y, cloud.intensity), (vec![3.0, 4.0], vec![7.0, 8.0]));
        }
    }

    #[test]
    fn doubles_are_narrowed_and_gaps_are_counted() {
        let values = [0.1, 2.0, 3.0, 1e300, 0.0, 0.0, f64::NAN, 0.0, 0.0_f64];
        let body: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let cloud = parse(&file(1, &header("<f8", "False", "(3, 3)"), &body), "s").unwrap();
        assert_eq!((&cloud.x[..], cloud.skipped, cloud.intensity.len()), (&[0.1_f32][..], 2, 0));
    }

    #[test]
    fn trouble_says_what_was_expected_and_found() {
        let good = header("<f4", "False", "(1, 3)");
        let cases = [
            (
                b"PK\x03\x04".to_vec(),
                "expected an npy header of version 1, 2 or 3, found another kind of file",
            ),
            (file(4, &good, &[]), "expected an npy header of version 1, 2 or 3, found version 4"),
            (
                file(1, &good, &[])[..40].to_vec(),
                "expected an npy header of version 1, 2 or 3, found the end of the file",
            ),
            (file(1, &good, &[0; 11]), "expected 12 bytes for 1 x 3 numbers, found 11"),
            (
                file(1, &good.replace("<f4", ">f4"), &[]),
                r#"expected descr '<f4' or '<f8' in the npy header, found "'>f4', 'fortran_order': False, 'shape': (1, 3), }""#,
            ),
            (
                file(1, "{'descr': [('x', '<f4')], }", &[]),
                r#"expected descr '<f4' or '<f8' in the npy header, found "[('x', '<f4')], }""#,
            ),
            (file(1, "{}", &[]), r#"expected a key descr in the npy header, found "{}""#),
            (
                file(1, &good.replace("(1, 3)", "(3,)"), &[]),
                r#"expected a shape (points, 3 or more) in the npy header, found "(3,), }""#,
            ),
        ];
        for (bytes, expected) in cases {
            assert_eq!(error(&bytes), expected);
        }
        for shape in ["(1, 2)", "()", "(1, 3, 1)", "(-1, 3)", "(1.0, 3)", "1, 3"] {
            assert!(
                error(&file(1, &good.replace("(1, 3)", shape), &[])).contains("a shape"),
                "{shape}"
            );
        }
        assert!(
            error(&file(1, &good.replace("False", "0"), &[]))
                .contains("fortran_order True or False")
        );
    }

    #[test]
    fn a_hostile_shape_is_refused_before_it_is_allocated() {
        for shape in ["(18446744073709551615, 3)", "(18446744073709551615, 18446744073709551615)"] {
            let bytes = file(1, &header("<f8", "False", shape), &[0; 100]);
            assert!(matches!(parse(&bytes, "s"), Err(NpyError::TooShort { .. })), "{shape}");
        }
        let no_rows = file(1, &header("<f8", "False", "(0, 18446744073709551615)"), &[]);
        assert!(parse(&no_rows, "s").unwrap().is_empty());
    }

    proptest! {
        #[test]
        fn random_and_mutated_files_never_panic(
            tail in prop::collection::vec(any::<u8>(), 0..200),
            at in 0..200_usize,
            value in any::<u8>(),
            version in 1..4_u8,
        ) {
            let _ = parse(&[MAGIC, &tail].concat(), "s");
            let mut bytes = file(version, &header("<f4", "True", "(4, 4)"), &[7; 64]);
            if let Some(byte) = bytes.get_mut(at) {
                *byte = value;
            }
            let _ = parse(&bytes, "s");
            bytes.truncate(at);
            let _ = parse(&bytes, "s");
        }
    }
}
