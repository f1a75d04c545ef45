//! `rtf config show`: what holds for a suite, and where it comes from.

use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use rtf_engine::config::{self, Asked, Files, OfSuite, Question, Run, Shown, View};
use rtf_engine::plan::Surroundings;
use rtf_engine::suite::{self, Source};

use super::{Outcome, planning};
use crate::cli::ConfigArgs;
use crate::error::Failure;
use crate::settings;

/// Comments begin in this column, where lines are short enough.
const COMMENT: usize = 44;

/// Prints.
pub fn show(args: &ConfigArgs) -> Outcome {
    let surroundings = Surroundings::of_process().map_err(Failure::own)?;
    let path: std::path::PathBuf =
        surroundings.current_folder.join(&args.input).components().collect();
    if !path.exists() {
        let what = format!("there is no file or folder `{}`", args.input.display());
        return Err(Failure::input(what));
    }
    let asked = settings::asked(&args.profile);
    let mut files = Files::new(&surroundings.current_folder);
    let folder = config::folder_of_input(&path);
    let view = files.above(&folder).map(|file| View::of(file, &asked));
    let run = Run::of([folder.as_path()].into_iter(), &asked, &mut files);
    let mut problems = std::mem::take(&mut files.problems);
    problems.extend(asked.check_profile(&files));
    if !problems.is_empty() {
        return Err(planning::refused(&problems, &files.sources())?);
    }
    let suite = of_suite(&path, &args.input);
    let mut text = head(view.as_ref(), &asked);
    let question = Question {
        view,
        suite: suite.as_ref().map(|(source, suite)| (source, suite)),
        run: &run.values,
        asked: &asked,
        user: &surroundings.variables,
    };
    for shown in config::show(&question) {
        text += &line(&shown);
    }
    let mut out = anstream::stdout().lock();
    Failure::unless_reader_left(out.write_all(text.as_bytes()).and_then(|()| out.flush()))?;
    Ok(ExitCode::SUCCESS)
}

/// The suite's own values; its problems are `rtf check`'s.
fn of_suite(path: &Path, name: &Path) -> Option<(Source, OfSuite)> {
    if !path.is_file() || !suite::is_suite_file(path) {
        return None;
    }
    let source = suite::open(path, &name.to_string_lossy()).ok()?;
    let values = suite::places(&source);
    Some((source, OfSuite { values }))
}

fn head(view: Option<&View>, asked: &Asked) -> String {
    let Some(view) = view else { return "# no rtf.toml\n".to_owned() };
    let mut text = format!("# {}\n", rtf_report::escape::line(view.file.source.name()));
    if let Some((profile, _)) = &view.profile {
        let from = match &view.file.profile {
            Some(name) if asked.profile.is_none() => {
                let label = view.file.source.label(name.span, "");
                format!("{}:{}", label.file, label.line)
            }
            _ => "--profile or RTF_PROFILE".to_owned(),
        };
        let values = vec![profile.clone()];
        text += &line(&Shown { key: "profile".to_owned(), values, from, over: Vec::new() });
    }
    text
}

fn line(shown: &Shown) -> String {
    let quoted = |text: &String| format!("\"{}\"", text.escape_debug());
    let value = match shown.key.as_str() {
        "reports" => {
            format!("[{}]", shown.values.iter().map(quoted).collect::<Vec<_>>().join(", "))
        }
        _ => shown.values.first().map(quoted).unwrap_or_default(),
    };
    let mut text = format!("{} = {value}", shown.key);
    let pad = COMMENT.saturating_sub(text.chars().count());
    let _ = write!(text, "{:pad$}  # {}", "", shown.from);
    if !shown.over.is_empty() {
        let _ = write!(text, ", over {}", shown.over.join(", "));
    }
    text.push('\n');
    rtf_report::escape::block(&text).into_owned()
}
