//! Why a floor could not be found, or cloud and image not compared.

use nalgebra::Point3;

/// Why a cloud has no floor that could be trusted, or could not be held against an image.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A threshold is out of its range.
    #[error("expected {field} to be {expected}, found {found}")]
    BadConfig {
        /// Field of [`crate::FloorConfig`] or [`crate::FitConfig`].
        field: &'static str,
        /// What it should be.
        expected: &'static str,
        /// What it is.
        found: String,
    },
    /// A point has a coordinate that is infinite or not a number.
    #[error("expected finite coordinates, found {found} at index {index}")]
    NonFinite {
        /// Place in the list of points, from 0; the first such point.
        index: usize,
        /// The point.
        found: Point3<f64>,
    },
    /// Hardly any point lies around the robot.
    #[error("expected at least {expected} points within {range_m} m of the robot, found {found}")]
    TooFewPoints {
        /// [`crate::FloorConfig::min_inliers`].
        expected: usize,
        /// Points that lie near enough.
        found: usize,
        /// [`crate::FloorConfig::range_m`].
        range_m: f64,
    },
    /// No plane of the tilts and heights allowed has enough points.
    #[error("expected a floor of at least {expected} points, found a best plane of {found}")]
    NoFloor {
        /// [`crate::FloorConfig::min_inliers`].
        expected: usize,
        /// Points on the lowest plane of any strength.
        found: usize,
    },
    /// The points lie along a line, as on a ledge: they fix no tilt.
    #[error(
        "expected floor points that spread at least {expected_m} m both ways, found {found_m:.3} m"
    )]
    TooNarrow {
        /// [`crate::FloorConfig::min_spread_m`].
        expected_m: f64,
        /// Standard deviation along the narrower direction, metres.
        found_m: f64,
    },
    /// The plane is a ramp or a wall, or the cloud is not in the base frame.
    #[error(
        "expected a floor tilted by at most {:.2} degrees, found {:.2} degrees",
        expected_rad.to_degrees(),
        found_rad.to_degrees()
    )]
    TooTilted {
        /// [`crate::FloorConfig::max_tilt_rad`].
        expected_rad: f64,
        /// Angle between the plane's normal and the z axis, radians.
        found_rad: f64,
    },
    /// The points fill the slab around the plane: they are clutter, not a surface.
    #[error("expected floor points within {expected_m} m rms of their plane, found {found_m:.3} m")]
    NotFlat {
        /// [`crate::FloorConfig::max_rms_m`].
        expected_m: f64,
        /// Root mean square distance from the plane, metres.
        found_m: f64,
    },
    /// An image is not of the camera it is said to be of.
    #[error("expected an image of {expected:?} pixels, found {found:?} in {bytes} bytes")]
    ImageSize {
        /// Columns and rows of the camera.
        expected: [usize; 2],
        /// Columns and rows of the image.
        found: [usize; 2],
        /// Bytes of the image, three for each pixel.
        bytes: usize,
    },
    /// There is no cloud to hold against the image.
    #[error("expected a sweep of at least one LiDAR, found none")]
    NoSweep,
    /// A sweep cannot be held against the image.
    #[error("cannot use the sweep of {sensor:?}")]
    Sweep {
        /// Name of the LiDAR.
        sensor: String,
        /// Why.
        #[source]
        source: Box<Error>,
    },
    /// One of several clouds has no floor.
    #[error("no floor in the cloud of {sensor:?}")]
    Sensor {
        /// Name of the LiDAR.
        sensor: String,
        /// Why.
        #[source]
        source: Box<Error>,
    },
}
