//! What a calibration check and a refinement of mounts come to, and floors.

use serde::{Deserialize, Serialize};

/// An offset that was measured, with how far it can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Measure {
    /// How far the mount is off: the mount is the truth plus this. Radians or metres, as the field's name
    /// says.
    pub offset: f64,
    /// Standard deviation of the offset, by leaving out one sector of azimuth at a time; same unit.
    /// That of a height holds `FitConfig::height_bias_m` too.
    pub deviation: f64,
    /// Ends of surfaces that it rests on.
    pub edges: usize,
    /// By how many standard errors the image's edges are stronger there than elsewhere.
    pub significance: f64,
    /// Whether the best offset is at the end of the range searched, so that the true one may be beyond.
    pub at_border: bool,
}

/// Why an offset says nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Doubt {
    /// The cloud shows fewer ends of surfaces in the image than `FitConfig::min_edges`.
    FewEdges,
    /// At the best offset the image's edges are hardly stronger than elsewhere.
    NoMatch,
    /// The best offset is at the end of the range searched.
    AtBorder,
    /// The sectors of azimuth disagree by more than the tolerance.
    Uncertain,
}

/// What one offset comes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding {
    /// Within the tolerance.
    Consistent,
    /// Beyond the tolerance.
    Off,
    /// Neither can be said.
    CannotTell(Doubt),
}

/// What all offsets together come to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Everything is within its tolerance.
    Consistent,
    /// Something is beyond its tolerance.
    Off,
    /// Nothing is beyond its tolerance, but something cannot be told.
    CannotTell,
}

/// How a LiDAR, or all of them as one, fit the image.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LidarFit {
    /// Name of the LiDAR; `rig` for all as one.
    pub sensor: String,
    /// How far the mount is turned about the z axis, counter-clockwise from above, radians.
    pub yaw_rad: Measure,
    /// What that comes to.
    pub yaw: Finding,
    /// How far the mount is too high, metres.
    pub height_m: Measure,
    /// What that comes to.
    pub height: Finding,
}

impl LidarFit {
    /// What moves the LiDAR's points to where the image has them: minus the offsets that could be told.
    #[must_use]
    pub fn correction(&self) -> Motion {
        let told = |finding, measure: &Measure| match finding {
            Finding::CannotTell(_) => 0.0,
            Finding::Consistent | Finding::Off => -measure.offset,
        };
        Motion {
            yaw_rad: told(self.yaw, &self.yaw_rad),
            height_m: told(self.height, &self.height_m),
            ..Motion::default()
        }
    }
}

/// Whether clouds fit images.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FitReport {
    /// Each LiDAR, by name.
    pub lidars: Vec<LidarFit>,
    /// All LiDARs moved as one.
    pub rig: LidarFit,
    /// What it all comes to.
    pub verdict: Verdict,
}

/// A way in which a LiDAR can be mounted wrongly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Freedom {
    /// Turned about the z axis, counter-clockwise from above; radians.
    Yaw,
    /// Turned about the y axis, nose down; radians.
    Pitch,
    /// Turned about the x axis, left side up; radians.
    Roll,
    /// Along the z axis, up; metres.
    Height,
}

impl Freedom {
    /// All, in the order of the numbers in a [`Motion`].
    pub const ALL: [Self; 4] = [Self::Yaw, Self::Pitch, Self::Roll, Self::Height];
}

/// A movement of a LiDAR in the base frame: turned about its own origin by `Rz(yaw) Ry(pitch) Rx(roll)`,
/// then raised.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Motion {
    /// About z, radians.
    pub yaw_rad: f64,
    /// About y, radians.
    pub pitch_rad: f64,
    /// About x, radians.
    pub roll_rad: f64,
    /// Along z, metres.
    pub height_m: f64,
}

impl Motion {
    /// One of its numbers, radians or metres.
    #[must_use]
    pub fn get(&self, freedom: Freedom) -> f64 {
        match freedom {
            Freedom::Yaw => self.yaw_rad,
            Freedom::Pitch => self.pitch_rad,
            Freedom::Roll => self.roll_rad,
            Freedom::Height => self.height_m,
        }
    }

    /// The same with one number replaced.
    #[must_use]
    pub fn with(mut self, freedom: Freedom, value: f64) -> Self {
        match freedom {
            Freedom::Yaw => self.yaw_rad = value,
            Freedom::Pitch => self.pitch_rad = value,
            Freedom::Roll => self.roll_rad = value,
            Freedom::Height => self.height_m = value,
        }
        self
    }
}

/// One freedom of a LiDAR's mount after refinement.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RefinedFreedom {
    /// Which.
    pub freedom: Freedom,
    /// What to add to the mount, radians or metres; 0 where the data do not determine it.
    pub correction: f64,
    /// Standard deviation of the correction, from the score's curvature and the scatter of the sectors, with the
    /// bias of `FitConfig`; none where the score has no top.
    pub deviation: Option<f64>,
    /// Whether the data determine it: the deviation, times `FitConfig::coverage`, is within the tolerance.
    pub is_determined: bool,
}

/// A LiDAR's mount after refinement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RefinedLidar {
    /// Name of the LiDAR.
    pub sensor: String,
    /// What moves its points to where the images have them.
    pub correction: Motion,
    /// Each freedom, in the order of [`Freedom::ALL`].
    pub freedoms: Vec<RefinedFreedom>,
    /// How much stronger the images' edges are at the cloud's edges than elsewhere, mean rank, before.
    pub score_before: f64,
    /// The same after.
    pub score_after: f64,
}

/// The mounts of all LiDARs after refinement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Refinement {
    /// Each LiDAR, by name.
    pub lidars: Vec<RefinedLidar>,
}

/// The plane that the robot stands on, in the base frame (x forward, y left, z up).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Floor {
    /// Unit normal `[x, y, z]`, upwards.
    pub normal: [f64; 3],
    /// z of the plane under the base frame's origin (at x = y = 0), metres; negative when the origin is
    /// above the floor.
    pub height_m: f64,
    /// Points within the tolerance of the plane.
    pub inliers: usize,
    /// Root mean square distance of those points from the plane, metres.
    pub rms_m: f64,
}

impl Floor {
    /// Angle between the floor's normal and the base frame's z axis, radians, in `[0, π/2]`.
    #[must_use]
    pub fn tilt_rad(&self) -> f64 {
        angle_rad(self.normal, [0.0, 0.0, 1.0])
    }

    /// Angle between this floor's normal and another's, radians.
    #[must_use]
    pub fn angle_to_rad(&self, other: &Self) -> f64 {
        angle_rad(self.normal, other.normal)
    }
}

/// Angle between two unit vectors, radians; exact for small angles, where the arc cosine is not.
fn angle_rad(a: [f64; 3], b: [f64; 3]) -> f64 {
    let cross =
        [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]);
    let dot: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
    cross.iter().map(|c| c * c).sum::<f64>().sqrt().atan2(dot)
}

/// The floor as one LiDAR sees it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SensorFloor {
    /// Name of the LiDAR.
    pub sensor: String,
    /// Its floor, base frame.
    pub floor: Floor,
}

/// How far the floors of two LiDARs lie apart.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FloorDifference {
    /// Name of the first LiDAR.
    pub first: String,
    /// Name of the second LiDAR.
    pub second: String,
    /// Height of the second floor under the origin minus that of the first, metres.
    pub height_m: f64,
    /// Angle between the two normals, radians.
    pub tilt_rad: f64,
}

/// The floors of several LiDARs and how they agree.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FloorAgreement {
    /// Each LiDAR's own floor, in the order given.
    pub floors: Vec<SensorFloor>,
    /// Every pair of LiDARs, in the order given; empty for a single LiDAR.
    pub differences: Vec<FloorDifference>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_as_they_were_set() {
        for freedom in Freedom::ALL {
            assert_eq!(Motion::default().with(freedom, 0.3).get(freedom), 0.3);
        }
    }
}
