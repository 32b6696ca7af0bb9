//! All places of all views, and what the images say of them once a LiDAR has moved.

use std::collections::BTreeMap;

use jrdb_projection::CameraModel;
use jrdb_types::calibration::{Freedom, Motion};
use nalgebra::Point3;

use super::candidate::{Candidate, Candidates};
use super::gradient::EdgeImage;
use super::motion::about;
use super::score::{Curve, Sum};
use super::{FitConfig, View};
use crate::Error;

/// What the views say of every LiDAR.
pub(super) struct Evidence<'a> {
    images: Vec<(&'a dyn CameraModel, EdgeImage)>,
    /// By name: the view and what the LiDAR sees there.
    lidars: BTreeMap<&'a str, Vec<(usize, Candidates)>>,
    units: usize,
}

/// Which edges are asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Edges {
    /// Those that fix columns.
    Upright,
    /// Those that fix rows.
    Level,
    /// All.
    Both,
}

impl<'a> Evidence<'a> {
    pub(super) fn new(views: &[View<'a>], config: &FitConfig) -> Result<Self, Error> {
        config.check()?;
        let (mut images, mut lidars) = (Vec::new(), BTreeMap::<_, Vec<_>>::new());
        for (index, view) in views.iter().enumerate() {
            images.push((view.camera, edge_image(view, config)?));
            for sweep in view.sweeps {
                check_finite(sweep.sensor, sweep.origin, sweep.points)?;
                let first_unit = index * config.sectors;
                let seen = (view.camera, first_unit);
                let found = Candidates::of(sweep.origin, sweep.points, seen, config);
                lidars.entry(sweep.sensor).or_default().push((index, found));
            }
        }
        if lidars.is_empty() {
            return Err(Error::NoSweep);
        }
        Ok(Self { images, lidars, units: views.len() * config.sectors })
    }

    /// Names of the LiDARs, sorted.
    pub(super) fn sensors(&self) -> impl Iterator<Item = &'a str> {
        self.lidars.keys().copied()
    }

    /// What the images say of one LiDAR's places once it has moved, per unit.
    pub(super) fn units(&self, sensor: &str, motion: &Motion, edges: Edges) -> Vec<Sum> {
        let mut units = vec![Sum::default(); self.units];
        for (view, candidates) in self.lidars.get(sensor).into_iter().flatten() {
            let (camera, image) = &self.images[*view];
            let moved = about(motion, &candidates.origin);
            let mut add = |candidate: &Candidate| {
                let strength = candidate.strength(&moved, *camera, image);
                units[candidate.unit].add(strength, candidate.is_end);
            };
            if edges != Edges::Level {
                candidates.upright.iter().for_each(&mut add);
            }
            if edges != Edges::Upright {
                candidates.level.iter().for_each(&mut add);
            }
        }
        units
    }

    /// The evidence along one freedom, at `count` steps on either side of zero; the others stay as they are.
    pub(super) fn curve(
        &self,
        sensor: &str,
        (motion, freedom): (&Motion, Freedom),
        (step, count): (f64, i32),
        edges: Edges,
    ) -> Curve {
        let positions: Vec<f64> = (-count..=count).map(|i| f64::from(i) * step).collect();
        let at = |x: &f64| self.units(sensor, &motion.with(freedom, *x), edges);
        let units = positions.iter().map(at).collect();
        Curve { positions, units }
    }
}

fn edge_image(view: &View<'_>, config: &FitConfig) -> Result<EdgeImage, Error> {
    let expected = view.camera.image();
    let size = [view.image.width, view.image.height];
    let wanted = [expected.width_px, expected.height_px].map(|side| side as usize);
    let bytes = view.image.rgb.len();
    if size != wanted || size.contains(&0) || size[0].checked_mul(size[1] * 3) != Some(bytes) {
        return Err(Error::ImageSize { expected: wanted, found: size, bytes });
    }
    Ok(EdgeImage::new(view.image, expected.wraps, config.blur_px))
}

fn check_finite(sensor: &str, origin: Point3<f64>, points: &[Point3<f64>]) -> Result<(), Error> {
    let all = std::iter::once(&origin).chain(points);
    let bad = all.enumerate().find(|(_, p)| !p.iter().all(|c| c.is_finite()));
    bad.map_or(Ok(()), |(place, found)| {
        let source = Error::NonFinite { index: place.saturating_sub(1), found: *found };
        Err(Error::Sweep { sensor: sensor.into(), source: Box::new(source) })
    })
}
