//! Every condition of a pattern on every thing it may mean: truths, probabilities and witnesses, kept for the trace.

use jrdb_graph::BitSet;
use jrdb_types::query::{Category, Measures, Pick};
use jrdb_types::vocab::MatchPolicy;
use jrdb_types::{Condition, Pattern, Related};

use crate::evaluation::{Column, Evaluated, Inner, Kinds, Link, Partner, Verdict};
use crate::place;
use crate::probability::of_count;
use crate::searcher::Searcher;
use crate::value::within_truth;
use crate::value::{NOBODY, Truth, Value};
use crate::{World, attribute, ranked};

impl Searcher<'_, '_> {
    /// Evaluates a pattern on everything of its kind.
    pub(crate) fn evaluate<'q>(&self, pattern: &'q Pattern) -> Evaluated<'q> {
        let kind = self.kind(&pattern.category).into_owned();
        self.evaluate_on(pattern, kind)
    }

    /// Evaluates a pattern on some things.
    pub(crate) fn evaluate_on<'q>(&self, pattern: &'q Pattern, kind: BitSet) -> Evaluated<'q> {
        let columns = self.columns_of(pattern, &kind);
        let mut verdicts = vec![Verdict::OTHER_KIND; self.index.size()];
        let mut passed = BitSet::new(self.index.size());
        for number in kind.iter() {
            verdicts[number] = self.verdict(&columns, number);
            if verdicts[number].passed() {
                passed.insert(number);
            }
        }
        let mut evaluated = Evaluated { pattern, kind, columns, verdicts, passed };
        if let Some(pick) = &pattern.pick {
            self.pick_from(&mut evaluated, pick);
        }
        evaluated
    }

    /// The conditions of a pattern; how things look is asked last, about those that may match.
    fn columns_of<'q>(&self, pattern: &'q Pattern, kind: &BitSet) -> Vec<Column<'q>> {
        let asks = |condition: &Condition| condition.asks_looks();
        if !pattern.conditions.iter().any(asks) {
            return pattern.conditions.iter().map(|c| self.column_of(c, kind)).collect();
        }
        let mut open = kind.clone();
        let mut columns: Vec<Option<Column<'q>>> = Vec::new();
        for condition in &pattern.conditions {
            let column = (!asks(condition)).then(|| self.column_of(condition, kind));
            if let Some(column) = &column {
                open.retain(|number| column.values[number].truth != Truth::No);
            }
            columns.push(column);
        }
        let each = pattern.conditions.iter().zip(columns);
        each.map(|(c, column)| column.unwrap_or_else(|| self.column_of(c, &open))).collect()
    }

    /// Leaves those that a pick takes for sure. Where nothing matches, or may match, it is made from the best guess.
    fn pick_from(&self, evaluated: &mut Evaluated<'_>, pick: &Pick) {
        let at_least = |least: Truth| {
            let mut set = evaluated.kind.clone();
            set.retain(|number| evaluated.verdicts[number].truth >= least);
            set
        };
        let [yes, maybe] = [Truth::Yes, Truth::Unknown].map(at_least);
        if self.config.world == World::Closed || maybe.is_empty() {
            evaluated.passed = self.pick(&self.meant(evaluated), pick);
            evaluated.decide(|_, truth| if truth == Truth::Yes { Truth::No } else { truth });
            return;
        }
        let picked = self.picked(&yes, &maybe, pick, self.may_be_unseen(evaluated.pattern));
        evaluated.passed = picked.yes.clone();
        let maybe = picked.possible(&maybe);
        evaluated.decide(|number, _| Truth::of(maybe.contains(number)).min(Truth::Unknown));
    }

    /// Those that match a pattern, its pick included, as the policy chooses.
    pub(crate) fn resolve(&self, pattern: &Pattern) -> BitSet {
        if self.config.policy != MatchPolicy::Ranked {
            return self.matches(pattern);
        }
        let evaluated = self.evaluate(pattern);
        if pattern.pick.is_some() {
            evaluated.passed
        } else {
            ranked::unpicked_choice(self, &evaluated)
        }
    }

    /// Those that an evaluated pattern means, its pick apart, as the policy chooses.
    fn meant(&self, evaluated: &Evaluated<'_>) -> BitSet {
        match self.config.policy {
            MatchPolicy::Ranked => ranked::unpicked_choice(self, evaluated),
            MatchPolicy::Strict | MatchPolicy::Majority => evaluated.passed.clone(),
        }
    }

    fn verdict(&self, columns: &[Column<'_>], number: usize) -> Verdict {
        let all = Value::all(columns.iter().map(|column| column.values[number]));
        let satisfied = columns.iter().map(|column| column.values[number].satisfied).sum();
        let [passed_attributes, passed_relations] = self.phases(columns, number, Truth::Yes);
        let truth = match self.config.policy {
            MatchPolicy::Ranked => all.truth,
            _ if passed_attributes && passed_relations => Truth::Yes,
            _ => {
                let may = self.phases(columns, number, Truth::Unknown) == [true; 2];
                Truth::of(may).min(Truth::Unknown)
            }
        };
        Verdict {
            passed_attributes,
            passed_relations,
            truth,
            satisfied,
            probability: all.probability,
            ranking: all.ranking,
            uncertain: all.uncertain,
        }
    }

    /// Whether enough attributes and all relations are at least so true.
    fn phases(&self, columns: &[Column<'_>], number: usize, least: Truth) -> [bool; 2] {
        let (mut attributes, mut held, mut related) = (0, 0, true);
        for column in columns {
            let holds = column.values[number].truth >= least;
            if column.condition.is_relation() {
                related &= holds;
            } else {
                attributes += 1;
                held += u32::from(holds);
            }
        }
        let enough = match self.config.policy {
            MatchPolicy::Strict => held == attributes,
            MatchPolicy::Majority | MatchPolicy::Ranked => attributes == 0 || 2 * held > attributes,
        };
        [enough, related]
    }

    fn column_of<'q>(&self, condition: &'q Condition, within: &BitSet) -> Column<'q> {
        let mut values = vec![Value::UNKNOWN; self.index.size()];
        let mut fill = |of: &dyn Fn(usize) -> Value| {
            within.iter().for_each(|number| values[number] = of(number));
        };
        if let Some(of) = self.described(condition) {
            fill(&*of);
            return Column::new(condition, values, Inner::Leaf);
        }
        let inner = match condition {
            Condition::FromRobot(place) => {
                fill(&|number| self.robot_place_value(number, place));
                Inner::Leaf
            }
            Condition::GroupSize(quantity) => {
                fill(&|number| Value::certain(self.group_truth(number, *quantity)));
                Inner::Leaf
            }
            Condition::Related(related) => return self.relation_column(condition, related, within),
            Condition::Compared(compared) => {
                let comparison = self.comparison(compared);
                fill(&|number| Value::certain(comparison.truth(number)));
                Inner::Comparison(comparison)
            }
            Condition::Is(pattern) => {
                let mut those = self.evaluate(pattern);
                if pattern.pick.is_none() {
                    those.passed = self.meant(&those);
                }
                fill(&|number| is_one_of(&those, number));
                Inner::Pattern(Box::new(those))
            }
            Condition::Not(inner) => {
                let column = self.column_of(inner, within);
                fill(&|number| column.values[number].negated());
                Inner::Parts(vec![column])
            }
            Condition::Any(parts) => {
                let parts = self.alternatives(parts);
                let columns: Vec<_> = parts.iter().map(|p| self.column_of(p, within)).collect();
                fill(&|number| any_of(condition, || columns.iter().map(|c| c.values[number])));
                Inner::Parts(columns)
            }
            Condition::All(parts) => {
                let columns: Vec<_> = parts.iter().map(|p| self.column_of(p, within)).collect();
                fill(&|number| Value::all(columns.iter().map(|c| c.values[number])));
                Inner::Parts(columns)
            }
            Condition::Attribute(asked) => {
                let neighbor = self.config.age_neighbor_probability;
                fill(&|number| {
                    let known = self.index.node(number).map(|node| &node.attributes);
                    attribute::value(*asked, known, neighbor)
                });
                Inner::Leaf
            }
            // Filled already.
            _ => Inner::Leaf,
        };
        Column::new(condition, values, inner)
    }

    /// The value of a condition that looks at nothing but the thing itself, apart from attributes.
    fn described<'s>(
        &'s self,
        condition: &'s Condition,
    ) -> Option<Box<dyn Fn(usize) -> Value + 's>> {
        Some(match condition {
            Condition::Measures(Measures { measure, within }) => {
                let measures = self.measures(measure);
                Box::new(move |number| Value::certain(within_truth(measures[number], within)))
            }
            Condition::Nearer(nearer) => {
                let truths = self.nearer(nearer);
                Box::new(move |number| Value::certain(truths[number]))
            }
            Condition::Looks(phrase) => Box::new(|number| self.looks(number, &phrase.words)),
            Condition::Id(id) => Box::new(|number| Value::certain(self.id_truth(number, *id))),
            Condition::Phrase(_) => Box::new(|_| Value::NOT_UNDERSTOOD),
            _ => return None,
        })
    }

    fn robot_place_value(&self, number: usize, asked: &jrdb_types::Place) -> Value {
        let node = self.index.node(number);
        let Some(found) = node.and_then(|node| self.seen_by_robot(node)) else {
            return Value::UNKNOWN;
        };
        let probability = place::probability(asked, &found, &self.robot_observer());
        Value::new(self.place_truth(number, asked), probability)
    }

    fn partner_of<'q>(&self, pattern: &'q Pattern) -> Partner<'q> {
        if pattern.category == Category::Robot {
            return Partner::Robot(pattern.conditions.is_empty());
        }
        let evaluated = self.evaluate(pattern);
        let passed = evaluated.passed.clone();
        let mut undecided = evaluated.kind.clone();
        undecided.retain(|number| evaluated.verdicts[number].truth == Truth::Unknown);
        undecided.subtract(&passed);
        let (may_be_unseen, evaluated) = (self.may_be_unseen(pattern), Some(Box::new(evaluated)));
        Partner::Things { passed, undecided, may_be_unseen, evaluated }
    }

    fn relation_column<'q>(
        &self,
        condition: &'q Condition,
        related: &'q Related,
        within: &BitSet,
    ) -> Column<'q> {
        let partner = self.partner_of(&related.partner);
        let kinds = Kinds::new(&related.kinds, |pattern| self.partner_of(pattern));
        let mut values = vec![Value::UNKNOWN; self.index.size()];
        let mut scratch = Vec::new();
        for subject in within.iter() {
            values[subject] = match &partner {
                Partner::Robot(is_free) => {
                    let link = if *is_free { self.robot_link(subject, &kinds) } else { Link::NONE };
                    robot_value(related, link)
                }
                Partner::Things { evaluated, .. } => {
                    self.possible_partners(subject, &kinds, &mut scratch);
                    let of = |other: usize| {
                        let those = evaluated.as_ref().filter(|e| e.kind.contains(other))?;
                        Some((those.verdicts[other], those.probabilities(other)))
                    };
                    self.relation_value(subject, related, &kinds, &scratch, &partner, of)
                }
            };
        }
        Column::new(condition, values, Inner::Relation { kinds, partner })
    }

    /// How many partners there are, how probably as many as asked, and the best of them: one that holds before one that
    /// does not, then by conditions satisfied, those that stand in the relations first, then by probability, then by id.
    fn relation_value(
        &self,
        subject: usize,
        related: &Related,
        kinds: &Kinds<'_>,
        possible: &[u32],
        partner: &Partner<'_>,
        verdict: impl Fn(usize) -> Option<(Verdict, [f64; 2])>,
    ) -> Value {
        let (mut count, mut uncertain) = (0, false);
        let mut perhaps: usize = self.unseen_partners(subject, kinds, partner, possible);
        let mut probabilities: Vec<[f64; 2]> = Vec::new();
        let mut best: Option<((bool, u32, bool, f64), u32)> = None;
        for &other in possible {
            let link = self.link(subject, other as usize, kinds);
            let Some((verdict, [believed, ranking])) = verdict(other as usize) else { continue };
            let truth = link.truth.min(partner.truth(other as usize));
            let holds = truth.holds();
            count += usize::from(holds);
            perhaps = perhaps.saturating_add(usize::from(truth == Truth::Unknown));
            uncertain |= verdict.uncertain;
            probabilities.push([link.probability * believed, link.probability * ranking]);
            let is_linked = link.truth.holds();
            let satisfied = u32::from(is_linked) + verdict.satisfied;
            let rank = (holds, satisfied, is_linked, link.probability * believed);
            if best.is_none_or(|(best, _)| rank > best) {
                best = Some((rank, other));
            }
        }
        let truth = Truth::of_count(related.quantity, count, perhaps);
        let quantity = related.quantity;
        let [probability, ranking] = [0, 1].map(|which| {
            // Of what is unknown and not at all probable the contrary is not probable either.
            if truth == Truth::Unknown && probabilities.iter().all(|p| p[which] == 0.0) {
                return 0.0;
            }
            let each = probabilities.iter().map(|p| p[which]);
            of_count(each, quantity.at_least, quantity.at_most)
        });
        let satisfied = match best {
            Some(((_, satisfied, ..), _)) if quantity.at_least > 0 => satisfied,
            _ => u32::from(truth.holds()),
        };
        let witness = best.map_or(NOBODY, |(_, other)| other);
        Value { truth, probability, ranking, satisfied, uncertain, witness }
    }
}

fn robot_value(related: &Related, link: Link) -> Value {
    let Link { truth, probability } = link;
    let [sure, perhaps] = [Truth::Yes, Truth::Unknown].map(|of| usize::from(truth == of));
    let satisfied = u32::from(truth.holds());
    let (quantity, truth) = (related.quantity, Truth::of_count(related.quantity, sure, perhaps));
    let p = of_count(std::iter::once(probability), quantity.at_least, quantity.at_most);
    let p = if truth == Truth::Unknown { 0.0 } else { p };
    Value { satisfied, ..Value::new(truth, p) }
}

fn is_one_of(those: &Evaluated<'_>, number: usize) -> Value {
    let truth = match those.passed.contains(number) {
        true => Truth::Yes,
        false => those.verdicts[number].truth.min(Truth::Unknown),
    };
    let [probability, ranking] = those.probabilities(number);
    let uncertain = those.verdicts[number].uncertain;
    Value { ranking, uncertain, ..Value::new(truth, probability) }
}

/// Alternatives exclude each other when they are values of one attribute or sectors of one place: then probabilities add.
fn any_of<V: Iterator<Item = Value>>(condition: &Condition, values: impl Fn() -> V) -> Value {
    let any = Value::any(values());
    let Condition::Any(parts) = condition else { return any };
    if !exclude_each_other(parts) {
        return any;
    }
    let sum = |of: fn(&Value) -> f64| values().map(|v| of(&v)).sum::<f64>().min(1.0);
    Value { probability: sum(|v| v.probability), ranking: sum(|v| v.ranking), ..any }
}

fn exclude_each_other(parts: &[Condition]) -> bool {
    use Condition::{Attribute, FromRobot};
    use jrdb_types::Place::{Direction, Distance};
    let is_one_kind = |pair: &[Condition]| match (&pair[0], &pair[1]) {
        (Attribute(a), Attribute(b)) => {
            a.attribute() == b.attribute() && a.attribute().row().exclusive
        }
        (FromRobot(Distance(_)), FromRobot(Distance(_)))
        | (FromRobot(Direction(_)), FromRobot(Direction(_))) => true,
        _ => false,
    };
    let repeats = |part: &Condition| parts.iter().filter(|other| *other == part).count() > 1;
    parts.windows(2).all(is_one_kind) && !parts.iter().any(repeats)
}
