//! Reads the notation.

use jrdb_types::query::{
    Category, Compared, Interval, Measure, Measures, Nearer, Order, Phrase, Pick, Place, Property,
    Quantity, Related, RelationKind, Slot, Task, Viewpoint,
};
use jrdb_types::vocab::PairWord;
use jrdb_types::{
    Attribute, AttributeNotation, AttributeValue, Condition, DistanceWord, Pattern, Query,
};

use super::cursor::{Read, Reader};
use super::error::NotationError;
use super::keyword;
use super::token::Kind;
use super::words::{attribute, direction};

/// Reads a query in the notation. Its `text` is the notation itself.
///
/// ```
/// use jrdb_parser::notation::{read, write};
/// let query = read("count person[sitting, seen direction=left: \"table\"]").unwrap();
/// assert_eq!(write(&query), query.text);
/// assert_eq!(read("find person[").unwrap_err().to_string(), "expected a condition, found the end at byte 12");
/// ```
///
/// # Errors
/// [`NotationError`] at the first piece that does not fit.
pub fn read(text: &str) -> Result<Query, NotationError> {
    let mut reader = Reader::new(text);
    let mut task = reader.task()?;
    let target = reader.pattern()?;
    match &mut task {
        Task::CompareCounts { than, .. } => {
            reader.expect("than")?;
            **than = reader.pattern()?;
        }
        Task::From { partner, .. } => {
            reader.expect("from")?;
            **partner = reader.pattern()?;
        }
        _ => {}
    }
    let mut slots = Vec::new();
    while reader.takes("slot") {
        slots.push(reader.slot()?);
    }
    let command = if reader.takes("command") { Some(reader.command()?) } else { None };
    match reader.peek() {
        None => Ok(Query { text: text.into(), task, target, command, slots, issues: Vec::new() }),
        Some(_) => Err(reader.wanted("the end")),
    }
}

impl Reader<'_> {
    fn task(&mut self) -> Read<Task> {
        const WORDS: [&str; 12] = [
            "find",
            "count",
            "where",
            "exists",
            "which",
            "more",
            "fewer",
            "each",
            "choice",
            "distance",
            "direction",
            "groups",
        ];
        let Some(word) = WORDS.into_iter().find(|word| self.is(word)) else {
            return Err(self.wanted(&WORDS.join(", ")));
        };
        self.at += 1;
        Ok(match word {
            "find" => Task::Find,
            "count" => Task::Count,
            "where" => Task::Where,
            "exists" => Task::Exists(self.quantity()?),
            "which" => self.which()?,
            "groups" => Task::Groups,
            "each" => self.each()?,
            "choice" => {
                self.expect("[")?;
                let options = self.conditions("]")?;
                self.expect("of")?;
                Task::Choice { options }
            }
            "distance" | "direction" => {
                let is_far = word == "distance";
                let property = if is_far { Property::Distance } else { Property::Direction };
                self.expect("of")?;
                // The other end follows the target.
                Task::From { property, partner: Box::default() }
            }
            _ => {
                let order = if word == "more" { Order::Most } else { Order::Least };
                // What they are compared with follows the target.
                Task::CompareCounts { order, than: Box::default() }
            }
        })
    }

    fn which(&mut self) -> Read<Task> {
        let mut properties = Vec::new();
        loop {
            let named = |word: &str| Property::all().find(|property| keyword(*property) == word);
            let found = self.vocabulary(named);
            properties.push(found.ok_or_else(|| self.wanted("a property"))?);
            if !self.takes(",") {
                break;
            }
        }
        let in_order = self.takes("in");
        if in_order {
            self.expect("order")?;
        }
        self.expect("of")?;
        Ok(Task::Which { properties, in_order })
    }

    /// An optional quantity; the default is "some".
    fn quantity(&mut self) -> Read<Quantity> {
        let has_number = matches!(self.peek().map(|token| &token.kind), Some(Kind::Number(_)));
        let has_mark = ["=", ">=", "<="].iter().any(|mark| self.is(mark));
        if has_number || has_mark { self.amount() } else { Ok(Quantity::SOME) }
    }

    fn amount(&mut self) -> Read<Quantity> {
        if self.takes("=") {
            return Ok(Quantity::exactly(self.whole()?));
        }
        if self.takes(">=") {
            return Ok(Quantity::at_least(self.whole()?));
        }
        if self.takes("<=") {
            return Ok(Quantity { at_least: 0, at_most: Some(self.whole()?) });
        }
        let at_least = self.whole()?;
        self.expect("..")?;
        Ok(Quantity { at_least, at_most: Some(self.whole()?) })
    }

    fn pattern(&mut self) -> Read<Pattern> {
        self.nested(|reader| {
            let category = reader.category()?;
            let conditions = if reader.takes("[") { reader.conditions("]")? } else { Vec::new() };
            let pick = if reader.takes("{") { Some(reader.pick()?) } else { None };
            Ok(Pattern { category, conditions, pick })
        })
    }

    fn category(&mut self) -> Read<Category> {
        if let Some(name) = self.quoted() {
            return Ok(Category::Class(name));
        }
        let found = self.vocabulary(|word| match word {
            "person" => Some(Category::Person),
            "object" => Some(Category::Object),
            "thing" => Some(Category::Anything),
            "robot" => Some(Category::Robot),
            _ => None,
        });
        found.ok_or_else(|| self.wanted("person, object, thing, robot or a quoted class"))
    }

    /// Conditions up to a closing bracket.
    pub(super) fn conditions(&mut self, close: &str) -> Read<Vec<Condition>> {
        let mut conditions = vec![self.condition()?];
        while self.takes(",") {
            conditions.push(self.condition()?);
        }
        self.expect(close)?;
        Ok(conditions)
    }

    fn condition(&mut self) -> Read<Condition> {
        self.nested(Self::any_condition)
    }

    fn any_condition(&mut self) -> Read<Condition> {
        if self.takes("(") {
            return self.joined();
        }
        if self.takes("not") {
            return Ok(Condition::Not(Box::new(self.condition()?)));
        }
        if self.takes("phrase") {
            let words = self.quoted().ok_or_else(|| self.wanted("quoted words"))?;
            return Ok(Condition::Phrase(Phrase { words, span: None }));
        }
        if self.takes("looks") {
            let words = self.quoted().ok_or_else(|| self.wanted("quoted words"))?;
            return Ok(Condition::Looks(Phrase { words, span: None }));
        }
        if self.takes("#") {
            return Ok(Condition::Id(self.whole()?));
        }
        if self.takes("nearer") {
            self.expect("to")?;
            let to = Box::new(self.pattern()?);
            self.expect("than")?;
            self.expect("to")?;
            return Ok(Condition::Nearer(Nearer { to, than: Box::new(self.pattern()?) }));
        }
        if let Some(measure) = self.measured() {
            let min = self.number();
            self.expect("..")?;
            let within = Interval { min, max: self.number() };
            return Ok(Condition::Measures(Measures { measure, within }));
        }
        if self.takes("is") {
            return Ok(Condition::Is(Box::new(self.pattern()?)));
        }
        if self.takes("group") {
            return Ok(Condition::GroupSize(self.amount()?));
        }
        if let Some(order) = self.more_or_less() {
            return self.compared(order);
        }
        if let Some(value) = self.attribute_with_key()? {
            return Ok(Condition::Attribute(value));
        }
        if let Some(place) = self.sector_or_distance()? {
            return Ok(Condition::FromRobot(place));
        }
        if let Some(kind) = self.relation()? {
            return self.related(kind);
        }
        self.vocabulary(attribute).ok_or_else(|| self.wanted("a condition"))
    }

    /// Behind the opening bracket: `a or b)`, `or a)`, `or)`.
    fn joined(&mut self) -> Read<Condition> {
        let mut word = self.joint();
        let mut parts = Vec::new();
        while !self.takes(")") {
            parts.push(self.condition()?);
            let next = self.joint();
            if self.is(")") && next.is_none() {
                continue;
            }
            let Some(next) = next.filter(|next| word.is_none_or(|word| word == *next)) else {
                return Err(self.wanted("\")\", or the same of \"or\" and \"and\" throughout"));
            };
            word = Some(next);
        }
        match word {
            Some("or") => Ok(Condition::Any(parts)),
            Some(_) => Ok(Condition::All(parts)),
            None => Err(self.wanted("\"or\" or \"and\" in the brackets")),
        }
    }

    fn joint(&mut self) -> Option<&'static str> {
        ["or", "and"].into_iter().find(|word| self.takes(word))
    }

    fn more_or_less(&mut self) -> Option<Order> {
        self.vocabulary(|word| match word {
            "more" => Some(Order::Most),
            "less" => Some(Order::Least),
            _ => None,
        })
    }

    /// `upper=red`.
    fn attribute_with_key(&mut self) -> Read<Option<AttributeValue>> {
        for attribute in Attribute::ALL {
            let AttributeNotation::Key { key, value } = attribute.row().notation else { continue };
            if self.takes(key) {
                self.expect("=")?;
                let found = self.vocabulary(|word| attribute.value(word));
                return found.map(Some).ok_or_else(|| self.wanted(value));
            }
        }
        Ok(None)
    }

    /// What bounds can be asked of.
    fn measured(&mut self) -> Option<Measure> {
        match () {
            () if self.takes("height") => Some(Measure::Height),
            () if self.takes("speed") => Some(Measure::Speed),
            () => None,
        }
    }

    fn compared(&mut self, order: Order) -> Read<Condition> {
        let measure = self.measure()?;
        self.expect("than")?;
        let than = Box::new(self.pattern()?);
        Ok(Condition::Compared(Compared { measure, order, than }))
    }

    fn measure(&mut self) -> Read<Measure> {
        let words = ["from left", "height", "age", "speed", "distance to"];
        let found = self.vocabulary(|found| words.into_iter().find(|word| *word == found));
        Ok(match found {
            Some("from left") => Measure::FromLeft,
            Some("height") => Measure::Height,
            Some("age") => Measure::Age,
            Some("speed") => Measure::Speed,
            Some(_) => Measure::DistanceTo(Box::new(self.pattern()?)),
            None => return Err(self.wanted("distance to, from left, height, age or speed")),
        })
    }

    fn pick(&mut self) -> Read<Pick> {
        let order = match () {
            () if self.takes("least") => Order::Least,
            () if self.takes("most") => Order::Most,
            () => return Err(self.wanted("least or most")),
        };
        let measure = self.measure()?;
        let rank = if self.takes("rank") { self.whole()? } else { 1 };
        let count = if self.takes("count") { self.whole()? } else { 1 };
        self.expect("}")?;
        Ok(Pick { measure, order, rank, count })
    }

    fn sector_or_distance(&mut self) -> Read<Option<Place>> {
        let place = if self.takes("distance") {
            self.expect("=")?;
            let word = self.vocabulary(DistanceWord::from_word);
            Place::Distance(word.ok_or_else(|| self.wanted("a distance word"))?)
        } else if self.takes("direction") {
            self.expect("=")?;
            let word = self.vocabulary(direction);
            Place::Direction(word.ok_or_else(|| self.wanted("a direction word"))?)
        } else if self.takes("metres") {
            let min = self.number();
            self.expect("..")?;
            Place::Metres(Interval { min, max: self.number() })
        } else if self.takes("degrees") {
            let center = self.need_number()?;
            self.expect("+-")?;
            Place::Degrees { center, half_width: self.need_number()? }
        } else {
            return Ok(None);
        };
        Ok(Some(place))
    }

    fn relation(&mut self) -> Read<Option<RelationKind>> {
        let viewpoint = match () {
            () if self.takes("has") => Some(Viewpoint::Subject),
            () if self.takes("at") => Some(Viewpoint::Partner),
            () if self.takes("seen") => Some(Viewpoint::Robot),
            () => None,
        };
        if let Some(viewpoint) = viewpoint {
            let place = self.sector_or_distance()?.ok_or_else(|| self.wanted("a place"))?;
            return Ok(Some(RelationKind::Placed { place, viewpoint }));
        }
        if self.takes("does") {
            let label = self.quoted().ok_or_else(|| self.wanted("a quoted label"))?;
            return Ok(Some(RelationKind::Interaction(label)));
        }
        if self.takes("between") {
            return Ok(Some(RelationKind::Between(Box::new(self.pattern()?))));
        }
        if self.takes("with") {
            return Ok(Some(RelationKind::With));
        }
        Ok(self.vocabulary(PairWord::from_word).map(RelationKind::Pair))
    }

    fn related(&mut self, first: RelationKind) -> Read<Condition> {
        let mut kinds = vec![first];
        while self.takes("&") {
            kinds.push(self.relation()?.ok_or_else(|| self.wanted("a relation"))?);
        }
        self.expect(":")?;
        let quantity = self.quantity()?;
        let partner = self.pattern()?;
        Ok(Condition::Related(Related { kinds, partner, quantity }))
    }

    fn slot(&mut self) -> Read<Slot> {
        let during_s = match self.number() {
            None => None,
            Some(from) => {
                self.expect("..")?;
                Some([from, self.need_number()?])
            }
        };
        self.expect("{")?;
        let conditions = if self.takes("}") { Vec::new() } else { self.conditions("}")? };
        Ok(Slot { during_s, conditions })
    }
}
