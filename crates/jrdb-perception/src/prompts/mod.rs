//! Questions about a person or an object in words, and how answers in words are read.
//!
//! Every model that answers in words shares them: the vision-language models of this crate, and the
//! models behind an [exchange file](crate::exchange).

mod json_boxes;
mod phrase;
mod question;
mod reply;
mod text_boxes;

pub use json_boxes::{JsonBox, json_boxes};
pub use phrase::{bare_phrase, phrase_question, plain_phrase, yes_no};
pub use question::{Question, Topic, questions};
pub(crate) use question::{believed, put};
pub use reply::label_in;
pub use text_boxes::text_boxes;
