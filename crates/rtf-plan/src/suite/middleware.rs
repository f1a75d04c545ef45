//! Probes of middleware in `<ready>` and `<alive>`: `ros-node`, `ros-topic`, …

use roxmltree::Node;

use super::reader::ElementReader;
use super::{DeclaredProbeKind, MiddlewareProbe, Spanned, reference};

/// The attributes. `fixtures/rtf_fixtures/probe.py` defines their meaning.
const KINDS: [&str; 5] = ["ros-node", "ros-topic", "ros-service", "ros2-topic", "yarp-port"];

/// Checks whether an attribute probes middleware.
pub(super) fn is_probe(attribute: &str) -> bool {
    KINDS.contains(&attribute)
}

/// Reads the probe; `None` if it is invalid.
pub(super) fn read(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
    attribute: &str,
    name: &Spanned<String>,
) -> Option<DeclaredProbeKind> {
    let kind = KINDS.into_iter().find(|kind| *kind == attribute)?;
    let min_rate = min_rate(reader, node);
    if !reference::check(reader, kind, name) {
        return None;
    }
    let example = crate::config::sample(&reference::example(&name.value));
    let is_absolute = example.len() > 1 && example.starts_with('/') && !example.ends_with('/');
    if !is_absolute || example.contains(char::is_whitespace) {
        let hint =
            format!("write all of it, like `/robot/{}`", kind.rsplit('-').next().unwrap_or(kind));
        reader.wrong(kind, name, "is not an absolute name", Some(&hint));
        return None;
    }
    let probe = MiddlewareProbe { kind, name: name.value.clone(), min_rate: min_rate.ok()? };
    Some(DeclaredProbeKind::Middleware(probe))
}

fn min_rate(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Result<Option<f64>, ()> {
    let Some(attribute) = reader.word(node, "min-rate") else { return Ok(None) };
    match attribute.value.parse::<f64>() {
        Ok(rate) if rate.is_finite() && rate > 0.0 => Ok(Some(rate)),
        _ => {
            let hint = Some("messages per second, like `5` or `0.5`");
            reader.wrong("min-rate", &attribute, "is not a rate", hint);
            Err(())
        }
    }
}
