//! Where a thing is, from the LiDAR points in its image box.

pub mod densest_range;
mod mean;

pub use densest_range::densest_range;
pub use mean::mean;

/// A centre found from points.
#[derive(Debug, Clone, PartialEq)]
pub struct Located {
    /// Centre, metres, base frame.
    pub center: nalgebra::Point3<f64>,
    /// Indices into the cloud of the points that the rule used, ascending.
    pub used: Vec<u32>,
}
