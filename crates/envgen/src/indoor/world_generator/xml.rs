//! Flat XML documents: a root and its children, with attributes only.

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

use super::error::{MAX_TEXT, WorldGeneratorError};
use crate::indoor::spec::IndoorSpec;

/// Reads a document element by element: the root first, then its children. Deeper elements, text and comments are
/// skipped.
pub(super) struct Flat<'a> {
    reader: Reader<&'a [u8]>,
    root: &'static str,
    depth: usize,
    /// An element without content ends itself.
    seen_root: bool,
    ended: bool,
}

/// An element, with its name and attributes.
pub(super) struct Element {
    name: String,
    attributes: Vec<(String, String)>,
}

impl<'a> Flat<'a> {
    /// Opens a document whose root must have this name; returns the root's element.
    pub(super) fn open(
        text: &'a str,
        root: &'static str,
    ) -> Result<(Self, Element), WorldGeneratorError> {
        if text.len() > MAX_TEXT {
            return Err(WorldGeneratorError::TooLong(text.len()));
        }
        let reader = Reader::from_str(text);
        let mut flat = Flat { reader, root, depth: 0, seen_root: false, ended: false };
        match flat.next()? {
            Some(element) => Ok((flat, element)),
            None => Err(flat.broken("there is no element")),
        }
    }

    /// Returns the next child of the root; `None` after the root's end.
    pub(super) fn next(&mut self) -> Result<Option<Element>, WorldGeneratorError> {
        loop {
            let event = match self.reader.read_event() {
                Ok(event) => event,
                Err(error) => {
                    let position = self.reader.error_position();
                    return Err(WorldGeneratorError::Xml { position, reason: error.to_string() });
                }
            };
            let (start, empty) = match event {
                Event::DocType(_) => {
                    let position = self.reader.buffer_position();
                    return Err(WorldGeneratorError::DocumentType(position));
                }
                Event::GeneralRef(reference)
                    if reference.resolve_char_ref().ok().flatten().is_none() =>
                {
                    let name = reference.to_string();
                    if !["amp", "lt", "gt", "quot", "apos"].contains(&name.as_str()) {
                        return Err(self.broken(&format!("the entity `{name}` is not known")));
                    }
                    continue;
                }
                Event::Eof if self.depth > 0 => {
                    let reason = format!("the file ends inside `{}`", self.root);
                    return Err(self.broken(&reason));
                }
                Event::Eof => return Ok(None),
                Event::End(_) => {
                    self.depth = self.depth.saturating_sub(1);
                    self.ended = self.depth == 0;
                    continue;
                }
                Event::Start(start) => (start, false),
                Event::Empty(start) => (start, true),
                _ => continue,
            };
            if self.ended {
                return Err(self.broken("there is something after the root"));
            }
            let depth = self.depth;
            let start = start.into_owned();
            if empty {
                self.ended = depth == 0;
            } else {
                self.depth += 1;
            }
            if depth > 1 {
                continue;
            }
            let element = self.element(&start)?;
            if depth == 0 {
                self.seen_root = true;
                if element.name != self.root {
                    let expected = self.root;
                    return Err(WorldGeneratorError::Root { found: element.name, expected });
                }
            }
            return Ok(Some(element));
        }
    }

    fn element(&self, start: &BytesStart<'_>) -> Result<Element, WorldGeneratorError> {
        let name = start.name().as_ref().to_owned();
        let mut attributes = Vec::new();
        for attribute in start.attributes() {
            let attribute = attribute.map_err(|error| self.broken(&error.to_string()))?;
            let key = attribute.key.as_ref().to_owned();
            let value = attribute
                .normalized_value(XmlVersion::Implicit1_0)
                .map_err(|error| self.broken(&error.to_string()))?;
            attributes.push((key, value.into_owned()));
        }
        Ok(Element { name, attributes })
    }

    fn broken(&self, reason: &str) -> WorldGeneratorError {
        let position = self.reader.buffer_position();
        WorldGeneratorError::Xml { position, reason: reason.to_owned() }
    }
}

impl Element {
    pub(super) fn is(&self, name: &str) -> bool {
        self.name == name
    }

    /// Returns the text of an attribute.
    pub(super) fn get(&self, attribute: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == attribute).map(|(_, value)| value.as_str())
    }

    /// Returns the number of attributes with other names than these.
    pub(super) fn others(&self, names: &[&str]) -> usize {
        self.attributes.iter().filter(|(key, _)| !names.contains(&key.as_str())).count()
    }

    /// Returns the text of a required attribute.
    pub(super) fn text(
        &self,
        element: &'static str,
        number: usize,
        attribute: &'static str,
    ) -> Result<&str, WorldGeneratorError> {
        self.get(attribute).ok_or_else(|| WorldGeneratorError::Attribute {
            element,
            number,
            attribute,
            value: "nothing".to_owned(),
            allowed: "a text".to_owned(),
        })
    }

    /// Returns the whole number of a required attribute.
    pub(super) fn number(
        &self,
        element: &'static str,
        number: usize,
        attribute: &'static str,
        (least, most): (u32, u32),
    ) -> Result<u32, WorldGeneratorError> {
        let found = self.get(attribute);
        let value = found.and_then(|text| text.trim().parse().ok());
        value.filter(|value| (least..=most).contains(value)).ok_or_else(|| {
            WorldGeneratorError::Attribute {
                element,
                number,
                attribute,
                value: found.map_or_else(|| "nothing".to_owned(), |text| format!("`{text}`")),
                allowed: format!("a whole number from {least} to {most}"),
            }
        })
    }
    /// Returns the number of an attribute that has the name of a setting, or the usual one if the attribute is absent.
    pub(super) fn metres(
        &self,
        element: &'static str,
        number: usize,
        setting: &'static str,
        usual: f64,
    ) -> Result<f64, WorldGeneratorError> {
        let Some(text) = self.get(setting) else { return Ok(usual) };
        let limits = IndoorSpec::setting(setting);
        let value = text.trim().parse().ok().filter(|value| limits.check(*value).is_ok());
        value.ok_or_else(|| WorldGeneratorError::Attribute {
            element,
            number,
            attribute: setting,
            value: format!("`{text}`"),
            allowed: limits.allowed_text(),
        })
    }
}
