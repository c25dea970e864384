//! Channels from numbers in memory, and the checks of every channel.

use super::error::{Problem, RecordingError, nearest};
use super::{Channel, ROLES, Role, UNITS, Unit};
use std::path::Path;

impl Channel {
    /// A channel of values in a unit of the table, which are converted to SI.
    ///
    /// * `time`: stamps, s, strictly increasing; length n;
    /// * `columns`: as many as the role has, each of length n.
    ///
    /// # Errors
    /// [`RecordingError`] without a file: a role or unit that is not known, a sample that is not finite, a stamp
    /// that is not above the one before. It names the sample, counted from 0.
    ///
    /// # Example
    /// ```
    /// use quell_recording::Channel;
    /// let channel = Channel::new("deformation", "mrad", vec![0.0, 0.1], vec![vec![1.0, 3.0]]).unwrap();
    /// assert_eq!((channel.unit.as_str(), channel.columns[0][1]), ("rad", 0.003));
    /// let error = Channel::new("deformation", "mrad", vec![0.0, 0.1], vec![vec![1.0, f64::NAN]]);
    /// let words = "channel deformation: sample 1 is NaN, not a finite number";
    /// assert_eq!(error.unwrap_err().to_string(), words);
    /// ```
    pub fn new(
        role: &str,
        unit: &str,
        time: Vec<f64>,
        mut columns: Vec<Vec<f64>>,
    ) -> Result<Self, RecordingError> {
        let refuse = |problem: Problem| problem.in_file(Path::new(""));
        let known = Role::from_name(role).ok_or_else(|| {
            refuse(Problem::UnknownRole {
                role: role.into(),
                nearest: nearest(role, ROLES.iter().map(|entry| entry.name)),
            })
        })?;
        let from = Unit::from_name(unit).ok_or_else(|| {
            let names = UNITS.iter().flat_map(|unit| unit.names.iter().copied());
            refuse(Problem::UnknownUnit {
                unit: unit.into(),
                nearest: nearest(unit, names),
            })
        })?;
        for value in columns.iter_mut().flatten() {
            *value = from.to_si(*value);
        }
        let channel = Self {
            role: known,
            unit: from.si.into(),
            time,
            columns,
        };
        let checked = channel.check();
        checked.map_err(|reason| {
            refuse(Problem::Channel {
                role: known.name(),
                reason,
            })
        })?;
        Ok(channel)
    }

    /// Checks that it is well formed; the error is a sentence.
    pub(super) fn check(&self) -> Result<(), String> {
        let Self {
            role,
            unit,
            time,
            columns,
        } = self;
        if Unit::from_name(unit).is_none_or(|known| known.si != unit) {
            return Err(format!(
                "\"{unit}\" is not an SI unit of the table of units"
            ));
        }
        if !role.entry().columns.contains(&columns.len()) {
            return Err(format!("it has {} columns", columns.len()));
        }
        if time.is_empty() {
            return Err("it has no samples".into());
        }
        if let Some(column) = columns.iter().find(|column| column.len() != time.len()) {
            let (values, stamps) = (column.len(), time.len());
            return Err(format!("it has {values} values and {stamps} stamps"));
        }
        for (what, series) in [("time of sample", time)]
            .into_iter()
            .chain(columns.iter().map(|c| ("sample", c)))
        {
            if let Some(sample) = series.iter().position(|value| !value.is_finite()) {
                let value = series[sample];
                return Err(format!("{what} {sample} is {value}, not a finite number"));
            }
        }
        match time.windows(2).position(|pair| pair[1] <= pair[0]) {
            Some(at) => {
                let (before, after) = (time[at], time[at + 1]);
                Err(format!(
                    "time {after} s of sample {} follows {before} s",
                    at + 1
                ))
            }
            None => Ok(()),
        }
    }
}
