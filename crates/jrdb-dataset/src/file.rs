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

/// A file's text: UTF-8 or UTF-16, with a byte order mark or without.
pub(crate) fn read_text(path: &Path) -> Result<String, Error> {
    decoded(read(path)?).map_err(|source| Error::Read { path: path.into(), source })
}

fn decoded(mut bytes: Vec<u8>) -> std::io::Result<String> {
    let invalid = |what: String| std::io::Error::new(std::io::ErrorKind::InvalidData, what);
    // Every text here starts with a sign of ASCII: UTF-16 has a zero beside it.
    let from_pair: Option<fn([u8; 2]) -> u16> = match bytes[..] {
        [0xff, 0xfe, ..] => Some(u16::from_le_bytes),
        [0xfe, 0xff, ..] => Some(u16::from_be_bytes),
        [first, 0, ..] if first != 0 => Some(u16::from_le_bytes),
        [0, second, ..] if second != 0 => Some(u16::from_be_bytes),
        _ => None,
    };
    if let Some(from_pair) = from_pair {
        let units: Vec<u16> = bytes.as_chunks().0.iter().map(|pair| from_pair(*pair)).collect();
        let text = String::from_utf16(&units).map_err(|_| invalid("expected UTF-16".into()))?;
        return Ok(text.trim_start_matches('\u{feff}').into());
    }
    if bytes.starts_with(b"\xef\xbb\xbf") {
        bytes.drain(..3);
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        invalid(format!("expected UTF-8 or UTF-16 text, found another encoding from byte {at} on"))
    })
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

/// Most digits of a frame's number: with more, digits are a time.
const MAX_DIGITS: usize = 9;

/// The frame number that digits, and nothing but digits, stand for.
pub(crate) fn number(stem: &str) -> Option<u32> {
    let is_time = stem.trim_start_matches('0').len() > MAX_DIGITS;
    let are_digits = stem.bytes().all(|b| b.is_ascii_digit());
    (are_digits && !is_time).then(|| stem.parse().ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_windows_are_decoded() {
        let text = "{\"é\": 1}";
        let wide = |bytes: fn(u16) -> [u8; 2], text: &str| -> Vec<u8> {
            text.encode_utf16().flat_map(bytes).collect()
        };
        let marked = format!("\u{feff}{text}");
        for bytes in [
            text.as_bytes().to_vec(),
            marked.as_bytes().to_vec(),
            wide(u16::to_le_bytes, &marked),
            wide(u16::to_be_bytes, &marked),
            wide(u16::to_le_bytes, text),
            wide(u16::to_be_bytes, text),
        ] {
            assert_eq!(decoded(bytes).unwrap(), text);
        }
        let error = decoded(b"caf\xe9".to_vec()).unwrap_err().to_string();
        assert_eq!(error, "expected UTF-8 or UTF-16 text, found another encoding from byte 3 on");
        assert_eq!(decoded(Vec::new()).unwrap(), "");
    }

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
        assert_eq!(frame_number("frame000012.png"), Some(12));
        assert_eq!(frame_number("cafe_0_000012.png"), Some(12));
        for odd in [
            "camera_2.jpg",
            "1550012345.123456789.jpg",
            "1550012345.jpg",
            "000012_jpg.rf.ab0012.jpg",
        ] {
            assert_eq!(frame_number(odd), None, "{odd}");
        }
        for odd in ["", "+1.jpg", "cover.jpg", "99999999999.jpg", "..", "12a.png"] {
            assert_eq!(frame_number(odd), None, "{odd}");
        }
    }
}
