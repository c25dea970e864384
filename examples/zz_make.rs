use quell::proof::{generate_kind, write_cases, Kind};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let seed: u64 = args[2].parse().unwrap();
    let count: u64 = args[3].parse().unwrap();
    let kinds: Vec<Kind> = args[4].split(',').map(|k| match k {
        "clean" => Kind::Clean, "single" => Kind::Single, "pair" => Kind::Pair, "triple" => Kind::Triple,
        "shaped" => Kind::Shaped, "outside" => Kind::Outside, _ => panic!() }).collect();
    let cases: Vec<_> = (0..count).map(|i| generate_kind(kinds[i as usize % kinds.len()], seed, i).unwrap()).collect();
    write_cases(std::path::Path::new(&args[1]), &cases).unwrap();
}
