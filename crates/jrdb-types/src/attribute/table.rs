//! The table of attributes: what can be believed and asked of a person, a row each.
//!
//! A row starts with the type of the attribute's values and the names of its getter and setters; the rest is an
//! [`AttributeRow`](super::AttributeRow).

/// Hands the rows to a macro.
macro_rules! for_each_attribute {
    ($callback:ident) => { $callback! {
        /// Age group.
        Age(crate::vocab::Age) {
            get: age, set: set_age, with: with_age, name: "age", ordered: true,
            exclusive: true, wording: Adjective, notation: Word,
            plural: "ages", sources: &[Labels, Light, LanguageModel],
        }
        /// Gender.
        Gender(crate::vocab::Gender) {
            get: gender, set: set_gender, with: with_gender, name: "gender", ordered: false,
            exclusive: true, wording: Adjective, notation: Word,
            plural: "genders", sources: &[Labels, Light, LanguageModel],
        }
        /// The benchmark's race words.
        Race(crate::vocab::Race) {
            get: race, set: set_race, with: with_race, name: "race", ordered: false,
            exclusive: true, wording: Adjective, notation: Word,
            plural: "races", sources: &[Labels, LanguageModel],
        }
        /// What the body does.
        Action(crate::vocab::Action) {
            get: action, set: set_action, with: with_action, name: "action", ordered: false,
            exclusive: true, wording: Adjective, notation: Word,
            plural: "actions", sources: &[Labels, Light, LanguageModel],
        }
        /// Colour of what it wears above the waist.
        UpperColor(crate::vocab::Color) {
            get: upper_color, set: set_upper_color, with: with_upper_color, name: "upper_color", ordered: false,
            exclusive: false, wording: Followed("above the waist"),
            notation: Key { key: "upper", value: "a colour" },
            plural: "colours of clothes", sources: &[Light],
        }
        /// Colour of what it wears below the waist.
        LowerColor(crate::vocab::Color) {
            get: lower_color, set: set_lower_color, with: with_lower_color, name: "lower_color", ordered: false,
            exclusive: false, wording: Followed("below the waist"),
            notation: Key { key: "lower", value: "a colour" },
            plural: "colours of clothes", sources: &[Light],
        }
        /// What is worn on the head.
        Headwear(crate::vocab::Headwear) {
            get: headwear, set: set_headwear, with: with_headwear, name: "headwear", ordered: false,
            exclusive: true, wording: Followed("on the head"),
            notation: Key { key: "headwear", value: "headwear" },
            plural: "headwear", sources: &[],
        }
    } };
}

pub(super) use for_each_attribute;
