use quell::model::*; use quell::recording::Recording; use quell::diagnosis::*;
fn main(){
  let root=std::env::args().nth(1).unwrap();
  let only:Vec<String>=std::env::args().skip(2).collect();
  let truth:serde_json::Value=serde_json::from_str(&std::fs::read_to_string(format!("{root}/truth.json")).unwrap()).unwrap();
  let mut names:Vec<String>=truth.as_object().unwrap().keys().cloned().collect(); names.sort();
  for name in names { if !only.is_empty() && !only.iter().any(|o| name.ends_with(o.as_str())) {continue;}
    let dir=format!("{root}/{name}");
    let toml: toml::Table = std::fs::read_to_string(format!("{dir}/model.toml")).unwrap().parse().unwrap();
    let kind=Kind::from_name(toml["kind"].as_str().unwrap()).unwrap();
    let mut values=vec![]; let mut given=vec![];
    for k in kind.keys { let v=toml.get(k.name).and_then(|v| v.as_float().or(v.as_integer().map(|i| i as f64))); given.push(v.is_some()); values.push(Value::from(v.or(k.default).unwrap())); }
    let model=Model{kind,values,given,hold:None,effects:vec![]};
    let rec=Recording::from_path(format!("{dir}/train")).unwrap();
    let t=std::time::Instant::now();
    let r=investigate(&model,&[rec],&[],&|_,_|{});
    let dt=t.elapsed().as_secs_f64();
    match r { Err(e)=>println!("{name}: ERROR {e}"), Ok((data,f))=>{
      let n=data.train.iter().flatten().flatten().map(|r| r.len()).sum::<usize>() as f64;
      let h=data.held_out.iter().flatten().flatten().map(|r| r.len()).sum::<usize>() as f64;
      println!("{name} TRUE {} | base {:.3}/{:.3} -> best {:?} {:.3}/{:.3} | equals {:?} | {:.2}s f={:.3}({}) xi={:.4}", truth[&name]["effect"].as_str().unwrap(), (f.baseline.train/n).sqrt(),(f.baseline.held_out/h).sqrt(), f.best.effects().iter().map(|e| e.0).collect::<Vec<_>>(), (f.best.train/n).sqrt(),(f.best.held_out/h).sqrt(), f.equals.iter().map(|t| t.explanation.effects().iter().map(|e| e.0).collect::<Vec<_>>().join("+")).collect::<Vec<_>>(), dt, f.best.fitted.point.keys[0], truth[&name]["natural_frequency_hz"], f.best.fitted.point.keys[1]);
      if !only.is_empty() { for t in &f.trials { println!("    {:?} dbic {:.1} held {:.3} passed {} {:?}", t.explanation.effects(), t.delta_bic,t.held_out_ratio,t.passed, t.explanation.fitted.point.terms.last().map(|t| t.values.clone())); } }
    }}
  }
}
