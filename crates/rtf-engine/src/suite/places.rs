//! Where a suite says what an `rtf.toml` may say as well.

use std::collections::BTreeMap;

use roxmltree::Node;

use super::{Source, Span, xml};

/// The suite's environment string (`environment`) and its own variables
/// (`env.NAME`), each with its place. Problems are not told: whoever reads the
/// suite does that.
#[must_use]
pub fn places(source: &Source) -> BTreeMap<String, (String, Span)> {
    let mut places = BTreeMap::new();
    let mut problems = Vec::new();
    let Some(scan) = xml::prepare(source, &mut problems) else { return places };
    let Some(document) = xml::parse(source, &scan.text, &mut problems) else { return places };
    for node in document.root_element().children().filter(Node::is_element) {
        match node.tag_name().name() {
            "environment" => {
                let text = node.text().unwrap_or_default().trim().to_owned();
                if !text.is_empty() {
                    places.insert("environment".to_owned(), (text, Span::new(node.range())));
                }
            }
            "env" => {
                if let (Some(name), Some(value)) = (node.attribute("name"), node.attribute("value"))
                {
                    let value = (value.to_owned(), Span::new(node.range()));
                    places.insert(format!("env.{}", name.trim()), value);
                }
            }
            _ => {}
        }
    }
    places
}
