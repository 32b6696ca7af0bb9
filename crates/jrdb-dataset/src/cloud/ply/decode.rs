//! Bytes of a PLY file to points.

use jrdb_types::PointCloud;

use super::error::PlyError;
use super::header::{Element, Encoding, Header, Kept, Kind, Property};
use crate::cloud::ascii::{self, Word};
use crate::cloud::columns::{ByteOrder, Column, Columns};
use crate::cloud::fields::{Fields, Notes, filled, other_count, whole_coordinates};

/// Parses a PLY file as the sweep of a sensor.
///
/// The points are the element `vertex` (or `point`) with `x`, `y` and `z` of any type of number. The intensity is called
/// `intensity`, `reflectance` or `scalar_intensity`. Other properties and elements, lists among them, are passed over.
///
/// ```
/// let text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
///             property double z\nproperty uchar intensity\nend_header\n1 2 3.5 200\n";
/// let cloud = jrdb_dataset::cloud::ply::parse(text.as_bytes(), "top").unwrap();
/// assert_eq!((cloud.z[0], cloud.intensity[0]), (3.5, 200.0));
/// ```
///
/// # Errors
/// [`PlyError`]; nothing is allocated for points that the file has no bytes for.
pub fn parse(bytes: &[u8], sensor: &str) -> Result<PointCloud, PlyError> {
    filled(sensor, |cloud| fill(bytes, Fields::All, cloud))
}

/// [`parse`], of some fields only, into a cloud.
pub(in crate::cloud) fn fill(
    bytes: &[u8],
    fields: Fields,
    cloud: &mut PointCloud,
) -> Result<Notes, PlyError> {
    let (header, body) = Header::parse(bytes)?;
    let header = header.with(fields);
    let whole = header.has_whole_coordinates().then(|| whole_coordinates("int or the like"));
    let mut notes: Notes = whole.into_iter().collect();
    match header.encoding {
        Encoding::Ascii => notes.extend(read_ascii(&header, body, cloud)?),
        Encoding::Binary(order) => {
            let mut body = body;
            for element in &header.before {
                body = skip(element, body, order)?;
            }
            match header.vertex.row_bytes() {
                Some(row_bytes) => read_table(&header, row_bytes, body, order, cloud)?,
                None => read_rows(&header, body, order, cloud)?,
            }
        }
    }
    Ok(notes)
}

impl Element {
    fn too_short(&self, found: u64) -> PlyError {
        PlyError::TooShort { element: self.name.clone(), expected: self.count, found }
    }

    /// The bytes of this many of the element, each `row_bytes` long, and what follows them.
    fn split_table<'a>(
        &self,
        row_bytes: usize,
        body: &'a [u8],
    ) -> Result<(&'a [u8], &'a [u8]), PlyError> {
        let bytes = usize::try_from(self.count).ok().and_then(|count| count.checked_mul(row_bytes));
        let split = bytes.and_then(|bytes| body.split_at_checked(bytes));
        // An element without bytes is never too short.
        split.ok_or_else(|| self.too_short((body.len() / row_bytes.max(1)) as u64))
    }

    /// Where each property of the element at the start of the body is, and what follows the element.
    fn walk<'a>(
        &self,
        body: &'a [u8],
        order: ByteOrder,
        mut at: impl FnMut(usize, &'a [u8]),
    ) -> Option<&'a [u8]> {
        let mut rest = body;
        for (index, property) in self.properties.iter().enumerate() {
            at(index, rest);
            let bytes = match property.kind {
                Kind::One(number) => number.size,
                Kind::List { count, item } => {
                    let length = count.length(rest, order)?;
                    length.checked_mul(item.size)?.checked_add(count.size)?
                }
            };
            rest = rest.get(bytes..)?;
        }
        Some(rest)
    }
}

/// What follows an element.
fn skip<'a>(element: &Element, body: &'a [u8], order: ByteOrder) -> Result<&'a [u8], PlyError> {
    if let Some(row_bytes) = element.row_bytes() {
        return Ok(element.split_table(row_bytes, body)?.1);
    }
    let mut rest = body;
    for found in 0..element.count {
        rest = element.walk(rest, order, |_, _| {}).ok_or_else(|| element.too_short(found))?;
    }
    Ok(rest)
}

/// Points that are all equally long.
fn read_table(
    header: &Header,
    row_bytes: usize,
    body: &[u8],
    order: ByteOrder,
    cloud: &mut PointCloud,
) -> Result<(), PlyError> {
    let (points, _) = header.vertex.split_table(row_bytes, body)?;
    let rows = points.len() / row_bytes;
    header.columns(row_bytes).fill(points, rows, order, cloud);
    Ok(())
}

/// Points with lists among their properties.
fn read_rows(
    header: &Header,
    body: &[u8],
    order: ByteOrder,
    cloud: &mut PointCloud,
) -> Result<(), PlyError> {
    let mut points = ascii::Points::new(cloud, header.intensity.is_some());
    let mut rest = body;
    for found in 0..header.vertex.count {
        let mut row = [0.0; 4];
        let after = header.vertex.walk(rest, order, |index, bytes| {
            for (slot, kept) in header.kept().enumerate().filter(|(_, kept)| kept.index == index) {
                row[slot] = kept.scalar.read(bytes, order);
            }
        });
        rest = after.ok_or_else(|| header.vertex.too_short(found))?;
        points.push(&row);
    }
    points.finish();
    Ok(())
}

/// Reads the points of an ASCII body; a note where they are more or fewer than stated.
fn read_ascii(
    header: &Header,
    body: &[u8],
    cloud: &mut PointCloud,
) -> Result<Option<String>, PlyError> {
    let mut rows = ascii::Rows::new(body);
    for element in header.before.iter().filter(|element| !element.properties.is_empty()) {
        for found in 0..element.count {
            rows.skip_row().ok_or_else(|| element.too_short(found))?;
        }
    }
    let (words, stated) = (header.words(), header.vertex.count);
    let mut points = ascii::Points::new(cloud, header.intensity.is_some());
    let (mut row, mut found) = ([0.0; 4], 0);
    // Behind the points there may be other elements, if more were stated.
    while found < stated || header.is_last {
        let Some(read) = rows.next_row(&words, &mut row) else { break };
        read.map_err(|ascii::BadRow { expected, found: line }| PlyError::BadRow {
            expected,
            point: found,
            found: line,
        })?;
        points.push(&row);
        found += 1;
    }
    points.finish();
    if found == stated {
        return Ok(None);
    }
    other_count(stated, found).map(Some).ok_or_else(|| header.vertex.too_short(found))
}

impl Header {
    /// The header without the properties that are not asked for.
    fn with(self, fields: Fields) -> Self {
        let intensity = self.intensity.filter(|_| fields == Fields::All);
        Self { intensity, ..self }
    }

    /// x, y, z and, where there is one, the intensity.
    fn kept(&self) -> impl Iterator<Item = &Kept> {
        self.xyz.iter().chain(&self.intensity)
    }

    /// The columns of points that are all equally long.
    fn columns(&self, row_bytes: usize) -> Columns {
        let column = |kept: &Kept| {
            let before = &self.vertex.properties[..kept.index];
            let start = before.iter().filter_map(|property| property.kind.size()).sum();
            Column { scalar: kept.scalar, start, stride: row_bytes }
        };
        let xyz = self.xyz.each_ref().map(column);
        Columns { xyz, intensity: self.intensity.as_ref().map(column) }
    }

    /// What to do with each word of an ASCII point.
    fn words(&self) -> Vec<Word> {
        let word = |property: &Property| match property.kind {
            Kind::One(_) => Word::Skip,
            Kind::List { .. } => Word::List,
        };
        let mut words: Vec<Word> = self.vertex.properties.iter().map(word).collect();
        for (slot, kept) in self.kept().enumerate() {
            words[kept.index] = Word::Keep(slot);
        }
        words
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ORDERS: [ByteOrder; 2] = [ByteOrder::Little, ByteOrder::Big];

    /// A camera, two points with a list, a face: every kind of thing that can be in the way.
    const WITH_LISTS: &str = "ply\nformat FORMAT 1.0\ncomment by hand\nelement camera 1\n\
        property list uchar int numbers\nproperty double f\nelement nothing 99999999999\n\
        element vertex 2\nproperty float x\nproperty list ushort short tags\nproperty double y\n\
        property uint id\nproperty float z\nproperty ushort reflectance\nelement face 1\n\
        property list uchar int vertex_indices\nend_header\n";

    /// The bytes of a number in either order.
    fn number<const N: usize>(little: [u8; N], order: ByteOrder) -> Vec<u8> {
        let mut bytes = little.to_vec();
        if order == ByteOrder::Big {
            bytes.reverse();
        }
        bytes
    }

    fn format(order: ByteOrder) -> &'static str {
        match order {
            ByteOrder::Little => "binary_little_endian",
            ByteOrder::Big => "binary_big_endian",
        }
    }

    fn with_lists(order: ByteOrder) -> Vec<u8> {
        let mut bytes = WITH_LISTS.replace("FORMAT", format(order)).into_bytes();
        bytes.push(2);
        bytes.extend([0xff; 2 * 4 + 8]);
        for (x, tags) in [(1.0_f32, 0_u16), (2.0, 3)] {
            bytes.extend(number(x.to_le_bytes(), order));
            bytes.extend(number(tags.to_le_bytes(), order));
            bytes.extend(vec![0xee; 2 * usize::from(tags)]);
            bytes.extend(number((f64::from(x) + 0.5).to_le_bytes(), order));
            bytes.extend([0xdd; 4]);
            bytes.extend(number((-x).to_le_bytes(), order));
            bytes.extend(number(513_u16.to_le_bytes(), order));
        }
        bytes
    }

    fn table(order: ByteOrder, points: &[[f32; 3]]) -> Vec<u8> {
        let mut bytes = format!(
            "ply\nformat {} 1.0\nelement camera 1\nproperty short id\nelement vertex {}\nproperty uchar red\n\
             property float y\nproperty float x\nproperty float z\nproperty uchar intensity\nend_header\n",
            format(order),
            points.len()
        )
        .into_bytes();
        bytes.extend([7, 7]);
        for [x, y, z] in points {
            bytes.push(9);
            bytes.extend([y, x, z].iter().flat_map(|v| number(v.to_le_bytes(), order)));
            bytes.push(200);
        }
        bytes
    }

    fn error(bytes: &[u8]) -> String {
        parse(bytes, "s").unwrap_err().to_string()
    }

    #[test]
    fn lists_and_other_elements_are_passed_over() {
        for order in ORDERS {
            let cloud = parse(&with_lists(order), "s").unwrap();
            assert_eq!((cloud.x, cloud.y), (vec![1.0, 2.0], vec![1.5, 2.5]), "{order:?}");
            assert_eq!((cloud.z, cloud.intensity), (vec![-1.0, -2.0], vec![513.0; 2]));
        }
        let rows = "2 9 9 0.5\n1 0 1.5 7 -1 513\n2 3 0 0 0 2.5 7 -2 513\n3 0 1 2\n";
        let cloud = parse((WITH_LISTS.replace("FORMAT", "ascii") + rows).as_bytes(), "s").unwrap();
        assert_eq!((cloud.x, cloud.y), (vec![1.0, 2.0], vec![1.5, 2.5]));
        assert_eq!((cloud.z, cloud.intensity), (vec![-1.0, -2.0], vec![513.0; 2]));
    }

    #[test]
    fn points_of_one_length_are_read_in_both_orders() {
        for order in ORDERS {
            let points = [[1.0, 2.0, 3.0], [f32::NAN, 0.0, 0.0], [-4.0, 5.0, 0.1]];
            let cloud = parse(&table(order, &points), "s").unwrap();
            assert_eq!((&cloud.x[..], &cloud.y[..]), (&[1.0, -4.0][..], &[2.0, 5.0][..]));
            assert_eq!((&cloud.z[..], cloud.skipped), (&[3.0, 0.1][..], 1));
            assert_eq!(cloud.intensity, [200.0; 2]);
        }
    }

    #[test]
    fn whole_coordinates_and_wide_properties_are_read() {
        let head = "ply\nformat binary_little_endian 1.0\nelement point 1\nproperty int64 id\nproperty short x\n\
            property uchar y\nproperty int z\nend_header\n";
        let body = [&[7; 8][..], &(-300_i16).to_le_bytes(), &[200], &(-70_000_i32).to_le_bytes()];
        let bytes = [head.as_bytes(), &body.concat()].concat();
        let mut cloud = PointCloud::default();
        let notes = fill(&bytes, Fields::All, &mut cloud).unwrap();
        assert_eq!((cloud.x[0], cloud.y[0], cloud.z[0]), (-300.0, 200.0, -70_000.0));
        assert!(notes[0].contains("whole numbers"), "{notes:?}");
    }

    #[test]
    fn a_line_more_or_fewer_than_stated_is_noted() {
        let head = "ply\nformat ascii 1.0\nelement vertex 20\nproperty float x\nproperty float y\n\
            property float z\nend_header\n";
        for found in [19, 21] {
            let text = head.to_string() + &"1 2 -nan(ind)\n".repeat(found);
            let mut cloud = PointCloud::default();
            let notes = fill(text.as_bytes(), Fields::All, &mut cloud).unwrap();
            let expected = format!("expected 20 points as stated, found {found}, which are used");
            assert_eq!((notes, cloud.skipped), (vec![expected], found));
        }
    }

    #[test]
    fn trouble_says_what_was_expected_and_found() {
        let whole = table(ByteOrder::Little, &[[0.0; 3]; 3]);
        let short = &whole[..whole.len() - 15];
        assert_eq!(
            error(short),
            r#"expected 3 of element "vertex", found the end of the file after 1"#
        );
        let no_camera = &whole[..whole.len() - 3 * 14 - 1];
        assert_eq!(
            error(no_camera),
            r#"expected 1 of element "camera", found the end of the file after 0"#
        );
        let lists = with_lists(ByteOrder::Big);
        assert_eq!(
            error(&lists[..lists.len() - 1]),
            r#"expected 2 of element "vertex", found the end of the file after 1"#
        );
        let ascii = |rows: &str| error((WITH_LISTS.replace("FORMAT", "ascii") + rows).as_bytes());
        assert_eq!(
            ascii("0 0\n1 0 1 7 nowhere 5"),
            r#"expected a number in point 0, found "1 0 1 7 nowhere 5""#
        );
        assert_eq!(
            ascii(""),
            r#"expected 1 of element "camera", found the end of the file after 0"#
        );
        assert_eq!(
            ascii("0 0\n1 0 1 7 3 5\n"),
            r#"expected 2 of element "vertex", found the end of the file after 1"#
        );
    }

    #[test]
    fn a_hostile_number_of_points_is_refused_before_it_is_allocated() {
        for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
            for list in ["", "property list uint double more\n"] {
                let text = format!(
                    "ply\nformat {format} 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
                     property float z\n{list}end_header\n",
                    u64::MAX
                );
                assert!(matches!(parse(text.as_bytes(), "s"), Err(PlyError::TooShort { .. })));
                let endless_list = [text.as_bytes(), &[0xff; 16]].concat();
                assert!(parse(&endless_list, "s").is_err());
            }
        }
    }

    proptest! {
        #[test]
        fn random_and_mutated_files_never_panic(
            tail in prop::collection::vec(any::<u8>(), 0..200),
            order in prop::sample::select(&ORDERS[..]),
            at in any::<prop::sample::Index>(),
            value in any::<u8>(),
            keep in any::<prop::sample::Index>(),
        ) {
            let _ = parse(&tail, "s");
            let _ = parse(&[WITH_LISTS.replace("FORMAT", "ascii").as_bytes(), &tail].concat(), "s");
            for mut bytes in [with_lists(order), table(order, &[[1.0; 3]; 3])] {
                let at = at.index(bytes.len());
                bytes[at] = value;
                let _ = parse(&bytes, "s");
                bytes.truncate(keep.index(bytes.len()));
                let _ = parse(&bytes, "s");
            }
        }
    }
}
