//! The grammar: recursive descent, one function per production, no backtracking beyond one attempt.
//!
//! Each file extends [`Parser`](crate::parser::Parser) with the productions of one topic. Quotation
//! marks hold words, capitals hold roles of [`Role`](crate::lexicon::Role), `*` repeats, `?` makes
//! optional.
//!
//! ```text
//! question      = request | how | which | who | properties | yes_no | compare_counts | among
//!               | target                                                         question.rs
//! request       = ("find" | "how many" | "where" | "describe") target
//! how, which, who, properties        questions with a question word              wh.rs
//! yes_no        = ("is" | "has" | …) (predicate_of | target)                     question.rs
//! predicate_of  = noun_group place* (complement | clauses)                       subject.rs
//! target        = noun_group clauses (("and" | "or" | ",") noun_group clauses)*  target.rs
//!                 a clause behind the last noun: of all or of the last           distribution.rs
//! noun_group    = determiner* adjective* noun superlative? ("'s" noun)*          noun.rs
//! noun_phrase   = robot | pronoun | noun_group clauses | unknown noun            coordination.rs
//! partners      = noun_phrase (("and" | "or") noun_phrase)*                      coordination.rs
//! clauses       = (joint | object_relative | predicate)*                         clause.rs
//! object_relative = noun_group verb         "(the woman) the man is talking to"  subject.rs
//! predicate     = negation | exception | clothes | activity | relation | location | possession
//!               | comparative | superlative | group | "between" partners | noun  predicate.rs
//! activity      = ACTION | INTERACTION partners?                                 interaction.rs
//! relation      = RELATION partners                                              interaction.rs
//! location      = place reference?                                               location.rs
//! place         = part ("and"? part)*                                            place.rs
//! possession    = ("has" | "with" | "without") noun_group location?              possession.rs
//! clothes       = ("in" | "wearing" | …) (worn | color garment?)                          clothes.rs
//! superlative, comparative, ordinal                                              superlative.rs
//! number, quantity, length                                                       number.rs
//! during, then                                                                   time.rs
//! ```
//!
//! # Contract
//!
//! - **A production that returns `false`, `None` or an empty list has changed nothing**: neither
//!   the state of the parser nor the pattern that it was given. A test runs the main productions at
//!   every word of every test sentence. `true` means that words were consumed and understood or
//!   reported.
//! - `joint` in clause.rs returns `Option<bool>`: none if the word at hand is not a joint,
//!   otherwise whether the clause continues.
//! - To try a reading, take a [`Checkpoint`](crate::parser::Checkpoint) and
//!   [`rewind`](crate::parser::Parser::rewind) to it. This restores the complete
//!   [`State`](crate::parser::State) and drops later issues and slots. Only the note that nesting
//!   was too deep is kept. A production that has only moved the position may set the position back.
//! - Functions named `is_…` and `…_at` only look ahead.
//! - A production appends conditions to the pattern of the entity that it describes. Inside "not"
//!   and behind "or", `conditions` is called instead of `predicates`, so that a superlative becomes
//!   a condition too.
//!
//! # Who describes whom
//!
//! - [`Scope`](crate::phrase::Scope) limits how much of the following text describes a noun: all of
//!   it for the target; up to a joint or verb for a partner.
//! - [`After`](crate::phrase::After) tells a predicate what precedes it. A noun can be a predicate
//!   only behind a verb.
//! - "him" stands for the antecedent: the subject while its partners are read, then the last
//!   partner.
//! - "the one" stands for the last noun. Behind "and" and "or" it stands for the noun that the
//!   question asks for, since it continues the outermost list: "the woman left of the chair and the
//!   one sitting" finds either woman. Exceptions are "between" and "except", whose lists it
//!   continues, and verbs of persons, which cannot describe a chair.
//! - A noun group behind the subject of a yes-or-no question is a condition of the subject, and so
//!   are its alternatives: "is the woman a chair or the one who is sitting" asks about one woman.
//!
//! The productions call each other in a circle, as the phrases of a language contain each other.
//! Everything below this folder is free of cycles: `lexicon`, `suggest`, `token`, `issues`,
//! `pattern`, `phrase` and `parser` do not know any production.

mod adjective;
mod appearance;
mod choice;
mod clause;
mod clothes;
mod command;
mod coordination;
mod discourse;
mod distribution;
mod garment;
mod gesture;
mod interaction;
mod kind;
mod location;
mod noun;
mod number;
mod passive;
mod place;
mod possession;
mod predicate;
mod question;
mod reference;
mod subject;
mod superlative;
mod target;
mod time;
mod view;
mod wh;

#[cfg(test)]
mod tests {
    use jrdb_types::Pattern;

    use crate::parser::Parser;
    use crate::parser::tests::{snapshot, with_parser};
    use crate::phrase::{After, LocationPhrase};

    type Production = fn(&mut Parser<'_>, &mut Pattern) -> bool;

    const PRODUCTIONS: &[(&str, Production)] = &[
        ("predicate behind a verb", |parser, pattern| parser.predicate(pattern, After::Verb)),
        ("predicate behind a noun", |parser, pattern| parser.predicate(pattern, After::Noun)),
        ("predicate of a partner", |parser, pattern| parser.predicate(pattern, After::Partner)),
        ("noun group", |parser, _| parser.noun_group().is_some()),
        ("partners", |parser, pattern| !parser.partners_of(pattern).is_empty()),
        ("location phrase", |parser, pattern| {
            parser.location_phrase(pattern, &mut LocationPhrase::default())
        }),
        ("possession", |parser, pattern| parser.possession(pattern)),
        ("clothes", |parser, pattern| parser.clothes(pattern)),
        ("whose", |parser, pattern| parser.whose(pattern)),
        ("object relative", |parser, pattern| parser.object_relative(pattern)),
        ("during", |parser, _| parser.during()),
        ("quantity", |parser, _| parser.quantity().is_some()),
        ("length", |parser, _| parser.length().is_some()),
        ("number", |parser, _| parser.number().is_some()),
        ("robot", |parser, _| parser.robot().is_some()),
        ("distance reference", |parser, _| parser.distance_reference().is_some()),
    ];

    /// The sentences of the tests.
    fn sentences() -> impl Iterator<Item = &'static str> {
        let lines = include_str!("../../tests/sentences.query").lines();
        lines.filter(|line| !line.is_empty() && !line.starts_with(['#', ' ']))
    }

    #[test]
    fn a_production_that_reads_nothing_changes_nothing() {
        for text in sentences() {
            with_parser(text, |mut parser| {
                parser.set_antecedent(&Pattern::default());
                for at in 0..parser.state.tokens.len() {
                    parser.state.at = at;
                    for (name, production) in PRODUCTIONS {
                        let (before, mut pattern) = (snapshot(&parser), Pattern::default());
                        let checkpoint = parser.checkpoint();
                        if !production(&mut parser, &mut pattern) {
                            assert_eq!(snapshot(&parser), before, "{name} at {at} of {text:?}");
                            assert_eq!(pattern, Pattern::default(), "{name} at {at} of {text:?}");
                        }
                        parser.rewind(checkpoint);
                        assert_eq!(snapshot(&parser), before, "{name} at {at} of {text:?}");
                    }
                }
            });
        }
    }
}
