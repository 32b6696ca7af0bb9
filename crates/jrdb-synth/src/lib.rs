#![doc = include_str!("../README.md")]

mod cast;
mod config;
mod dress;
mod feature;
mod furniture;
mod labels;
mod lidar;
mod paint;
mod person;
mod plan;
mod questions;
mod random;
mod robot;
mod room;
mod solid;
mod training;
mod view;
mod wording;

#[cfg(test)]
mod tests;

use std::path::Path;

use jrdb_dataset::{Error, LabelledFrame, TreeWriter, check_sequence_name};
use jrdb_types::vocab::Headwear;
use jrdb_types::{
    Age, Artefact, Belief, EntityId, FrameId, Image, PointCloud, Question, Questions,
};
use serde_json::Value;

use cast::Cast;
use lidar::Target;
use paint::{Subject, chair_of};
use random::Random;
use room::Room;

pub use config::SynthConfig;
pub use feature::Feature;
pub use robot::calibration;
pub use room::Setting;
pub use training::{Practice, TILE_PX, practice, practice_with_looks};
pub use view::{InTile, Seen, View};

/// File of the questions, below the root of a scene, in JRDB-Reasoning's form.
pub const QUESTIONS_FILE: &str = "questions.json";

/// File of the detections of every frame, below the root of a scene: everything that is true of the things in the image,
/// also what JRDB's labels cannot hold.
pub const DETECTIONS_FILE: &str = "detections.json";

/// File of the configuration that a scene was made from, below its root: the same makes it again.
pub const SCENE_FILE: &str = "scene.json";

/// JRDB's frames come 15 times a second, and every fifth is labelled here, so that motion shows.
const FRAMES_PER_S: f64 = 15.0;
const STRIDE: u32 = 5;

/// More people than this do not get into a room.
const PEOPLE_MAX: usize = 60;

/// Returns of people, their chairs and the furniture, in the sensor's scale of 0 to 255.
const PERSON_RETURN: f32 = 18.0;
const CHAIR_RETURN: f32 = 26.0;
const FURNITURE_RETURN: f32 = 42.0;

/// A room with everything in it, over time. Frames are made when they are asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct World {
    config: SynthConfig,
    room: Room,
    cast: Cast,
}

/// One moment of a world, as the sensors and an all-knowing annotator have it.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Its name; numbers grow by 5, at 15 per second.
    pub id: FrameId,
    /// The panorama.
    pub image: Image,
    /// For each pixel of the panorama 0, or the same number for all pixels of one labelled thing.
    pub instances: Vec<u8>,
    /// One sweep per LiDAR of [`calibration`], in the sensors' frames.
    pub clouds: Vec<PointCloud>,
    /// Who and what is where, and the LiDAR points in each 3D box.
    pub labels: LabelledFrame,
    /// Questions with their answers, sorted by category.
    pub questions: Vec<Question>,
}

/// Makes a world. The same configuration gives the same world.
///
/// Ages, genders and races are dealt so that all come before one comes again; the first groups of
/// people are those that a scene of the setting should have: somebody across the seam of the
/// panorama, a close pair, somebody who sits and somebody who walks, somebody near and somebody
/// far.
#[must_use]
pub fn generate(config: &SynthConfig) -> World {
    let config = SynthConfig { people: config.people.min(PEOPLE_MAX), ..config.clone() };
    let room = Room::new(config.setting, &mut Random::stream(config.seed, 1));
    let path_seconds = seconds(config.frames.saturating_sub(1));
    let mut cast = cast::cast(&config, &room, path_seconds);
    let looks = dress::dress(&mut cast, &config.looks);
    let headwear = headwear(&cast, &config.headwear);
    World { config: SynthConfig { headwear, looks, ..config }, room, cast }
}

/// The configuration with looks dealt to everybody. The same configuration gives the same looks.
///
/// ```
/// use jrdb_synth::{SynthConfig, generate, with_looks};
/// let config = with_looks(&SynthConfig::default());
/// assert_eq!(config.looks.len(), config.people);
/// assert_eq!(generate(&config).config().looks, config.looks);
/// ```
#[must_use]
pub fn with_looks(config: &SynthConfig) -> SynthConfig {
    let plain = generate(&SynthConfig { looks: Vec::new(), ..config.clone() });
    let mut random = Random::stream(config.seed, 4);
    let people = plain.cast.people.iter();
    let looks =
        people.map(|person| dress::deal(person, &mut random).into_iter().collect()).collect();
    generate(&SynthConfig { looks, ..plain.config }).config
}

/// What each person wears on the head: as listed, then as drawn.
fn headwear(cast: &Cast, listed: &[Headwear]) -> Vec<Headwear> {
    let drawn = cast.people.iter().map(|person| match person.age {
        Age::Adolescent => Headwear::Cap,
        _ => Headwear::None,
    });
    drawn.enumerate().map(|(index, drawn)| listed.get(index).copied().unwrap_or(drawn)).collect()
}

/// Writes every frame of a world as a JRDB tree below `root`, its questions as [`QUESTIONS_FILE`], its detections as
/// [`DETECTIONS_FILE`] and its configuration as [`SCENE_FILE`].
///
/// Files that are there are replaced; others stay, so a folder should hold one world only.
///
/// # Errors
/// When the sequence's name cannot be that of a folder, or a file cannot be written.
pub fn write(world: &World, root: &Path) -> Result<(), Error> {
    check_sequence_name(&world.config.sequence)?;
    let writer = TreeWriter::new(root);
    writer.calibration(&calibration())?;
    let (mut labels, mut questions) = (Vec::new(), Vec::new());
    for index in 0..world.config.frames {
        let frame = world.frame(index);
        writer.image(&frame.id, &frame.image)?;
        for cloud in &frame.clouds {
            writer.cloud(&frame.id, cloud)?;
        }
        labels.push(frame.labels);
        questions.extend(frame.questions);
    }
    writer.labels(&world.config.sequence, &labels)?;
    let text = jrdb_dataset::write_questions(&Questions { questions });
    write_text(&root.join(QUESTIONS_FILE), &text)?;
    write_text(&root.join(DETECTIONS_FILE), &detections(labels))?;
    let scene = serde_json::to_string_pretty(&world.config).unwrap_or_default();
    write_text(&root.join(SCENE_FILE), &format!("{scene}\n"))
}

/// The detections of all frames, as a list of artefacts.
fn detections(frames: Vec<LabelledFrame>) -> String {
    let artefact = |frame: LabelledFrame| Artefact::new(Value::Null, frame.detections).to_json();
    let artefacts: Vec<String> = frames.into_iter().map(artefact).collect();
    let artefacts: Vec<&str> = artefacts.iter().map(|text| text.trim_end()).collect();
    format!("[\n{}\n]\n", artefacts.join(",\n"))
}

fn write_text(path: &Path, text: &str) -> Result<(), Error> {
    jrdb_dataset::write_file(path, text.as_bytes())
}

/// Seconds from the first frame to another.
fn seconds(index: u32) -> f64 {
    f64::from(index) * f64::from(STRIDE) / FRAMES_PER_S
}

impl World {
    /// What it was made from.
    #[must_use]
    pub fn config(&self) -> &SynthConfig {
        &self.config
    }

    /// A frame by its place in the sequence, from 0.
    #[must_use]
    pub fn frame(&self, index: u32) -> Frame {
        let number = index.saturating_mul(STRIDE);
        let id = FrameId { sequence: self.config.sequence.clone(), frame: number };
        let subjects = self.subjects(index);
        let picture = paint::paint(&self.room, &subjects, &robot::panorama());
        let clouds = self.clouds(&subjects, index);
        let mut labels = labels::labels(&id, &subjects, &picture.drawn, &clouds);
        for (person, &worn) in self.cast.people.iter().zip(&self.config.headwear) {
            let all = &mut labels.detections.detections;
            let seen =
                all.iter_mut().find(|one| one.id == EntityId::new("pedestrian", person.number));
            if let Some(seen) = seen {
                seen.attributes.set_headwear(Belief::certain(worn));
            }
        }
        let questions = questions::questions(&labels.detections, self.config.seed);
        let (image, instances) = (picture.image, picture.instances);
        Frame { id, image, instances, clouds, labels, questions }
    }

    /// The picture of a frame, by its place in the sequence, from 0: the one of [`World::frame`], in less time.
    #[must_use]
    pub fn view(&self, index: u32) -> View {
        let subjects = self.subjects(index);
        let picture = paint::paint(&self.room, &subjects, &robot::panorama());
        let seen = |(instance, subject): (u8, &Subject<'_>)| {
            let Subject::Person(person, pose) = subject else { return None };
            let drawn = picture.drawn.iter().find(|drawn| drawn.id == subject.id())?;
            let mut attributes = labels::attributes(person);
            attributes.facing = Belief::certain(paint::facing_of(pose));
            let (pixels, bbox) = (drawn.pixels, drawn.bbox);
            let features = person.features.iter().copied().collect();
            Some(Seen { instance, pixels, bbox, attributes, features })
        };
        let people = (1..).zip(&subjects).filter_map(seen).collect();
        View { image: picture.image, instances: picture.instances, people }
    }

    fn subjects(&self, index: u32) -> Vec<Subject<'_>> {
        let now = seconds(index);
        let people =
            self.cast.people.iter().map(|person| Subject::Person(person, person.pose(now)));
        people.chain(self.cast.furniture.iter().map(Subject::Furniture)).collect()
    }

    fn clouds(&self, subjects: &[Subject<'_>], index: u32) -> Vec<PointCloud> {
        let targets: Vec<Target> = subjects.iter().flat_map(targets).collect();
        let sensors = robot::sensors();
        let sweep = |(lidar, sensor): (&jrdb_dataset::LidarMount, u64)| {
            let stream = 100 + 2 * u64::from(index) + sensor;
            let mut random = Random::stream(self.config.seed, stream);
            lidar::sweep(&lidar.name, &sensors, &self.room, &targets, &mut random)
        };
        calibration().lidars.iter().zip(0..).map(sweep).collect()
    }
}

fn targets(subject: &Subject<'_>) -> Vec<Target> {
    let solids = |parts: Vec<furniture::Part>| parts.into_iter().map(|part| part.solid).collect();
    match subject {
        Subject::Furniture(thing) => vec![Target::new(solids(thing.placed()), FURNITURE_RETURN)],
        Subject::Person(person, pose) => {
            let mut targets = vec![Target::new(person.solids(pose), PERSON_RETURN)];
            let chair: Vec<_> = solids(chair_of(person, pose).concat());
            if !chair.is_empty() {
                targets.push(Target::new(chair, CHAIR_RETURN));
            }
            targets
        }
    }
}
