//! Which boxes can be used, whatever file they come from.

use jrdb_types::{EntityId, ImageGeometry, PixelBox};

/// The prefixes and class names that mean a person.
const PEOPLE: [&str; 2] = ["pedestrian", jrdb_types::detection::PERSON];

/// The box with `x` inside a wrapping image, or what is wrong with it.
pub(crate) fn checked(bbox: PixelBox, image: ImageGeometry) -> Result<PixelBox, String> {
    image.checked_box(bbox).map_err(|error| error.to_string())
}

/// The category of a class name: people have one name, everything else its own.
pub(crate) fn category_of_class(class: &str) -> String {
    let class = if PEOPLE.contains(&class) { jrdb_types::detection::PERSON } else { class };
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
    }
}
