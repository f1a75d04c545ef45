//! Checks the dependencies of rtf itself.

use std::process::{Command, Stdio};

use rtf_engine::isolate;
use rtf_plan::plan::{HostPlan, LocatedHost, RunnerEnvironment, find_in_path, installed_hosts};
use rtf_process::cgroup::Cgroups;
use rtf_process::fork_server::ForkMode;
use rtf_process::spawner::Spawner;

use super::{CheckResult, Component, Missing};

/// The names of the components.
pub const NAMES: [&str; 8] =
    ["dll", "lua", "python", "ruby", "stacks", "cgroups", "network", "ssh"];

/// Checks the selected components.
pub fn check(runner: &RunnerEnvironment, is_selected: &dyn Fn(&str) -> bool) -> Vec<CheckResult> {
    let hosts = installed_hosts(runner).into_iter();
    let hosts = hosts.filter(|(name, _)| is_selected(name));
    let mut findings: Vec<CheckResult> = hosts.map(|(name, host)| check_host(name, host)).collect();
    let others = NAMES.into_iter().filter(|name| is_selected(name));
    findings.extend(others.filter_map(|name| match name {
        "stacks" => Some(check_stacks(runner)),
        "cgroups" => Some(check_cgroups()),
        "network" => Some(check_network()),
        "ssh" => Some(check_ssh(runner)),
        _ => None,
    }));
    findings
}

/// Checks the host of Python plug-ins, and so of the fixture managers.
pub fn check_python(runner: &RunnerEnvironment) -> Result<HostPlan, String> {
    let mut hosts = installed_hosts(runner).into_iter();
    let python = hosts.find(|(name, _)| *name == "python");
    start_host(python.map(|(_, host)| host).ok_or("rtf has no host for Python")?)
}

fn check_host(name: &str, host: LocatedHost) -> CheckResult {
    let (part, about, install) = match name {
        "dll" => (Component::Rtf, "plug-ins in C and C++", "reinstall rtf"),
        "lua" => (Component::Rtf, "plug-ins in Lua", "reinstall rtf"),
        "python" => (
            Component::Optional,
            "plug-ins in Python, including all fixture managers of rtf",
            "install Python 3.9 or later (`apt-get install python3`), activate a virtual \
             environment, or set RTF_PYTHON to an interpreter",
        ),
        _ => (
            Component::Optional,
            "plug-ins in Ruby",
            "install Ruby 2.7 or later (`apt-get install ruby`), or set RTF_RUBY to an interpreter",
        ),
    };
    finding(name, part, about, start_host(host).map(|plan| describe(&plan)), install)
}

/// Starts a host, which checks no files and exits.
fn start_host(host: LocatedHost) -> Result<HostPlan, String> {
    let plan = host.map_err(|problem| problem.message)?;
    let (program, arguments) = plan.command.split_first().ok_or("the host has no program")?;
    let mut command = Command::new(program);
    command.args(arguments).arg("--check").envs(plan.env.iter().cloned()).stdin(Stdio::null());
    let output =
        command.output().map_err(|error| format!("`{program}` does not start: {error}"))?;
    if output.status.success() {
        return Ok(plan);
    }
    let stderr = String::from_utf8_lossy(&output.stderr);
    let last_line = stderr.lines().last().unwrap_or("no error message");
    Err(format!("`{program}` does not start: {}: {last_line}", output.status))
}

/// The host's program, or the interpreter and its version.
fn describe(plan: &HostPlan) -> String {
    let program = plan.command.first().map(String::as_str).unwrap_or_default();
    if plan.command.len() == 1 {
        return program.to_owned();
    }
    let output = Command::new(program).arg("--version").stdin(Stdio::null()).output();
    let output = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    match output.as_deref().unwrap_or_default().lines().next() {
        Some(version) => format!("{program} ({version})"),
        None => program.to_owned(),
    }
}

fn check_stacks(runner: &RunnerEnvironment) -> CheckResult {
    let debuggers = ["gdb", "eu-stack"].iter();
    let found = debuggers.filter_map(|name| find_in_path(name, runner)).next();
    let found = found
        .map(|file| file.display().to_string())
        .ok_or_else(|| "neither `gdb` nor `eu-stack` is on PATH".to_owned());
    let about = "stack dumps of hung native code";
    let install = "`apt-get install gdb` or `apt-get install elfutils`";
    finding("stacks", Component::Optional, about, found, install)
}

fn check_cgroups() -> CheckResult {
    let found = match Cgroups::create() {
        Some(_) => Ok("rtf can create control groups (version 2)".to_owned()),
        None => Err("rtf cannot create control groups (version 2)".to_owned()),
    };
    let about = "finding daemons that hide from their test";
    let install = "run as root or in a delegated group (`systemd-run --user --scope -p \
                   Delegate=yes rtf …`), on Linux 5.14 or later";
    finding("cgroups", Component::Optional, about, found, install)
}

fn check_network() -> CheckResult {
    let check = || -> Result<(), String> {
        let mut builder = tokio::runtime::Builder::new_current_thread();
        let runtime = builder.enable_all().build().map_err(|error| error.to_string())?;
        runtime.block_on(async {
            let spawner = Spawner::start(ForkMode::Never).map_err(|error| error.to_string())?;
            isolate::check_network(&spawner).await
        })
    };
    let found = check().map(|()| "rtf can create network namespaces".to_owned());
    let about = "suites with isolate=\"network\"";
    let install = "run as root, or `sysctl kernel.unprivileged_userns_clone=1 \
                   user.max_user_namespaces=10000`, on Ubuntu `sysctl \
                   kernel.apparmor_restrict_unprivileged_userns=0`, or in a container `--cap-add SYS_ADMIN`";
    finding("network", Component::Optional, about, found, install)
}

fn check_ssh(runner: &RunnerEnvironment) -> CheckResult {
    let found = find_in_path("ssh", runner)
        .map(|file| file.display().to_string())
        .ok_or_else(|| "`ssh` is not on PATH".to_owned());
    let install = "`apt-get install openssh-client`, or set RTF_SSH to another program";
    finding("ssh", Component::Optional, "fixtures on other machines", found, install)
}

fn finding(
    name: &str,
    part: Component,
    about: &str,
    found: Result<String, String>,
    install: &str,
) -> CheckResult {
    let missing = |what: String| Missing { what, install: install.to_owned(), purpose: None };
    CheckResult {
        name: name.to_owned(),
        part,
        ok: found.is_ok(),
        about: about.to_owned(),
        missing: found.as_ref().err().cloned().map(missing).into_iter().collect(),
        found: found.into_iter().collect(),
    }
}
