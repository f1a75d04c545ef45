//! The text of an exception: its message, and the place in the test.

use std::path::Path;

use rtf_model::Location;

/// Where Maven and Gradle have sources, relative to a directory around the classes.
const SOURCE_DIRS: [&str; 6] =
    ["src/test/java", "src/test/kotlin", "src/main/java", "src/main/kotlin", "src", ""];

/// How many directories around the classes are searched for sources.
const ANCESTORS: usize = 6;

/// The message of an exception, without the type of an assertion.
pub(super) fn message(trace: &str, is_assertion: bool) -> String {
    let is_frame = |line: &&str| line.starts_with("\tat ") || line.starts_with("\t...");
    let is_rest = |line: &&str| line.starts_with("\tSuppressed: ");
    let lines = trace.lines().take_while(|line| !is_frame(line) && !is_rest(line));
    let mut text = lines.collect::<Vec<_>>().join("\n");
    let causes = trace.lines().filter(|line| line.starts_with("Caused by: "));
    for cause in causes {
        text.push('\n');
        text.push_str(cause);
    }
    match text.split_once(": ") {
        Some((class, message)) if is_assertion && !class.contains(char::is_whitespace) => {
            message.trim().to_owned()
        }
        _ => text.trim().to_owned(),
    }
}

/// The message of an assumption that did not hold.
pub(super) fn assumption(trace: &str) -> String {
    let text = message(trace, true);
    text.strip_prefix("Assumption failed: ").unwrap_or(&text).to_owned()
}

/// The innermost call in the test's own class, or in a class that is nested in it.
pub(super) fn location(trace: &str, class: &str, classes: &Path) -> Option<Location> {
    let class = outermost(class);
    let frame = trace.lines().filter_map(frame).find(|frame| outermost(frame.class) == class)?;
    let package = class.rsplit_once('.').map_or("", |(package, _)| package).replace('.', "/");
    let name = match package.is_empty() {
        true => frame.file.to_owned(),
        false => format!("{package}/{}", frame.file),
    };
    Some(Location { file: source(&name, classes), line: frame.line })
}

struct Frame<'a> {
    class: &'a str,
    file: &'a str,
    line: u32,
}

/// A line of a stack trace: `\tat example.ArmTest.moves(ArmTest.java:12)`, which can have a
/// class loader and a module: `\tat app//example.ArmTest…`.
fn frame(line: &str) -> Option<Frame<'_>> {
    let (call, place) = line.trim_start().strip_prefix("at ")?.rsplit_once('(')?;
    let (file, line) = place.strip_suffix(')')?.rsplit_once(':')?;
    let call = call.rsplit_once('/').map_or(call, |(_, call)| call);
    let (class, _) = call.rsplit_once('.')?;
    Some(Frame { class, file, line: line.parse().ok()? })
}

fn outermost(class: &str) -> &str {
    class.split_once('$').map_or(class, |(outer, _)| outer)
}

/// The file of a class, if it is where Maven and Gradle have it; otherwise its name.
fn source(name: &str, classes: &Path) -> String {
    for dir in classes.ancestors().skip(1).take(ANCESTORS) {
        for sources in SOURCE_DIRS {
            let file = dir.join(sources).join(name);
            if file.is_file() {
                return file.to_string_lossy().into_owned();
            }
        }
    }
    name.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRACE: &str = "org.opentest4j.AssertionFailedError: late ==> expected: <1\n> but was: <2>\n\tat org.junit.jupiter.api.Assertions.assertEquals(Assertions.java:601)\n\tat app//example.ArmTest$AtRest.moves the arm(ArmTest.kt:19)\n\tSuppressed: java.lang.Error: x\n";

    #[test]
    fn the_message_ends_before_the_first_frame() {
        assert_eq!(message(TRACE, true), "late ==> expected: <1\n> but was: <2>");
        let error = "java.lang.IllegalStateException: no speed\n\tat a.B.c(B.java:1)\nCaused by: java.lang.Error: seven\n\t... 3 more\n";
        let expected =
            "java.lang.IllegalStateException: no speed\nCaused by: java.lang.Error: seven";
        assert_eq!(message(error, false), expected);
    }

    #[test]
    fn the_location_is_in_the_class_of_the_test() {
        let location = location(TRACE, "example.ArmTest", Path::new("/no/such/classes"));
        let file = "example/ArmTest.kt".to_owned();
        assert_eq!(location, Some(Location { file, line: 19 }));
    }
}
