//! Documents against the source tree: links, commands, figures, and the site that they make.
use integration_tests::documents::{blocks_of, pages, section, text};
use integration_tests::fmus::tree;
use integration_tests::installed::Program;
use integration_tests::python::python;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Text without code blocks and code spans, which hold no links.
fn prose(text: &str) -> String {
    let mut prose = String::new();
    let mut code = false;
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            code = !code;
        } else if !code {
            prose.extend(line.split('`').step_by(2));
            prose.push('\n');
        }
    }
    prose
}

/// Targets of all links and pictures of a text.
fn links(text: &str) -> Vec<String> {
    let prose = prose(text);
    let targets = prose.split("](").skip(1);
    targets.map(|rest| rest.split(')').next().unwrap().to_owned()).collect()
}

/// Anchor that forges and the site give a headline.
fn anchor(headline: &str) -> String {
    let letters = headline.trim().to_lowercase();
    let letters = letters
        .chars()
        .filter(|letter| letter.is_alphanumeric() || " -_".contains(*letter));
    letters.map(|letter| if letter == ' ' { '-' } else { letter }).collect()
}

/// Anchors of all headlines of a page.
fn anchors(text: &str) -> BTreeSet<String> {
    let headlines = text.lines().filter(|line| line.starts_with('#'));
    headlines.map(|line| anchor(line.trim_start_matches('#'))).collect()
}

#[test]
fn every_relative_link_of_every_page_resolves() {
    let mut broken = Vec::new();
    for page in pages() {
        let text = text(page.to_str().unwrap());
        for link in links(&text) {
            if link.contains("://") || link.starts_with("mailto:") {
                continue;
            }
            let (file, anchor) = link
                .split_once('#')
                .map_or((link.as_str(), None), |(f, a)| (f, Some(a)));
            let target = match file {
                "" => tree().join(&page),
                file => tree().join(page.parent().unwrap()).join(file),
            };
            let there = target.is_file()
                && anchor.is_none_or(|anchor| anchors(&fs::read_to_string(&target).unwrap()).contains(anchor));
            if !there {
                broken.push(format!("{}: {link}", page.display()));
            }
        }
    }
    assert!(broken.is_empty(), "broken links:\n{}", broken.join("\n"));
}

/// Commands of the program in a text that shows them, one a line; the words behind `master`.
fn calls(text: &str) -> Vec<Vec<String>> {
    let lines = text.lines().filter_map(|line| {
        let line = line.split(" # ").next().unwrap();
        let call = line.strip_prefix("target/release/").unwrap_or(line);
        call.strip_prefix("master ").map(str::to_owned)
    });
    lines
        .map(|call| call.split_whitespace().map(|word| word.replace(',', "")).collect())
        .collect()
}

#[test]
fn every_shown_call_of_the_program_names_commands_options_and_scenes_that_exist() {
    let mut shown: Vec<(String, Vec<String>)> = Vec::new();
    for page in pages() {
        let page = page.to_str().unwrap();
        for block in blocks_of(&text(page), "sh") {
            shown.extend(calls(&block).into_iter().map(|call| (page.to_owned(), call)));
        }
    }
    for (file, figures) in figures() {
        for figure in figures {
            shown.extend(calls(&figure.command).into_iter().map(|call| (file.clone(), call)));
        }
    }
    assert!(shown.len() > 100, "{} calls", shown.len());
    let program = Program::new();
    let mut helps: BTreeMap<String, String> = BTreeMap::new();
    for (place, call) in shown {
        let command = &call[0];
        let help = helps
            .entry(command.clone())
            .or_insert_with(|| program.call(&[command, "--help"]).done().stdout);
        for word in &call[1..] {
            let option = word.split('=').next().unwrap();
            let known = !option.starts_with("--")
                || help.contains(&format!("{option} "))
                || help.contains(&format!("{option}\n"));
            assert!(known, "{place}: `master {command}` has no {option}");
            let scene = word.starts_with("scenes/") && word.ends_with(".toml");
            assert!(!scene || tree().join(word).is_file(), "{place}: there is no {word}");
        }
    }
}

/// A measured figure.
struct Figure {
    value: String,
    command: String,
}

/// Fields of a line of a CSV file; a field in quotation marks may hold commas.
fn fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    for letter in line.chars() {
        match letter {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            letter => fields.last_mut().unwrap().push(letter),
        }
    }
    fields
}

/// The figures of all files of `docs/validation`, with every row well formed.
fn figures() -> BTreeMap<String, Vec<Figure>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(tree().join("docs/validation")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "csv") {
            continue;
        }
        let name = format!("docs/validation/{}", path.file_name().unwrap().to_string_lossy());
        let text = text(&name);
        let mut lines = text.lines();
        assert_eq!(
            lines.next(),
            Some("figure,value,unit,command,commit,machine,date"),
            "{name}"
        );
        let mut names = BTreeSet::new();
        let mut figures = Vec::new();
        for line in lines {
            let fields = fields(line);
            let [figure, value, _unit, command, commit, machine, date] = &fields[..] else {
                panic!("{name}: {line}");
            };
            assert!(names.insert(figure.clone()), "{name}: {figure} stands twice");
            assert!(!value.is_empty() && !command.is_empty(), "{name}: {line}");
            let elsewhere = command.starts_with("not measured by this program");
            assert_eq!(
                elsewhere,
                commit.is_empty() && machine.is_empty() && date.is_empty(),
                "{name}: {line}"
            );
            figures.push(Figure {
                value: value.clone(),
                command: command.clone(),
            });
        }
        all.insert(name, figures);
    }
    assert!(all.len() > 5);
    all
}

#[test]
fn every_figure_that_the_readme_quotes_stands_in_the_linked_file() {
    let readme = text("README.md");
    let all = figures();
    let rows = section(&readme, "Validation")
        .lines()
        .filter(|line| line.starts_with("| "));
    let mut quoted = 0;
    for row in rows.filter(|row| row.contains(".csv")) {
        let cells: Vec<_> = row.trim_matches('|').split('|').map(str::trim).collect();
        let value = cells[1].split(' ').next().unwrap();
        let link = links(row).pop().unwrap();
        let file = all.get(&link).unwrap_or_else(|| panic!("no {link}"));
        assert!(file.iter().any(|figure| figure.value == value), "{link} has no {value}");
        quoted += 1;
    }
    assert_eq!(quoted, 5);
}

#[test]
fn the_site_builds_without_a_warning() {
    println!("made with {}", python());
    let output = Command::new("sh").arg(tree().join("docs/build")).output().unwrap();
    let said = [output.stdout, output.stderr].concat();
    let said = String::from_utf8_lossy(&said);
    assert!(output.status.success(), "{said}");
    let page = |name: &str| Path::new(&tree().join("target/site")).join(name).is_file();
    for name in ["index.html", "docs/architecture.html", "docs/guide/python-api.html"] {
        assert!(page(name), "no {name}: {said}");
    }
}
