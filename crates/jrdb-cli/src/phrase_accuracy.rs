//! How well phrases are judged on drawn scenes, whose truth is known.

use std::fmt::Write as _;

use jrdb_perception::{Models, Subject, View};
use jrdb_synth::{Feature, Practice, Seen};
use jrdb_types::{FrameId, ImageGeometry};
use rayon::prelude::*;

use crate::Error;
use crate::evaluation::{counts, same};

/// What was made of a phrase about somebody.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judged {
    /// Which phrase.
    pub feature: Feature,
    /// Whether it is true.
    pub holds: bool,
    /// Whether the picture shows it: glasses do not show from behind.
    pub shows: bool,
    /// The probability that was given; `None` where the model could not tell.
    pub probability: Option<f64>,
}

/// How the phrase for a feature was judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Judging {
    /// Which one.
    pub feature: Feature,
    /// Of how many people the picture shows it.
    pub shown: usize,
    /// Of how many of these it is true.
    pub holds: usize,
    /// Average precision over them; those whom the model cannot tell count as one half.
    pub average_precision: f64,
    /// The part of them, in `[0, 1]`, of whom the model could not tell.
    pub unknown: f64,
    /// The part of the others, in `[0, 1]`, of whom the more probable answer was right.
    pub right: f64,
    /// The same average precision with the people of whom the picture does not show it.
    pub average_precision_of_all: f64,
    /// The part of those, in `[0, 1]`, of whom the model could not tell.
    pub hidden_unknown: f64,
}

/// Asks every phrase of everybody who counts and was found.
///
/// # Errors
/// When a model fails, or none can be asked.
pub fn on_phrases(scenes: &[Practice], models: &Models) -> Result<Vec<Judged>, Error> {
    let found: Vec<_> = scenes.par_iter().map(|scene| of_scene(scene, models)).collect();
    Ok(found.into_iter().collect::<Result<Vec<_>, _>>()?.concat())
}

fn of_scene(scene: &Practice, models: &Models) -> Result<Vec<Judged>, Error> {
    let (image, frame) = (&scene.view.image, FrameId::default());
    let geometry =
        ImageGeometry { width_px: image.width as u32, height_px: image.height as u32, wraps: true };
    let Some(model) = &models.phrases else {
        return Err(Error::Usage("expected a model that can be asked phrases, found none".into()));
    };
    let detections = models.detector.detect(image, &frame)?.detections;
    let view = View { geometry, image: Some(image) };
    let mut judged = Vec::new();
    for seen in scene.view.people.iter().filter(|seen| counts(scene, seen)) {
        let Some(detection) = same(&detections, seen, Some(image.width as f64)) else { continue };
        let subject = Subject { frame: &frame, view, detection };
        let told = model.weigh(&subject, &Feature::ALL.map(Feature::phrase))?;
        judged
            .extend(Feature::ALL.into_iter().zip(told).map(|(feature, p)| judge(seen, feature, p)));
    }
    Ok(judged)
}

fn judge(seen: &Seen, feature: Feature, probability: Option<f64>) -> Judged {
    let (holds, shows) = (seen.features.contains(&feature), seen.shows(feature));
    Judged { feature, holds, shows, probability }
}

/// Sums up what was made of each phrase, in the order of [`Feature::ALL`].
#[must_use]
pub fn summed_up(judged: &[Judged]) -> Vec<Judging> {
    Feature::ALL.map(|feature| of_feature(judged, feature)).to_vec()
}

fn of_feature(judged: &[Judged], feature: Feature) -> Judging {
    let all: Vec<Judged> = judged.iter().copied().filter(|one| one.feature == feature).collect();
    let (shown, hidden): (Vec<Judged>, Vec<Judged>) = all.iter().partition(|one| one.shows);
    let told = |one: &&Judged| one.probability.is_some();
    let is_right = |one: &&Judged| one.probability.is_some_and(|p| (p >= 0.5) == one.holds);
    let known = shown.iter().filter(told).count();
    Judging {
        feature,
        shown: shown.len(),
        holds: shown.iter().filter(|one| one.holds).count(),
        average_precision: average_precision(&shown),
        unknown: part(shown.len() - known, shown.len()),
        right: part(shown.iter().filter(is_right).count(), known),
        average_precision_of_all: average_precision(&all),
        hidden_unknown: part(hidden.len() - hidden.iter().filter(told).count(), hidden.len()),
    }
}

fn part(some: usize, all: usize) -> f64 {
    some as f64 / all.max(1) as f64
}

/// Mean, over the people of whom the phrase is true, of the precision among all who are as probable
/// or more; 0 if it is true of nobody.
fn average_precision(judged: &[Judged]) -> f64 {
    let score = |one: &Judged| one.probability.unwrap_or(0.5);
    let mut sorted = judged.to_vec();
    sorted.sort_by(|a, b| score(b).total_cmp(&score(a)));
    let (mut seen, mut right, mut sum) = (0, 0, 0.0);
    for equal in sorted.chunk_by(|a, b| score(a) == score(b)) {
        let holds = equal.iter().filter(|one| one.holds).count();
        (seen, right) = (seen + equal.len(), right + holds);
        sum += holds as f64 * part(right, seen);
    }
    sum / right.max(1) as f64
}

/// A table of how phrases were judged.
#[must_use]
pub fn phrase_table(judgings: &[Judging]) -> String {
    let names = ["shown", "true", "AP", "unknown", "right", "AP, all", "hidden unknown"];
    let mut text = format!("{:<16}", "phrases");
    names.iter().for_each(|name| write!(text, "{name:>9}").unwrap_or_default());
    for one in judgings {
        let _ = write!(text, "\n  {:<14}{:>9}{:>9}", one.feature.phrase(), one.shown, one.holds);
        let all = one.average_precision_of_all;
        let numbers = [one.average_precision, one.unknown, one.right, all, one.hidden_unknown];
        numbers.iter().for_each(|number| write!(text, "{number:>9.3}").unwrap_or_default());
    }
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn average_precision_is_the_mean_of_the_precision_at_each_hit() {
        let told = |holds: bool, p: Option<f64>| Judged {
            feature: Feature::Tie,
            holds,
            shows: true,
            probability: p,
        };
        let judged = [told(true, Some(0.9)), told(false, Some(0.8)), told(true, None)];
        assert!((average_precision(&judged) - (1.0 + 2.0 / 3.0) / 2.0).abs() < 1e-12);
        assert_eq!(average_precision(&[told(false, Some(0.9))]), 0.0);
        let tie = summed_up(&judged)[6];
        assert_eq!((tie.shown, tie.holds, tie.right), (3, 2, 0.5));
        assert!((tie.unknown - 1.0 / 3.0).abs() < 1e-12);
        assert!(phrase_table(&[tie]).contains("  tie                   3        2    0.833"));
    }
}
