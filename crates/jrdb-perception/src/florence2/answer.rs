//! Reads Florence-2's answers: words and location tags to boxes, polygons and labels.
//!
//! The rules are the reference implementation's, oddities included: a label is whatever stands
//! before its locations, even the rest of a tag. Coordinates stay fractions of a pixel, where the
//! reference cuts them to whole ones.

use super::location::BINS;

/// How an answer is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grammar {
    /// Words.
    Text,
    /// A label and four locations, or several times four.
    LabelledBoxes,
    /// Four locations.
    Boxes,
    /// As [`Grammar::LabelledBoxes`]; labels that point to nothing in particular ("it") are left
    /// out.
    GroundedPhrases,
    /// As [`Grammar::LabelledBoxes`], or labels with polygons if there is a `<poly>`.
    BoxesOrPolygons,
    /// Polygons without a label.
    Polygons,
    /// Words and the four corners of each.
    Quads,
}

/// The content of an answer. Coordinates are pixels of the picture.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// Words.
    Text(String),
    /// Boxes by their corners x0, y0, x1, y1. They are as the model wrote them and may be inverted
    /// or empty.
    Boxes(Vec<Labelled<[f64; 4]>>),
    /// Outlines, each of one or several polygons of x, y pairs.
    Polygons(Vec<Labelled<Vec<Vec<f64>>>>),
    /// The corners x, y of writing.
    Quads(Vec<Labelled<[f64; 8]>>),
}

/// A location with its label.
#[derive(Debug, Clone, PartialEq)]
pub struct Labelled<T> {
    /// Its name; empty where answers carry none.
    pub label: String,
    /// Where.
    pub place: T,
}

impl Grammar {
    /// Reads an answer about a picture of this size. `no_phrases` are labels that do not count as
    /// grounded phrases.
    #[must_use]
    pub fn read(self, text: &str, size_px: [f64; 2], no_phrases: &[String]) -> Answer {
        let text =
            ["<s>", "</s>", "<pad>"].iter().fold(text.to_owned(), |t, tag| t.replace(tag, ""));
        let px = |(axis, bin): (usize, u32)| (f64::from(bin) + 0.5) * size_px[axis % 2] / BINS;
        let places =
            |bins: &[u32]| -> Vec<f64> { bins.iter().copied().enumerate().map(px).collect() };
        match self {
            Self::Text => Answer::Text(text),
            Self::Boxes => Answer::Boxes(corners("", &places(&bare_locations(&text, 4)))),
            Self::LabelledBoxes => Answer::Boxes(boxes(&text, places, &[])),
            Self::GroundedPhrases => Answer::Boxes(boxes(&text, places, no_phrases)),
            Self::BoxesOrPolygons if text.contains("<poly>") => {
                Answer::Polygons(labelled_polygons(&text, places))
            }
            Self::BoxesOrPolygons => Answer::Boxes(boxes(&text, places, &[])),
            Self::Polygons => Answer::Polygons(bare_polygons(&text, places)),
            Self::Quads => Answer::Quads(quads(&text, places)),
        }
    }
}

/// A label and the tags behind it.
struct Run<'t> {
    label: String,
    tags: &'t str,
}

/// Everything of the form "words, then at least `least` tags of these kinds".
fn runs<'t>(text: &'t str, least: usize, is_tag: impl Fn(&str) -> bool) -> Vec<Run<'t>> {
    let (mut found, mut rest) = (Vec::new(), text);
    while let Some(start) = rest.find(|c| c != '<') {
        let words = &rest[start..];
        let end = words.find('<').unwrap_or(words.len());
        let (length, count) = tags(&words[end..], &is_tag);
        if count >= least {
            let label = words[..end].trim().chars().filter(char::is_ascii).collect();
            found.push(Run { label, tags: &words[end..end + length] });
        }
        rest = &words[if count >= least { end + length } else { end }..];
    }
    found
}

/// Length and number of the tags at the beginning.
fn tags(text: &str, is_tag: &impl Fn(&str) -> bool) -> (usize, usize) {
    let (mut length, mut count) = (0, 0);
    while let Some(tag) = text[length..].strip_prefix('<').and_then(|rest| rest.split_once('>')) {
        if !is_tag(tag.0) {
            break;
        }
        length += tag.0.len() + 2;
        count += 1;
    }
    (length, count)
}

/// The number of a location tag, without its brackets.
fn location(tag: &str) -> Option<u32> {
    let digits = tag.strip_prefix("loc_")?;
    digits.bytes().all(|byte| byte.is_ascii_digit()).then(|| digits.parse().ok())?
}

fn is_location(tag: &str) -> bool {
    location(tag).is_some()
}

fn is_outline(tag: &str) -> bool {
    is_location(tag) || matches!(tag, "sep" | "poly" | "/poly")
}

/// The numbers of all location tags.
fn locations(tags: &str) -> Vec<u32> {
    tags.split('<').filter_map(|tag| location(tag.split_once('>')?.0)).collect()
}

/// The numbers of location tags that come in groups of `size`, wherever they are.
fn bare_locations(text: &str, size: usize) -> Vec<u32> {
    let (mut found, mut rest) = (Vec::new(), text);
    while let Some(start) = rest.find('<') {
        rest = &rest[start..];
        let (length, count) = tags(rest, &is_location);
        found.extend(locations(&rest[..length]).into_iter().take(count / size * size));
        rest = &rest[length.max(1)..];
    }
    found
}

fn corners(label: &str, places: &[f64]) -> Vec<Labelled<[f64; 4]>> {
    let (groups, _) = places.as_chunks::<4>();
    groups.iter().map(|place| Labelled { label: label.into(), place: *place }).collect()
}

fn boxes(
    text: &str,
    places: impl Fn(&[u32]) -> Vec<f64>,
    no_phrases: &[String],
) -> Vec<Labelled<[f64; 4]>> {
    runs(text, 4, is_location)
        .iter()
        .filter(|run| !no_phrases.contains(&run.label))
        .flat_map(|run| corners(&run.label, &places(&locations(run.tags))))
        .collect()
}

fn labelled_polygons(
    text: &str,
    places: impl Fn(&[u32]) -> Vec<f64>,
) -> Vec<Labelled<Vec<Vec<f64>>>> {
    let outlines = |run: &Run<'_>| -> Vec<Labelled<Vec<Vec<f64>>>> {
        let parts: Vec<&str> = if run.tags.contains("<poly>") && run.tags.contains("</poly>") {
            let inside = |part: &'_ str| part.find("</poly>");
            run.tags.split("<poly>").filter_map(|part| Some(&part[..inside(part)?])).collect()
        } else {
            vec![run.tags]
        };
        let outline =
            |part: &str| Labelled { label: run.label.clone(), place: polygons(part, &places) };
        parts.into_iter().map(outline).collect()
    };
    runs(text, 4, is_outline).iter().flat_map(outlines).collect()
}

fn bare_polygons(text: &str, places: impl Fn(&[u32]) -> Vec<f64>) -> Vec<Labelled<Vec<Vec<f64>>>> {
    let (mut found, mut rest) = (Vec::new(), text);
    while let Some(start) = rest.find('<') {
        rest = &rest[start..];
        let (length, count) = tags(rest, &is_outline);
        if count >= 4 {
            let place = polygons(&rest[..length], &places);
            found.push(Labelled { label: String::new(), place });
        }
        rest = &rest[length.max(1)..];
    }
    found
}

/// Polygons with a separator between them; a last number without partner is dropped.
fn polygons(tags: &str, places: &impl Fn(&[u32]) -> Vec<f64>) -> Vec<Vec<f64>> {
    let polygon = |part: &str| {
        let bins = locations(part);
        places(&bins[..bins.len() / 2 * 2])
    };
    tags.split("<sep>").map(polygon).filter(|polygon| !polygon.is_empty()).collect()
}

fn quads(text: &str, places: impl Fn(&[u32]) -> Vec<f64>) -> Vec<Labelled<[f64; 8]>> {
    let quad = |run: Run<'_>| {
        let place = *places(&locations(run.tags)).first_chunk::<8>()?;
        Some(Labelled { label: run.label, place })
    };
    runs(text, 8, is_location).into_iter().filter_map(quad).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn labels_hold_for_every_box_behind_them() {
        let text = "</s><s>person<loc_0><loc_0><loc_499><loc_999><loc_1><loc_2><loc_3><loc_4></s>";
        let Answer::Boxes(found) = Grammar::LabelledBoxes.read(text, [2000.0, 1000.0], &[]) else {
            panic!("boxes were asked for")
        };
        let labels: Vec<&str> = found.iter().map(|b| b.label.as_str()).collect();
        assert_eq!(labels, ["person", "person"]);
        assert_eq!(found[0].place, [1.0, 0.5, 999.0, 999.5]);
    }

    #[test]
    fn phrases_that_point_to_nothing_are_no_answer() {
        let text = "a man<loc_1><loc_2><loc_3><loc_4>it<loc_1><loc_2><loc_3><loc_4>";
        let Answer::Boxes(found) =
            Grammar::GroundedPhrases.read(text, [10.0, 10.0], &["it".into()])
        else {
            panic!("boxes were asked for")
        };
        assert_eq!(found.len(), 1);
    }

    proptest! {
        #[test]
        fn any_text_is_read(parts in proptest::collection::vec(prop_oneof![
            Just("<loc_1>".to_owned()), Just("<loc_999>".to_owned()), Just("<poly>".to_owned()), Just("</poly>".to_owned()),
            Just("<sep>".to_owned()), Just("<".to_owned()), Just(">".to_owned()), Just("<loc_99999999999>".to_owned()), "\\PC{0,4}"], 0..30)) {
            use Grammar::*;
            let text = parts.concat();
            for grammar in [Text, LabelledBoxes, Boxes, GroundedPhrases, BoxesOrPolygons, Polygons, Quads] {
                let _ = grammar.read(&text, [3760.0, 480.0], &[]);
            }
        }
    }
}
