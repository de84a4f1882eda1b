//! Links between the repository's pages, the book's list of pages, and its length.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::manifests::root;

/// Links that lead nowhere, and pages of the book that its summary lacks, as "page: link".
pub fn broken_links() -> Vec<String> {
    let book = root().join("docs/src");
    let mut broken = Vec::new();
    for page in all_pages() {
        let text = read(&page);
        for link in links_of(&text) {
            let (file, heading) = link.split_once('#').unwrap_or((&link, ""));
            let target = match file {
                "" => page.clone(),
                _ => page.parent().expect("a folder").join(file),
            };
            let is_known = match heading {
                "" => target.exists(),
                _ => target.is_file() && headings_of(&read(&target)).contains(heading),
            };
            if !is_known {
                broken.push(format!("{}: {link}", page.display()));
            }
        }
    }
    // The page of the architecture is this part of a file.
    let part = "ANCHOR: book -->";
    if !read(&root().join("ARCHITECTURE.md")).contains(part) {
        broken.push(format!("ARCHITECTURE.md lacks {part}"));
    }
    let summary = links_of(&read(&book.join("SUMMARY.md")));
    for page in markdown_in(&book) {
        let name = page
            .file_name()
            .expect("a file")
            .to_string_lossy()
            .into_owned();
        if name != "SUMMARY.md" && !summary.contains(&name) {
            broken.push(format!("SUMMARY.md lacks {name}"));
        }
    }
    broken
}

/// The pages of the book, and those beside it.
pub fn all_pages() -> Vec<PathBuf> {
    let mut pages = markdown_in(&root().join("docs/src"));
    let others = [
        "README.md",
        "ARCHITECTURE.md",
        "CONTRIBUTING.md",
        "crates/python/README.md",
    ];
    pages.extend(others.map(|name| root().join(name)));
    pages
}

/// Lines of the blocks of code of a page, and code within its sentences.
pub fn code_of(text: &str) -> Vec<String> {
    let blocks = text.split("\n```").skip(1).step_by(2);
    let joined = blocks.map(|block| block.replace("\\\n", " "));
    let lines = joined.flat_map(|block| block.lines().map(str::to_owned).collect::<Vec<_>>());
    let prose = prose_of(text);
    let spans = prose.split('`').skip(1).step_by(2).map(str::to_owned);
    lines.chain(spans).collect()
}

/// Words of the book's prose: its pages without code, tables, comments and the targets of links.
pub fn words_of_book() -> usize {
    let mut pages = markdown_in(&root().join("docs/src"));
    pages.retain(|page| !page.ends_with("SUMMARY.md"));
    pages.push(root().join("ARCHITECTURE.md"));
    let words = pages.iter().map(|page| {
        let prose = prose_of(&read(page));
        let lines = prose.lines().map(str::trim_start);
        let lines = lines.filter(|line| !line.starts_with(['|', '<']));
        let text = lines.collect::<Vec<_>>().join(" ");
        let parts = text.split("](").enumerate();
        let parts = parts.map(|(i, part)| match part.split_once(')') {
            Some((_target, rest)) if i > 0 => rest,
            _ => part,
        });
        parts.collect::<String>().split_whitespace().count()
    });
    words.sum()
}

pub fn read(page: &Path) -> String {
    std::fs::read_to_string(page).unwrap_or_else(|error| panic!("{}: {error}", page.display()))
}

fn markdown_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("the book's folder");
    let files = entries.map(|entry| entry.expect("an entry").path());
    files
        .filter(|file| file.extension().is_some_and(|extension| extension == "md"))
        .collect()
}

/// A page without its blocks of code.
fn prose_of(text: &str) -> String {
    let prose: Vec<&str> = text.split("\n```").step_by(2).collect();
    prose.join("\n")
}

/// The targets of `[text](target)` within the repository, outside blocks of code.
fn links_of(text: &str) -> Vec<String> {
    let prose = prose_of(text);
    let ends = prose.split("](").skip(1);
    let targets = ends.filter_map(|rest| rest.split_once(')'));
    targets
        .map(|(target, _)| target.to_owned())
        .filter(|target| !target.contains("://") && !target.starts_with("mailto:"))
        .collect()
}

/// The names by which links call the headings of a page.
fn headings_of(text: &str) -> BTreeSet<String> {
    let prose = prose_of(text);
    let headings = prose.lines().filter(|line| line.starts_with('#'));
    let names = headings.map(|line| {
        let title = line.trim_start_matches('#').trim().to_lowercase();
        let kept = title.chars().filter_map(|c| match c {
            ' ' => Some('-'),
            _ if c.is_alphanumeric() || "-_".contains(c) => Some(c),
            _ => None,
        });
        kept.collect()
    });
    names.collect()
}
