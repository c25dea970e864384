//! Registration of two frames by iterated closest points (ICP), without known correspondence.

use nalgebra::{Isometry3, Point3, SymmetricEigen, Vector3};

use super::SignalError;
use super::registration::{Registration, centroid, check_points, kabsch};

/// Options of iterated closest points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IcpOptions {
    /// Most iterations.
    pub iterations: usize,
    /// Share of the source points that is kept, those nearest to the target: 1 for all, less where
    /// some have no partner.
    pub kept: f64,
    /// Largest motion of a source point in one iteration at which it stops, m.
    pub tolerance: f64,
}

impl Default for IcpOptions {
    /// 500 iterations, all points, 10 nm.
    fn default() -> Self {
        Self {
            iterations: 500,
            kept: 1.0,
            tolerance: 1e-8,
        }
    }
}

/// Result of [`icp`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IcpResult {
    /// The transform from source to target, its rms and covariance given the last correspondence.
    pub registration: Registration,
    /// Iterations made.
    pub iterations: usize,
    /// Whether the last motion was below the tolerance.
    pub converged: bool,
}

/// The rigid transform that maps `source` onto the path through the points `target`.
///
/// Alternates between the closest point of the path for each mapped source point, and [`kabsch`].
/// The result is the local optimum that `initial` leads to: begin with [`initial_guess`]. The
/// closest point is sought on the two segments that meet at the nearest vertex, so the path should be
/// sampled finely against its bends.
///
/// A path that can slide along itself, such as the arc of a single joint, is fixed in that direction only by
/// its two ends, and a vibration there shifts it. [`register_arc`](super::register_arc) uses the instants and
/// does not have this freedom. The covariance does not include the uncertainty of the correspondence.
///
/// # Errors
/// As [`kabsch`], for the kept points.
///
/// Source: Besl and McKay, "A method for registration of 3-D shapes", IEEE PAMI 14 (1992);
/// trimming: Chetverikov et al., "The trimmed iterative closest point algorithm", ICPR 2002.
pub fn icp(
    source: &[Point3<f64>],
    target: &[Point3<f64>],
    initial: &Isometry3<f64>,
    options: IcpOptions,
) -> Result<IcpResult, SignalError> {
    check_points("source points", source)?;
    check_points("target points", target)?;
    let path = Path::new(target);
    let share = if options.kept > 0.0 && options.kept <= 1.0 {
        options.kept
    } else {
        1.0
    };
    let kept = ((source.len() as f64 * share).ceil() as usize).clamp(3, source.len());
    let mut transform = *initial;
    let mut iterations = 0;
    loop {
        iterations += 1;
        let mut pairs: Vec<(f64, Point3<f64>, Point3<f64>)> = source
            .iter()
            .map(|p| {
                let closest = path.closest(&(transform * p));
                ((transform * p - closest).norm_squared(), *p, closest)
            })
            .collect();
        if kept < pairs.len() {
            pairs.select_nth_unstable_by(kept - 1, |a, b| a.0.total_cmp(&b.0));
            pairs.truncate(kept);
        }
        let from: Vec<_> = pairs.iter().map(|pair| pair.1).collect();
        let to: Vec<_> = pairs.iter().map(|pair| pair.2).collect();
        let registration = kabsch(&from, &to)?;
        let next = registration.transform;
        let motion = source
            .iter()
            .map(|p| (next * p - transform * p).norm())
            .fold(0.0, f64::max);
        transform = next;
        let converged = motion < options.tolerance;
        if converged || iterations >= options.iterations {
            return Ok(IcpResult {
                registration,
                iterations,
                converged,
            });
        }
    }
}

/// A starting transform for [`icp`], for two records of the same move in the same order: points at equal shares
/// of the two lists are paired. It is good enough if both records contain about the same share of rest before
/// and after the move.
///
/// # Errors
/// [`SignalError`] as [`kabsch`], but for the spread: a rough guess may leave a large residual.
pub fn initial_guess(
    source: &[Point3<f64>],
    target: &[Point3<f64>],
) -> Result<Isometry3<f64>, SignalError> {
    check_points("source points", source)?;
    check_points("target points", target)?;
    let count = source.len().min(target.len()).min(200);
    let pick = |points: &[Point3<f64>]| -> Vec<Point3<f64>> {
        (0..count)
            .map(|k| points[k * (points.len() - 1) / (count - 1)])
            .collect()
    };
    Ok(super::registration::best_transform(
        &pick(source),
        &pick(target),
    ))
}

/// A path through points, its vertices ordered along its main direction for the search.
struct Path<'a> {
    points: &'a [Point3<f64>],
    direction: Vector3<f64>,
    /// Coordinate along the direction and index, ascending.
    order: Vec<(f64, usize)>,
}

impl<'a> Path<'a> {
    fn new(points: &'a [Point3<f64>]) -> Self {
        let middle = centroid(points);
        let spread = points
            .iter()
            .map(|p| (p - middle) * (p - middle).transpose())
            .sum();
        let eigen = SymmetricEigen::<f64, nalgebra::Const<3>>::new(spread);
        let direction = eigen
            .eigenvectors
            .column(eigen.eigenvalues.imax())
            .into_owned();
        let mut order: Vec<(f64, usize)> = points
            .iter()
            .enumerate()
            .map(|(k, p)| (direction.dot(&p.coords), k))
            .collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self {
            points,
            direction,
            order,
        }
    }

    fn closest(&self, p: &Point3<f64>) -> Point3<f64> {
        let nearest = self.nearest_vertex(p);
        let before = nearest.saturating_sub(1);
        let after = (nearest + 1).min(self.points.len() - 1);
        let candidates =
            [(before, nearest), (nearest, after)].map(|(a, b)| self.on_segment(a, b, p));
        let [left, right] = candidates;
        if (left - p).norm_squared() <= (right - p).norm_squared() {
            left
        } else {
            right
        }
    }

    /// Searches outward from the vertex of the same coordinate, until that coordinate alone is farther away
    /// than the best.
    fn nearest_vertex(&self, p: &Point3<f64>) -> usize {
        let at = self.direction.dot(&p.coords);
        let middle = self.order.partition_point(|entry| entry.0 < at);
        let mut best = (f64::INFINITY, 0);
        let mut look = |entry: &(f64, usize)| {
            if (entry.0 - at).powi(2) >= best.0 {
                return false;
            }
            let distance = (self.points[entry.1] - p).norm_squared();
            if distance < best.0 {
                best = (distance, entry.1);
            }
            true
        };
        for entry in &self.order[middle..] {
            if !look(entry) {
                break;
            }
        }
        for entry in self.order[..middle].iter().rev() {
            if !look(entry) {
                break;
            }
        }
        best.1
    }

    fn on_segment(&self, a: usize, b: usize, p: &Point3<f64>) -> Point3<f64> {
        let (start, along) = (self.points[a], self.points[b] - self.points[a]);
        let length = along.norm_squared();
        if length == 0.0 {
            return start;
        }
        start + along * (along.dot(&(p - start)) / length).clamp(0.0, 1.0)
    }
}
