//! Checks the README, the guide and the READMEs of the crates: links, pictures, headings and chapters. Also
//! checks that documentation, comments and messages use the words of the glossary.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

use envgen::geometry::{Pose, Rect};
use envgen::settings::Setting;
use mapping_trial::driver::Hello;
use mapping_trial::experiment::survey::Condition;
use mapping_trial::lidar::LaserProfile;
use mapping_trial::odometry::OdometryProfile;
use mapping_trial::robot::{Chassis, LaserMount, Robot};
use mapping_trial::score::{MovingScores, Scores};
use mapping_trial::trial::{Setup, TrialSettings};
use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};
use serde_json::Value;

/// The largest number of lines of the README.
const README_LINES: usize = 170;

/// The links of a page, and what other pages can link to.
#[derive(Default)]
struct Page {
    /// The targets of links and pictures, as written.
    targets: Vec<String>,
    /// The anchors of its headings.
    anchors: BTreeSet<String>,
    /// Whether it has code blocks in Rust.
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

/// Returns the anchor of a heading, as on GitHub and in mdBook.
fn anchor(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    heading.to_lowercase().chars().filter(kept).map(|c| if c == ' ' { '-' } else { c }).collect()
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Returns the pages in a folder and below it, relative to the root.
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

/// Returns every page, by its path relative to the root.
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

/// Returns the file that a relative link of a page refers to, relative to the root, or `None` if it is
/// outside of the root.
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

/// Returns what is wrong with a link, if anything.
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

/// Returns the features that the manifest of a crate declares, without `default`.
fn features(manifest: &str) -> Vec<&str> {
    let lines = manifest.lines().skip_while(|line| *line != "[features]").skip(1);
    let lines = lines.take_while(|line| !line.starts_with('['));
    let names = lines.filter_map(|line| line.split_once(" = [")).map(|(name, _)| name);
    names.filter(|name| *name != "default").collect()
}

#[test]
fn the_guide_names_every_feature() {
    for (krate, page) in [
        ("envgen", "installation.md"),
        ("mapping_trial", "installation.md"),
        ("bevy_envgen", "bevy.md"),
        ("bevy_mapping_trial", "bevy.md"),
        ("bevy_offscreen", "bevy.md"),
    ] {
        let manifest = root().join("crates").join(krate).join("Cargo.toml");
        let manifest = fs::read_to_string(manifest).unwrap();
        let page = fs::read_to_string(root().join("docs/guide").join(page)).unwrap();
        let sentence = format!("Features of `{krate}`");
        let mut paragraphs = page.split("\n\n").skip_while(|found| !found.starts_with(&sentence));
        let mut named = paragraphs.next().unwrap_or_default().to_owned();
        // A table is a paragraph of its own.
        if named.ends_with(':') {
            named.push_str(paragraphs.next().unwrap_or_default());
        }
        let readme =
            fs::read_to_string(root().join("crates").join(krate).join("README.md")).unwrap();
        let features = features(&manifest);
        assert!(!features.is_empty(), "{krate}");
        for feature in features {
            let name = format!("`{feature}`");
            assert!(named.contains(&name), "{krate}: {name} is not in the guide");
            assert!(readme.contains(&name), "{krate}: {name} is not in the crate's README");
        }
    }
}

#[test]
fn the_guide_names_every_public_module() {
    let page = fs::read_to_string(root().join("docs/guide/architecture.md")).unwrap();
    for krate in ["envgen", "mapping_trial", "bevy_envgen", "bevy_mapping_trial"] {
        let (_, section) = page.split_once(&format!("## Inside `{krate}`")).unwrap();
        let section = section.split("\n## ").next().unwrap();
        let library = root().join("crates").join(krate).join("src/lib.rs");
        let library = fs::read_to_string(library).unwrap();
        let modules = library.lines().filter_map(|line| line.strip_prefix("pub mod "));
        let modules: Vec<&str> = modules.filter_map(|line| line.strip_suffix(';')).collect();
        assert!(modules.len() > 4, "{krate}");
        for module in modules {
            assert!(section.contains(&format!("`{module}`")), "{krate}: `{module}` is not named");
        }
    }
}

/// Returns the names of the fields of a JSON value, including those of nested objects.
fn fields(value: &Value) -> BTreeSet<String> {
    let Some(object) = value.as_object() else { return BTreeSet::new() };
    let below = |(name, value): (&String, &Value)| {
        let inner: Vec<String> = fields(value).into_iter().map(|f| format!("{name}.{f}")).collect();
        std::iter::once(name.clone()).chain(inner)
    };
    object.iter().flat_map(below).collect()
}

#[test]
fn drivers_are_sent_the_fields_that_the_protocol_documents() {
    let text = fs::read_to_string(root().join("docs/driver-protocol.md")).unwrap();
    let (_, section) = text.split_once("### hello, from the trial").unwrap();
    let example = section.split("```json").nth(1).unwrap().split("```").next().unwrap();
    let documented: Value = serde_json::from_str(example).unwrap();
    let (settings, starts) = (TrialSettings::default(), [Pose::new(4.5, 1.5, 0.0)]);
    let area = Rect::new(Pose::default().position, Pose::new(48.0, 48.0, 0.0).position);
    let doors = false;
    let setup = Setup { settings: &settings, starts: &starts, area, doors, scenario: None };
    let hello = Hello::new(&setup);
    let sent = serde_json::to_value(&hello).unwrap();
    assert_eq!(fields(&sent), fields(&documented));
    assert_eq!(sent["robot"], documented["robot"]);
}

/// Returns the first column of the first table after a text of the page on files.
fn documented_fields(page: &str, after: &str) -> BTreeSet<String> {
    let (_, rest) = page.split_once(after).unwrap_or_else(|| panic!("{after}"));
    let rows = rest.lines().skip_while(|line| !line.starts_with("|---")).skip(1);
    let rows = rows.take_while(|line| line.starts_with('|'));
    rows.map(|row| row.split('`').nth(1).unwrap().to_owned()).collect()
}

fn keys(value: &Value) -> BTreeSet<String> {
    value.as_object().unwrap().keys().cloned().collect()
}

#[test]
fn the_page_on_files_has_the_fields_of_files() {
    let page = fs::read_to_string(root().join("docs/guide/files.md")).unwrap();
    let settings = |settings: &[Setting]| -> BTreeSet<String> {
        let name = |name: &str| name.replace("circumscribed_radius", "swing_radius");
        settings.iter().map(|setting| name(setting.name)).collect()
    };
    for (after, known) in [
        ("\n## Robots\n", Robot::SETTINGS),
        ("\n`laser_mount` has", LaserMount::SETTINGS),
        ("\n`chassis` has", Chassis::SETTINGS),
        ("\n## Lasers\n", LaserProfile::SETTINGS),
        ("\n## Odometry\n", OdometryProfile::SETTINGS),
    ] {
        assert_eq!(documented_fields(&page, after), settings(known), "{after}");
    }
    let scores = serde_json::to_value(Scores::default()).unwrap();
    assert_eq!(documented_fields(&page, "\n`score_1` has"), keys(&scores["score_1"]));
    let moving = serde_json::to_value(MovingScores::default()).unwrap();
    assert_eq!(documented_fields(&page, "\n`moving` has"), keys(&moving));
    let mut all = keys(&scores);
    all.insert("moving".to_owned());
    assert_eq!(documented_fields(&page, "\n`scores` has"), all);
    let condition = Condition { driver: Some(String::new()), ..Condition::default() };
    let mut known = keys(&serde_json::to_value(condition).unwrap());
    // Files omit them at their defaults.
    known.extend(["wheel_calibration", "scenario"].map(str::to_owned));
    assert_eq!(documented_fields(&page, "\nA condition has these fields"), known);
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

/// The words that are not used, each with its replacement. `docs/glossary.md` gives the reasons.
const WORDS: [(&str, &str); 17] = [
    ("way", "path, direction, method"),
    ("ways", "paths, directions, methods"),
    ("anew", "again, rebuild"),
    ("stands", "is, exists, is ready"),
    ("tells of", "reports, shows"),
    ("tell of", "report, show"),
    ("told", "reported, given"),
    ("foretold", "predicted"),
    ("goes on", "continues"),
    ("dead odometry", "wheel odometry"),
    ("per cents", "percent"),
    ("a metre of", "per metre"),
    ("brain", "autonomy"),
    ("knob", "lever"),
    ("knobs", "levers"),
    ("swing radius", "circumscribed radius"),
    ("vertical range", "extent"),
];

/// Returns the words of a line that are not used, each with its replacement. Code in the line may contain any
/// word.
fn wrong_words(line: &str) -> Vec<String> {
    let line: String = line.split('`').step_by(2).collect::<Vec<_>>().join(" ");
    let words = |text: &str| -> Vec<String> {
        let parts = text.split(|c: char| !c.is_alphanumeric() && c != '_' && c != '-');
        parts.filter(|word| !word.is_empty()).map(str::to_lowercase).collect()
    };
    let line = words(&line);
    let has = |phrase: &str| {
        let phrase = words(phrase);
        line.windows(phrase.len()).any(|window| *window == *phrase)
    };
    let wrong = WORDS.iter().filter(|(wrong, _)| has(wrong));
    wrong.map(|(wrong, right)| format!("`{wrong}` ({right})")).collect()
}

/// Returns the Rust files in a folder and below it, relative to the root.
fn sources_below(folder: &Path) -> Vec<PathBuf> {
    let mut sources = Vec::new();
    for entry in fs::read_dir(root().join(folder)).into_iter().flatten() {
        let entry = entry.unwrap();
        let path = folder.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            sources.extend(sources_below(&path));
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            sources.push(path);
        }
    }
    sources
}

/// Returns the English text of a line of Rust: its comment, or else its string literals and the name of its
/// function.
fn comments_and_strings(line: &str) -> Cow<'_, str> {
    let line = line.trim_start();
    if line.starts_with("//") {
        return Cow::Borrowed(line);
    }
    let (code, comment) = line.split_once(" // ").unwrap_or((line, ""));
    let code = code.replace("'\"'", "").replace("\\\"", "");
    let name = match code.split_once("fn ") {
        Some((before, name)) if !before.contains('"') => name.split(['(', '<']).next(),
        _ => None,
    };
    let name = name.unwrap_or_default().replace('_', " ");
    let texts = code.split('"').skip(1).step_by(2).chain([name.as_str(), comment]);
    let texts: Vec<&str> = texts.map(str::trim).filter(|text| !text.is_empty()).collect();
    Cow::Owned(texts.join(" "))
}

/// Returns all columns of a line of the glossary except the last, which has the words that are not used.
fn terms_and_meanings(line: &str) -> Cow<'_, str> {
    let end = line.strip_suffix(" |").and_then(|line| line.rfind('|'));
    Cow::Borrowed(&line[..end.unwrap_or_default()])
}

/// Returns the words in the name of a file and in those of the folders that contain it.
fn names(path: &Path) -> String {
    path.with_extension("").to_string_lossy().replace(['/', '_', '-', '.'], " ")
}

#[test]
fn documentation_keeps_to_the_words_of_the_glossary() {
    let mut wrong = Vec::new();
    let mut read = 0;
    let mut look = |path: &Path, prose: fn(&str) -> Cow<'_, str>| {
        let text = fs::read_to_string(root().join(path)).unwrap();
        wrong.extend(
            wrong_words(&names(path)).iter().map(|word| format!("{}: {word}", path.display())),
        );
        for (number, line) in text.lines().enumerate() {
            let written = prose(line);
            read += usize::from(!written.is_empty());
            for word in wrong_words(&written) {
                wrong.push(format!("{}:{}: {word}", path.display(), number + 1));
            }
        }
    };
    look(Path::new("CHANGELOG.md"), |line| Cow::Borrowed(line));
    for page in pages().keys() {
        look(
            page,
            if page.ends_with("glossary.md") {
                terms_and_meanings
            } else {
                |line| Cow::Borrowed(line)
            },
        );
    }
    let crates = fs::read_dir(root().join("crates")).unwrap();
    let mut folders: Vec<PathBuf> = vec!["src".into(), "examples".into(), "tests".into()];
    for entry in crates {
        let of_crate = Path::new("crates").join(entry.unwrap().file_name());
        folders.extend(["src", "examples", "tests", "benches"].map(|folder| of_crate.join(folder)));
    }
    for source in folders.iter().flat_map(|folder| sources_below(folder)) {
        // This file contains the list of words itself.
        if source != Path::new("tests/docs.rs") {
            look(&source, comments_and_strings);
        }
    }
    assert!(read > 20_000, "only {read} lines were read");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn wrong_words_are_noticed() {
    assert_eq!(
        wrong_words("Builds it Anew; dead odometry."),
        ["`anew` (again, rebuild)", "`dead odometry` (wheel odometry)"]
    );
    let line = r#"fail("no way", way, '"', "a \"told\" one"); // anew"#;
    assert_eq!(comments_and_strings(line), "no way a told one anew");
    assert_eq!(comments_and_strings("    let way = 1;"), "");
    assert_eq!(comments_and_strings("    pub fn begins_anew<T>(way: T) {"), "begins anew");
    assert_eq!(names(Path::new("a/new_way/b-c.rs")), "a new way b c");
    assert_eq!(terms_and_meanings("| lever | A setting | knob |"), "| lever | A setting ");
    assert!(wrong_words("A wayward gateway, `way` and always a half-way house.").is_empty());
}
