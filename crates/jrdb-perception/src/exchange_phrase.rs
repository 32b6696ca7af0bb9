//! Phrases in exchange files: requests whether a phrase is true of a detection, and their replies.

use jrdb_types::{Detection, FrameId, ImageGeometry};

use crate::exchange::{Exchange, Reply, Request};
use crate::prompts::{bare_phrase, label_in, phrase_question, plain_phrase, yes_no};

/// The request whether a phrase is true of a detection, with the probability as its reply where it
/// is known. `None` for a phrase without words.
#[must_use]
pub fn ask_phrase(
    frame: &FrameId,
    detection: &Detection,
    phrase: &str,
    probability: Option<f64>,
) -> Option<Exchange> {
    let plain = plain_phrase(phrase)?;
    let [yes, no] = ["yes", "no"].map(String::from);
    let request = Request {
        frame: frame.clone(),
        image: None,
        bbox: Some(detection.bbox),
        topic: None,
        prompt: phrase_question(&plain, &detection.category),
        looks: Some(plain),
        sentence: None,
        labels: vec![yes.clone(), no.clone()],
    };
    let told = |p: f64| [(yes, p), (no, 1.0 - p)].into();
    let reply = probability.map(|p| Reply { probabilities: Some(told(p)), ..Reply::default() });
    Some(Exchange { request, reply })
}

/// The probability that a phrase is true of a detection, from the replies; of several the last
/// counts. `None` where no line asks for it, or no reply tells.
#[must_use]
pub fn phrase_probability(
    lines: &[Exchange],
    frame: &FrameId,
    image: ImageGeometry,
    detection: &Detection,
    phrase: &str,
) -> Option<f64> {
    let plain = plain_phrase(phrase)?;
    let is_asked = |line: &&Exchange| {
        let request = &line.request;
        let bbox = request.bbox.and_then(|bbox| image.checked_box(bbox).ok());
        let looks = request.looks.as_deref().and_then(plain_phrase);
        request.frame == *frame
            && bbox == Some(detection.bbox)
            && looks.is_some_and(|looks| bare_phrase(&looks) == bare_phrase(&plain))
    };
    let replies = lines.iter().filter(is_asked).filter_map(|line| line.reply.as_ref());
    replies.filter_map(probability_of_yes).next_back()
}

/// What a reply makes of yes: its share of the probabilities, or certainty from words.
fn probability_of_yes(reply: &Reply) -> Option<f64> {
    let labels = yes_no();
    if let Some(told) = &reply.probabilities {
        let of = |spellings: &Vec<String>| -> f64 {
            let known = spellings.iter().filter_map(|one| told.get(one));
            known.filter(|p| p.is_finite()).map(|p| p.clamp(0.0, 1.0)).sum()
        };
        let [yes, no] = [of(&labels[0]), of(&labels[1])];
        return (yes + no > 0.0).then(|| yes / (yes + no));
    }
    // An answer such as "No, yes would be wrong" names both and tells nothing.
    let named = |index: usize| label_in(reply.text.as_deref()?, &labels[index..=index]);
    match (named(0), named(1)) {
        (Some(_), None) => Some(1.0),
        (None, Some(_)) => Some(0.0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use jrdb_types::{EntityId, PixelBox};

    use super::*;
    use crate::exchange::replay;

    const IMAGE: ImageGeometry = ImageGeometry { width_px: 100, height_px: 50, wraps: true };

    fn person() -> Detection {
        let bbox = PixelBox::from([10.0, 5.0, 8.0, 20.0]);
        Detection::new(EntityId::new("person", 1), "person", 0.9, bbox)
    }

    fn asked(line: &Exchange, phrase: &str) -> Option<f64> {
        let text = serde_json::to_string(line).unwrap();
        let lines = Exchange::read_lines(&text).unwrap();
        phrase_probability(&lines, &FrameId::default(), IMAGE, &person(), phrase)
    }

    #[test]
    fn what_was_recorded_is_replayed_in_any_wording_of_the_beginning() {
        let line = ask_phrase(&FrameId::default(), &person(), "a Striped shirt", Some(0.75));
        let line = line.unwrap();
        assert_eq!(line.request.looks.as_deref(), Some("a striped shirt"));
        assert_eq!(asked(&line, "wearing a striped shirt"), Some(0.75));
        assert_eq!(asked(&line, "dotted shirt"), None);
    }

    #[test]
    fn a_request_without_a_usable_reply_tells_nothing() {
        let line = ask_phrase(&FrameId::default(), &person(), "glasses", None).unwrap();
        assert_eq!(asked(&line, "glasses"), None);
        let say = |text: &str| {
            let reply = Reply { text: Some(text.into()), ..Reply::default() };
            asked(&Exchange { reply: Some(reply), ..line.clone() }, "glasses")
        };
        assert_eq!((say("Yes, she does."), say("no")), (Some(1.0), Some(0.0)));
        assert_eq!((say("I cannot tell."), say("yes and no")), (None, None));
        let empty = Reply { probabilities: Some([].into()), ..Reply::default() };
        assert_eq!(asked(&Exchange { reply: Some(empty), ..line }, "glasses"), None);
    }

    #[test]
    fn phrases_change_no_detection() {
        let find = Exchange::record(
            &jrdb_types::Detections::new(FrameId::default(), IMAGE, vec![person()]),
            &[],
        );
        let asked = ask_phrase(&FrameId::default(), &person(), "glasses", None).unwrap();
        let with = [find.clone(), vec![asked]].concat();
        let frame = FrameId::default();
        assert_eq!(replay(&with, &frame, IMAGE), replay(&find, &frame, IMAGE));
    }
}
