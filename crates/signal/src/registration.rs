//! Registration of two frames from corresponding points (Kabsch).

use nalgebra::{
    Isometry3, Matrix3, Point3, Rotation3, SymmetricEigen, Translation3, UnitQuaternion, Vector3,
};

use super::SignalError;

/// A rigid transform between two frames and how well the points determine it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Registration {
    /// Maps source coordinates to target coordinates: `q = R p + t`.
    pub transform: Isometry3<f64>,
    /// Root mean square distance of the mapped points from their partners, m.
    pub rms: f64,
    /// Covariance of the rotation vector (left, in target axes), rad^2.
    pub rotation_covariance: Matrix3<f64>,
    /// Variance of each coordinate of the mapped centroid, m^2.
    pub centroid_variance: f64,
    /// Points used.
    pub points: usize,
}

/// The rigid transform (no reflection) that maps `source` to `target`, point by point, with the
/// least sum of squares.
///
/// `R = V diag(1, 1, det(V U')) U'` with `U S V'` the singular value decomposition of
/// `sum (p - p_mean)(q - q_mean)'`. Points in a plane, such as the arc that one joint sweeps,
/// determine it; points on a line do not. With noise of standard deviation `s` on each coordinate the
/// covariance is `s^2 (sum |r|^2 I - r r')^-1`, `r` from the centroid; `s^2` is estimated from the
/// residual with `3 n - 6` degrees of freedom.
///
/// # Errors
/// [`SignalError::Lengths`], [`SignalError::TooFew`] below 3 points, [`SignalError::NotFinite`], and
/// [`SignalError::Degenerate`] where the points spread across their main line by no more than three
/// times the residual noise: the rotation about that line is free.
///
/// # Example
/// ```
/// use nalgebra::{Point3, Vector3};
/// let p = [Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)];
/// let q = p.map(|p| p + Vector3::new(0.0, 0.0, 2.0));
/// let found = quell_signal::kabsch(&p, &q).unwrap();
/// assert!((found.transform.translation.z - 2.0).abs() < 1e-15 && found.rms < 1e-15);
/// ```
///
/// Source: Kabsch, "A solution for the best rotation to relate two sets of vectors", Acta
/// Crystallographica A32 (1976), with the sign of Umeyama, IEEE PAMI 13 (1991).
pub fn kabsch(source: &[Point3<f64>], target: &[Point3<f64>]) -> Result<Registration, SignalError> {
    if source.len() != target.len() {
        let (left, right) = (source.len(), target.len());
        return Err(SignalError::Lengths {
            what: "corresponding points",
            left,
            right,
        });
    }
    check_points("source points", source)?;
    check_points("target points", target)?;
    let transform = best_transform(source, target);
    let residual: f64 = source
        .iter()
        .zip(target)
        .map(|(p, q)| (transform * p - q).norm_squared())
        .sum();
    let freedom = (3 * source.len()).saturating_sub(6).max(1) as f64;
    let variance = residual / freedom;
    let mean = centroid(source);
    let spread = source
        .iter()
        .map(|p| (p - mean) * (p - mean).transpose())
        .sum();
    check_spread(&spread, source.len(), variance)?;
    let rotation = transform.rotation.to_rotation_matrix();
    let mapped = rotation.matrix() * spread * rotation.matrix().transpose();
    let information = Matrix3::identity() * mapped.trace() - mapped;
    Ok(Registration {
        transform,
        rms: (residual / source.len() as f64).sqrt(),
        rotation_covariance: information.try_inverse().unwrap_or_else(Matrix3::zeros) * variance,
        centroid_variance: variance / source.len() as f64,
        points: source.len(),
    })
}

/// The transform of [`kabsch`] alone, for lists of equal length.
pub(super) fn best_transform(source: &[Point3<f64>], target: &[Point3<f64>]) -> Isometry3<f64> {
    let (p_mean, q_mean) = (centroid(source), centroid(target));
    let cross: Matrix3<f64> = source
        .iter()
        .zip(target)
        .map(|(p, q)| (p - p_mean) * (q - q_mean).transpose())
        .sum();
    let rotation = UnitQuaternion::from_rotation_matrix(&best_rotation(&cross));
    let translation = q_mean.coords - rotation * p_mean.coords;
    Isometry3::from_parts(Translation3::from(translation), rotation)
}

fn best_rotation(cross: &Matrix3<f64>) -> Rotation3<f64> {
    let svd = cross.svd_unordered(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Rotation3::identity();
    };
    // The smallest singular value takes the sign that makes the product a rotation.
    let smallest = svd.singular_values.imin();
    let mut sign = Vector3::repeat(1.0);
    sign[smallest] = (v_t.transpose() * u.transpose()).determinant().signum();
    let rotation = v_t.transpose() * Matrix3::from_diagonal(&sign) * u.transpose();
    Rotation3::from_matrix_unchecked(rotation)
}

pub(super) fn check_points(what: &'static str, points: &[Point3<f64>]) -> Result<(), SignalError> {
    if points.len() < 3 {
        return Err(SignalError::TooFew {
            what,
            found: points.len(),
            needed: 3,
        });
    }
    for (index, point) in points.iter().enumerate() {
        if let Some(&value) = point.iter().find(|x| !x.is_finite()) {
            return Err(SignalError::NotFinite { what, index, value });
        }
    }
    Ok(())
}

/// Refuses points on a line: `spread` is the sum of `r r'`, `variance` the noise of a coordinate.
fn check_spread(spread: &Matrix3<f64>, points: usize, variance: f64) -> Result<(), SignalError> {
    let eigen = SymmetricEigen::new(*spread);
    let main = eigen.eigenvalues.imax();
    let largest = eigen.eigenvalues[main];
    let second = (0..3)
        .filter(|&k| k != main)
        .map(|k| eigen.eigenvalues[k])
        .fold(0.0, f64::max);
    // 1e-14: rounding of the sums for coordinates that are themselves rounded at 1e-16.
    let least = (9.0 * variance * points as f64).max(1e-14 * largest);
    if second > least {
        return Ok(());
    }
    let direction = eigen.eigenvectors.column(main);
    Err(SignalError::Degenerate {
        direction: [direction[0], direction[1], direction[2]],
    })
}

pub(super) fn centroid(points: &[Point3<f64>]) -> Point3<f64> {
    let sum = points
        .iter()
        .fold(Vector3::zeros(), |sum, p| sum + p.coords);
    Point3::from(sum / points.len().max(1) as f64)
}
