//! A suite of 10 000 tests: read, and planned without asking a host.

use std::error::Error;
use std::fmt::Write as _;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;

use jiff::civil::date;
use rtf_plan::plan::{self, InputPath, Options, RunnerEnvironment};

const TESTS: usize = 10_000;

/// Does it.
pub fn run(folder: &Path) -> Result<(), Box<dyn Error>> {
    let mut text = String::from("<suite name='counted' tags='all'>\n");
    for test in 0..TESTS {
        writeln!(
            text,
            "  <test name='test-{test:05}' param='--number {test}' tags='t{} quick' timeout='2s'>T.lua</test>",
            test % 10
        )?;
    }
    text += "</suite>\n";
    let (suite, host) = (folder.join("counted.xml"), folder.join("rtf-host-lua"));
    std::fs::write(&suite, text)?;
    std::fs::write(folder.join("T.lua"), "TestCase = {}\n")?;
    // Nothing is started: the planner only checks that it exists.
    std::fs::write(&host, "")?;
    std::fs::set_permissions(&host, std::fs::Permissions::from_mode(0o755))?;
    let surroundings = RunnerEnvironment {
        current_dir: folder.to_owned(),
        executable: folder.join("rtf"),
        variables: [("PATH".to_owned(), String::new())].into_iter().collect(),
    };
    let requests = [InputPath::Any(suite)];
    let outcome = plan::draft(&requests, &Options::new(surroundings, date(2026, 7, 1))).unchecked();
    match outcome.plan {
        Some(plan) if plan.tests as usize == TESTS => Ok(()),
        _ => Err(format!("no plan of {TESTS} tests: {:?}", outcome.diagnostics.first()).into()),
    }
}
