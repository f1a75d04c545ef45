//! The documentation covers all variables, options, exit codes, elements and attributes of the
//! code, and its links are valid.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use regex::Regex;

use crate::support::{Folder, root};

fn read(file: &str) -> String {
    std::fs::read_to_string(root().join(file)).expect(file)
}

fn pattern(pattern: &str) -> Regex {
    Regex::new(pattern).expect("a pattern")
}

fn found(pattern: &str, text: &str) -> BTreeSet<String> {
    found_by(&self::pattern(pattern), text)
}

fn found_by(pattern: &Regex, text: &str) -> BTreeSet<String> {
    pattern.captures_iter(text).map(|captures| captures[1].to_owned()).collect()
}

/// The files below a folder of the project whose names end so; tests, hidden
/// folders and what was built or installed are left out.
fn files(folder: &Path, endings: &[&str], to: &mut Vec<PathBuf>) {
    const LEFT_OUT: [&str; 7] =
        ["build", "examples", "node_modules", "target", "test", "tests", "tests.rs"];
    for entry in folder.read_dir().expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        if name.starts_with('.') || LEFT_OUT.contains(&name) {
            continue;
        }
        if path.is_dir() {
            files(&path, endings, to);
        } else if path
            .extension()
            .is_some_and(|ending| endings.iter().any(|known| ending == *known))
        {
            to.push(path);
        }
    }
}

fn below(folder: &str, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    files(&root().join(folder), endings, &mut found);
    found.sort();
    assert!(!found.is_empty(), "{folder}");
    found
}

/// The user's guide and the specifications, in one piece.
fn documents() -> String {
    let pages = [below("docs", &["md"]), below("spec", &["md"])].concat();
    let texts = pages.iter().map(|page| std::fs::read_to_string(page).expect("a page"));
    texts.chain([read("README.md")]).collect::<Vec<_>>().join("\n")
}

#[test]
fn every_environment_variable() {
    let code = ["rs", "py", "rb", "lua", "h", "hpp", "adb", "sh"];
    // The names of ports, parameters and values are parts of the names of their variables.
    let formats = [
        (pattern(r#""(RTF_[A-Z]+_)\{\w*\}""#), "NAME"),
        (pattern(r#""(RTF_[A-Z]+_)\{\w*\}_\{\w*\}""#), "NAME_VALUE"),
    ];
    let quoted = pattern(r#"["'=](RTF_[A-Z_]+)["'=]"#);
    let mut used = BTreeSet::new();
    for file in ["crates", "sdk", "fixtures"].iter().flat_map(|folder| below(folder, &code)) {
        // No user runs it.
        if file.components().any(|part| part.as_os_str() == "rtf-fuzz") {
            continue;
        }
        let text = std::fs::read_to_string(&file).expect("a file");
        let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
        used.extend(found_by(&quoted, text));
        for (format, names) in &formats {
            used.extend(found_by(format, text).iter().map(|start| format!("{start}{names}")));
        }
    }
    // The beginnings of such names.
    used.retain(|name| !name.ends_with('_'));
    let page = read("spec/environment.md");
    let rows: Vec<_> = page.lines().filter_map(|line| line.strip_prefix("| ")).collect();
    let named = rows.iter().filter_map(|row| row.split('|').next()).collect::<String>();
    assert_eq!(used, found(r"`(RTF_[A-Z_]+)`", &named));
}

#[test]
fn every_option() {
    let folder = Folder::new();
    let help = |verb: &str| {
        let words: Vec<_> = verb.split_whitespace().chain(["--help"]).collect();
        folder.rtf(&words).stdout
    };
    let mut verbs = found(r"(?m)^  ([a-z-]+)  ", &help(""));
    verbs.extend(
        ["config show", "campaign run", "campaign show", "campaign compare", "campaign plan"]
            .map(str::to_owned),
    );
    let questions = found(r"(?m)^  ([a-z-]+)  ", &help("history"));
    verbs.extend(questions.iter().map(|question| format!("history {question}")));
    verbs.remove("history help");
    assert!(verbs.len() > 10, "{verbs:?}");
    let documents = documents();
    for verb in verbs {
        for option in found(r"(?m)^ +(?:-\w, )?(--[a-z-]+)", &help(&verb)) {
            let mentioned = Regex::new(&format!("{option}([^a-z-]|$)")).expect("a pattern");
            assert!(mentioned.is_match(&documents), "no document has `{option}` of `rtf {verb}`");
        }
    }
}

#[test]
fn every_exit_code() {
    let code = Regex::new(r"pub const (\w+): u8 = (\d+);").expect("a pattern");
    let spec = read("spec/exit-codes.md");
    let constants = read("crates/rtf-model/src/exit_code.rs");
    let help = Folder::new().rtf(&["--help"]).stdout;
    let known: Vec<_> = code.captures_iter(&constants).collect();
    assert_eq!(known.len(), 7);
    for constant in known {
        let (name, number) = (&constant[1], &constant[2]);
        assert!(spec.contains(&format!("| {number} | `{name}` |")), "{name} in the specification");
        assert!(help.contains(&format!("\n  {number}  ")), "{number} in the help");
    }
}

#[test]
fn every_element_and_attribute() {
    let spec = read("spec/suite.md");
    let names = found(r#"<xs:(?:attribute|element) name="([^"]+)""#, &read("spec/suite.xsd"));
    assert!(names.len() > 40, "{names:?}");
    for name in names {
        let forms = [format!("`{name}`"), format!("`<{name}"), format!("`{name}=")];
        assert!(forms.iter().any(|form| spec.contains(form)), "spec/suite.md has no `{name}`");
    }
}

/// The anchors that a page's headings make.
fn anchors(page: &str) -> BTreeSet<String> {
    let heading = |line: &str| {
        let kept = |c: &char| c.is_alphanumeric() || " -_".contains(*c);
        line.to_lowercase().chars().filter(kept).collect::<String>().replace(' ', "-")
    };
    found(r"(?m)^#+ (.+)$", page).iter().map(|line| heading(line)).collect()
}

#[test]
fn every_link() {
    let mut broken = Vec::new();
    for page in below("", &["md"]) {
        let text = std::fs::read_to_string(&page).expect("a page");
        for link in found(r"\]\(([^)\s]+)\)", &text) {
            if link.contains("://") {
                continue;
            }
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let beside = page.parent().expect("a folder");
            let target = if file.is_empty() { page.clone() } else { beside.join(file) };
            let is_there = match std::fs::read_to_string(&target) {
                Ok(text) if !anchor.is_empty() => anchors(&text).contains(anchor),
                _ => target.exists(),
            };
            if !is_there {
                broken.push(format!("{}: {link}", page.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{broken:#?}");
}
