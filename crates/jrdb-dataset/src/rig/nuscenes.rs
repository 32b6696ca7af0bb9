//! Tables of the nuScenes kind: sensors, their calibrations, and the samples that they gave.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use jrdb_types::lens::Pinhole;
use jrdb_types::{Camera, LensModel, Lidar, Rig, Rotation, Transform};
use serde::Deserialize;
use serde_json::Value;

use super::pinhole::pinhole;
use crate::number::exactly_in;
use crate::{Error, file, json};

/// nuScenes' base frame: x forward, y left, z up, on the ground below the rear axle.
const EGO: &str = "ego";

/// The camera that comes first.
const FORWARD: &str = "CAM_FRONT";

const SAMPLE_DATA: &str = "sample_data.json";

/// Most tokens that an error lists.
const MAX_TOKENS: usize = 8;

/// Which calibrations to take: the tables have another one for each drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Calibrations<'a> {
    /// The only one that each channel has.
    Only,
    /// Those of a sample, by its token.
    OfSample(&'a str),
    /// These, by the tokens of `calibrated_sensor.json`.
    Tokens(&'a [&'a str]),
}

/// The rig of a folder with nuScenes' tables `sensor.json`, `calibrated_sensor.json` and `sample_data.json`, or of one above it.
///
/// The base frame is `ego`. Every camera and LiDAR that has data is part of the rig, in a frame of its channel's name; radars
/// are not. The cameras are rectified pinholes as large as `sample_data` says, `CAM_FRONT` first, then by name. Quaternions are
/// `w x y z`, translations metres, both sensor to ego.
///
/// # Errors
/// [`Error::Read`] or [`Error::Json`] for a table, and [`Error::Content`] when a channel has several calibrations (with their
/// tokens), when something unknown is asked for, for numbers that are too few, too many or not finite, a camera matrix
/// of another form, and a camera whose pictures have no size or several.
pub fn nuscenes(folder: &Path, calibrations: Calibrations<'_>) -> Result<Rig, Error> {
    let tables = Tables::read(&folder_of_tables(folder)?, calibrations)?;
    let mut rig = Rig { base: EGO.into(), transforms: vec![], cameras: vec![], lidars: vec![] };
    for (sensor, calibrated) in tables.one_for_each_channel()? {
        let (name, frame) = (sensor.channel.clone(), sensor.channel.clone());
        match sensor.modality.as_str() {
            "camera" => {
                let lens = LensModel::Pinhole(tables.lens(calibrated)?);
                rig.cameras.push(Camera { name, frame, lens });
            }
            "lidar" => rig.lidars.push(Lidar { name, frame }),
            _ => continue,
        }
        rig.transforms.push(tables.transform(&sensor.channel, calibrated)?);
    }
    rig.cameras.sort_by(|a, b| (a.name != FORWARD, &a.name).cmp(&(b.name != FORWARD, &b.name)));
    super::plausible::check(&rig, &tables.path)?;
    Ok(rig)
}

/// The folder itself, or the only one in it that has the tables, such as `v1.0-mini`.
fn folder_of_tables(folder: &Path) -> Result<PathBuf, Error> {
    let has_tables = |folder: &Path| folder.join(SAMPLE_DATA).is_file();
    if has_tables(folder) {
        return Ok(folder.into());
    }
    let inner: Vec<PathBuf> =
        file::list(folder)?.into_iter().filter(|inner| has_tables(inner)).collect();
    match &inner[..] {
        [] => Ok(folder.into()), // whose missing table is named when it is read
        [only] => Ok(only.clone()),
        _ => {
            let names = inner.iter().filter_map(|path| path.file_name()?.to_str());
            let found = names.collect::<Vec<_>>().join(" and ");
            Err(Error::content(folder, "one folder with tables", found))
        }
    }
}

/// A row of `sensor.json`.
#[derive(Deserialize)]
struct Sensor {
    token: String,
    channel: String,
    modality: String,
}

/// A row of `calibrated_sensor.json`.
#[derive(Deserialize)]
struct Calibrated {
    token: String,
    sensor_token: String,
    translation: Value,
    rotation: Value,
    #[serde(default)]
    camera_intrinsic: Value,
}

/// A row of `sample_data.json`, of which there may be millions.
#[derive(Deserialize)]
struct SampleData<'a> {
    #[serde(borrow)]
    sample_token: Cow<'a, str>,
    #[serde(borrow)]
    calibrated_sensor_token: Cow<'a, str>,
    width: Option<u32>,
    height: Option<u32>,
}

struct Tables {
    folder: PathBuf,
    /// `calibrated_sensor.json`.
    path: PathBuf,
    sensors: BTreeMap<String, Sensor>,
    /// The calibrations asked for, in the order of the file.
    calibrated: Vec<Calibrated>,
    /// By the token of a calibration that has data: the sizes of its pictures.
    sizes_px: BTreeMap<String, BTreeSet<[u32; 2]>>,
}

impl Tables {
    fn read(folder: &Path, calibrations: Calibrations<'_>) -> Result<Self, Error> {
        let sizes_px = read_sizes(&folder.join(SAMPLE_DATA), calibrations)?;
        let sensors: Vec<Sensor> =
            json::read(&folder.join("sensor.json"), "rows of token, channel and modality")?;
        let path = folder.join("calibrated_sensor.json");
        let mut calibrated: Vec<Calibrated> = json::read(
            &path,
            "rows of token, sensor_token, translation, rotation and camera_intrinsic",
        )?;
        calibrated.retain(|row| sizes_px.contains_key(&row.token));
        if let Calibrations::Tokens(tokens) = calibrations {
            calibrated.retain(|row| tokens.contains(&row.token.as_str()));
            let has = |token: &str| calibrated.iter().any(|row| row.token == token);
            if let Some(token) = tokens.iter().find(|token| !has(token)) {
                let expected = format!("a calibration {token:?} that has data");
                return Err(Error::content(&path, expected, "none"));
            }
        }
        let sensors = sensors.into_iter().map(|sensor| (sensor.token.clone(), sensor)).collect();
        Ok(Self { folder: folder.into(), path, sensors, calibrated, sizes_px })
    }

    /// The calibration of each channel, sorted by channel.
    fn one_for_each_channel(&self) -> Result<Vec<(&Sensor, &Calibrated)>, Error> {
        let mut channels: BTreeMap<&str, Vec<(&Sensor, &Calibrated)>> = BTreeMap::new();
        for row in &self.calibrated {
            let sensor = self.sensors.get(&row.sensor_token).ok_or_else(|| {
                let expected = format!("a sensor of sensor.json in row {:?}", row.token);
                Error::content(&self.path, expected, format!("{:?}", row.sensor_token))
            })?;
            channels.entry(&sensor.channel).or_default().push((sensor, row));
        }
        let one = |(channel, rows): (&str, Vec<_>)| match rows[..] {
            [one] => Ok(one),
            _ => Err(self.ambiguous(channel, &rows)),
        };
        channels.into_iter().map(one).collect()
    }

    fn ambiguous(&self, channel: &str, rows: &[(&Sensor, &Calibrated)]) -> Error {
        let tokens = rows.iter().take(MAX_TOKENS).map(|(_, row)| row.token.as_str());
        let mut found = tokens.collect::<Vec<_>>().join(", ");
        if rows.len() > MAX_TOKENS {
            found = format!("{found} and {} more", rows.len() - MAX_TOKENS);
        }
        let expected = format!("one calibration of {channel}, or a choice by token or sample");
        Error::content(&self.path, expected, found)
    }

    fn lens(&self, row: &Calibrated) -> Result<Pinhole, Error> {
        let key = format!("camera_intrinsic of {:?}", row.token);
        let k = exactly_in(Some(&row.camera_intrinsic), &key, &self.path)?;
        let sizes: Vec<[u32; 2]> = self.sizes_px[&row.token].iter().copied().collect();
        let [size_px] = sizes[..] else {
            let expected = format!("pictures of one size of calibration {:?}", row.token);
            let path = self.folder.join(SAMPLE_DATA);
            return Err(Error::content(&path, expected, format!("{sizes:?}")));
        };
        pinhole(k, size_px, &key, &self.path)
    }

    fn transform(&self, channel: &str, row: &Calibrated) -> Result<Transform, Error> {
        let numbers = |name: &str| format!("{name} of {:?}", row.token);
        let (t, q) = (Some(&row.translation), Some(&row.rotation));
        let translation_m = exactly_in(t, &numbers("translation"), &self.path)?;
        let rotation = exactly_in(q, &numbers("rotation"), &self.path)?;
        Ok(Transform {
            parent: EGO.into(),
            child: channel.into(),
            translation_m,
            rotation: Rotation::QuaternionWxyz(rotation),
        })
    }
}

/// The sizes of the pictures of every calibration that has data.
fn read_sizes(
    path: &Path,
    calibrations: Calibrations<'_>,
) -> Result<BTreeMap<String, BTreeSet<[u32; 2]>>, Error> {
    let text = file::read_text(path)?;
    let rows: Vec<SampleData<'_>> = serde_json::from_str(&text).map_err(|source| Error::Json {
        expected: "rows of sample_token, calibrated_sensor_token, width and height",
        path: path.into(),
        source,
    })?;
    let mut sizes_px: BTreeMap<String, BTreeSet<[u32; 2]>> = BTreeMap::new();
    for row in rows {
        if matches!(calibrations, Calibrations::OfSample(token) if token != row.sample_token) {
            continue;
        }
        let size_px = [row.width.unwrap_or(0), row.height.unwrap_or(0)];
        match sizes_px.get_mut(row.calibrated_sensor_token.as_ref()) {
            Some(sizes_px) => drop(sizes_px.insert(size_px)),
            None => {
                drop(
                    sizes_px.insert(row.calibrated_sensor_token.into(), BTreeSet::from([size_px])),
                );
            }
        }
    }
    match calibrations {
        Calibrations::OfSample(token) if sizes_px.is_empty() => {
            Err(Error::content(path, format!("data of sample {token:?}"), "none"))
        }
        _ => Ok(sizes_px),
    }
}
