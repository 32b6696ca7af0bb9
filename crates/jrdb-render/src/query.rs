//! A whole question, in words.

use jrdb_types::query::{Order, Property, Slot};
use jrdb_types::{Pattern, Query, Task};

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
        _ => String::new(),
    };
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
        Task::Which { properties, in_order } => {
            let names: Vec<String> = properties.iter().map(|p| property(*p)).collect();
            let over_time = if *in_order { " over time" } else { "" };
            format!("tell the {}{over_time} of {noun}", names.join(", "))
        }
    }
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
