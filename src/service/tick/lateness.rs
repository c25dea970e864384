//! Histogram of durations with geometric buckets: quantiles without stored samples.

/// Buckets for each octave: neighbours differ by 4.4 %.
const PER_OCTAVE: usize = 16;
/// Number of octaves from [`SHORTEST`] on: up to 4.3 s.
const OCTAVES: usize = 24;
/// Upper edge of the first bucket, s.
const SHORTEST: f64 = 256e-9;

/// Counts of durations.
#[derive(Clone, Debug)]
pub struct Histogram {
    buckets: Box<[u64; PER_OCTAVE * OCTAVES]>,
    count: u64,
    longest: f64,
}

impl Default for Histogram {
    fn default() -> Self {
        Self {
            buckets: Box::new([0; PER_OCTAVE * OCTAVES]),
            count: 0,
            longest: 0.0,
        }
    }
}

impl Histogram {
    /// Counts a duration, s; below 0 it counts as 0. No allocation.
    pub fn add(&mut self, duration: f64) {
        let octaves = (duration / SHORTEST).log2().max(0.0);
        let bucket = (octaves * PER_OCTAVE as f64).ceil() as usize;
        self.buckets[bucket.min(self.buckets.len() - 1)] += 1;
        self.count += 1;
        self.longest = self.longest.max(duration);
    }

    /// The duration that a share (0 to 1) of all does not exceed, s. It is the edge of its bucket, up to 4.4 %
    /// too large; 0 without any.
    pub fn quantile(&self, share: f64) -> f64 {
        let rank = (share * self.count as f64).ceil() as u64;
        let mut seen = 0;
        for (bucket, count) in self.buckets.iter().enumerate() {
            seen += count;
            if *count > 0 && seen >= rank {
                let edge = SHORTEST * (bucket as f64 / PER_OCTAVE as f64).exp2();
                return edge.min(self.longest);
            }
        }
        self.longest
    }

    /// The longest, s.
    pub fn longest(&self) -> f64 {
        self.longest
    }
}
