//! Reads the elements of an XML file: of a suite, or of another file with the same rules.

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::{ElementReader, FixtureReferences, ReferenceUser, SourceText, port_reference, xml};

/// Parses the text of an XML file, and passes its first element to `read`. Adds every problem to
/// `problems`; `None` if the text is not XML, or `read` returned it.
pub fn read_document<T>(
    source: &SourceText,
    problems: &mut Vec<Diagnostic>,
    read: impl FnOnce(&mut ElementReader<'_>, Node<'_, '_>) -> Option<T>,
) -> Option<T> {
    let scan = xml::prepare(source, problems)?;
    let document = xml::parse(source, &scan.text, problems)?;
    let mut reader = ElementReader {
        source,
        problems,
        ports: port_reference::Ports::default(),
        user: ReferenceUser::Suite,
        fixture_references: FixtureReferences::default(),
    };
    read(&mut reader, document.root_element())
}
