//! Reading and writing whole files, with errors that name them.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

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

/// Writes a file and the folders above it.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let folders = path.parent().map_or(Ok(()), fs::create_dir_all);
    folders
        .and_then(|()| fs::write(path, bytes))
        .map_err(|source| Error::Write { path: path.into(), source })
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

/// The frame number of a file or frame key: its integer stem, `images/000012.jpg` → 12, or that behind the name of a camera or
/// a sequence, `frame000012.jpg`, `cafe_0_000012.jpg` → 12.
pub(crate) fn frame_number(name: &str) -> Option<u32> {
    stem_number(Path::new(name).file_stem()?.to_str()?)
}

/// The frame number that a name without its ending stands for.
pub(crate) fn stem_number(stem: &str) -> Option<u32> {
    number(stem).or_else(|| {
        let prefix = stem.trim_end_matches(|c: char| c.is_ascii_digit());
        let digits = &stem[prefix.len()..];
        let is_name = prefix.ends_with(['_', '-']) || prefix.chars().all(char::is_alphabetic);
        let is_number = digits.len() >= MIN_DIGITS && is_name && !prefix.contains('.');
        is_number.then(|| number(digits)).flatten()
    })
}

/// Fewest digits of a number behind a name: with fewer it may be a part of the name, as in `camera_2`.
const MIN_DIGITS: usize = 4;

/// A file's ending in small letters; empty where it has none.
pub(crate) fn extension(path: &Path) -> String {
    path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_lowercase()
}

/// The file of this name in a folder, in whatever case its name is written; the name as it is when there is none.
pub(crate) fn named(folder: &Path, name: &str) -> PathBuf {
    let usual = folder.join(name);
    if usual.is_file() {
        return usual;
    }
    let is_it = |path: &PathBuf| {
        let found = path.file_name().and_then(|found| found.to_str());
        found.is_some_and(|found| found.eq_ignore_ascii_case(name)) && path.is_file()
    };
    list(folder).ok().and_then(|files| files.into_iter().find(is_it)).unwrap_or(usual)
}

/// The number that digits, and nothing but digits, stand for.
pub(crate) fn number(stem: &str) -> Option<u32> {
    stem.bytes().all(|b| b.is_ascii_digit()).then(|| stem.parse().ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_numbers_are_integer_stems() {
        assert_eq!(frame_number("000012.jpg"), Some(12));
        assert_eq!(frame_number("image_stitched/cafe_0/000000.pcd"), Some(0));
        assert_eq!(frame_number("7"), Some(7));
        assert_eq!(frame_number("frame000012.png"), Some(12));
        assert_eq!(frame_number("cafe_0_000012.png"), Some(12));
        for odd in ["camera_2.jpg", "1550012345.123456789.jpg", "000012_jpg.rf.ab0012.jpg"] {
            assert_eq!(frame_number(odd), None, "{odd}");
        }
        for odd in ["", "+1.jpg", "cover.jpg", "99999999999.jpg", "..", "12a.png"] {
            assert_eq!(frame_number(odd), None, "{odd}");
        }
    }
}
