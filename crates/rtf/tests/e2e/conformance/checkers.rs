//! The same scenarios with programs that find wrong uses of memory and threads: the sanitizers of GCC in
//! the plug-ins, and valgrind around the hosts. `tools/sanitizers.sh` installs them and runs these tests.

use std::fs::Permissions;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;

use super::{LANGUAGES, Language, check_with};
use crate::host_modes::{Mode, PROCESS, SHARED};
use crate::support::{Finished, Folder, root};

/// A program that observes a host.
struct Checker {
    name: &'static str,
    /// Compiler flags of C++ plug-ins.
    flags: &'static str,
    /// The lines of a shell script before the command of a host, which is `"$@"`. `REPORTS` is
    /// the start of the names of its reports.
    script: &'static str,
    /// The libraries that must be loaded first, `LIBRARIES` in the script.
    libraries: &'static [&'static str],
}

/// GCC's address and undefined behaviour sanitizers. Tests that use a null pointer on purpose must
/// crash as without.
const ADDRESS: Checker = Checker {
    name: "address",
    flags: "-fsanitize=address,undefined -fno-sanitize=null -fno-sanitize-recover=all -fno-omit-frame-pointer",
    script: "export LD_PRELOAD='LIBRARIES'
export ASAN_OPTIONS=handle_segv=0:handle_abort=0:detect_leaks=0:log_path=REPORTS
export UBSAN_OPTIONS=print_stacktrace=1:log_path=REPORTS
exec \"$@\"",
    // Without the second, it finds no function that throws an exception.
    libraries: &["libasan.so", "libstdc++.so.6"],
};

/// GCC's thread sanitizer. The host is not compiled with it, so what it sees of the host's locks is incomplete:
/// only the plug-ins are examined.
const THREAD: Checker = Checker {
    name: "thread",
    flags: "-fsanitize=thread",
    script: "export LD_PRELOAD='LIBRARIES'
export TSAN_OPTIONS=ignore_noninstrumented_modules=1:handle_segv=0:handle_abort=0:report_signal_unsafe=0:log_path=REPORTS
exec \"$@\"",
    libraries: &["libtsan.so", "libstdc++.so.6"],
};

/// Valgrind's memcheck around the host, without what it starts.
const MEMCHECK: Checker = Checker {
    name: "memcheck",
    flags: "",
    script: "exec valgrind --quiet --suppressions=SUPPRESSIONS --log-file=REPORTS.%p \"$@\"",
    libraries: &[],
};

/// What valgrind says about the end of a process that crashes.
const CRASH: &str = "Process terminating with default action of signal";

/// The tests that use a null pointer on purpose.
const ON_PURPOSE: &str = "{
  a test that crashes
  Memcheck:Addr4
  fun:*Crash*run*
}
";

#[test]
#[ignore = "for tools/sanitizers.sh"]
fn cpp_with_the_address_sanitizer() {
    check(&LANGUAGES[0], &ADDRESS, PROCESS);
}

#[test]
#[ignore = "for tools/sanitizers.sh"]
fn cpp_shared_with_the_address_sanitizer() {
    check(&LANGUAGES[0], &ADDRESS, SHARED);
}

#[test]
#[ignore = "for tools/sanitizers.sh"]
fn cpp_with_the_thread_sanitizer() {
    check(&LANGUAGES[0], &THREAD, PROCESS);
}

#[test]
#[ignore = "for tools/sanitizers.sh"]
fn cpp_with_valgrind() {
    check(&LANGUAGES[0], &MEMCHECK, PROCESS);
}

#[test]
#[ignore = "for tools/sanitizers.sh"]
fn lua_with_valgrind() {
    check(&LANGUAGES[1], &MEMCHECK, PROCESS);
}

#[test]
#[ignore = "for tools/sanitizers.sh"]
fn lua_shared_with_valgrind() {
    check(&LANGUAGES[1], &MEMCHECK, SHARED);
}

/// All scenarios have their usual results, and there is no report.
fn check(language: &Language, checker: &Checker, mode: Mode) {
    let temp = Folder::new();
    let reports = Folder::new();
    let rtf = checker.wrap_hosts(reports.path());
    let start = |temp: &Folder, args: &[&str]| {
        Finished::of(temp.command_of(&rtf, args).output().expect("rtf runs"))
    };
    check_with(language, mode, &temp, checker.flags, start);
    let found = checker.reports(reports.path());
    assert!(found.is_empty(), "{}", found.join("\n"));
}

impl Checker {
    /// Makes a copy of `rtf` whose hosts are scripts that start the real ones.
    fn wrap_hosts(&self, dir: &Path) -> PathBuf {
        let built = Path::new(env!("CARGO_BIN_EXE_rtf"));
        let bin = dir.join("bin");
        std::fs::create_dir(&bin).expect("a directory");
        // As in the source tree.
        let source = root().canonicalize().expect("a path");
        for shipped in ["fixtures", "sdk"] {
            symlink(source.join(shipped), dir.join(shipped)).expect("a link");
        }
        let suppressions = dir.join("suppressions");
        std::fs::write(&suppressions, ON_PURPOSE).expect("a file");
        let script = self
            .script
            .replace("LIBRARIES", &self.libraries.iter().map(|it| library(it)).collect::<String>())
            .replace("SUPPRESSIONS", &suppressions.to_string_lossy())
            .replace("REPORTS", &dir.join("report").to_string_lossy());
        for host in ["rtf-host-native", "rtf-host-lua"] {
            let real = built.with_file_name(host);
            let wrapper = bin.join(host);
            let text = format!("#!/bin/sh\nset -- {} \"$@\"\n{script}\n", real.display());
            std::fs::write(&wrapper, text).expect("a script");
            std::fs::set_permissions(&wrapper, Permissions::from_mode(0o755)).expect("a script");
        }
        for host in ["rtf-host-signals", "rtf-host-faults"] {
            symlink(built.with_file_name(host), bin.join(host)).expect("a link");
        }
        let rtf = bin.join("rtf");
        std::fs::copy(built, &rtf).expect("a copy of rtf");
        rtf
    }

    /// The reports about the hosts.
    fn reports(&self, dir: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(dir).expect("the directory").flatten();
        entries
            .filter(|entry| entry.file_name().to_string_lossy().starts_with("report"))
            .map(|entry| std::fs::read(entry.path()).expect("a report"))
            .map(|report| String::from_utf8_lossy(&report).into_owned())
            .filter(|report| is_about_an_error(report))
            .map(|report| format!("{}: {report}", self.name))
            .collect()
    }
}

/// Whether there is more than the end of a process.
fn is_about_an_error(report: &str) -> bool {
    let before = report.split_once(CRASH).map_or(report, |(before, _)| before);
    before.contains(|letter: char| letter.is_ascii_alphabetic())
}

/// The path of a library of the compiler, and a separator.
fn library(name: &str) -> String {
    let mut compiler = Command::new("c++");
    let printed = compiler.arg(format!("-print-file-name={name}")).output().expect("c++ runs");
    String::from_utf8(printed.stdout).expect("a path").trim().to_owned() + " "
}
