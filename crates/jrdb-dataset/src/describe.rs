//! What a file or a folder is, and what it contains.

mod description;
mod file;
mod folder;

use std::path::Path;

use crate::Error;

pub use description::{Description, Kind};

/// Describes a file or a folder: whatever it is, as far as it can be read.
///
/// # Errors
/// [`Error::Read`] when it is not there. A file that is not what its name stands for is described as that, with the reason as
/// what is missing.
pub fn describe(path: &Path) -> Result<Description, Error> {
    if path.is_dir() {
        folder::describe(path)
    } else {
        std::fs::metadata(path).map_err(|source| Error::Read { path: path.into(), source })?;
        Ok(file::describe(path))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn described(name: &str, text: &str) -> Description {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        describe(&path).unwrap()
    }

    #[test]
    fn files_are_known_by_what_they_hold() {
        let cloud = "FIELDS x y z\nWIDTH 2\nHEIGHT 1\nDATA ascii\n1 2 3\n4 5 6\n";
        let found = described("a.pcd", cloud);
        assert_eq!((found.kind, found.contains[0].as_str()), (Kind::Cloud, "2 points"));
        let results = r#"[{"image_id": 0, "category_id": 1, "bbox": [1, 2, 3, 4], "score": NaN}]"#;
        let found = described("a.json", results);
        assert_eq!((found.kind, found.title.as_str()), (Kind::Detections, "COCO results"));
        assert!(found.contains.contains(&"category_id 1: 1".into()), "{found:?}");
        let labels = r#"{"labels": {"000000.jpg": [{"label_id": "pedestrian:1"}]}}"#;
        assert_eq!(described("b.json", labels).kind, Kind::Labels);
        let artefact = r#"{"schema": "jrdb.query", "schema_version": 2, "data": {}}"#;
        assert_eq!(described("c.json", artefact).kind, Kind::Artefact);
        let ros =
            "camera_matrix: {data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}\ndistortion_model: plumb_bob\n";
        assert_eq!(described("d.yaml", ros).kind, Kind::CameraCalibration);
        assert_eq!(described("e.txt", "P2: 1\nTr_velo_to_cam: 1\n").kind, Kind::KittiCalibration);
        assert_eq!(described("f.las", "").kind, Kind::Unknown);
        let broken = described("g.pcd", "VERSION .7\n");
        assert!(broken.missing[0].contains("DATA line"), "{broken:?}");
    }

    #[test]
    fn trees_tell_what_they_have_and_lack() {
        let folder = tempfile::tempdir().unwrap();
        let sweeps = folder.path().join("pointclouds/top/walk");
        std::fs::create_dir_all(&sweeps).unwrap();
        std::fs::create_dir_all(folder.path().join("images/image_stitched/walk")).unwrap();
        std::fs::write(sweeps.join("000000.bin"), [0; 16]).unwrap();
        let found = describe(folder.path()).unwrap();
        assert_eq!(found.kind, Kind::Dataset);
        assert!(
            found.contains.iter().any(|fact| fact == "sequence walk: 1 frame (000000)"),
            "{found:?}"
        );
        assert!(found.contains.iter().any(|fact| fact.contains("top: 1 sweep")), "{found:?}");
        assert!(found.missing.iter().any(|fact| fact.contains("calibration")), "{found:?}");
        let other = tempfile::tempdir().unwrap();
        assert_eq!(describe(other.path()).unwrap().kind, Kind::Folder);
        assert!(describe(&other.path().join("none")).is_err());
    }
}
