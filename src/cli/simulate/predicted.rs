//! A model's prediction of a recording, as CSV files.

use std::path::{Path, PathBuf};

use super::Args;
use crate::cli::out::Out;
use crate::cli::{CliError, next, output};
use crate::diagnosis::{Predicted, predict};
use crate::model::Model;
use crate::recording::{Recording, plain};
use crate::report::score_line;

/// Predicts a recording and writes each output at its own stamps: the first one into `out`, each
/// further one beside it, with its role in the name. A folder gets `prediction.csv`.
///
/// # Errors
/// [`CliError::Input`] where model or recording is refused.
pub fn run(model: &Path, recording: &Path, args: &Args) -> Result<(), CliError> {
    let (folder, first) = split(&args.out);
    let verb = ("simulate", args.force);
    let out = Out::open(&folder, verb, &[model, recording], [&first])?;
    let next = next::command(["diagnose".as_ref(), "--model".as_ref(), model, recording]);
    let model = Model::from_path(model).map_err(CliError::input)?;
    let recording = Recording::from_path(recording)?;
    let (outputs, score) = predict(&model, recording).map_err(CliError::input)?;
    let stage = out.stage()?;
    let mut files = Vec::new();
    for (index, predicted) in outputs.iter().enumerate() {
        let name = match index {
            0 => first.clone(),
            _ => beside(&first, index, predicted.name),
        };
        stage.file(&name, csv(predicted)?)?;
        files.push(folder.join(name).display().to_string());
    }
    stage.put()?;
    match args.json {
        true => output::json(&serde_json::json!({ "files": files, "score": score })),
        false => output::text(&format!(
            "{}\nWritten: {}\n{}",
            score_line(&score),
            files.join(", "),
            next
        )),
    }
}

/// The folder of `--out`, and the name of the first file in it.
fn split(out: &Path) -> (PathBuf, PathBuf) {
    match (out.extension(), out.parent(), out.file_name()) {
        (Some(_), Some(folder), Some(name)) if !out.is_dir() => (folder.into(), name.into()),
        _ => (out.into(), "prediction.csv".into()),
    }
}

/// `prediction-2-link_position.csv` beside `prediction.csv`.
fn beside(first: &Path, index: usize, role: &str) -> PathBuf {
    let stem = first.file_stem().unwrap_or_default().to_string_lossy();
    let extension = first.extension().unwrap_or_default().to_string_lossy();
    first.with_file_name(format!("{stem}-{}-{role}.{extension}", index + 1))
}

/// Stamps, recorded values, and predictions, with enough digits to restore the numbers to the bit.
fn csv(predicted: &Predicted) -> Result<Vec<u8>, CliError> {
    let legible = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let unit: String = predicted.unit.chars().map(legible).collect();
    let role = predicted.name;
    let header = [
        "time_s".to_string(),
        format!("{role}_recorded_{unit}"),
        format!("{role}_predicted_{unit}"),
    ];
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header).map_err(CliError::failure)?;
    let values = predicted.recorded.iter().zip(&predicted.predicted);
    for (time, (recorded, predicted)) in predicted.time.iter().zip(values) {
        let row = [time, recorded, predicted].map(|value| plain(*value));
        writer.write_record(row).map_err(CliError::failure)?;
    }
    writer
        .into_inner()
        .map_err(|error| CliError::failure(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_named_and_numbers_keep_their_digits() {
        let predicted = Predicted {
            name: "link_acceleration",
            unit: "rad/s^2".into(),
            time: vec![0.0, 0.003],
            recorded: vec![0.1, 1.0 / 3.0],
            predicted: vec![0.0, -2e-9],
        };
        let text = String::from_utf8(csv(&predicted).unwrap()).unwrap();
        let expected = "time_s,link_acceleration_recorded_rad_s_2,link_acceleration_predicted_rad_s_2\n\
                        0,0.1,0\n0.003,0.3333333333333333,-0.000000002\n";
        assert_eq!(text, expected);
        let second = beside(Path::new("out/p.csv"), 1, "deformation");
        assert_eq!(second, Path::new("out/p-2-deformation.csv"));
    }
}
