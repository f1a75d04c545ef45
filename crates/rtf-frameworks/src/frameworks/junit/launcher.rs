//! Finds a Java virtual machine and the console launcher of the JUnit platform.

use std::path::{Path, PathBuf};

/// The name of the launcher's JAR, before its version.
const NAME: &str = "junit-platform-console-standalone";

/// The first version that reports to a socket.
const MINIMUM: [u32; 2] = [6, 1];

/// The command that starts a virtual machine.
pub(super) fn java() -> Result<PathBuf, String> {
    let home = std::env::var_os("JAVA_HOME").map(|home| Path::new(&home).join("bin/java"));
    if let Some(java) = home.filter(|java| java.exists()) {
        return Ok(java);
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&path).map(|dir| dir.join("java")).find(|java| java.exists());
    found.ok_or_else(|| {
        "no Java virtual machine is installed: neither `JAVA_HOME` nor `PATH` has `java`\nDebian's package is `default-jre-headless`".to_owned()
    })
}

/// The launcher: `RTF_JUNIT`, or the latest one that Maven, Gradle or Debian installed.
pub(super) fn find() -> Result<PathBuf, String> {
    if let Some(file) = std::env::var_os("RTF_JUNIT").filter(|file| !file.is_empty()) {
        let file = PathBuf::from(file);
        return match file.is_file() {
            true => Ok(file),
            false => Err(format!("`RTF_JUNIT` is `{}`, which is no file", file.display())),
        };
    }
    let found = candidates().into_iter().filter_map(|file| Some((version(&file)?, file)));
    let latest = found.max_by(|(one, _), (other, _)| one.cmp(other));
    let install = format!(
        "`mvn dependency:get -Dartifact=org.junit.platform:{NAME}:6.1.0` installs one; `RTF_JUNIT` can name its JAR"
    );
    match latest {
        Some((version, file)) if version[..] >= MINIMUM[..] => Ok(file),
        Some((_, file)) => {
            let file = file.display();
            Err(format!("`{file}` is too old: version 6.1 or later is needed\n{install}"))
        }
        None => Err(format!("no console launcher of JUnit is installed\n{install}")),
    }
}

/// All installed launchers.
fn candidates() -> Vec<PathBuf> {
    let mut dirs = vec![PathBuf::from("/usr/share/java")];
    if let Some(home) = std::env::var_os("HOME").map(PathBuf::from) {
        let maven = home.join(".m2/repository/org/junit/platform").join(NAME);
        dirs.extend(subdirs(&maven));
        let gradle = std::env::var_os("GRADLE_USER_HOME").map(PathBuf::from);
        let gradle = gradle.unwrap_or_else(|| home.join(".gradle"));
        let gradle = gradle.join("caches/modules-2/files-2.1/org.junit.platform").join(NAME);
        // A directory per version, and in it one per file, named by its hash.
        dirs.extend(subdirs(&gradle).iter().flat_map(|version| subdirs(version)));
    }
    dirs.iter().flat_map(|dir| entries(dir)).filter(|file| version(file).is_some()).collect()
}

fn entries(dir: &Path) -> Vec<PathBuf> {
    std::fs::read_dir(dir).into_iter().flatten().flatten().map(|entry| entry.path()).collect()
}

fn subdirs(dir: &Path) -> Vec<PathBuf> {
    entries(dir).into_iter().filter(|path| path.is_dir()).collect()
}

/// The version in the name of the JAR; `None` if it is another file.
fn version(file: &Path) -> Option<Vec<u32>> {
    let name = file.file_name()?.to_str()?;
    let version = name.strip_prefix(NAME)?.strip_prefix('-')?.strip_suffix(".jar")?;
    version.split(['.', '-']).map(|part| part.parse().ok()).collect()
}
