//! Whether the residual of an explanation is noise.

use super::explanation::Explanation;
use super::found::Found;
use super::judge::Judge;
use super::locate::Located;
use super::noise::REDDEST;
use super::search::Search;
use super::thresholds::FLOOR;

/// Residual, relative to the noise, that is a mismatch even if it cannot be located: no estimate of a noise
/// level is that far off.
const CERTAIN: f64 = 1.5;

/// Standard deviations by which noise may exceed its expectation by chance.
const CHANCE: f64 = 3.0;

impl Judge<'_> {
    /// Whether the residual of an explanation is noise. Possible errors of its laws' shapes are allowed for in
    /// the fitted rows; errors of the fit in the held-out rows. An explanation may be uncertain enough
    /// there to allow for anything, as a law over the position in a move that passes each position once, so its residual there
    /// must be no certain mismatch either.
    pub fn leaves_noise(&self, own: &Explanation) -> bool {
        let beyond = own.evidence.held_out_beyond_fit();
        self.fits_to_noise(own)
            && beyond <= most_of_noise(self.held_out_rows)
            && own.held_out <= times_noise(CERTAIN, self.held_out_rows)
    }

    /// Whether an explanation leaves only noise of the rows that were fitted.
    pub fn fits_to_noise(&self, own: &Explanation) -> bool {
        own.evidence.left() <= most_of_noise(self.train_rows)
    }

    /// Chi-squared that an explanation leaves of the held-out rows, beyond the errors of its fit and beyond what it leaves of as
    /// many fitted ones.
    pub fn contradiction(&self, own: &Explanation) -> f64 {
        own.evidence.held_out_beyond_fit() - self.unit(own) * self.held_out_rows as f64
    }
}

impl Search<'_> {
    /// Whether the residual of an explanation is noise.
    pub fn leaves_noise(&self, own: &Explanation) -> bool {
        self.judge.leaves_noise(own)
    }

    /// Whether the refitted model leaves nothing that could be located. A residual a little above the noise may
    /// be noise of another colour, unless it has a place in the chain.
    pub fn leaves_nothing(&self, found: &Found, located: &Located) -> bool {
        let own = &found.baseline;
        let little = self.is_below(own, CERTAIN) && located.location.place.is_none();
        self.leaves_noise(own) || little || self.leaves_other_noise(own)
    }

    /// Whether the best explanation leaves nothing but noise.
    pub fn explains(&self, found: &Found) -> bool {
        self.leaves_noise(&found.best)
    }

    /// Whether the residual is noise that third differences underestimate: it is as large where the machine
    /// hardly moves as where it moves most. This holds for the model without added effects only: effects that
    /// absorb part of a mismatch of another shape remove just the part that grows with the motion.
    fn leaves_other_noise(&self, own: &Explanation) -> bool {
        self.is_below(own, REDDEST) && self.problem.follows_motion(&own.fitted.point) == Some(false)
    }

    fn is_below(&self, own: &Explanation, times: f64) -> bool {
        own.train <= times_noise(times, self.judge.train_rows)
            && own.held_out <= times_noise(times, self.judge.held_out_rows)
    }
}

/// Chi-squared of so many rows that are these `times` the noise.
fn times_noise(times: f64, rows: usize) -> f64 {
    times * times * rows as f64
}

/// Largest chi-squared of noise in as many rows. Its level is known within a tenth, and the chi-squared of `n` rows has
/// the standard deviation `sqrt(2 n)`; both errors are independent.
fn most_of_noise(rows: usize) -> f64 {
    let scatter = CHANCE * (2.0 / rows.max(1) as f64).sqrt();
    rows as f64 * (1.0 + (FLOOR - 1.0).hypot(scatter))
}
