//! A PCD file read piece by piece: the points of a binary one are decoded while their bytes are still at hand.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use jrdb_types::PointCloud;

use super::decode::fill;
use super::encoding::Encoding;
use super::error::PcdError;
use super::header::Header;
use crate::Error;
use crate::cloud::buffers::Buffers;
use crate::cloud::columns::{ByteOrder, Growing};
use crate::cloud::error::CloudError;
use crate::cloud::fields::{Fields, Notes};

/// Bytes that are read at a time, the header in the first: they stay in the second-level cache until they are decoded.
const PIECE: usize = 1 << 17;

/// Reads a file into a cloud; what it says is what [`super::parse`] says of its bytes.
pub(in crate::cloud) fn read(
    path: &Path,
    fields: Fields,
    Buffers { bytes, block }: &mut Buffers,
    cloud: &mut PointCloud,
) -> Result<Notes, Error> {
    let unreadable = |source| Error::Read { path: path.into(), source };
    let mut file = File::open(path).map_err(unreadable)?;
    let length = file.metadata().map_err(unreadable)?.len();
    bytes.resize(PIECE.max(bytes.len()), 0);
    let filled = read_full(&mut file, &mut bytes[..PIECE]).map_err(unreadable)?;
    let parsed = match Header::parse(&bytes[..filled]) {
        Ok((header, body)) if can_stream(&header, body) => {
            let (header, start) = (header.with(fields), filled - body.len());
            let source = Source { file, piece: &mut bytes[..PIECE], start, filled };
            let read = source.binary(&header, length, cloud).map_err(unreadable)?;
            read.map(|()| header.notes())
        }
        // Another encoding, or a header that is wrong or longer than a piece.
        _ => {
            bytes.truncate(filled);
            file.read_to_end(bytes).map_err(unreadable)?;
            fill(bytes, fields, block, cloud)
        }
    };
    parsed.map_err(|source| Error::Cloud { path: path.into(), source: CloudError::Pcd(source) })
}

/// Whether points can be read piece by piece. A header that ends where the piece does may not be whole.
fn can_stream(header: &Header, body: &[u8]) -> bool {
    let has_rows = (1..=PIECE).contains(&header.row_bytes);
    header.encoding == Encoding::Binary && has_rows && !body.is_empty()
}

/// Fills a buffer, or as much of it as the file has; how much.
fn read_full(file: &mut File, buffer: &mut [u8]) -> std::io::Result<usize> {
    let mut filled = 0;
    loop {
        match file.read(&mut buffer[filled..]) {
            Ok(0) => return Ok(filled),
            Ok(read) => filled += read,
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// An open file and the piece of it that was read last.
struct Source<'a> {
    file: File,
    piece: &'a mut [u8],
    /// Where in the piece the bytes start that are not yet decoded, and where they end.
    start: usize,
    filled: usize,
}

impl Source<'_> {
    /// The points of a binary body; the outer error is the file's, the inner one the format's.
    fn binary(
        mut self,
        header: &Header,
        length: u64,
        cloud: &mut PointCloud,
    ) -> std::io::Result<Result<(), PcdError>> {
        let available = usize::try_from(length).unwrap_or(usize::MAX).saturating_sub(self.start);
        if let Err(error) = header.body_bytes(available) {
            return Ok(Err(error));
        }
        let (row, mut left) = (header.row_bytes, header.points as usize);
        let columns = header.columns(|kept| (kept.offset, row));
        let mut growing = Growing::new(columns, left, ByteOrder::Little, cloud);
        while left > 0 {
            let body = &self.piece[self.start..self.filled];
            let rows = (body.len() / row).min(left);
            growing.append(body, rows);
            (self.start, left) = (self.start + rows * row, left - rows);
            if left > 0 && !self.advance()? {
                // The file has become shorter since its length was asked for.
                let (points, expected) = (header.points, u128::from(header.points) * row as u128);
                let found = (points as usize - left) * row;
                return Ok(Err(PcdError::TooShort { expected, points, found }));
            }
        }
        growing.finish();
        Ok(Ok(()))
    }

    /// Moves what is left of the piece to its start and reads on; false at the end of the file.
    fn advance(&mut self) -> std::io::Result<bool> {
        self.piece.copy_within(self.start..self.filled, 0);
        let kept = self.filled - self.start;
        let read = read_full(&mut self.file, &mut self.piece[kept..])?;
        (self.start, self.filled) = (0, kept + read);
        Ok(read > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::Reader;
    use crate::cloud::pcd::{parse, write};

    fn cloud(points: usize) -> PointCloud {
        let column = |offset: f32| (0..points).map(|i| i as f32 + offset).collect::<Vec<_>>();
        let (x, y, z, intensity) = (column(0.0), column(0.25), column(0.5), column(0.75));
        PointCloud { sensor: "s".into(), x, y, z, intensity, skipped: 0 }
    }

    #[test]
    fn a_file_read_in_pieces_is_the_cloud_of_its_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cloud.pcd");
        let mut reader = Reader::default();
        for points in [0, 1, PIECE / 16 - 20, PIECE / 16, 3 * PIECE / 16 + 5] {
            let mut whole = cloud(points);
            for encoding in [Encoding::Ascii, Encoding::Binary, Encoding::BinaryCompressed] {
                let bytes = write(&whole, encoding);
                std::fs::write(&path, &bytes).unwrap();
                assert_eq!(
                    Reader::default().read(&path, "s", Fields::All).unwrap(),
                    parse(&bytes, "s").unwrap()
                );
                let positions = PointCloud { intensity: Vec::new(), ..whole.clone() };
                assert_eq!(
                    reader.read(&path, "s", Fields::Positions).unwrap(),
                    positions,
                    "{encoding:?}"
                );
            }
            // A point without a place, in whatever piece it is.
            whole.y.iter_mut().last().into_iter().for_each(|y| *y = f32::NAN);
            std::fs::write(&path, write(&whole, Encoding::Binary)).unwrap();
            let found = Reader::default().read(&path, "s", Fields::All).unwrap();
            assert_eq!((found.len(), found.skipped), (points.saturating_sub(1), points.min(1)));
        }
    }

    #[test]
    fn a_file_that_breaks_off_says_the_same_in_pieces() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cloud.pcd");
        for encoding in [Encoding::Binary, Encoding::BinaryCompressed] {
            let bytes = write(&cloud(9000), encoding);
            for length in [0, 10, 150, 400, PIECE, bytes.len() - 1] {
                std::fs::write(&path, &bytes[..length.min(bytes.len() - 1)]).unwrap();
                let Err(Error::Cloud { source, .. }) =
                    Reader::default().read(&path, "s", Fields::All)
                else {
                    unreachable!("{encoding:?} of {length} bytes")
                };
                let expected = parse(&bytes[..length.min(bytes.len() - 1)], "s").unwrap_err();
                assert_eq!(source.to_string(), expected.to_string());
            }
        }
    }
}
