//! The tasks of Florence-2, and the prompt of each.

use super::answer::Grammar;
use super::location::LocationBox;

/// A task; those that are about something carry it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Task {
    /// Every object with the name of its kind.
    ObjectDetection,
    /// Every object with a phrase that describes it.
    DenseRegionCaption,
    /// Boxes without names.
    RegionProposal,
    /// The objects with this name: boxes, or polygons where the model prefers them.
    OpenVocabularyDetection(String),
    /// Boxes of the phrases in a sentence.
    PhraseGrounding(String),
    /// The outline of the object that the words refer to.
    ReferringSegmentation(String),
    /// The category of a region.
    RegionToCategory(LocationBox),
    /// A description of a region.
    RegionToDescription(LocationBox),
    /// The outline of the object in a region.
    RegionToSegmentation(LocationBox),
    /// The writing in a region.
    RegionToOcr(LocationBox),
    /// One sentence.
    Caption,
    /// Several sentences.
    DetailedCaption,
    /// A paragraph.
    MoreDetailedCaption,
    /// The writing in the picture.
    Ocr,
    /// The writing, each with the four corners of its place.
    OcrWithRegion,
}

impl Task {
    /// The task with this tag in Florence-2's own notation, `<OD>` or `<OPEN_VOCABULARY_DETECTION>a
    /// red bag`.
    #[must_use]
    pub fn from_tag(text: &str) -> Option<Self> {
        let (tag, input) = text.strip_prefix('<')?.split_once('>')?;
        let region = || LocationBox::from_tags(input);
        let task = match tag {
            "OPEN_VOCABULARY_DETECTION" => {
                return Some(Self::OpenVocabularyDetection(input.into()));
            }
            "CAPTION_TO_PHRASE_GROUNDING" => return Some(Self::PhraseGrounding(input.into())),
            "REFERRING_EXPRESSION_SEGMENTATION" => {
                return Some(Self::ReferringSegmentation(input.into()));
            }
            "REGION_TO_CATEGORY" => return region().map(Self::RegionToCategory),
            "REGION_TO_DESCRIPTION" => return region().map(Self::RegionToDescription),
            "REGION_TO_SEGMENTATION" => return region().map(Self::RegionToSegmentation),
            "REGION_TO_OCR" => return region().map(Self::RegionToOcr),
            "OD" => Self::ObjectDetection,
            "DENSE_REGION_CAPTION" => Self::DenseRegionCaption,
            "REGION_PROPOSAL" => Self::RegionProposal,
            "CAPTION" => Self::Caption,
            "DETAILED_CAPTION" => Self::DetailedCaption,
            "MORE_DETAILED_CAPTION" => Self::MoreDetailedCaption,
            "OCR" => Self::Ocr,
            "OCR_WITH_REGION" => Self::OcrWithRegion,
            _ => return None,
        };
        input.is_empty().then_some(task)
    }

    /// The sentence that asks for it.
    #[must_use]
    pub fn prompt(&self) -> String {
        match self {
            Self::ObjectDetection => "Locate the objects with category name in the image.".into(),
            Self::DenseRegionCaption => {
                "Locate the objects in the image, with their descriptions.".into()
            }
            Self::RegionProposal => "Locate the region proposals in the image.".into(),
            Self::OpenVocabularyDetection(what) => format!("Locate {what} in the image."),
            Self::PhraseGrounding(caption) => {
                format!("Locate the phrases in the caption: {caption}")
            }
            Self::ReferringSegmentation(what) => format!("Locate {what} in the image with mask"),
            Self::RegionToCategory(region) => format!("What is the region {}?", region.tags()),
            Self::RegionToDescription(region) => {
                format!("What does the region {} describe?", region.tags())
            }
            Self::RegionToSegmentation(region) => {
                format!("What is the polygon mask of region {}", region.tags())
            }
            Self::RegionToOcr(region) => format!("What text is in the region {}?", region.tags()),
            Self::Caption => "What does the image describe?".into(),
            Self::DetailedCaption => "Describe in detail what is shown in the image.".into(),
            Self::MoreDetailedCaption => {
                "Describe with a paragraph what is shown in the image.".into()
            }
            Self::Ocr => "What is the text in the image?".into(),
            Self::OcrWithRegion => "What is the text in the image, with regions?".into(),
        }
    }

    /// How answers are written.
    #[must_use]
    pub fn grammar(&self) -> Grammar {
        match self {
            Self::ObjectDetection | Self::DenseRegionCaption => Grammar::LabelledBoxes,
            Self::RegionProposal => Grammar::Boxes,
            Self::PhraseGrounding(_) => Grammar::GroundedPhrases,
            Self::OpenVocabularyDetection(_) => Grammar::BoxesOrPolygons,
            Self::ReferringSegmentation(_) | Self::RegionToSegmentation(_) => Grammar::Polygons,
            Self::OcrWithRegion => Grammar::Quads,
            _ => Grammar::Text,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_become_sentences() {
        let prompt = |tag| Task::from_tag(tag).map(|task| task.prompt());
        assert_eq!(
            prompt("<OPEN_VOCABULARY_DETECTION>a red bag").as_deref(),
            Some("Locate a red bag in the image.")
        );
        assert_eq!(
            prompt("<REGION_TO_CATEGORY><loc_1><loc_2><loc_3><loc_4>").as_deref(),
            Some("What is the region <loc_1><loc_2><loc_3><loc_4>?")
        );
        let wrong = ["OD", "<OD>person", "<FLY>", "<REGION_TO_OCR><loc_1><loc_2><loc_3>", ""];
        assert_eq!(wrong.map(prompt), [None, None, None, None, None]);
    }
}
