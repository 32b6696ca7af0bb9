//! The picture of a frame: the room, then everything in it from the farthest to the nearest.

mod background;
mod canvas;
mod clothes;
mod head;
mod head_things;
mod pen;
mod person;
mod shade;
mod solids;

use jrdb_types::{EntityId, Image, PixelBox};

use super::furniture::{Furniture, Part, chair, placed};
use super::person::{Person, Pose};
use super::robot::Panorama;
use super::room::Room;
use canvas::{Canvas, Extent};
use person::Facing;

/// Something to draw.
pub(super) enum Subject<'a> {
    Person(&'a Person, Pose),
    Furniture(&'a Furniture),
}

/// Where something was drawn.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drawn {
    pub(super) id: EntityId,
    /// How many pixels it has, those included that others hide.
    pub(super) pixels: usize,
    /// The whole drawing, hidden parts too, whole pixels inside the picture's rows.
    pub(super) bbox: PixelBox,
    /// Share of its pixels that nothing hides, in `[0, 1]`.
    pub(super) visible: f64,
}

/// A picture, whose pixels are whose, and where everything is.
pub(super) struct Picture {
    pub(super) image: Image,
    /// For each pixel, 1 + the index of the subject; 0 where nothing labelled is.
    pub(super) instances: Vec<u8>,
    /// In the order of the subjects, without those of which no row is in the picture.
    pub(super) drawn: Vec<Drawn>,
}

impl Subject<'_> {
    fn range_m(&self) -> f64 {
        match self {
            Self::Person(_, pose) => pose.place_m.norm(),
            Self::Furniture(thing) => thing.place_m.norm(),
        }
    }

    pub(super) fn id(&self) -> EntityId {
        match self {
            Self::Person(person, _) => EntityId::new("pedestrian", person.number),
            Self::Furniture(thing) => thing.id.clone(),
        }
    }

    fn draw(&self, canvas: &mut Canvas, camera: &Panorama, instance: u8) -> Option<Extent> {
        match self {
            Self::Furniture(thing) => solids::draw(canvas, camera, &thing.placed(), instance),
            Self::Person(person, pose) => {
                let [seat, back] = chair_of(person, pose);
                let away = Facing::of(pose.place_m, pose.heading_rad) == Facing::Away;
                let (behind, before) =
                    if away { (seat, back) } else { ([seat, back].concat(), vec![]) };
                solids::draw(canvas, camera, &behind, 0);
                let extent = person::draw(canvas, camera, person, pose, instance);
                solids::draw(canvas, camera, &before, 0);
                extent
            }
        }
    }
}

/// Which side of somebody the robot sees.
pub(super) fn facing_of(pose: &Pose) -> jrdb_types::vocab::Facing {
    use jrdb_types::vocab;
    match Facing::of(pose.place_m, pose.heading_rad) {
        Facing::Towards => vocab::Facing::Towards,
        Facing::Away => vocab::Facing::Away,
        Facing::Left => vocab::Facing::Left,
        Facing::Right => vocab::Facing::Right,
    }
}

/// Seat and back of the chair below a sitting person, in the base frame; nothing below others.
pub(super) fn chair_of(person: &Person, pose: &Pose) -> [Vec<Part>; 2] {
    if person.action != jrdb_types::Action::Sitting {
        return [vec![], vec![]];
    }
    let (height_m, hip_m) = (person.height_m, person.build().hip * person.height_m);
    chair(height_m, hip_m).map(|parts| placed(&parts, pose.place_m, pose.heading_rad))
}

/// Draws a room and what is in it; at most 255 subjects get pixels of their own.
pub(super) fn paint(room: &Room, subjects: &[Subject<'_>], camera: &Panorama) -> Picture {
    let mut canvas = Canvas::new(&background::background(room, camera));
    let mut order: Vec<usize> = (0..subjects.len()).collect();
    order.sort_by(|&a, &b| subjects[b].range_m().total_cmp(&subjects[a].range_m()));
    let mut extents = vec![None; subjects.len()];
    for index in order {
        let instance = u8::try_from(index + 1).unwrap_or(0);
        let extent = subjects[index].draw(&mut canvas, camera, instance);
        extents[index] = extent.map(|extent| (extent, canvas.pixels_of(instance)));
    }
    let (image, instances) = canvas.finish();
    let mut seen = [0_usize; 256];
    instances.iter().for_each(|instance| seen[usize::from(*instance)] += 1);
    let drawn =
        subjects.iter().zip(extents).enumerate().filter_map(|(index, (subject, extent))| {
            let (extent, pixels) = extent?;
            let visible =
                seen.get(index + 1).map_or(0.0, |seen| *seen as f64 / pixels.max(1) as f64);
            let bbox = pixel_box(extent, camera)?;
            Some(Drawn { id: subject.id(), pixels, bbox, visible })
        });
    Picture { drawn: drawn.collect(), image, instances }
}

/// The whole pixels around an extent, inside the rows of the picture.
fn pixel_box(extent: Extent, camera: &Panorama) -> Option<PixelBox> {
    let [left, top, right, bottom] = extent.map(f64::from);
    let rows = f64::from(camera.lens.height_px);
    let (x, y) = (left.floor(), top.floor().max(0.0));
    let bbox = PixelBox { x, y, w: right.ceil() - x, h: bottom.ceil().min(rows) - y };
    bbox.is_proper().then(|| bbox.wrapped(f64::from(camera.lens.width_px)))
}
