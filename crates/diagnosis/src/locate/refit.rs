//! The part of a residual that the refit of a model has already absorbed.

use super::Residual;
use super::basis::Basis;
use super::coordinate::has_link;
use super::smoother::Smoother;

/// Directions of the output's offset and, where there is a mode, of its frequency and damping: the error's
/// response to the deformation and its rate. A regressor counts only by what it explains beyond them, since the
/// refit has removed that part.
///
/// If a force drives an oscillator without a motor side, position, velocity and acceleration take the place of
/// the deformation.
pub(super) fn refit(residual: &Residual, smoother: &Smoother) -> Basis {
    let mut basis = Basis::default();
    basis.add(&vec![1.0; residual.time.len()]);
    if residual.dynamics.natural_frequency == 0.0 || residual.sensor_only {
        return basis;
    }
    let has_link = has_link(residual);
    let base = |i: usize, k: usize| if has_link { residual.motor[k][i] } else { 0.0 };
    for i in 0..if has_link { 2 } else { 3 } {
        let n = residual.time.len();
        let force: Vec<f64> = (0..n).map(|k| residual.link[k][i] - base(i, k)).collect();
        basis.add(&smoother.response(&force));
    }
    basis
}
