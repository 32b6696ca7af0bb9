//! Which demographic attributes small models may guess from faces.

use jrdb_types::Query;

/// Which demographic attributes are guessed from faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Demographics {
    /// Gender where a question needs it, else none.
    #[default]
    Auto,
    /// None.
    None,
    /// Gender.
    Gender,
    /// Gender and age; age is unreliable.
    All,
}

impl Demographics {
    /// What is meant, given the questions that will be asked.
    #[must_use]
    pub fn for_queries<'a>(self, queries: impl IntoIterator<Item = &'a Query>) -> Self {
        match self {
            Self::Auto if queries.into_iter().any(speaks_of_gender) => Self::Gender,
            Self::Auto => Self::None,
            chosen => chosen,
        }
    }
}

/// Whether a query has a condition on, or asks for, a person's gender, however deep. Its JSON form names every part.
fn speaks_of_gender(query: &Query) -> bool {
    let bare = Query { text: String::new(), issues: Vec::new(), ..query.clone() };
    serde_json::to_string(&bare).is_ok_and(|json| json.contains("\"gender\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meant(text: &str) -> Demographics {
        Demographics::Auto.for_queries([&jrdb_parser::parse(text)])
    }

    #[test]
    fn gender_is_guessed_for_questions_that_need_it_only() {
        assert_eq!(meant("Who is left of the woman?"), Demographics::Gender);
        assert_eq!(meant("Who is left of the sitting person?"), Demographics::None);
        let off = Demographics::None.for_queries([&jrdb_parser::parse("Find the man")]);
        assert_eq!(off, Demographics::None);
    }
}
