//! Documents of the source tree, as tests read them.
use crate::fmus::tree;
use std::fs;
use std::path::{Path, PathBuf};

/// Text of a document, by its path in the source tree.
///
/// # Panics
/// When there is no such file.
#[must_use]
pub fn text(document: &str) -> String {
    let path = tree().join(document);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// First code block of a language in the section of a document below a headline of level 2.
///
/// # Panics
/// When there is none.
#[must_use]
pub fn block(document: &str, headline: &str, language: &str) -> String {
    let blocks = blocks_of(section(&text(document), headline), language);
    blocks
        .into_iter()
        .next()
        .unwrap_or_else(|| panic!("{document}, {headline}: no {language}"))
}

/// Section of a text below a headline of level 2.
///
/// # Panics
/// When there is none.
#[must_use]
pub fn section<'a>(text: &'a str, headline: &str) -> &'a str {
    let (_, below) = text
        .split_once(&format!("\n## {headline}\n"))
        .unwrap_or_else(|| panic!("no headline {headline}"));
    below.split("\n## ").next().unwrap()
}

/// All code blocks of a language in a text, in their order.
#[must_use]
pub fn blocks_of(text: &str, language: &str) -> Vec<String> {
    let opening = format!("```{language}\n");
    let mut rest = text;
    let mut blocks = Vec::new();
    while let Some((_, code)) = rest.split_once(&opening) {
        let (code, after) = code.split_once("```").expect("a code block ends");
        blocks.push(code.to_owned());
        rest = after;
    }
    blocks
}

/// All Markdown files of the source tree, by their paths in it.
///
/// # Panics
/// When a folder cannot be read.
#[must_use]
pub fn pages() -> Vec<PathBuf> {
    let mut pages = Vec::new();
    collect(tree(), &mut pages);
    pages.sort();
    assert!(pages.contains(&PathBuf::from("README.md")));
    pages
}

/// Adds the Markdown files of a folder, without products of builds and hidden folders.
fn collect(folder: &Path, pages: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() {
            if !name.starts_with('.') && !["target", "results"].contains(&name.as_str()) {
                collect(&path, pages);
            }
        } else if path.extension().is_some_and(|extension| extension == "md") {
            pages.push(path.strip_prefix(tree()).unwrap().to_owned());
        }
    }
}
