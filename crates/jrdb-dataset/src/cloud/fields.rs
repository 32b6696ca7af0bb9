//! What is read of a cloud, and what the formats share.

use jrdb_types::PointCloud;

/// What is read of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fields {
    /// Its position; what a file says beyond the last coordinate of the last point is not looked at.
    Positions,
    /// Its position, and its intensity where the file has one.
    All,
}

/// The cloud of a sensor, without points until it is filled.
pub(super) fn filled<T, E>(
    sensor: &str,
    fill: impl FnOnce(&mut PointCloud) -> Result<T, E>,
) -> Result<PointCloud, E> {
    let mut cloud = PointCloud { sensor: sensor.into(), ..PointCloud::default() };
    fill(&mut cloud)?;
    Ok(cloud)
}

/// The start of a text, short enough for a message.
pub(super) fn excerpt(text: &str) -> String {
    const MAX_CHARS: usize = 80;
    text.chars().take(MAX_CHARS).collect()
}

/// What is odd about a file that was used all the same, each a sentence without the file's name.
pub(super) type Notes = Vec<String>;

/// The bytes behind a byte order mark, which editors put before text.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// The note on coordinates without parts.
pub(super) fn whole_coordinates(kind: &str) -> String {
    format!(
        "the coordinates are whole numbers ({kind}), taken as metres: places are only good to a metre"
    )
}

/// Smallest part of the stated points with which an ASCII cloud is used: a filter dropped some, the file is not cut.
const MIN_PART: f64 = 0.9;

/// The note on a file with another number of points than it states; none where so many are absent that the file was cut.
pub(super) fn other_count(stated: u64, found: u64) -> Option<String> {
    let is_enough = found as f64 >= MIN_PART * stated as f64;
    is_enough.then(|| format!("expected {stated} points as stated, found {found}, which are used"))
}
