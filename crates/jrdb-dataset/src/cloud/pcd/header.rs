//! The text in front of the points: which fields there are, of what type, and where.

use std::collections::BTreeMap;

use super::encoding::Encoding;
use super::error::PcdError;
use crate::cloud::columns::Scalar;
use crate::cloud::fields::excerpt;

/// What a PCD header says, as far as a cloud needs it.
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) points: u64,
    /// Bytes of a point.
    pub(super) row_bytes: usize,
    /// Numbers in a line of an ASCII cloud.
    pub(super) columns_per_row: usize,
    pub(super) xyz: [Kept; 3],
    pub(super) intensity: Option<Kept>,
}

/// A field that becomes a column of the cloud; it has one number.
#[derive(Clone, Copy)]
pub(super) struct Kept {
    pub(super) scalar: Scalar,
    /// Bytes of a point before this field.
    pub(super) offset: usize,
    /// Numbers of a point before this field.
    pub(super) column: usize,
}

/// One field of a point.
struct Field {
    /// Type of its numbers; none where they cannot be kept.
    scalar: Option<Scalar>,
    /// Bytes of one number.
    size: usize,
    /// Numbers in the field.
    count: usize,
    offset: usize,
    column: usize,
}

fn scalar(letter: &str, size: usize) -> Option<Scalar> {
    match (letter, size) {
        ("F", 4) => Some(Scalar::F32),
        ("F", 8) => Some(Scalar::F64),
        ("U", 1) => Some(Scalar::U8),
        ("U", 2) => Some(Scalar::U16),
        _ => None,
    }
}

/// Keywords that matter; those that do not are `VERSION` and `VIEWPOINT`.
const KEYWORDS: [&str; 7] = ["FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "POINTS"];

/// The header's lines: the words after each keyword.
#[derive(Default)]
struct Lines<'a>(BTreeMap<&'a str, Vec<&'a str>>);

impl Header {
    /// Reads the header and gives back what follows it.
    pub(super) fn parse(bytes: &[u8]) -> Result<(Self, &[u8]), PcdError> {
        let mut lines = Lines::default();
        let mut rest = bytes;
        loop {
            let (line, after) = split_line(rest)?;
            rest = after;
            let mut words = line.split_whitespace();
            let Some(keyword) = words.next().filter(|word| !word.starts_with('#')) else {
                continue;
            };
            let words: Vec<&str> = words.collect();
            match keyword {
                "VERSION" | "VIEWPOINT" => {}
                "DATA" => return Ok((lines.header(encoding(&words)?)?, rest)),
                _ if KEYWORDS.contains(&keyword) => drop(lines.0.insert(keyword, words)),
                _ => return Err(bad("a PCD keyword", line)),
            }
        }
    }

    /// Bytes of all points, if no more than there are.
    pub(super) fn body_bytes(&self, available: usize) -> Result<usize, PcdError> {
        let expected = u128::from(self.points) * self.row_bytes as u128;
        usize::try_from(expected)
            .ok()
            .filter(|&bytes| bytes <= available)
            .ok_or(PcdError::TooShort { expected, points: self.points, found: available })
    }
}

fn split_line(bytes: &[u8]) -> Result<(&str, &[u8]), PcdError> {
    let no_header = |found: &str| PcdError::NoHeader { found: found.into() };
    let end = bytes.iter().position(|&b| b == b'\n').ok_or_else(|| {
        no_header(if bytes.is_empty() { "the end of the file" } else { "no end of a line" })
    })?;
    let line =
        std::str::from_utf8(&bytes[..end]).map_err(|_| no_header("a line that is not text"))?;
    Ok((line, &bytes[end + 1..]))
}

fn bad(expected: &'static str, found: impl AsRef<str>) -> PcdError {
    PcdError::BadHeader { expected, found: excerpt(found.as_ref()) }
}

fn encoding(words: &[&str]) -> Result<Encoding, PcdError> {
    match words {
        ["ascii"] => Ok(Encoding::Ascii),
        ["binary"] => Ok(Encoding::Binary),
        ["binary_compressed"] => Ok(Encoding::BinaryCompressed),
        _ => Err(bad("DATA ascii, binary or binary_compressed", words.join(" "))),
    }
}

impl Lines<'_> {
    fn header(&self, encoding: Encoding) -> Result<Header, PcdError> {
        let names = self.0.get("FIELDS").ok_or_else(|| bad("FIELDS", "none"))?;
        let fields = self.layout(names.len())?;
        let find = |name: &str| {
            let field = fields.get(names.iter().position(|found| *found == name)?)?;
            let scalar = field.scalar.filter(|_| field.count == 1)?;
            Some(Kept { scalar, offset: field.offset, column: field.column })
        };
        let coordinate = |name: &str| {
            find(name)
                .filter(|kept| kept.scalar.is_float())
                .ok_or_else(|| bad("fields x, y and z of TYPE F and SIZE 4 or 8", names.join(" ")))
        };
        Ok(Header {
            encoding,
            points: self.point_count()?,
            row_bytes: fields.iter().map(|field| field.size * field.count).sum(),
            columns_per_row: fields.iter().map(|field| field.count).sum(),
            xyz: [coordinate("x")?, coordinate("y")?, coordinate("z")?],
            intensity: find("intensity"),
        })
    }

    /// Type and place of every field.
    fn layout(&self, fields: usize) -> Result<Vec<Field>, PcdError> {
        let sizes = self.per_field("SIZE", "one SIZE for each field", fields)?;
        let kinds = self.per_field("TYPE", "one TYPE for each field", fields)?;
        let counts = match self.0.get("COUNT") {
            None => &vec!["1"; fields], // the line may be absent
            Some(_) => self.per_field("COUNT", "one COUNT for each field", fields)?,
        };
        let (mut offset, mut column) = (0, 0);
        let mut layout = Vec::with_capacity(fields);
        for ((size, kind), count) in sizes.iter().zip(kinds).zip(counts) {
            let field = field(size, kind, count, offset, column)?;
            offset += field.size * field.count;
            column += field.count;
            layout.push(field);
        }
        Ok(layout)
    }

    fn per_field(
        &self,
        keyword: &str,
        expected: &'static str,
        fields: usize,
    ) -> Result<&Vec<&str>, PcdError> {
        match self.0.get(keyword) {
            Some(words) if words.len() == fields => Ok(words),
            Some(words) => Err(bad(expected, words.join(" "))),
            None => Err(bad(expected, "none")),
        }
    }

    fn number(&self, keyword: &str, expected: &'static str) -> Result<Option<u64>, PcdError> {
        let Some(words) = self.0.get(keyword) else { return Ok(None) };
        let number = match words[..] {
            [word] => word.parse().ok(),
            _ => None,
        };
        number.map(Some).ok_or_else(|| bad(expected, words.join(" ")))
    }

    fn point_count(&self) -> Result<u64, PcdError> {
        let points = self.number("POINTS", "a number of POINTS")?;
        let width = self.number("WIDTH", "a number as WIDTH")?;
        let height = self.number("HEIGHT", "a number as HEIGHT")?;
        let grid = width.map(|width| u128::from(width) * u128::from(height.unwrap_or(1)));
        match (points, grid) {
            (Some(points), Some(grid)) if u128::from(points) != grid => {
                Err(bad("WIDTH times HEIGHT equal to POINTS", format!("{grid} and {points}")))
            }
            (Some(points), _) => Ok(points),
            (None, Some(grid)) => {
                u64::try_from(grid).map_err(|_| bad("a number of points", grid.to_string()))
            }
            (None, None) => Err(bad("POINTS, or WIDTH and HEIGHT", "none")),
        }
    }
}

/// Largest COUNT of a field: PCL's widest descriptor has 1980 numbers, and no sum of these overflows.
const MAX_COUNT: usize = 1 << 16;

fn field(
    size: &str,
    kind: &str,
    count: &str,
    offset: usize,
    column: usize,
) -> Result<Field, PcdError> {
    let size = match size {
        "1" => 1,
        "2" => 2,
        "4" => 4,
        "8" => 8,
        _ => return Err(bad("a SIZE of 1, 2, 4 or 8", size)),
    };
    if !matches!(kind, "F" | "I" | "U") {
        return Err(bad("a TYPE of F, I or U", kind));
    }
    let count = match count.parse() {
        Ok(count) if (1..=MAX_COUNT).contains(&count) => count,
        _ => return Err(bad("a COUNT of 1 to 65536", count)),
    };
    Ok(Field { scalar: scalar(kind, size), size, count, offset, column })
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 3\nPOINTS 6\nDATA binary\n";

    fn error(text: &str) -> String {
        Header::parse(text.as_bytes()).map(|_| ()).unwrap_err().to_string()
    }

    #[test]
    fn jrdb_s_own_header_is_understood() {
        let text = "VERSION 0.7\nFIELDS x y z intensity ring\nSIZE 4 4 4 4 2\nTYPE F F F F U\n\
            COUNT 1 1 1 1 1\nWIDTH 5\nHEIGHT 1\nVIEWPOINT 0.0 0.0 0.0 1.0 0.0 0.0 0.0\nPOINTS 5\n\
            DATA binary_compressed\nrest";
        let (header, rest) = Header::parse(text.as_bytes()).unwrap();
        assert_eq!((header.points, header.row_bytes, rest), (5, 18, &b"rest"[..]));
        assert_eq!(header.intensity.unwrap().offset, 12);
    }

    #[test]
    fn count_points_and_windows_line_ends_are_optional() {
        let text =
            GOOD.replace("COUNT 1 1 1\n", "").replace("POINTS 6\n", "").replace('\n', "\r\n");
        assert_eq!(Header::parse(text.as_bytes()).unwrap().0.points, 6);
    }

    #[test]
    fn trouble_says_what_was_expected_and_found() {
        let cases = [
            ("", "", "expected a pcd header with a DATA line, found the end of the file"),
            (
                "DATA binary\n",
                "",
                "expected a pcd header with a DATA line, found the end of the file",
            ),
            ("HEIGHT", "HEIGTH", r#"expected a PCD keyword in the pcd header, found "HEIGTH 3""#),
            (
                "POINTS 6",
                "POINTS 7",
                r#"expected WIDTH times HEIGHT equal to POINTS in the pcd header, found "6 and 7""#,
            ),
            (
                "SIZE 4 4 4",
                "SIZE 4 4",
                r#"expected one SIZE for each field in the pcd header, found "4 4""#,
            ),
            (
                "SIZE 4 4 4",
                "SIZE 4 4 3",
                r#"expected a SIZE of 1, 2, 4 or 8 in the pcd header, found "3""#,
            ),
            (
                "TYPE F F F",
                "TYPE F F X",
                r#"expected a TYPE of F, I or U in the pcd header, found "X""#,
            ),
            (
                "COUNT 1 1 1",
                "COUNT 1 1 99999999999999999999",
                r#"expected a COUNT of 1 to 65536 in the pcd header, found "99999999999999999999""#,
            ),
            (
                "FIELDS x y z",
                "FIELDS x y w",
                r#"expected fields x, y and z of TYPE F and SIZE 4 or 8 in the pcd header, found "x y w""#,
            ),
            (
                "DATA binary",
                "DATA zip",
                r#"expected DATA ascii, binary or binary_compressed in the pcd header, found "zip""#,
            ),
            ("WIDTH 2", "WIDTH -2", r#"expected a number as WIDTH in the pcd header, found "-2""#),
        ];
        for (old, new, expected) in cases {
            let text = if old.is_empty() { String::new() } else { GOOD.replace(old, new) };
            assert_eq!(error(&text), expected);
        }
    }
}
