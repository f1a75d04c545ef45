//! What `<ready>` and `<alive>` ask of middleware: `ros-node`, `ros-topic`, …

use roxmltree::Node;

use super::value::Reader;
use super::{MiddlewareQuestion, Question, Spanned, port};

/// The attributes. What each of them means is known to the program that asks,
/// `fixtures/rtf_fixtures/probe.py`.
const KINDS: [&str; 5] = ["ros-node", "ros-topic", "ros-service", "ros2-topic", "yarp-port"];

/// Whether an attribute asks something of a middleware.
pub(super) fn is_question(attribute: &str) -> bool {
    KINDS.contains(&attribute)
}

/// Reads the question; `None` when it cannot be asked.
pub(super) fn read(
    reader: &mut Reader<'_>,
    node: Node<'_, '_>,
    attribute: &str,
    name: &Spanned<String>,
) -> Option<Question> {
    let kind = KINDS.into_iter().find(|kind| *kind == attribute)?;
    let rate = min_rate(reader, node);
    if !port::check(reader, kind, name) {
        return None;
    }
    let example = crate::config::sample(&port::expand(&name.value, |_| "1".to_owned()));
    let is_name = example.len() > 1 && example.starts_with('/') && !example.ends_with('/');
    if !is_name || example.contains(char::is_whitespace) {
        let hint =
            format!("write all of it, like `/robot/{}`", kind.rsplit('-').next().unwrap_or(kind));
        reader.wrong(kind, name, "is not a name from the root", Some(&hint));
        return None;
    }
    let min_rate = rate.ok()?;
    Some(Question::Middleware(MiddlewareQuestion { kind, name: name.value.clone(), min_rate }))
}

fn min_rate(reader: &mut Reader<'_>, node: Node<'_, '_>) -> Result<Option<f64>, ()> {
    let Some(written) = reader.word(node, "min-rate") else { return Ok(None) };
    match written.value.parse::<f64>() {
        Ok(rate) if rate.is_finite() && rate > 0.0 => Ok(Some(rate)),
        _ => {
            let hint = Some("messages a second, like `5` or `0.5`");
            reader.wrong("min-rate", &written, "is not a rate", hint);
            Err(())
        }
    }
}
