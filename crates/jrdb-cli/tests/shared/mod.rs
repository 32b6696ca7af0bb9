//! Where the research data for conformance tests is.

use std::collections::BTreeMap;
use std::path::PathBuf;

/// A file or folder of the shared data, or `None` (said aloud) where there is none.
pub(crate) fn shared(path: &str) -> Option<PathBuf> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");
    let root =
        std::env::var_os("JRDB_SHARED").map_or_else(|| PathBuf::from(default), PathBuf::from);
    let path = root.join(path);
    if !path.exists() {
        println!("skipped: no shared data");
        return None;
    }
    Some(path)
}

/// Rows of a comma-separated file with a header, by column name. Fields hold no commas.
#[allow(dead_code, reason = "not every test file reads tables")]
pub(crate) fn table(path: &str) -> Option<Vec<BTreeMap<String, String>>> {
    let text = std::fs::read_to_string(shared(path)?).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row = |line: &str| {
        names.iter().map(ToString::to_string).zip(line.split(',').map(String::from)).collect()
    };
    Some(lines.map(row).collect())
}
