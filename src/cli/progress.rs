//! Progress of a verb: a bar on stderr if that is a terminal, otherwise a line every few seconds.

use super::CliError;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// Time between two lines.
const LINES: Duration = Duration::from_secs(5);

/// Whether the user wants no progress.
static SILENT: AtomicBool = AtomicBool::new(false);

/// Sets whether the user wants no progress.
pub fn silence(silent: bool) {
    SILENT.store(silent, Ordering::Relaxed);
}

/// Shows the progress until it is dropped.
pub struct Progress {
    bar: ProgressBar,
    /// Closed to end the lines.
    teller: Option<(Sender<()>, JoinHandle<()>)>,
}

impl Progress {
    /// Progress in this number of steps; the bar follows a template of `indicatif`.
    ///
    /// # Errors
    /// [`CliError`] for a template that cannot be read.
    pub fn new(count: u64, template: &str) -> Result<Self, CliError> {
        let style = ProgressStyle::with_template(template).map_err(CliError::failure)?;
        let silent = SILENT.load(Ordering::Relaxed);
        let target = match silent {
            true => ProgressDrawTarget::hidden(),
            false => ProgressDrawTarget::stderr(),
        };
        let bar = ProgressBar::with_draw_target(Some(count), target).with_style(style);
        let teller = (!silent && !io::stderr().is_terminal()).then(|| {
            let (open, closed) = channel();
            let own = bar.clone();
            let lines = move || {
                while closed.recv_timeout(LINES) == Err(RecvTimeoutError::Timeout) {
                    // If stderr is closed, nobody reads the lines.
                    let _ = writeln!(io::stderr(), "{}", line(&own));
                }
            };
            (open, std::thread::spawn(lines))
        });
        Ok(Self { bar, teller })
    }

    /// Sets the number of finished steps, and the current activity.
    pub fn set(&self, done: u64, what: &str) {
        self.bar.set_position(done);
        self.bar.set_message(what.to_string());
    }

    /// One more step is done.
    pub fn step(&self) {
        self.bar.inc(1);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
        if let Some((open, lines)) = self.teller.take() {
            drop(open);
            let _ = lines.join();
        }
    }
}

/// The position of a bar, in words.
fn line(bar: &ProgressBar) -> String {
    let share = bar.position() as f64 / bar.length().unwrap_or(1).max(1) as f64;
    words(share, bar.elapsed(), &bar.message())
}

fn words(share: f64, elapsed: Duration, what: &str) -> String {
    let gap = if what.is_empty() { "" } else { ": " };
    let (percent, seconds) = (100.0 * share, elapsed.as_secs());
    format!("{percent:.0} % after {seconds} s{gap}{what}")
}

#[cfg(test)]
mod tests {
    use super::words;
    use std::time::Duration;

    #[test]
    fn a_line_says_how_far_it_is_and_what_is_done() {
        let elapsed = Duration::from_millis(6900);
        assert_eq!(words(0.0, elapsed, ""), "0 % after 6 s");
        let screened = "25 % after 6 s: screening the catalogue";
        assert_eq!(words(0.25, elapsed, "screening the catalogue"), screened);
    }
}
