//! The panorama with everyone's box, the answer highlighted.

use jrdb_types::{Entity, Image, PixelBox};

use crate::canvas::{Letters, text_size};
use crate::{BLACK, Canvas, Caption, Color, FrameView, Role, WHITE, witnesses};

/// Height of the strip that holds question and answer, pixels.
const STRIP_PX: usize = 104;

/// The panorama below a strip with question and answer: every box with its id and distance, the
/// selected ones green, their partners orange, guesses dashed and grey. A box across the seam is drawn as its two parts.
/// Without a picture the ground is grey.
#[must_use]
pub fn draw_panorama(frame: &FrameView<'_>, caption: Option<Caption<'_>>) -> Image {
    let size = frame.geometry;
    let (width, height) = (size.width_px as usize, size.height_px as usize);
    let mut canvas = Canvas::filled(width, height + STRIP_PX, [70; 3]);
    if let Some(image) = frame.image {
        canvas.image(image, 0, STRIP_PX as i32);
    }
    canvas.fill_rect([0.0, 0.0, width as f64, STRIP_PX as f64], BLACK, 1.0);
    if let Some(caption) = caption {
        strip(&mut canvas, caption);
    }
    let answer = caption.map(|caption| caption.answer);
    let mut entities: Vec<(Role, &Entity)> =
        frame.entities.iter().map(|e| (Role::of(&e.id, answer), e)).collect();
    // The answer last, so that nothing lies over it.
    entities.sort_by_key(|(role, _)| *role);
    for (role, entity) in entities {
        draw_box(&mut canvas, entity, role, f64::from(size.width_px));
    }
    canvas.to_image()
}

fn strip(canvas: &mut Canvas, Caption { question, answer }: Caption<'_>) {
    canvas.text(question, [16.0, 8.0], Letters::Huge, WHITE);
    let words = format!("answer: {}", jrdb_render::headline(answer));
    canvas.text(&words, [16.0, 54.0], Letters::Huge, crate::reply_color(answer.status));
    let partners: Vec<String> = witnesses(answer)
        .map(|(of, partner)| format!("{} with {}", of.short(), partner.short()))
        .collect();
    if !partners.is_empty() {
        let at = [16.0 + text_size(&words, Letters::Huge)[0] + 40.0, 54.0];
        canvas.text(&partners.join(", "), at, Letters::Huge, crate::WITNESS);
    }
}

/// The parts of a box that lie in `[0, width)`: one, or two across the seam.
fn parts(bbox: &PixelBox, width: f64) -> Vec<[f64; 4]> {
    let right = bbox.x + bbox.w;
    let whole = [bbox.x, bbox.y, bbox.w.min(width - bbox.x), bbox.h];
    let wrapped = (right > width).then_some([0.0, bbox.y, (right - width).min(bbox.x), bbox.h]);
    std::iter::once(whole).chain(wrapped).collect()
}

fn draw_box(canvas: &mut Canvas, entity: &Entity, role: Role, width: f64) {
    let color = role.color();
    let stroke = if role == Role::Other { 2.0 } else { 5.0 };
    let distance = entity.from_robot.and_then(|r| r.distance_m).map(|m| format!(" {m:.1} m"));
    let text = format!("{}{}", entity.id.short(), distance.unwrap_or_default());
    for [x, y, w, h] in parts(&entity.bbox, width) {
        let y = y + STRIP_PX as f64;
        // Outlines stay inside the box, so that neighbours can be told apart.
        let inset = f64::from(stroke) / 2.0;
        let rect = [x + inset, y + inset, (w - 2.0 * inset).max(0.0), (h - 2.0 * inset).max(0.0)];
        match role {
            Role::Guess => canvas.dashed_rect(rect, color, stroke),
            _ => canvas.rect(rect, color, stroke),
        }
        label(canvas, &text, [x, y], color, role);
    }
}

fn label(canvas: &mut Canvas, text: &str, [x, y]: [f64; 2], color: Color, role: Role) {
    let letters = if role == Role::Other { Letters::Large } else { Letters::Huge };
    let above = y - text_size(text, letters)[1] - 2.0;
    canvas.label(text, [x, above.max(STRIP_PX as f64)], letters, [BLACK, color]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_across_the_seam_has_two_parts() {
        let bbox = PixelBox::from([3700.0, 10.0, 100.0, 50.0]);
        assert_eq!(parts(&bbox, 3760.0), [[3700.0, 10.0, 60.0, 50.0], [0.0, 10.0, 40.0, 50.0]]);
        let bbox = PixelBox::from([100.0, 10.0, 100.0, 50.0]);
        assert_eq!(parts(&bbox, 3760.0), [[100.0, 10.0, 100.0, 50.0]]);
    }
}
