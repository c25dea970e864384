//! Records: every output, the nuisances, remarks.

use super::case::Case;
use super::motion::residual;
use super::score::{NOISE_ANEW, score_beside};
use super::shown::{Shown, rms};
use quell_diagnosis::Scored;
use quell_page::{Page, Table, number};

/// The last section.
pub fn section(page: Page, case: &Case) -> Page {
    let mut page = page;
    if !case.diagnosis.remarks.is_empty() {
        page = page.heading("Remarks");
    }
    for remark in &case.diagnosis.remarks {
        page = page.text(remark.clone());
    }
    if !case.traces.outputs.is_empty() || !case.diagnosis.nuisances.is_empty() {
        page = page.heading("For the record");
    }
    if !case.traces.outputs.is_empty() {
        page = page.table(outputs(case));
    }
    if !case.diagnosis.fit.scores.is_empty() {
        page = page.table(scores(case));
    }
    match case.diagnosis.nuisances.is_empty() {
        true => page,
        false => page.table(nuisances(case)),
    }
}

/// Misfit of each output of each recording.
fn outputs(case: &Case) -> Table {
    let after = case.has_after();
    let mut table = Table::new("Every recording and output")
        .text_column("recording and output")
        .column("noise", "")
        .column(if after { "misfit before" } else { "misfit" }, "rms");
    if after {
        table = table.column("misfit after", "rms");
    }
    table = table.text_column("unit").column("over noise", "");
    for trace in &case.traces.outputs {
        let [before, with] =
            [&trace.before, &trace.after].map(|model| rms(residual(trace, model).into_iter()));
        let shown = match trace.unit == case.diagnosis.fit.unit {
            true => case.misfit_unit(),
            false => Shown::of(&trace.unit, trace.noise_std),
        };
        let last = if after { with } else { before };
        let mut row = vec![
            trace.name.clone().into(),
            (trace.noise_std * shown.factor).into(),
            (before * shown.factor).into(),
        ];
        if after {
            row.push((with * shown.factor).into());
        }
        row.extend([shown.unit.into(), (last / trace.noise_std).into()]);
        table = table.row(row);
    }
    table
}

/// Misfit of each recording as a whole, in the words of `quell score`.
fn scores(case: &Case) -> Table {
    let table = Table::new("What quell score says of each recording")
        .text_column("recording")
        .text_column("model")
        .text_column("score")
        .note(format!(
            "Of the whole recording: clocks, offsets and unknown starts are fitted to all of it. {NOISE_ANEW}"
        ));
    let fold = |table: Table, own: &Scored| {
        let name = || own.recording.clone().into();
        let table = table.row([
            name(),
            "refitted".into(),
            score_beside(&own.before, case).into(),
        ]);
        match case.has_after() {
            true => table.row([
                name(),
                "with the findings".into(),
                score_beside(&own.after, case).into(),
            ]),
            false => table,
        }
    };
    case.diagnosis.fit.scores.iter().fold(table, fold)
}

fn nuisances(case: &Case) -> Table {
    let table = Table::new("Fitted besides")
        .text_column("parameter")
        .column("value", "")
        .text_column("95 % interval")
        .note("The model's own parameters as refitted, clock and output offsets.");
    let all = case.diagnosis.nuisances.iter();
    all.fold(table, |table, (name, value)| {
        let plain = Shown::plain();
        let [quoted, interval] = match case.diagnosis.nuisances_ci95.get(name) {
            Some(ci95) => [plain.quoted(*value, *ci95), plain.interval(*ci95)],
            None => [number(*value), String::new()],
        };
        table.row([name.clone().into(), quoted.into(), interval.into()])
    })
}
