//! The text of a script → the modules that it imports. Text in comments and strings may count,
//! too; imports that are computed do not.

use std::path::{Path, PathBuf};

/// A language whose scripts name the modules that they import.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Language {
    Python,
    Lua,
    Ruby,
}

impl Language {
    /// The language of a script, by its name.
    pub fn of(file: &Path) -> Option<Self> {
        match file.extension()?.to_str()? {
            "py" => Some(Self::Python),
            "lua" => Some(Self::Lua),
            "rb" => Some(Self::Ruby),
            _ => None,
        }
    }

    /// The files that a module may be.
    pub fn files(self, module: &Path) -> Vec<PathBuf> {
        let with = |end: &str| {
            let mut file = module.as_os_str().to_owned();
            file.push(end);
            PathBuf::from(file)
        };
        match self {
            Self::Python => vec![with(".py")],
            Self::Lua => vec![with(".lua"), module.join("init.lua"), module.to_owned()],
            Self::Ruby => vec![with(".rb"), module.to_owned()],
        }
    }

    /// The variable with further directories.
    pub fn variable(self) -> Option<&'static str> {
        match self {
            Self::Python => Some("PYTHONPATH"),
            Self::Lua => None,
            Self::Ruby => Some("RUBYLIB"),
        }
    }
}

/// A module that a script names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Import {
    /// Its name, with `/` between its parts.
    pub name: String,
    /// The number of directories above that of the script in which it is; `None` if it is
    /// searched for.
    pub parents: Option<usize>,
}

/// The modules that a script names.
pub(super) fn find(text: &str, language: Language) -> Vec<Import> {
    match language {
        Language::Python => text.lines().flat_map(python).collect(),
        Language::Lua => quoted(text, &["require", "dofile", "loadfile"], '.'),
        Language::Ruby => quoted(text, &["require", "load"], '/'),
    }
}

fn python(line: &str) -> Vec<Import> {
    let line = line.trim_start();
    if let Some(rest) = line.strip_prefix("import ") {
        let names = rest.split(',').filter_map(|it| it.split_whitespace().next());
        return names.map(|name| absolute(name, '.')).collect();
    }
    let Some(rest) = line.strip_prefix("from ") else { return Vec::new() };
    let Some((module, names)) = rest.split_once(" import ") else { return Vec::new() };
    let name = module.trim().trim_start_matches('.');
    let dots = module.trim().len() - name.len();
    if dots == 0 {
        return vec![absolute(name, '.')];
    }
    let relative = |name: &str| Import { name: name.replace('.', "/"), parents: Some(dots - 1) };
    match name {
        "" => {
            let names = names.trim_start_matches('(').split(',');
            names.filter_map(|it| it.split_whitespace().next()).map(relative).collect()
        }
        _ => vec![relative(name)],
    }
}

fn absolute(name: &str, separator: char) -> Import {
    Import { name: name.replace(separator, "/"), parents: None }
}

/// Names in quotes after one of these words.
fn quoted(text: &str, words: &[&str], separator: char) -> Vec<Import> {
    let mut imports = Vec::new();
    for word in words {
        for (at, _) in text.match_indices(word) {
            let is_inside = text[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
            let rest = &text[at + word.len()..];
            let is_relative = rest.starts_with("_relative");
            let rest = rest.strip_prefix("_relative").unwrap_or(rest);
            let rest = rest.trim_start_matches([' ', '\t', '(']);
            let Some(quote) = rest.chars().next().filter(|c| matches!(c, '"' | '\'')) else {
                continue;
            };
            let Some((name, _)) = rest[1..].split_once(quote) else { continue };
            if is_inside || name.is_empty() || name.contains('\n') {
                continue;
            }
            // The name of a file keeps its dots.
            let is_file = name.ends_with(".lua") || name.ends_with(".rb");
            let import = absolute(name, if is_file { '/' } else { separator });
            imports.push(Import { parents: is_relative.then_some(0), ..import });
        }
    }
    imports
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str, language: Language) -> Vec<(String, Option<usize>)> {
        find(text, language).into_iter().map(|it| (it.name, it.parents)).collect()
    }

    fn name(name: &str, parents: Option<usize>) -> (String, Option<usize>) {
        (name.to_owned(), parents)
    }

    #[test]
    fn imports_of_python() {
        let text = "import a.b as x, c\n    from d.e import f\nfrom . import g as h, i\n\
                    from ..j import k\nfrom .l.m import (\n  n)\nimportant = 1\nfrom x\n";
        let expected = [
            name("a/b", None),
            name("c", None),
            name("d/e", None),
            name("g", Some(0)),
            name("i", Some(0)),
            name("j", Some(1)),
            name("l/m", Some(0)),
        ];
        assert_eq!(found(text, Language::Python), expected);
    }

    #[test]
    fn imports_of_lua_and_ruby() {
        let text =
            "local a = require 'b.c'\nrequire(\"d\")\nmy_require('e')\ndofile('f.lua')\nrequire(x)";
        let expected = [name("b/c", None), name("d", None), name("f.lua", None)];
        assert_eq!(found(text, Language::Lua), expected);
        let text = "require 'b/c'\nrequire_relative \"d\"\nload 'e.rb'\nrequire \"é";
        let expected = [name("b/c", None), name("d", Some(0)), name("e.rb", None)];
        assert_eq!(found(text, Language::Ruby), expected);
    }
}
