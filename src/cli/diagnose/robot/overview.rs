//! All joints of a robot on one page, the worst first.

use super::Told;
use super::prepared::Prepared;
use crate::cli::overview::{self, Line};
use crate::page::Page;
use serde_json::{Value, json};
use std::path::Path;

/// All joints of a robot.
pub struct Overview<'a> {
    robot: String,
    joints: overview::Overview,
    told: &'a [Told],
    remarks: Vec<String>,
    train: &'a [Prepared],
}

impl<'a> Overview<'a> {
    pub fn new(description: &Path, train: &'a [Prepared], told: &'a [Told]) -> Self {
        let line = |told: &Told| Line {
            name: told.joint.clone(),
            report: told
                .outcome
                .is_ok()
                .then(|| format!("{}/report.html", told.folder)),
            told: match &told.outcome {
                Ok(one) => Ok(overview::Told::of(&one.diagnosis)),
                Err(why) => Err(why.clone()),
            },
        };
        Self {
            robot: description
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into(),
            joints: overview::Overview::new("joint", told.iter().map(line).collect()),
            told,
            remarks: train.iter().flat_map(Prepared::remarks).collect(),
            train,
        }
    }

    /// The results with the worst joint first.
    fn sorted(&self) -> impl Iterator<Item = &'a Told> {
        let of = |line: &Line| self.told.iter().find(|told| told.joint == line.name);
        self.joints.lines.iter().filter_map(of)
    }

    pub fn text(&self, page: &Path) -> String {
        let mut text = format!("{}\n\n{}", self.joints.sentence().1, self.joints.text());
        if !self.remarks.is_empty() {
            text += &format!("\n{}\n", self.remarks.join("\n"));
        }
        text + &format!(
            "\nMisfits are times the noise. Written: {}\n",
            page.display()
        )
    }

    pub fn page(&self) -> Page {
        let (verdict, sentence) = self.joints.sentence();
        let names: Vec<&str> = self.train.iter().map(|own| &*own.name).collect();
        let mut page = Page::new(format!("Joints of {}", self.robot))
            .subtitle(names.join(", "))
            .verdict(verdict, sentence)
            .table(self.joints.table());
        if !self.remarks.is_empty() {
            page = page.heading("What the description does not have");
        }
        for remark in &self.remarks {
            page = page.text(remark.clone());
        }
        page
    }

    pub fn document(&self) -> Value {
        let joints = self.sorted().map(|told| match &told.outcome {
            Ok(one) => json!({
                "joint": told.joint,
                "folder": told.folder,
                "verdict": one.diagnosis.verdict,
                "summary": one.diagnosis.summary,
                "findings": one.diagnosis.findings.iter().map(|own| &own.effect).collect::<Vec<_>>(),
                "misfit_over_noise": one.diagnosis.fit.before.held_out_over_noise,
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
                    "lever_m": payload.lever,
                    "lever_std_m": payload.lever_std,
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
