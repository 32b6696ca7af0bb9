//! A tree that the writer made, read back; and trees with something missing or wrong.
#![allow(clippy::unwrap_used, reason = "a failing helper should panic")]

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fs;
use std::path::PathBuf;

use jrdb_dataset::{Dataset, LabelledFrame, LidarMount, OfficialCalibration, TreeWriter};
use jrdb_types::detection::Interaction;
use jrdb_types::vocab::Occlusion;
use jrdb_types::{
    Action, Age, Attributes, Box3d, CylindricalPanorama, Detection, Detections, EntityId, FrameId,
    Gender, Image, ImageGeometry, IssueKind, LensModel, Lidar, PixelBox, PointCloud, Race,
};

/// An empty folder for one test.
fn folder(test: &str) -> PathBuf {
    let root = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("tree").join(test);
    let _ = fs::remove_dir_all(&root);
    fs::create_dir_all(&root).unwrap();
    root
}

fn calibration() -> OfficialCalibration {
    let panorama = CylindricalPanorama {
        width_px: 376,
        height_px: 48,
        focal_px: 48.292_412_345_678_9,
        horizon_px: 1.0 / 3.0,
    };
    let mount = |name: &str, z: f64, yaw_rad: f64| LidarMount {
        name: name.into(),
        offset_m: [0.0, 0.1, z],
        yaw_rad,
    };
    let lidars =
        vec![mount("upper_velodyne", -0.33529, 0.085), mount("lower_velodyne", 0.13511, 0.0)];
    OfficialCalibration { panorama, lidars }
}

fn geometry() -> ImageGeometry {
    LensModel::Cylindrical(calibration().panorama).image()
}

fn lidars() -> Vec<Lidar> {
    calibration().rig().lidars
}

fn frame(frame: u32) -> FrameId {
    FrameId { sequence: "cafe-2030-01-01_0".into(), frame }
}

fn person(number: u32, x: f64) -> Detection {
    let box3d = Box3d { center: [1.25, -2.0, 0.0], size: [0.9, 0.5, 1.75], heading_rad: 0.5 };
    Detection {
        camera: None,
        id: EntityId::new("pedestrian", number),
        category: "person".into(),
        score: 1.0,
        bbox: PixelBox::from([x, 10.0, 20.5, 30.0]),
        attributes: Attributes::certain([
            Age::MiddleAged.into(),
            Gender::Female.into(),
            Race::Asian.into(),
            Action::GoingDown.into(),
        ]),
        interactions: Vec::new(),
        group: None,
        occlusion: Some(Occlusion::MostlyVisible),
        heading_rad: Some(box3d.heading_rad),
        box3d: Some(box3d),
    }
}

fn with(number: u32, label: &str) -> Interaction {
    Interaction { partner: EntityId::new("pedestrian", number), label: label.into() }
}

/// Two people who talk, one behind the robot of whom little is known, and a table.
fn labelled() -> LabelledFrame {
    let mut talker = person(1, 370.0);
    talker.interactions = vec![with(2, "conversation"), with(2, "standing together")];
    let mut listener = person(2, 30.0);
    listener.interactions = vec![with(1, "conversation"), with(1, "standing together")];
    let stranger = Detection {
        attributes: Attributes::default(),
        occlusion: None,
        heading_rad: None,
        box3d: None,
        ..person(11, 0.12345)
    };
    let table = Detection {
        id: EntityId::new("table", 1),
        category: "table".into(),
        attributes: Attributes::default(),
        ..person(1, 40.0)
    };
    let detections = Detections {
        frame: frame(3),
        image: geometry(),
        detections: vec![talker, listener, stranger, table],
        capabilities: None,
        issues: vec![],
    };
    LabelledFrame {
        detections,
        num_points: BTreeMap::from([(EntityId::new("pedestrian", 1), 120)]),
    }
}

fn cloud(sensor: &str) -> PointCloud {
    PointCloud {
        sensor: sensor.into(),
        x: vec![1.0, 2.5],
        y: vec![0.0, -3.0],
        z: vec![0.5, 0.25],
        intensity: vec![7.0, 0.0],
        skipped: 0,
    }
}

#[test]
fn what_is_written_is_read_back() {
    let root = folder("round-trip");
    let writer = TreeWriter::new(&root);
    let image = Image::filled(376, 48, [1, 2, 3]);
    writer.calibration(&calibration()).unwrap();
    writer.image(&frame(3), &image).unwrap();
    for sensor in ["upper_velodyne", "lower_velodyne"] {
        writer.cloud(&frame(3), &cloud(sensor)).unwrap();
    }
    writer.labels(&frame(3).sequence, &[labelled()]).unwrap();

    let dataset = Dataset::open(&root).unwrap();
    assert_eq!(dataset.root(), root);
    assert_eq!(dataset.sequences().unwrap(), [frame(3).sequence]);
    assert_eq!(dataset.frames(&frame(3).sequence).unwrap(), [3]);
    assert_eq!(dataset.official_calibration().unwrap(), calibration());
    assert_eq!(dataset.rig().unwrap(), calibration().rig());
    assert_eq!(dataset.image(&frame(3).sequence, 3).unwrap(), image);
    let (clouds, issues) = dataset.clouds(&frame(3).sequence, 3, &lidars());
    let positions = |sensor| PointCloud { intensity: Vec::new(), ..cloud(sensor) };
    assert_eq!(
        (clouds, issues),
        (["upper_velodyne", "lower_velodyne"].map(positions).to_vec(), vec![])
    );

    let labels = dataset.labels(&frame(3).sequence).unwrap();
    assert_eq!(labels.frames(), [3]);
    let found = labels.detections(&frame(3), geometry());
    let expected = labelled().detections;
    assert_eq!(found.issues, []);
    for (found, expected) in found.detections.iter().zip(&expected.detections) {
        let difference = found.heading_rad.unwrap_or(0.0) - expected.heading_rad.unwrap_or(0.0);
        assert!(difference.abs() < 1e-5);
        let (heading_rad, box3d) = (expected.heading_rad, expected.box3d);
        assert_eq!(&Detection { heading_rad, box3d, group: None, ..found.clone() }, expected);
        assert_eq!(found.box3d.map(|b| (b.center, b.size)), box3d.map(|b| (b.center, b.size)));
    }
    assert_eq!(found.detections.len(), expected.detections.len());
    let groups: Vec<_> = found.detections.iter().map(|detection| detection.group).collect();
    assert_eq!(groups, [Some(1), Some(1), Some(3), None], "those who interact are a group");
}

#[test]
fn label_files_are_in_jrdb_s_form() {
    let root = folder("form");
    TreeWriter::new(&root).labels("cafe", &[labelled()]).unwrap();
    let read = |folder: &str| -> serde_json::Value {
        let path = root.join("labels").join(folder).join("cafe.json");
        serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
    };
    let flat = &read("labels_2d_stitched")["labels"]["000003.jpg"];
    assert_eq!(
        flat[0],
        serde_json::json!({
            "label_id": "pedestrian:1", "file_id": "000003.jpg", "box": [370, 10, 20.5, 30],
            "attributes": {"area": 615.0, "interpolated": false, "no_eval": false,
                "occlusion": "Mostly_visible", "truncated": "false"}
        })
    );
    let space = &read("labels_3d")["labels"]["000003.pcd"];
    assert_eq!(space[0]["attributes"]["num_points"], 120);
    assert_eq!(space[0]["box"]["rot_z"], ((PI - 0.5) * 1e5).round() / 1e5);
    assert_eq!(space.as_array().unwrap().len(), 3, "the stranger has no 3d box");
    let social = &read("labels_2d_activity_social_stitched")["labels"]["000003.jpg"];
    assert_eq!(social.as_array().unwrap().len(), 3, "the table is no person");
    let demographics = serde_json::json!([{
        "age": {"Middle_Adulthood": "1"}, "gender": {"Female": "1"}, "race": {"Mongoloid/Asian": "1"}
    }]);
    assert_eq!(social[0]["demographics_info"], demographics);
    assert_eq!(social[0]["action_label"], serde_json::json!({"going downstairs": 1}));
    assert_eq!(social[2]["demographics_info"][0]["age"], serde_json::json!({"impossible": "1"}));
    let groups: Vec<_> = (0..3).map(|i| social[i]["social_group"]["cluster_ID"].clone()).collect();
    assert_eq!(groups, [1, 1, 3]);
}

#[test]
fn an_interaction_said_by_one_is_written_on_both() {
    let root = folder("both");
    let mut labelled = labelled();
    labelled.detections.detections[1].interactions.clear();
    TreeWriter::new(&root).labels("cafe", &[labelled]).unwrap();
    let found = Dataset::open(&root).unwrap().labels("cafe").unwrap();
    let found = found.detections(&frame(3), geometry());
    assert_eq!(
        found.detections[1].interactions,
        [with(1, "conversation"), with(1, "standing together")]
    );
}

#[test]
fn a_known_group_keeps_its_number() {
    let root = folder("group");
    let mut labelled = labelled();
    labelled.detections.detections[0].group = Some(40);
    TreeWriter::new(&root).labels("cafe", &[labelled]).unwrap();
    let found = Dataset::open(&root).unwrap().labels("cafe").unwrap();
    assert_eq!(found.detections(&frame(3), geometry()).detections[0].group, Some(40));
}

#[test]
fn the_same_labels_give_the_same_bytes() {
    let [a, b] = ["once", "twice"].map(|test| {
        let root = folder(test);
        TreeWriter::new(&root).labels("cafe", &[labelled()]).unwrap();
        TreeWriter::new(&root).calibration(&calibration()).unwrap();
        ["labels/labels_2d_activity_social_stitched/cafe.json", "calibration/cameras.yaml"]
            .map(|path| fs::read(root.join(path)).unwrap())
    });
    assert_eq!(a, b);
}

#[test]
fn a_folder_that_is_no_tree_says_what_was_expected() {
    let root = folder("none");
    let error = Dataset::open(&root).unwrap_err().to_string();
    assert!(
        error.starts_with("expected images/image_stitched or labels, found nothing of the kind in"),
        "{error}"
    );
}

#[test]
fn clouds_that_are_absent_or_broken_are_issues_and_the_others_go_on() {
    let root = folder("clouds");
    let writer = TreeWriter::new(&root);
    writer.image(&frame(0), &Image::filled(2, 2, [0; 3])).unwrap();
    let mut partly_nowhere = cloud("lower_velodyne");
    partly_nowhere.x[0] = f32::NAN;
    writer.cloud(&frame(0), &partly_nowhere).unwrap();
    let dataset = Dataset::open(&root).unwrap();
    let (clouds, issues) = dataset.clouds(&frame(0).sequence, 0, &lidars());
    assert_eq!((clouds.len(), clouds[0].len(), clouds[0].skipped), (1, 1, 1));
    let kinds: Vec<_> = issues.iter().map(|issue| issue.kind).collect();
    assert_eq!(kinds, [IssueKind::MissingInput, IssueKind::SkippedPoints]);
    assert_eq!(
        issues[0].message,
        "pointclouds/upper_velodyne/cafe-2030-01-01_0/000000.pcd: no such file"
    );

    let broken = root.join("pointclouds/upper_velodyne").join(frame(0).sequence);
    fs::create_dir_all(&broken).unwrap();
    fs::write(broken.join("000000.pcd"), "VERSION 0.7\n").unwrap();
    let (_, issues) = dataset.clouds(&frame(0).sequence, 0, &lidars());
    assert!(issues[0].message.ends_with("DATA line, found the end of the file"), "{issues:?}");
}

/// A cloud of one point as every kind of file: name ending, and bytes.
fn one_point() -> [(&'static str, Vec<u8>); 5] {
    let floats = |n| [1.0_f32, 2.0, 3.0, 4.0, 5.0][..n].iter().flat_map(|v| v.to_le_bytes());
    let npy = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 4)}";
    let npy = [b"\x93NUMPY\x01\x00", &[npy.len() as u8, 0][..], npy.as_bytes()].concat();
    let pcd = "FIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nPOINTS 1\nDATA ascii\n1 2 3 4\n";
    let ply = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
        property float z\nproperty float intensity\nend_header\n1 2 3 4\n";
    [
        ("pcd", pcd.into()),
        ("bin", floats(4).collect()),
        ("npy", npy.into_iter().chain(floats(4)).collect()),
        ("ply", ply.into()),
        ("pcd.bin", floats(5).collect()),
    ]
}

#[test]
fn another_robot_is_a_rig_file_and_clouds_of_any_kind_in_folders_of_its_lidars_names() {
    let root = folder("robot");
    TreeWriter::new(&root).labels("walk", &[]).unwrap();
    let mut lidars = Vec::new();
    for (frame, (ending, bytes)) in one_point().into_iter().enumerate() {
        let name = format!("lidar_{frame}");
        let sweeps = root.join("pointclouds").join(&name).join("walk");
        fs::create_dir_all(&sweeps).unwrap();
        fs::write(sweeps.join(format!("000004.{ending}")), &bytes).unwrap();
        fs::write(sweeps.join(format!("{}.{ending}", frame + 10)), &bytes).unwrap();
        lidars.push(format!("{{ name: {name}, frame: base }}"));
    }
    let text = format!(
        "schema: jrdb.rig\nschema_version: 2\ndata:\n  base: base\n  cameras:\n    - name: ring\n      \
         frame: base\n      lens: {{ model: equirectangular, width_px: 8, height_px: 4 }}\n  \
         lidars: [{}]\n",
        lidars.join(", ")
    );
    fs::create_dir_all(root.join("calibration")).unwrap();
    fs::write(root.join("calibration/rig.yaml"), &text).unwrap();

    let dataset = Dataset::open(&root).unwrap();
    assert_eq!(dataset.frames("walk").unwrap(), [4, 10, 11, 12, 13, 14]);
    let rig = dataset.rig().unwrap();
    let (clouds, issues) = dataset.clouds("walk", 4, &rig.lidars);
    assert_eq!((clouds.len(), issues), (5, vec![]));
    for (cloud, lidar) in clouds.iter().zip(&rig.lidars) {
        assert_eq!(cloud.sensor, lidar.name);
        assert_eq!((cloud.x[0], cloud.y[0], cloud.z[0]), (1.0, 2.0, 3.0), "{}", cloud.sensor);
        assert!(cloud.intensity.is_empty(), "only positions are read");
    }
    let (clouds, issues) = dataset.clouds("walk", 12, &rig.lidars);
    assert_eq!((clouds[0].sensor.as_str(), issues.len()), ("lidar_2", 4));

    fs::write(root.join("calibration/rig.yml"), &text).unwrap();
    let error = dataset.rig().unwrap_err().to_string();
    assert!(error.starts_with("expected one rig file, found rig.yaml and rig.yml, in"), "{error}");
}

#[test]
fn frames_are_the_union_of_images_and_clouds_and_names_need_not_have_six_digits() {
    let root = folder("frames");
    let writer = TreeWriter::new(&root);
    let sequence = frame(0).sequence;
    writer.image(&frame(5), &Image::filled(2, 2, [9; 3])).unwrap();
    writer.cloud(&frame(7), &cloud("upper_velodyne")).unwrap();
    let images = root.join("images/image_stitched").join(&sequence);
    fs::rename(images.join("000005.png"), images.join("5.png")).unwrap();
    fs::write(images.join("notes.txt"), "").unwrap();
    let dataset = Dataset::open(&root).unwrap();
    assert_eq!(dataset.frames(&sequence).unwrap(), [5, 7]);
    assert_eq!(dataset.image(&sequence, 5).unwrap().pixel(0, 0), [9; 3]);
    assert!(
        dataset.image(&sequence, 7).unwrap_err().to_string().starts_with("expected 000007.jpg")
    );
    assert!(dataset.frames("elsewhere").is_err());
    assert!(dataset.labels(&sequence).is_err());
}

#[test]
fn sequences_without_images_are_known_by_their_labels() {
    let root = folder("labels-only");
    let writer = TreeWriter::new(&root);
    writer.labels("b", &[labelled()]).unwrap();
    writer.labels("a", &[]).unwrap();
    assert_eq!(Dataset::open(&root).unwrap().sequences().unwrap(), ["a", "b"]);
}

#[test]
fn calibration_files_with_a_fault_say_which() {
    let root = folder("calibration");
    let writer = TreeWriter::new(&root);
    writer.labels("a", &[]).unwrap();
    let dataset = Dataset::open(&root).unwrap();
    let cases = [
        (
            "cameras.yaml",
            "sensor_6:",
            "sensor_5:",
            "expected cameras.sensor_6, found no such camera",
        ),
        ("cameras.yaml", " 0 376\n", " 0 nan\n", "expected 9 finite numbers as cameras.sensor_0.K"),
        (
            "cameras.yaml",
            "0 0 1\n    R",
            "0 1\n    R",
            "expected 9 finite numbers as cameras.sensor_0.K",
        ),
        ("cameras.yaml", "0 0 1\n    R", "0 zero 1\n    R", "expected camera calibrations with K"),
        ("cameras.yaml", "48.2924", "-48.2924", "expected a positive median of K[1,1], found -48"),
        (
            "defaults.yaml",
            "[0, 0, 0.085]",
            "[0.1, 0, 0.085]",
            "expected calibrated.lidar_upper_to_rgb.rotation about z only, found [0.1, 0.0, 0.085]",
        ),
        (
            "defaults.yaml",
            "[0, 0, 0.085]",
            "[0, 0, nan]",
            "expected 3 finite numbers as calibrated.lidar_upper_to_rgb.rotation",
        ),
        ("defaults.yaml", "lidar_lower", "lidar_middle", "expected calibrated.lidar_lower_to_rgb"),
        ("defaults.yaml", "width: 376", "width: 0", "expected image.width of 1 to 65536 pixels"),
        ("defaults.yaml", "width: 376", "width: 400000", "expected image.width of 1 to 65536 pix"),
        ("defaults.yaml", "image:", "picture:", "expected lidar mounts and an image size"),
    ];
    for (file, old, new, expected) in cases {
        writer.calibration(&calibration()).unwrap();
        let path = root.join("calibration").join(file);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(old), "{old}");
        fs::write(&path, text.replace(old, new)).unwrap();
        let error = dataset.rig().unwrap_err().to_string();
        assert!(error.starts_with(expected) && error.contains(file), "{error}");
    }
    writer.calibration(&calibration()).unwrap();
    let path = root.join("calibration/cameras.yaml");
    let list = fs::read_to_string(&path).unwrap().replace("D: 0 0 0 0 0", "D: [0, 0, 0, 0, 0]");
    fs::write(&path, list).unwrap();
    assert_eq!(dataset.official_calibration().unwrap(), calibration());
}

#[test]
fn what_cannot_be_written_in_jrdb_s_form_is_refused() {
    let writer = TreeWriter::new(&folder("refused"));
    assert!(writer.cloud(&frame(0), &cloud("front_livox")).is_err());
    assert!(writer.image(&frame(0), &Image::filled(0, 2, [0; 3])).is_err());
    let mut one_lidar = calibration();
    one_lidar.lidars.pop();
    assert!(writer.calibration(&one_lidar).is_err());
}

/// A tree with a picture and a sweep of one point, both with their names.
fn named(test: &str, picture: &str, sweep: &str) -> (Dataset, PathBuf) {
    let root = folder(test);
    let writer = TreeWriter::new(&root);
    writer.image(&frame(0), &Image::filled(2, 2, [0; 3])).unwrap();
    let images = root.join("images/image_stitched").join(frame(0).sequence);
    fs::rename(images.join("000000.png"), images.join(picture)).unwrap();
    let sweeps = root.join("pointclouds/upper_velodyne").join(frame(0).sequence);
    fs::create_dir_all(&sweeps).unwrap();
    fs::write(sweeps.join(sweep), &one_point()[1].1).unwrap();
    (Dataset::open(&root).unwrap(), root)
}

#[test]
fn endings_may_be_in_capitals_and_numbers_behind_names() {
    for (picture, sweep) in [("000000.PNG", "000000.BIN"), ("frame000000.png", "cloud_000000.bin")]
    {
        let (dataset, _) = named("capitals", picture, sweep);
        assert_eq!(dataset.frames(&frame(0).sequence).unwrap(), [0]);
        assert!(dataset.image(&frame(0).sequence, 0).is_ok());
        let (clouds, issues) = dataset.clouds(&frame(0).sequence, 0, &lidars()[..1]);
        assert_eq!((clouds.len(), issues), (1, vec![]));
    }
}

#[test]
fn files_named_by_times_are_frames_in_their_order_and_sweeps_are_the_nearest() {
    let (dataset, root) = named("times", "1550012345.500000000.png", "1550012345.520000000.bin");
    let sequence = frame(0).sequence;
    assert_eq!(dataset.frames(&sequence).unwrap(), [0]);
    assert!(dataset.image(&sequence, 0).is_ok());
    let (clouds, issues) = dataset.clouds(&sequence, 0, &lidars()[..1]);
    assert_eq!((clouds.len(), issues), (1, vec![]));
    let sweeps = root.join("pointclouds/upper_velodyne").join(&sequence);
    let far = sweeps.join("1550012399.520000000.bin");
    fs::rename(sweeps.join("1550012345.520000000.bin"), far).unwrap();
    let (_, issues) = dataset.clouds(&sequence, 0, &lidars()[..1]);
    assert_eq!(issues[0].kind, IssueKind::MissingInput);
    assert!(issues[0].message.contains("is 54.020 s apart"), "{issues:?}");
    let images = root.join("images/image_stitched").join(&sequence);
    fs::rename(images.join("1550012345.500000000.png"), images.join("000000.png")).unwrap();
    let (_, issues) = dataset.clouds(&sequence, 0, &lidars()[..1]);
    let why = r#"000000.bin: no such file; the folder holds "1550012399.520000000.bin""#;
    assert!(issues[0].message.ends_with(why), "numbers and times do not go together: {issues:?}");
    fs::rename(images.join("000000.png"), images.join("1550012345.500000000.png")).unwrap();
    fs::write(images.join("start.png"), "").unwrap();
    let error = dataset.frames(&sequence).unwrap_err().to_string();
    assert!(error.contains("1550012345.500000000.png"), "{error}");
}

#[test]
fn a_sequence_that_is_not_there_is_answered_with_names_alike() {
    let (dataset, _) = named("alike", "000000.png", "000000.bin");
    let error = dataset.frames("cafe").unwrap_err().to_string();
    assert!(error.contains(r#"found the sequences "cafe-2030-01-01_0""#), "{error}");
}

#[test]
fn stated_columns_are_taken() {
    let (dataset, root) = named("columns", "000000.png", "000000.bin");
    let path = root.join("pointclouds/upper_velodyne").join(frame(0).sequence).join("000000.bin");
    let row = [7.0_f64, 3.0, 2.0, 1.0].iter().flat_map(|v| v.to_le_bytes());
    fs::write(path, row.collect::<Vec<u8>>()).unwrap();
    let dataset = dataset.with_cloud_columns("t:f64,z:f64,y:f64,x:f64".parse().unwrap());
    let (clouds, issues) = dataset.clouds(&frame(0).sequence, 0, &lidars()[..1]);
    assert_eq!((clouds[0].x[0], clouds[0].z[0], issues), (1.0, 3.0, vec![]));
}

#[test]
fn labels_of_windows_and_of_python_are_read() {
    let root = folder("odd-labels");
    TreeWriter::new(&root).labels("cafe", &[labelled()]).unwrap();
    let read = || {
        let dataset = Dataset::open(&root).unwrap();
        let id = FrameId { sequence: "cafe".into(), ..frame(3) };
        dataset.labels("cafe").unwrap().detections(&id, geometry())
    };
    let (sound, path) = (read(), root.join("labels/labels_3d/cafe.json"));
    let text = fs::read_to_string(&path).unwrap();
    let utf16: Vec<u8> =
        format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    fs::write(&path, utf16).unwrap();
    assert_eq!(read(), sound);
    fs::write(&path, text.replacen("\"rot_z\":", "\"rot_z\": NaN, \"old\":", 1)).unwrap();
    let found = read();
    assert_eq!(found.detections.len(), sound.detections.len());
    assert_eq!(found.issues[0].kind, IssueKind::BadBox);
    fs::write(&path, text.replace("000003", "third")).unwrap();
    let error = Dataset::open(&root).unwrap().labels("cafe").unwrap_err().to_string();
    assert!(error.starts_with("expected frames named by their numbers"), "{error}");
}
