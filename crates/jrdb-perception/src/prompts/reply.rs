//! Free answers to the words of a vocabulary.

/// The entry of a vocabulary that an answer names: the longest spelling that occurs in it as whole
/// words, the first of equals.
///
/// ```
/// use jrdb_perception::prompts::label_in;
/// let labels = [vec!["male".into(), "man".into()], vec!["female".into(), "woman".into()]];
/// assert_eq!(label_in("The person is a woman.", &labels), Some(1));
/// assert_eq!(label_in("I cannot tell.", &labels), None);
/// ```
#[must_use]
pub fn label_in(answer: &str, labels: &[Vec<String>]) -> Option<usize> {
    let answer = plain(answer);
    let named = |spelling: &String| {
        let spelling = plain(spelling);
        answer.contains(&spelling).then_some(spelling.len())
    };
    let longest =
        |(index, all): (usize, &Vec<String>)| Some((all.iter().filter_map(named).max()?, index));
    let found = labels.iter().enumerate().filter_map(longest);
    found.max_by_key(|(length, index)| (*length, usize::MAX - index)).map(|(_, index)| index)
}

/// Lower-case words with a space on both sides of each; everything but letters and digits parts
/// words.
fn plain(text: &str) -> String {
    let words = text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let lower: Vec<String> = words.map(str::to_lowercase).collect();
    format!(" {} ", lower.join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prompts::{Topic, questions};

    #[test]
    fn words_inside_words_do_not_count() {
        let asked = questions(&[Topic::Gender, Topic::Race, Topic::Age]);
        assert_eq!(label_in("Female", &asked[0].labels), Some(1));
        assert_eq!(label_in("Caucasian.", &asked[1].labels), Some(0));
        assert_eq!(label_in("a MIDDLE AGED person", &asked[2].labels), Some(3));
        assert_eq!(label_in("a young adult", &asked[2].labels), Some(2));
        assert_eq!(label_in("", &asked[2].labels), None);
    }
}
