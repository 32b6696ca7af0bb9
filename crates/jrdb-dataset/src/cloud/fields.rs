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
pub(super) fn filled<E>(
    sensor: &str,
    fill: impl FnOnce(&mut PointCloud) -> Result<(), E>,
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
