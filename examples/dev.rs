//! dev
use quell::diagnosis::*;
use quell::model::*;
use quell::recording::Recording;
fn main() {
    let root = std::env::args().nth(1).unwrap();
    let only: Vec<String> = std::env::args().skip(2).collect();
    let truth: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(format!("{root}/truth.json")).unwrap())
            .unwrap();
    let mut names: Vec<String> = truth.as_object().unwrap().keys().cloned().collect();
    names.sort();
    for name in names {
        if !only.is_empty() && !only.iter().any(|o| name.ends_with(o.as_str())) {
            continue;
        }
        let dir = format!("{root}/{name}");
        let model = Model::from_path(format!("{dir}/model.toml")).unwrap();
        let rec = match Recording::from_path(format!("{dir}/train")) {
            Ok(r) => r,
            Err(e) => {
                println!("{name} {e}");
                continue;
            }
        };
        let t = std::time::Instant::now();
        let r = diagnose(&model, &[rec], &[], &Options::default(), &|_, _| {});
        let dt = t.elapsed().as_secs_f64();
        match r {
            Err(e) => println!("{name}: ERROR {e}"),
            Ok(o) => {
                let test = Recording::from_path(format!("{dir}/test")).unwrap();
                let sc = score(&o.model, &test)
                    .map(|s| s.rms_over_noise)
                    .unwrap_or(f64::NAN);
                let d = &o.diagnosis;
                let tn = &truth[&name];
                let eff = tn
                    .get("catalogue_names")
                    .map(|v| v.to_string())
                    .unwrap_or(tn["effect"].to_string());
                println!(
                    "{name} TRUE {eff} r{:.1} | {:?} {} | held {:.3} -> {:.3} test {:.3} | {:.2}s",
                    tn["baseline_residual_over_noise"]
                        .as_f64()
                        .unwrap_or(f64::NAN),
                    d.verdict,
                    d.findings
                        .iter()
                        .map(|f| format!("{}@{}{:?}", f.effect, f.place, f.alternatives))
                        .collect::<Vec<_>>()
                        .join(" + "),
                    d.fit.before.held_out_over_noise,
                    d.fit.after.held_out_over_noise,
                    sc,
                    dt
                );
                if !only.is_empty() {
                    println!(
                        "  {}\n  train {:e} -> {:e} noise {:e} {:?}\n loc {:?} {:?}",
                        d.summary,
                        d.fit.before.train_rms,
                        d.fit.after.train_rms,
                        d.fit.noise_std,
                        d.nuisances,
                        d.location,
                        d.remarks
                    );
                    for t in &d.candidates {
                        println!(
                            "    {} {} dbic {:.1} held {:.3}",
                            t.effect, t.place, t.delta_bic, t.held_out_ratio
                        );
                    }
                    for f in &d.findings {
                        println!("  {:?}", f);
                    }
                }
            }
        }
    }
}
