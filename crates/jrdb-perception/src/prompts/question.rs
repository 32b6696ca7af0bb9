//! Questions about a person, and the accepted answers.

use jrdb_types::vocab::{Action, Age, Facing, Gender, Race};
use jrdb_types::{Attribute, Attributes, Belief};
use serde::{Deserialize, Serialize};

/// An attribute that a question asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Topic {
    /// Gender, as it looks.
    Gender,
    /// Age group, as it looks.
    Age,
    /// The benchmark's race words, as they look.
    Race,
    /// The action of the body.
    Action,
    /// Which way the front points in the picture.
    Facing,
}

impl Topic {
    /// All topics, in the order of the questions.
    pub const ALL: [Self; 5] = [Self::Gender, Self::Age, Self::Race, Self::Action, Self::Facing];

    /// The attribute that is asked for; facing is not one.
    #[must_use]
    pub fn attribute(self) -> Option<Attribute> {
        match self {
            Self::Gender => Some(Attribute::Gender),
            Self::Age => Some(Attribute::Age),
            Self::Race => Some(Attribute::Race),
            Self::Action => Some(Attribute::Action),
            Self::Facing => None,
        }
    }

    /// Whether the attribute describes the identity of a person rather than an action. Such
    /// questions are asked only on request.
    #[must_use]
    pub fn is_demographic(self) -> bool {
        matches!(self, Self::Gender | Self::Age | Self::Race)
    }
}

/// A question with a closed list of answers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Question {
    /// The attribute.
    pub topic: Topic,
    /// The question, and the words from which to answer.
    pub text: String,
    /// For each word of the vocabulary, in its order, the ways to spell it. The first is the one in
    /// the question.
    pub labels: Vec<Vec<String>>,
}

/// The questions on some topics.
#[must_use]
pub fn questions(topics: &[Topic]) -> Vec<Question> {
    topics.iter().map(|topic| question(*topic)).collect()
}

fn question(topic: Topic) -> Question {
    let labels: Vec<Vec<String>> =
        spellings(topic).iter().map(|all| all.iter().map(|&one| one.into()).collect()).collect();
    let listed: Vec<&str> = labels.iter().map(|all| all[0].as_str()).collect();
    let text = format!("{} Answer with exactly one of: {}.", asked(topic), listed.join(", "));
    Question { topic, text, labels }
}

fn asked(topic: Topic) -> &'static str {
    match topic {
        Topic::Gender => "What is the gender of the person in the image?",
        Topic::Age => "What is the age group of the person in the image?",
        Topic::Race => "What is the perceived race of the person in the image?",
        Topic::Action => "What is the person in the image doing?",
        Topic::Facing => "Which way does the person in the image face, as the camera sees it?",
    }
}

/// Words of each vocabulary, in the order of its `ALL`.
fn spellings(topic: Topic) -> &'static [&'static [&'static str]] {
    match topic {
        Topic::Gender => &[&["male", "man", "boy"], &["female", "woman", "girl"]],
        Topic::Age => &[
            &["child", "kid"],
            &["adolescent", "teenager", "teen"],
            &["young", "young adult"],
            &["middle-aged", "middle aged"],
            &["elderly", "old"],
        ],
        Topic::Race => {
            &[&["White", "white", "Caucasian"], &["Black", "black"], &["Asian", "asian"]]
        }
        Topic::Action => &[
            &["walking"],
            &["standing"],
            &["sitting", "seated"],
            &["bending"],
            &["running", "jogging"],
            &["cycling", "riding a bicycle"],
            &["going up", "going upstairs"],
            &["going down", "going downstairs"],
            &["skating", "skateboarding"],
            &["scootering", "riding a scooter"],
        ],
        Topic::Facing => &[
            &["towards", "toward"],
            &["towards left"],
            &["left"],
            &["away left"],
            &["away"],
            &["away right"],
            &["right"],
            &["towards right"],
        ],
    }
}

/// Writes probabilities on a topic into the attributes of a person. `probabilities` are in the
/// order of the vocabulary.
pub(crate) fn put(attributes: &mut Attributes, topic: Topic, probabilities: &[f64]) {
    match topic {
        Topic::Gender => attributes.set_gender(belief(Gender::ALL, probabilities)),
        Topic::Age => attributes.set_age(belief(Age::ALL, probabilities)),
        Topic::Race => attributes.set_race(belief(Race::ALL, probabilities)),
        Topic::Action => attributes.set_action(belief(Action::ALL, probabilities)),
        Topic::Facing => attributes.facing = belief(Facing::ALL, probabilities),
    }
}

/// The probabilities on a topic, in the order of its vocabulary.
pub(crate) fn believed(attributes: &Attributes, topic: Topic) -> Vec<f64> {
    match topic {
        Topic::Gender => of(Gender::ALL, &attributes.gender()),
        Topic::Age => of(Age::ALL, &attributes.age()),
        Topic::Race => of(Race::ALL, &attributes.race()),
        Topic::Action => of(Action::ALL, &attributes.action()),
        Topic::Facing => of(Facing::ALL, &attributes.facing),
    }
}

fn of<T: Ord + Copy>(all: &[T], belief: &Belief<T>) -> Vec<f64> {
    all.iter().map(|value| belief.probability(*value)).collect()
}

/// Probabilities are rounded to this many parts of one, so that engines with different rounding
/// agree.
const PARTS: f64 = 1e4;

fn belief<T: Ord + Copy>(all: &[T], probabilities: &[f64]) -> Belief<T> {
    let told = probabilities.iter().map(|p| (p * PARTS).round() / PARTS);
    Belief(all.iter().copied().zip(told).filter(|(_, p)| *p > 0.0).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_of_every_vocabulary_can_be_answered() {
        let words = [
            Gender::ALL.len(),
            Age::ALL.len(),
            Race::ALL.len(),
            Action::ALL.len(),
            Facing::ALL.len(),
        ];
        let asked = questions(&Topic::ALL);
        assert_eq!(asked.iter().map(|q| q.labels.len()).collect::<Vec<_>>(), words);
        for (word, labels) in Age::ALL.iter().zip(&asked[1].labels) {
            assert_eq!(word.word(), labels[0]);
        }
        assert_eq!(
            asked[0].text,
            "What is the gender of the person in the image? Answer with exactly one of: male, female."
        );
    }

    #[test]
    fn beliefs_are_rounded_and_leave_out_what_is_not_believed() {
        let mut attributes = Attributes::default();
        put(&mut attributes, Topic::Gender, &[0.999_98, 0.000_02]);
        assert_eq!(attributes.gender(), Belief([(Gender::Male, 1.0)].into()));
    }
}
