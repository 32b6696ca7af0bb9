//! Names of a frame's files, and what to say when there is none.

use std::path::{Path, PathBuf};

use crate::{Error, file};

/// Endings of stitched images.
pub(crate) const IMAGE_EXTENSIONS: [&str; 3] = ["jpg", "jpeg", "png"];
/// Endings of sweeps.
pub(crate) const CLOUD_EXTENSIONS: [&str; 5] = ["pcd", "bin", "npy", "ply", "pcd.bin"];
/// Endings of files that hold points, too, but are not read, with what to do.
const OTHER_CLOUDS: [(&str, &str); 3] = [
    ("npz", "save the array alone, with numpy.save"),
    ("las", "convert it to .pcd or .ply"),
    ("laz", "convert it to .pcd or .ply"),
];

/// The name before its extension, which may have a dot of its own, if it is one of these in any case.
pub(crate) fn stem<'a>(path: &'a Path, extensions: &[&str]) -> Option<&'a str> {
    let name = path.file_name()?.to_str()?;
    let stem = |extension: &&str| {
        let (stem, ending) = name.split_at_checked(name.len().checked_sub(extension.len())?)?;
        stem.strip_suffix('.').filter(|_| ending.eq_ignore_ascii_case(extension))
    };
    extensions.iter().filter_map(stem).min_by_key(|stem| stem.len())
}

fn frame_of(path: &Path, extensions: &[&str]) -> Option<u32> {
    file::stem_number(stem(path, extensions)?)
}

/// The frame numbers of a folder's files of a kind.
pub(crate) fn numbered(folder: &Path, extensions: &[&str]) -> Result<Vec<u32>, Error> {
    let files = file::list(folder)?;
    Ok(files.iter().filter_map(|path| frame_of(path, extensions)).collect())
}

/// A file of the kind whose name is not a frame's number.
pub(crate) fn unnumbered(folder: &Path, extensions: &[&str]) -> Option<String> {
    let files = file::list(folder).ok()?;
    let is_odd = |path: &&PathBuf| {
        stem(path, extensions).is_some_and(|stem| !stem.starts_with('.'))
            && frame_of(path, extensions).is_none()
    };
    let odd = files.iter().find(is_odd)?;
    Some(odd.file_name()?.to_string_lossy().into_owned())
}

/// A frame's file: six digits as in JRDB, else any file whose integer stem is the frame's number, else one whose number stands
/// behind a name.
pub(crate) fn find(folder: &Path, frame: u32, extensions: &[&str]) -> Option<PathBuf> {
    let usual = extensions.iter().map(|extension| folder.join(format!("{frame:06}.{extension}")));
    usual.into_iter().find(|path| path.is_file()).or_else(|| {
        let mut files = file::list(folder).ok()?;
        files.retain(|path| path.is_file()); // a pipe would never end
        let is_bare =
            |path: &&PathBuf| stem(path, extensions).and_then(file::number) == Some(frame);
        let is_it = |path: &&PathBuf| frame_of(path, extensions) == Some(frame);
        files.iter().find(is_bare).or_else(|| files.iter().find(is_it)).cloned()
    })
}

/// The name that a frame's absent sweep should have, with the ending of its neighbours, and what is there instead.
pub(crate) fn absent_sweep(folder: &Path, frame: u32) -> (PathBuf, String) {
    let mut files = file::list(folder).unwrap_or_default();
    files.retain(|path| path.is_file());
    let known: Vec<&PathBuf> =
        files.iter().filter(|path| stem(path, &CLOUD_EXTENSIONS).is_some()).collect();
    let distance = |path: &&&PathBuf| {
        frame_of(path, &CLOUD_EXTENSIONS).map_or(u32::MAX, |number| number.abs_diff(frame))
    };
    if let Some((path, why)) = files.iter().find_map(|path| other_cloud(path, frame)) {
        return (path, why);
    }
    let Some(nearest) = known.iter().min_by_key(distance) else {
        return (folder.join(format!("{frame:06}.pcd")), "no such file".into());
    };
    let name = nearest.file_name().unwrap_or_default().to_string_lossy();
    let stem = stem(nearest, &CLOUD_EXTENSIONS).unwrap_or_default();
    let ending = name.get(stem.len()..).unwrap_or_default();
    let others = match known.len() - 1 {
        0 => String::new(),
        count => format!(" and {count} more"),
    };
    let why = format!("no such file; the folder holds {name:?}{others}");
    (folder.join(format!("{frame:06}{ending}")), why)
}

/// A frame's file in a format that is not read.
fn other_cloud(path: &Path, frame: u32) -> Option<(PathBuf, String)> {
    let found = |(extension, what): &(&str, &str)| {
        let is_it = frame_of(path, &[extension]) == Some(frame);
        is_it.then(|| (path.to_path_buf(), format!(".{extension} files are not read: {what}")))
    };
    OTHER_CLOUDS.iter().find_map(found)
}

/// The names most like one that is not there, the most alike first; all of them when none is alike.
pub(crate) fn near<'a>(name: &str, known: &'a [String]) -> Vec<&'a str> {
    const MOST: usize = 8;
    let lower = name.to_lowercase();
    let distance = |known: &str| {
        let known = known.to_lowercase();
        let contains = known.contains(&lower) || lower.contains(&known);
        if contains { 0 } else { edits(&lower, &known) }
    };
    let mut alike: Vec<(usize, &str)> = known.iter().map(|k| (distance(k), k.as_str())).collect();
    alike.sort();
    let is_alike = |(distance, _): &(usize, &str)| *distance <= name.len().div_ceil(3);
    let count = alike.iter().filter(|one| is_alike(one)).count();
    let shown = if count == 0 { MOST } else { count.min(MOST) };
    alike.into_iter().take(shown).map(|(_, known)| known).collect()
}

/// Levenshtein's distance: letters to insert, delete or replace.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != *to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_may_be_written_in_any_case() {
        let stem = |name| stem(Path::new(name), &CLOUD_EXTENSIONS).map(String::from);
        assert_eq!(stem("000012.PCD").as_deref(), Some("000012"));
        assert_eq!(stem("a.Pcd.Bin").as_deref(), Some("a"));
        assert_eq!((stem("000012.las"), stem("é")), (None, None));
    }

    #[test]
    fn the_most_alike_names_come_first() {
        let known = ["plaza_0", "plaza_1", "cafe_0"].map(String::from);
        assert_eq!(near("plaza", &known), ["plaza_0", "plaza_1"]);
        assert_eq!(near("caffe_0", &known), ["cafe_0"]);
        assert_eq!(near("street", &known).len(), 3);
        assert_eq!((edits("", "ab"), edits("kitten", "sitting")), (2, 3));
    }

    #[test]
    fn an_absent_sweep_has_the_ending_of_its_neighbours() {
        let folder = tempfile::tempdir().unwrap();
        let absent = |frame| {
            let (path, why) = absent_sweep(folder.path(), frame);
            (path.file_name().unwrap().to_string_lossy().into_owned(), why)
        };
        assert_eq!(absent(3), ("000003.pcd".into(), "no such file".into()));
        for name in ["1712345678.123.npy", "notes.txt", "000009.NPZ"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let why = r#"no such file; the folder holds "1712345678.123.npy""#;
        assert_eq!(absent(3), ("000003.npy".into(), why.into()));
        assert!(absent(9).1.contains("numpy.save"));
    }
}
