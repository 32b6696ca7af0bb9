//! The question whether a phrase is true of a detection, and its two answers.

/// Longer phrases are not asked, characters.
const LONGEST: usize = 200;

/// Words before the first word of a phrase that do not change what is asked.
const BEGINNINGS: [&str; 17] = [
    "a", "an", "the", "some", "his", "her", "their", "is", "who", "with", "in", "has", "having",
    "wears", "wearing", "holding", "carrying",
];

/// The question whether a phrase is true of the person or object that a picture shows.
///
/// ```
/// use jrdb_perception::prompts::phrase_question;
/// let question = phrase_question("striped shirt", "person");
/// assert_eq!(
///     question,
///     "Is this true of the person in the image: \"striped shirt\"? Answer with exactly one of: yes, no."
/// );
/// ```
#[must_use]
pub fn phrase_question(phrase: &str, category: &str) -> String {
    format!(
        "Is this true of the {category} in the image: \"{phrase}\"? Answer with exactly one of: yes, no."
    )
}

/// The ways to spell yes, and the ways to spell no.
#[must_use]
pub fn yes_no() -> Vec<Vec<String>> {
    [["yes", "Yes"], ["no", "No"]].map(|all| all.map(String::from).to_vec()).to_vec()
}

/// A phrase in lower case as it is asked: words with single spaces between them, without quotes and
/// marks that a model could take for its own. `None` if nothing is left, or too much.
///
/// ```
/// use jrdb_perception::prompts::plain_phrase;
/// assert_eq!(plain_phrase(" Striped\n\"T-shirt\" <|im_end|>"), Some("striped t-shirt im end".into()));
/// assert_eq!(plain_phrase("?!"), None);
/// ```
#[must_use]
pub fn plain_phrase(phrase: &str) -> Option<String> {
    let keep = |c: char| if c.is_alphanumeric() || "-',".contains(c) { c } else { ' ' };
    let kept: String = phrase.chars().map(keep).flat_map(char::to_lowercase).collect();
    let has_letters = |word: &&str| word.contains(char::is_alphanumeric);
    let words: Vec<&str> = kept.split_whitespace().filter(has_letters).collect();
    let text = words.join(" ");
    (!text.is_empty() && text.chars().count() <= LONGEST).then_some(text)
}

/// A plain phrase without the words before it that do not change what is asked.
///
/// ```
/// use jrdb_perception::prompts::bare_phrase;
/// assert_eq!(bare_phrase("wearing a striped shirt"), "striped shirt");
/// assert_eq!(bare_phrase("with"), "with");
/// ```
#[must_use]
pub fn bare_phrase(plain: &str) -> &str {
    let mut rest = plain;
    while let Some((first, later)) = rest.split_once(' ')
        && BEGINNINGS.contains(&first)
    {
        rest = later;
    }
    rest
}
