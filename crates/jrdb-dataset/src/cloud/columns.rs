//! Columns of numbers out of rows of bytes, and the cloud that they make.

use jrdb_types::PointCloud;

/// Type of a number that can be kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    F32,
    F64,
    U8,
    U16,
}

impl Scalar {
    /// Bytes of a number.
    pub(super) const fn size(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The number at the start of the bytes; NaN when they are too few.
    pub(super) fn read(self, bytes: &[u8], order: ByteOrder) -> f32 {
        let number = match self {
            Self::F32 => chunk(bytes, order).map(f32::from_le_bytes),
            Self::F64 => chunk(bytes, order).map(|b| f64::from_le_bytes(b) as f32),
            Self::U8 => bytes.first().map(|&b| f32::from(b)),
            Self::U16 => chunk(bytes, order).map(|b| f32::from(u16::from_le_bytes(b))),
        };
        number.unwrap_or(f32::NAN)
    }

    pub(super) fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }
}

/// Which byte of a number comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

/// The bytes of a number, the lowest first.
fn chunk<const N: usize>(bytes: &[u8], order: ByteOrder) -> Option<[u8; N]> {
    let mut bytes = *bytes.first_chunk()?;
    if order == ByteOrder::Big {
        bytes.reverse();
    }
    Some(bytes)
}

/// Where the numbers of one field are: at `start`, `start + stride` and so on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Column {
    pub(super) scalar: Scalar,
    pub(super) start: usize,
    pub(super) stride: usize,
}

/// The columns that make a cloud.
#[derive(Debug, Clone, Copy)]
pub(super) struct Columns {
    pub(super) xyz: [Column; 3],
    pub(super) intensity: Option<Column>,
}

/// Rows that are decoded at a time: so few that their bytes, once read for the first column, are still at hand for
/// the others.
const BLOCK_ROWS: usize = 1024;

impl Columns {
    /// x, y, z and intensity.
    fn each(self) -> [Option<Column>; 4] {
        let [x, y, z] = self.xyz.map(Some);
        [x, y, z, self.intensity]
    }

    /// The columns with their places among x, y, z and intensity, as they come in the file.
    pub(super) fn in_order(self) -> Vec<(usize, Column)> {
        let columns = self.each().into_iter().enumerate();
        let mut columns: Vec<(usize, Column)> =
            columns.filter_map(|(axis, column)| Some((axis, column?))).collect();
        columns.sort_by_key(|(_, column)| column.start);
        columns
    }

    /// Fills a cloud without points with these columns. Rows that the body does not reach are not finite; callers
    /// check sizes.
    pub(super) fn fill(self, body: &[u8], rows: usize, order: ByteOrder, cloud: &mut PointCloud) {
        let mut growing = Growing::new(self, rows, order, cloud);
        growing.append(body, rows);
        growing.finish();
    }
}

/// A cloud that is decoded piece by piece.
pub(super) struct Growing<'a> {
    columns: [Option<Column>; 4],
    cloud: &'a mut PointCloud,
    order: ByteOrder,
    /// Whether every coordinate so far is a finite number.
    is_finite: bool,
}

impl<'a> Growing<'a> {
    /// A cloud without points, with memory for so many rows.
    pub(super) fn new(
        columns: Columns,
        rows: usize,
        order: ByteOrder,
        cloud: &'a mut PointCloud,
    ) -> Self {
        let columns = columns.each();
        for (column, numbers) in columns.iter().zip(numbers(cloud)) {
            numbers.reserve(column.map_or(0, |_| rows));
        }
        Self { columns, cloud, order, is_finite: true }
    }

    /// Decodes the next rows, which start where the body does.
    pub(super) fn append(&mut self, body: &[u8], rows: usize) {
        for first in (0..rows).step_by(BLOCK_ROWS) {
            let count = BLOCK_ROWS.min(rows - first);
            for axis in 0..self.columns.len() {
                self.append_axis(axis, body, first, count);
            }
        }
    }

    /// Decodes some rows of one column: those behind the ones it has.
    #[inline(always)]
    pub(super) fn append_axis(&mut self, axis: usize, body: &[u8], first: usize, count: usize) {
        let Some(column) = self.columns[axis] else { return };
        let [x, y, z, intensity] = numbers(self.cloud);
        let numbers = match axis {
            0 => x,
            1 => y,
            2 => z,
            _ => intensity,
        };
        let start = numbers.len();
        column.decode(body, first, count, self.order, numbers);
        self.is_finite &= axis > 2 || all_finite(&numbers[start..]);
    }

    pub(super) fn finish(self) {
        if !self.is_finite {
            close_gaps(self.cloud);
        }
    }
}

/// x, y, z and intensity.
pub(super) fn numbers(cloud: &mut PointCloud) -> [&mut Vec<f32>; 4] {
    [&mut cloud.x, &mut cloud.y, &mut cloud.z, &mut cloud.intensity]
}

impl Column {
    /// Appends the numbers of some rows.
    fn decode(
        self,
        body: &[u8],
        first: usize,
        count: usize,
        order: ByteOrder,
        numbers: &mut Vec<f32>,
    ) {
        let bytes = body.get(self.start + first * self.stride..).unwrap_or_default();
        let rows = bytes.chunks_exact(self.stride).take(count);
        let read = rows.len();
        match (self.scalar, order, self.stride) {
            // The usual floats, fast: a column of its own, `x y z intensity` and nuScenes' five.
            (Scalar::F32, ByteOrder::Little, 4) => numbers.extend(floats::<4>(bytes, read)),
            (Scalar::F32, ByteOrder::Little, 16) => numbers.extend(floats::<16>(bytes, read)),
            (Scalar::F32, ByteOrder::Little, 20) => numbers.extend(floats::<20>(bytes, read)),
            (Scalar::F32, ByteOrder::Little, _) => {
                let number = |row: &[u8]| row.first_chunk().map(|&bytes| f32::from_le_bytes(bytes));
                numbers.extend(rows.map(|row| number(row).unwrap_or(f32::NAN)));
            }
            (scalar, ..) => numbers.extend(rows.map(|row| scalar.read(row, order))),
        }
        if read < count {
            // The last row of a file ends before the stride does when the column is not its first.
            let last = bytes.get(read * self.stride..).unwrap_or_default();
            numbers.push(self.scalar.read(last, order));
        }
    }
}

/// The little-endian floats at the start of each row.
fn floats<const STRIDE: usize>(bytes: &[u8], rows: usize) -> impl ExactSizeIterator<Item = f32> {
    let rows = bytes.as_chunks::<STRIDE>().0.iter().take(rows);
    rows.map(|row| f32::from_le_bytes([row[0], row[1], row[2], row[3]]))
}

/// Moves the points together that have a place; the others are counted instead.
pub(super) fn close_gaps(cloud: &mut PointCloud) {
    let (rows, mut kept) = (cloud.len(), 0);
    let mut columns = numbers(cloud);
    for row in 0..rows {
        let [x, y, z, _] = &columns;
        let has_place = [x, y, z].iter().all(|axis| axis.get(row).is_some_and(|v| v.is_finite()));
        for column in &mut columns {
            // A cloud without intensity has none here either.
            if let Some(&number) = column.get(row) {
                column[kept] = number;
            }
        }
        kept += usize::from(has_place);
    }
    for column in columns {
        column.truncate(kept);
    }
    cloud.skipped = rows - kept;
}

/// Whether all numbers are sure to be finite, several at a time: their sums are. Numbers so large that a sum overflows
/// are taken for gaps, too, until [`close_gaps`] looks at each.
fn all_finite(numbers: &[f32]) -> bool {
    const LANES: usize = 16;
    let (blocks, rest) = numbers.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for block in blocks {
        for (sum, number) in sums.iter_mut().zip(block) {
            *sum += number;
        }
    }
    sums.iter().chain(rest).all(|number: &f32| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_at_the_end_of_the_number_range_are_kept() {
        let body: Vec<u8> = [f32::MAX; 3 * 40].iter().flat_map(|v| v.to_le_bytes()).collect();
        let column = |start| Column { scalar: Scalar::F32, start, stride: 12 };
        let columns = Columns { xyz: [0, 4, 8].map(column), intensity: None };
        let mut cloud = PointCloud::default();
        columns.fill(&body, 40, ByteOrder::Little, &mut cloud);
        assert_eq!((cloud.len(), cloud.skipped), (40, 0));
    }

    #[test]
    fn one_number_that_is_not_finite_is_found_wherever_it_is() {
        for at in 0..40 {
            for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                let mut numbers = [-1e30; 40];
                assert!(all_finite(&numbers));
                numbers[at] = value;
                assert!(!all_finite(&numbers), "{value} at {at}");
            }
        }
    }

    #[test]
    fn rows_of_any_length_and_number_are_read_to_the_last() {
        for rows in [0, 1, BLOCK_ROWS - 1, BLOCK_ROWS, 2 * BLOCK_ROWS + 1] {
            for stride in [12, 16, 18, 20] {
                let row = |i: usize| {
                    let numbers = [i as f32, -(i as f32), 0.5];
                    let mut row: Vec<u8> = numbers.iter().flat_map(|v| v.to_le_bytes()).collect();
                    row.splice(0..0, vec![0xff; stride - 12]);
                    row
                };
                let body: Vec<u8> = (0..rows).flat_map(row).collect();
                let column = |at| Column { scalar: Scalar::F32, start: stride - 12 + at, stride };
                let columns = Columns { xyz: [0, 4, 8].map(column), intensity: None };
                let mut cloud = PointCloud::default();
                columns.fill(&body, rows, ByteOrder::Little, &mut cloud);
                let expected: Vec<f32> = (0..rows).map(|i| i as f32).collect();
                assert_eq!(cloud.x, expected, "{stride}");
                assert_eq!(cloud.y, expected.iter().map(|v| -v).collect::<Vec<_>>(), "{stride}");
                assert_eq!(cloud.z, vec![0.5; rows], "{stride}");
            }
        }
    }
}
