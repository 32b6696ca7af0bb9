//! Reading files of any format.

use std::path::Path;

use jrdb_types::PointCloud;

use super::bin::{self, CloudColumns};
use super::buffers::Buffers;
use super::columns::empty;
use super::error::CloudError;
use super::fields::{Fields, Notes, filled};
use super::format::Format;
use super::pcd;
use crate::{Error, file};

/// Reads a file as the sweep of a sensor, in the format that its name stands for.
///
/// # Errors
/// Those of [`Reader::read`].
pub fn read(path: &Path, sensor: &str, fields: Fields) -> Result<PointCloud, Error> {
    Reader::default().read(path, sensor, fields)
}

/// Reads files one after the other and uses its memory again: what a stream of frames wants.
///
/// ```
/// use jrdb_dataset::cloud::{Fields, Reader};
/// use jrdb_types::PointCloud;
///
/// # fn main() -> Result<(), jrdb_dataset::Error> {
/// # let folder = std::env::temp_dir().join(format!("jrdb-dataset-stream-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder).unwrap();
/// # std::fs::write(folder.join("000000.bin"), [0; 32]).unwrap();
/// # std::fs::write(folder.join("000001.bin"), [0; 16]).unwrap();
/// let (mut reader, mut sweep) = (Reader::default(), PointCloud::default());
/// for (frame, points) in [("000000.bin", 2), ("000001.bin", 1)] {
///     reader.read_into(&folder.join(frame), "velodyne", Fields::Positions, &mut sweep)?;
///     assert_eq!(sweep.len(), points);
/// }
/// # std::fs::remove_dir_all(&folder).ok();
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Default)]
pub struct Reader {
    buffers: Buffers,
    columns: Option<CloudColumns>,
    notes: Notes,
}

impl Reader {
    /// A reader that takes the points of every `.bin` and `.pcd.bin` to have these columns.
    #[must_use]
    pub fn with_columns(columns: CloudColumns) -> Self {
        Self { columns: Some(columns), ..Self::default() }
    }

    /// What is odd about the file that was read last, and was used all the same; sentences without the file's name.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// [`read`].
    ///
    /// # Errors
    /// [`Error::Content`] for a name of no known format, [`Error::Read`] or [`Error::Cloud`].
    pub fn read(&mut self, path: &Path, sensor: &str, fields: Fields) -> Result<PointCloud, Error> {
        filled(sensor, |cloud| self.read_into(path, sensor, fields, cloud))
    }

    /// [`Reader::read`] into a cloud whose memory is used again; what it held before is lost. Binary and compressed
    /// PCD and `.bin` take no new memory for the points of a sweep no larger than those before.
    ///
    /// # Errors
    /// Those of [`Reader::read`]. The cloud then has no points and can be read into again.
    pub fn read_into(
        &mut self,
        path: &Path,
        sensor: &str,
        fields: Fields,
        cloud: &mut PointCloud,
    ) -> Result<(), Error> {
        sensor.clone_into(&mut cloud.sensor);
        self.notes.clear();
        match self.fill(path, fields, cloud) {
            Ok(notes) => self.notes = notes,
            Err(error) => {
                empty(cloud);
                return Err(error);
            }
        }
        Ok(())
    }

    /// Reads a file into a cloud, whatever it held.
    fn fill(
        &mut self,
        path: &Path,
        fields: Fields,
        cloud: &mut PointCloud,
    ) -> Result<Notes, Error> {
        let format = Format::of(path).ok_or_else(|| {
            let name = path.file_name().unwrap_or_default();
            Error::content(path, "a .pcd, .bin, .pcd.bin, .npy or .ply file", format!("{name:?}"))
        })?;
        if format == Format::Pcd {
            return pcd::read(path, fields, &mut self.buffers, cloud);
        }
        let Buffers { bytes, block } = &mut self.buffers;
        file::read_into(path, bytes)?;
        let filled = match (format, &self.columns) {
            (Format::Bin(_), Some(columns)) => {
                bin::fill_stated(bytes, columns, fields, cloud).map_err(CloudError::from)
            }
            _ => format.fill(bytes, fields, block, cloud),
        };
        filled.map_err(|source| Error::Cloud { path: path.into(), source })
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use pcd::{Encoding, write};

    /// Makes a file of a cloud.
    type WriteCloud = fn(&PointCloud) -> Vec<u8>;

    const SENSOR: &str = "upper_velodyne";

    /// A property of PLY that makes points unequally long.
    const LISTS: &str = "property list uchar int tags\n";

    fn cloud(points: usize) -> PointCloud {
        let [x, y, z, intensity] =
            [0.0, 0.25, 0.5, 0.75].map(|offset| (0..points).map(|i| i as f32 + offset).collect());
        PointCloud { sensor: SENSOR.into(), x, y, z, intensity, skipped: 0 }
    }

    /// A cloud with points that have no place, the last among them.
    fn with_gaps(points: usize) -> PointCloud {
        let mut cloud = cloud(points);
        (cloud.x[points / 2], cloud.y[points - 1]) = (f32::NAN, f32::INFINITY);
        cloud
    }

    /// Rows of a cloud's four numbers, each row with `more` zeros behind it.
    fn rows(PointCloud { x, y, z, intensity, .. }: &PointCloud, more: usize) -> Vec<u8> {
        let row = |i| [&[x[i], y[i], z[i], intensity[i]][..], &vec![0.0; more]].concat();
        (0..x.len()).flat_map(row).flat_map(f32::to_le_bytes).collect()
    }

    fn npy(cloud: &PointCloud) -> Vec<u8> {
        let shape = format!("({}, 4)", cloud.len());
        let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}\n");
        let length = (header.len() as u16).to_le_bytes();
        [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), &rows(cloud, 0)].concat()
    }

    fn ply(format: &str, points: usize, more: &str, body: &[u8]) -> Vec<u8> {
        let header = format!(
            "ply\nformat {format} 1.0\nelement vertex {points}\nproperty float x\nproperty float y\n\
             property float z\nproperty float intensity\n{more}end_header\n"
        );
        [header.as_bytes(), body].concat()
    }

    /// Files of every format and way through its reader, long and short in turn.
    fn whole_files() -> Vec<(&'static str, Vec<u8>)> {
        let bare = PointCloud { intensity: Vec::new(), ..cloud(11) };
        let with_lists: Vec<u8> =
            rows(&with_gaps(6), 0).chunks(16).flat_map(|row| [row, &[0]].concat()).collect();
        vec![
            ("compressed.pcd", write(&cloud(40), Encoding::BinaryCompressed)),
            ("binary.pcd", write(&cloud(9), Encoding::Binary)),
            ("pieces.pcd", write(&with_gaps(9000), Encoding::Binary)),
            ("ascii.pcd", write(&with_gaps(5), Encoding::Ascii)),
            ("bare.pcd", write(&bare, Encoding::BinaryCompressed)),
            ("nothing.pcd", write(&cloud(0), Encoding::Binary)),
            ("kitti.bin", rows(&with_gaps(20), 0)),
            ("nuscenes.pcd.bin", rows(&cloud(4), 1)),
            ("array.npy", npy(&with_gaps(17))),
            ("ascii.ply", ply("ascii", 2, "", b"1 2 3 4\nnan 6 7 8\n")),
            ("table.ply", ply("binary_little_endian", 13, "", &rows(&with_gaps(13), 0))),
            ("lists.ply", ply("binary_little_endian", 6, LISTS, &with_lists)),
        ]
    }

    /// Files that are found wrong, most of them after some of their points are read; the last has no known name.
    fn broken_files() -> Vec<(&'static str, Vec<u8>)> {
        let cut = |mut bytes: Vec<u8>| {
            bytes.truncate(bytes.len() - 3);
            bytes
        };
        vec![
            ("cut_compressed.pcd", cut(write(&cloud(30), Encoding::BinaryCompressed))),
            ("cut_binary.pcd", cut(write(&cloud(30), Encoding::Binary))),
            ("cut_ascii.pcd", cut(write(&cloud(30), Encoding::Ascii))),
            ("cut.bin", cut(rows(&cloud(3), 0))),
            ("cut.npy", cut(npy(&cloud(3)))),
            ("cut_ascii.ply", ply("ascii", 3, "", b"1 2 3 4\n5 6 7 8\n")),
            ("cut_lists.ply", ply("binary_little_endian", 1, LISTS, &rows(&cloud(1), 0))),
            ("cloud.las", Vec::new()),
        ]
    }

    #[test]
    fn a_cloud_that_is_read_into_again_is_the_one_read_afresh() {
        let folder = tempfile::tempdir().unwrap();
        let (whole, broken) = (whole_files(), broken_files());
        for (name, bytes) in whole.iter().chain(&broken) {
            fs::write(folder.path().join(name), bytes).unwrap();
        }
        let mut names: Vec<&str> = whole.iter().chain(&broken).map(|(name, _)| *name).collect();
        names.push("absent.pcd");
        let (mut reader, mut cloud) = (Reader::default(), PointCloud::default());
        let mut check = |name: &str, fields| {
            let path = folder.path().join(name);
            let again = reader.read_into(&path, SENSOR, fields, &mut cloud);
            match read(&path, SENSOR, fields) {
                Ok(fresh) => {
                    again.unwrap();
                    assert_eq!(cloud, fresh, "{name}");
                    let bytes = fs::read(&path).unwrap();
                    let parsed = Format::of(&path).unwrap().parse(&bytes, SENSOR).unwrap();
                    assert_eq!((&cloud.x, cloud.skipped), (&parsed.x, parsed.skipped), "{name}");
                    let kept = if fields == Fields::All { &parsed.intensity[..] } else { &[] };
                    assert_eq!(cloud.intensity, kept, "{name}");
                }
                Err(error) => {
                    assert!(!whole.iter().any(|(whole, _)| *whole == name), "{name}: {error:?}");
                    assert_eq!(format!("{:?}", again.unwrap_err()), format!("{error:?}"));
                    let none = PointCloud { sensor: SENSOR.into(), ..PointCloud::default() };
                    assert_eq!(cloud, none, "{name}");
                }
            }
        };
        // Every file after every other, and after itself.
        for first in &names {
            for second in &names {
                check(first, Fields::All);
                check(second, Fields::Positions);
                check(second, Fields::All);
            }
        }
    }

    #[test]
    fn a_sweep_no_larger_than_one_before_takes_no_new_memory() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name| folder.path().join(name);
        let files: [(&str, WriteCloud); 3] = [
            ("a.pcd", |cloud| write(cloud, Encoding::Binary)),
            ("b.pcd", |cloud| write(cloud, Encoding::BinaryCompressed)),
            ("c.bin", |cloud| rows(cloud, 0)),
        ];
        for (name, bytes) in files {
            let (mut reader, mut cloud) = (Reader::default(), PointCloud::default());
            let mut memory_after = |sweep: PointCloud| {
                fs::write(path(name), bytes(&sweep)).unwrap();
                reader.read_into(&path(name), SENSOR, Fields::All, &mut cloud).unwrap();
                let columns =
                    crate::cloud::columns::numbers(&mut cloud).map(|c| (c.as_ptr(), c.capacity()));
                let buffers = [&reader.buffers.bytes, &reader.buffers.block]
                    .map(|b| (b.as_ptr(), b.capacity()));
                (columns, buffers)
            };
            let first = memory_after(with_gaps(9000));
            assert_eq!(memory_after(self::cloud(10)), first, "{name}");
            assert_eq!(memory_after(with_gaps(9000)), first, "{name}");
        }
    }
}
