//! `rtf config show`: what holds for a suite, and where it comes from.

use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use rtf_plan::config::{
    self, ConfigFiles, ConfigRequest, ProfileView, RunConfig, Setting, SettingsQuery,
};
use rtf_plan::plan::RunnerEnvironment;
use rtf_plan::suite::{self, SourceText, SuiteSettings};

use super::{Outcome, planning};
use crate::cli::ConfigArgs;
use crate::error::Failure;
use crate::settings;

/// Comments begin in this column, where lines are short enough.
const COMMENT: usize = 44;

/// Prints.
pub fn show(args: &ConfigArgs) -> Outcome {
    let surroundings = RunnerEnvironment::from_current_process().map_err(Failure::own)?;
    let path: std::path::PathBuf =
        surroundings.current_dir.join(&args.input).components().collect();
    if !path.exists() {
        let what = format!("there is no file or folder `{}`", args.input.display());
        return Err(Failure::input(what));
    }
    let asked = settings::asked(&args.profile);
    let mut files = ConfigFiles::new(&surroundings.current_dir);
    let folder = config::input_dir(&path);
    let view = files.find_nearest(&folder).map(|file| ProfileView::new(file, &asked));
    let run = RunConfig::collect([folder.as_path()].into_iter(), &asked, &mut files);
    let mut problems = std::mem::take(&mut files.problems);
    problems.extend(asked.check_profile(&files));
    if !problems.is_empty() {
        return Err(planning::refused(&problems, &files.sources())?);
    }
    let suite = of_suite(&path, &args.input);
    let mut text = head(view.as_ref(), &asked);
    let question = SettingsQuery {
        view,
        suite: suite.as_ref().map(|(source, suite)| (source, suite)),
        run: &run.values,
        request: &asked,
        user: &surroundings.variables,
    };
    for shown in config::effective_settings(&question) {
        text += &line(&shown);
    }
    let mut out = anstream::stdout().lock();
    Failure::unless_reader_left(out.write_all(text.as_bytes()).and_then(|()| out.flush()))?;
    Ok(ExitCode::SUCCESS)
}

/// The suite's own values; its problems are `rtf check`'s.
fn of_suite(path: &Path, name: &Path) -> Option<(SourceText, SuiteSettings)> {
    if !path.is_file() || !suite::is_suite_file(path) {
        return None;
    }
    let source = suite::read_source(path, &name.to_string_lossy()).ok()?;
    let settings = suite::shared_settings(&source);
    Some((source, settings))
}

fn head(view: Option<&ProfileView>, asked: &ConfigRequest) -> String {
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
        text += &line(&Setting {
            key: "profile".to_owned(),
            values,
            origin: from,
            overridden: Vec::new(),
        });
    }
    text
}

fn line(shown: &Setting) -> String {
    let quoted = |text: &String| format!("\"{}\"", text.escape_debug());
    let value = match shown.key.as_str() {
        "reports" => {
            format!("[{}]", shown.values.iter().map(quoted).collect::<Vec<_>>().join(", "))
        }
        _ => shown.values.first().map(quoted).unwrap_or_default(),
    };
    let mut text = format!("{} = {value}", shown.key);
    let pad = COMMENT.saturating_sub(text.chars().count());
    let _ = write!(text, "{:pad$}  # {}", "", shown.origin);
    if !shown.overridden.is_empty() {
        let _ = write!(text, ", over {}", shown.overridden.join(", "));
    }
    text.push('\n');
    rtf_report::escape::block(&text).into_owned()
}
