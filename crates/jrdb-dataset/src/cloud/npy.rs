//! Clouds in NumPy's `.npy` format (versions 1, 2 and 3): arrays of numbers or of records with named fields.

mod error;
mod header;

use jrdb_types::PointCloud;

use super::columns::{ByteOrder, Column, Columns, Scalar};
use super::fields::{Fields, Notes, filled, whole_coordinates};
pub use error::NpyError;
use error::bad;
use header::{Item, Layout, Named};

const MAGIC: &[u8] = b"\x93NUMPY";

/// The start of a zip archive, which `.npz` files are.
const ZIP: &[u8] = b"PK\x03\x04";

/// Most columns of an array of rows, and most rows of an array of columns.
const MAX_COLUMNS: usize = 16;

/// Parses an `.npy` file as the sweep of a sensor.
///
/// The array has a row `x y z`, or `x y z intensity` and more, for each point: shape (points, 3 to 16), or (rows, columns, 3 to 16)
/// of an organised cloud. Arrays of few rows and many columns, (3, points) or (4, points), hold the coordinates one behind the
/// other. Arrays of records have fields `x`, `y`, `z` and perhaps `intensity`, in any order and among others. Numbers are floats
/// or integers of any size and byte order, in C or Fortran order.
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
pub(super) fn fill(
    bytes: &[u8],
    fields: Fields,
    cloud: &mut PointCloud,
) -> Result<Notes, NpyError> {
    let (header, body) = split_header(bytes)?;
    let Layout { item, fortran_order, shape } = header.parse()?;
    let table = match item {
        Item::Number { scalar, order } => Table::of_numbers(scalar, order, fortran_order, &shape)?,
        Item::Record { fields, bytes } => Table::of_records(&fields, bytes, &shape)?,
    };
    if table.bytes > body.len() as u128 {
        let Table { rows, numbers: columns, bytes: expected, .. } = table;
        return Err(NpyError::TooShort { expected, rows, columns, found: body.len() });
    }
    let intensity = table.columns.intensity.filter(|_| fields == Fields::All);
    let columns = Columns { intensity, ..table.columns };
    let is_whole = columns.xyz.iter().any(|column| !column.scalar.is_float());
    columns.fill(body, table.rows, table.order, cloud);
    Ok(is_whole.then(|| whole_coordinates("an integer dtype")).into_iter().collect())
}

/// Where the numbers of the points are.
struct Table {
    columns: Columns,
    order: ByteOrder,
    rows: usize,
    /// Numbers or fields of a point.
    numbers: usize,
    /// Bytes of all points.
    bytes: u128,
}

/// Whether a shape can be rows of numbers.
fn is_row(numbers: usize) -> bool {
    (3..=MAX_COLUMNS).contains(&numbers)
}

fn product(numbers: &[usize]) -> usize {
    numbers.iter().fold(1, |product, &number| product.saturating_mul(number))
}

impl Table {
    /// Points as rows of numbers, or as columns where there are few rows and many columns.
    fn of_numbers(
        scalar: Scalar,
        order: ByteOrder,
        fortran_order: bool,
        shape: &[usize],
    ) -> Result<Self, NpyError> {
        let (first, last) = (shape.first().copied(), shape.last().copied());
        let (rows, numbers, is_planar) = match (shape.len(), first, last) {
            (2 | 3, _, Some(last)) if is_row(last) => {
                (product(&shape[..shape.len() - 1]), last, fortran_order)
            }
            (2 | 3, Some(first), _) if is_row(first) => {
                (product(&shape[1..]), first, !fortran_order)
            }
            // Nothing of what is not there can be of a wrong width.
            (2, Some(0), Some(last)) if last >= 3 => (0, last, fortran_order),
            _ => return Err(bad("a shape (points, 3 to 16)", &format!("{shape:?}"))),
        };
        let size = scalar.size();
        let column = |index: usize| {
            let (start, stride) = if is_planar { (index * rows, 1) } else { (index, numbers) };
            Column {
                scalar,
                start: start.saturating_mul(size),
                stride: stride.saturating_mul(size),
            }
        };
        let bytes = (rows as u128 * numbers as u128).saturating_mul(size as u128);
        let is_possible = bytes <= usize::MAX as u128;
        let columns = Columns {
            xyz: [0, 1, 2].map(|index| column(if is_possible { index } else { 0 })),
            intensity: (numbers > 3 && is_possible && scalar.is_strength()).then(|| column(3)),
        };
        Ok(Self { columns, order, rows, numbers, bytes })
    }

    /// Points as records with named fields.
    fn of_records(fields: &[Named], stride: usize, shape: &[usize]) -> Result<Self, NpyError> {
        let find = |name: &str| fields.iter().find(|field| field.name.eq_ignore_ascii_case(name));
        let names = || fields.iter().map(|f| f.name.as_str()).collect::<Vec<_>>().join(" ");
        let absent = || bad("fields x, y and z of one byte order", &names());
        let [x, y, z] = ["x", "y", "z"].map(find);
        let [Some(x), Some(y), Some(z)] = [x, y, z] else { return Err(absent()) };
        let column = |field: &Named| Column { scalar: field.scalar, start: field.offset, stride };
        if [y, z].iter().any(|field| field.order != x.order) {
            return Err(absent());
        }
        let intensity = ["intensity", "reflectance"].iter().find_map(|name| find(name));
        let intensity =
            intensity.filter(|field| field.scalar.is_strength() && field.order == x.order);
        let rows = product(shape);
        Ok(Self {
            columns: Columns { xyz: [x, y, z].map(column), intensity: intensity.map(column) },
            order: x.order,
            rows,
            numbers: fields.len(),
            bytes: rows as u128 * stride as u128,
        })
    }
}

/// The header's text, and what follows it.
fn split_header(bytes: &[u8]) -> Result<(&str, &[u8]), NpyError> {
    let none = |found: &str| NpyError::NoHeader { found: found.into() };
    let ends = || none("the end of the file");
    let other = if bytes.starts_with(ZIP) {
        "a zip archive as .npz is: save the array alone, with numpy.save"
    } else {
        "another kind of file"
    };
    let after = bytes.strip_prefix(MAGIC).ok_or_else(|| none(other))?;
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
    fn arrays_of_columns_and_organised_arrays_are_read() {
        let values: Vec<f32> = (0..96).map(|i| i as f32).collect();
        let body = floats(&values);
        let read = |order: &str, shape: &str| {
            let cloud = parse(&file(1, &header("<f4", order, shape), &body), "s").unwrap();
            (cloud.len(), cloud.x[1], cloud.y[0], cloud.intensity[0])
        };
        assert_eq!(read("False", "(4, 24)"), (24, 1.0, 24.0, 72.0), "columns");
        assert_eq!(read("True", "(4, 24)"), (24, 4.0, 1.0, 3.0), "columns, in Fortran's order");
        assert_eq!(read("False", "(6, 4, 4)"), (24, 4.0, 1.0, 3.0), "organised");
        assert_eq!(
            read("True", "(6, 4, 4)"),
            (24, 1.0, 24.0, 72.0),
            "organised, in Fortran's order"
        );
        assert_eq!(read("False", "(1, 24, 4)"), (24, 4.0, 1.0, 3.0), "one sweep");
    }

    #[test]
    fn numbers_of_every_type_are_read() {
        let cases: [(&str, Vec<u8>); 6] = [
            ("<f2", [0x3c00_u16, 0x4000, 0x4200].iter().flat_map(|v| v.to_le_bytes()).collect()),
            (">f4", [1.0_f32, 2.0, 3.0].iter().flat_map(|v| v.to_be_bytes()).collect()),
            (">f8", [1.0_f64, 2.0, 3.0].iter().flat_map(|v| v.to_be_bytes()).collect()),
            ("<i2", [1_i16, 2, 3].iter().flat_map(|v| v.to_le_bytes()).collect()),
            ("<i8", [1_i64, 2, 3].iter().flat_map(|v| v.to_le_bytes()).collect()),
            ("|u1", vec![1, 2, 3]),
        ];
        for (descr, body) in cases {
            let mut cloud = PointCloud::default();
            let bytes = file(1, &header(descr, "False", "(1, 3)"), &body);
            let notes = fill(&bytes, Fields::All, &mut cloud).unwrap();
            assert_eq!((cloud.x[0], cloud.y[0], cloud.z[0]), (1.0, 2.0, 3.0), "{descr}");
            assert_eq!(notes.len(), usize::from(!descr.contains('f')), "{descr}");
        }
    }

    #[test]
    fn records_say_which_number_is_which() {
        let descr = "[('t', '<u8'), ('Z', '<f4'), ('', '|V4'), ('n', '<f4', (2,)), ('y', '<f8'), ('x', '<f4'), ('intensity', '|u1'), ('s', '<U2')]";
        let head = header("<f4", "False", "(2,)").replace("'<f4'", descr);
        let row = |x: f32| {
            let (t, z, y) = (7_u64.to_le_bytes(), 3_f32.to_le_bytes(), 2_f64.to_le_bytes());
            [&t[..], &z, &[0; 4], &[0; 8], &y, &x.to_le_bytes(), &[200], &[0; 8]].concat()
        };
        let cloud = parse(&file(1, &head, &[row(1.0), row(-1.0)].concat()), "s").unwrap();
        assert_eq!((cloud.x, cloud.y[1], cloud.z[0]), (vec![1.0, -1.0], 2.0, 3.0));
        assert_eq!(cloud.intensity, [200.0; 2]);
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
                "expected an npy header of version 1, 2 or 3, found a zip archive as .npz is: save the \
                 array alone, with numpy.save",
            ),
            (
                b"P2".to_vec(),
                "expected an npy header of version 1, 2 or 3, found another kind of file",
            ),
            (file(4, &good, &[]), "expected an npy header of version 1, 2 or 3, found version 4"),
            (
                file(1, &good, &[])[..40].to_vec(),
                "expected an npy header of version 1, 2 or 3, found the end of the file",
            ),
            (file(1, &good, &[0; 11]), "expected 12 bytes for 1 x 3 numbers, found 11"),
            (
                file(1, &good.replace("<f4", "<c8"), &[]),
                r#"expected descr of a float or an integer such as '<f4' in the npy header, found "'<c8', 'fortran_order': False, 'shape': (1, 3), }""#,
            ),
            (
                file(1, &good.replace("'<f4'", "[('x', '<f4'), ('t', '<i8')]"), &[]),
                r#"expected fields x, y and z of one byte order in the npy header, found "x t""#,
            ),
            (file(1, "{}", &[]), r#"expected a key descr in the npy header, found "{}""#),
            (
                file(1, &good.replace("(1, 3)", "(3,)"), &[]),
                r#"expected a shape (points, 3 to 16) in the npy header, found "[3]""#,
            ),
        ];
        for (bytes, expected) in cases {
            assert_eq!(error(&bytes), expected);
        }
        for shape in ["(1, 2)", "()", "(1, 2, 1)", "(1, 1, 1, 3)", "(-1, 3)", "(1.0, 3)", "1, 3"] {
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
        for shape in ["(18446744073709551615, 3)", "(18446744073709551615, 16)"] {
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
