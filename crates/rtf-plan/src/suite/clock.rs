//! The attributes `clock` and `clock-backstop` of a suite.

use roxmltree::Node;

use super::reader::ElementReader;
use super::{ClockSource, DeclaredClock};

const SOURCES: [(&str, Option<ClockSource>); 5] = [
    ("wall", None),
    ("ros", Some(ClockSource::Ros)),
    ("ros2", Some(ClockSource::Ros2)),
    ("yarp", Some(ClockSource::Yarp)),
    ("file", Some(ClockSource::File)),
];

/// Reads both attributes.
pub(super) fn read(reader: &mut ElementReader<'_>, root: Node<'_, '_>) -> Option<DeclaredClock> {
    let clock = reader.attribute(root, "clock");
    let source = reader.choice(root, "clock", &SOURCES).flatten();
    let backstop = reader.number(root, "clock-backstop", 1);
    // An unknown clock was reported above; it may well have a backstop.
    let is_wall =
        source.is_none() && clock.as_ref().is_none_or(|clock| clock.value.trim() == SOURCES[0].0);
    if is_wall && let Some(attribute) = reader.attribute(root, "clock-backstop") {
        let hint = "`clock` is `ros`, `ros2`, `yarp` or `file` in a suite that needs one";
        reader.wrong("clock-backstop", &attribute, "has no meaning for the wall clock", Some(hint));
    }
    let span = clock?.span;
    source.map(|source| DeclaredClock { source, backstop, span })
}
