//! Reading and writing whole files, with errors that name them.

use std::fs;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use serde::de::DeserializeOwned;

use crate::Error;

pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Error> {
    fs::read(path).map_err(|source| Error::Read { path: path.into(), source })
}

/// [`read`] into bytes whose memory is used again.
pub(crate) fn read_into(path: &Path, bytes: &mut Vec<u8>) -> Result<(), Error> {
    bytes.clear();
    let read = fs::File::open(path).and_then(|mut file| file.read_to_end(bytes));
    read.map(|_| ()).map_err(|source| Error::Read { path: path.into(), source })
}

pub(crate) fn read_text(path: &Path) -> Result<String, Error> {
    fs::read_to_string(path).map_err(|source| Error::Read { path: path.into(), source })
}

pub(crate) fn read_yaml<T: DeserializeOwned>(
    path: &Path,
    expected: &'static str,
) -> Result<T, Error> {
    serde_saphyr::from_str(&read_text(path)?).map_err(|source| Error::Yaml {
        expected,
        path: path.into(),
        source: Box::new(source),
    })
}

pub(crate) fn read_json<T: DeserializeOwned>(
    path: &Path,
    expected: &'static str,
) -> Result<T, Error> {
    serde_json::from_str(&read_text(path)?).map_err(|source| Error::Json {
        expected,
        path: path.into(),
        source,
    })
}

/// Ending of a file that is being written.
pub const PART: &str = ".part";

/// Writes a file and the folders above it, whole or not at all: under another name in the same folder, which ends in
/// [`PART`], and then renamed. A process that is killed may leave that other file.
///
/// # Errors
/// [`Error::Write`], with the final name.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let fail = |source| Error::Write { path: path.into(), source };
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(fail)?;
    }
    let part = part_name(path);
    let written = write_new(&part, bytes).and_then(|()| fs::rename(&part, path));
    written.map_err(|source| {
        let _ = fs::remove_file(&part);
        fail(source)
    })
}

/// Another name in the same folder, which no other process and no other thread uses.
fn part_name(path: &Path) -> PathBuf {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let (process, count) = (std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    path.with_file_name(format!(".{name}.{process}.{count}{PART}"))
}

/// Writes a file that must not exist yet, so that no link is followed, and waits until it is on the disk.
fn write_new(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut file = fs::File::create_new(path)?;
    file.write_all(bytes)?;
    file.sync_data()
}

/// What a folder holds, sorted; nothing when there is no such folder.
pub(crate) fn list(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let read_error = |source| Error::Read { path: folder.into(), source };
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let mut paths = fs::read_dir(folder)
        .map_err(read_error)?
        .map(|entry| entry.map(|entry| entry.path()).map_err(read_error))
        .collect::<Result<Vec<_>, _>>()?;
    paths.sort();
    Ok(paths)
}

/// The frame number of a file or frame key: its integer stem, `images/000012.jpg` → 12.
pub(crate) fn frame_number(name: &str) -> Option<u32> {
    number(Path::new(name).file_stem()?.to_str()?)
}

/// The number that digits, and nothing but digits, stand for.
pub(crate) fn number(stem: &str) -> Option<u32> {
    stem.bytes().all(|b| b.is_ascii_digit()).then(|| stem.parse().ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_and_nothing_else_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b.json");
        write(&path, b"first").unwrap();
        write(&path, b"second").unwrap();
        assert_eq!(read(&path).unwrap(), b"second");
        assert_eq!(list(path.parent().unwrap()).unwrap(), [path]);
    }

    #[test]
    fn a_write_that_fails_leaves_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("taken");
        fs::create_dir(&path).unwrap();
        assert!(matches!(write(&path, b"x"), Err(Error::Write { .. })));
        assert_eq!(list(folder.path()).unwrap(), [path]);
    }

    #[test]
    fn frame_numbers_are_integer_stems() {
        assert_eq!(frame_number("000012.jpg"), Some(12));
        assert_eq!(frame_number("image_stitched/cafe_0/000000.pcd"), Some(0));
        assert_eq!(frame_number("7"), Some(7));
        for odd in ["", "+1.jpg", "cover.jpg", "99999999999.jpg", "..", "12a.png"] {
            assert_eq!(frame_number(odd), None, "{odd}");
        }
    }
}
