//! XML that is changed in its elements and attributes, or as bytes.

use fastrand::Rng;

use crate::texts::{ODD, change_bytes};

/// Places of all tags, `<` and `>` included.
fn tags(text: &str) -> Vec<(usize, usize)> {
    let begins = text.match_indices('<').map(|(at, _)| at);
    begins
        .filter_map(|at| Some((at, at + text[at..].find('>')? + 1)))
        .collect()
}

/// Places of name and value of all attributes of a tag.
fn attributes(tag: &str) -> Vec<(std::ops::Range<usize>, std::ops::Range<usize>)> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(equals) = tag[at..].find("=\"").map(|place| at + place) {
        let name = tag[..equals]
            .rfind(char::is_whitespace)
            .map_or(equals, |blank| blank + 1);
        let value = equals + 2;
        let Some(end) = tag[value..].find('"').map(|place| value + place) else {
            break;
        };
        found.push((name..equals, value..end));
        at = end + 1;
    }
    found
}

/// A value in place of another one, as it stands in quotation marks.
fn other(rng: &mut Rng, value: &str, elsewhere: &str) -> String {
    let odd = [
        "&#7;&#27;[31m",
        "&#0;",
        "&amp;lt;",
        "&undefined;",
        "&#xFFFFFFFF;",
        "2147483648",
        "-1",
        "4294967295",
        "4294967296",
        "3.0",
        "ModelExchange",
        "kN/m",
        "resources/../../x",
        "%2e%2e/x",
        "file:///etc/passwd",
        "http://example.org",
    ];
    match rng.u8(..8) {
        0 => String::new(),
        1 => elsewhere.to_owned(),
        2 => value.repeat(1 << rng.u32(..12)),
        3 => format!("{value}{value}"),
        4 | 5 => odd[rng.usize(..odd.len())].to_owned(),
        _ => ODD[rng.usize(..ODD.len())].replace('"', "&quot;"),
    }
}

/// Changes one thing of a document.
fn change(rng: &mut Rng, text: &mut String) {
    let tags = tags(text);
    if tags.is_empty() {
        return;
    }
    let (begin, end) = tags[rng.usize(..tags.len())];
    let tag = text[begin..end].to_owned();
    let (other_begin, other_end) = tags[rng.usize(..tags.len())];
    let other_tag = text[other_begin..other_end].to_owned();
    match rng.u8(..16) {
        0 => text.replace_range(begin..end, ""),
        1 => text.insert_str(begin, &tag),
        2 => text.insert_str(end, &other_tag),
        3 => text.replace_range(begin..end, &other_tag),
        4 => {
            let (from, to) = (end.min(other_end), end.max(other_end));
            text.replace_range(from..to, "");
        }
        5 => {
            let (from, to) = (end.min(other_end), end.max(other_end));
            let piece = text[from..to].to_owned();
            if piece.len() < 1 << 16 {
                text.insert_str(to, &piece.repeat(1 << rng.u32(..5)));
            }
        }
        6 => {
            let depth = 1 << rng.u32(..13);
            text.insert_str(end, &format!("{}{}", "<a>".repeat(depth), "</a>".repeat(depth)));
        }
        7 => {
            let odd = [
                "<!DOCTYPE a [<!ENTITY b \"c\">]>",
                "<![CDATA[ ]]>",
                "<!-- -- -->",
                "<?xml version=\"1.1\" encoding=\"utf-16\"?>",
                "text",
                "&lt;",
                "<a",
                "\u{1b}[31m",
            ];
            text.insert_str(begin, odd[rng.usize(..odd.len())]);
        }
        _ => {
            let found = attributes(&tag);
            if found.is_empty() {
                return;
            }
            let (name, value) = found[rng.usize(..found.len())].clone();
            let (name, value) = (
                name.start + begin..name.end + begin,
                value.start + begin..value.end + begin,
            );
            match rng.u8(..8) {
                0 => text.replace_range(name.start..(value.end + 1).min(text.len()), ""),
                1 => {
                    let again = format!(" {}", &text[name.start..value.end + 1]);
                    text.insert_str(value.end + 1, &again);
                }
                2 => text.insert(name.end, 'x'),
                _ => {
                    let elsewhere = attributes(&other_tag);
                    let elsewhere = elsewhere.get(rng.usize(..elsewhere.len().max(1)));
                    let elsewhere = elsewhere.map_or("", |(_, value)| &other_tag[value.clone()]);
                    let new = other(rng, &text[value.clone()], elsewhere);
                    text.replace_range(value, &new);
                }
            }
        }
    }
}

/// A document that is changed in one to three things, or as bytes.
pub fn changed(rng: &mut Rng, text: &str) -> Vec<u8> {
    if rng.u8(..6) == 0 {
        let mut bytes = text.as_bytes().to_vec();
        change_bytes(rng, &mut bytes);
        return bytes;
    }
    let mut text = text.to_owned();
    for _ in 0..rng.usize(1..4) {
        change(rng, &mut text);
    }
    text.into_bytes()
}
