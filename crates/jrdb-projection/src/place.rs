//! The first half of the stage: where detections are in space, before anything is known of headings.

use jrdb_types::detection::PERSON;
use jrdb_types::vocab::PlacementQuality;
use jrdb_types::{Detection, Detections, FloorPlane, Localizer, Position};
use nalgebra::Point3;

use crate::box_view::BoxView;
use crate::localize::{self, Located, densest_range::Target};
use crate::person_box::person_box;
use crate::quality::{Depths, quality};
use crate::select::points_in_boxes;
use crate::{BaseCloud, CameraModel, Error, ProjectionConfig, Sensors};

/// What detections are placed in: one frame's points, the sensors that saw them, and the floor.
#[derive(Clone, Copy)]
pub struct Space<'a> {
    /// All sweeps of the frame, base frame, metres.
    pub cloud: &'a BaseCloud,
    /// The camera that the detections were made with, and the LiDARs.
    pub sensors: &'a Sensors,
    /// The floor, where it is known.
    pub floor: Option<FloorPlane>,
}

/// Where one detection is in space; `None` inside when no point and no 3D box tells.
#[derive(Debug, Clone, PartialEq)]
pub struct Placement(pub(crate) Option<Spot>);

impl Placement {
    /// Nothing tells where it is.
    pub const UNKNOWN: Self = Self(None);
}

/// A position and the points that it was found from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Spot {
    pub(crate) position: Position,
    /// The centre by the points alone: of people, the height is that of the LiDAR's rings.
    pub(crate) of_points: Point3<f64>,
    pub(crate) own: Vec<u32>,
    pub(crate) up_to_it: Vec<u32>,
}

impl Placement {
    /// The centre, base frame, metres.
    #[must_use]
    pub fn center_m(&self) -> Option<[f64; 3]> {
        self.0.as_ref().map(|spot| spot.position.center)
    }
}

/// Places every detection in space, in the order of the detections.
///
/// Positions do not depend on headings, so they can be compared over several frames before headings
/// are derived from motion; [`crate::entities`] does the rest.
///
/// # Errors
/// [`Error::ImageSize`] when the detections were made on an image of another size than the camera's.
pub fn place(
    detections: &Detections,
    space: &Space<'_>,
    config: &ProjectionConfig,
) -> Result<Vec<Placement>, Error> {
    tracing::trace!(target: "jrdb::place", frame = %detections.frame);
    let camera = &space.sensors.camera;
    let image = camera.image();
    let expected_px = [image.width_px, image.height_px];
    let found_px = [detections.image.width_px, detections.image.height_px];
    if expected_px != found_px {
        return Err(Error::ImageSize { expected_px, found_px });
    }
    let boxes: Vec<_> = detections.detections.iter().map(|d| d.bbox).collect();
    let inside = points_in_boxes(space.cloud, &boxes, image);
    let placer = Placer { cloud: space.cloud, camera, config };
    let all = detections.detections.iter().zip(&inside);
    Ok(all.map(|(detection, inside)| Placement(placer.spot(detection, inside))).collect())
}

struct Placer<'a> {
    cloud: &'a BaseCloud,
    camera: &'a dyn CameraModel,
    config: &'a ProjectionConfig,
}

impl Placer<'_> {
    fn spot(&self, detection: &Detection, inside: &[u32]) -> Option<Spot> {
        match self.config.localizer {
            Localizer::Given => self.given(detection, inside),
            Localizer::Mean | Localizer::DensestRange => self.by_points(detection, inside),
        }
    }

    fn by_points(&self, detection: &Detection, inside: &[u32]) -> Option<Spot> {
        let is_person = detection.category == PERSON;
        let (cloud, config) = (self.cloud, self.config);
        let view = BoxView::new(&detection.bbox, self.camera);
        let Located { center: of_points, used } = match config.localizer {
            Localizer::Mean => localize::mean(cloud, inside),
            _ => {
                let (bbox, image) = (&detection.bbox, self.camera.image());
                let target = Target { bbox, image, view, is_person };
                localize::densest_range(cloud, inside, &target, config)
            }
        }?;
        let person = view.filter(|_| is_person);
        // The mean is the paper's own centre; the median height of a few rings is not a person's middle.
        let center = match (config.localizer, &person) {
            (Localizer::DensestRange, Some(view)) => {
                person_box(&of_points, view, None, config).center
            }
            _ => of_points.into(),
        };
        let ranges = used.iter().map(|&i| cloud.point(i as usize).coords.xy().norm());
        let range_m =
            ranges.fold([f64::INFINITY, 0.0], |[near, far], r| [near.min(r), f64::max(far, r)]);
        let depths = Depths::new(cloud, inside, range_m);
        let visible_fraction = depths.visible_fraction();
        let position = Position {
            center,
            localizer: config.localizer,
            points_in_box: inside.len(),
            points_used: used.len(),
            range_m,
            visible_fraction,
            quality: quality(used.len(), range_m, visible_fraction, person.as_ref(), config),
        };
        Some(Spot { position, of_points, own: used, up_to_it: depths.up_to_it })
    }

    fn given(&self, detection: &Detection, inside: &[u32]) -> Option<Spot> {
        let box3d = detection.box3d?;
        let of_points = Point3::from(box3d.center);
        let half_m = box3d.size[0].hypot(box3d.size[1]) / 2.0;
        let middle_m = of_points.x.hypot(of_points.y);
        let range_m = [(middle_m - half_m).max(0.0), middle_m + half_m];
        let depths = Depths::new(self.cloud, inside, range_m);
        let position = Position {
            center: box3d.center,
            localizer: Localizer::Given,
            points_in_box: inside.len(),
            points_used: 0,
            range_m,
            visible_fraction: depths.visible_fraction(),
            quality: PlacementQuality::Good,
        };
        let Depths { own, up_to_it } = depths;
        Some(Spot { position, of_points, own, up_to_it })
    }
}
