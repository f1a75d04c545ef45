//! `clock` and `clock-backstop` of a suite.

use roxmltree::Node;

use super::value::Reader;
use super::{ClockSource, WrittenClock};

const SOURCES: [(&str, Option<ClockSource>); 5] = [
    ("wall", None),
    ("ros", Some(ClockSource::Ros)),
    ("ros2", Some(ClockSource::Ros2)),
    ("yarp", Some(ClockSource::Yarp)),
    ("file", Some(ClockSource::File)),
];

/// Reads both.
pub(super) fn read(reader: &mut Reader<'_>, root: Node<'_, '_>) -> Option<WrittenClock> {
    let written = reader.attribute(root, "clock");
    let source = reader.choice(root, "clock", &SOURCES).flatten();
    let backstop = reader.number(root, "clock-backstop", 1);
    // Of a clock that is not known it cannot be told whether it has a backstop.
    let is_wall = source.is_none()
        && written.as_ref().is_none_or(|written| written.value.trim() == SOURCES[0].0);
    if is_wall && let Some(attribute) = reader.attribute(root, "clock-backstop") {
        let hint = "`clock` is `ros`, `ros2`, `yarp` or `file` in a suite that needs one";
        reader.wrong("clock-backstop", &attribute, "has no meaning for the wall clock", Some(hint));
    }
    let span = written?.span;
    source.map(|source| WrittenClock { source, backstop, span })
}
