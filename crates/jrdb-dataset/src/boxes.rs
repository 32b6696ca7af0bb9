//! Which boxes can be used, whatever file they come from.

use jrdb_types::{EntityId, ImageGeometry, PixelBox};

/// Class names that mean a person, in small letters with blanks.
const PEOPLE: [&str; 9] = [
    "pedestrian",
    "pedestrians",
    jrdb_types::detection::PERSON,
    "persons",
    "people",
    "human",
    "humans",
    "person sitting",
    "type pedestrian",
];

/// What nuScenes' and other class names with parts start with when they mean a person.
const PEOPLE_PARTS: [&str; 3] = ["human.pedestrian", "pedestrian.", "person."];

/// Whether a class name means a person, in whatever case it is written.
pub(crate) fn is_person(class: &str) -> bool {
    let class = class.trim().to_lowercase().replace(['_', '-'], " ");
    PEOPLE.contains(&class.as_str()) || PEOPLE_PARTS.iter().any(|part| class.starts_with(part))
}

/// The id with a person's class in small letters, as JRDB writes it.
pub(crate) fn usual_id(id: EntityId) -> EntityId {
    let class = if is_person(&id.class) { id.class.trim().to_lowercase() } else { id.class };
    EntityId { class, ..id }
}

/// The box with `x` inside a wrapping image, or what is wrong with it.
pub(crate) fn checked(bbox: PixelBox, image: ImageGeometry) -> Result<PixelBox, String> {
    image.checked_box(bbox).map_err(|error| error.to_string())
}

/// The category of a class name: people have one name, everything else its own.
pub(crate) fn category_of_class(class: &str) -> String {
    let class = if is_person(class) { jrdb_types::detection::PERSON } else { class.trim() };
    class.into()
}

/// The category that an id's class stands for.
pub(crate) fn category(id: &EntityId) -> String {
    category_of_class(&id.class)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_wrapping_image_has_no_sides() {
        let panorama = ImageGeometry { width_px: 100, height_px: 50, wraps: true };
        let picture = ImageGeometry { wraps: false, ..panorama };
        let outside = PixelBox::from([-30.0, 0.0, 20.0, 20.0]);
        assert_eq!(checked(outside, panorama), Ok(PixelBox { x: 70.0, ..outside }));
        assert_eq!(
            checked(outside, picture),
            Err("expected a box inside 100 x 50 pixels, found [-30.0, 0.0, 20.0, 20.0]".into())
        );
        let over_the_edge = PixelBox { x: -10.0, ..outside };
        assert_eq!(checked(over_the_edge, picture), Ok(over_the_edge));
    }

    #[test]
    fn pedestrians_are_people() {
        assert_eq!(category(&EntityId::new("pedestrian", 1)), "person");
        assert_eq!(category(&EntityId::new("table", 1)), "table");
        for class in
            ["Person", "PEDESTRIAN", "people", "human ", "human.pedestrian.adult", "Person_sitting"]
        {
            assert_eq!(category_of_class(class), "person", "{class}");
        }
        for class in ["personal computer", "humanoid robot", "Dog"] {
            assert_eq!(category_of_class(class), class);
        }
        let id = usual_id(EntityId::new("Pedestrian", 3));
        assert_eq!(id, EntityId::new("pedestrian", 3));
    }
}
