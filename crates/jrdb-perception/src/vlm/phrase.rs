//! Whether phrases are true of a person or an object, by weighing yes against no on the crop.

use jrdb_types::{Image, Vocabulary};

use super::attribute::VlmAttributes;
use super::memory::Key;
use super::score::{LabelScore, probabilities, shared_beginning};
use crate::detector::{PerceptionError, check_image};
use crate::image::{Wrap, crop};
use crate::phrase::{PhraseModel, Subject};
use crate::prompts::{bare_phrase, phrase_question, plain_phrase, yes_no};

impl VlmAttributes {
    /// The log-likelihoods of the answers to questions about a picture: for each question every
    /// spelling of yes, then every spelling of no.
    ///
    /// The picture is seen and read once for all questions.
    ///
    /// # Errors
    /// When the picture has no pixels or a graph fails.
    pub fn weigh_yes_no(
        &self,
        picture: &Image,
        questions: &[String],
    ) -> Result<Vec<Vec<Vec<LabelScore>>>, PerceptionError> {
        check_image(picture)?;
        if questions.is_empty() {
            return Ok(Vec::new());
        }
        let shown = self.family.show(&self.vlm, picture)?;
        let prompt =
            |question: &String| self.vlm.tokens().encode(&self.family.prompt(question, &shown));
        let prompts = questions.iter().map(prompt).collect::<Result<Vec<_>, _>>()?;
        let shared = shared_beginning(&prompts);
        let beginning = &prompts[0][..shared];
        let places = self.family.places(beginning, &shown);
        let beginning = self.vlm.read(beginning, &shown.features, places.as_deref())?;
        let answers = yes_no();
        let score = |prompt: &Vec<u32>| {
            let read = self.vlm.read_on(&beginning, &prompt[shared..])?;
            self.vlm.score(&read, &answers, self.end)
        };
        prompts.iter().map(score).collect()
    }

    /// The question that a phrase is asked with; `None` where the model cannot judge it.
    fn question(&self, phrase: &str, category: &str) -> Option<String> {
        let plain = plain_phrase(phrase)?;
        let asked = match &self.config.phrases {
            Vocabulary::Open(_) => plain.as_str(),
            Vocabulary::Listed(known) => known.get(bare_phrase(&plain))?,
        };
        Some(phrase_question(asked, &plain_phrase(category)?))
    }

    /// Probabilities of yes, from what was weighed before or now.
    fn probabilities_of_yes(
        &self,
        picture: &Image,
        questions: &[String],
    ) -> Result<Vec<f64>, PerceptionError> {
        let keys = Key::all(picture, questions);
        let unknown: Vec<&Key> = keys.iter().filter(|key| self.memory.get(key).is_none()).collect();
        let asked: Vec<String> = unknown.iter().map(|key| key.question.clone()).collect();
        let scores = self.weigh_yes_no(picture, &asked)?;
        let yes = scores.iter().map(|score| probabilities(score, self.config.temperature)[0]);
        let new: Vec<(Key, f64)> = unknown.into_iter().cloned().zip(yes).collect();
        let of = |key: &Key| {
            let fresh = new.iter().find(|(other, _)| other == key).map(|(_, yes)| *yes);
            fresh.or_else(|| self.memory.get(key)).unwrap_or(HALF)
        };
        let all = keys.iter().map(of).collect();
        self.memory.put(new);
        Ok(all)
    }
}

/// As probable as not.
const HALF: f64 = 0.5;

/// Probabilities are rounded to this many parts of one, so that engines with different rounding
/// agree.
const PARTS: f64 = 1e4;

impl PhraseModel for VlmAttributes {
    fn weigh(
        &self,
        subject: &Subject<'_>,
        phrases: &[&str],
    ) -> Result<Vec<Option<f64>>, PerceptionError> {
        let (detection, nothing) = (subject.detection, vec![None; phrases.len()]);
        let Some(image) = subject.view.image else { return Ok(nothing) };
        check_image(image)?;
        let wrap = Wrap::of(self.config.wraps);
        let Some(picture) = crop(image, &detection.bbox, self.config.margin, wrap) else {
            return Ok(nothing);
        };
        let question = |phrase: &&str| self.question(phrase, &detection.category);
        let questions: Vec<Option<String>> = phrases.iter().map(question).collect();
        let asked: Vec<String> = questions.iter().flatten().cloned().collect();
        let mut yes = self.probabilities_of_yes(&picture, &asked)?.into_iter();
        let decided = |probability: &f64| (probability - HALF).abs() >= self.config.undecided;
        let answer = |question: &Option<String>| {
            let probability = question.as_ref().and_then(|_| yes.next()).filter(decided)?;
            Some((probability * PARTS).round() / PARTS)
        };
        Ok(questions.iter().map(answer).collect())
    }

    fn phrases(&self) -> Vocabulary<String> {
        self.config.phrases.clone()
    }

    fn source(&self) -> String {
        self.family.name().into()
    }
}
