//! The templates, `crates/rtf/templates/new/<language>/<kind>`, with the files that the kinds or the
//! languages share in a directory `any`. Their project has the name `my_robot`, which this module
//! replaces.

use clap::ValueEnum;
use rust_embed::RustEmbed;

use super::name::ProjectName;
use crate::cli::{Language, ProjectKind};

/// The file whose first code block has the next commands.
pub const README: &str = "README.md";

/// The directory of what is shared.
const ANY: &str = "any";

#[derive(RustEmbed)]
#[folder = "templates/new"]
struct Templates;

/// A file of a new project.
#[derive(Debug)]
pub struct TemplateFile {
    /// The path in the project.
    pub path: String,
    pub text: String,
}

/// The files of a project, in the order of their paths.
pub fn files(language: Language, kind: ProjectKind, name: &ProjectName) -> Vec<TemplateFile> {
    let (language, kind) = (word(language), word(kind));
    let dirs = [(&*language, &*kind), (&*language, ANY), (ANY, &*kind)];
    let dirs = dirs.map(|(language, kind)| format!("{language}/{kind}/"));
    let files = Templates::iter().filter_map(|path| {
        let path_in_project = dirs.iter().find_map(|dir| path.strip_prefix(dir))?;
        let text = Templates::get(&path)?.data;
        let path = replace(path_in_project, name);
        Some(TemplateFile { path, text: replace(&String::from_utf8_lossy(&text), name) })
    });
    let mut files: Vec<_> = files.collect();
    files.sort_by(|a, b| a.path.cmp(&b.path));
    files
}

/// The lines of the first code block of a page.
pub fn commands(page: &str) -> Vec<&str> {
    let block = page.lines().skip_while(|line| !line.starts_with("```")).skip(1);
    block.take_while(|line| !line.starts_with("```")).collect()
}

/// Replaces the templates' name, in each spelling.
fn replace(text: &str, name: &ProjectName) -> String {
    let text = text.replace("MyRobot", &name.pascal).replace("my_robot", &name.snake);
    text.replace("My_Robot", &name.ada)
}

/// The word on the command line, which is also the directory's name.
fn word(value: impl ValueEnum) -> String {
    value.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
}
