//! `rtf new`: writes a small project that runs at once.
//!
//! [`template`] has the files, [`name`] spells the project's name in each language.

mod name;
mod template;

use std::fs::File;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use name::ProjectName;
use rtf_report::escape;
use rtf_run::error::Failure;
use rtf_run::terminal;
use template::TemplateFile;

use super::VerbResult;
use crate::cli::NewArgs;

/// Writes a project.
pub fn run(args: &NewArgs) -> VerbResult {
    let name = ProjectName::parse(&args.name, args.kind).ok_or_else(|| {
        Failure::input(format!("`{}` cannot be the name of a project", escape::line(&args.name)))
            .hint("a name starts with a letter and contains letters, digits, `-` and `_`: `elbow`")
    })?;
    let dir = args.directory.clone().unwrap_or_else(|| PathBuf::from(&args.name));
    let files = template::files(args.language, args.kind, &name);
    refuse_existing(&dir, &files)?;
    for file in &files {
        write(&dir.join(&file.path), &file.text)?;
    }
    print(&dir, &files)?;
    Ok(ExitCode::SUCCESS)
}

/// Fails before anything is written.
fn refuse_existing(dir: &Path, files: &[TemplateFile]) -> Result<(), Failure> {
    let paths = files.iter().map(|file| dir.join(&file.path));
    // A broken link exists, too.
    let existing: Vec<_> = paths.filter(|path| path.symlink_metadata().is_ok()).collect();
    if existing.is_empty() {
        return Ok(());
    }
    let names = existing.iter().map(|path| format!("`{}`", path.display()));
    let names = names.collect::<Vec<_>>().join(", ");
    let (verb, them) = if existing.len() == 1 { ("exists", "it") } else { ("exist", "them") };
    let error = format!("{} {verb}, and `rtf new` does not overwrite {them}", escape::line(&names));
    Err(Failure::input(error).hint("`--directory DIR` writes the project to another directory"))
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    let dir = path.parent().unwrap_or(Path::new("."));
    let written = std::fs::create_dir_all(dir)
        .and_then(|()| File::create_new(path))
        .and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| cannot_write(path, &error))
}

fn cannot_write(path: &Path, error: &io::Error) -> Failure {
    let path = path.display().to_string();
    Failure::input(format!("`{}` cannot be written: {error}", escape::line(&path)))
}

/// Prints the files and the next commands.
fn print(dir: &Path, files: &[TemplateFile]) -> Result<(), Failure> {
    let readme = files.iter().find(|file| file.path == template::README);
    let commands = readme.map(|file| template::commands(&file.text)).unwrap_or_default();
    terminal::stdout(|out| {
        for file in files {
            let path = dir.join(&file.path).display().to_string();
            writeln!(out, "wrote {}", escape::line(&path))?;
        }
        writeln!(out, "\nnext:")?;
        if dir != Path::new(".") {
            writeln!(out, "  cd {}", shell_words::quote(&dir.to_string_lossy()))?;
        }
        for command in commands {
            writeln!(out, "  {command}")?;
        }
        Ok(())
    })
}
