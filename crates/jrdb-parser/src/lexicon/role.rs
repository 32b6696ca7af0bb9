//! The roles of words in the grammar.

/// A list of roles, at most 128: a set of them is one number.
macro_rules! roles {
    ($($(#[doc = $doc:literal])+ $name:ident = $word:literal,)+) => {
        /// The role of a word in the grammar. A word may have several.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub(crate) enum Role { $($(#[doc = $doc])+ $name,)+ }

        impl Role {
            /// The role that a `word` line of the lexicon names.
            pub(super) fn from_word(word: &str) -> Option<Self> {
                match word { $($word => Some(Self::$name),)+ _ => None }
            }
        }
    };
}

roles! {
    /// A word that is in no phrase of the lexicon.
    Unknown = "(unknown)",
    /// Digits, or a word for a number.
    Number = "(number)",
    /// A comma or semicolon.
    Comma = "(comma)",
    /// A slash or backslash between words.
    Slash = "(slash)",
    /// A dash between numbers.
    Dash = "(dash)",
    /// Names a category.
    Noun = "(noun)",
    /// Implies conditions for the entity that it names or describes.
    Implies = "(implies)",
    /// Implies an action of the body; such words also stand behind the noun.
    Action = "(action)",
    /// Relates the subject to a noun behind it.
    Relation = "(relation)",
    /// An interaction with people or an object.
    Interaction = "(interaction)",
    /// A distance in words.
    Far = "(far)",
    /// A sector or an elevation.
    Sector = "(sector)",
    /// "tallest", "leftmost".
    Superlative = "(superlative)",
    /// "taller".
    Comparative = "(comparative)",
    /// "second".
    Ordinal = "(ordinal)",
    /// "metres".
    Unit = "(unit)",
    /// A property that a question can ask for.
    Asks = "(asks)",
    /// Something that no scene graph holds.
    Unsupported = "(unsupported)",
    /// A colour.
    Color = "(color)",
    /// A piece of clothing.
    Garment = "(garment)",
    /// A worn thing that is an attribute of its wearer.
    Worn = "(worn)",
    /// "find".
    Find = "find",
    /// "how many".
    Count = "count",
    /// "do you see".
    Exists = "exists",
    /// "describe".
    Describe = "describe",
    /// "where".
    Where = "where",
    /// "who", "that": begins a clause or a question.
    Who = "who",
    /// "which", "what": begins a question.
    Which = "which",
    /// "what": about objects and people.
    What = "what",
    /// "whose".
    Whose = "whose",
    /// "how", "how old".
    How = "how",
    /// "in order".
    Order = "order",
    /// "doing", "does".
    Doing = "doing",
    /// "the".
    The = "the",
    /// "a", "some".
    A = "a",
    /// "every".
    All = "all",
    /// "no".
    No = "no",
    /// "the one", "those".
    One = "one",
    /// "is".
    Is = "is",
    /// "'s".
    Possessive = "possessive",
    /// "not".
    Not = "not",
    /// "has".
    Has = "has",
    /// "with".
    With = "with",
    /// "without".
    Without = "without",
    /// "neither" and "nor".
    Neither = "neither",
    /// "either".
    Either = "either",
    /// "and".
    And = "and",
    /// "but": except, before a noun.
    But = "but",
    /// "or".
    Or = "or",
    /// "except".
    Except = "except",
    /// "and then".
    Then = "then",
    /// "during".
    During = "during",
    /// "than".
    Than = "than",
    /// "more".
    More = "more",
    /// "fewer".
    Fewer = "fewer",
    /// "of", and "in front of": a noun must follow.
    Of = "of",
    /// "to", "from".
    To = "to",
    /// "at", "on".
    At = "at",
    /// "located".
    Located = "located",
    /// "relative".
    Relative = "relative",
    /// "near".
    Near = "near",
    /// "me".
    Robot = "robot",
    /// "my".
    My = "my",
    /// "his".
    His = "his",
    /// "him".
    Him = "him",
    /// "it": not a person.
    It = "it",
    /// "please".
    Filler = "filler",
    /// "side", "distance", "away": part of a place, without meaning of its own.
    Side = "side",
    /// "within", "at least", "exactly": limits a number.
    Limit = "(limit)",
    /// "several": two or more.
    Several = "several",
    /// "between".
    Between = "between",
    /// "in a group of".
    Group = "group",
    /// "each other".
    EachOther = "each-other",
    /// "seconds".
    Seconds = "seconds",
    /// "o'clock".
    Clock = "clock",
    /// "nd" of "2nd".
    Suffix = "suffix",
    /// "if".
    If = "if",
    /// "non" of "non-seated".
    Non = "non",
    /// "among": followed by the candidates.
    Among = "among",
    /// "radius".
    Radius = "radius",
    /// "degrees".
    Degrees = "degrees",
    /// "last", "second to last": counted from the other end.
    Last = "last",
    /// "towards": where a walk leads.
    Towards = "towards",
    /// A plural noun or verb.
    Plural = "plural",
    /// A singular noun or verb.
    Singular = "singular",
    /// "uh": dropped wherever it stands.
    Noise = "noise",
    /// "dark": before a colour, or a colour word that is read as another.
    Shade = "shade",
    /// "coloured" behind a colour.
    Coloured = "coloured",
    /// "colour": of a garment, where a question asks for it.
    Colour = "colour",
    /// "all", "entirely" before a colour: of everything that is worn.
    Wholly = "wholly",
    /// "on" behind what is worn.
    On = "on",
    /// "something": any garment, with a colour.
    Something = "something",
    /// Describes what can be looked at, without a table for it.
    Looks = "looks",
    /// A deed that can be looked at, without a table for it.
    Deed = "deed",
    /// A part of the body, which only a longer description says something with.
    Body = "body",
    /// "other", "else": none of those spoken of before.
    Other = "other",
    /// A room or place that no scene graph holds.
    Room = "room",
    /// "most of".
    Most = "most-of",
    /// "half of".
    Half = "half-of",
    /// "neither of", "none of the".
    NoneOf = "none-of",
    /// "#", "number": before the number of a thing.
    IdMark = "id",
    /// "point of view".
    View = "view",
    /// "from where I am": as the robot sees it.
    RobotView = "robot-view",
    /// "right?" behind a statement.
    Tag = "tag",
    /// A verb that tells the robot to do something.
    Command = "command",
    /// "say": what is to be said follows.
    Speech = "speech",
    /// "apart".
    Apart = "apart",
    /// "by" of a passive.
    By = "by",
    /// A common word without a role in questions.
    Common = "common",
}

/// A set of roles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Roles(u128);

impl Roles {
    /// The set of these.
    pub(crate) const fn of(roles: &[Role]) -> Self {
        let (mut bits, mut at) = (0, 0);
        while at < roles.len() {
            bits |= 1 << roles[at] as u64;
            at += 1;
        }
        Self(bits)
    }

    pub(crate) const fn has(self, role: Role) -> bool {
        self.0 >> role as u64 & 1 == 1
    }

    pub(crate) const fn has_any(self, roles: Self) -> bool {
        self.0 & roles.0 != 0
    }

    /// The roles of both sets.
    pub(crate) const fn and(self, roles: Self) -> Self {
        Self(self.0 | roles.0)
    }

    /// The set without the number of a noun: "woman" and "women" mean the same.
    pub(super) const fn of_meaning(self) -> Self {
        Self(self.0 & !(1 << Role::Plural as u64 | 1 << Role::Singular as u64))
    }

    pub(super) fn insert(&mut self, role: Role) {
        self.0 |= 1 << role as u64;
    }
}
