//! The labels of a sequence: three files joined by frame and id.

mod classes;
mod index;
mod join;
mod raw;
pub(crate) mod words;

pub(crate) use join::wrap_rad;

use std::collections::BTreeSet;
use std::path::Path;

use jrdb_types::detection::PERSON;
use jrdb_types::{
    Attribute, Capabilities, Detections, FrameId, ImageGeometry, Issue, IssueKind, Vocabulary,
};

use crate::{Error, file};
use index::LabelFile;
use raw::{BoxLabel, SocialLabel, SpaceLabel};

/// Folders of the label files under `labels/`.
pub(crate) const BOXES: &str = "labels_2d_stitched";
pub(crate) const SPACE: &str = "labels_3d";
pub(crate) const SOCIAL: &str = "labels_2d_activity_social_stitched";

/// The attributes that the social file holds.
const SOCIAL_ATTRIBUTES: [Attribute; 4] =
    [Attribute::Age, Attribute::Gender, Attribute::Race, Attribute::Action];

/// The labels of one sequence: 2D boxes, 3D boxes, and JRDB-Act and JRDB-Social attributes.
///
/// The files are read through once; of each only the places of the frames are kept, and a frame's labels are read when it is asked
/// for. Objects that could not be read are trouble of their frame. Frame keys without an integer
/// stem belong to no frame and are passed over.
#[derive(Debug, Clone)]
pub struct SequenceLabels {
    boxes: LabelFile<BoxLabel>,
    space: LabelFile<SpaceLabel>,
    social: LabelFile<SocialLabel>,
    /// Classes of all objects of the sequence.
    classes: BTreeSet<String>,
}

impl SequenceLabels {
    /// Reads whichever of the three files are there; `labels` is the folder that holds theirs.
    pub(crate) fn read(labels: &Path, sequence: &str) -> Result<Self, Error> {
        let name = format!("{sequence}.json");
        let path = |folder: &str| file::named(&labels.join(folder), &name);
        let paths = [BOXES, SPACE, SOCIAL].map(path);
        if !paths.iter().any(|path| path.is_file()) {
            let expected = format!("{BOXES}, {SPACE} or {SOCIAL} of {sequence:?}");
            return Err(Error::Absent { expected, path: labels.into() });
        }
        Ok(Self {
            boxes: LabelFile::open(&paths[0])?,
            space: LabelFile::open(&paths[1])?,
            social: LabelFile::open(&paths[2])?,
            classes: classes::of_files(&paths)?,
        })
    }

    /// Every frame that one of the files has, sorted.
    #[must_use]
    pub fn frames(&self) -> Vec<u32> {
        let all = self.boxes.numbers().chain(self.space.numbers()).chain(self.social.numbers());
        let frames: BTreeSet<u32> = all.collect();
        frames.into_iter().collect()
    }

    /// What the labels say of a frame, joined by id; nothing when they have no such frame.
    ///
    /// * The box is that of `labels_2d_stitched`, else that of the social file. Whoever has none is
    ///   left out with an issue, as is a box without area or outside the image.
    /// * Position and heading are those of `labels_3d`: heading = π - `rot_z`, in (-π, π].
    /// * Age, gender, race, action and interactions are those of the social file. Of several actions
    ///   the first pose counts; `impossible` and race `Others` mean "unknown".
    /// * `pedestrian:` and `person:` ids are people, `table:` ids are tables, and so on. Objects
    ///   marked `no_eval` stay.
    #[must_use]
    pub fn detections(&self, frame: &FrameId, image: ImageGeometry) -> Detections {
        let boxes = self.boxes.of_frame(frame.frame);
        let space = self.space.of_frame(frame.frame);
        let social = self.social.of_frame(frame.frame);
        let mut joined = join::Joined::default();
        joined.add(BOXES, &boxes, |parts, label| parts.flat = Some(label));
        joined.add(SPACE, &space, |parts, label| parts.space = Some(label));
        joined.add(SOCIAL, &social, |parts, label| parts.social = Some(label));
        let mut detections = joined.into_detections(frame, image);
        let missing = self.missing(frame);
        detections.capabilities = Some(self.capabilities(frame.frame));
        detections.issues.splice(0..0, missing);
        detections
    }

    /// What these labels state about a frame: the classes that occur in the sequence, and what the social file holds.
    fn capabilities(&self, frame: u32) -> Capabilities {
        let has_boxes = self.boxes.has(frame) || self.social.has(frame);
        if !has_boxes {
            return Capabilities::none();
        }
        let people = std::iter::once(PERSON.to_owned());
        let categories = people.chain(self.classes.iter().cloned()).collect();
        if self.social.has(frame) {
            let (attributes, interactions) = (SOCIAL_ATTRIBUTES.into_iter(), Vocabulary::OPEN);
            let attributes = attributes.collect();
            return Capabilities { categories, attributes, interactions, ..Capabilities::none() };
        }
        Capabilities { categories, ..Capabilities::none() }
    }

    /// What is not there of a frame.
    fn missing(&self, frame: &FrameId) -> Vec<Issue> {
        let lacks = |folder: &str, what: &str| {
            let sequence = &frame.sequence;
            let message = format!(
                "labels/{folder}/{sequence}.json has nothing for frame {}: {what} unknown",
                frame.frame
            );
            Issue::new(IssueKind::MissingLabels, message)
        };
        match [self.boxes.has(frame.frame), self.social.has(frame.frame)] {
            [_, true] => Vec::new(),
            [true, false] if self.social.is_absent() => Vec::new(),
            [true, false] => vec![lacks(SOCIAL, "ages, genders, actions and interactions are")],
            [false, false] => vec![lacks(BOXES, "who is there is")],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jrdb_types::{Action, Belief, EntityId, Gender, IssueKind, Race};

    const IMAGE: ImageGeometry = ImageGeometry { width_px: 3760, height_px: 480, wraps: true };

    fn detections(boxes: &str, space: &str, social: &str) -> Detections {
        let file = |extension: &str, objects: &str| {
            format!(r#"{{"labels": {{"000007.{extension}": [{objects}]}}}}"#)
        };
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: String| {
            std::fs::create_dir_all(folder.path().join(name)).unwrap();
            std::fs::write(folder.path().join(name).join("cafe.json"), text).unwrap();
        };
        write(BOXES, file("jpg", boxes));
        write(SPACE, file("pcd", space));
        write(SOCIAL, file("jpg", social));
        let labels = SequenceLabels::read(folder.path(), "cafe").unwrap();
        labels.detections(&FrameId { sequence: "cafe".into(), frame: 7 }, IMAGE)
    }

    fn messages(found: &Detections) -> Vec<String> {
        found.issues.iter().map(|issue| format!("{:?}: {}", issue.kind, issue.message)).collect()
    }

    const FLAT: &str = r#"{"label_id": "pedestrian:1", "file_id": "000009.jpg", "box": [10, "20", 30, 40.5],
        "attributes": {"occlusion": "Mostly_visible", "truncated": "false", "no_eval": true}, "new": 1}"#;
    const SPACE_LABEL: &str = r#"{"label_id": "pedestrian:1", "file_id": "000009.pcd", "observation_angle": null,
        "box": {"cx": 1, "cy": "2.5", "cz": -0.1, "l": 0.9, "w": 0.5, "h": 1.8, "rot_z": 0.0}}"#;
    const SOCIAL_LABEL: &str = r#"{"label_id": "pedestrian:1", "box": [11, 21, 31, 41],
        "action_label": {"talking to someone": 1, "sitting": "2", "bending": 1},
        "demographics_info": [{"gender": {"Female": "1", "Male": "2"}, "age": {"impossible": "1"},
            "race": {"Mongoloid/Asian": "1"}}],
        "H-interaction": [{"pair": "pedestrian:7", "inter_labels": {"sitting together": 1, "conversation": 2}}]}"#;

    #[test]
    fn three_files_make_one_person() {
        let found = detections(FLAT, SPACE_LABEL, SOCIAL_LABEL);
        assert_eq!(messages(&found), [""; 0]);
        let person = &found.detections[0];
        assert_eq!((person.category.as_str(), person.score), ("person", 1.0));
        assert_eq!(<[f64; 4]>::from(person.bbox), [10.0, 20.0, 30.0, 40.5]);
        assert_eq!(person.heading_rad, Some(std::f64::consts::PI));
        assert_eq!(person.box3d.unwrap().center, [1.0, 2.5, -0.1]);
        assert_eq!(person.box3d.unwrap().size, [0.9, 0.5, 1.8]);
        assert_eq!(person.occlusion, Some(jrdb_types::vocab::Occlusion::MostlyVisible));
        assert_eq!(person.attributes.gender(), Belief::certain(Gender::Female));
        assert_eq!(person.attributes.race(), Belief::certain(Race::Asian));
        assert_eq!(person.attributes.action(), Belief::certain(Action::Sitting));
        assert!(person.attributes.age().is_unknown());
        let labels: Vec<&str> = person.interactions.iter().map(|i| i.label.as_str()).collect();
        assert_eq!(labels, ["conversation", "sitting together"]);
        assert_eq!(person.interactions[0].partner, EntityId::new("pedestrian", 7));
    }

    #[test]
    fn the_first_pose_in_the_file_s_own_order_is_the_action() {
        let social = SOCIAL_LABEL.replace("talking to someone", "going upstairs");
        let found = detections("", "", &social);
        assert_eq!(found.detections[0].attributes.action(), Belief::certain(Action::GoingUp));
        assert_eq!(found.detections[0].bbox.x, 11.0, "the social file's box stands in");
        assert_eq!(found.detections[0].heading_rad, None);
    }

    #[test]
    fn a_3d_label_without_a_2d_box_is_left_out_with_an_issue() {
        let found = detections("", SPACE_LABEL, "");
        assert!(found.detections.is_empty());
        assert_eq!(messages(&found), ["BadLabel: 3d label without a 2d box"]);
    }

    #[test]
    fn one_bad_object_does_not_spoil_the_others() {
        let bad = [
            r#"{"label_id": "pedestrian:2"}"#,
            r#"{"label_id": "pedestrian:3", "box": [1, 2, 3]}"#,
            r#"{"label_id": "pedestrian:4", "box": [1, 2, 1e999, 4]}"#,
            r#"{"label_id": 5, "box": [1, 2, 3, 4]}"#,
            "null",
            FLAT,
        ];
        let found = detections(&format!("{FLAT}, {}", bad.join(",")), "", "");
        assert_eq!(found.detections.len(), 1);
        assert_eq!(found.issues.len(), bad.len());
        assert!(found.issues.iter().all(|issue| issue.kind == IssueKind::BadLabel));
        let subjects = found.issues.iter().filter(|issue| issue.subject.is_some()).count();
        assert_eq!(subjects, 4);
    }

    #[test]
    fn boxes_are_wrapped_and_improper_ones_are_left_out() {
        let label =
            |id: u32, numbers: &str| format!(r#"{{"label_id": "p:{id}", "box": {numbers}}}"#);
        let boxes = [
            label(1, "[-10, 0, 20, 20]"),
            label(2, "[3750, 0, 20, 20]"),
            label(3, "[5, 5, 0, 20]"),
            label(4, r#"["nan", 5, 1, 20]"#),
            label(5, "[5, 480, 1, 20]"),
        ];
        let found = detections(&boxes.join(","), "", "");
        let kept: Vec<f64> = found.detections.iter().map(|d| d.bbox.x).collect();
        assert_eq!(kept, [3750.0, 3750.0]);
        assert!(found.issues.iter().all(|issue| issue.kind == IssueKind::BadBox));
        assert_eq!(found.issues.len(), 3);
    }

    #[test]
    fn a_bad_3d_box_costs_the_position_only() {
        for (old, new) in [(r#""w": 0.5"#, r#""w": 0"#), (r#""cx": 1"#, r#""cx": "inf""#)] {
            let found = detections(FLAT, &SPACE_LABEL.replace(old, new), "");
            assert_eq!((found.detections.len(), found.issues.len()), (1, 1));
            assert_eq!(found.issues[0].kind, IssueKind::BadBox);
            assert_eq!(found.detections[0].box3d, None);
        }
    }

    #[test]
    fn other_classes_are_objects_and_lists_are_sorted() {
        let object = |id: &str| format!(r#"{{"label_id": "{id}", "box": [1, 2, 3, 4]}}"#);
        let all = ["table:1", "person:3", "pedestrian:12", "pedestrian:9"].map(object).join(",");
        let found = detections(&all, "", "");
        let ids: Vec<String> =
            found.detections.iter().map(|d| format!("{} {}", d.id, d.category)).collect();
        assert_eq!(
            ids,
            ["pedestrian:9 person", "pedestrian:12 person", "person:3 person", "table:1 table"]
        );
    }

    #[test]
    fn sections_of_another_shape_are_unknown_not_fatal() {
        let social = r#"{"label_id": "pedestrian:1", "box": [1, 2, 3, 4], "attributes": "none",
            "action_label": [], "demographics_info": [], "H-interaction": {}}"#;
        let found = detections("", "", social);
        assert!(found.detections[0].attributes.action().is_unknown());
        assert_eq!(messages(&found), [""; 0]);
    }

    #[test]
    fn an_interaction_with_nobody_is_an_issue() {
        let social = SOCIAL_LABEL.replace("pedestrian:7", "nobody");
        let found = detections("", "", &social);
        assert_eq!(
            messages(&found),
            [r#"BadLabel: interaction: expected an id like "pedestrian:12", found "nobody""#]
        );
    }

    #[test]
    fn a_frame_that_is_not_a_list_is_an_issue_and_a_file_without_labels_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("cafe.json");
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            LabelFile::<BoxLabel>::open(&path)
        };
        let text = r#"{"labels": {"000007.jpg": 5, "8.jpg": [], "cover.jpg": []}, "more": {}}"#;
        let file = read(text).unwrap();
        assert_eq!(file.numbers().collect::<Vec<_>>(), [7, 8]);
        assert!(file.of_frame(7)[0].is_err() && file.of_frame(8).is_empty());
        assert!(read(r#"{"detections": {}}"#).is_err());
        assert!(read("{").is_err() && read(r#"{"labels": {}} x"#).is_err());
    }
}
