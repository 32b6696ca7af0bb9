//! Files that are named by the time at which they were recorded.

use std::path::{Path, PathBuf};

use crate::file;
use crate::names::stem;

/// Farthest that a sweep may be from its picture in time, nanoseconds: a turn of a LiDAR of 10 Hz.
const MAX_APART_NS: u64 = 100_000_000;

/// The files of a sequence in the order of time; their places in it are the frames' numbers.
pub(crate) struct Timeline {
    files: Vec<(u64, PathBuf)>,
}

impl Timeline {
    /// The files of a kind in a folder, if there are any, all are named by times, and no two by the same.
    pub(crate) fn of(folder: &Path, extensions: &[&str]) -> Option<Self> {
        let paths = file::list(folder).ok()?.into_iter().filter(|path| path.is_file());
        let named = paths.filter_map(|path| {
            let stem = stem(&path, extensions).filter(|stem| !stem.starts_with('.'))?;
            Some((time_ns(stem), path))
        });
        let timed = named.map(|(time, path)| Some((time?, path)));
        let mut files = timed.collect::<Option<Vec<(u64, PathBuf)>>>()?;
        files.sort();
        let differ = files.windows(2).all(|pair| pair[0].0 != pair[1].0);
        (differ && !files.is_empty()).then_some(Self { files })
    }

    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        self.files.len()
    }

    /// A frame's file and its time, nanoseconds.
    pub(crate) fn get(&self, frame: u32) -> Option<(u64, &Path)> {
        let (time_ns, path) = self.files.get(frame as usize)?;
        Some((*time_ns, path))
    }

    /// The file nearest to a time, and how far it is, nanoseconds.
    pub(crate) fn nearest(&self, time_ns: u64) -> Option<(u64, &Path)> {
        let apart_ns = |(time, _): &&(u64, PathBuf)| time.abs_diff(time_ns);
        let nearest = self.files.iter().min_by_key(apart_ns)?;
        Some((apart_ns(&nearest), &nearest.1))
    }

    /// How far a sweep may be from its picture: half of the usual distance of pictures, and a turn of a LiDAR at most.
    pub(crate) fn max_apart_ns(&self) -> u64 {
        let mut gaps: Vec<u64> = self.files.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
        gaps.sort_unstable();
        gaps.get(gaps.len() / 2).map_or(MAX_APART_NS, |gap| (gap / 2).min(MAX_APART_NS))
    }
}

/// The time that a name stands for, nanoseconds: seconds with a fraction (`1550012345.123456789`), seconds and nanoseconds
/// (`1550012345_123456789`), or as many seconds, milli-, micro- or nanoseconds since 1970 as have 10, 13, 16 or 19 digits.
fn time_ns(stem: &str) -> Option<u64> {
    const NS: u64 = 1_000_000_000;
    const MAX_FRACTION: usize = 9;
    let digits = |text: &str| {
        let are_digits = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        are_digits.then(|| text.parse::<u64>().ok()).flatten()
    };
    if let Some((seconds, rest)) = stem.split_once(['.', '_', '-']) {
        let (seconds, part) = (digits(seconds).filter(|_| seconds.len() == 10)?, digits(rest)?);
        let missing = MAX_FRACTION.checked_sub(rest.len())?;
        let is_fraction = stem.contains('.');
        let part = if is_fraction { part * 10_u64.pow(missing as u32) } else { part };
        return seconds.checked_mul(NS)?.checked_add(part);
    }
    let unit = match stem.len() {
        10 => NS,
        13 => NS / 1000,
        16 => 1000,
        19 => 1,
        _ => return None,
    };
    digits(stem)?.checked_mul(unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_ros_and_of_loggers_are_times() {
        let same =
            ["1550012345.5", "1550012345_500000000", "1550012345-500000000", "1550012345500"];
        for stem in same.into_iter().chain(["1550012345500000", "1550012345500000000"]) {
            assert_eq!(time_ns(stem), Some(1_550_012_345_500_000_000), "{stem}");
        }
        for stem in
            ["000012", "1550012345.", "cafe_0", "1550012345.0000000001", "99999999999999999999"]
        {
            assert_eq!(time_ns(stem), None, "{stem}");
        }
    }

    #[test]
    fn files_are_taken_in_the_order_of_time() {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str| std::fs::write(folder.path().join(name), "").unwrap();
        for name in ["1550012345.5.png", "1550012345.25.png", "1550012345.75.png"] {
            put(name);
        }
        let line = Timeline::of(folder.path(), &["png"]).unwrap();
        assert_eq!((line.len(), line.max_apart_ns()), (3, MAX_APART_NS));
        assert!(line.get(0).unwrap().1.ends_with("1550012345.25.png"));
        let (apart, path) = line.nearest(1_550_012_345_510_000_000).unwrap();
        assert!(path.ends_with("1550012345.5.png") && apart == 10_000_000);
        put("000001.png");
        assert!(Timeline::of(folder.path(), &["png"]).is_none(), "one is no time");
    }
}
