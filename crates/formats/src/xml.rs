//! Elements of a file: names, attributes read as numbers or words, children, places.

use crate::error::{FormatError, Place};
use glam::DVec3;
use std::sync::Arc;

/// Deepest nesting of elements that is read.
const MAX_DEPTH: usize = 500;
/// Most elements, texts and comments of one file.
const MAX_NODES: u32 = 2_000_000;

#[derive(Clone, Debug)]
pub(crate) struct Attribute {
    pub name: String,
    pub value: String,
    /// Where it stands: for an inherited attribute, not where its element does.
    pub place: Place,
}

#[derive(Clone, Debug)]
pub(crate) struct Element {
    pub name: String,
    pub attributes: Vec<Attribute>,
    pub children: Vec<Element>,
    pub place: Place,
}

/// The root element of a text. Document type definitions are refused, so no entity can expand.
pub(crate) fn parse(text: &str, file: &str) -> Result<Element, FormatError> {
    let lines = Lines::new(text, file);
    let options = roxmltree::ParsingOptions {
        allow_dtd: false,
        nodes_limit: MAX_NODES,
        ..roxmltree::ParsingOptions::default()
    };
    let document = roxmltree::Document::parse_with_options(text, options).map_err(|error| {
        if matches!(error, roxmltree::Error::DtdDetected) {
            return lines.type_definition();
        }
        let position = error.pos();
        let place = match error {
            roxmltree::Error::UnclosedRootNode | roxmltree::Error::UnexpectedEndOfStream => {
                lines.place(text.len())
            }
            _ => Place {
                file: lines.file.clone(),
                line: position.row,
                column: position.col,
            },
        };
        let problem = without_position(&error.to_string());
        FormatError::Xml { place, problem }
    })?;
    convert(document.root_element(), &lines, 1)
}

/// The XML parser's message without the " at line:column" at its end.
fn without_position(message: &str) -> String {
    match message.rsplit_once(" at ") {
        Some((problem, at)) if at.chars().all(|c| c.is_ascii_digit() || c == ':') => problem.into(),
        _ => message.into(),
    }
}

fn convert(node: roxmltree::Node, lines: &Lines, depth: usize) -> Result<Element, FormatError> {
    let mut element = Element {
        name: name(node),
        attributes: Vec::new(),
        children: Vec::new(),
        place: lines.place(node.range().start),
    };
    element.check_depth(depth)?;
    for attribute in node.attributes() {
        element.attributes.push(Attribute {
            name: attribute.name().to_owned(),
            value: attribute.value().to_owned(),
            place: lines.place(attribute.range().start),
        });
    }
    for child in node.children().filter(roxmltree::Node::is_element) {
        element.children.push(convert(child, lines, depth + 1)?);
    }
    Ok(element)
}

/// As it is written, with the prefix of its namespace.
fn name(node: roxmltree::Node) -> String {
    let tag = node.tag_name();
    let prefix = tag.namespace().and_then(|uri| node.lookup_prefix(uri));
    match prefix {
        Some(prefix) if !prefix.is_empty() => format!("{prefix}:{}", tag.name()),
        _ => tag.name().to_owned(),
    }
}

/// What follows the comment or instruction that a text begins with.
fn behind_comment(text: &str) -> Option<&str> {
    let ends = [("<!--", "-->"), ("<?", "?>")];
    let behind = |(start, end)| Some(text.strip_prefix(start)?.split_once(end)?.1);
    ends.into_iter().find_map(behind)
}

/// Where each line of a text starts.
struct Lines<'a> {
    text: &'a str,
    file: Arc<str>,
    starts: Vec<usize>,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str, file: &str) -> Self {
        let newlines = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let starts = std::iter::once(0)
            .chain(newlines.map(|(i, _)| i + 1))
            .collect();
        Self {
            text,
            file: file.into(),
            starts,
        }
    }

    /// The error of a text that defines its type; the parser does not say where. It stands behind comments and
    /// instructions, which may name one.
    fn type_definition(&self) -> FormatError {
        let mut rest = self.text.trim_start_matches('\u{feff}').trim_start();
        while let Some(behind) = behind_comment(rest) {
            rest = behind.trim_start();
        }
        FormatError::Invalid {
            place: self.place(self.text.len() - rest.len()),
            element: "!DOCTYPE".into(),
            problem: "document type definitions are not read".into(),
            remedy: "remove the line".into(),
        }
    }

    fn place(&self, offset: usize) -> Place {
        let row = self.starts.partition_point(|start| *start <= offset);
        let line = &self.text[self.starts[row - 1]..offset];
        let column = line.chars().count() + 1;
        Place {
            file: self.file.clone(),
            line: row as u32,
            column: column as u32,
        }
    }
}

impl Element {
    /// An error about this element.
    pub fn invalid(&self, problem: &str, remedy: &str) -> FormatError {
        FormatError::Invalid {
            place: self.place.clone(),
            element: self.name.clone(),
            problem: problem.to_owned(),
            remedy: remedy.to_owned(),
        }
    }

    /// Elements are read recursively, so their depth is bounded.
    pub fn check_depth(&self, depth: usize) -> Result<(), FormatError> {
        if depth <= MAX_DEPTH {
            return Ok(());
        }
        let problem = format!("elements are nested more than {MAX_DEPTH} deep");
        Err(self.invalid(&problem, "make the tree of elements flatter"))
    }

    /// An error about one of its attributes.
    pub fn invalid_attribute(&self, name: &str, problem: &str, remedy: &str) -> FormatError {
        let attribute = self.attributes.iter().find(|a| a.name == name);
        FormatError::Invalid {
            place: attribute.map_or(&self.place, |a| &a.place).clone(),
            element: self.name.clone(),
            problem: format!("attribute `{name}` {problem}"),
            remedy: remedy.to_owned(),
        }
    }

    /// An attribute's text.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes
            .iter()
            .find(|a| a.name == name)
            .map(|a| a.value.as_str())
    }

    /// Whether an attribute is there.
    pub fn has(&self, name: &str) -> bool {
        self.get(name).is_some()
    }

    /// An attribute's text; missing, an error.
    pub fn require(&self, name: &str) -> Result<&str, FormatError> {
        self.get(name).ok_or_else(|| {
            self.invalid(
                &format!("attribute `{name}` is missing"),
                &format!("write {name}=\"…\""),
            )
        })
    }

    /// The element without its children.
    pub fn shallow(&self) -> Self {
        Self {
            name: self.name.clone(),
            attributes: self.attributes.clone(),
            children: Vec::new(),
            place: self.place.clone(),
        }
    }

    /// Takes over attributes, in the place of its own of the same name.
    pub fn inherit_over(&mut self, attributes: &[Attribute]) {
        for attribute in attributes {
            match self
                .attributes
                .iter_mut()
                .find(|own| own.name == attribute.name)
            {
                Some(own) => *own = attribute.clone(),
                None => self.attributes.push(attribute.clone()),
            }
        }
    }

    /// Children of a name.
    pub fn children_named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Element> {
        self.children.iter().filter(move |child| child.name == name)
    }

    /// The first child of a name.
    pub fn child(&self, name: &str) -> Option<&Element> {
        self.children.iter().find(|child| child.name == name)
    }

    /// Numbers separated by blanks, between `least` and `most` of them.
    pub fn list(
        &self,
        name: &str,
        least: usize,
        most: usize,
    ) -> Result<Option<Vec<f64>>, FormatError> {
        let Some(text) = self.get(name) else {
            return Ok(None);
        };
        let mut numbers = Vec::new();
        for word in text.split_ascii_whitespace() {
            match word.parse::<f64>() {
                Ok(number) if number.is_finite() => numbers.push(number),
                _ => {
                    return Err(self.invalid_attribute(
                        name,
                        &format!("holds `{word}`, which is not a finite number"),
                        "write numbers such as 1, -0.5 or 2e-3, separated by blanks",
                    ));
                }
            }
        }
        if (least..=most).contains(&numbers.len()) {
            return Ok(Some(numbers));
        }
        let wanted = match (least, most) {
            (a, b) if a == b => format!("{a}"),
            (0, b) => format!("at most {b}"),
            (a, usize::MAX) => format!("at least {a}"),
            (a, b) => format!("{a} to {b}"),
        };
        Err(self.invalid_attribute(
            name,
            &format!("holds {} numbers", numbers.len()),
            &format!("write {wanted}, separated by blanks"),
        ))
    }

    /// Exactly N numbers.
    pub fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, FormatError> {
        let list = self.list(name, N, N)?;
        Ok(list.map(|list| std::array::from_fn(|i| list[i])))
    }

    /// One number.
    pub fn number(&self, name: &str) -> Result<Option<f64>, FormatError> {
        Ok(self.numbers::<1>(name)?.map(|[x]| x))
    }

    /// One number that must not be negative.
    pub fn non_negative(&self, name: &str) -> Result<Option<f64>, FormatError> {
        let number = self.number(name)?;
        match number {
            Some(x) if x < 0.0 => Err(self.invalid_attribute(
                name,
                &format!("is {x}, below zero"),
                "write zero or a positive number",
            )),
            _ => Ok(number),
        }
    }

    /// Three numbers.
    pub fn vector(&self, name: &str) -> Result<Option<DVec3>, FormatError> {
        Ok(self.numbers::<3>(name)?.map(DVec3::from_array))
    }

    /// A whole number.
    pub fn integer(&self, name: &str) -> Result<Option<i64>, FormatError> {
        let Some(text) = self.get(name) else {
            return Ok(None);
        };
        let remedy = "write a whole number such as 1 or -2";
        let number = text.trim().parse();
        number.map(Some).map_err(|_| {
            self.invalid_attribute(name, &format!("is `{text}`, not a whole number"), remedy)
        })
    }

    /// One of the given words.
    pub fn word<'a>(&self, name: &str, words: &[&'a str]) -> Result<Option<&'a str>, FormatError> {
        let Some(text) = self.get(name) else {
            return Ok(None);
        };
        match words.iter().find(|word| **word == text) {
            Some(word) => Ok(Some(word)),
            None => Err(self.invalid_attribute(
                name,
                &format!("is `{text}`"),
                &format!("write one of: {}", words.join(", ")),
            )),
        }
    }

    /// "true" or "false".
    pub fn truth(&self, name: &str) -> Result<Option<bool>, FormatError> {
        Ok(self
            .word(name, &["true", "false"])?
            .map(|word| word == "true"))
    }
}
