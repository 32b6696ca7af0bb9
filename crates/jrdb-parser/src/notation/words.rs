//! Words of the notation that stand for a value by themselves.

use jrdb_types::vocab::{Elevation, Sector};
use jrdb_types::{Attribute, AttributeNotation, Condition, Direction};

/// The condition that a bare word stands for.
pub(super) fn attribute(word: &str) -> Option<Condition> {
    let is_bare = |a: &&Attribute| a.row().notation == AttributeNotation::Word;
    let mut bare = Attribute::ALL.iter().filter(is_bare);
    bare.find_map(|attribute| attribute.value(word)).map(Condition::Attribute)
}

/// The direction that words stand for: `front left`, `up back`.
pub(super) fn direction(words: &str) -> Option<Direction> {
    let level = || Sector::from_word(words).map(Direction::level);
    level().or_else(|| {
        let (elevation, sector) = words.split_once(' ')?;
        let elevation = Elevation::from_word(elevation)?;
        Some(Direction { sector: Sector::from_word(sector)?, elevation })
    })
}
