//! A whole question, in words.

use jrdb_types::query::{Command, Order, Property, Share, Slot};
use jrdb_types::{Condition, Pattern, Query, Task};

use crate::wording;

/// A query in words: what is asked of which kind of thing, then one line per condition.
///
/// ```
/// use jrdb_types::{Condition, Gender, Query};
/// let mut query = Query::default();
/// query.target.conditions.push(Condition::has(Gender::Male));
/// assert_eq!(jrdb_render::query(&query), "find a person with\n  gender male");
/// ```
#[must_use]
pub fn query(query: &Query) -> String {
    let target = &query.target;
    let noun = wording::pattern(&Pattern::of(target.category.clone()));
    let mut lines: Vec<String> = target.conditions.iter().map(wording::condition).collect();
    lines.extend(target.pick.as_ref().map(wording::pick));
    lines.extend(query.slots.iter().zip(1..).map(|(slot, number)| self::slot(slot, number)));
    let with = if lines.is_empty() { "" } else { " with" };
    let lines: String = lines.iter().map(|line| format!("\n  {line}")).collect();
    let than = match &query.task {
        Task::CompareCounts { than, .. } => format!("\nthan {}", wording::description(than)),
        Task::From { partner, .. } => format!("\nfrom {}", wording::pattern(partner)),
        _ => String::new(),
    };
    let told = query.command.as_ref().map(|told| format!("\nto {}", command(told)));
    let than = than + &told.unwrap_or_default();
    format!("{}{with}{lines}{than}", task(&query.task, &noun))
}

fn task(task: &Task, noun: &str) -> String {
    match task {
        Task::Find => format!("find {noun}"),
        Task::Count => format!("count {noun}"),
        Task::Exists(quantity) => {
            format!("is there {noun}, {} of them,", wording::amount(*quantity))
        }
        Task::CompareCounts { order: Order::Most, .. } => format!("are there more: {noun}"),
        Task::CompareCounts { order: Order::Least, .. } => format!("are there fewer: {noun}"),
        Task::Where => format!("where is {noun}"),
        Task::Groups => format!("count the groups of {noun}"),
        Task::Each { share, asked } => {
            let share = match share {
                Share::All => "all",
                Share::None => "none",
                Share::Most => "most",
                Share::Half => "at least half",
            };
            format!("are {share} of these {}: {noun}", listed(asked, " and "))
        }
        Task::Choice { options } => format!("which of {}: {noun}", listed(options, " or ")),
        Task::From { property: asked, .. } => format!("tell the {} of {noun}", property(*asked)),
        Task::Which { properties, in_order } => {
            let names: Vec<String> = properties.iter().map(|p| property(*p)).collect();
            let over_time = if *in_order { " over time" } else { "" };
            format!("tell the {}{over_time} of {noun}", names.join(", "))
        }
    }
}

fn listed(conditions: &[Condition], joint: &str) -> String {
    conditions.iter().map(wording::condition).collect::<Vec<_>>().join(joint)
}

/// A command in words: `take this to the kitchen`.
pub(crate) fn command(command: &Command) -> String {
    let object = command.object.iter().map(|object| format!(" {object}"));
    let destination = command.destination.iter().map(|place| format!(" to {place}"));
    std::iter::once(command.verb.clone()).chain(object).chain(destination).collect()
}

/// A stretch of a recording with its conditions: `then during 2 to 5 s action sitting`.
pub(crate) fn slot(slot: &Slot, number: usize) -> String {
    let conditions: Vec<String> = slot.conditions.iter().map(wording::condition).collect();
    let then = if number == 1 { "" } else { "then " };
    let during = slot.during_s.map(|[from, to]| format!("during {from} to {to} s "));
    let conditions =
        if conditions.is_empty() { "present".into() } else { conditions.join(" and ") };
    format!("{then}{}{conditions}", during.unwrap_or_default())
}

/// The name of a property in words: `social interaction`.
pub(crate) fn property(property: Property) -> String {
    property.name().replace('_', " ")
}
