//! The classes of the objects of a recording: what its labels can state.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use jrdb_types::EntityId;

use crate::{Error, boxes};

/// The key of an object's id.
const KEY: &str = "\"label_id\"";

/// The categories of all objects in some label files; files that are not there have none.
pub(super) fn of_files(paths: &[PathBuf]) -> Result<BTreeSet<String>, Error> {
    let mut found = BTreeSet::new();
    for path in paths.iter().filter(|path| path.is_file()) {
        let unreadable = |source| Error::Read { path: path.clone(), source };
        found.extend(of_file(path).map_err(unreadable)?);
    }
    Ok(found)
}

/// Looks for the ids alone: between two braces there is at most one.
fn of_file(path: &Path) -> std::io::Result<BTreeSet<String>> {
    let mut bytes = BufReader::new(File::open(path)?);
    let (mut found, mut part) = (BTreeSet::new(), Vec::new());
    while bytes.read_until(b'}', &mut part)? > 0 {
        let text = String::from_utf8_lossy(&part);
        found.extend(text.split(KEY).skip(1).filter_map(category));
        part.clear();
    }
    Ok(found)
}

/// The category of the id that follows the key: `: "table:3", ..`.
fn category(rest: &str) -> Option<String> {
    let id = rest.trim_start().strip_prefix(':')?.trim_start().strip_prefix('"')?;
    let id: EntityId = id.split('"').next()?.parse().ok()?;
    Some(boxes::category(&id))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_class_of_any_frame_is_found() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let text = r#"{"labels": {"000000.jpg": [{"label_id": "pedestrian:1", "box": [1, 2, 3, 4]},
            {"box": [1, 2, 3, 4], "label_id" : "table:2"}], "000007.jpg": [{"label_id":"trash_bin:1"}]}}"#;
        std::fs::write(file.path(), text).unwrap();
        let found = of_files(&[file.path().into(), "/nowhere".into()]).unwrap();
        assert_eq!(found.into_iter().collect::<Vec<_>>(), ["person", "table", "trash_bin"]);
    }
}
