//! The paper's rule: the mean of all points in the box.

use nalgebra::Point3;

use super::Located;
use crate::BaseCloud;

/// Mean of the points `inside`, metres; `None` without points.
///
/// Source: the paper's F_P. Background and occluders pull it off: on a real JRDB frame by 1.36 m in the
/// median over 20 people.
#[must_use]
pub fn mean(cloud: &BaseCloud, inside: &[u32]) -> Option<Located> {
    let mean = |column: &[f32]| {
        let sum: f64 = inside.iter().map(|&i| f64::from(column[i as usize])).sum();
        sum / inside.len() as f64
    };
    let center = Point3::new(mean(&cloud.x), mean(&cloud.y), mean(&cloud.z));
    (!inside.is_empty()).then(|| Located { center, used: inside.to_vec() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_two_points_is_the_middle() {
        let (x, y, z) = (vec![1.0, 3.0, 0.0], vec![0.0, 4.0, 0.0], vec![0.0; 3]);
        let cloud = BaseCloud { x, y, z, ..BaseCloud::default() };
        let located = mean(&cloud, &[0, 1]).unwrap();
        assert_eq!(located.center, Point3::new(2.0, 2.0, 0.0));
        assert_eq!(mean(&cloud, &[]), None);
    }
}
