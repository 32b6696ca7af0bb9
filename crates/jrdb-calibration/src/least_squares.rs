//! Least squares, by faer's factorisations: solutions, and how uncertain they are.

use faer::linalg::solvers::{DenseSolveCore, SolveLstsqCore};
use faer::{Conj, Mat, Side};

/// The symmetric matrix whose entries `entry` gives; only its lower half is read.
fn symmetric<const N: usize>(entry: impl Fn(usize, usize) -> f64) -> Mat<f64> {
    Mat::from_fn(N, N, entry)
}

/// The solution of `A x = b` with the least sum of squares; each row is one equation, its last number `b`.
///
/// `None` for fewer equations than unknowns, and where the equations leave an unknown open.
pub(crate) fn solve<const N: usize>(rows: &[([f64; N], f64)]) -> Option<[f64; N]> {
    if rows.len() < N {
        return None;
    }
    let matrix = Mat::from_fn(rows.len(), N, |row, column| rows[row].0[column]);
    let mut right = Mat::from_fn(rows.len(), 1, |row, _| rows[row].1);
    matrix.qr().solve_lstsq_in_place_with_conj(Conj::No, right.as_mut());
    let solution = std::array::from_fn(|i| right[(i, 0)]);
    solution.iter().all(|value: &f64| value.is_finite()).then_some(solution)
}

/// The inverse of a positive definite matrix, from its Cholesky factor: of the curvature of a sum of squares it is the
/// covariance of the solution. `None` if the matrix is not positive definite.
pub(crate) fn covariance(curvature: &Mat<f64>) -> Option<Mat<f64>> {
    Some(curvature.llt(Side::Lower).ok()?.inverse())
}

/// Eigenvalues of a symmetric matrix, ascending, and the eigenvector of the least one.
///
/// Of the scatter of points around their centroid these are their variances along its axes, and the normal of the plane that
/// fits them best (total least squares). `None` for numbers that are not finite.
pub(crate) fn least_direction<const N: usize>(
    scatter: impl Fn(usize, usize) -> f64,
) -> Option<([f64; N], [f64; N])> {
    let eigen = symmetric::<N>(scatter).self_adjoint_eigen(Side::Lower).ok()?;
    let (values, vectors) = (eigen.S().column_vector(), eigen.U());
    let least = std::array::from_fn(|i| vectors[(i, 0)]);
    Some((std::array::from_fn(|i| values[i]), least))
}
