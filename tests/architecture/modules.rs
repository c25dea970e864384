//! No circles of imports between the modules of a crate.
//!
//! Of two modules with one parent at most one sees the other, by whatever way. A parent may list its children, and
//! they may see what it declares.

use super::{rust_files, source_folders};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use syn::visit::{self, Visit};

type Module = Vec<String>;

/// The names in a file: paths, and names that it imports with where they come from.
#[derive(Default)]
struct Names {
    paths: Vec<Vec<String>>,
    imports: Vec<(String, Vec<String>)>,
}

impl Names {
    fn import(&mut self, tree: &syn::UseTree, before: &mut Vec<String>, own: bool) {
        let (name, tail) = match tree {
            syn::UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.import(&path.tree, before, own);
                before.pop();
                return;
            }
            syn::UseTree::Group(group) => {
                for tree in &group.items {
                    self.import(tree, before, own);
                }
                return;
            }
            syn::UseTree::Name(name) => (name.ident.to_string(), name.ident.to_string()),
            syn::UseTree::Rename(name) => (name.rename.to_string(), name.ident.to_string()),
            syn::UseTree::Glob(_) => ("*".into(), "self".into()),
        };
        let mut path = before.clone();
        path.extend((tail != "self").then_some(tail));
        if own {
            self.paths.push(path.clone());
        }
        let name = if name == "self" {
            path.last().cloned().unwrap_or_default()
        } else {
            name
        };
        self.imports.push((name, path));
    }
}

/// Whether an item is there in tests only.
fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let list = attribute.meta.require_list();
        attribute.path().is_ident("cfg") && list.is_ok_and(|list| list.tokens.to_string() == "test")
    })
}

impl<'a> Visit<'a> for Names {
    fn visit_item_mod(&mut self, item: &'a syn::ItemMod) {
        if !is_test(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'a syn::ItemUse) {
        // What is handed on is not used.
        let own = matches!(item.vis, syn::Visibility::Inherited);
        self.import(&item.tree, &mut Vec::new(), own);
    }

    fn visit_path(&mut self, path: &'a syn::Path) {
        let segments = path
            .segments
            .iter()
            .map(|segment| segment.ident.to_string());
        self.paths.push(segments.collect());
        visit::visit_path(self, path);
    }
}

/// The modules of a crate.
struct Crate(BTreeMap<Module, Names>);

impl Crate {
    fn read(folder: &Path) -> Self {
        let mut modules = BTreeMap::new();
        for file in rust_files(folder) {
            let inside = file.strip_prefix(folder).unwrap().with_extension("");
            let mut module: Module = inside
                .iter()
                .map(|part| part.to_string_lossy().into())
                .collect();
            let last = module.last().cloned().unwrap_or_default();
            if last == "main" {
                continue;
            }
            if last == "mod" || inside == Path::new("lib") {
                module.pop();
            }
            let text = std::fs::read_to_string(&file).unwrap();
            modules.insert(module, names(&text));
        }
        Self(modules)
    }

    /// The module in which a path that is written in `from` ends; none where it leads out of the crate.
    fn resolve(&self, from: &Module, path: &[String], depth: usize) -> Option<Module> {
        let (first, mut rest) = path.split_first()?;
        let mut at = match first.as_str() {
            "crate" => Module::new(),
            "self" => from.clone(),
            "super" => from[..from.len().checked_sub(1)?].to_vec(),
            name => {
                let child = [from.as_slice(), &[name.to_string()]].concat();
                match self.0.contains_key(&child) {
                    true => child,
                    false => return self.imported(from, path, depth),
                }
            }
        };
        while let Some((next, after)) = rest.split_first() {
            let child = [at.as_slice(), std::slice::from_ref(next)].concat();
            if next == "super" {
                at.pop()?;
            } else if self.0.contains_key(&child) {
                at = child;
            } else {
                return self.imported(&at, rest, depth).or(Some(at));
            }
            rest = after;
        }
        Some(at)
    }

    /// Where a name comes from that a module imports.
    fn imported(&self, at: &Module, path: &[String], depth: usize) -> Option<Module> {
        let (name, rest) = path.split_first()?;
        let (_, origin) = self
            .0
            .get(at)?
            .imports
            .iter()
            .find(|(own, _)| own == name)?;
        // A name that is imported from itself ends in another crate.
        let leads_on = depth < 8 && origin.as_slice() != std::slice::from_ref(name);
        leads_on.then(|| self.resolve(at, &[origin.as_slice(), rest].concat(), depth + 1))?
    }

    /// Which child of a module sees which, with one place where it does.
    fn edges(&self) -> BTreeMap<Module, BTreeMap<String, BTreeMap<String, String>>> {
        let mut edges: BTreeMap<_, BTreeMap<_, BTreeMap<_, _>>> = BTreeMap::new();
        for (from, names) in &self.0 {
            for path in &names.paths {
                let Some(to) = self.resolve(from, path, 0) else {
                    continue;
                };
                let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
                if let (Some(own), Some(other)) = (from.get(shared), to.get(shared)) {
                    let place = format!("{}: {}", from.join("::"), path.join("::"));
                    let of_parent: &mut BTreeMap<_, BTreeMap<_, _>> =
                        edges.entry(from[..shared].to_vec()).or_default();
                    of_parent
                        .entry(own.clone())
                        .or_default()
                        .insert(other.clone(), place);
                }
            }
        }
        edges
    }

    /// Circles, each told by its steps.
    fn circles(&self) -> Vec<String> {
        let mut circles = Vec::new();
        for children in self.edges().values() {
            for (own, others) in children {
                for (other, place) in others {
                    if let Some(back) = way(children, other, own) {
                        circles.push(format!("{place}, and back: {}", back.join(", ")));
                    }
                }
            }
        }
        circles
    }
}

/// Places that lead from one module to another.
fn way(
    children: &BTreeMap<String, BTreeMap<String, String>>,
    from: &str,
    to: &str,
) -> Option<Vec<String>> {
    let mut left = vec![(from.to_string(), Vec::new())];
    let mut seen = BTreeSet::new();
    while let Some((at, places)) = left.pop() {
        for (next, place) in children.get(&at).into_iter().flatten() {
            let places = [places.as_slice(), std::slice::from_ref(place)].concat();
            if next == to {
                return Some(places);
            }
            if seen.insert(next.clone()) {
                left.push((next.clone(), places));
            }
        }
    }
    None
}

fn names(text: &str) -> Names {
    let mut names = Names::default();
    names.visit_file(&syn::parse_file(text).unwrap());
    names
}

#[test]
fn no_crate_has_a_circle_of_imports() {
    let circles: Vec<String> = source_folders()
        .iter()
        .flat_map(|folder| Crate::read(folder).circles())
        .collect();
    assert!(circles.is_empty(), "{}", circles.join("\n"));
}

#[test]
fn a_circle_is_found_through_what_a_parent_hands_on() {
    let module = |path: &str| {
        path.split("::")
            .filter(|part| !part.is_empty())
            .map(String::from)
            .collect()
    };
    let of = |files: &[(&str, &str)]| {
        let files = files.iter().map(|(path, text)| (module(path), names(text)));
        Crate(files.collect()).circles()
    };
    let root = "mod a; mod b; pub use b::Thing;";
    let round = of(&[
        ("", root),
        ("a", "use crate::Thing; pub fn f(_: Thing) {}"),
        ("b", "use super::a::f; pub struct Thing;"),
    ]);
    assert_eq!(round.len(), 2, "{round:?}");
    let down = of(&[
        ("", root),
        ("a", "use crate::Thing;"),
        ("b", "pub struct Thing;"),
    ]);
    assert!(down.is_empty(), "{down:?}");
    let by_path = of(&[
        ("", root),
        ("a", "fn f() { super::b::g() }"),
        ("b", "use crate::a;"),
    ]);
    assert_eq!(by_path.len(), 2, "{by_path:?}");
}
