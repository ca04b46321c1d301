//! Checks that no two files of a crate or a program depend on each other, directly or through other files.
//!
//! A file depends on the modules in which the paths that it imports or mentions are defined. Methods of a
//! type that is implemented in several files, and macros that are called by their names alone, are not
//! followed.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use quote::ToTokens;
use syn::punctuated::Punctuated;
use syn::{Attribute, Item, Meta, Token, UseTree, Visibility};

/// The names of a path. If it names a module, it is relative to the root of its crate.
type Names = Vec<String>;

/// The modules of a crate without its unit tests, and the paths in them.
struct Modules<'a> {
    /// Returns the text of a file, if the file exists.
    text: &'a dyn Fn(&Path) -> Option<String>,
    /// The file of each module.
    files: BTreeMap<Names, PathBuf>,
    /// The path, as written, from which each name of a module is imported.
    imports: BTreeMap<(Names, String), Names>,
    /// The modules, each with a path that is mentioned in it.
    mentions: Vec<(Names, Names)>,
}

impl<'a> Modules<'a> {
    fn read(root: &Path, text: &'a dyn Fn(&Path) -> Option<String>) -> Self {
        let (files, imports, mentions) = <_>::default();
        let mut modules = Modules { text, files, imports, mentions };
        let source = text(root).unwrap_or_else(|| panic!("no {}", root.display()));
        modules.read_file(root, root.parent().unwrap(), Names::new(), &source);
        modules
    }

    /// Reads a file. `folder` contains the files of its modules.
    fn read_file(&mut self, file: &Path, folder: &Path, module: Names, source: &str) {
        let parsed = syn::parse_file(source).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        self.read_items(file, folder, module, parsed.items);
    }

    fn read_items(&mut self, file: &Path, folder: &Path, module: Names, items: Vec<Item>) {
        self.files.insert(module.clone(), file.to_owned());
        for item in items {
            match item {
                item if is_test(attributes(&item)) => {}
                Item::Mod(child) => {
                    let name = child.ident.to_string();
                    let below = [module.clone(), vec![name.clone()]].concat();
                    let inner = folder.join(&name);
                    if let Some((_, items)) = child.content {
                        self.read_items(file, &inner, below, items);
                        continue;
                    }
                    if let Some(place) = file_attribute(&child.attrs) {
                        let place = file.parent().unwrap().join(place);
                        let source = (self.text)(&place).expect("a file by its path");
                        self.read_file(&place, place.parent().unwrap(), below, &source);
                        continue;
                    }
                    let places = [folder.join(format!("{name}.rs")), inner.join("mod.rs")];
                    let found = places.iter().find_map(|place| Some((place, (self.text)(place)?)));
                    let (place, source) = found.unwrap_or_else(|| panic!("no {places:?}"));
                    self.read_file(place, &inner, below, &source);
                }
                Item::Use(import) => {
                    let is_public = !matches!(import.vis, Visibility::Inherited);
                    self.import(&module, &mut Names::new(), import.tree, is_public);
                }
                item => {
                    let mut paths = Vec::new();
                    collect_paths(item.into_token_stream(), &[], &mut paths);
                    self.mentions.extend(paths.into_iter().map(|path| (module.clone(), path)));
                }
            }
        }
    }

    fn import(&mut self, module: &Names, path: &mut Names, tree: UseTree, is_public: bool) {
        let (name, alias) = match tree {
            UseTree::Path(part) => {
                path.push(part.ident.to_string());
                self.import(module, path, *part.tree, is_public);
                path.pop();
                return;
            }
            UseTree::Group(group) => {
                let import = |tree| self.import(module, path, tree, is_public);
                group.items.into_iter().for_each(import);
                return;
            }
            // The other module would have to be searched for the items that it exports.
            UseTree::Glob(_) => {
                assert!(!is_public, "{path:?} is exported as a whole in {module:?}");
                (None, None)
            }
            UseTree::Name(name) => (Some(name.ident.to_string()), None),
            UseTree::Rename(name) => (Some(name.ident.to_string()), Some(name.rename.to_string())),
        };
        let path: Names = path.iter().cloned().chain(name.filter(|name| name != "self")).collect();
        self.mentions.push((module.clone(), path.clone()));
        let alias = alias.or_else(|| path.last().cloned()).unwrap_or_default();
        self.imports.insert((module.clone(), alias), path);
    }

    /// Returns a path in a module as a path from the root of the crate, or `None` for paths of other crates
    /// and for paths through more than `depth` imports.
    fn absolute(&self, module: &Names, path: &Names, depth: usize) -> Option<Names> {
        let (first, rest) = path.split_first()?;
        let from = |module: &[String]| Some([module, rest].concat());
        match first.as_str() {
            "crate" => from(&[]),
            "self" | "super" => {
                let module = if first == "self" { module } else { module.split_last()?.1 };
                match rest.first() {
                    Some(next) if next == "super" => {
                        self.absolute(&module.to_vec(), &rest.to_vec(), depth)
                    }
                    _ => from(module),
                }
            }
            _ => {
                let child = [&module[..], std::slice::from_ref(first)].concat();
                if self.files.contains_key(&child) {
                    return from(&child);
                }
                let import = self.imports.get(&(module.clone(), first.clone()))?;
                let import = self.absolute(module, import, depth.checked_sub(1)?)?;
                from(&import)
            }
        }
    }

    /// Returns the file that defines what a path from the root of the crate names, even if other modules
    /// re-export it.
    fn file(&self, path: &Names, depth: usize) -> Option<&Path> {
        if let Some(file) = self.files.get(path) {
            return Some(file);
        }
        let inner = (0..path.len()).rev().find(|&n| self.files.contains_key(&path[..n]))?;
        let (module, rest) = path.split_at(inner);
        let module = module.to_vec();
        let exported = self.imports.get(&(module.clone(), rest[0].clone())).and_then(|import| {
            let target = self.absolute(&module, import, depth)?;
            let target = [target, rest[1..].to_vec()].concat();
            self.file(&target, depth.checked_sub(1)?)
        });
        exported.or_else(|| self.files.get(&module).map(PathBuf::as_path))
    }

    /// Returns the files on which each file depends.
    fn arrows(&self) -> BTreeMap<&Path, BTreeSet<&Path>> {
        let mut arrows: BTreeMap<&Path, BTreeSet<&Path>> = BTreeMap::new();
        for (module, path) in &self.mentions {
            let from = self.files[module].as_path();
            let to = self.absolute(module, path, 8).and_then(|path| self.file(&path, 8));
            arrows.entry(from).or_default().extend(to.filter(|to| *to != from));
        }
        arrows
    }
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// Returns whether an item is compiled only for tests.
fn is_test(attributes: &[Attribute]) -> bool {
    let is_cfg = |attribute: &&Attribute| attribute.path().is_ident("cfg");
    attributes
        .iter()
        .filter(is_cfg)
        .any(|attribute| attribute.parse_args().is_ok_and(|condition: Meta| needs_test(&condition)))
}

fn needs_test(condition: &Meta) -> bool {
    match condition {
        Meta::List(list) if list.path.is_ident("all") => {
            let all = list.parse_args_with(Punctuated::<Meta, Token![,]>::parse_terminated);
            all.is_ok_and(|all| all.iter().any(needs_test))
        }
        condition => condition.path().is_ident("test"),
    }
}

/// Returns the file that `#[path = "..."]` names.
fn file_attribute(attributes: &[Attribute]) -> Option<String> {
    attributes.iter().find_map(|attribute| match &attribute.meta {
        Meta::NameValue(named) if named.path.is_ident("path") => {
            let text = named.value.to_token_stream().to_string();
            Some(text.trim_matches('"').to_owned())
        }
        _ => None,
    })
}

/// Collects the paths with at least two names in code, including those in the arguments of macros and
/// attributes. Names in braces after a path continue that path.
fn collect_paths(tokens: TokenStream, prefix: &[String], paths: &mut Vec<Names>) {
    let (mut path, mut colons) = (Names::new(), 0);
    for token in tokens {
        match token {
            TokenTree::Punct(punct) if punct.as_char() == ':' => colons += 1,
            // `$crate` is the crate that defines a macro, which is imported from its file.
            TokenTree::Punct(punct) if punct.as_char() == '$' => {
                paths.push(std::mem::replace(&mut path, vec!["$".to_owned()]));
                colons = 2;
            }
            TokenTree::Ident(name) => {
                if colons != 2 {
                    paths.push(std::mem::replace(&mut path, prefix.to_vec()));
                }
                path.push(name.to_string());
                colons = 0;
            }
            TokenTree::Group(group) if !is_visibility(&group) => {
                let is_continued = colons == 2 && group.delimiter() == Delimiter::Brace;
                collect_paths(group.stream(), if is_continued { &path } else { &[] }, paths);
                paths.push(std::mem::take(&mut path));
                colons = 0;
            }
            other => {
                paths.push(std::mem::take(&mut path));
                colons = 0;
                // For example `with = "crate::module"` in an attribute.
                if let TokenTree::Literal(literal) = other {
                    let text = literal.to_string();
                    let text = text.trim_matches('"');
                    if text.starts_with("crate::") || text.starts_with("super::") {
                        paths.push(text.split("::").map(str::to_owned).collect());
                    }
                }
            }
        }
    }
    paths.push(path);
    paths.retain(|path| path.len() > 1);
}

/// Returns whether a group is that of `pub(in path)`.
fn is_visibility(group: &proc_macro2::Group) -> bool {
    let first = group.stream().into_iter().next();
    group.delimiter() == Delimiter::Parenthesis
        && first.is_some_and(|first| first.to_string() == "in")
}

/// Returns the dependencies between files that depend on each other.
fn circles<'a>(
    arrows: &BTreeMap<&'a Path, BTreeSet<&'a Path>>,
) -> BTreeMap<&'a Path, BTreeSet<&'a Path>> {
    let needs = |from: &'a Path| {
        let (mut found, mut ahead) = (BTreeSet::new(), vec![from]);
        while let Some(file) = ahead.pop() {
            let next = arrows.get(file).into_iter().flatten();
            ahead.extend(next.filter(|file| found.insert(**file)));
        }
        found
    };
    let all: BTreeMap<&Path, BTreeSet<&Path>> =
        arrows.keys().map(|file| (*file, needs(file))).collect();
    let back = |from: &'a Path, to: &BTreeSet<&'a Path>| -> BTreeSet<&'a Path> {
        to.iter().copied().filter(|to| all.get(to).is_some_and(|all| all.contains(from))).collect()
    };
    let arrows = arrows.iter().map(|(from, to)| (*from, back(from, to)));
    arrows.filter(|(_, to)| !to.is_empty()).collect()
}

/// Returns the root files of the crates and programs in a folder.
fn roots(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut roots: Vec<PathBuf> = entries
        .map(|entry| entry.unwrap().path())
        .flat_map(|path| match path.is_dir() {
            true => vec![path.join("lib.rs"), path.join("main.rs")],
            false => vec![path],
        })
        .filter(|path| path.is_file() && path.extension().is_some_and(|ending| ending == "rs"))
        .collect();
    roots.sort();
    roots
}

#[test]
fn no_two_files_need_each_other() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let crates = fs::read_dir(root.join("crates")).unwrap().map(|entry| entry.unwrap().path());
    let text = |path: &Path| fs::read_to_string(path).ok();
    let (mut read, mut found) = (BTreeSet::new(), Vec::new());
    for krate in crates.chain([root.to_owned()]) {
        let whole = ["src/lib.rs", "src/main.rs"].map(|file| krate.join(file));
        let whole = whole.into_iter().filter(|path| path.is_file());
        let folders = ["src/bin", "examples", "tests", "benches"].map(|folder| krate.join(folder));
        let begins: Vec<PathBuf> =
            whole.chain(folders.iter().flat_map(|folder| roots(folder))).collect();
        assert!(!begins.is_empty(), "nothing begins in {}", krate.display());
        for begin in begins {
            let modules = Modules::read(&begin, &text);
            read.extend(modules.files.values().cloned());
            for (from, to) in circles(&modules.arrows()) {
                let short =
                    |path: &Path| path.strip_prefix(root).unwrap_or(path).display().to_string();
                let to: Vec<String> = to.into_iter().map(short).collect();
                found.push(format!("{} needs {}", short(from), to.join(", ")));
            }
        }
    }
    assert!(read.len() > 900, "only {} files were read", read.len());
    assert!(found.is_empty(), "files in circles:\n{}", found.join("\n"));
}

#[test]
fn circles_are_noticed() {
    let find = |files: &[(&'static str, &'static str)]| -> Vec<String> {
        let files: BTreeMap<PathBuf, &str> =
            files.iter().map(|(path, text)| (PathBuf::from(path), *text)).collect();
        let text = |path: &Path| files.get(path).map(|text| (*text).to_owned());
        let modules = Modules::read(Path::new("src/lib.rs"), &text);
        circles(&modules.arrows()).keys().map(|path| path.display().to_string()).collect()
    };
    let root = ("src/lib.rs", "mod a; pub use a::C; #[cfg(test)] mod tests;");
    let alone = ("src/a.rs", "mod b; pub use b::C; fn f() -> u8 { b::g() }");
    // An item that the parent only re-exports from another child belongs to that child.
    let below =
        ("src/a/b.rs", "pub struct C; pub(in crate::a) fn g() -> u8 { let c: crate::C; 1 }");
    assert_eq!(find(&[root, alone, below]), [""; 0]);
    let back = ("src/a/b.rs", "use super::f; pub struct C; pub fn g() {}");
    assert_eq!(find(&[root, alone, back]), ["src/a/b.rs", "src/a.rs"]);
    let in_macro = ("src/a/b.rs", "pub struct C; pub fn g() { x!(1, [super::f()]) }");
    assert_eq!(find(&[root, alone, in_macro]), ["src/a/b.rs", "src/a.rs"]);
    let far = ("src/lib.rs", "mod a; pub fn h() -> a::C {}");
    let through = ("src/a/b.rs", "use crate as root; pub struct C; pub fn g() { root::h() }");
    assert_eq!(find(&[far, alone, through]), ["src/a/b.rs", "src/lib.rs"]);
    for inside in [
        "pub struct C; pub fn g() { use super::super::a::{f, b::C as D}; }",
        "#[serde(with = \"crate::a\")] pub struct C; pub fn g() {}",
        "pub struct C; pub fn g() { self::super::f() }",
        "pub struct C; #[cfg(any(test, unix))] pub fn g() { super::f() }",
    ] {
        let found = find(&[root, alone, ("src/a/b.rs", inside)]);
        assert_eq!(found, ["src/a/b.rs", "src/a.rs"], "{inside}");
    }
    for inside in [
        "pub struct C; #[cfg(test)] fn h() { super::f() } pub fn g() {}",
        "pub struct C; #[cfg(all(unix, test))] use super::f; pub fn g() {}",
        "pub struct C; pub fn g() { macro_rules! m { () => { $crate::a::f() } } }",
    ] {
        assert_eq!(find(&[root, alone, ("src/a/b.rs", inside)]), [""; 0], "{inside}");
    }
    let only_tests = ("src/a/b.rs", "pub struct C; #[cfg(test)] mod tests { use crate::a::f; }");
    assert_eq!(find(&[root, alone, only_tests]), [""; 0]);
}
