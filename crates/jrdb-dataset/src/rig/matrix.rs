//! What calibration files ask of linear algebra: products, transposes, and the rotation nearest to a printed one.

/// A vector.
pub(super) type Vector = [f64; 3];
/// A matrix, row by row.
pub(super) type Matrix = [[f64; 3]; 3];

const IDENTITY: Matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

pub(super) fn rows(numbers: [f64; 9]) -> Matrix {
    let [a, b, c, d, e, f, g, h, i] = numbers;
    [[a, b, c], [d, e, f], [g, h, i]]
}

pub(super) fn transpose(m: &Matrix) -> Matrix {
    [0, 1, 2].map(|column| m.map(|row| row[column]))
}

pub(super) fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn product(a: &Matrix, b: &Matrix) -> Matrix {
    let columns = transpose(b);
    a.map(|row| columns.each_ref().map(|column| dot(&row, column)))
}

pub(super) fn apply(m: &Matrix, v: &Vector) -> Vector {
    m.each_ref().map(|row| dot(row, v))
}

pub(super) fn add(a: &Vector, b: &Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// The vector turned round; 0 stays 0 and does not become -0.
pub(super) fn negated(v: &Vector) -> Vector {
    v.map(|number| 0.0 - number)
}

/// Largest entry of `|R Rᵀ - 1|`; NaN where an entry is not a number.
pub(super) fn deviation(r: &Matrix) -> f64 {
    let square = product(r, &transpose(r));
    let off = square.iter().flatten().zip(IDENTITY.iter().flatten()).map(|(a, b)| (a - b).abs());
    off.fold(0.0, |largest, off| if off > largest || off.is_nan() { off } else { largest })
}

/// The orthonormal matrix nearest to one whose deviation is small.
pub(super) fn orthonormal(r: &Matrix) -> Matrix {
    // Newton-Schulz steps to the polar factor: the deviation is squared by each, 1e-3 → 1e-6 → 1e-12 → 1e-24.
    (0..3).fold(*r, |r, _| {
        let square = product(&transpose(&r), &r);
        let mut step = IDENTITY;
        for (row, squares) in step.iter_mut().zip(&square) {
            for (entry, square) in row.iter_mut().zip(squares) {
                *entry = (3.0 * *entry - square) / 2.0;
            }
        }
        product(&r, &step)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_printed_with_few_digits_becomes_one_again() {
        let (sin, cos) = 0.3_f64.sin_cos();
        let exact = product(
            &[[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]],
            &[[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]],
        );
        let printed = exact.map(|row| row.map(|entry| (entry * 1e3).round() / 1e3));
        assert!((1e-4..1e-3).contains(&deviation(&printed)), "{}", deviation(&printed));
        let found = orthonormal(&printed);
        assert!(deviation(&found) < 1e-15);
        let off = exact.iter().flatten().zip(found.iter().flatten()).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-3);
    }

    #[test]
    fn what_is_not_a_number_deviates() {
        let mut broken = IDENTITY;
        broken[1][1] = f64::NAN;
        assert!(deviation(&broken).is_nan());
        assert_eq!(deviation(&IDENTITY), 0.0);
    }

    #[test]
    fn rows_are_rows() {
        let m = rows([0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        assert_eq!(apply(&m, &[1.0, 2.0, 3.0]), [-2.0, 1.0, 3.0]);
        assert_eq!(product(&m, &transpose(&m)), IDENTITY);
    }
}
