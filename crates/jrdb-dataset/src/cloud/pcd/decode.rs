//! Bytes of a PCD file to points.

use jrdb_types::PointCloud;

use super::encoding::Encoding;
use super::error::PcdError;
use super::header::{Header, Kept};
use super::lzf::{self, Decompressor};
use crate::cloud::ascii::{self, Word};
use crate::cloud::columns::{ByteOrder, Column, Columns, Growing, empty};
use crate::cloud::fields::{Fields, Notes, filled, other_count, whole_coordinates};

/// Parses a PCD file as the sweep of a sensor.
///
/// `x`, `y` and `z` are numbers of any type. `intensity` is kept when it is a float or an unsigned
/// integer of at most 2 bytes; other fields are passed over. Points with a non-finite coordinate are
/// left out and counted in [`PointCloud::skipped`]. Bytes after the last point are ignored in the
/// binary encodings. What PCL reads of old and careless files is read: `COLUMNS`, no `SIZE`, `TYPE` or `COUNT`
/// (4-byte floats), keywords and field names in any case, a byte order mark, a block that is stored as it is, and an ASCII file
/// with a few lines more or fewer than it states.
///
/// ```
/// let text = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n\
///             WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n1 2 3\nnan 0 0\n";
/// let cloud = jrdb_dataset::pcd::parse(text.as_bytes(), "upper_velodyne").unwrap();
/// assert_eq!((cloud.x[0], cloud.len(), cloud.skipped), (1.0, 1, 1));
/// ```
///
/// # Errors
/// [`PcdError`]; nothing is allocated for points that the file has no bytes for.
pub fn parse(bytes: &[u8], sensor: &str) -> Result<PointCloud, PcdError> {
    filled(sensor, |cloud| fill(bytes, Fields::All, &mut Vec::new(), cloud))
}

/// [`parse`], of some fields only, into a cloud; decompresses into `block`.
pub(in crate::cloud) fn fill(
    bytes: &[u8],
    fields: Fields,
    block: &mut Vec<u8>,
    cloud: &mut PointCloud,
) -> Result<Notes, PcdError> {
    let (header, body) = Header::parse(bytes)?;
    let header = header.with(fields);
    let rows = header.points as usize; // of a binary body, which is checked to have them
    let little = ByteOrder::Little;
    let mut notes = header.notes();
    match header.encoding {
        Encoding::Ascii => notes.extend(read_ascii(&header, body, cloud)?),
        Encoding::Binary => {
            let body = body.get(..header.body_bytes(body.len())?).unwrap_or_default();
            let columns = header.columns(|kept| (kept.offset, header.row_bytes));
            columns.fill(body, rows, little, cloud);
        }
        Encoding::BinaryCompressed if header.points == 0 => empty(cloud),
        Encoding::BinaryCompressed => fill_compressed(&header, body, block, cloud)?,
    }
    Ok(notes)
}

impl Header {
    /// The header without the fields that are not asked for.
    pub(super) fn with(self, fields: Fields) -> Self {
        let intensity = self.intensity.filter(|_| fields == Fields::All);
        Self { intensity, ..self }
    }

    /// What is odd about the header.
    pub(super) fn notes(&self) -> Notes {
        let whole = self.has_whole_coordinates().then(|| whole_coordinates("TYPE I or U"));
        whole.into_iter().collect()
    }

    /// The columns, given each one's start and stride.
    pub(super) fn columns(&self, place: impl Fn(&Kept) -> (usize, usize)) -> Columns {
        let column = |kept: &Kept| {
            let (start, stride) = place(kept);
            Column { scalar: kept.scalar, start, stride }
        };
        let xyz = self.xyz.each_ref().map(&column);
        Columns { xyz, intensity: self.intensity.as_ref().map(column) }
    }

    /// What to do with each number of an ASCII line.
    fn words(&self) -> Vec<Word> {
        let mut words = vec![Word::Skip; self.columns_per_row];
        for (slot, kept) in self.xyz.iter().chain(&self.intensity).enumerate() {
            words[kept.column] = Word::Keep(slot);
        }
        words
    }
}

/// Reads the points of an ASCII body; a note where they are more or fewer than stated.
fn read_ascii(
    header: &Header,
    body: &[u8],
    cloud: &mut PointCloud,
) -> Result<Option<String>, PcdError> {
    let (mut rows, words) = (ascii::Rows::new(body), header.words());
    let (mut points, mut found) = (ascii::Points::new(cloud, header.intensity.is_some()), 0);
    let mut row = [0.0; 4];
    while let Some(read) = rows.next_row(&words, &mut row) {
        let bad = |bad: ascii::BadRow| PcdError::BadRow {
            expected: bad.expected,
            point: found,
            found: bad.found,
        };
        read.map_err(bad)?;
        points.push(&row);
        found += 1;
    }
    points.finish();
    if found as u64 == header.points {
        return Ok(None);
    }
    let note = other_count(header.points, found as u64);
    note.map(Some).ok_or(PcdError::WrongCount { expected: header.points, found })
}

/// Rows of a column that are decompressed before they are decoded: they are then still in the first-level cache.
const PIECE_ROWS: usize = 1 << 12;

/// Reads columns one behind the other, from a block that is decompressed as far as they go.
fn fill_compressed(
    header: &Header,
    body: &[u8],
    block: &mut Vec<u8>,
    cloud: &mut PointCloud,
) -> Result<(), PcdError> {
    let expected = header.body_bytes(body.len().saturating_mul(lzf::MAX_RATIO))?;
    let stream = compressed(body, expected)?;
    let rows = header.points as usize; // no more than the block is found to have
    let columns = header.columns(|kept| (kept.offset * rows, kept.scalar.size()));
    if unpack(columns, rows, Packed { stream, expected }, block, cloud).is_some() {
        return Ok(());
    }
    if stream.len() == expected {
        // What does not become shorter is stored as it is by some programs.
        columns.fill(stream, rows, ByteOrder::Little, cloud);
        return Ok(());
    }
    Err(bad_compression(expected, "a stream that stands for others".into()))
}

/// A compressed block, and the bytes that it should stand for.
struct Packed<'a> {
    stream: &'a [u8],
    expected: usize,
}

/// Decompresses columns piece by piece and decodes each piece at once; none when the stream is not one of LZF.
fn unpack(
    columns: Columns,
    rows: usize,
    Packed { stream, expected }: Packed<'_>,
    block: &mut Vec<u8>,
    cloud: &mut PointCloud,
) -> Option<()> {
    let columns_in_order = columns.in_order();
    let ends = columns_in_order.iter().map(|(_, column)| column.start + rows * column.stride);
    let end = ends.max().unwrap_or(0).min(expected);
    let mut block = Decompressor::new(stream, expected, end, block)?;
    let mut growing = Growing::new(columns, rows, ByteOrder::Little, cloud);
    for (axis, column) in columns_in_order {
        for first in (0..rows).step_by(PIECE_ROWS) {
            let count = PIECE_ROWS.min(rows - first);
            let end = column.start + (first + count) * column.stride;
            growing.append_axis(axis, block.first(end)?, first, count);
        }
    }
    block.first(end)?;
    growing.finish();
    Some(())
}

/// A block larger than this is refused when its stream is so short that nearly all points must be alike.
const MAX_BYTES_OF_ANY_RATIO: usize = 32 << 20;
/// Most bytes that a byte of a stream may stand for in a large block. Sweeps reach 2; those with nothing but zeros, 88.
const MAX_LARGE_RATIO: usize = 16;
/// Largest block: more points than any sweep has.
const MAX_BLOCK_BYTES: usize = 1 << 30;

/// The compressed bytes of a body that says how many they are and what they stand for.
fn compressed(body: &[u8], expected: usize) -> Result<&[u8], PcdError> {
    let Some((sizes, rest)) = body.split_at_checked(8) else {
        return Err(bad_compression(
            expected,
            format!("{} bytes, too few for its sizes", body.len()),
        ));
    };
    let size = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| sizes[at + i])) as usize;
    if size(4) != expected {
        return Err(bad_compression(expected, format!("one that states {}", size(4))));
    }
    let stream = rest.get(..size(0)).ok_or_else(|| {
        bad_compression(expected, format!("{} of {} compressed bytes", rest.len(), size(0)))
    })?;
    let is_bomb = expected > MAX_BYTES_OF_ANY_RATIO
        && expected > stream.len().saturating_mul(MAX_LARGE_RATIO);
    if is_bomb || expected > MAX_BLOCK_BYTES {
        let found = format!("{} compressed bytes, too few for points of a sweep", stream.len());
        return Err(bad_compression(expected, found));
    }
    Ok(stream)
}

fn bad_compression(expected: usize, found: String) -> PcdError {
    PcdError::BadCompression { expected, found }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::pcd::write;
    use proptest::prelude::*;

    const ENCODINGS: [Encoding; 3] =
        [Encoding::Ascii, Encoding::Binary, Encoding::BinaryCompressed];

    fn clouds() -> impl Strategy<Value = PointCloud> {
        let point = (-100.0..100_f32, -100.0..100_f32, -3.0..3_f32, 0..255_u8);
        (prop::collection::vec(point, 0..60), any::<bool>()).prop_map(|(points, has_intensity)| {
            PointCloud {
                sensor: "lower_velodyne".into(),
                x: points.iter().map(|p| p.0).collect(),
                y: points.iter().map(|p| p.1).collect(),
                z: points.iter().map(|p| p.2).collect(),
                intensity: points
                    .iter()
                    .filter(|_| has_intensity)
                    .map(|p| f32::from(p.3))
                    .collect(),
                skipped: 0,
            }
        })
    }

    fn ascii(header: &str, rows: &str) -> String {
        format!("# made by hand\nVERSION 0.7\n{header}\nDATA ascii\n{rows}")
    }

    fn error(text: &str) -> String {
        parse(text.as_bytes(), "s").unwrap_err().to_string()
    }

    #[test]
    fn fields_may_stand_in_any_order_among_others() {
        let mut bytes = b"FIELDS ring z normal intensity y x\nSIZE 2 8 4 1 4 4\nTYPE U F F U F F\n\
            COUNT 1 1 3 1 1 1\nPOINTS 1\nWIDTH 1\nHEIGHT 1\nVERSION .5\nDATA binary\n"
            .to_vec();
        bytes.extend(9_u16.to_le_bytes());
        bytes.extend(3.25_f64.to_le_bytes());
        bytes.extend([0xee; 12]);
        bytes.push(200);
        bytes.extend(2.5_f32.to_le_bytes());
        bytes.extend(1.5_f32.to_le_bytes());
        let cloud = parse(&bytes, "s").unwrap();
        assert_eq!(
            (cloud.x[0], cloud.y[0], cloud.z[0], cloud.intensity[0]),
            (1.5, 2.5, 3.25, 200.0)
        );
    }

    #[test]
    fn ascii_columns_follow_the_counts_of_the_fields_before() {
        let text = ascii(
            "FIELDS normal x y z\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 3 1 1 1\nWIDTH 1\nHEIGHT 1",
            "9 9 9 1 2 3\n",
        );
        let cloud = parse(text.as_bytes(), "s").unwrap();
        assert_eq!((cloud.x[0], cloud.y[0], cloud.z[0]), (1.0, 2.0, 3.0));
    }

    #[test]
    fn points_without_a_place_are_counted_and_left_out_with_their_intensity() {
        let text = ascii(
            "FIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 3\nHEIGHT 1\nPOINTS 3",
            "1 2 3 4\n-nan 0 0 5\n6 inf 7 8",
        );
        let cloud = parse(text.as_bytes(), "s").unwrap();
        assert_eq!((cloud.len(), cloud.skipped, &cloud.intensity[..]), (1, 2, &[4.0][..]));
    }

    #[test]
    fn an_intensity_of_another_type_is_passed_over() {
        let text = ascii(
            "FIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F I\nWIDTH 1\nHEIGHT 1",
            "1 2 3 4",
        );
        assert!(parse(text.as_bytes(), "s").unwrap().intensity.is_empty());
    }

    #[test]
    fn trouble_says_what_was_expected_and_found() {
        let xyz = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1";
        let cases = [
            (ascii(xyz, "1 2 3"), "expected 2 points, found 1"),
            (ascii(xyz, "1 2 3\n1 2"), r#"expected 3 columns in point 1, found "1 2""#),
            (ascii(xyz, "1 2 three"), r#"expected a number in point 0, found "1 2 three""#),
            (ascii(xyz, "").replace("ascii", "binary"), "expected 24 bytes for 2 points, found 0"),
            (
                ascii(xyz, "\u{8}\0\0\0\u{18}\0\0\0").replace("ascii", "binary_compressed"),
                "expected an lzf block of 24 bytes, found 0 of 8 compressed bytes",
            ),
            (
                ascii(xyz, "\u{1}\0\0\0\u{19}\0\0\0\0").replace("ascii", "binary_compressed"),
                "expected an lzf block of 24 bytes, found one that states 25",
            ),
        ];
        for (text, expected) in cases {
            assert_eq!(error(&text), expected);
        }
    }

    /// The notes on a file that can be read, and its points.
    fn noted(bytes: &[u8]) -> (Notes, usize) {
        let mut cloud = PointCloud::default();
        let notes = fill(bytes, Fields::All, &mut Vec::new(), &mut cloud).unwrap();
        (notes, cloud.len())
    }

    #[test]
    fn a_line_more_or_fewer_than_stated_is_noted() {
        let header = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 20\nHEIGHT 1";
        assert_eq!(noted(ascii(header, &"1 2 3\n".repeat(20)).as_bytes()), (vec![], 20));
        for found in [19, 21] {
            let (notes, points) = noted(ascii(header, &"1 2 3\n".repeat(found)).as_bytes());
            let expected = format!("expected 20 points as stated, found {found}, which are used");
            assert_eq!((notes, points), (vec![expected], found));
        }
        assert_eq!(error(&ascii(header, &"1 2 3\n".repeat(9))), "expected 20 points, found 9");
    }

    #[test]
    fn whole_coordinates_of_every_type_are_read_and_noted() {
        for (kind, size) in
            [("I", 1), ("I", 2), ("I", 4), ("I", 8), ("U", 1), ("U", 2), ("U", 4), ("U", 8)]
        {
            let header = format!(
                "FIELDS x y z\nSIZE {size} {size} {size}\nTYPE {kind} {kind} {kind}\nWIDTH 1\nHEIGHT 1\nDATA binary\n"
            );
            let number = |low: u8| [&[low][..], &vec![0; size - 1]].concat();
            let bytes = [header.into_bytes(), number(1), number(2), number(3)].concat();
            let cloud = parse(&bytes, "s").unwrap();
            assert_eq!((cloud.x[0], cloud.y[0], cloud.z[0]), (1.0, 2.0, 3.0), "{kind}{size}");
            assert!(noted(&bytes).0[0].contains("whole numbers"));
        }
    }

    #[test]
    fn a_stored_block_is_read_as_it_is() {
        let cloud = PointCloud {
            sensor: "s".into(),
            x: vec![1.5, -2.25, 3.0],
            y: vec![0.1, 0.2, 0.3],
            z: vec![-1.0, -1.5, 7.75],
            ..PointCloud::default()
        };
        let columns = [&cloud.x, &cloud.y, &cloud.z].into_iter().flatten();
        let block: Vec<u8> = columns.flat_map(|v| v.to_le_bytes()).collect();
        let head =
            "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 3\nHEIGHT 1\nDATA binary_compressed\n";
        let size = (block.len() as u32).to_le_bytes();
        let bytes = [head.as_bytes(), &size, &size, &block].concat();
        assert_eq!(parse(&bytes, "s").unwrap(), cloud);
        let empty = head.replace("WIDTH 3", "WIDTH 0");
        assert!(parse(empty.as_bytes(), "s").unwrap().is_empty(), "without sizes");
    }

    #[test]
    fn a_short_stream_for_a_large_block_is_refused() {
        let rows = 4_000_000;
        let head = format!("FIELDS x y z\nWIDTH {rows}\nHEIGHT 1\nDATA binary_compressed\n");
        let stream = [&[0, 0][..], &[0xe0, 0xff, 0].repeat(12 * rows / 264)].concat();
        let sizes = [stream.len() as u32, 12 * rows as u32].map(u32::to_le_bytes).concat();
        let text =
            parse(&[head.as_bytes(), &sizes, &stream].concat(), "s").unwrap_err().to_string();
        assert!(text.ends_with("compressed bytes, too few for points of a sweep"), "{text}");
    }

    #[test]
    fn a_line_without_end_is_quoted_in_part() {
        let header = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1";
        assert!(error(&ascii(header, &"7 ".repeat(10_000))).len() < 200);
    }

    #[test]
    fn a_hostile_number_of_points_is_refused_before_it_is_allocated() {
        let header = format!(
            "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH {0}\nHEIGHT 1\nPOINTS {0}",
            u64::MAX
        );
        for encoding in ["binary", "binary_compressed"] {
            let text = ascii(&header, "123456789").replace("ascii", encoding);
            assert!(matches!(parse(text.as_bytes(), "s"), Err(PcdError::TooShort { .. })));
        }
        assert!(matches!(
            parse(ascii(&header, "1 2 3").as_bytes(), "s"),
            Err(PcdError::WrongCount { found: 1, .. })
        ));
    }

    proptest! {
        #[test]
        fn clouds_survive_the_round_trip_in_all_encodings(cloud in clouds()) {
            for encoding in ENCODINGS {
                prop_assert_eq!(&parse(&write(&cloud, encoding), "lower_velodyne").unwrap(), &cloud);
            }
        }

        #[test]
        fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..500)) {
            let _ = parse(&bytes, "s");
        }

        #[test]
        fn mutated_files_never_panic(
            cloud in clouds(),
            encoding in prop::sample::select(&ENCODINGS[..]),
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
            keep in any::<prop::sample::Index>(),
        ) {
            let mut bytes = write(&cloud, encoding);
            for (at, value) in changes {
                let at = at.index(bytes.len());
                bytes[at] = value;
            }
            bytes.truncate(keep.index(bytes.len()) + 1);
            let _ = parse(&bytes, "s");
        }
    }
}
