//! Builds test programs with cargo, and starts them as cargo does.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use serde::Deserialize;
use serde_json::Value;

use crate::framework::ListError;
use crate::listing;

/// The limit for a build, which may include all dependencies.
const BUILD_LIMIT: Duration = Duration::from_secs(3600);

/// The variables of a package, and its fields in `cargo metadata`.
const PACKAGE_VARIABLES: [(&str, &str); 9] = [
    ("CARGO_PKG_NAME", "name"),
    ("CARGO_PKG_VERSION", "version"),
    ("CARGO_PKG_DESCRIPTION", "description"),
    ("CARGO_PKG_HOMEPAGE", "homepage"),
    ("CARGO_PKG_REPOSITORY", "repository"),
    ("CARGO_PKG_LICENSE", "license"),
    ("CARGO_PKG_LICENSE_FILE", "license_file"),
    ("CARGO_PKG_RUST_VERSION", "rust_version"),
    ("CARGO_PKG_README", "readme"),
];

/// The test programs of a build.
#[derive(Debug, Default)]
pub(super) struct Build {
    pub binaries: Vec<TestBinary>,
    /// The compiler names files relative to this directory.
    pub workspace: PathBuf,
}

#[derive(Clone, Debug)]
pub(super) struct TestBinary {
    /// The target's name, with more if another target has it.
    pub name: String,
    program: PathBuf,
    dir: PathBuf,
    variables: BTreeMap<String, String>,
}

impl TestBinary {
    pub fn command(&self) -> Command {
        let mut command = Command::new(&self.program);
        command.current_dir(&self.dir).envs(&self.variables);
        for name in ["RUST_TEST_NOCAPTURE", "RUST_TEST_THREADS", "RUST_TEST_SHUFFLE"] {
            command.env_remove(name);
        }
        command
    }
}

/// A message of `cargo test --no-run`.
#[derive(Debug, Deserialize)]
#[serde(tag = "reason", rename_all = "kebab-case")]
enum Message {
    CompilerArtifact(Artifact),
    BuildScriptExecuted {
        package_id: String,
        out_dir: PathBuf,
        linked_paths: Vec<String>,
    },
    #[serde(other)]
    Other,
}

#[derive(Debug, Deserialize)]
struct Artifact {
    package_id: String,
    manifest_path: PathBuf,
    target: Target,
    profile: Profile,
    executable: Option<PathBuf>,
}

#[derive(Debug, Deserialize)]
struct Target {
    name: String,
    kind: Vec<String>,
}

#[derive(Debug, Deserialize)]
struct Profile {
    test: bool,
}

#[derive(Debug, Deserialize)]
struct Metadata {
    packages: Vec<Value>,
    workspace_root: PathBuf,
}

/// Builds the tests of the package in a directory.
pub(super) fn build(dir: &Path, args: &[String]) -> Result<Build, ListError> {
    if !dir.join("Cargo.toml").is_file() {
        let message = format!("`{}` contains no `Cargo.toml`", dir.display());
        return Err(ListError::new(message));
    }
    let mut command = cargo(dir);
    command.args(["test", "--no-run", "--message-format=json-render-diagnostics"]).args(args);
    let built = listing::run(command, BUILD_LIMIT)?;
    if !built.status.success() {
        let message = format!("`cargo test` cannot build the tests\n{}", built.quote());
        return Err(ListError::new(message));
    }
    let mut metadata = cargo(dir);
    metadata.args(["metadata", "--no-deps", "--offline", "--format-version=1"]);
    let listed = listing::run(metadata, BUILD_LIMIT)?;
    let metadata: Metadata = serde_json::from_slice(&listed.stdout).map_err(|error| {
        ListError::new(format!("`cargo metadata` failed: {error}\n{}", listed.quote()))
    })?;
    let lines = built.stdout.split(|byte| *byte == b'\n');
    let messages = lines.filter_map(|line| serde_json::from_slice(line).ok()).collect();
    Ok(binaries(messages, metadata))
}

fn cargo(dir: &Path) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    command.current_dir(dir);
    command
}

fn binaries(messages: Vec<Message>, metadata: Metadata) -> Build {
    let (mut tests, mut programs) = (Vec::new(), Vec::new());
    let mut scripts: HashMap<String, (PathBuf, Vec<String>)> = HashMap::new();
    for message in messages {
        match message {
            Message::CompilerArtifact(it) if it.executable.is_none() => {}
            Message::CompilerArtifact(it) if it.profile.test => tests.push(it),
            Message::CompilerArtifact(it) => programs.push(it),
            Message::BuildScriptExecuted { package_id, out_dir, linked_paths } => {
                scripts.insert(package_id, (out_dir, linked_paths));
            }
            Message::Other => {}
        }
    }
    // Cargo prints them in the order in which they are complete.
    let is_lib =
        |artifact: &Artifact| artifact.target.kind.iter().any(|kind| kind.ends_with("lib"));
    tests.sort_by_key(|it| (it.package_id.clone(), !is_lib(it), it.target.name.clone()));
    let libraries = library_path(&tests, &scripts);
    let mut used = HashSet::new();
    let binary = |artifact: Artifact| {
        let package = metadata.packages.iter().find(|it| it["id"] == *artifact.package_id);
        let mut variables = package_variables(package);
        let dir = artifact.manifest_path.parent().unwrap_or(Path::new("/")).to_owned();
        let mut set = |name: &str, value: &Path| {
            variables.insert(name.to_owned(), value.to_string_lossy().into_owned());
        };
        set("CARGO_MANIFEST_DIR", &dir);
        set("CARGO_MANIFEST_PATH", &artifact.manifest_path);
        set("LD_LIBRARY_PATH", Path::new(&libraries));
        if let Some((out_dir, _)) = scripts.get(&artifact.package_id) {
            set("OUT_DIR", out_dir);
        }
        let ours = programs.iter().filter(|it| it.package_id == artifact.package_id);
        for (program, file) in ours.filter_map(|it| Some((it, it.executable.as_ref()?))) {
            set(&format!("CARGO_BIN_EXE_{}", program.target.name), file);
        }
        let program = artifact.executable.clone().unwrap_or_default();
        TestBinary { name: unique_name(&artifact, package, &mut used), program, dir, variables }
    };
    let binaries = tests.into_iter().map(binary).collect();
    Build { binaries, workspace: metadata.workspace_root }
}

/// `arm`; the program `bin/arm` next to a library of that name; `package/test/reaches`.
fn unique_name(artifact: &Artifact, package: Option<&Value>, used: &mut HashSet<String>) -> String {
    let name = &artifact.target.name;
    let kind = artifact.target.kind.first().map_or("", String::as_str);
    let package = package.and_then(|it| it["name"].as_str()).unwrap_or_default();
    let names = [name.clone(), format!("{kind}/{name}"), format!("{package}/{kind}/{name}")];
    let unique = names.iter().find(|name| !used.contains(*name)).unwrap_or(&names[2]).clone();
    used.insert(unique.clone());
    unique
}

fn package_variables(package: Option<&Value>) -> BTreeMap<String, String> {
    let mut variables = BTreeMap::new();
    let Some(package) = package else { return variables };
    for (variable, field) in PACKAGE_VARIABLES {
        let value = package[field].as_str().unwrap_or_default();
        variables.insert(variable.to_owned(), value.to_owned());
    }
    let authors = package["authors"].as_array().into_iter().flatten();
    let authors: Vec<&str> = authors.filter_map(Value::as_str).collect();
    variables.insert("CARGO_PKG_AUTHORS".to_owned(), authors.join(":"));
    let version = package["version"].as_str().unwrap_or_default();
    let version = version.split('+').next().unwrap_or_default();
    let (numbers, pre) = version.split_once('-').unwrap_or((version, ""));
    let mut numbers = numbers.split('.');
    for part in ["MAJOR", "MINOR", "PATCH"] {
        let number = numbers.next().unwrap_or_default().to_owned();
        variables.insert(format!("CARGO_PKG_VERSION_{part}"), number);
    }
    variables.insert("CARGO_PKG_VERSION_PRE".to_owned(), pre.to_owned());
    variables
}

/// Where the programs find shared libraries: those of the build, of build scripts and of the
/// compiler, and then those of the user.
fn library_path(
    tests: &[Artifact],
    scripts: &HashMap<String, (PathBuf, Vec<String>)>,
) -> std::ffi::OsString {
    let linked = scripts.values().flat_map(|(_, paths)| paths);
    let mut paths: Vec<PathBuf> =
        linked.map(|path| path.split_once('=').map_or(&**path, |(_, path)| path).into()).collect();
    paths.sort();
    if let Some(deps) = tests.first().and_then(|it| it.executable.as_ref()?.parent()) {
        paths.push(deps.to_owned());
        paths.extend(deps.parent().map(Path::to_owned));
    }
    let mut rustc = Command::new(std::env::var_os("RUSTC").unwrap_or("rustc".into()));
    rustc.args(["--print", "target-libdir"]);
    if let Ok(listed) = listing::run(rustc, BUILD_LIMIT) {
        paths.push(String::from_utf8_lossy(listed.stdout.trim_ascii()).into_owned().into());
    }
    let users = std::env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    paths.extend(std::env::split_paths(&users).filter(|path| !path.as_os_str().is_empty()));
    std::env::join_paths(paths).unwrap_or(users)
}
