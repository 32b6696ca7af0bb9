//! Faces by CenterFace (Xu et al. 2020) on 480 x 480 pixels, with eyes, nose and corners of the
//! mouth.

use std::fmt;

use jrdb_types::{Image, PixelBox};

use crate::detector::PerceptionError;
use crate::engine::{Engine, Tensor};
use crate::image::{Filter, resize};
use crate::tiling::{ScoredBox, nms};

/// Side of the model's input, pixels.
const SIDE: usize = 480;
/// Pixels of the input to a cell of its outputs.
const STRIDE: usize = 4;
const CELLS: usize = SIDE / STRIDE;
const PLANE: usize = CELLS * CELLS;
/// Names of the tensors: input f32 `[1, 3, 480, 480]`; probability, size (height, width), shift
/// (down, right) and five landmarks (down, right each), f32 `[1, 1 | 2 | 2 | 10, 120, 120]`.
const INPUT: &str = "input.1";
const OUTPUTS: [(&str, usize); 4] = [("537", 1), ("538", 2), ("539", 2), ("540", 10)];
/// Faces that overlap by more are one.
const NMS_IOU: f64 = 0.3;

/// A face in a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Face {
    /// Where, pixels of the picture.
    pub bbox: PixelBox,
    /// Confidence in `[0, 1]`.
    pub score: f64,
    /// Right and left eye, tip of the nose, right and left corner of the mouth, as seen from the
    /// face itself, so that the right eye of who looks at us is on our left; pixels of the picture.
    pub landmarks: [[f64; 2]; 5],
}

/// Finds faces in a picture.
pub struct FaceFinder {
    engine: Box<dyn Engine>,
}

impl fmt::Debug for FaceFinder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FaceFinder").field("engine", &self.engine.name()).finish()
    }
}

impl FaceFinder {
    /// On an engine that has loaded the model.
    #[must_use]
    pub fn new(engine: Box<dyn Engine>) -> Self {
        Self { engine }
    }

    /// Faces of at least this confidence, most confident first.
    ///
    /// # Errors
    /// When the model cannot be used.
    pub fn find(&self, picture: &Image, min_score: f64) -> Result<Vec<Face>, PerceptionError> {
        if picture.rgb.is_empty() {
            return Ok(Vec::new());
        }
        let scale = SIDE as f64 / picture.width.max(picture.height) as f64;
        let names = OUTPUTS.map(|(name, _)| name);
        let outputs = self.engine.run(&[(INPUT, &input(picture, scale))], &names)?;
        let planes = |index: usize| planes(&outputs, index);
        let maps =
            Maps { score: planes(0)?, size: planes(1)?, shift: planes(2)?, marks: planes(3)? };
        let sure = (0..PLANE).filter(|&cell| f64::from(maps.score[cell]) >= min_score);
        let faces = sure.map(|cell| maps.face(cell, scale));
        let faces: Vec<Face> = faces.filter(|face| face.bbox.is_proper()).collect();
        Ok(distinct(&faces))
    }
}

/// The model's outputs, each a number of planes.
struct Maps<'a> {
    score: &'a [f32],
    size: &'a [f32],
    shift: &'a [f32],
    marks: &'a [f32],
}

impl Maps<'_> {
    /// The face that a cell encodes, in pixels of a picture that was scaled by `scale`.
    fn face(&self, cell: usize, scale: f64) -> Face {
        let at = |map: &[f32], plane: usize| f64::from(map[plane * PLANE + cell]);
        let stride = STRIDE as f64;
        let (h, w) = (at(self.size, 0).exp() * stride, at(self.size, 1).exp() * stride);
        let middle = |place: usize, shift: f64| (place as f64 + shift + 0.5) * stride;
        let y = middle(cell / CELLS, at(self.shift, 0)) - h / 2.0;
        let x = middle(cell % CELLS, at(self.shift, 1)) - w / 2.0;
        let mark = |i: usize| {
            let (down, right) = (at(self.marks, 2 * i), at(self.marks, 2 * i + 1));
            [x + right * w, y + down * h].map(|v| v / scale)
        };
        let bbox = PixelBox::from([x, y, w, h].map(|v| v / scale));
        Face { bbox, score: at(self.score, 0), landmarks: [0, 1, 2, 3, 4].map(mark) }
    }
}

/// The best of every group of boxes that show one face.
fn distinct(faces: &[Face]) -> Vec<Face> {
    let boxes: Vec<ScoredBox> =
        faces.iter().map(|face| ScoredBox { bbox: face.bbox, score: face.score }).collect();
    let find = |kept: ScoredBox| faces.iter().find(|face| face.bbox == kept.bbox).copied();
    nms(&boxes, NMS_IOU, None).into_iter().filter_map(find).collect()
}

/// The picture scaled into the upper left corner, the rest black: planes of red, green and blue, 0
/// to 255.
fn input(picture: &Image, scale: f64) -> Tensor {
    let scaled = |length: usize| ((length as f64 * scale).round() as usize).clamp(1, SIDE);
    let (width, height) = (scaled(picture.width), scaled(picture.height));
    let small = resize(picture, width, height, Filter::Bilinear);
    let mut data = vec![0.0; 3 * SIDE * SIDE];
    for (y, row) in small.rgb.chunks_exact(3 * width).enumerate() {
        for (x, pixel) in row.chunks_exact(3).enumerate() {
            for (channel, &byte) in pixel.iter().enumerate() {
                data[channel * SIDE * SIDE + y * SIDE + x] = f32::from(byte);
            }
        }
    }
    Tensor::F32 { shape: vec![1, 3, SIDE, SIDE], data }
}

/// One output's numbers, of the shape that it must have.
fn planes(outputs: &[Tensor], index: usize) -> Result<&[f32], PerceptionError> {
    let (name, count) = OUTPUTS[index];
    let expected = [1, count, CELLS, CELLS];
    let found = match outputs.get(index) {
        Some(Tensor::F32 { shape, data }) if shape[..] == expected => return Ok(data),
        Some(other) => other.describe(),
        None => "nothing".into(),
    };
    Err(PerceptionError::Output { name, expected: format!("f32 {expected:?}"), found })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixed::Fixed;

    /// Sees a face of 40 x 40 pixels of its input, centred on cell (10, 20), all landmarks in its
    /// middle.
    fn finder() -> FaceFinder {
        let values = [0.0, 10.0_f32.ln(), 0.0, 0.5];
        let tensor = |(index, (_, count)): (usize, &(&str, usize))| {
            let mut data = vec![values[index]; count * PLANE];
            if index == 0 {
                data[20 * CELLS + 10] = 0.9;
            }
            Tensor::F32 { shape: vec![1, *count, CELLS, CELLS], data }
        };
        FaceFinder::new(Box::new(Fixed(OUTPUTS.iter().enumerate().map(tensor).collect())))
    }

    #[test]
    fn a_cell_becomes_a_face_in_pixels_of_the_picture() {
        let found = finder().find(&Image::filled(240, 120, [9; 3]), 0.5).unwrap();
        let [face] = found[..] else { panic!("{found:?}") };
        for (found, expected) in
            [(face.bbox.x, 11.0), (face.bbox.y, 31.0), (face.bbox.w, 20.0), (face.bbox.h, 20.0)]
        {
            assert!((found - expected).abs() < 1e-4, "{face:?}");
        }
        assert!(
            (face.landmarks[2][0] - 21.0).abs() < 1e-4
                && (face.landmarks[2][1] - 41.0).abs() < 1e-4
        );
        assert!(
            finder().find(&Image { width: 0, height: 0, rgb: Vec::new() }, 0.5).unwrap().is_empty()
        );
    }

    #[test]
    fn a_wide_picture_fills_the_upper_part_of_the_input() {
        let Tensor::F32 { data, .. } = input(&Image::filled(20, 10, [1, 2, 3]), 24.0) else {
            panic!("not floats")
        };
        let at = |channel: usize, y: usize, x: usize| data[channel * SIDE * SIDE + y * SIDE + x];
        assert_eq!((at(0, 0, 0), at(2, 239, 479), at(1, 240, 0)), (1.0, 3.0, 0.0));
    }
}
