//! `rtf.toml`.

use rtf_plan::config::parse;

use super::labels;

/// A configuration file: its entries have the positions of their keys.
pub fn check(data: &[u8]) {
    labels::check(data, |source, problems| {
        let config = parse(source, problems);
        let layers = config.profiles.iter().map(|(_, layer)| layer).chain([&config.defaults]);
        for entry in layers.flat_map(|layer| &layer.entries) {
            assert!(!entry.key.is_empty());
            assert!(source.text().get(entry.span.range()).is_some(), "{entry:?}");
            for value in &entry.values {
                assert!(source.text().get(value.span.range()).is_some(), "{value:?}");
            }
        }
        problems.is_empty()
    });
}
