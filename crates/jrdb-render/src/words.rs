//! Words for files: the fields of an answer that other programs read as text.

use jrdb_types::Answer;
use jrdb_types::answer::{Check, Reply};

use crate::{change, check, property};

/// The answer with every field that holds words filled: what was asked and found in each check, the values of properties and the
/// conditions of changes. Writers of artefacts call it; in memory an answer has values only.
#[must_use]
pub fn with_words(mut answer: Answer) -> Answer {
    if let Reply::Properties(all) = &mut answer.reply {
        for of in all {
            of.words = property::words(of);
        }
    }
    answer.trace.iter_mut().flat_map(|trace| &mut trace.checks).for_each(fill);
    for change in &mut answer.sensitivity {
        change.words = change::condition(change);
    }
    answer
}

fn fill(check: &mut Check) {
    check.asked = check::asked(check);
    check.found = check::found(check);
    check.parts.iter_mut().for_each(fill);
}
