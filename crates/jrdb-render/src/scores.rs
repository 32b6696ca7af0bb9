//! Scores, in words.

use std::fmt::Write as _;

use jrdb_types::score::{IouKind, QuestionScore, Scores};
use jrdb_types::{Answer, Question, Task};

use crate::brief::ids;

/// Scores as a table, one row per category.
#[must_use]
pub fn scores(scores: &Scores) -> String {
    let mut text = format!(
        "{:<32} {:>9} {:>8} {:>12} {:>10} {:>6} {:>6}\n",
        "category", "exact", "miou_gt", "miou_matched", "miou_query", "AP50", "mAP"
    );
    let all = [("all", &scores.overall)];
    let rows = scores.categories.iter().map(|(name, summary)| (name.as_str(), summary));
    for (name, s) in rows.chain(all) {
        // Writing to a String does not fail.
        let _ = writeln!(
            text,
            "{name:<32} {:>9} {:>8.3} {:>12.3} {:>10.3} {:>6.3} {:>6.3}",
            format!("{}/{}", s.exact, s.questions),
            s.miou_gt,
            s.miou_matched,
            s.miou_query,
            s.ap50,
            s.map
        );
    }
    let kind = match scores.iou {
        IouKind::Planar => "planar",
        IouKind::Circular => "circular",
    };
    let _ = writeln!(text, "IoU is {kind}");
    text
}

/// The known answer of a question beside its score: `#1 #2   exact, IoU 1.000`; nothing where no answer is known.
#[must_use]
pub fn truth(question: &Question, answer: &Answer, score: &QuestionScore) -> Option<String> {
    let truth = question.truth.as_ref()?;
    let wanted = match answer.task {
        Task::Count => truth.count.map_or_else(|| ids(&truth.ids), |count| count.to_string()),
        _ if truth.ids.is_empty() => format!("{} boxes", truth.boxes.len()),
        _ => ids(&truth.ids),
    };
    let verdict = match score.exact {
        Some(true) => "exact, ",
        Some(false) => "WRONG, ",
        None => "",
    };
    let boxes = score.true_positives + score.false_negatives;
    let iou = if boxes > 0 { score.matched_iou / boxes as f64 } else { 0.0 };
    Some(format!("{wanted}   {verdict}IoU {iou:.3}"))
}
