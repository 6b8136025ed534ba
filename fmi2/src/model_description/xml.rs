//! A bounded element tree: names, attributes and lines of a document. Text is dropped, and foreign content on request.

use super::DescriptionError;
use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use std::borrow::Cow;

/// Largest document, bytes.
const MAX_BYTES: usize = 64 << 20;
/// Deepest nesting of elements.
const MAX_DEPTH: usize = 64;
/// Most elements: a million variables with their type element, and their part of the model structure.
const MAX_ELEMENTS: usize = 4_000_000;
/// Longest name, bytes; other attributes (lists of dependencies, start texts) may be as long as the document.
const MAX_NAME: usize = 4096;

/// Treatment of annotations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Annotations {
    /// Annotations are kept with all content.
    Kept,
    /// The elements `Annotations` and `VendorAnnotations` stay empty.
    Dropped,
}

/// An element with its attributes and children.
#[derive(Debug, Default)]
pub struct Element {
    /// Name as written, prefix included.
    pub name: String,
    /// Names as written, prefixes included, and values; declarations of namespaces are among them.
    pub attributes: Vec<(String, String)>,
    /// Children in the order of the document.
    pub children: Vec<Element>,
    /// Line, from 1.
    pub line: usize,
}

impl Element {
    /// Value of an attribute.
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes
            .iter()
            .find(|(key, _)| key == name)
            .map(|(_, value)| value.as_str())
    }

    /// Value of an attribute that must be there.
    ///
    /// # Errors
    ///
    /// [`DescriptionError::MissingAttribute`].
    pub fn required(&self, name: &'static str) -> Result<&str, DescriptionError> {
        self.attribute(name).ok_or_else(|| DescriptionError::MissingAttribute {
            line: self.line,
            element: self.name.clone(),
            attribute: name,
        })
    }

    /// The first child of that name.
    #[must_use]
    pub fn child(&self, name: &str) -> Option<&Self> {
        self.children.iter().find(|child| child.name == name)
    }

    /// Children called `name` of the child called `list`.
    pub fn members<'a>(&'a self, list: &str, name: &'a str) -> impl Iterator<Item = &'a Self> + 'a {
        let children = self.child(list).map_or(&[][..], |list| &list.children);
        children.iter().filter(move |child| child.name == name)
    }
}

/// Counts lines up to a position that only grows.
struct Lines<'a> {
    text: &'a str,
    position: usize,
    line: usize,
}

impl Lines<'_> {
    fn at(&mut self, position: u64) -> usize {
        let position = usize::try_from(position).unwrap_or(usize::MAX).min(self.text.len());
        if position > self.position {
            let passed = &self.text.as_bytes()[self.position..position];
            self.line += passed.iter().filter(|byte| **byte == b'\n').count();
            self.position = position;
        }
        self.line
    }
}

/// Reads a document: UTF-8 with or without byte order mark, or Latin-1.
///
/// # Errors
///
/// A document that is too large, too deep, not well-formed, or that defines entities.
pub fn parse(bytes: &[u8], annotations: Annotations) -> Result<Element, DescriptionError> {
    if bytes.len() > MAX_BYTES {
        return Err(DescriptionError::TooLarge {
            size: bytes.len(),
            limit: MAX_BYTES,
        });
    }
    let text = decoded(bytes)?;
    if text.trim().is_empty() {
        return Err(DescriptionError::Empty);
    }
    let mut reader = quick_xml::Reader::from_str(&text);
    let mut lines = Lines {
        text: &text,
        position: 0,
        line: 1,
    };
    let mut stack: Vec<Element> = Vec::new();
    let mut root = None;
    let mut count = 0;
    loop {
        let start = reader.buffer_position();
        let event = reader.read_event();
        let line = lines.at(start);
        let event = event.map_err(|problem| DescriptionError::Syntax {
            line: lines.at(reader.error_position()),
            problem: problem.to_string(),
        })?;
        match event {
            Event::Start(tag) => {
                count += 1;
                let element = open(&tag, line, stack.len(), count, root.is_some())?;
                stack.push(element);
            }
            Event::Empty(tag) => {
                count += 1;
                let element = open(&tag, line, stack.len(), count, root.is_some())?;
                close(element, &mut stack, &mut root, annotations);
            }
            Event::End(_) => {
                if let Some(element) = stack.pop() {
                    close(element, &mut stack, &mut root, annotations);
                }
            }
            Event::DocType(declaration) => {
                if let Some(at) = declaration.find("<!ENTITY") {
                    let entity = declaration[at..].split('>').next().unwrap_or_default();
                    return Err(DescriptionError::Entity {
                        line,
                        entity: format!("{entity}>"),
                    });
                }
            }
            Event::Text(content) if stack.is_empty() && !content.trim().is_empty() => {
                return Err(DescriptionError::Syntax {
                    line,
                    problem: "text outside the root element".into(),
                });
            }
            Event::Eof => break,
            _ => {}
        }
    }
    if let Some(open) = stack.last() {
        return Err(DescriptionError::Syntax {
            line: lines.at(u64::MAX),
            problem: format!("the file ends inside <{}>, opened at line {}", open.name, open.line),
        });
    }
    root.ok_or_else(|| DescriptionError::Syntax {
        line: 1,
        problem: "there is no element".into(),
    })
}

/// Decodes UTF-8 with or without byte order mark, or Latin-1 if declared.
fn decoded(bytes: &[u8]) -> Result<Cow<'_, str>, DescriptionError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(200)]).to_ascii_lowercase();
    let declaration = head.split("?>").next().filter(|text| text.starts_with("<?xml"));
    if declaration.is_some_and(|text| text.contains("iso-8859-1")) {
        return Ok(Cow::Owned(bytes.iter().copied().map(char::from).collect()));
    }
    std::str::from_utf8(bytes)
        .map(Cow::Borrowed)
        .map_err(|error| DescriptionError::Encoding {
            encoding: "UTF-8".into(),
            offset: error.valid_up_to(),
        })
}

fn open(
    tag: &BytesStart<'_>,
    line: usize,
    depth: usize,
    count: usize,
    after_root: bool,
) -> Result<Element, DescriptionError> {
    if depth >= MAX_DEPTH {
        return Err(DescriptionError::TooDeep { line, limit: MAX_DEPTH });
    }
    if count > MAX_ELEMENTS {
        return Err(DescriptionError::TooMany {
            line,
            limit: MAX_ELEMENTS,
        });
    }
    let syntax = |problem: String| DescriptionError::Syntax { line, problem };
    if after_root && depth == 0 {
        return Err(syntax("there is a second root element".into()));
    }
    let name = tag.name().as_ref().to_owned();
    let mut attributes = Vec::new();
    for attribute in tag.attributes() {
        let attribute = attribute.map_err(|problem| syntax(problem.to_string()))?;
        let key: &str = attribute.key.as_ref();
        let value = attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|_| {
            let entity = attribute
                .value
                .split('&')
                .skip(1)
                .filter_map(|rest| rest.split(';').next());
            let known = ["amp", "lt", "gt", "quot", "apos"];
            let unknown = entity.into_iter().find(|e| !known.contains(e)).unwrap_or_default();
            DescriptionError::Entity {
                line,
                entity: format!("&{unknown};"),
            }
        })?;
        if value.len() > MAX_NAME && matches!(key, "name" | "unit" | "declaredType" | "modelIdentifier" | "guid") {
            return Err(DescriptionError::TooLong {
                line,
                element: name,
                attribute: key.to_owned(),
                length: value.len(),
                limit: MAX_NAME,
            });
        }
        attributes.push((key.to_owned(), value.into_owned()));
    }
    Ok(Element {
        name,
        attributes,
        children: Vec::new(),
        line,
    })
}

fn close(element: Element, stack: &mut [Element], root: &mut Option<Element>, annotations: Annotations) {
    let drops = annotations == Annotations::Dropped;
    match stack.last_mut() {
        Some(parent) if drops && matches!(parent.name.as_str(), "VendorAnnotations" | "Annotations") => {}
        Some(parent) => parent.children.push(element),
        None => *root = Some(element),
    }
}
