//! What rtf itself uses.

use std::process::{Command, Stdio};

use rtf_engine::isolate;
use rtf_plan::plan::{HostPlan, LocatedHost, RunnerEnvironment, find_in_path, installed_hosts};
use rtf_process::cgroup::Cgroups;
use rtf_process::fork_server::ForkMode;
use rtf_process::spawner::Spawner;

use super::{Finding, Missing, Part};

/// What can be asked for.
pub const NAMES: [&str; 8] =
    ["dll", "lua", "python", "ruby", "stacks", "cgroups", "network", "ssh"];

/// Looks at what is asked for.
pub fn look(surroundings: &RunnerEnvironment, is_asked: &dyn Fn(&str) -> bool) -> Vec<Finding> {
    let hosts = installed_hosts(surroundings).into_iter();
    let mut found: Vec<Finding> = hosts
        .filter(|(name, _)| is_asked(name))
        .map(|(name, there)| of_host(name, there))
        .collect();
    let others = NAMES.into_iter().filter(|name| is_asked(name));
    found.extend(others.filter_map(|name| match name {
        "stacks" => Some(stacks(surroundings)),
        "cgroups" => Some(cgroups()),
        "network" => Some(network()),
        "ssh" => Some(ssh(surroundings)),
        _ => None,
    }));
    found
}

/// Whether Python plug-ins, as the fixture managers are, can run.
pub fn python(surroundings: &RunnerEnvironment) -> Result<HostPlan, String> {
    let mut hosts = installed_hosts(surroundings).into_iter();
    let python = hosts.find(|(name, _)| *name == "python");
    let there = python.map(|(_, there)| there).ok_or("rtf has no host for Python")?;
    started(there)
}

fn of_host(name: &str, there: LocatedHost) -> Finding {
    let (part, about, install) = match name {
        "dll" => (Part::Rtf, "plug-ins in C and C++", "it is installed together with rtf"),
        "lua" => (Part::Rtf, "plug-ins in Lua", "it is installed together with rtf"),
        "python" => (
            Part::Optional,
            "plug-ins in Python, all fixture managers of rtf",
            "Python 3.9 or later: `apt-get install python3`, or an active virtual environment; \
             RTF_PYTHON names another one",
        ),
        _ => (
            Part::Optional,
            "plug-ins in Ruby",
            "Ruby 2.7 or later: `apt-get install ruby`; RTF_RUBY names another one",
        ),
    };
    finding(name, part, about, started(there).map(|plan| described(&plan)), install)
}

/// The host if it starts: its check of no files does nothing else.
fn started(there: LocatedHost) -> Result<HostPlan, String> {
    let plan = there.map_err(|problem| problem.message)?;
    let (program, arguments) = plan.command.split_first().ok_or("it has no program")?;
    let mut command = Command::new(program);
    command.args(arguments).arg("--check").envs(plan.env.iter().cloned()).stdin(Stdio::null());
    let ended = command.output().map_err(|error| format!("`{program}` does not start: {error}"))?;
    if ended.status.success() {
        return Ok(plan);
    }
    let said = String::from_utf8_lossy(&ended.stderr);
    let last = said.lines().last().unwrap_or("it says nothing");
    Err(format!("`{program}` does not start: {}: {last}", ended.status))
}

/// Its program, with the version if it is the user's.
fn described(plan: &HostPlan) -> String {
    let program = plan.command.first().map(String::as_str).unwrap_or_default();
    if plan.command.len() == 1 {
        return program.to_owned();
    }
    let asked = Command::new(program).arg("--version").stdin(Stdio::null()).output();
    let answer = asked.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    match answer.as_deref().unwrap_or_default().lines().next() {
        Some(version) => format!("{program} ({version})"),
        None => program.to_owned(),
    }
}

fn stacks(surroundings: &RunnerEnvironment) -> Finding {
    let debuggers = ["gdb", "eu-stack"].iter();
    let found = debuggers.filter_map(|name| find_in_path(name, surroundings)).next();
    let found = found
        .map(|file| file.display().to_string())
        .ok_or_else(|| "there is no program `gdb` or `eu-stack` on PATH".to_owned());
    let about = "stack dumps of native code that hangs";
    let install = "`apt-get install gdb`, or `apt-get install elfutils`";
    finding("stacks", Part::Optional, about, found, install)
}

fn cgroups() -> Finding {
    let found = match Cgroups::create() {
        Some(_) => Ok("control groups of version 2 can be made".to_owned()),
        None => Err("control groups of version 2 cannot be made".to_owned()),
    };
    let about = "daemons that hide from their test are found at once";
    let install = "run as root, or in a delegated group: `systemd-run --user --scope -p \
                   Delegate=yes rtf …`; Linux 5.14 or later";
    finding("cgroups", Part::Optional, about, found, install)
}

fn network() -> Finding {
    let possible = || -> Result<(), String> {
        let mut builder = tokio::runtime::Builder::new_current_thread();
        let runtime = builder.enable_all().build().map_err(|error| error.to_string())?;
        runtime.block_on(async {
            let spawner = Spawner::start(ForkMode::Never).map_err(|error| error.to_string())?;
            isolate::check_network(&spawner).await
        })
    };
    let found = possible().map(|()| "network namespaces can be made".to_owned());
    let about = "suites with isolate=\"network\"";
    let install = "root, or `sysctl kernel.unprivileged_userns_clone=1 \
                   user.max_user_namespaces=10000`; in a container `--cap-add SYS_ADMIN`";
    finding("network", Part::Optional, about, found, install)
}

fn ssh(surroundings: &RunnerEnvironment) -> Finding {
    let found = find_in_path("ssh", surroundings)
        .map(|file| file.display().to_string())
        .ok_or_else(|| "there is no program `ssh` on PATH".to_owned());
    let install = "`apt-get install openssh-client`, or RTF_SSH names another program";
    finding("ssh", Part::Optional, "fixtures on other machines", found, install)
}

fn finding(
    name: &str,
    part: Part,
    about: &str,
    found: Result<String, String>,
    install: &str,
) -> Finding {
    let missing = |what: String| Missing { what, install: install.to_owned(), purpose: None };
    Finding {
        name: name.to_owned(),
        part,
        ok: found.is_ok(),
        about: about.to_owned(),
        missing: found.as_ref().err().cloned().map(missing).into_iter().collect(),
        found: found.into_iter().collect(),
    }
}
