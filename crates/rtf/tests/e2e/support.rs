//! A temporary directory with suites and plug-ins, and the real runner in it.

use std::collections::BTreeSet;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use regex::Regex;
use rtf_model::{Event, EventKind, OrderChecker, Record};

/// The root of the checkout.
pub fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// A folder that is gone with the test.
pub struct Folder {
    temp: tempfile::TempDir,
}

/// What a command came to.
pub struct Finished {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Finished {
    pub fn of(output: std::process::Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

/// A journal, read.
pub struct Journal {
    pub events: Vec<Event>,
    pub record: Record,
}

impl Folder {
    pub fn new() -> Self {
        build_hosts();
        Self { temp: tempfile::tempdir().expect("a temporary folder") }
    }

    pub fn path(&self) -> &Path {
        self.temp.path()
    }

    pub fn file(&self, name: &str, text: &str) -> &Self {
        let path = self.path().join(name);
        std::fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
        std::fs::write(path, text).expect("a file");
        self
    }

    pub fn command(&self, args: &[&str]) -> Command {
        self.command_of(Path::new(env!("CARGO_BIN_EXE_rtf")), args)
    }

    /// A copy of `rtf` in this folder.
    pub fn command_of(&self, program: &Path, args: &[&str]) -> Command {
        let mut command = Command::new(program);
        command.args(args).current_dir(self.path()).stdin(Stdio::null());
        // Cargo sets the library path, in which plug-ins are searched.
        for variable in [
            "RTF_RESULTS",
            "RTF_HISTORY_URL",
            "RTF_PLUGIN_PATH",
            "RTF_PYTHON",
            "RTF_RUBY",
            "RTF_FORK",
            "RTF_PROFILE",
            "RTF_SSH",
            "PYTHONUNBUFFERED",
            "LD_LIBRARY_PATH",
            "GITHUB_ACTIONS",
            "GITHUB_WORKSPACE",
            "GITLAB_CI",
            "CI_PROJECT_DIR",
            // The width of help.
            "COLUMNS",
        ] {
            command.env_remove(variable);
        }
        command.env("NO_COLOR", "1");
        command
    }

    pub fn rtf(&self, args: &[&str]) -> Finished {
        Finished::of(self.command(args).output().expect("rtf runs"))
    }

    /// `rtf` under the predecessor's name.
    pub fn testrunner_command(&self, args: &[&str]) -> Command {
        let mut command = self.command(args);
        command.arg0("robottestingframework-testrunner");
        command
    }

    /// Runs `rtf` under the predecessor's name.
    pub fn testrunner(&self, args: &[&str]) -> Finished {
        Finished::of(self.testrunner_command(args).output().expect("rtf runs"))
    }

    /// The text of a file.
    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path().join(name)).expect("a file")
    }

    /// Starts `rtf` and lets it run.
    pub fn start(&self, args: &[&str]) -> Running {
        self.start_command(self.command(args))
    }

    /// Starts a command of this folder and lets it run.
    pub fn start_command(&self, mut command: Command) -> Running {
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        self.watch(command.spawn().expect("rtf starts"))
    }

    /// A runner that was started in this folder.
    pub fn watch(&self, child: Child) -> Running {
        Running { child, folder: self.path().to_owned() }
    }

    /// The newest journal, complete and in order.
    pub fn journal(&self) -> Journal {
        self.journal_in("rtf-results")
    }

    /// The newest journal in a folder of results.
    pub fn journal_in(&self, results: &str) -> Journal {
        let journal = read_journal(&self.path().join(results).join("latest/events.jsonl"));
        let mut order = OrderChecker::default();
        for event in &journal.events {
            order.check(event).expect("events in order");
        }
        order.finish().expect("a complete journal");
        journal
    }

    /// Exit code, output and errors for a snapshot, with what changes from run
    /// to run replaced.
    pub fn shown(&self, finished: &Finished) -> String {
        let text = format!(
            "exit code {}\n----- stdout\n{}----- stderr\n{}",
            finished.code.map_or("none".to_owned(), |code| code.to_string()),
            finished.stdout,
            finished.stderr
        );
        self.redact(&text)
    }

    /// The text without the paths of this machine.
    pub fn redact_paths(&self, text: &str) -> String {
        let canonical = self.path().canonicalize().expect("a path");
        let bins = Path::new(env!("CARGO_BIN_EXE_rtf")).parent().expect("a folder");
        let prefix = bins.parent().expect("a folder");
        let text = text
            .replace(&canonical.display().to_string(), "[FOLDER]")
            .replace(&self.path().display().to_string(), "[FOLDER]")
            .replace(&bins.display().to_string(), "[BIN]")
            .replace(&prefix.display().to_string(), "[PREFIX]");
        replace_path(&text, &root().canonicalize().expect("a path"), "[ROOT]")
    }

    /// The text without what changes from run to run.
    pub fn redact(&self, text: &str) -> String {
        let mut text = self.redact_paths(text);
        for (pattern, with) in [
            (r"\d{4}-\d\d-\d\dT\d\d-\d\d-\d\dZ-[0-9a-f]+", "[RUN]"),
            (r"\d+(\.\d+)? ?(ms|s)\b", "[TIME]"),
        ] {
            text = Regex::new(pattern).expect("a pattern").replace_all(&text, with).into_owned();
        }
        text
    }
}

/// Replaces a directory and the start of the paths in it. A short path, such as `/rtf`, can also
/// be a part of others, which stay.
fn replace_path(text: &str, path: &Path, with: &str) -> String {
    let is_name = |char: char| char.is_alphanumeric() || "_-.".contains(char);
    let path = path.display().to_string();
    let mut replaced = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once(&path) {
        replaced += before;
        let inside = replaced.ends_with(|char| is_name(char) || "/]".contains(char));
        let other_name = after.trim_start_matches('.').starts_with(is_name);
        replaced += if inside || other_name { &path } else { with };
        rest = after;
    }
    replaced + rest
}

#[test]
fn a_path_is_replaced_where_it_begins() {
    let replaced = |text| replace_path(text, Path::new("/rtf"), "[ROOT]");
    assert_eq!(replaced("`/rtf`: /rtf/rtf /rtf\n/rtf."), "`[ROOT]`: [ROOT]/rtf [ROOT]\n[ROOT].");
    let others = "[BIN]/rtf-host a/rtf.toml lib/rtf/plugins usr/bin/rtf /rtf-2 /rtf.toml";
    assert_eq!(replaced(others), others);
}

/// A runner that runs.
pub struct Running {
    pub child: Child,
    folder: PathBuf,
}

impl Running {
    /// Waits until the journal holds an event, which is returned.
    pub fn wait_for(&self, wanted: impl Fn(&EventKind) -> bool) -> Event {
        let path = self.folder.join("rtf-results/latest/events.jsonl");
        // The events that were looked at. The next run has another journal.
        let mut seen = String::new();
        wait_until("an event in the journal", || {
            let text = std::fs::read_to_string(&path).ok()?;
            let whole = &text[..=text.rfind('\n')?];
            let new = whole.strip_prefix(&*seen).unwrap_or(whole);
            let mut events =
                new.lines().map(|line| serde_json::from_str::<Event>(line).expect("an event"));
            let found = events.find(|event| wanted(&event.kind));
            seen = whole.to_owned();
            found
        })
    }

    /// The runner below the guard, which is the process that was started.
    pub fn runner(&self) -> i32 {
        let guard = self.child.id();
        wait_until("the runner", || {
            let children = format!("/proc/{guard}/task/{guard}/children");
            std::fs::read_to_string(children).ok()?.split_whitespace().next()?.parse().ok()
        })
    }

    /// Kills the runner with SIGKILL.
    pub fn kill_runner(&self) {
        assert!(self.try_kill_runner(), "the runner has ended before");
    }

    /// Kills the runner with SIGKILL; whether it was still there.
    pub fn try_kill_runner(&self) -> bool {
        let guard = self.child.id();
        let children = std::fs::read_to_string(format!("/proc/{guard}/task/{guard}/children"));
        let children = children.unwrap_or_default();
        children.split_whitespace().next().is_some_and(|runner| {
            let kill = Command::new("kill").args(["-KILL", runner]).stderr(Stdio::null()).status();
            kill.expect("kill").success()
        })
    }

    pub fn signal(&self, signal: &str) {
        send(self.child.id().cast_signed(), signal);
    }

    pub fn finish(self) -> Finished {
        Finished::of(self.child.wait_with_output().expect("rtf ends"))
    }
}

/// Waits until the next signal is another request to end the run: signals within
/// the documented window belong to the one before.
pub fn next_request() {
    std::thread::sleep(rtf_engine::guard::WINDOW + Duration::from_millis(100));
}

/// Sends a signal.
pub fn send(pid: i32, signal: &str) {
    let status = Command::new("kill").args(["-s", signal, &pid.to_string()]).status();
    assert!(status.expect("kill").success());
}

/// Kills a process with SIGKILL; whether it was there.
pub fn kill(pid: u32) -> bool {
    let mut kill = Command::new("kill");
    kill.args(["-KILL", &pid.to_string()]).stderr(Stdio::null());
    kill.status().expect("kill").success()
}

/// Random numbers that a seed repeats (SplitMix64).
pub struct Random(u64);

impl Random {
    /// The seed is `RTF_CHAOS_SEED`, or a new one; it is printed.
    pub fn from_environment() -> Self {
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        let new = now.map_or(0, |now| u64::from(now.subsec_nanos()));
        let seed = number("RTF_CHAOS_SEED").unwrap_or(new);
        println!("RTF_CHAOS_SEED={seed}");
        Self(seed)
    }

    pub fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (mixed ^ (mixed >> 31)) % limit
    }
}

/// A number in an environment variable.
pub fn number(variable: &str) -> Option<u64> {
    std::env::var(variable).ok().and_then(|value| value.parse().ok())
}

/// A port that nobody listens at.
pub fn free_port() -> u16 {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    listener.local_addr().expect("its address").port()
}

/// Asks until there is an answer; fails after a minute.
pub fn wait_until<T>(what: &str, mut ask: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(answer) = ask() {
            return answer;
        }
        assert!(start.elapsed() < Duration::from_secs(60), "waited for {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

pub fn read_journal(path: &Path) -> Journal {
    let text = std::fs::read_to_string(path).expect("a journal");
    let whole = text.rsplit_once('\n').map_or("", |(whole, _)| whole);
    let mut record = Record::default();
    let mut events = Vec::new();
    for line in whole.lines() {
        let event: Event = serde_json::from_str(line).expect("an event");
        record.apply(&event);
        events.push(event);
    }
    Journal { events, record }
}

/// Whether nothing of this folder runs any more. Every process of a run has
/// the folder's path in its working folder, command or environment.
pub fn nothing_left(folder: &Folder) -> bool {
    let path = folder.path().canonicalize().expect("a path");
    let entries = std::fs::read_dir("/proc").expect("/proc").flatten();
    entries
        .filter_map(|entry| std::fs::read_link(entry.path().join("cwd")).ok())
        .all(|cwd| !cwd.starts_with(&path))
}

/// The hosts are binaries of other packages: cargo builds them on demand.
fn build_hosts() {
    static BUILT: std::sync::Once = std::sync::Once::new();
    BUILT.call_once(|| {
        let bins = Path::new(env!("CARGO_BIN_EXE_rtf")).parent().expect("a folder");
        let release = bins.ends_with("release");
        let mut cargo = Command::new(env!("CARGO"));
        // With `-p`, libraries have other features than in a build of the workspace, and are compiled
        // a second time.
        cargo.args(["build", "--quiet", "--workspace"]);
        for host in ["native", "lua", "framework", "signals", "faults"] {
            cargo.args(["--bin", &format!("rtf-host-{host}")]);
        }
        cargo.args(release.then_some("--release")).current_dir(root());
        assert!(cargo.status().expect("cargo").success(), "the hosts build");
    });
}

/// Builds C++ plug-ins with the SDK's CMake package; returns the folder with
/// `<name>.so`.
pub fn build_cpp(sources: &Path, name: &str) -> PathBuf {
    build_cpp_with(sources, name, "")
}

/// The same with further compiler flags, for each of which there is a folder.
pub fn build_cpp_with(sources: &Path, name: &str, flags: &str) -> PathBuf {
    // What this program has built, one folder at a time.
    static BUILT: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = format!("{name}{}", flags.replace([' ', '=', ','], "-"));
    let build = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    if built.contains(&build) {
        return build;
    }
    let package =
        root().canonicalize().expect("a path").join("sdk/cpp/cmake/RobotTestingFramework");
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(sources).arg("-B").arg(&build).arg("-DCMAKE_BUILD_TYPE=Debug");
    configure.arg(format!("-DRobotTestingFramework_DIR={}", package.display()));
    configure.arg(format!("-DCMAKE_CXX_FLAGS={flags}"));
    run_quietly(&mut configure);
    run_quietly(Command::new("cmake").arg("--build").arg(&build).args(["--parallel", "2"]));
    built.insert(build.clone());
    build
}

/// Builds Ada plug-ins, one for each value of a project's variable; returns the
/// folder with `<value>/`.
pub fn build_ada(project: &Path, variable: &str, values: &[String]) -> PathBuf {
    // What this program has built, one plug-in at a time.
    static BUILT: Mutex<BTreeSet<(PathBuf, String)>> = Mutex::new(BTreeSet::new());
    let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    let name = project.file_stem().expect("a name").to_string_lossy();
    let build = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-ada"));
    let objects = |value: &str| build.join("obj").join(value);
    for value in values {
        let key = (build.clone(), value.clone());
        if built.contains(&key) {
            continue;
        }
        let first = built.range((build.clone(), String::new())..).next();
        if let Some((_, first)) = first.filter(|(of, _)| *of == build) {
            copy_sdk_objects(&objects(first), &objects(value));
        }
        let build = format!("-XBUILD={}", build.display());
        gprbuild(project, &[format!("-X{variable}={value}"), build]);
        built.insert(key);
    }
    build
}

/// Copies the objects of the Ada SDK from one plug-in to another of the same project, which is compiled
/// with the same switches. `gprbuild` compiles what does not match its sources.
fn copy_sdk_objects(from: &Path, to: &Path) {
    if to.exists() {
        return;
    }
    std::fs::create_dir_all(to).expect("a folder");
    for entry in from.read_dir().expect("a folder of objects").flatten() {
        if entry.file_name().to_string_lossy().starts_with("robottestingframework") {
            let copy = to.join(entry.file_name());
            let modified = entry.metadata().expect("a file").modified().expect("a time");
            std::fs::copy(entry.path(), &copy).expect("a copy");
            let copy = std::fs::File::options().write(true).open(copy).expect("the copy");
            copy.set_modified(modified).expect("a time");
        }
    }
}

/// What `gprconfig` finds out about the compiler, once and not in each `gprbuild`.
fn ada_compiler() -> &'static Path {
    static FOUND: OnceLock<PathBuf> = OnceLock::new();
    FOUND.get_or_init(|| {
        let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("ada.cgpr");
        run_quietly(Command::new("gprconfig").args(["--batch", "--config=ada", "-o"]).arg(&file));
        // The objects of a plug-in are listed one by one. Without this, each `nm` loads LLVM.
        let found = std::fs::read_to_string(&file).expect("a configuration");
        let lister = r#"("nm", "-g", "--plugin=/dev/null")"#;
        std::fs::write(&file, found.replace(r#"("nm", "-g")"#, lister)).expect("the same");
        file
    })
}

/// Builds an Ada project with the SDK's sources.
pub fn gprbuild(project: &Path, more: &[String]) {
    let sdk = root().canonicalize().expect("a path").join("sdk/ada");
    let mut gprbuild = Command::new("gprbuild");
    gprbuild.arg(format!("--config={}", ada_compiler().display()));
    gprbuild.args(["-p", "-q", "-j2", "-P"]).arg(project).args(more);
    run_quietly(gprbuild.env("GPR_PROJECT_PATH", &sdk));
}

fn run_quietly(command: &mut Command) {
    let output = command.output().expect("the tool is installed");
    let text = String::from_utf8_lossy(&output.stdout).into_owned()
        + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}\n{text}");
}
