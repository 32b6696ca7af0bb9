//! The words that the parser knows, from `lexicon.txt`.

mod english;
mod entry;
mod piece;
mod read;
mod role;
mod table;

use std::sync::LazyLock;

pub(crate) use english::is_english;
pub(crate) use entry::{Entry, Garment, Limit, Measured};
#[cfg(test)]
pub(crate) use piece::Key;
pub(crate) use piece::{Piece, special, split};
pub(crate) use role::{Role, Roles};
pub(crate) use table::Lexicon;

/// The lexicon of the crate.
pub(crate) static LEXICON: LazyLock<Lexicon> =
    LazyLock::new(|| read::read(include_str!("lexicon.txt")).expect("the tests read this file"));
