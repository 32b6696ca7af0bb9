//! The text in front of the points: which fields there are, of what type, and where.

use std::borrow::Cow;
use std::collections::BTreeMap;

use super::encoding::Encoding;
use super::error::PcdError;
use crate::cloud::columns::Scalar;
use crate::cloud::fields::{excerpt, without_mark};

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
        ("F", 2) => Some(Scalar::F16),
        ("F", 4) => Some(Scalar::F32),
        ("F", 8) => Some(Scalar::F64),
        ("I", 1) => Some(Scalar::I8),
        ("I", 2) => Some(Scalar::I16),
        ("I", 4) => Some(Scalar::I32),
        ("I", 8) => Some(Scalar::I64),
        ("U", 1) => Some(Scalar::U8),
        ("U", 2) => Some(Scalar::U16),
        ("U", 4) => Some(Scalar::U32),
        ("U", 8) => Some(Scalar::U64),
        _ => None,
    }
}

/// Keywords that matter, with the names they have in files; those that do not are `VERSION` and `VIEWPOINT`.
const KEYWORDS: [(&str, &str); 8] = [
    ("FIELDS", "FIELDS"),
    ("COLUMNS", "FIELDS"),
    ("SIZE", "SIZE"),
    ("TYPE", "TYPE"),
    ("COUNT", "COUNT"),
    ("WIDTH", "WIDTH"),
    ("HEIGHT", "HEIGHT"),
    ("POINTS", "POINTS"),
];

/// The header's lines: the words after each keyword.
#[derive(Default)]
struct Lines(BTreeMap<&'static str, Vec<String>>);

impl Header {
    /// Reads the header and gives back what follows it.
    pub(super) fn parse(bytes: &[u8]) -> Result<(Self, &[u8]), PcdError> {
        let mut lines = Lines::default();
        let mut rest = without_mark(bytes);
        loop {
            let (line, after) = split_line(rest)?;
            rest = after;
            let mut words = line.split_whitespace();
            let Some(keyword) = words.next().filter(|word| !word.starts_with('#')) else {
                continue;
            };
            let words: Vec<String> = words.map(String::from).collect();
            match keyword.to_ascii_uppercase().as_str() {
                "VERSION" | "VIEWPOINT" => {}
                "DATA" => return Ok((lines.header(encoding(&words)?)?, rest)),
                keyword => {
                    let known = KEYWORDS.iter().find(|(name, _)| *name == keyword);
                    let (_, meaning) = known.ok_or_else(|| bad("a PCD keyword", &line))?;
                    lines.0.insert(meaning, words);
                }
            }
        }
    }

    /// Whether a coordinate is a whole number.
    pub(super) fn has_whole_coordinates(&self) -> bool {
        self.xyz.iter().any(|kept| !kept.scalar.is_float())
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

/// The next line and what follows it. Only the last line, `DATA`, may lack its end.
fn split_line(bytes: &[u8]) -> Result<(Cow<'_, str>, &[u8]), PcdError> {
    let no_header = |found: &str| PcdError::NoHeader { found: found.into() };
    let (line, rest) = match bytes.iter().position(|&b| b == b'\n') {
        Some(end) => (&bytes[..end], &bytes[end + 1..]),
        None if bytes.is_empty() => return Err(no_header("the end of the file")),
        None if bytes.len() <= MAX_LAST_LINE && bytes.starts_with(b"DATA") => (bytes, &[][..]),
        None => return Err(no_header("no end of a line")),
    };
    Ok((String::from_utf8_lossy(line), rest))
}

fn bad(expected: &'static str, found: impl AsRef<str>) -> PcdError {
    PcdError::BadHeader { expected, found: excerpt(found.as_ref()) }
}

fn encoding(words: &[String]) -> Result<Encoding, PcdError> {
    match words.join(" ").to_ascii_lowercase().as_str() {
        "ascii" => Ok(Encoding::Ascii),
        "binary" => Ok(Encoding::Binary),
        "binary_compressed" => Ok(Encoding::BinaryCompressed),
        _ => Err(bad("DATA ascii, binary or binary_compressed", words.join(" "))),
    }
}

/// The words that stand for a keyword which is absent: the values that PCL takes then.
const DEFAULT_SIZE: &str = "4";
const DEFAULT_TYPE: &str = "F";
const DEFAULT_COUNT: &str = "1";

/// Longest last line without an end: `DATA binary_compressed` and some blanks.
const MAX_LAST_LINE: usize = 64;

impl Lines {
    fn header(&self, encoding: Encoding) -> Result<Header, PcdError> {
        let names = self.0.get("FIELDS").ok_or_else(|| bad("FIELDS", "none"))?;
        let fields = self.layout(names.len())?;
        let place = |name: &str| {
            let exact = names.iter().position(|found| *found == name);
            exact.or_else(|| names.iter().position(|found| found.eq_ignore_ascii_case(name)))
        };
        let find = |name: &str| {
            let field = fields.get(place(name)?)?;
            let scalar = field.scalar.filter(|_| field.count == 1)?;
            Some(Kept { scalar, offset: field.offset, column: field.column })
        };
        let coordinate = |name: &str| {
            find(name).ok_or_else(|| bad("fields x, y and z with a COUNT of 1", names.join(" ")))
        };
        Ok(Header {
            encoding,
            points: self.point_count()?,
            row_bytes: fields.iter().map(|field| field.size * field.count).sum(),
            columns_per_row: fields.iter().map(|field| field.count).sum(),
            xyz: [coordinate("x")?, coordinate("y")?, coordinate("z")?],
            intensity: find("intensity").filter(|kept| kept.scalar.is_strength()),
        })
    }

    /// Type and place of every field.
    fn layout(&self, fields: usize) -> Result<Vec<Field>, PcdError> {
        let sizes = self.per_field("SIZE", "one SIZE for each field", DEFAULT_SIZE, fields)?;
        let kinds = self.per_field("TYPE", "one TYPE for each field", DEFAULT_TYPE, fields)?;
        let counts = self.per_field("COUNT", "one COUNT for each field", DEFAULT_COUNT, fields)?;
        let (mut offset, mut column) = (0, 0);
        let mut layout = Vec::with_capacity(fields);
        for ((size, kind), count) in sizes.into_iter().zip(kinds).zip(counts) {
            let field = field(size, kind, count, offset, column)?;
            offset += field.size * field.count;
            column += field.count;
            if column > MAX_COLUMNS {
                return Err(bad("at most 16384 numbers in a point", format!("{column} or more")));
            }
            layout.push(field);
        }
        Ok(layout)
    }

    /// The words of a keyword, one for each field; the default where the keyword is absent.
    fn per_field<'a>(
        &'a self,
        keyword: &str,
        expected: &'static str,
        default: &'a str,
        fields: usize,
    ) -> Result<Vec<&'a str>, PcdError> {
        match self.0.get(keyword) {
            None => Ok(vec![default; fields]),
            Some(words) if words.len() == fields => Ok(words.iter().map(String::as_str).collect()),
            Some(words) => Err(bad(expected, words.join(" "))),
        }
    }

    fn number(&self, keyword: &str, expected: &'static str) -> Result<Option<u64>, PcdError> {
        let Some(words) = self.0.get(keyword) else { return Ok(None) };
        let number = match &words[..] {
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

/// Largest COUNT of a field.
const MAX_COUNT: usize = 1 << 16;

/// Most numbers in a point: PCL's widest descriptor has 7992.
const MAX_COLUMNS: usize = 1 << 14;

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
    let kind_upper = kind.to_ascii_uppercase();
    if !matches!(kind_upper.as_str(), "F" | "I" | "U") {
        return Err(bad("a TYPE of F, I or U", kind));
    }
    let count = match count.parse() {
        Ok(count) if count <= MAX_COUNT => count,
        _ => return Err(bad("a COUNT of 0 to 65536", count)),
    };
    Ok(Field { scalar: scalar(&kind_upper, size), size, count, offset, column })
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
    fn headers_of_old_and_careless_programs_are_understood() {
        let changes = [
            ("FIELDS", "COLUMNS"),
            ("SIZE 4 4 4\n", ""),
            ("TYPE F F F\n", ""),
            ("SIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n", ""),
            ("TYPE F F F", "TYPE f f f"),
            ("DATA binary", "DATA BINARY"),
            ("x y z", "X Y Z"),
            ("FIELDS", "\u{feff}FIELDS"),
            ("FIELDS", "# comment\nFIELDS"),
        ];
        for (old, new) in changes {
            let text = GOOD.replace(old, new);
            let (header, _) = Header::parse(text.as_bytes()).unwrap();
            assert_eq!((header.points, header.row_bytes), (6, 12), "{new}");
        }
        let latin = [&b"# caf\xe9\n"[..], GOOD.as_bytes()].concat();
        assert!(Header::parse(&latin).is_ok());
        assert!(Header::parse(GOOD.trim_end().as_bytes()).is_ok(), "no end of the last line");
    }

    #[test]
    fn an_empty_field_takes_no_place() {
        let text = GOOD.replace("x y z", "x _ y z").replace("4 4 4", "4 1 4 4");
        let text = text.replace("F F F", "F U F F").replace("1 1 1", "1 0 1 1");
        let (header, _) = Header::parse(text.as_bytes()).unwrap();
        assert_eq!((header.row_bytes, header.columns_per_row, header.xyz[1].offset), (12, 3, 4));
    }

    #[test]
    fn points_of_absurdly_many_numbers_are_refused() {
        let wide = GOOD.replace("x y z", "x y z d e").replace("4 4 4", "4 4 4 4 4");
        let wide = wide.replace("F F F", "F F F F F").replace("1 1 1", "1 1 1 9000 9000");
        assert_eq!(
            error(&wide),
            r#"expected at most 16384 numbers in a point in the pcd header, found "18003 or more""#
        );
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
                r#"expected a COUNT of 0 to 65536 in the pcd header, found "99999999999999999999""#,
            ),
            (
                "FIELDS x y z",
                "FIELDS x y w",
                r#"expected fields x, y and z with a COUNT of 1 in the pcd header, found "x y w""#,
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
