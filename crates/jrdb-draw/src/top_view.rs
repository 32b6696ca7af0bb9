//! The scene from above: robot, people with their headings, range rings, relations of the answer.

use jrdb_projection::BaseCloud;
use jrdb_types::detection::PERSON;
use jrdb_types::{Answer, DistanceWord, Entity, EntityId, Image};

use crate::canvas::{Letters, text_size};
use crate::{ANSWER, BLACK, Canvas, Caption, FrameView, Role, WHITE, WITNESS, witnesses};

/// Side of the picture, pixels.
const SIDE_PX: usize = 1000;
/// At least this range is shown, metres.
const RANGE_MIN_M: f64 = 4.0;
/// At most this range is shown, metres.
const RANGE_MAX_M: f64 = 20.0;
/// Half the width of a person in the picture, metres.
const PERSON_RADIUS_M: f64 = 0.25;

const GROUND: [u8; 3] = [24, 27, 33];
const RING: [u8; 3] = [70, 76, 88];
const POINT: [u8; 3] = [84, 92, 106];

/// From above: the robot in the middle looks up, its left is left. Rings stand where distance words
/// change; people are circles with a tick towards their heading, objects are squares; arrows go from each selected person to
/// the partner of its relation.
#[must_use]
pub fn draw_top_view(frame: &FrameView<'_>, caption: Option<Caption<'_>>) -> Image {
    let entities = frame.entities;
    let mut view = View::around(entities);
    if let Some(cloud) = frame.cloud {
        view.points(cloud);
    }
    view.rings();
    view.robot();
    let answer = caption.map(|caption| caption.answer);
    for entity in entities {
        view.thing(entity, Role::of(&entity.id, answer));
    }
    if let Some(answer) = answer {
        view.arrows(answer, entities);
    }
    if let Some(caption) = caption {
        view.title(caption.question);
    }
    view.canvas.to_image()
}

struct View {
    canvas: Canvas,
    px_per_m: f64,
    range_m: f64,
}

fn place(entity: &Entity) -> Option<[f64; 2]> {
    entity.position.map(|p| [p.center[0], p.center[1]])
}

impl View {
    fn around(entities: &[Entity]) -> Self {
        let ranges = entities.iter().filter_map(place).map(|[x, y]| x.hypot(y));
        let range_m = (ranges.fold(0.0, f64::max) * 1.15).clamp(RANGE_MIN_M, RANGE_MAX_M);
        let px_per_m = SIDE_PX as f64 / (2.0 * range_m);
        Self { canvas: Canvas::filled(SIDE_PX, SIDE_PX, GROUND), px_per_m, range_m }
    }

    /// Forward is up, left is left.
    fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let middle = SIDE_PX as f64 / 2.0;
        [middle - y * self.px_per_m, middle - x * self.px_per_m]
    }

    fn rings(&mut self) {
        let middle = self.pixel([0.0, 0.0]);
        for word in DistanceWord::ALL {
            let (_, edge_m) = word.bounds_m();
            if edge_m.is_finite() && edge_m < self.range_m * 1.4 {
                self.canvas.circle(middle, edge_m * self.px_per_m, RING, 2.0);
                // Behind the robot to the right, where the ring has the most room.
                let corner_m = -edge_m * std::f64::consts::FRAC_1_SQRT_2;
                let at = self.pixel([corner_m, corner_m]);
                self.canvas.text(&format!("{edge_m} m"), at, Letters::Small, RING.map(|c| c + 70));
            }
        }
    }

    fn robot(&mut self) {
        let nose = [[0.35, 0.0], [-0.2, 0.2], [-0.1, 0.0], [-0.2, -0.2]].map(|p| self.pixel(p));
        self.canvas.polygon(&nose, WHITE);
        let at = self.pixel([-0.25, 0.0]);
        let half = text_size("robot", Letters::Small)[0] / 2.0;
        self.canvas.text("robot", [at[0] - half, at[1]], Letters::Small, WHITE);
    }

    fn thing(&mut self, entity: &Entity, role: Role) {
        let Some(center) = place(entity) else { return };
        let at = self.pixel(center);
        let radius = (PERSON_RADIUS_M * self.px_per_m).max(6.0);
        if entity.category == PERSON {
            self.person(entity, center, radius, role);
        } else {
            let square = [at[0] - radius, at[1] - radius, 2.0 * radius, 2.0 * radius];
            if role != Role::Other {
                self.canvas.fill_rect(square, role.color(), 1.0);
            }
            self.canvas.rect(square, role.color(), 2.0);
        }
        let label = [at[0] + radius + 3.0, at[1] - radius - 8.0];
        self.canvas.label(&entity.id.short(), label, Letters::Small, [BLACK, role.color()]);
    }

    fn points(&mut self, cloud: &BaseCloud) {
        for (&x, &y) in cloud.x.iter().zip(&cloud.y) {
            self.canvas.dot(self.pixel([x, y].map(f64::from)), POINT);
        }
    }

    fn person(&mut self, person: &Entity, center: [f64; 2], radius: f64, role: Role) {
        let at = self.pixel(center);
        if role != Role::Other {
            self.canvas.disc(at, radius, role.color());
        }
        self.canvas.circle(at, radius, role.color(), 2.0);
        if let Some(heading) = person.heading {
            let ahead = 2.2 * PERSON_RADIUS_M;
            let (sin, cos) = heading.angle_rad.sin_cos();
            let tip = [center[0] + ahead * cos, center[1] + ahead * sin];
            let tip = self.pixel(tip);
            self.canvas.line(&[at, tip], role.color(), 3.0);
        }
    }

    fn arrows(&mut self, answer: &Answer, entities: &[Entity]) {
        let find = |id: &EntityId| entities.iter().find(|e| e.id == *id).and_then(place);
        for (of, partner) in witnesses(answer) {
            let (Some(from), Some(to)) = (find(of), find(partner)) else { continue };
            let (from, to) = (self.pixel(from), self.pixel(to));
            self.canvas.dashed_line(&[from, to], WITNESS, 3.0);
            self.arrow_head(from, to);
        }
        for id in answer.selection.iter().filter_map(find) {
            let (robot, at) = (self.pixel([0.0, 0.0]), self.pixel(id));
            self.canvas.dashed_line(&[robot, at], ANSWER, 1.0);
        }
    }

    fn arrow_head(&mut self, from: [f64; 2], to: [f64; 2]) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = dx.hypot(dy).max(1.0);
        let (ux, uy) = (dx / length, dy / length);
        let radius = (PERSON_RADIUS_M * self.px_per_m).max(6.0);
        let tip = [to[0] - ux * radius, to[1] - uy * radius];
        let back = [tip[0] - 14.0 * ux, tip[1] - 14.0 * uy];
        let wing = |side: f64| [back[0] - side * 6.0 * uy, back[1] + side * 6.0 * ux];
        self.canvas.polygon(&[tip, wing(1.0), wing(-1.0)], WITNESS);
    }

    fn title(&mut self, question: &str) {
        let per_line = SIDE_PX / 10 - 2;
        let mut lines = vec![String::new()];
        for word in question.split_whitespace() {
            let last = lines.len() - 1;
            if !lines[last].is_empty() && lines[last].len() + word.len() >= per_line {
                lines.push(word.into());
            } else {
                let blank = if lines[last].is_empty() { "" } else { " " };
                lines[last] = format!("{}{blank}{word}", lines[last]);
            }
        }
        for (line, row) in lines.iter().take(3).zip(0..) {
            self.canvas.text(line, [10.0, 8.0 + 22.0 * f64::from(row)], Letters::Large, WHITE);
        }
    }
}
