//! Lens distortion of pinholes in OpenCV's terms, with the radius up to which it is one-to-one.

use jrdb_types::lens::DistortionModel;
use nalgebra::{Matrix2, Point2, Vector2};

use super::monotonic;

/// No image reaches further than this from the optical axis, in focal lengths (89.9999°).
const MAX_RADIUS: f64 = 1e6;

/// Keeps the limit on the near side of a pole, whichever way roundings fall.
const JUST_INSIDE: f64 = 1.0 - 1e-12;

/// Newton steps after the radial solution; small tangential terms need three or four.
const MAX_NEWTON_STEPS: usize = 50;

/// Times a Newton step is halved to stay within the limit and come nearer.
const MAX_HALVINGS: i32 = 20;

/// A [`DistortionModel`] with the radius up to which it is one-to-one.
///
/// Barrel distortion bends back on itself: the polynomials of JRDB's lenses turn at 51° to 55° and draw points
/// at 60° inside the image again. Beyond the limit this type gives `None`, for the corners of such images too.
///
/// The limit: with `f(r) = r L(r²)` and `p = hypot(p1, p2)`, the first `r` with `f'(r) = 8 p r`. Up to there
/// the Jacobian's determinant is positive in every direction, as `f' ≥ 8 p r` and with it `f / r ≥ 4 p r` imply
/// `(f' + 6 p r cos ψ) (f / r + 2 p r cos ψ) > (2 p r sin ψ)²` for all ψ. Without tangential terms it is
/// the turning point of the radial polynomial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distortion {
    model: DistortionModel,
    terms: Terms,
    max_radius: f64,
}

impl From<DistortionModel> for Distortion {
    fn from(model: DistortionModel) -> Self {
        let terms = Terms::of(&model);
        let max_radius = match model {
            DistortionModel::None => f64::INFINITY,
            _ => terms.max_radius(),
        };
        Self { model, terms, max_radius }
    }
}

impl From<Distortion> for DistortionModel {
    fn from(distortion: Distortion) -> Self {
        distortion.model
    }
}

impl Default for Distortion {
    /// A rectified image.
    fn default() -> Self {
        DistortionModel::None.into()
    }
}

impl Distortion {
    /// The coefficients.
    #[must_use]
    pub fn model(&self) -> &DistortionModel {
        &self.model
    }

    /// Undistorted distance from the optical axis, in focal lengths (tangent of the incidence angle), up to
    /// which the model is one-to-one; infinite for a rectified image.
    #[must_use]
    pub fn max_radius(&self) -> f64 {
        self.max_radius
    }

    /// Where the lens draws the direction `(x, y, 1)`, or `None` beyond [`Distortion::max_radius`].
    #[must_use]
    pub fn distort(&self, ideal: &Point2<f64>) -> Option<Point2<f64>> {
        if self.model == DistortionModel::None {
            return Some(*ideal);
        }
        self.contains(ideal).then(|| self.terms.distort(ideal))
    }

    /// The direction `(x, y, 1)` that the lens draws at a distorted point, or `None` where it draws nothing.
    #[must_use]
    pub fn undistort(&self, distorted: &Point2<f64>) -> Option<Point2<f64>> {
        if self.model == DistortionModel::None {
            return Some(*distorted);
        }
        let mut ideal = self.radial_guess(distorted)?;
        for _ in 0..MAX_NEWTON_STEPS {
            let jacobian = self.terms.jacobian(&ideal);
            let residual = self.terms.distort(&ideal) - distorted;
            let size = 1.0 + distorted.coords.norm() + jacobian.norm() * ideal.coords.norm();
            if residual.norm() <= monotonic::RESIDUAL * size {
                return self.contains(&ideal).then_some(ideal);
            }
            // Whole steps go astray close to a pole or a turning point.
            let step = jacobian.try_inverse()? * residual;
            let nearer = |next: &Point2<f64>| {
                let left = self.terms.distort(next) - distorted;
                self.contains(next) && left.norm() < residual.norm()
            };
            ideal = (0..MAX_HALVINGS).map(|n| ideal - step * 0.5_f64.powi(n)).find(nearer)?;
        }
        None
    }

    fn contains(&self, ideal: &Point2<f64>) -> bool {
        ideal.coords.norm() < self.max_radius
    }

    /// The undistorted point without the tangential terms; the edge for points slightly out of reach.
    fn radial_guess(&self, distorted: &Point2<f64>) -> Option<Point2<f64>> {
        let target = distorted.coords.norm();
        if target == 0.0 {
            return Some(*distorted);
        }
        let (reach, _) = self.terms.radial(self.max_radius);
        let radial = |radius| self.terms.radial(radius);
        let radius = monotonic::invert(radial, target.min(reach), self.max_radius)?;
        Some(distorted * (radius / target))
    }
}

/// The model's coefficients in one form: absent ones are zero.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Terms {
    /// `1 k1 k2 k3`: powers of `s`.
    numerator: [f64; 4],
    /// `1 k4 k5 k6`: powers of `s`.
    denominator: [f64; 4],
    p1: f64,
    p2: f64,
}

impl Terms {
    fn of(model: &DistortionModel) -> Self {
        let ([k1, k2, k3], denominator, [p1, p2]) = match *model {
            DistortionModel::None => ([0.0; 3], [0.0; 3], [0.0; 2]),
            DistortionModel::BrownConrady { k1, k2, p1, p2, k3 } => {
                ([k1, k2, k3], [0.0; 3], [p1, p2])
            }
            DistortionModel::Rational { k1, k2, p1, p2, k3, k4, k5, k6 } => {
                ([k1, k2, k3], [k4, k5, k6], [p1, p2])
            }
        };
        let [k4, k5, k6] = denominator;
        Self { numerator: [1.0, k1, k2, k3], denominator: [1.0, k4, k5, k6], p1, p2 }
    }

    /// `L` and `dL/ds` at `s`.
    fn scale(&self, s: f64) -> (f64, f64) {
        let slope = |[_, a, b, c]: [f64; 4]| a + s * (2.0 * b + s * 3.0 * c);
        let bottom = monotonic::evaluate(&self.denominator, s);
        let scale = monotonic::evaluate(&self.numerator, s) / bottom;
        (scale, (slope(self.numerator) - scale * slope(self.denominator)) / bottom)
    }

    /// `f = r L(r²)` and its slope.
    fn radial(&self, radius: f64) -> (f64, f64) {
        let s = radius * radius;
        let (scale, slope) = self.scale(s);
        (radius * scale, scale + 2.0 * s * slope)
    }

    fn distort(&self, &Point2 { coords }: &Point2<f64>) -> Point2<f64> {
        let (x, y, s) = (coords.x, coords.y, coords.norm_squared());
        let (scale, _) = self.scale(s);
        let Self { p1, p2, .. } = *self;
        Point2::new(
            x * scale + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x),
            y * scale + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y,
        )
    }

    fn jacobian(&self, &Point2 { coords }: &Point2<f64>) -> Matrix2<f64> {
        let (x, y) = (coords.x, coords.y);
        let (scale, slope) = self.scale(coords.norm_squared());
        let tangential = Vector2::new(self.p2, self.p1);
        let (dx, dy) = (tangential.x * x, tangential.y * y);
        let cross = 2.0 * (x * y * slope + self.p1 * x + self.p2 * y);
        Matrix2::new(
            scale + 2.0 * x * x * slope + 2.0 * dy + 6.0 * dx,
            cross,
            cross,
            scale + 2.0 * y * y * slope + 6.0 * dy + 2.0 * dx,
        )
    }

    /// See [`Distortion`]. With `L = N/D` as polynomials in `r`, `f' - 8 p r` has the sign of
    /// `(N + r N') D - r N D' - 8 p r D²`, up to the first zero of `D`.
    fn max_radius(&self) -> f64 {
        let in_radius = |[one, a, b, c]: [f64; 4]| [one, 0.0, a, 0.0, b, 0.0, c];
        let (top, bottom) = (in_radius(self.numerator), in_radius(self.denominator));
        let times_radius = |p: &[f64]| monotonic::product(&[0.0, 1.0], p);
        let growth = monotonic::product(&monotonic::derivative(&times_radius(&top)), &bottom);
        let shrink = monotonic::product(&top, &times_radius(&monotonic::derivative(&bottom)));
        let sway = monotonic::product(
            &[0.0, 8.0 * self.p1.hypot(self.p2)],
            &monotonic::product(&bottom, &bottom),
        );
        let loss: Vec<f64> = monotonic::sum(&shrink, &sway).iter().map(|c| -c).collect();
        let pole = monotonic::positive_up_to(&bottom, MAX_RADIUS);
        JUST_INSIDE * monotonic::positive_up_to(&monotonic::sum(&growth, &loss), pole)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Typical of a 75° machine vision lens.
    pub(in crate::camera) const BARREL: DistortionModel =
        DistortionModel::BrownConrady { k1: -0.34, k2: 0.16, p1: 1e-4, p2: -7e-5, k3: -0.05 };

    /// Small enough for a limit to exist beyond the middle of the image, else anything.
    pub(in crate::camera) fn models() -> impl Strategy<Value = DistortionModel> {
        (prop::array::uniform6(-0.5..0.5), prop::array::uniform2(-0.02..0.02)).prop_map(
            |([k1, k2, k3, k4, k5, k6], [p1, p2])| DistortionModel::Rational {
                k1,
                k2,
                p1,
                p2,
                k3,
                k4,
                k5,
                k6,
            },
        )
    }

    #[test]
    fn known_point_by_hand() {
        // s = 0.05: L = 1 + 0.1·0.05 = 1.005; tangential x: 2·0.01·0.02 + 0.02·(0.05 + 0.02)
        let model = DistortionModel::from_opencv(&[0.1, 0.0, 0.01, 0.02]).unwrap();
        let drawn = Distortion::from(model).distort(&Point2::new(0.1, 0.2)).unwrap();
        assert!((drawn.x - (0.1005 + 0.0004 + 0.0014)).abs() < 1e-15);
        assert!((drawn.y - (0.2010 + 0.0013 + 0.0008)).abs() < 1e-15);
    }

    #[test]
    fn a_rational_model_divides() {
        // s = 1: (1 + 0.1 + 0.2 + 0.3) / (1 + 0.4 + 0.5 + 0.6)
        let model =
            DistortionModel::from_opencv(&[0.1, 0.2, 0.0, 0.0, 0.3, 0.4, 0.5, 0.6]).unwrap();
        let (scale, _) = Terms::of(&model).scale(1.0);
        assert!((scale - 1.6 / 2.5).abs() < 1e-15);
    }

    #[test]
    fn the_limit_is_the_turning_point() {
        // f = r - r³/3 turns at r = 1.
        let model = DistortionModel::from_opencv(&[-1.0 / 3.0, 0.0, 0.0, 0.0]).unwrap();
        let distortion = Distortion::from(model);
        assert!((distortion.max_radius() - 1.0).abs() < 1e-11);
        assert!(distortion.distort(&Point2::new(0.999, 0.0)).is_some());
        assert_eq!(distortion.distort(&Point2::new(0.0, 1.001)), None);
        assert_eq!(distortion.undistort(&Point2::new(0.67, 0.0)), None);
        // A pole at r = 1 ends the rational model too.
        let model =
            DistortionModel::from_opencv(&[0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0]).unwrap();
        assert!((Distortion::from(model).max_radius() - 1.0).abs() < 1e-11);
        assert_eq!(Distortion::default().max_radius(), f64::INFINITY);
    }

    #[test]
    fn a_list_of_another_length_is_refused() {
        let error = DistortionModel::from_opencv(&[0.0; 6]).unwrap_err().to_string();
        assert!(error.ends_with("(k1 k2 p1 p2 k3 k4 k5 k6), found 6"), "{error}");
    }

    proptest! {
        #[test]
        fn what_is_drawn_is_found_again(model in models(), at in 0.0..0.99, turn in 0.0..6.3) {
            let distortion = Distortion::from(model);
            let radius = at * distortion.max_radius().min(3.0);
            let ideal = Point2::new(radius * f64::cos(turn), radius * f64::sin(turn));
            let drawn = distortion.distort(&ideal).unwrap();
            let again = distortion.undistort(&drawn).unwrap();
            prop_assert!((again - ideal).norm() < 1e-8, "{ideal} came back as {again}");
        }

        #[test]
        fn the_jacobian_is_positive_and_is_the_derivative(model in models(), at in 0.0..1.0, turn in 0.0..6.3) {
            let distortion = Distortion::from(model);
            let radius = at * distortion.max_radius().min(3.0);
            let ideal = Point2::new(radius * f64::cos(turn), radius * f64::sin(turn));
            let jacobian = distortion.terms.jacobian(&ideal);
            prop_assert!(jacobian.determinant() > 0.0);
            let step = Vector2::new(1e-6, -2e-6);
            let secant = distortion.terms.distort(&(ideal + step)) - distortion.terms.distort(&(ideal - step));
            prop_assert!((secant - jacobian * step * 2.0).norm() < 1e-10 * (1.0 + jacobian.norm().powi(3)));
        }

        #[test]
        fn the_radius_grows_up_to_the_limit(model in models(), at in 0.0..0.999, turn in 0.0..6.3) {
            let distortion = Distortion::from(model);
            let reach = |radius: f64| {
                let ideal = Point2::new(radius * f64::cos(turn), radius * f64::sin(turn));
                distortion.distort(&ideal).unwrap().coords.norm()
            };
            let limit = distortion.max_radius().min(10.0);
            prop_assert!(reach(at * limit) < reach((at + 0.001) * limit * 0.9999999));
        }

        #[test]
        fn nothing_panics(d in prop::array::uniform8(any::<f64>()), x: f64, y: f64) {
            let distortion = Distortion::from(DistortionModel::from_opencv(&d).unwrap());
            let _ = (distortion.distort(&Point2::new(x, y)), distortion.undistort(&Point2::new(x, y)));
        }
    }
}
