//! The productions of the grammar.

mod clause;
mod clothes;
mod coordination;
mod distribution;
mod interaction;
mod location;
mod noun;
mod number;
mod place;
mod possession;
mod predicate;
mod question;
mod subject;
mod superlative;
mod target;
mod time;
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
