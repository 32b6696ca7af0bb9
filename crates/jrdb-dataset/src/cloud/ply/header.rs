//! The text in front of the elements: which there are, and of what they consist.

use std::borrow::Cow;

use super::error::PlyError;
use crate::cloud::columns::{ByteOrder, Scalar};
use crate::cloud::fields::{excerpt, without_mark};

/// How the elements of a PLY file are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Binary(ByteOrder),
}

/// What a PLY header says, as far as a cloud needs it.
pub(super) struct Header {
    pub(super) encoding: Encoding,
    /// What comes before the points.
    pub(super) before: Vec<Element>,
    /// The points.
    pub(super) vertex: Element,
    /// Whether nothing comes behind the points.
    pub(super) is_last: bool,
    pub(super) xyz: [Kept; 3],
    pub(super) intensity: Option<Kept>,
}

/// A property of the points that becomes a column of the cloud.
pub(super) struct Kept {
    /// Index among the properties.
    pub(super) index: usize,
    pub(super) scalar: Scalar,
}

/// A list of things of one kind.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

/// One property of an element.
#[derive(Debug)]
pub(super) struct Property {
    name: String,
    pub(super) kind: Kind,
}

/// What a property is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    One(Number),
    /// As many numbers as the one before them says.
    List {
        count: Number,
        item: Number,
    },
}

/// Type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Number {
    /// Bytes.
    pub(super) size: usize,
    is_float: bool,
    is_signed: bool,
}

impl Number {
    fn new(name: &str) -> Option<Self> {
        let (size, is_float, is_signed) = match name {
            "char" | "int8" => (1, false, true),
            "uchar" | "uint8" => (1, false, false),
            "short" | "int16" => (2, false, true),
            "ushort" | "uint16" => (2, false, false),
            "int" | "int32" => (4, false, true),
            "uint" | "uint32" => (4, false, false),
            "int64" | "long" | "longlong" => (8, false, true),
            "uint64" | "ulong" | "ulonglong" => (8, false, false),
            "half" | "float16" => (2, true, true),
            "float" | "float32" => (4, true, true),
            "double" | "float64" => (8, true, true),
            _ => return None,
        };
        Some(Self { size, is_float, is_signed })
    }

    /// How the number is read.
    fn scalar(self) -> Scalar {
        match (self.is_float, self.is_signed, self.size) {
            (true, _, 2) => Scalar::F16,
            (true, _, 4) => Scalar::F32,
            (true, ..) => Scalar::F64,
            (false, true, 1) => Scalar::I8,
            (false, true, 2) => Scalar::I16,
            (false, true, 4) => Scalar::I32,
            (false, true, _) => Scalar::I64,
            (false, false, 1) => Scalar::U8,
            (false, false, 2) => Scalar::U16,
            (false, false, 4) => Scalar::U32,
            (false, false, _) => Scalar::U64,
        }
    }

    /// The number at the start of the bytes, as a length.
    pub(super) fn length(self, bytes: &[u8], order: ByteOrder) -> Option<usize> {
        let bytes = bytes.get(..self.size)?;
        let append = |number: u64, byte: &u8| number << 8 | u64::from(*byte);
        let number = match order {
            ByteOrder::Little => bytes.iter().rev().fold(0, append),
            ByteOrder::Big => bytes.iter().fold(0, append),
        };
        let is_negative = self.is_signed && number >> (8 * self.size - 1) == 1;
        usize::try_from(number).ok().filter(|_| !is_negative)
    }
}

impl Element {
    /// Bytes of each, where all have the same.
    pub(super) fn row_bytes(&self) -> Option<usize> {
        self.properties.iter().map(|property| property.kind.size()).sum()
    }
}

impl Kind {
    pub(super) fn size(self) -> Option<usize> {
        match self {
            Self::One(number) => Some(number.size),
            Self::List { .. } => None,
        }
    }

    /// The type of the one number.
    fn scalar(self) -> Option<Scalar> {
        match self {
            Self::One(number) => Some(number.scalar()),
            Self::List { .. } => None,
        }
    }
}

/// Names under which programs write the element of the points.
const POINTS: [&str; 4] = ["vertex", "point", "points", "vertices"];

/// Names under which programs write the strength of the return.
const INTENSITIES: [&str; 3] = ["intensity", "reflectance", "scalar_intensity"];

impl Header {
    /// Reads the header and gives back what follows it.
    pub(super) fn parse(bytes: &[u8]) -> Result<(Self, &[u8]), PlyError> {
        let (first, mut rest) = split_line(without_mark(bytes))?;
        if first.trim_end() != "ply" {
            return Err(PlyError::NoHeader { found: "another kind of file" });
        }
        let (mut encoding, mut elements) = (None, Vec::new());
        loop {
            let (line, after) = split_line(rest)?;
            rest = after;
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            match words[..] {
                [] | ["comment" | "obj_info", ..] => {}
                ["format", name, "1.0"] => encoding = Some(self::encoding(name, &line)?),
                ["element", name, count] => {
                    let count = count.parse().map_err(|_| bad("a number of elements", &line))?;
                    elements.push(Element { name: name.into(), count, properties: Vec::new() });
                }
                ["property", ref words @ ..] => {
                    let element =
                        elements.last_mut().ok_or_else(|| bad("an element first", &line))?;
                    element.properties.push(property(words, &line)?);
                }
                ["end_header"] => {
                    let encoding = encoding.ok_or_else(|| bad("a format", "none"))?;
                    return Ok((Self::new(encoding, elements)?, rest));
                }
                _ => return Err(bad("format .. 1.0, element, property or end_header", &line)),
            }
        }
    }

    fn new(encoding: Encoding, mut elements: Vec<Element>) -> Result<Self, PlyError> {
        let named = |name: &&str| elements.iter().position(|e| e.name.eq_ignore_ascii_case(name));
        let at = POINTS.iter().find_map(named);
        let at = at.ok_or_else(|| bad("an element vertex", "none"))?;
        let is_last = at + 1 == elements.len();
        elements.truncate(at + 1); // what follows the points does not matter
        let vertex = elements.remove(at);
        let place = |name: &str| {
            let mut names = vertex.properties.iter();
            let exact = names.position(|property| property.name == name);
            let any_case = |property: &Property| property.name.eq_ignore_ascii_case(name);
            exact.or_else(|| vertex.properties.iter().position(any_case))
        };
        let find = |name: &str| {
            let index = place(name)?;
            Some(Kept { index, scalar: vertex.properties[index].kind.scalar()? })
        };
        let coordinate = |name: &str| {
            find(name).ok_or_else(|| {
                let names: Vec<&str> = vertex.properties.iter().map(|p| p.name.as_str()).collect();
                bad("properties x, y and z of one number each in vertex", &names.join(" "))
            })
        };
        let xyz = [coordinate("x")?, coordinate("y")?, coordinate("z")?];
        let strength = |name: &&str| find(name).filter(|kept| kept.scalar.is_strength());
        let intensity = INTENSITIES.iter().find_map(strength);
        Ok(Self { encoding, before: elements, vertex, is_last, xyz, intensity })
    }

    /// Whether a coordinate is a whole number.
    pub(super) fn has_whole_coordinates(&self) -> bool {
        self.xyz.iter().any(|kept| !kept.scalar.is_float())
    }
}

/// A line without its end, `\n` or `\r\n`, and what follows it.
fn split_line(bytes: &[u8]) -> Result<(Cow<'_, str>, &[u8]), PlyError> {
    let (line, rest) = match bytes.iter().position(|&b| b == b'\n') {
        Some(end) => (&bytes[..end], &bytes[end + 1..]),
        None if bytes == b"end_header" => (bytes, &[][..]),
        None => return Err(PlyError::NoHeader { found: "the end of the file" }),
    };
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    Ok((String::from_utf8_lossy(line), rest))
}

fn bad(expected: &'static str, found: &str) -> PlyError {
    PlyError::BadHeader { expected, found: excerpt(found) }
}

fn encoding(name: &str, line: &str) -> Result<Encoding, PlyError> {
    match name {
        "ascii" => Ok(Encoding::Ascii),
        "binary_little_endian" => Ok(Encoding::Binary(ByteOrder::Little)),
        "binary_big_endian" => Ok(Encoding::Binary(ByteOrder::Big)),
        _ => Err(bad("format ascii, binary_little_endian or binary_big_endian", line)),
    }
}

fn property(words: &[&str], line: &str) -> Result<Property, PlyError> {
    let number =
        |name| Number::new(name).ok_or_else(|| bad("a type of number, char to double", line));
    match *words {
        ["list", count, item, name] => {
            let count = number(count)?;
            if count.is_float {
                return Err(bad("an integer type as length of a list", line));
            }
            Ok(Property { name: name.into(), kind: Kind::List { count, item: number(item)? } })
        }
        [one, name] => Ok(Property { name: name.into(), kind: Kind::One(number(one)?) }),
        _ => Err(bad("property TYPE NAME or property list TYPE TYPE NAME", line)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_read_in_either_order_and_never_negative() {
        let short = Number::new("short").unwrap();
        assert_eq!(short.length(&[1, 2], ByteOrder::Little), Some(0x201));
        assert_eq!(short.length(&[1, 2, 9], ByteOrder::Big), Some(0x102));
        assert_eq!(short.length(&[0, 0x80], ByteOrder::Little), None);
        assert_eq!(short.length(&[0], ByteOrder::Big), None);
        assert_eq!(Number::new("uint8").unwrap().length(&[0xff], ByteOrder::Big), Some(0xff));
    }

    #[test]
    fn headers_of_careless_programs_are_understood() {
        const GOOD: &str = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
            property float z\nend_header\n";
        let changes = [
            ("float x", "float X"),
            ("vertex", "point"),
            ("float y", "int y"),
            ("float y\n", "float y\nproperty int64 id\nproperty ulong time\n"),
            ("ply\n", "\u{feff}ply\r\n"),
        ];
        for (old, new) in changes {
            assert!(Header::parse(GOOD.replace(old, new).as_bytes()).is_ok(), "{new}");
        }
        let latin = GOOD.replace("1.0\n", "1.0\ncomment caf?\n").into_bytes();
        let latin: Vec<u8> = latin.iter().map(|&b| if b == b'?' { 0xe9 } else { b }).collect();
        assert!(Header::parse(&latin).is_ok());
    }

    #[test]
    fn trouble_says_what_was_expected_and_found() {
        const GOOD: &str = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
            property float z\nend_header\n";
        assert!(Header::parse(GOOD.as_bytes()).is_ok());
        assert!(Header::parse(GOOD.replace('\n', "\r\n").as_bytes()).is_ok());
        let cases = [
            ("ply\n", "plot\n", "expected a ply header, found another kind of file"),
            ("end_header\n", "", "expected a ply header, found the end of the file"),
            (
                "ascii 1.0",
                "ascii 2.0",
                r#"expected format .. 1.0, element, property or end_header in the ply header, found "format ascii 2.0""#,
            ),
            (
                "ascii",
                "binary",
                r#"expected format ascii, binary_little_endian or binary_big_endian in the ply header, found "format binary 1.0""#,
            ),
            ("format ascii 1.0\n", "", r#"expected a format in the ply header, found "none""#),
            (
                "vertex 1",
                "vertex -1",
                r#"expected a number of elements in the ply header, found "element vertex -1""#,
            ),
            ("vertex", "face", r#"expected an element vertex in the ply header, found "none""#),
            (
                "float y",
                "list uchar float y",
                r#"expected properties x, y and z of one number each in vertex in the ply header, found "x y z""#,
            ),
            (
                "float y",
                "quad y",
                r#"expected a type of number, char to double in the ply header, found "property quad y""#,
            ),
            (
                "float y",
                "list float int y",
                r#"expected an integer type as length of a list in the ply header, found "property list float int y""#,
            ),
            (
                "element vertex 1\n",
                "",
                r#"expected an element first in the ply header, found "property float x""#,
            ),
        ];
        for (old, new, expected) in cases {
            let text = GOOD.replace(old, new);
            let error = Header::parse(text.as_bytes()).map(|_| ()).unwrap_err().to_string();
            assert_eq!(error, expected);
        }
    }
}
