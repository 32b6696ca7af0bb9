//! One frame's labels, to be written.

use std::collections::BTreeMap;

use jrdb_types::{Detections, EntityId, FrameId};

/// The labels of one frame, to be written.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelledFrame {
    /// Who is where. Ids and boxes are written as they are; of a belief the most probable value.
    pub detections: Detections,
    /// LiDAR points in each 3D box; 0 where an id is absent.
    pub num_points: BTreeMap<EntityId, usize>,
}

/// The name of a frame's file.
pub(super) fn file_name(frame: &FrameId, extension: &str) -> String {
    format!("{:06}.{extension}", frame.frame)
}
