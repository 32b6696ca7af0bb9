//! What the numbers of a point without a header are.

use std::fmt;
use std::str::FromStr;

use super::error::BinError;
use crate::cloud::columns::{Column, Columns, Scalar};
use crate::cloud::fields::Fields;

/// The columns of points without a header, in words: `x,y,z,intensity,time:f64`.
///
/// Every column has a name and perhaps a type, `f32` where none is given. `x`, `y` and `z` must be among them; `intensity` is
/// kept; any other name is passed over.
///
/// ```
/// use jrdb_dataset::cloud::CloudColumns;
/// let columns: CloudColumns = "x,y,z,intensity,ring:u16".parse().unwrap();
/// assert_eq!(columns.row_bytes(), 18);
/// assert!("x,y".parse::<CloudColumns>().is_err());
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CloudColumns {
    columns: Vec<(String, Scalar)>,
}

/// Types that a column may have.
const TYPES: [(&str, Scalar); 11] = [
    ("f16", Scalar::F16),
    ("f32", Scalar::F32),
    ("f64", Scalar::F64),
    ("i8", Scalar::I8),
    ("i16", Scalar::I16),
    ("i32", Scalar::I32),
    ("i64", Scalar::I64),
    ("u8", Scalar::U8),
    ("u16", Scalar::U16),
    ("u32", Scalar::U32),
    ("u64", Scalar::U64),
];

/// Names of a point's numbers, where nothing else is known: the fourth is the strength of the return.
const NAMES: [&str; 4] = ["x", "y", "z", "intensity"];

/// Most columns that can be stated.
const MAX_COLUMNS: usize = 64;

impl CloudColumns {
    /// So many columns of one type: x, y, z, the intensity and others.
    pub(super) fn alike(scalar: Scalar, count: usize) -> Self {
        let name = |index: usize| NAMES.get(index).copied().unwrap_or("_").to_string();
        Self { columns: (0..count).map(|index| (name(index), scalar)).collect() }
    }

    /// Bytes of a point.
    #[must_use]
    pub fn row_bytes(&self) -> usize {
        self.columns.iter().map(|(_, scalar)| scalar.size()).sum()
    }

    /// The columns of a cloud.
    pub(super) fn places(&self, fields: Fields) -> Option<Columns> {
        let stride = self.row_bytes();
        let place = |name: &str| {
            let at = self.columns.iter().position(|(found, _)| found == name)?;
            let start = self.columns[..at].iter().map(|(_, scalar)| scalar.size()).sum();
            Some(Column { scalar: self.columns[at].1, start, stride })
        };
        let xyz = [place("x")?, place("y")?, place("z")?];
        let intensity = place("intensity").filter(|_| fields == Fields::All);
        Some(Columns { xyz, intensity })
    }
}

impl fmt::Display for CloudColumns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (name, scalar)) in self.columns.iter().enumerate() {
            let comma = if index > 0 { "," } else { "" };
            write!(f, "{comma}{name}")?;
            if let Some((word, _)) = TYPES.iter().find(|(_, known)| known == scalar)
                && *scalar != Scalar::F32
            {
                write!(f, ":{word}")?;
            }
        }
        Ok(())
    }
}

impl FromStr for CloudColumns {
    type Err = BinError;

    fn from_str(text: &str) -> Result<Self, BinError> {
        let bad = || BinError::Columns { found: text.into() };
        let column = |word: &str| {
            let (name, kind) = word.trim().split_once(':').unwrap_or((word.trim(), "f32"));
            let kind = TYPES.iter().find(|(known, _)| *known == kind.trim());
            Some((name.trim().to_ascii_lowercase(), kind?.1))
        };
        let columns: Option<Vec<_>> = text.split(',').map(column).collect();
        let columns = Self { columns: columns.ok_or_else(bad)? };
        let is_sound =
            columns.columns.len() <= MAX_COLUMNS && columns.places(Fields::All).is_some();
        is_sound.then_some(columns).ok_or_else(bad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_named_and_typed() {
        let columns: CloudColumns = "t:f64, X,y,z,intensity:u8".parse().unwrap();
        assert_eq!(columns.to_string(), "t:f64,x,y,z,intensity:u8");
        let places = columns.places(Fields::All).unwrap();
        assert_eq!((places.xyz[0].start, places.intensity.unwrap().start), (8, 20));
        for bad in ["", "x,y", "x,y,z:f7", "x y z"] {
            assert!(bad.parse::<CloudColumns>().is_err(), "{bad}");
        }
    }
}
