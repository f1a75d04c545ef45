//! The text of an imported suite.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::{Component, Path, PathBuf};

/// How many names of tests a comment lists.
const NAMES_SHOWN: usize = 6;

/// A test of the suite.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ImportedTest {
    /// Its type.
    pub kind: &'static str,
    /// Its name; it gets a number if it is not unique.
    pub name: String,
    /// Its program, file or directory, absolute.
    pub subject: String,
    /// Its arguments.
    pub args: Vec<String>,
    /// The selected cases; empty: all.
    pub cases: Vec<String>,
    /// Its limit in seconds.
    pub timeout: Option<String>,
    /// The limit of each case in seconds.
    pub case_timeout: Option<String>,
    pub tags: Vec<String>,
    /// Its environment variables.
    pub env: Vec<(String, String)>,
    /// The tests of CTest that it replaces.
    pub ctest_names: Vec<String>,
    /// Further explanation.
    pub comment: Option<String>,
}

/// The suite, whose file is in `dir`.
pub fn text(name: &str, source: &str, tests: &[ImportedTest], dir: &Path) -> String {
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let _ = writeln!(text, "<!-- Written by `rtf import` from {}. -->", comment(source));
    let _ = writeln!(text, "<suite name=\"{}\">", attribute(name));
    let mut names: HashMap<&str, u32> = HashMap::new();
    for test in tests {
        let count = names.entry(&test.name).or_default();
        *count += 1;
        let name = match *count {
            1 => test.name.clone(),
            count => format!("{}-{count}", test.name),
        };
        push_test(&mut text, test, &name, dir);
    }
    text.push_str("</suite>\n");
    text
}

fn push_test(text: &mut String, test: &ImportedTest, name: &str, dir: &Path) {
    if let Some(note) = explanation(test) {
        let _ = writeln!(text, "\n  <!-- {} -->", comment(&note));
    }
    let _ = write!(text, "  <test type=\"{}\" name=\"{}\"", test.kind, attribute(name));
    let mut push = |name: &str, value: &str| {
        if !value.is_empty() {
            let _ = write!(text, " {name}=\"{}\"", attribute(value));
        }
    };
    push("param", &words(&test.args));
    push("cases", &words(&test.cases.iter().map(|case| pattern(case)).collect::<Vec<_>>()));
    let seconds =
        |limit: &Option<String>| limit.as_ref().map_or(String::new(), |it| format!("{it}s"));
    push("timeout", &seconds(&test.timeout));
    push("case-timeout", &seconds(&test.case_timeout));
    // Tags are separated by spaces and commas.
    let tags: Vec<String> = test.tags.iter().map(|tag| tag.replace([' ', ','], "-")).collect();
    push("tags", &tags.join(" "));
    let _ = write!(text, "> {}", element(&relative(Path::new(&test.subject), dir)));
    if test.env.is_empty() {
        text.push_str(" </test>\n");
        return;
    }
    text.push('\n');
    for (name, value) in &test.env {
        let (name, value) = (attribute(name), attribute(value));
        let _ = writeln!(text, "    <env name=\"{name}\" value=\"{value}\"/>");
    }
    text.push_str("  </test>\n");
}

fn explanation(test: &ImportedTest) -> Option<String> {
    let names = &test.ctest_names;
    let shown = names.iter().take(NAMES_SHOWN).cloned().collect::<Vec<_>>().join(", ");
    let dots = if names.len() > NAMES_SHOWN { ", …" } else { "" };
    let replaced = match (test.kind, names.len()) {
        (_, 0) => None,
        ("ctest", _) => {
            Some("Tests that only CTest can run, or whose framework is not known".to_owned())
        }
        (_, 1) => Some(format!("CTest: {shown}")),
        (_, count) => Some(format!("{count} tests of CTest: {shown}{dots}")),
    };
    match (replaced, &test.comment) {
        (Some(replaced), Some(comment)) => Some(format!("{replaced}. {comment}")),
        (replaced, comment) => replaced.or(comment.clone()),
    }
}

/// A path relative to `dir`, if both have a common directory below `/`.
fn relative(path: &Path, dir: &Path) -> String {
    let (ours, theirs): (Vec<Component<'_>>, Vec<Component<'_>>) =
        (dir.components().collect(), path.components().collect());
    let common = ours.iter().zip(&theirs).take_while(|(our, their)| our == their).count();
    if common < 2 {
        return path.to_string_lossy().into_owned();
    }
    let up = std::iter::repeat_n(Component::ParentDir, ours.len() - common);
    let relative: PathBuf = up.chain(theirs[common..].iter().copied()).collect();
    match relative.to_string_lossy().as_ref() {
        "" => ".".to_owned(),
        relative => relative.to_owned(),
    }
}

/// Arguments as `param` is written. It has no way to write a quote.
fn words(words: &[String]) -> String {
    let quoted = |word: &String| match word.is_empty() || word.contains([' ', '\t', '\n']) {
        true => format!("\"{word}\""),
        false => word.clone(),
    };
    words.iter().map(quoted).collect::<Vec<_>>().join(" ")
}

/// A pattern that matches a name. `?` stands for characters with a meaning.
fn pattern(name: &str) -> String {
    let name = name.replace('"', "?");
    match name.strip_prefix('!') {
        Some(rest) => format!("?{rest}"),
        None => name,
    }
}

fn element(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

fn attribute(text: &str) -> String {
    element(text).replace('"', "&quot;").replace('\n', "&#10;").replace('\t', "&#9;")
}

/// `--` is not allowed in comments.
fn comment(text: &str) -> String {
    let text = text.replace("--", "- -").replace('\n', " ");
    if text.ends_with('-') { format!("{text} ") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_suite() {
        let gtest = ImportedTest {
            kind: "gtest",
            name: "arm_test".to_owned(),
            subject: "/ws/build/arm/arm_test".to_owned(),
            args: vec!["--robot".to_owned(), "two words".to_owned()],
            timeout: Some("60".to_owned()),
            tags: vec!["slow".to_owned(), "motion planning".to_owned()],
            env: vec![("A".to_owned(), "<\"1\">".to_owned())],
            ctest_names: vec!["Arm.a".to_owned(), "Arm.b".to_owned()],
            ..ImportedTest::default()
        };
        let rest = ImportedTest {
            kind: "ctest",
            name: "arm_test".to_owned(),
            subject: "/ws/build/arm".to_owned(),
            cases: vec!["a b".to_owned(), "!x\"y".to_owned()],
            ctest_names: vec!["a b".to_owned()],
            ..ImportedTest::default()
        };
        insta::assert_snapshot!(text("arm", "/ws/build--x", &[gtest, rest], Path::new("/ws/suites")), @r#"
        <?xml version="1.0" encoding="UTF-8"?>
        <!-- Written by `rtf import` from /ws/build- -x. -->
        <suite name="arm">

          <!-- 2 tests of CTest: Arm.a, Arm.b -->
          <test type="gtest" name="arm_test" param="--robot &quot;two words&quot;" timeout="60s" tags="slow motion-planning"> ../build/arm/arm_test
            <env name="A" value="&lt;&quot;1&quot;&gt;"/>
          </test>

          <!-- Tests that only CTest can run, or whose framework is not known -->
          <test type="ctest" name="arm_test-2" cases="&quot;a b&quot; ?x?y"> ../build/arm </test>
        </suite>
        "#);
    }

    #[test]
    fn paths() {
        assert_eq!(relative(Path::new("/ws/build"), Path::new("/ws")), "build");
        assert_eq!(relative(Path::new("/ws"), Path::new("/ws")), ".");
        assert_eq!(relative(Path::new("/opt/x"), Path::new("/ws")), "/opt/x");
    }
}
