//! All joints of a robot on one page, the worst first.

use super::Told;
use super::prepared::Prepared;
use crate::diagnosis::{Diagnosis, Verdict};
use crate::effects::Catalogue;
use crate::page::{self, Cell, Page, Table, columns, number};
use serde_json::{Value, json};
use std::path::Path;

/// All joints of a robot.
pub struct Overview<'a> {
    robot: String,
    /// The joint with the largest misfit first, those without a diagnosis last.
    told: Vec<&'a Told>,
    remarks: Vec<String>,
    train: &'a [Prepared],
}

impl<'a> Overview<'a> {
    pub fn new(description: &Path, train: &'a [Prepared], told: &'a [Told]) -> Self {
        let misfit = |told: &Told| {
            told.outcome
                .as_ref()
                .map_or(-1.0, |one| before(&one.diagnosis))
        };
        let mut told: Vec<&Told> = told.iter().collect();
        told.sort_by(|a, b| misfit(b).total_cmp(&misfit(a)));
        Self {
            robot: description
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into(),
            told,
            remarks: train.iter().flat_map(Prepared::remarks).collect(),
            train,
        }
    }

    /// The answer for the whole robot.
    fn sentence(&self) -> (page::Verdict, String) {
        let lacking = |told: &&&Told| match &told.outcome {
            Ok(one) => !matches!(
                one.diagnosis.verdict,
                Verdict::NoMismatch | Verdict::NotExcited
            ),
            Err(_) => false,
        };
        let names = self.told.iter().filter(lacking);
        let names: Vec<&str> = names.map(|own| &*own.joint).collect();
        let of = self.told.len();
        match names.len() {
            0 => (
                page::Verdict::Good,
                format!("Nothing is missing at any of {of} joints."),
            ),
            some => (
                page::Verdict::Bad,
                format!(
                    "Physics is missing at {some} of {of} joints, the worst first: {}.",
                    names.join(", ")
                ),
            ),
        }
    }

    pub fn text(&self, page: &Path) -> String {
        let header = ["joint", "verdict", "missing", "misfit", "with it"];
        let rows = self.told.iter().map(|told| match &told.outcome {
            Ok(one) => {
                let own = &one.diagnosis;
                let quiet = own.verdict == Verdict::NotExcited;
                let figure = |value: f64| if quiet { "-".into() } else { number(value) };
                [
                    told.joint.clone(),
                    own.verdict.name().into(),
                    missing(own),
                    figure(before(own)),
                    figure(own.fit.after.held_out_over_noise),
                ]
            }
            Err(_) => {
                let dash = || "-".to_string();
                [
                    told.joint.clone(),
                    "set aside".into(),
                    dash(),
                    dash(),
                    dash(),
                ]
            }
        });
        let mut text = format!("{}\n\n{}", self.sentence().1, columns(header, rows));
        let aside = self.told.iter().filter_map(|told| {
            let why = told.outcome.as_ref().err()?;
            Some(format!("{}: {why}", told.joint))
        });
        let lines: Vec<String> = aside.chain(self.remarks.iter().cloned()).collect();
        if !lines.is_empty() {
            text += &format!("\n{}\n", lines.join("\n"));
        }
        text + &format!(
            "\nMisfits are times the noise. Written: {}\n",
            page.display()
        )
    }

    pub fn page(&self) -> Page {
        let (verdict, sentence) = self.sentence();
        let mut table = Table::new("Joints")
            .text_column("joint")
            .text_column("verdict")
            .text_column("what was found")
            .column("misfit", "noise")
            .column("with it", "noise");
        for told in &self.told {
            table = match &told.outcome {
                Ok(one) => table.row([
                    Cell::Link {
                        text: told.joint.clone(),
                        file: format!("{}/report.html", told.folder),
                    },
                    one.diagnosis.verdict.name().into(),
                    one.diagnosis.summary.clone().into(),
                    before(&one.diagnosis).into(),
                    one.diagnosis.fit.after.held_out_over_noise.into(),
                ]),
                Err(why) => table.row([
                    told.joint.clone().into(),
                    "set aside".into(),
                    why.clone().into(),
                ]),
            };
        }
        let names: Vec<&str> = self.train.iter().map(|own| &*own.name).collect();
        let mut page = Page::new(format!("Joints of {}", self.robot))
            .subtitle(names.join(", "))
            .verdict(verdict, sentence)
            .table(table);
        if !self.remarks.is_empty() {
            page = page.heading("What the description does not have");
        }
        for remark in &self.remarks {
            page = page.text(remark.clone());
        }
        page
    }

    pub fn document(&self) -> Value {
        let joints = self.told.iter().map(|told| match &told.outcome {
            Ok(one) => json!({
                "joint": told.joint,
                "folder": told.folder,
                "verdict": one.diagnosis.verdict,
                "summary": one.diagnosis.summary,
                "findings": one.diagnosis.findings.iter().map(|own| &own.effect).collect::<Vec<_>>(),
                "misfit_over_noise": before(&one.diagnosis),
                "with_findings_over_noise": one.diagnosis.fit.after.held_out_over_noise,
            }),
            Err(why) => json!({ "joint": told.joint, "set_aside": why }),
        });
        let recordings = self.train.iter().map(|own| {
            let names = own.robot.dynamics.joints();
            let couplings = own.couplings.iter().map(|coupling| {
                json!({
                    "joint": names[coupling.joint].name,
                    "other": names[coupling.other].name,
                    "cause": format!("{:?}", coupling.cause).to_lowercase(),
                    "size": coupling.size,
                    "std": coupling.std,
                })
            });
            let payload = own.payload.map(|payload| {
                json!({
                    "behind": names[payload.joint].name,
                    "mass_kg": payload.mass,
                    "mass_std_kg": payload.mass_std,
                    "centre_m": payload.centre.coords.as_slice(),
                })
            });
            json!({
                "recording": own.name,
                "payload": payload,
                "couplings": couplings.collect::<Vec<_>>(),
            })
        });
        json!({
            "joints": joints.collect::<Vec<_>>(),
            "recordings": recordings.collect::<Vec<_>>(),
            "remarks": self.remarks,
        })
    }
}

/// The misfit of the model as it was believed, its parameters refitted, over the noise.
fn before(diagnosis: &Diagnosis) -> f64 {
    diagnosis.fit.before.held_out_over_noise
}

fn missing(diagnosis: &Diagnosis) -> String {
    let titles = diagnosis
        .findings
        .iter()
        .map(|own| own.title(Catalogue::default()));
    let titles: Vec<String> = titles.collect();
    match titles.is_empty() {
        true => "-".into(),
        false => titles.join(" + "),
    }
}
