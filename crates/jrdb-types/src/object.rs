//! Classes of objects, which datasets and detectors name each in their own way.

/// The category of people.
pub const PERSON: &str = "person";

/// A class and the wider one that it is a kind of. The widest are JRDB's panoptic classes as its labels spell them; the others are
/// COCO's classes, which most detectors know, and plain words.
const KINDS: [(&str, &str); 45] = [
    ("armchair", "chair"),
    ("backpack", "bag"),
    ("bench", "chair/sofa"),
    ("bicycle", "bicycle/scooter"),
    ("bin", "trash_bin"),
    ("bird", "animal"),
    ("book", "document"),
    ("bottle", "waterbottle"),
    ("bowl", "tableware"),
    ("bus", "big_vehicle"),
    ("cat", "animal"),
    ("cell phone", "phone"),
    ("chair", "chair/sofa"),
    ("couch", "chair/sofa"),
    ("cup", "tableware"),
    ("desk", "table"),
    ("dining table", "table"),
    ("dog", "animal"),
    ("elevator", "lift"),
    ("fence", "barrier/fence"),
    ("fork", "tableware"),
    ("handbag", "bag"),
    ("horse", "animal"),
    ("hoverboard", "skateboard/segway/hoverboard"),
    ("knife", "tableware"),
    ("laptop", "monitor"),
    ("machine", "machines"),
    ("picture frame", "picture_frames"),
    ("plant", "decoration"),
    ("plate", "tableware"),
    ("pole", "pole/trafficcone"),
    ("potted plant", "plant"),
    ("remote", "controller"),
    ("scooter", "bicycle/scooter"),
    ("segway", "skateboard/segway/hoverboard"),
    ("skateboard", "skateboard/segway/hoverboard"),
    ("sofa", "couch"),
    ("spoon", "tableware"),
    ("statue", "statues"),
    ("stop sign", "sign"),
    ("suitcase", "bag"),
    ("traffic cone", "pole/trafficcone"),
    ("truck", "big_vehicle"),
    ("tv", "television"),
    ("wine glass", "tableware"),
];

/// Whether a thing of one class may be what is asked for: it is of that class or of a kind of it, or its class is so wide that what is
/// asked for is a kind of it.
///
/// ```
/// use jrdb_types::object::may_be;
/// assert!(may_be("bench", "bench") && may_be("potted plant", "plant"));
/// assert!(may_be("chair/sofa", "bench"), "JRDB's labels cannot tell");
/// assert!(!may_be("couch", "bench"));
/// ```
#[must_use]
pub fn may_be(found: &str, asked: &str) -> bool {
    found == asked || is_kind_of(found, asked) || is_kind_of(asked, found)
}

fn is_kind_of(class: &str, wider: &str) -> bool {
    std::iter::successors(wider_than(class), |class| wider_than(class)).any(|class| class == wider)
}

fn wider_than(class: &str) -> Option<&'static str> {
    let place = KINDS.binary_search_by_key(&class, |(kind, _)| kind).ok()?;
    Some(KINDS[place].1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_sorted_and_lead_to_an_end() {
        assert!(KINDS.is_sorted_by(|a, b| a.0 < b.0));
        for (kind, _) in KINDS {
            let steps = std::iter::successors(wider_than(kind), |class| wider_than(class));
            assert!(steps.take(5).count() < 5, "{kind}");
        }
    }

    #[test]
    fn kinds_of_kinds_count_and_siblings_do_not() {
        assert!(may_be("potted plant", "decoration"));
        assert!(may_be("decoration", "potted plant"));
        assert!(!may_be("laptop", "television"));
        assert!(!may_be("zebra", "animal"), "a name that is not here is only itself");
        assert!(may_be("zebra", "zebra"));
    }
}
