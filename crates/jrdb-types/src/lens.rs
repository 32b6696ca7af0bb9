//! How a camera draws: the numbers of every lens model that a rig file can name.
//!
//! Every lens looks along +z of its own frame: x right, y down, z forward. The code that evaluates the
//! formulas, and says which points a lens cannot see, is `jrdb_projection::camera`.

use serde::{Deserialize, Serialize};

use crate::geometry::ImageGeometry;

/// A lens model and its numbers.
///
/// As JSON or YAML: the numbers, with the model's name beside them as `model`.
///
/// ```
/// use jrdb_types::LensModel;
/// let lens: LensModel =
///     serde_json::from_str(r#"{"model": "equirectangular", "width_px": 3840, "height_px": 1920}"#).unwrap();
/// assert!(lens.image().wraps);
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "model", rename_all = "snake_case")]
pub enum LensModel {
    /// Straight lines stay straight, but for the distortion.
    Pinhole(Pinhole),
    /// Fisheye: a polynomial of the incidence angle.
    KannalaBrandt(KannalaBrandt),
    /// Fisheye: two spheres and a pinhole.
    DoubleSphere(DoubleSphere),
    /// Longitude and latitude: what most 360° cameras write.
    Equirectangular(Equirectangular),
    /// A vertical cylinder around the camera: JRDB's official panorama.
    Cylindrical(CylindricalPanorama),
    /// Several cameras on a cylinder of finite radius: what JRDB's panorama really is.
    StitchedCylindrical(StitchedCylindrical),
}

impl LensModel {
    /// Size of its images and whether they wrap.
    #[must_use]
    pub fn image(&self) -> ImageGeometry {
        let (width_px, height_px, wraps) = match self {
            Self::Pinhole(lens) => (lens.width_px, lens.height_px, false),
            Self::KannalaBrandt(lens) => (lens.width_px, lens.height_px, false),
            Self::DoubleSphere(lens) => (lens.width_px, lens.height_px, false),
            Self::Equirectangular(lens) => (lens.width_px, lens.height_px, true),
            Self::Cylindrical(lens) => (lens.width_px, lens.height_px, true),
            Self::StitchedCylindrical(lens) => (lens.width_px, lens.height_px, true),
        };
        ImageGeometry { width_px, height_px, wraps }
    }
}

/// A pinhole camera, distorted or rectified: OpenCV's and ROS's camera matrix `K` and coefficients `D`.
///
/// `u = fx x_d + cx`, `v = fy y_d + cy` with `(x_d, y_d)` the distorted `(X / Z, Y / Z)`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Pinhole {
    /// Columns, pixels.
    pub width_px: u32,
    /// Rows, pixels.
    pub height_px: u32,
    /// Columns per unit `x_d`, pixels.
    pub fx: f64,
    /// Rows per unit `y_d`, pixels.
    pub fy: f64,
    /// Column of the optical axis, pixels.
    pub cx: f64,
    /// Row of the optical axis, pixels.
    pub cy: f64,
    /// What bends straight lines; `"none"` (or nothing) for a rectified image.
    #[serde(default)]
    pub distortion: DistortionModel,
}

/// How a lens bends straight lines, as OpenCV's and ROS's coefficients.
///
/// With `x = X / Z`, `y = Y / Z`, `s = x² + y²`, the distorted point is
/// `x L + 2 p1 x y + p2 (s + 2 x²)`, `y L + p1 (s + 2 y²) + 2 p2 x y`,
/// where `L = 1 + k1 s + k2 s² + k3 s³`, divided by `1 + k4 s + k5 s² + k6 s³` in the rational model.
///
/// Source of the formulas: OpenCV's documentation, "Camera Calibration and 3D Reconstruction".
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[expect(missing_docs, reason = "the coefficients are defined by the formulas above")]
pub enum DistortionModel {
    /// A rectified image.
    #[default]
    None,
    /// ROS `plumb_bob`; JRDB's single cameras.
    BrownConrady { k1: f64, k2: f64, p1: f64, p2: f64, k3: f64 },
    /// ROS `rational_polynomial`.
    Rational { k1: f64, k2: f64, p1: f64, p2: f64, k3: f64, k4: f64, k5: f64, k6: f64 },
}

/// Why a list of numbers is no distortion.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DistortionError {
    /// The list has an unknown length.
    #[error(
        "expected 0, 4, 5 or 8 distortion coefficients (k1 k2 p1 p2 k3 k4 k5 k6), found {found}"
    )]
    Count {
        /// Length of the list.
        found: usize,
    },
}

impl DistortionModel {
    /// Reads OpenCV's list `D`: `k1 k2 p1 p2 [k3 [k4 k5 k6]]`, or nothing. Note that `k3` comes last but
    /// for the rational coefficients, after the tangential `p1 p2`.
    ///
    /// # Errors
    /// [`DistortionError::Count`] when there are not 0, 4, 5 or 8 numbers.
    ///
    /// ```
    /// use jrdb_types::lens::DistortionModel;
    /// let model = DistortionModel::from_opencv(&[-0.34, 0.16, 1e-4, -7e-5, -0.05]).unwrap();
    /// let DistortionModel::BrownConrady { p2, k3, .. } = model else { unreachable!() };
    /// assert_eq!((p2, k3), (-7e-5, -0.05));
    /// ```
    pub fn from_opencv(coefficients: &[f64]) -> Result<Self, DistortionError> {
        match *coefficients {
            [] => Ok(Self::None),
            [k1, k2, p1, p2] => Ok(Self::BrownConrady { k1, k2, p1, p2, k3: 0.0 }),
            [k1, k2, p1, p2, k3] => Ok(Self::BrownConrady { k1, k2, p1, p2, k3 }),
            [k1, k2, p1, p2, k3, k4, k5, k6] => {
                Ok(Self::Rational { k1, k2, p1, p2, k3, k4, k5, k6 })
            }
            _ => Err(DistortionError::Count { found: coefficients.len() }),
        }
    }
}

/// A fisheye whose radius in the image is a polynomial of the angle of incidence.
///
/// With θ the angle between the ray and the optical axis and `θ_d = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸)`,
/// `u = fx θ_d x / hypot(x, y) + cx`, `v = fy θ_d y / hypot(x, y) + cy`.
///
/// OpenCV's `fisheye` and ROS's `equidistant`; Kannala and Brandt 2006 without the asymmetric terms.
/// Unlike OpenCV, this model sees beyond 90°, up to the angle at which `θ_d` stops growing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct KannalaBrandt {
    /// Columns, pixels.
    pub width_px: u32,
    /// Rows, pixels.
    pub height_px: u32,
    /// Columns per radian on the axis, pixels.
    pub fx: f64,
    /// Rows per radian on the axis, pixels.
    pub fy: f64,
    /// Column of the optical axis, pixels.
    pub cx: f64,
    /// Row of the optical axis, pixels.
    pub cy: f64,
    /// `[k1, k2, k3, k4]`; all 0 is the equidistant fisheye.
    pub k: [f64; 4],
}

/// A closed-form fisheye of six numbers.
///
/// A point is projected on a unit sphere, from there on a second one whose centre lies `ξ` behind the first's,
/// and then by a pinhole moved back by `α / (1 - α)`: with `d1 = |p|`, `ζ = ξ d1 + z`, `d2 = |(x, y, ζ)|`,
/// `u = fx x / (α d2 + (1 - α) ζ) + cx` and `v` alike (the paper's letters and formulas, but for ζ).
///
/// A point is seen while the radius in the image grows with its angle from the optical axis: `ζ > -w1 d2`
/// with `w1 = min(α, 1 - α) / max(α, 1 - α)`, and `d1 + ξ z > 0`, which matters for `|ξ| > 1` only. The paper's own
/// test `z > -w2 d1` is an approximation of this: narrower for most lenses, but wide enough to
/// fold back where `-2 w1 > ξ`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct DoubleSphere {
    /// Columns, pixels.
    pub width_px: u32,
    /// Rows, pixels.
    pub height_px: u32,
    /// Horizontal focal length, pixels; a radian on the axis is `fx / (1 + ξ)` columns.
    pub fx: f64,
    /// Vertical focal length, pixels.
    pub fy: f64,
    /// Column of the optical axis, pixels.
    pub cx: f64,
    /// Row of the optical axis, pixels.
    pub cy: f64,
    /// ξ, distance of the spheres' centres in radii, usually in (-1, 1).
    pub xi: f64,
    /// α in `[0, 1]`: 0 draws the second sphere as a pinhole does, 1 orthographically.
    pub alpha: f64,
}

/// The whole sphere, wrapping: columns are longitude and rows latitude.
///
/// `u = (1/2 + atan2(x, z) / 2π) · W mod W`,
/// `v = (1/2 + atan2(y, hypot(x, z)) / π) · H`.
///
/// The middle of the image looks forward, the top row straight up, the seam backwards. The poles, which
/// have a row but no column, get the middle column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Equirectangular {
    /// W, columns, pixels: 360°.
    pub width_px: u32,
    /// H, rows, pixels: 180°.
    pub height_px: u32,
}

/// A 360° image on a vertical cylinder around the camera, wrapping: JRDB's official model.
///
/// `u = (1/2 + atan2(x, z) / 2π) · W mod W`, `v = c + f · y / hypot(x, z)`: column 0 looks backwards,
/// the middle column forwards, columns grow to the right. Pixels are not square: `f` is vertical only.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CylindricalPanorama {
    /// W, columns, pixels.
    pub width_px: u32,
    /// Rows, pixels.
    pub height_px: u32,
    /// f, rows per unit slope, pixels.
    pub focal_px: f64,
    /// c, the row of the horizon, pixels.
    pub horizon_px: f64,
}

/// One of the cameras whose pictures were stitched, in the panorama's frame: x right, y down, z forward.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct StitchView {
    /// Where it looks: `atan2(x, z)` of its optical axis, radians, positive to the right.
    pub azimuth_rad: f64,
    /// Its centre `[x, y, z]`, metres; nearer to the vertical axis than the cylinder is.
    pub center_m: [f64; 3],
}

/// Pictures of several views, re-projected on the cylinder of radius `ρ0` around the vertical axis.
///
/// The ray from a view's centre through the point meets the cylinder in `X`, and
/// `u = (1/2 + atan2(X.x, X.z) / 2π) · W + u0 mod W`, `v = F · X.y / ρ0 + c`.
/// A point at distance `ρ0` is drawn where a camera on the axis would see it; nearer and farther ones are
/// displaced by the parallax between the view's centre and the axis.
///
/// The view is the one whose azimuth is nearest to the point's. Close to the border between two views a
/// point farther than `ρ0` may be in the image twice and a nearer one not at all; the model gives the pixel in
/// its nearest view. For the same reason a pixel less than the parallax (about 1° in JRDB) from a border
/// may come back from its ray as the point's other image.
///
/// JRDB's panorama is fitted by `ρ0` = 1.7143 m, `F` = 514.24, `c` = 199.431, `u0` = -1.059 and the views of
/// `sensor_0` to `sensor_4` of its `cameras.yaml`, to 0.3 px in the median on a frame of bytes-cafe-2019-02-07_0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct StitchedCylindrical {
    /// W, columns, pixels: 360°.
    pub width_px: u32,
    /// Rows, pixels.
    pub height_px: u32,
    /// `ρ0`, the cylinder's radius, metres.
    pub radius_m: f64,
    /// F, rows per unit slope, pixels.
    pub focal_px: f64,
    /// c, the row of the horizon, pixels.
    pub horizon_px: f64,
    /// `u0`: the forward column is `W / 2 + u0`, pixels.
    pub column_offset_px: f64,
    /// The cameras.
    pub views: Vec<StitchView>,
}
