//! A model's prediction of a recording, as a CSV file.

use std::path::Path;

use crate::cli::{CliError, output};

/// One output of the model over one recording.
pub struct Predicted<'a> {
    /// Role of the output, such as `deformation`.
    pub role: &'a str,
    /// SI unit of the values.
    pub unit: &'a str,
    /// Stamps of the recorded samples, s.
    pub time: &'a [f64],
    /// One value a stamp for each component: three of a position in space, else one.
    pub columns: &'a [Vec<f64>],
}

/// Writes time and components as columns, `time_s,deformation_rad` or `time_s,tip_position_x_m,...`.
///
/// # Errors
/// [`CliError::Failure`] that names the file.
pub fn write(file: &Path, predicted: &Predicted) -> Result<(), CliError> {
    output::file(file, csv(predicted)?)
}

/// Numbers with as many digits as bring them back to the bit.
fn csv(predicted: &Predicted) -> Result<Vec<u8>, CliError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer
        .write_record(header(predicted))
        .map_err(CliError::failure)?;
    for (row, time) in predicted.time.iter().enumerate() {
        let values = predicted
            .columns
            .iter()
            .map(|column| column.get(row).copied());
        let values = values.map(|value| value.map_or(String::new(), |value| value.to_string()));
        let record = std::iter::once(time.to_string()).chain(values);
        writer.write_record(record).map_err(CliError::failure)?;
    }
    writer
        .into_inner()
        .map_err(|error| CliError::failure(error.to_string()))
}

fn header(predicted: &Predicted) -> Vec<String> {
    let Predicted { role, unit, .. } = predicted;
    let unit: String = unit
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    let mut header = vec!["time_s".to_string()];
    match predicted.columns.len() {
        1 => header.push(format!("{role}_{unit}")),
        count => header.extend(
            ["x", "y", "z"]
                .into_iter()
                .map(String::from)
                .chain((4..).map(|k: usize| k.to_string()))
                .take(count)
                .map(|component| format!("{role}_{component}_{unit}")),
        ),
    }
    header
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_named_and_numbers_keep_their_digits() {
        let columns = [vec![0.1, 1.0 / 3.0], vec![0.0, -2e-9], vec![1.0, 2.0]];
        let time = [0.0, 0.003];
        let mut predicted = Predicted {
            role: "tip_position",
            unit: "m",
            time: &time,
            columns: &columns,
        };
        let text = String::from_utf8(csv(&predicted).unwrap()).unwrap();
        let expected = "time_s,tip_position_x_m,tip_position_y_m,tip_position_z_m\n0,0.1,0,1\n\
                        0.003,0.3333333333333333,-0.000000002,2\n";
        assert_eq!(text, expected);
        (predicted.role, predicted.unit, predicted.columns) = ("deformation", "rad", &columns[..1]);
        assert_eq!(header(&predicted), ["time_s", "deformation_rad"]);
        (predicted.role, predicted.unit) = ("link_acceleration", "rad/s^2");
        assert_eq!(header(&predicted)[1], "link_acceleration_rad_s_2");
    }
}
