//! Whether a cloud can be a sweep in metres.

use jrdb_types::PointCloud;

/// Why a cloud is no sweep in metres.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "expected metres, found a median range of {median_range_m:.0}, beyond that of any LiDAR: the unit is probably {unit}"
)]
pub struct Implausible {
    /// Median distance of the points from the sensor, as if it were metres.
    pub median_range_m: f32,
    /// The unit that is likely.
    pub unit: &'static str,
}

/// Points that are looked at.
const SAMPLE: usize = 4096;
/// Half of the points of no sweep are beyond: LiDARs reach 100 to 300 m.
const MAX_MEDIAN_M: f32 = 500.0;
/// Half of the points of a sweep may be beyond, but not while the ground is `MAX_DEPTH_M` below.
const FAR_MEDIAN_M: f32 = 100.0;
/// How far below the sensor the lowest tenth of the points can be.
const MAX_DEPTH_M: f32 = 20.0;
/// From here on the unit is millimetres rather than centimetres.
const MILLIMETRES_M: f32 = 2000.0;

/// Why a cloud cannot be a sweep in metres; none for all that may be one.
///
/// Points at the sensor itself, which are no returns, do not count.
///
/// ```
/// use jrdb_types::PointCloud;
/// let near = PointCloud { x: vec![3.0; 9], y: vec![4.0; 9], z: vec![-1.0; 9], ..PointCloud::default() };
/// assert_eq!(jrdb_dataset::cloud::implausible(&near), None);
/// let far = PointCloud { x: vec![3000.0; 9], y: vec![4000.0; 9], z: vec![-1000.0; 9], ..PointCloud::default() };
/// assert_eq!(jrdb_dataset::cloud::implausible(&far).unwrap().unit, "millimetres");
/// ```
#[must_use]
pub fn implausible(cloud: &PointCloud) -> Option<Implausible> {
    let step = cloud.len().div_ceil(SAMPLE).max(1);
    let points = (0..cloud.len()).step_by(step).map(|i| [cloud.x[i], cloud.y[i], cloud.z[i]]);
    let returns: Vec<[f32; 3]> = points.filter(|point| *point != [0.0; 3]).collect();
    let median_range_m = quantile(returns.iter().map(squared_range), 0.5)?.sqrt() as f32;
    let depth_m = -quantile(returns.iter().map(|[.., z]| f64::from(*z)), 0.1)? as f32;
    let is_far = median_range_m > MAX_MEDIAN_M;
    let is_deep = median_range_m > FAR_MEDIAN_M && depth_m > MAX_DEPTH_M;
    let unit = if median_range_m > MILLIMETRES_M { "millimetres" } else { "centimetres" };
    (is_far || is_deep).then_some(Implausible { median_range_m, unit })
}

/// From so many points on, coordinates that are all whole numbers are no chance.
const MIN_COARSE: usize = 100;

/// Whether all coordinates are whole metres: too coarse to say where somebody stands.
pub(crate) fn is_coarse(cloud: &PointCloud) -> bool {
    let is_whole = |column: &[f32]| column.iter().all(|number| number.fract() == 0.0);
    cloud.len() >= MIN_COARSE
        && [&cloud.x, &cloud.y, &cloud.z].iter().all(|column| is_whole(column))
}

/// Square of the distance from the sensor, m²; in double precision, where no square overflows.
fn squared_range(point: &[f32; 3]) -> f64 {
    point.iter().map(|&axis| f64::from(axis).powi(2)).sum()
}

/// The number below which this part of the numbers is.
fn quantile(numbers: impl Iterator<Item = f64>, part: f64) -> Option<f64> {
    let mut numbers: Vec<f64> = numbers.collect();
    let at = (part * numbers.len() as f64) as usize;
    let at = at.min(numbers.len().checked_sub(1)?);
    Some(*numbers.select_nth_unstable_by(at, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A floor 1.1 m below the sensor and walls around it.
    fn room(scale: f32) -> PointCloud {
        let (mut cloud, count) = (PointCloud::default(), 1000);
        for i in 0..count {
            let turn = i as f32 * 0.1;
            let (range, z) = if i % 2 == 0 { (3.0, -1.1) } else { (6.0, 0.5) };
            cloud.x.push(scale * range * turn.cos());
            cloud.y.push(scale * range * turn.sin());
            cloud.z.push(scale * z);
        }
        cloud
    }

    #[test]
    fn whole_metres_are_coarse_where_there_are_enough_of_them() {
        let mut cloud = room(1.0);
        assert!(!is_coarse(&cloud));
        for column in [&mut cloud.x, &mut cloud.y, &mut cloud.z] {
            column.iter_mut().for_each(|number| *number = number.round());
        }
        assert!(is_coarse(&cloud));
        assert!(!is_coarse(&PointCloud::default()));
    }

    #[test]
    fn other_units_than_metres_are_named() {
        let unit = |scale| implausible(&room(scale)).map(|found| found.unit);
        assert_eq!((unit(1.0), unit(10.0)), (None, None));
        assert_eq!((unit(100.0), unit(1000.0)), (Some("centimetres"), Some("millimetres")));
        assert_eq!(implausible(&PointCloud::default()), None);
        let message = implausible(&room(1000.0)).unwrap().to_string();
        assert!(message.starts_with("expected metres, found a median range of"), "{message}");
    }
}
