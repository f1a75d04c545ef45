//! The settings of a suite file that an `rtf.toml` can contain as well.

use std::collections::BTreeMap;

use roxmltree::Node;

use super::{SourceText, Span, xml};

/// Values and their spans by the keys of an `rtf.toml`: `environment`, `env.NAME`.
pub type SharedSettings = BTreeMap<String, (String, Span)>;

/// Returns the suite's environment string and its variables. Problems of the
/// file are not reported here: [`parse`](super::parse) reports them.
#[must_use]
pub fn shared_settings(source: &SourceText) -> SharedSettings {
    let mut settings = SharedSettings::new();
    let mut problems = Vec::new();
    let Some(scan) = xml::prepare(source, &mut problems) else { return settings };
    let Some(document) = xml::parse(source, &scan.text, &mut problems) else { return settings };
    for node in document.root_element().children().filter(Node::is_element) {
        let span = Span::new(node.range());
        match node.tag_name().name() {
            "environment" => {
                let text = node.text().unwrap_or_default().trim().to_owned();
                if !text.is_empty() {
                    settings.insert("environment".to_owned(), (text, span));
                }
            }
            "env" => {
                if let (Some(name), Some(value)) = (node.attribute("name"), node.attribute("value"))
                {
                    settings.insert(format!("env.{}", name.trim()), (value.to_owned(), span));
                }
            }
            _ => {}
        }
    }
    settings
}
