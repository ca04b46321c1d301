//! The README, the guide and the crates' READMEs hold together: links, pictures, headings, chapters.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};

/// The most lines of the README.
const README_LINES: usize = 170;

/// What a page links to, and what can be linked in it.
#[derive(Default)]
struct Page {
    /// Targets of links and pictures, as written.
    targets: Vec<String>,
    /// The names of its headings in links.
    anchors: BTreeSet<String>,
    /// Whether it has snippets in Rust.
    rust: bool,
}

impl Page {
    fn parse(text: &str) -> Page {
        let mut page = Page::default();
        let mut heading: Option<String> = None;
        for event in Parser::new_ext(text, Options::ENABLE_TABLES) {
            match event {
                Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                    page.targets.push(dest_url.into_string());
                }
                Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
                Event::Text(part) | Event::Code(part) => {
                    if let Some(heading) = &mut heading {
                        heading.push_str(&part);
                    }
                }
                Event::End(TagEnd::Heading(_)) => {
                    let name = anchor(&heading.take().unwrap_or_default());
                    let numbered = (1..).map(|n| format!("{name}-{n}"));
                    let mut names = std::iter::once(name.clone()).chain(numbered);
                    let free = names.find(|name| !page.anchors.contains(name));
                    page.anchors.extend(free);
                }
                Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(language))) => {
                    page.rust |= &*language == "rust";
                }
                _ => {}
            }
        }
        page
    }
}

/// The name of a heading in links, as on GitHub and in mdBook.
fn anchor(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    heading.to_lowercase().chars().filter(kept).map(|c| if c == ' ' { '-' } else { c }).collect()
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The pages in a folder and below it, relative to the root.
fn pages_below(folder: &Path) -> Vec<PathBuf> {
    let mut pages = Vec::new();
    for entry in fs::read_dir(root().join(folder)).unwrap() {
        let entry = entry.unwrap();
        let path = folder.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            pages.extend(pages_below(&path));
        } else if path.extension().is_some_and(|ending| ending == "md") {
            pages.push(path);
        }
    }
    pages.sort();
    pages
}

/// Every page, by its path relative to the root.
fn pages() -> BTreeMap<PathBuf, Page> {
    let mut paths = vec![PathBuf::from("README.md")];
    paths.extend(pages_below(Path::new("docs")));
    let crates = fs::read_dir(root().join("crates")).unwrap();
    let readmes =
        crates.map(|entry| Path::new("crates").join(entry.unwrap().file_name()).join("README.md"));
    paths.extend(readmes.filter(|path| root().join(path).exists()));
    let read = |path: PathBuf| {
        let text = fs::read_to_string(root().join(&path)).unwrap();
        (path, Page::parse(&text))
    };
    paths.into_iter().map(read).collect()
}

/// The file that a relative link of a page means, relative to the root; `None` outside of the root.
fn resolved(page: &Path, link: &str) -> Option<PathBuf> {
    if link.is_empty() {
        return Some(page.to_owned());
    }
    let mut path = page.parent()?.to_owned();
    for part in Path::new(link).components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => path = path.parent()?.to_owned(),
            Component::Normal(name) => path.push(name),
            Component::Prefix(_) | Component::RootDir => return None,
        }
    }
    Some(path)
}

/// What is wrong with a link, if anything.
fn complaint(pages: &BTreeMap<PathBuf, Page>, page: &Path, target: &str) -> Option<String> {
    if target.contains("://") || target.starts_with("mailto:") {
        return None;
    }
    let (link, name) = target.split_once('#').unwrap_or((target, ""));
    let Some(path) = resolved(page, link) else {
        return Some("is outside of the repository".to_owned());
    };
    if !root().join(&path).exists() {
        return Some("does not exist".to_owned());
    }
    let known = |other: &Page| other.anchors.contains(name);
    (!name.is_empty() && !pages.get(&path).is_some_and(known))
        .then(|| "names a heading that does not exist".to_owned())
}

#[test]
fn every_link_and_picture_exists() {
    let pages = pages();
    let mut wrong = Vec::new();
    for (path, page) in &pages {
        for target in &page.targets {
            let complaint = complaint(&pages, path, target);
            wrong.extend(complaint.map(|what| format!("{}: {target} {what}", path.display())));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    let links: usize = pages.values().map(|page| page.targets.len()).sum();
    assert!(links > 80, "only {links} links were found");
}

#[test]
fn the_summary_lists_every_chapter_once() {
    let summary = Path::new("docs/SUMMARY.md");
    let pages = pages();
    let mut listed: Vec<_> =
        pages[summary].targets.iter().filter_map(|link| resolved(summary, link)).collect();
    listed.sort();
    let mut chapters = pages_below(Path::new("docs"));
    chapters.retain(|path| path != summary);
    assert_eq!(listed, chapters);
}

#[test]
fn the_readme_is_short_and_its_commands_change_no_file_of_the_repository() {
    let text = fs::read_to_string(root().join("README.md")).unwrap();
    let lines = text.lines().count();
    assert!(lines <= README_LINES, "{lines} lines");
    let commands = || text.lines().filter(|line| line.starts_with("cargo run"));
    assert!(commands().count() > 5);
    for command in commands() {
        assert!(!command.contains("docs/"), "{command}");
    }
}

#[test]
fn snippets_of_the_guide_are_compiled() {
    let library = fs::read_to_string(root().join("src/lib.rs")).unwrap();
    for (path, page) in pages() {
        if path.starts_with("docs") {
            let included = library.contains(&format!("include_str!(\"../{}\")", path.display()));
            assert_eq!(page.rust, included, "{} and src/lib.rs", path.display());
        }
    }
}

#[test]
fn headings_have_the_names_that_links_use() {
    for (heading, name) in [
        ("Your own SLAM, policy or sensor", "your-own-slam-policy-or-sensor"),
        ("What is promised and measured", "what-is-promised-and-measured"),
        ("`sample`, in full", "sample-in-full"),
    ] {
        let page = Page::parse(&format!("# {heading}\n\n## {heading}\n"));
        let expected = [name.to_owned(), format!("{name}-1")];
        assert_eq!(page.anchors, BTreeSet::from(expected));
    }
}

#[test]
fn broken_links_are_noticed() {
    let pages = pages();
    let page = Path::new("docs/guide/trials.md");
    for (target, expected) in [
        ("#scores", None),
        ("drivers.md", None),
        ("../../examples/drivers/minimal.py", None),
        ("https://docs.rs/envgen", None),
        ("#no-such-heading", Some("names a heading")),
        ("drivers.md#no-such-heading", Some("names a heading")),
        ("../pictures/no_such.svg", Some("does not exist")),
        ("../../../outside.md", Some("outside")),
        ("/docs/guide/drivers.md", Some("outside")),
    ] {
        let found = complaint(&pages, page, target);
        let as_expected = match (expected, &found) {
            (None, None) => true,
            (Some(expected), Some(found)) => found.contains(expected),
            _ => false,
        };
        assert!(as_expected, "{target}: {found:?}, expected {expected:?}");
    }
}
