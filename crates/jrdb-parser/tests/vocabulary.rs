//! The lexicon knows every class and value of the tables in `jrdb-types`.

use jrdb_parser::{notation, parse};
use jrdb_types::vocab::{Action, Age, Color, Gender, Race};

/// COCO's classes, apart from people.
const COCO: [&str; 79] = [
    "bicycle",
    "car",
    "motorcycle",
    "airplane",
    "bus",
    "train",
    "truck",
    "boat",
    "traffic light",
    "fire hydrant",
    "stop sign",
    "parking meter",
    "bench",
    "bird",
    "cat",
    "dog",
    "horse",
    "sheep",
    "cow",
    "elephant",
    "bear",
    "zebra",
    "giraffe",
    "backpack",
    "umbrella",
    "handbag",
    "tie",
    "suitcase",
    "frisbee",
    "skis",
    "snowboard",
    "sports ball",
    "kite",
    "baseball bat",
    "baseball glove",
    "skateboard",
    "surfboard",
    "tennis racket",
    "bottle",
    "wine glass",
    "cup",
    "fork",
    "knife",
    "spoon",
    "bowl",
    "banana",
    "apple",
    "sandwich",
    "orange",
    "broccoli",
    "carrot",
    "hot dog",
    "pizza",
    "donut",
    "cake",
    "chair",
    "couch",
    "potted plant",
    "bed",
    "dining table",
    "toilet",
    "tv",
    "laptop",
    "mouse",
    "remote",
    "keyboard",
    "cell phone",
    "microwave",
    "oven",
    "toaster",
    "sink",
    "refrigerator",
    "book",
    "clock",
    "vase",
    "scissors",
    "teddy bear",
    "hair drier",
    "toothbrush",
];

/// Classes whose names are rather colours or clothes.
const AMBIGUOUS: [&str; 2] = ["orange", "tie"];

#[test]
fn every_class_of_coco_is_a_thing() {
    let unknown: Vec<&str> = COCO
        .into_iter()
        .filter(|class| !AMBIGUOUS.contains(class))
        .filter(|class| {
            let query = parse(&format!("is there a {class} near me?"));
            let read = notation::write(&query);
            !read.starts_with("exists \"") || !query.issues.is_empty()
        })
        .collect();
    assert!(unknown.is_empty(), "{unknown:?}");
}

#[test]
fn every_value_of_an_attribute_is_a_word() {
    let words = [Age::WORDS, Gender::WORDS, Race::WORDS].concat();
    for word in words {
        assert_eq!(
            notation::write(&parse(&format!("the {word} person"))),
            format!("find person[{word}]")
        );
    }
    for word in Action::WORDS {
        assert_eq!(
            notation::write(&parse(&format!("who is {word}?"))),
            format!("find person[{word}]")
        );
    }
    for word in Color::WORDS {
        let read = notation::write(&parse(&format!("the person in a {word} shirt")));
        assert_eq!(read, format!("find person[upper={word}]"));
    }
}
