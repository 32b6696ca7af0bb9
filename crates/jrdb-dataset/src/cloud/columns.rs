//! Columns of numbers out of rows of bytes, and the cloud that they make.

use jrdb_types::PointCloud;

/// Type of a number that can be kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    F16,
    F32,
    F64,
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
}

impl Scalar {
    /// Bytes of a number.
    pub(super) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::F16 | Self::I16 | Self::U16 => 2,
            Self::F32 | Self::I32 | Self::U32 => 4,
            Self::F64 | Self::I64 | Self::U64 => 8,
        }
    }

    /// The number at the start of the bytes; NaN when they are too few.
    pub(super) fn read(self, bytes: &[u8], order: ByteOrder) -> f32 {
        let number = match self {
            Self::F16 => chunk(bytes, order).map(|b| half(u16::from_le_bytes(b))),
            Self::F32 => chunk(bytes, order).map(f32::from_le_bytes),
            Self::F64 => chunk(bytes, order).map(|b| f64::from_le_bytes(b) as f32),
            Self::I8 => chunk(bytes, order).map(|b| f32::from(i8::from_le_bytes(b))),
            Self::I16 => chunk(bytes, order).map(|b| f32::from(i16::from_le_bytes(b))),
            Self::I32 => chunk(bytes, order).map(|b| i32::from_le_bytes(b) as f32),
            Self::I64 => chunk(bytes, order).map(|b| i64::from_le_bytes(b) as f32),
            Self::U8 => bytes.first().map(|&b| f32::from(b)),
            Self::U16 => chunk(bytes, order).map(|b| f32::from(u16::from_le_bytes(b))),
            Self::U32 => chunk(bytes, order).map(|b| u32::from_le_bytes(b) as f32),
            Self::U64 => chunk(bytes, order).map(|b| u64::from_le_bytes(b) as f32),
        };
        number.unwrap_or(f32::NAN)
    }
}

impl Scalar {
    /// Whether the numbers may have parts.
    pub(super) fn is_float(self) -> bool {
        matches!(self, Self::F16 | Self::F32 | Self::F64)
    }

    /// Whether a column of this type can be the strength of returns.
    pub(super) fn is_strength(self) -> bool {
        self.is_float() || matches!(self, Self::U8 | Self::U16)
    }
}

/// The number that a half-precision float stands for.
fn half(bits: u16) -> f32 {
    const MANTISSA_BITS: i32 = 10;
    const BIAS: i32 = 15;
    let (sign, exponent) = (bits >> 15, i32::from(bits >> MANTISSA_BITS & 0x1f));
    let mantissa = f32::from(bits & 0x3ff);
    let step = |exponent: i32| 2_f32.powi(exponent - BIAS - MANTISSA_BITS);
    let size = match (exponent, bits & 0x3ff) {
        (0, _) => mantissa * step(1),
        (31, 0) => f32::INFINITY,
        (31, _) => f32::NAN,
        _ => (mantissa + 1024.0) * step(exponent),
    };
    if sign == 1 { -size } else { size }
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
const BLOCK_ROWS: usize = 4096;

impl Columns {
    /// x, y, z and intensity.
    fn each(self) -> [Option<Column>; 4] {
        let [x, y, z] = self.xyz.map(Some);
        [x, y, z, self.intensity]
    }

    /// Where each row has x, y and z one behind the other as little-endian floats, and the length of rows; none where they are
    /// not.
    fn places(&self, order: ByteOrder) -> Option<(usize, usize)> {
        let Column { start, stride, .. } = self.xyz[0];
        let is_next = |(axis, column): (usize, &Column)| {
            column.scalar == Scalar::F32
                && column.start == start + axis * Scalar::F32.size()
                && column.stride == stride
        };
        let are_floats = self.xyz.iter().enumerate().all(is_next);
        (are_floats && order == ByteOrder::Little).then_some((start, stride))
    }

    /// The columns with their places among x, y, z and intensity, as they come in the file.
    pub(super) fn in_order(self) -> Vec<(usize, Column)> {
        let columns = self.each().into_iter().enumerate();
        let mut columns: Vec<(usize, Column)> =
            columns.filter_map(|(axis, column)| Some((axis, column?))).collect();
        columns.sort_by_key(|(_, column)| column.start);
        columns
    }

    /// Fills a cloud with these columns. Rows that the body does not reach are not finite; callers
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
    /// [`Columns::places`].
    places: Option<(usize, usize)>,
    cloud: &'a mut PointCloud,
    /// Rows that each column has so far.
    filled: [usize; 4],
    order: ByteOrder,
    /// Whether every coordinate so far is a finite number.
    is_finite: bool,
}

impl<'a> Growing<'a> {
    /// A cloud to be given so many rows, in the memory that it has.
    pub(super) fn new(
        columns: Columns,
        rows: usize,
        order: ByteOrder,
        cloud: &'a mut PointCloud,
    ) -> Self {
        let (columns, places) = (columns.each(), columns.places(order));
        for (column, numbers) in columns.iter().zip(numbers(cloud)) {
            resize(numbers, column.map_or(0, |_| rows));
        }
        cloud.skipped = 0;
        Self { columns, places, cloud, filled: [0; 4], order, is_finite: true }
    }

    /// Decodes the next rows, which start where the body does.
    pub(super) fn append(&mut self, body: &[u8], rows: usize) {
        for first in (0..rows).step_by(BLOCK_ROWS) {
            let count = BLOCK_ROWS.min(rows - first);
            let placed = self.append_places(body, first, count);
            for axis in 0..self.columns.len() {
                let done = if axis < 3 { placed } else { 0 };
                self.append_axis(axis, body, first + done, count - done);
            }
        }
    }

    /// Decodes x, y and z of some rows at once, where they are of a usual length; how many rows. 22
    /// bytes are Velodyne's points, 26 Hesai's, 48 Ouster's.
    fn append_places(&mut self, body: &[u8], first: usize, count: usize) -> usize {
        let Some((start, stride)) = self.places else { return 0 };
        let bytes = body.get(start + first * stride..).unwrap_or_default();
        match stride {
            12 => self.append_rows::<12>(bytes, count),
            16 => self.append_rows::<16>(bytes, count),
            20 => self.append_rows::<20>(bytes, count),
            22 => self.append_rows::<22>(bytes, count),
            26 => self.append_rows::<26>(bytes, count),
            32 => self.append_rows::<32>(bytes, count),
            48 => self.append_rows::<48>(bytes, count),
            _ => 0,
        }
    }

    /// Decodes x, y and z of the rows that the bytes reach to the end of, at most so many; how many.
    fn append_rows<const STRIDE: usize>(&mut self, bytes: &[u8], count: usize) -> usize {
        let rows = bytes.as_chunks::<STRIDE>().0;
        let rows = &rows[..count.min(rows.len())];
        let [x, y, z, _] = numbers(self.cloud);
        let start = self.filled[0];
        let xyz = [x, y, z].map(|axis| &mut axis[start..start + rows.len()]);
        self.is_finite &= pulp::Arch::new().dispatch(Places { rows, xyz });
        self.filled[..3].fill(start + rows.len());
        rows.len()
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
        let start = self.filled[axis];
        let numbers = &mut numbers[start..start + count];
        column.decode(body, first, self.order, numbers);
        self.is_finite &= axis > 2 || all_finite(numbers);
        self.filled[axis] += count;
    }

    pub(super) fn finish(self) {
        if !self.is_finite {
            close_gaps(self.cloud);
        }
    }
}

/// The rows to take columns from, by the widest registers of the machine: each row starts with three little-endian floats.
struct Places<'a, const STRIDE: usize> {
    rows: &'a [[u8; STRIDE]],
    xyz: [&'a mut [f32]; 3],
}

impl<const STRIDE: usize> pulp::NullaryFnOnce for Places<'_, STRIDE> {
    /// Whether all are finite numbers.
    type Output = bool;

    #[inline(always)]
    fn call(self) -> bool {
        const SIGN: u32 = 1 << 31;
        let [x, y, z] = self.xyz;
        let mut greatest = 0;
        for (((row, x), y), z) in self.rows.iter().zip(x).zip(y).zip(z) {
            let bits = |at| u32::from_le_bytes([row[at], row[at + 1], row[at + 2], row[at + 3]]);
            let (bits_x, bits_y, bits_z) = (bits(0), bits(4), bits(8));
            greatest = greatest.max(bits_x & !SIGN).max(bits_y & !SIGN).max(bits_z & !SIGN);
            (*x, *y, *z) = (f32::from_bits(bits_x), f32::from_bits(bits_y), f32::from_bits(bits_z));
        }
        greatest < f32::INFINITY.to_bits()
    }
}

/// x, y, z and intensity.
pub(super) fn numbers(cloud: &mut PointCloud) -> [&mut Vec<f32>; 4] {
    [&mut cloud.x, &mut cloud.y, &mut cloud.z, &mut cloud.intensity]
}

impl Column {
    /// Reads the numbers of some rows.
    #[inline(always)]
    fn decode(self, body: &[u8], first: usize, order: ByteOrder, numbers: &mut [f32]) {
        let bytes = body.get(self.start + first * self.stride..).unwrap_or_default();
        let read = numbers.len().min(bytes.len() / self.stride);
        let (whole, last) = numbers.split_at_mut(read);
        match (self.scalar, order, self.stride) {
            // The usual floats, fast: a column of its own, `x y z intensity` and nuScenes' five.
            (Scalar::F32, ByteOrder::Little, 4) => floats::<4>(bytes, whole),
            (Scalar::F32, ByteOrder::Little, 16) => floats::<16>(bytes, whole),
            (Scalar::F32, ByteOrder::Little, 20) => floats::<20>(bytes, whole),
            (Scalar::F32, ByteOrder::Little, stride) if stride > 4 => {
                for (number, row) in whole.iter_mut().zip(bytes.chunks_exact(stride)) {
                    *number = f32::from_le_bytes([row[0], row[1], row[2], row[3]]);
                }
            }
            (scalar, _, stride) => {
                for (number, row) in whole.iter_mut().zip(bytes.chunks_exact(stride)) {
                    *number = scalar.read(row, order);
                }
            }
        }
        for (number, row) in last.iter_mut().zip(read..) {
            // The last row of a file ends before the stride does when the column is not its first.
            let bytes = bytes.get(row * self.stride..).unwrap_or_default();
            *number = self.scalar.read(bytes, order);
        }
    }
}

/// Reads the little-endian float at the start of each row.
fn floats<const STRIDE: usize>(bytes: &[u8], numbers: &mut [f32]) {
    for (number, row) in numbers.iter_mut().zip(bytes.as_chunks::<STRIDE>().0) {
        *number = f32::from_le_bytes([row[0], row[1], row[2], row[3]]);
    }
}

/// Gives a column so many numbers, of any value, in the memory that it has if that is enough.
fn resize(numbers: &mut Vec<f32>, count: usize) {
    if numbers.capacity() < count {
        *numbers = vec![0.0; count]; // which nobody has to fill with zeros
    } else {
        numbers.resize(count, 0.0);
    }
}

/// Takes all points out of a cloud, but keeps its memory.
pub(super) fn empty(cloud: &mut PointCloud) {
    for column in numbers(cloud) {
        column.clear();
    }
    cloud.skipped = 0;
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
    fn integers_and_halves_are_read_in_both_orders() {
        let read = |scalar: Scalar, bytes: &[u8]| {
            let reversed: Vec<u8> = bytes.iter().rev().copied().collect();
            let number = scalar.read(bytes, ByteOrder::Little);
            assert_eq!(scalar.size(), bytes.len());
            let big = scalar.read(&reversed, ByteOrder::Big);
            assert!(big == number || (big.is_nan() && number.is_nan()), "{scalar:?}");
            number
        };
        assert_eq!(read(Scalar::I8, &(-7_i8).to_le_bytes()), -7.0);
        assert_eq!(read(Scalar::I16, &(-700_i16).to_le_bytes()), -700.0);
        assert_eq!(read(Scalar::I32, &(-70_000_i32).to_le_bytes()), -70_000.0);
        assert_eq!(read(Scalar::I64, &(-70_000_i64).to_le_bytes()), -70_000.0);
        assert_eq!(read(Scalar::U32, &70_000_u32.to_le_bytes()), 70_000.0);
        assert_eq!(read(Scalar::U64, &70_000_u64.to_le_bytes()), 70_000.0);
        let halves =
            [(0x3c00_u16, 1.0), (0xc500, -5.0), (0x0001, 5.960_464_5e-8), (0x7c00, f32::INFINITY)];
        for (bits, number) in halves {
            assert_eq!(read(Scalar::F16, &bits.to_le_bytes()), number, "{bits:x}");
        }
        assert!(read(Scalar::F16, &0x7e00_u16.to_le_bytes()).is_nan());
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
            for stride in [12, 16, 18, 20, 22, 26, 48] {
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
