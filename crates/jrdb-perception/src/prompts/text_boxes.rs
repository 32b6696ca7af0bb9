//! Boxes in the words of vision-language models, whatever their notation.

use super::json_boxes::{JsonBox, json_boxes};
use crate::detector::PerceptionError;

/// What stands around the corners of a box.
const MARKS: [(&str, &str); 2] = [("<box>", "</box>"), ("<|box_start|>", "<|box_end|>")];
/// What stands around the name in front of it.
const NAMES: [(&str, &str); 2] =
    [("<ref>", "</ref>"), ("<|object_ref_start|>", "<|object_ref_end|>")];

/// Reads the boxes of an answer: between marks, as InternVL (`<box>[[x0, y0, x1, y1]]</box>`), Ovis
/// and Qwen-VL (`<box>(x0,y0),(x1,y1)</box>`) write them, or else as JSON. `scale` converts the
/// numbers to pixels of the original picture, along x and y.
///
/// # Errors
/// [`PerceptionError::File`] if the answer has neither marks nor JSON.
///
/// ```
/// use jrdb_perception::prompts::text_boxes;
/// let answer = "<ref>the man</ref><box>[[100, 0, 200, 500]]</box>";
/// let found = text_boxes(answer, [3.76, 0.48]).unwrap();
/// assert_eq!((found[0].label.as_str(), found[0].corners), ("the man", [376.0, 0.0, 752.0, 240.0]));
/// ```
pub fn text_boxes(answer: &str, scale: [f64; 2]) -> Result<Vec<JsonBox>, PerceptionError> {
    match MARKS.iter().find(|(start, _)| answer.contains(start)) {
        Some(marks) => Ok(marked_boxes(answer, *marks, scale)),
        None => json_boxes(answer, scale),
    }
}

fn marked_boxes(answer: &str, (start, end): (&str, &str), scale: [f64; 2]) -> Vec<JsonBox> {
    let mut found = Vec::new();
    let mut parts = answer.split(start);
    let mut before = parts.next().unwrap_or_default();
    for part in parts {
        let (inside, after) = part.split_once(end).unwrap_or((part, ""));
        let label = name_in(before);
        let numbers = numbers_in(inside);
        let scaled = |corners: &[f64; 4]| std::array::from_fn(|at| corners[at] * scale[at % 2]);
        let boxes = numbers.as_chunks::<4>().0.iter().map(scaled);
        found.extend(boxes.map(|corners| JsonBox { label: label.into(), corners }));
        before = after;
    }
    found
}

/// The last name in a text; empty if it has none.
fn name_in(text: &str) -> &str {
    let inside = |(start, end): &(&str, &str)| {
        let (_, from) = text.rsplit_once(start)?;
        Some(from.split_once(end)?.0.trim())
    };
    NAMES.iter().find_map(inside).unwrap_or_default()
}

fn numbers_in(text: &str) -> Vec<f64> {
    let is_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-');
    text.split(|c| !is_number(c)).filter_map(|word| word.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(answer: &str) -> Vec<(String, [f64; 4])> {
        let found = text_boxes(answer, [1.0, 10.0]).unwrap();
        found.into_iter().map(|one| (one.label, one.corners)).collect()
    }

    #[test]
    fn every_notation_is_read() {
        let one = |label: &str| vec![(label.to_owned(), [1.0, 20.0, 3.5, 40.0])];
        assert_eq!(read("It is <box>(1, 2), (3.5,4)</box>."), one(""));
        assert_eq!(read("<ref>a man</ref><box>[[1,2,3.5,4]]</box>"), one("a man"));
        let qwen = "<|object_ref_start|>he<|object_ref_end|><|box_start|>(1,2),(3.5,4)<|box_end|>";
        assert_eq!(read(qwen), one("he"));
        assert_eq!(read(r#"[{"bbox_2d": [1, 2, 3.5, 4], "label": "she"}]"#), one("she"));
        assert_eq!(read("[[1, 2, 3.5, 4]]"), one(""));
        assert_eq!(read("[1, 2, 3.5, 4]"), one(""));
    }

    #[test]
    fn several_boxes_are_read_and_broken_ones_left_out() {
        let two = "<ref>men</ref><box>[[1, 2, 3, 4], [5, 6, 7, 8]]</box> <box>[[1, 2]]</box>";
        assert_eq!(read(two).len(), 2);
        assert_eq!(read("<box>nothing</box>").len(), 0);
        assert!(text_boxes("nobody", [1.0, 1.0]).is_err());
    }
}
