//! A writer for XML.

use std::io::Write;

use quick_xml::Writer;
#[cfg(feature = "sdf")]
use quick_xml::events::BytesText;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, Event};

use super::error::ExportError;
use crate::xml_text::allowed;

/// The name and the value of an attribute.
pub(super) type Attribute = (&'static str, String);

/// Formats a number with as many digits as are needed to read the same number back.
pub(super) fn number(value: f64) -> String {
    let plain = value.to_string();
    if plain.len() <= 24 { plain } else { format!("{value:e}") }
}

/// Formats numbers with a space between them.
#[cfg(any(feature = "sdf", feature = "mjcf"))]
pub(super) fn numbers(values: impl IntoIterator<Item = f64>) -> String {
    values.into_iter().map(number).collect::<Vec<_>>().join(" ")
}

/// A document that is written element by element.
pub(super) struct Xml<'a>(Writer<&'a mut dyn Write>);

impl<'a> Xml<'a> {
    /// Begins a document without elements.
    pub(super) fn begin(out: &'a mut dyn Write) -> Result<Self, ExportError> {
        let mut xml = Xml(Writer::new_with_indent(out, b' ', 2));
        xml.0.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
        Ok(xml)
    }

    /// Ends the document's last line.
    pub(super) fn end(mut self) -> Result<(), ExportError> {
        Ok(self.0.get_mut().write_all(b"\n")?)
    }

    /// Writes an element without content.
    #[cfg(any(feature = "mjcf", feature = "opendrive"))]
    pub(super) fn leaf(&mut self, name: &str, attributes: &[Attribute]) -> Result<(), ExportError> {
        Ok(self.0.write_event(Event::Empty(element(name, attributes)))?)
    }

    /// Writes an element that contains a text.
    #[cfg(feature = "sdf")]
    pub(super) fn text(&mut self, name: &str, text: &str) -> Result<(), ExportError> {
        self.0.write_event(Event::Start(element(name, &[])))?;
        self.0.write_event(Event::Text(BytesText::new(&allowed(text))))?;
        Ok(self.0.write_event(Event::End(BytesEnd::new(name)))?)
    }

    /// Writes an element that contains other elements.
    pub(super) fn nest(
        &mut self,
        name: &str,
        attributes: &[Attribute],
        inner: impl FnOnce(&mut Self) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        self.0.write_event(Event::Start(element(name, attributes)))?;
        inner(self)?;
        Ok(self.0.write_event(Event::End(BytesEnd::new(name)))?)
    }
}

fn element<'a>(name: &'a str, attributes: &'a [Attribute]) -> BytesStart<'a> {
    let mut element = BytesStart::new(name);
    for (name, value) in attributes {
        element.push_attribute((*name, &*allowed(value)));
    }
    element
}
