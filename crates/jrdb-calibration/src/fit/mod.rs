//! Does a cloud fit an image, and if not, by how much?
//!
//! Where a LiDAR sees a near thing end before a far one, the image should have an edge. Between neighbouring
//! beams of one column such an end fixes a row, and so the height; between neighbours of one ring it fixes a
//! column, and so the yaw.

mod candidate;
mod check;
mod config;
mod evidence;
mod gradient;
mod motion;
mod refine;
mod rings;
mod score;
mod verdict;
#[cfg(test)]
mod world;

use jrdb_projection::CameraModel;
use jrdb_types::Image;
use nalgebra::Point3;

pub use check::check_fit;
pub use config::FitConfig;
pub use motion::about;
pub use refine::refine;

/// One sweep of a LiDAR in the robot's base frame (x forward, y left, z up), metres.
#[derive(Debug, Clone, Copy)]
pub struct Sweep<'a> {
    /// Name of the LiDAR; sweeps of one name in several views are one LiDAR.
    pub sensor: &'a str,
    /// Where the LiDAR's beams start, base frame.
    pub origin: Point3<f64>,
    /// The points, base frame.
    pub points: &'a [Point3<f64>],
}

/// An image and the sweeps taken at the same time.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// Where points of the base frame fall in the image.
    pub camera: &'a dyn CameraModel,
    /// The image.
    pub image: &'a Image,
    /// The sweeps.
    pub sweeps: &'a [Sweep<'a>],
}
