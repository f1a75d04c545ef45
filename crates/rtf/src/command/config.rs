//! `rtf config show`: prints the effective settings of a suite and their sources.

use std::fmt::Write as _;
use std::path::Path;
use std::process::ExitCode;

use rtf_plan::config::{
    self, ConfigFiles, ConfigRequest, ProfileView, RunConfig, Setting, SettingsQuery,
};
use rtf_plan::plan::RunnerEnvironment;
use rtf_plan::suite::{self, SharedSettings, SourceText};
use rtf_report::escape;
use rtf_run::error::Failure;
use rtf_run::{diagnostics, history, terminal};

use super::VerbResult;
use crate::cli::ConfigArgs;
use crate::request::config::{absolute, request};

const COMMENT_COLUMN: usize = 44;

/// Prints the effective settings.
pub fn show(args: &ConfigArgs) -> VerbResult {
    let runner = RunnerEnvironment::from_current_process().map_err(Failure::internal)?;
    let path = absolute(&runner.current_dir, &args.input);
    if !path.exists() {
        let error = format!("there is no file or directory `{}`", args.input.display());
        return Err(Failure::input(error));
    }
    let request = request(&args.profile);
    let mut files = ConfigFiles::new(&runner.current_dir);
    let dir = config::input_dir(&path);
    let view = files.find_nearest(&dir).map(|file| ProfileView::new(file, &request));
    let run = RunConfig::collect([dir.as_path()].into_iter(), &request, &mut files);
    let mut problems = std::mem::take(&mut files.problems);
    problems.extend(request.check_profile(&files));
    if !problems.is_empty() {
        return Err(diagnostics::refuse(&problems, &files.sources()));
    }
    let suite = read_suite(&path, &args.input);
    let mut text = header(view.as_ref(), &request);
    let query = SettingsQuery {
        view,
        suite: suite.as_ref().map(|(source, suite)| (source, suite)),
        run: &run.values,
        request: &request,
        user: &runner.variables,
    };
    text.extend(config::effective_settings(&query).iter().map(line));
    terminal::raw_stdout(|out| out.write_all(text.as_bytes()))?;
    Ok(ExitCode::SUCCESS)
}

/// The settings in a suite file, whose problems `rtf check` reports.
fn read_suite(path: &Path, name: &Path) -> Option<(SourceText, SharedSettings)> {
    if !path.is_file() || !suite::is_suite_file(path) {
        return None;
    }
    let source = suite::read_source(path, &name.to_string_lossy()).ok()?;
    let settings = suite::shared_settings(&source);
    Some((source, settings))
}

fn header(view: Option<&ProfileView>, request: &ConfigRequest) -> String {
    let Some(view) = view else { return "# no rtf.toml\n".to_owned() };
    let mut text = format!("# {}\n", escape::line(view.file.source.name()));
    if let Some((profile, _)) = &view.profile {
        let origin = match &view.file.profile {
            Some(name) if request.profile.is_none() => {
                let label = view.file.source.label(name.span, "");
                format!("{}:{}", label.file, label.line)
            }
            _ => "--profile or RTF_PROFILE".to_owned(),
        };
        let (key, values) = ("profile".to_owned(), vec![profile.clone()]);
        text += &line(&Setting { key, values, origin, overridden: Vec::new() });
    }
    text
}

fn line(setting: &Setting) -> String {
    let quote = |text: &String| format!("\"{}\"", history::without_password(text).escape_debug());
    let value = match setting.key.as_str() {
        "reports" => {
            format!("[{}]", setting.values.iter().map(quote).collect::<Vec<_>>().join(", "))
        }
        _ => setting.values.first().map(quote).unwrap_or_default(),
    };
    let mut text = format!("{} = {value}", setting.key);
    let padding = COMMENT_COLUMN.saturating_sub(text.chars().count());
    let _ = write!(text, "{:padding$}  # {}", "", setting.origin);
    if !setting.overridden.is_empty() {
        let _ = write!(text, ", over {}", setting.overridden.join(", "));
    }
    text.push('\n');
    escape::block(&text).into_owned()
}
