#![doc = include_str!("../README.md")]

mod canvas;
mod overlay;
mod panorama;
mod top_view;

pub use canvas::Canvas;
pub use overlay::{Overlay, Strip, draw_overlay};
pub use panorama::draw_panorama;
pub use top_view::draw_top_view;

use jrdb_projection::BaseCloud;
use jrdb_types::{Answer, Entity, EntityId, Image, ImageGeometry, Status};

/// A colour: red, green, blue, 0 to 255.
pub type Color = [u8; 3];

pub(crate) const WHITE: Color = [245, 245, 245];
pub(crate) const BLACK: Color = [20, 22, 26];
/// The answer.
pub(crate) const ANSWER: Color = [60, 220, 90];
/// The other person of a relation that made the answer.
pub(crate) const WITNESS: Color = [255, 165, 30];
/// A guess: the nearest where nobody satisfies the question, those that may be meant where it is open.
pub(crate) const GUESS: Color = [190, 190, 195];
/// Everyone else.
pub(crate) const OTHER: Color = [120, 190, 255];

/// One frame, as far as pictures show it.
#[derive(Debug, Clone, Copy)]
pub struct FrameView<'a> {
    /// Size of the image and whether it wraps.
    pub geometry: ImageGeometry,
    /// The image; the ground is grey without one.
    pub image: Option<&'a Image>,
    /// All sweeps in the base frame, metres.
    pub cloud: Option<&'a BaseCloud>,
    /// People and objects.
    pub entities: &'a [Entity],
}

/// A question and its answer, to be shown in a picture.
#[derive(Debug, Clone, Copy)]
pub struct Caption<'a> {
    /// The question's words.
    pub question: &'a str,
    /// The answer.
    pub answer: &'a Answer,
}

/// Which part a thing plays in an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Role {
    Other,
    Witness,
    Guess,
    Selected,
}

impl Role {
    pub(crate) fn of(id: &EntityId, answer: Option<&Answer>) -> Self {
        let Some(answer) = answer else { return Self::Other };
        let is_selected = answer.selection.binary_search(id).is_ok();
        let is_possible = || answer.possible.iter().any(|one| one.id == *id);
        match answer.status {
            Status::Answered if is_selected => return Self::Selected,
            Status::Nearest if is_selected => return Self::Guess,
            Status::Unknown if is_possible() => return Self::Guess,
            Status::Unknown | Status::NotUnderstood => return Self::Other,
            Status::Answered | Status::Nearest => {}
        }
        let is_witness = witnesses(answer).any(|(_, witness)| witness == id);
        if is_witness { Self::Witness } else { Self::Other }
    }

    pub(crate) fn color(self) -> Color {
        match self {
            Self::Other => OTHER,
            Self::Witness => WITNESS,
            Self::Guess => GUESS,
            Self::Selected => ANSWER,
        }
    }
}

/// The colour of a reply: grey where it is no answer.
pub(crate) fn reply_color(status: Status) -> Color {
    if status == Status::Answered { ANSWER } else { GUESS }
}

/// Selected things and the partners of their relations.
pub(crate) fn witnesses(answer: &Answer) -> impl Iterator<Item = (&EntityId, &EntityId)> {
    let is_open = answer.status.is_open();
    let selected = answer.trace.iter().filter(move |trace| trace.selected && !is_open);
    selected.flat_map(|trace| {
        let witnesses = trace.checks.iter().flat_map(|check| &check.witnesses);
        witnesses.map(|witness| (&trace.id, witness))
    })
}
