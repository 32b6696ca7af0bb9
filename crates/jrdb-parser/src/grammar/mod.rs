//! The productions of the grammar.

mod clause;
mod clothes;
mod coordination;
mod distribution;
mod interaction;
mod noun;
mod number;
mod place;
mod possession;
mod predicate;
mod question;
mod subject;
mod superlative;
mod time;
mod wh;
