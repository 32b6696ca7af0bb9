//! One sweep of a frame, and what is wrong with it.

use std::path::Path;

use jrdb_types::{Issue, IssueKind, PointCloud, with_causes};

use crate::Error;
use crate::cloud::{Fields, Reader, implausible, is_coarse};

/// Reads a LiDAR's file. What is odd about it are issues; when it cannot be used, that is the last of them.
///
/// `place` is the file's path without folders of the machine. Points at the sensor itself are no returns and are left out.
pub(crate) fn read(
    reader: &mut Reader,
    path: &Path,
    sensor: &str,
    place: &str,
) -> (Option<PointCloud>, Vec<Issue>) {
    let issue = |kind, message: &str| Issue::new(kind, format!("{place}: {message}"));
    let read = reader.read(path, sensor, Fields::Positions);
    let mut issues: Vec<Issue> =
        reader.notes().iter().map(|note| issue(IssueKind::DoubtfulInput, note)).collect();
    let mut cloud = match read {
        Ok(cloud) => cloud,
        Err(error) => {
            issues.push(issue(IssueKind::MissingInput, &without_path(error)));
            return (None, issues);
        }
    };
    if let Some(why) = implausible(&cloud) {
        issues.push(issue(IssueKind::MissingInput, &why.to_string()));
        return (None, issues);
    }
    if is_coarse(&cloud) {
        let message = "all coordinates are whole numbers of metres, too coarse to place people: \
                       write them with fractions (PCD: TYPE F)";
        issues.push(issue(IssueKind::MissingInput, message));
        return (None, issues);
    }
    if cloud.skipped > 0 {
        let message = format!("{} points without a finite position", cloud.skipped);
        issues.push(issue(IssueKind::SkippedPoints, &message));
    }
    let far = leave_out(&mut cloud);
    if far > 0 {
        let message = format!("{far} points beyond {MAX_PLACE_M} m, left out");
        issues.push(issue(IssueKind::SkippedPoints, &message));
    }
    (Some(cloud), issues)
}

/// An error's text without the file's path, which stands in front of it.
fn without_path(error: Error) -> String {
    match error {
        Error::Cloud { source, .. } => with_causes(&source),
        Error::Read { source, .. } => source.to_string(),
        error => with_causes(&error),
    }
}

/// Largest coordinate that can be a place, metres.
const MAX_PLACE_M: f32 = 100_000.0;

/// Takes out the points at the sensor itself, which drivers write where no light came back, and those that are nowhere; how many
/// the latter are.
fn leave_out(cloud: &mut PointCloud) -> usize {
    let place = |cloud: &PointCloud, i: usize| [cloud.x[i], cloud.y[i], cloud.z[i]];
    let is_far = |place: [f32; 3]| place.iter().any(|number| number.abs() > MAX_PLACE_M);
    let is_odd = |place: [f32; 3]| place.iter().all(|number| *number == 0.0) || is_far(place);
    let first = (0..cloud.len()).find(|&i| is_odd(place(cloud, i)));
    let Some(first) = first else { return 0 };
    let (mut kept, mut far) = (first, 0);
    for i in first..cloud.len() {
        let place = place(cloud, i);
        far += usize::from(is_far(place));
        if !is_odd(place) {
            for column in [&mut cloud.x, &mut cloud.y, &mut cloud.z, &mut cloud.intensity] {
                if let Some(&number) = column.get(i) {
                    column[kept] = number;
                }
            }
            kept += 1;
        }
    }
    for column in [&mut cloud.x, &mut cloud.y, &mut cloud.z, &mut cloud.intensity] {
        column.truncate(kept);
        column.shrink_to_fit(); // a sweep of little but no returns may be large
    }
    far
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_at_the_sensor_are_left_out() {
        let mut cloud = PointCloud {
            x: vec![1.0, 0.0, 0.0, 2.0, 0.0, 1e20],
            y: vec![0.0, 0.0, 3.0, 2.0, 0.0, 0.0],
            z: vec![0.0; 6],
            intensity: vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
            ..PointCloud::default()
        };
        assert_eq!(leave_out(&mut cloud), 1);
        assert_eq!((cloud.x, cloud.y), (vec![1.0, 0.0, 2.0], vec![0.0, 3.0, 2.0]));
        assert_eq!(cloud.intensity, [1.0, 3.0, 4.0]);
    }

    #[test]
    fn a_cloud_in_millimetres_is_refused_and_notes_become_issues() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("7.pcd");
        let head = "FIELDS x y z\nSIZE 4 4 4\nTYPE I I I\nWIDTH 2\nHEIGHT 1\nDATA ascii\n";
        let read = |rows: &str| {
            std::fs::write(&path, format!("{head}{rows}")).unwrap();
            let (cloud, issues) = read(&mut Reader::default(), &path, "top", "top/7.pcd");
            let kinds: Vec<IssueKind> = issues.iter().map(|issue| issue.kind).collect();
            (cloud.is_some(), kinds, issues.last().unwrap().message.clone())
        };
        let (is_read, kinds, message) = read("1 2 3\n4 5 6\n");
        assert_eq!((is_read, kinds), (true, vec![IssueKind::DoubtfulInput]));
        assert!(message.starts_with("top/7.pcd: the coordinates are whole numbers"), "{message}");
        let (is_read, kinds, message) = read("1000 2000 3000\n4000 5000 6000\n");
        assert_eq!((is_read, kinds[1]), (false, IssueKind::MissingInput));
        assert!(message.ends_with("the unit is probably millimetres"), "{message}");
    }
}
