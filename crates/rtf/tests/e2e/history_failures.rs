//! What can go wrong with the history: a server that is down, a directory that cannot be written,
//! an import that is killed, a full disk.

use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use insta::assert_snapshot;
use serde_json::Value;

use crate::history::{folder, rtf};
use crate::support::{Finished, Folder, Random, kill};

/// No server has the port 1.
#[test]
fn a_server_that_is_down_delays_no_run_and_its_password_is_nowhere() {
    let folder = folder();
    let url = "postgres://me:s3cret@127.0.0.1:1/team";
    folder.file("rtf.toml", &format!("[history]\nurl = \"{url}\"\n"));
    let started = Instant::now();
    let finished = rtf(&folder, &["run", "arm.xml"]);
    assert!(started.elapsed() < Duration::from_secs(30));
    assert_eq!(finished.code, Some(0), "{}", finished.stderr);
    assert_snapshot!(folder.redact(&finished.stderr), @"warning: the run was not imported into the history: cannot use the history `postgres://127.0.0.1:1/team`: error connecting to server: Connection refused (os error 111) (the next run imports it)");
    let mut texts = vec![finished.stdout, finished.stderr];
    let given = rtf(&folder, &["run", "arm.xml", "--history", url]);
    texts.extend([given.stdout, given.stderr]);
    let asked = rtf(&folder, &["history", "runs"]);
    assert_eq!(asked.code, Some(3), "{}", asked.stderr);
    texts.extend([asked.stdout, asked.stderr]);
    for args in [&["config", "show", "arm.xml"][..], &["run", "--help"], &["show"]] {
        let mut command = folder.command(args);
        let shown = command.env("RTF_HISTORY_URL", url).output().expect("rtf runs");
        texts.push(String::from_utf8_lossy(&[shown.stdout, shown.stderr].concat()).into_owned());
    }
    let journal = folder.read("rtf-results/latest/events.jsonl");
    assert!(journal.contains("postgres://me:***@127.0.0.1:1/team"), "{journal}");
    texts.push(journal);
    assert!(texts.iter().all(|text| !text.contains("s3cret")), "{texts:?}");
    // Nothing is lost.
    let imported = rtf(&folder, &["history", "import", "--history", "local.db"]);
    assert!(imported.stdout.starts_with("2 runs imported"), "{}", imported.stdout);
}

#[test]
fn a_read_only_directory_can_be_read_and_is_not_written() {
    let folder = folder();
    rtf(&folder, &["run", "arm.xml"]);
    let results = folder.path().join("rtf-results");
    let set_mode = |path: &std::path::Path, mode| {
        std::fs::set_permissions(path, PermissionsExt::from_mode(mode)).expect("permissions");
    };
    for name in ["history.db", "history.db-wal", "history.db-shm"] {
        let path = results.join(name);
        if path.exists() {
            set_mode(&path, 0o444);
        }
    }
    set_mode(&results, 0o555);
    // Root has no privileges without its capabilities.
    let rtf = |args: &[&str]| {
        let mut command = folder.command(args);
        command.env("RTF_LOCKS", folder.path().join("locks"));
        let drop_all = ["setpriv", "--inh-caps=-all", "--bounding-set=-all"];
        if rustix::process::getuid().is_root() {
            command = wrapped(&command, &drop_all);
        }
        Finished::of(command.output().expect("rtf runs"))
    };
    let runs = rtf(&["history", "runs", "--format", "json"]);
    let run = ["run", "arm.xml", "--results", "other", "--history", "rtf-results/history.db"];
    let imported = rtf(&run);
    let asked = rtf(&["history", "import", "other", "--history", "rtf-results/history.db"]);
    set_mode(&results, 0o755);
    assert_eq!(runs.code, Some(0), "{}", runs.stderr);
    let runs: Value = serde_json::from_str(&runs.stdout).expect("JSON");
    assert_eq!(runs["runs"].as_array().map(Vec::len), Some(1));
    assert_eq!(imported.code, Some(0), "{}", imported.stderr);
    assert!(
        imported.stderr.starts_with("warning: the run was not imported"),
        "{}",
        imported.stderr
    );
    assert_eq!(asked.code, Some(3), "{}", asked.stderr);
}

#[test]
fn an_import_that_is_killed_leaves_nothing_half() {
    let folder = folder();
    let tests = "<test>Moves.lua</test>".repeat(40);
    folder.file("many.xml", &format!("<suite name='many'>{tests}</suite>"));
    for _ in 0..6 {
        assert_eq!(rtf(&folder, &["run", "many.xml", "--no-history"]).code, Some(0));
    }
    let started = Instant::now();
    assert_eq!(import(&folder, "undisturbed.db").code, Some(0));
    let duration = u64::try_from(started.elapsed().as_micros()).expect("a short time");
    let undisturbed = exported(&folder, "undisturbed.db");
    let mut random = Random::from_environment();
    for moment in 0..34 {
        let file = format!("killed-{moment}.db");
        // The moments are spread from the start of the program to its end.
        for _ in 0..3 {
            let mut command = folder.command(&["history", "import", "--history", &file]);
            let mut child = command.stdout(Stdio::null()).spawn().expect("rtf starts");
            std::thread::sleep(Duration::from_micros(random.below(duration)));
            kill(child.id());
            child.wait().expect("an end");
        }
        assert_eq!(import(&folder, &file).code, Some(0));
        assert_eq!(exported(&folder, &file), undisturbed, "{file}");
    }
}

fn import(folder: &Folder, file: &str) -> Finished {
    rtf(folder, &["history", "import", "--history", file])
}

/// All rows of a history.
fn exported(folder: &Folder, file: &str) -> [String; 3] {
    ["runs", "results", "points"].map(|table| {
        let args = ["history", "export", "--format", "json", "--history", file, "--table", table];
        let exported = rtf(folder, &args);
        assert_eq!(exported.code, Some(0), "{}", exported.stderr);
        exported.stdout
    })
}

/// The limit of the size of files is what a full disk is: a write that fails.
#[test]
fn a_full_disk_leaves_nothing_half() {
    let folder = folder();
    let tests = "<test>Moves.lua</test>".repeat(40);
    folder.file("many.xml", &format!("<suite name='many'>{tests}</suite>"));
    for _ in 0..6 {
        assert_eq!(rtf(&folder, &["run", "many.xml", "--no-history"]).code, Some(0));
    }
    assert_eq!(import(&folder, "undisturbed.db").code, Some(0));
    let undisturbed = exported(&folder, "undisturbed.db");
    let mut codes = Vec::new();
    for kibibytes in [4, 40, 100, 200, 100_000] {
        let file = format!("full-{kibibytes}.db");
        // The signal is ignored, so that the write fails instead.
        let script = format!("trap '' XFSZ; ulimit -f {}; exec \"$0\" \"$@\"", kibibytes * 2);
        let command = folder.command(&["history", "import", "--history", &file]);
        let mut limited = wrapped(&command, &["sh", "-c", &script]);
        let finished = Finished::of(limited.output().expect("rtf runs"));
        assert!(!finished.stderr.contains("panicked"), "{}", finished.stderr);
        codes.push(finished.code);
        assert_eq!(import(&folder, &file).code, Some(0));
        assert_eq!(exported(&folder, &file), undisturbed, "{kibibytes} KiB");
    }
    assert_eq!((codes[0], codes[1], codes[4]), (Some(3), Some(3), Some(0)), "{codes:?}");
}

/// The same command as arguments of another one.
fn wrapped(command: &Command, wrapper: &[&str]) -> Command {
    let mut wrapped = Command::new(wrapper[0]);
    wrapped.args(&wrapper[1..]).arg(command.get_program()).args(command.get_args());
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => wrapped.env(name, value),
            None => wrapped.env_remove(name),
        };
    }
    if let Some(dir) = command.get_current_dir() {
        wrapped.current_dir(dir);
    }
    wrapped
}
