//! Boxes with categories, and detections numbered from them.

use jrdb_types::detection::PERSON;
use jrdb_types::{Detection, EntityId, PixelBox};

/// A box with the category of what it shows.
#[derive(Debug, Clone, PartialEq)]
pub struct CategoryBox {
    /// Pixels of the image.
    pub bbox: PixelBox,
    /// Confidence in `[0, 1]`.
    pub score: f64,
    /// `person`, or the name of an object.
    pub category: String,
}

/// Words for people; a label that is one of them becomes `person`.
const PEOPLE: [&str; 11] = [
    "person",
    "people",
    "man",
    "woman",
    "boy",
    "girl",
    "child",
    "human",
    "pedestrian",
    "men",
    "women",
];

/// `person` for every word for people, else the label in lower case without the rest of a tag.
pub(crate) fn category(label: &str) -> String {
    let words = label.rsplit('>').next().unwrap_or_default().trim().to_lowercase();
    if PEOPLE.contains(&words.as_str()) { PERSON.into() } else { words }
}

/// Detections, people first, each category numbered from left to right.
pub(crate) fn numbered(mut found: Vec<CategoryBox>) -> Vec<Detection> {
    found.sort_by(|a, b| {
        let kinds = (a.category != PERSON).cmp(&(b.category != PERSON));
        let kinds = kinds.then(a.category.cmp(&b.category));
        kinds.then(a.bbox.x.total_cmp(&b.bbox.x)).then(a.bbox.y.total_cmp(&b.bbox.y))
    });
    let mut number = 0;
    let mut last = String::new();
    let detection = |CategoryBox { bbox, score, category }: CategoryBox| {
        number = if category == last { number + 1 } else { 1 };
        last.clone_from(&category);
        Detection::new(EntityId::new(&category, number), category, score, bbox)
    };
    let mut detections: Vec<Detection> = found.into_iter().map(detection).collect();
    detections.sort_by(|a, b| a.id.cmp(&b.id));
    detections
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_for_people_are_persons_and_rests_of_tags_are_nothing() {
        assert_eq!(
            ["Man", "loc_4>person", "Chair ", "sep>"].map(category),
            ["person", "person", "chair", ""]
        );
    }

    #[test]
    fn people_and_things_are_numbered_each_from_left_to_right() {
        let at = |x: f64, category: &str| CategoryBox {
            bbox: PixelBox::from([x, 0.0, 5.0, 5.0]),
            score: 0.5,
            category: category.into(),
        };
        let found = numbered(vec![at(9.0, "chair"), at(30.0, "person"), at(10.0, "person")]);
        let ids: Vec<String> = found.iter().map(|d| d.id.to_string()).collect();
        assert_eq!(ids, ["chair:1", "person:1", "person:2"]);
        assert_eq!(found[1].bbox.x, 10.0);
    }
}
