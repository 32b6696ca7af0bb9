//! Boxes in the answers of vision-language models.

use crate::detector::PerceptionError;
use crate::json::parse_json;

/// A box in an answer.
#[derive(Debug, Clone, PartialEq)]
pub struct JsonBox {
    /// Its name; empty if it has none.
    pub label: String,
    /// Corners x0, y0, x1, y1, pixels of the original picture.
    pub corners: [f64; 4],
}

/// Reads boxes from an answer in JSON, with or without a fence around it.
///
/// The answer is a list of objects with corners, a list of corners, or one of these; its numbers
/// are pixels of the resized picture. `scale` converts them to pixels of the original picture, along x and y.
///
/// # Errors
/// [`PerceptionError::File`] if the answer holds no JSON. Entries without four numbers are skipped.
///
/// ```
/// use jrdb_perception::prompts::json_boxes;
/// let found = json_boxes("```json\n[{\"bbox_2d\": [1, 2, 3, 4], \"label\": \"person\"}]\n```", [2.0, 1.0]).unwrap();
/// assert_eq!((found[0].label.as_str(), found[0].corners), ("person", [2.0, 2.0, 6.0, 4.0]));
/// ```
pub fn json_boxes(answer: &str, scale: [f64; 2]) -> Result<Vec<JsonBox>, PerceptionError> {
    let start = answer.find(['[', '{']).unwrap_or(0);
    let end = answer.rfind([']', '}']).map_or(answer.len(), |at| at + 1);
    let inside = answer.get(start..end.max(start)).unwrap_or_default();
    let value: serde_json::Value = parse_json("answer in JSON", inside)?;
    let entries = match value {
        serde_json::Value::Array(entries) if corners(&entries).is_none() => entries,
        single => vec![single],
    };
    let read = |entry: &serde_json::Value| {
        let named = ["bbox_2d", "bbox", "box"].iter().find_map(|key| entry.get(key));
        let corners = corners(named.unwrap_or(entry).as_array()?)?;
        let corners = std::array::from_fn(|axis| corners[axis] * scale[axis % 2]);
        let label = entry.get("label").and_then(|label| label.as_str()).unwrap_or_default();
        Some(JsonBox { label: label.into(), corners })
    };
    Ok(entries.iter().filter_map(read).collect())
}

/// The corners that four numbers are.
fn corners(entries: &[serde_json::Value]) -> Option<[f64; 4]> {
    let numbers: Option<Vec<f64>> = entries.iter().map(serde_json::Value::as_f64).collect();
    numbers?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_come_in_many_forms() {
        let read = |answer: &str| json_boxes(answer, [1.0, 1.0]).map(|found| found.len());
        assert_eq!(read("{\"bbox\": [1, 2, 3, 4]}").unwrap(), 1);
        assert_eq!(
            read("Sure! [{\"box\": [1, 2, 3, 4]}, {\"box\": [1, 2]}, {}] Anything else?").unwrap(),
            1
        );
        assert_eq!(read("[]").unwrap(), 0);
        for broken in ["I see nobody.", "", "]{", "[{\"bbox_2d\": [1, 2"] {
            assert!(read(broken).unwrap_err().to_string().contains("answer in JSON"), "{broken}");
        }
    }
}
