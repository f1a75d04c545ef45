//! Runs with equal sources are comparable, committed or not: `rtf history flaky`.

use insta::assert_snapshot;

use crate::history::{json, rtf, shown};
use crate::support::Folder;

/// A test whose result depends on a file that is not one of its sources.
const DEPENDS: &str = "TestCase = {}\nlocal arm = require('arm_lib')\nfunction TestCase.run()\n  \
     rtf.check(io.open('broken') == nil, arm.name .. ' holds')\nend\n";

/// A directory without a repository, whose test imports a module.
fn depending() -> Folder {
    let folder = Folder::new();
    folder.file("Moves.lua", DEPENDS);
    folder.file("arm_lib.lua", "return { name = 'left' }\n");
    folder.file("arm.xml", "<suite name=\"arm\"><test tags=\"smoke\">Moves.lua</test></suite>\n");
    folder
}

/// Runs the suite; the test passes, fails and passes.
fn run_flaky(folder: &Folder, command: &[&str]) {
    for broken in [false, true, false] {
        if broken {
            folder.file("broken", "");
        } else {
            drop(std::fs::remove_file(folder.path().join("broken")));
        }
        assert_eq!(rtf(folder, command).code, Some(i32::from(broken)));
    }
}

#[test]
fn a_test_that_changes_without_a_repository_is_flaky() {
    let folder = depending();
    run_flaky(&folder, &["run", "arm.xml"]);
    assert_snapshot!(shown(&folder, &["flaky"]), @"
    exit code 0
    ----- stdout
    arm/Moves
      2 flips in 2 pairs of comparable results with equal sources: 100 % (34 % … 100 %)
      2 passed, 1 failed
      last problem  [START]  failed: left holds  ([RUN])
    compared if the sources of a test are equal (suite, plug-ins, their modules), without a commit or with uncommitted changes: 3 runs
    ----- stderr
    ");
    let flaky = json(&folder, &["flaky"]);
    let test = &flaky["tests"][0];
    assert_eq!((&test["flips"], &test["pairs"]), (&2.into(), &2.into()));
    assert_eq!(test["pairs_by_sources"], 2);
    let exported = rtf(&folder, &["history", "export", "--format", "json"]);
    assert!(exported.stdout.contains("source_hash"), "{}", exported.stdout);
}

#[test]
fn a_test_whose_module_was_changed_is_not_flaky() {
    for (file, text) in [
        ("Moves.lua", format!("{DEPENDS}-- other\n")),
        ("arm_lib.lua", "return { name = 'right' }\n".to_owned()),
        ("arm.xml", "<suite name=\"arm\"><test>Moves.lua</test><!-- --></suite>\n".to_owned()),
    ] {
        let folder = depending();
        rtf(&folder, &["run", "arm.xml"]);
        folder.file(file, &text);
        folder.file("broken", "");
        assert_eq!(rtf(&folder, &["run", "arm.xml"]).code, Some(1));
        let flaky = json(&folder, &["flaky"]);
        assert_eq!(flaky["tests"], serde_json::json!([]), "{file}");
    }
}

#[test]
fn a_python_test_is_flaky_unless_a_module_was_changed() {
    let folder = Folder::new();
    folder.file("lib/arm/__init__.py", "");
    folder.file("lib/arm/reach.py", "from .units import FAR\n");
    folder.file("lib/arm/units.py", "FAR = 2\n");
    folder.file(
        "Moves.py",
        "import os\nimport sys\nimport rtf\nfrom arm.reach import FAR\n\n\n\
         class Moves(rtf.TestCase):\n    def run(self):\n        \
         self.check(not os.path.exists('broken'), 'holds')\n",
    );
    folder.file(
        "arm.xml",
        "<suite name='arm'><env name='PYTHONPATH' value='lib'/>\
         <test type='python'>Moves</test></suite>\n",
    );
    run_flaky(&folder, &["run", "arm.xml"]);
    assert_eq!(json(&folder, &["flaky"])["tests"][0]["flips"], 2);
    folder.file("lib/arm/units.py", "FAR = 3\n");
    folder.file("broken", "");
    assert_eq!(rtf(&folder, &["run", "arm.xml"]).code, Some(1));
    assert_eq!(json(&folder, &["flaky"])["tests"][0]["flips"], 2, "another FAR");
}

#[test]
fn a_test_that_changes_with_uncommitted_changes_is_flaky() {
    let folder = depending();
    let git = |args: &[&str]| {
        let mut git = std::process::Command::new("git");
        git.args(["-c", "user.name=a", "-c", "user.email=a@localhost"]).args(args);
        let output = git.current_dir(folder.path()).output().expect("git runs");
        assert!(output.status.success(), "{args:?}: {output:?}");
    };
    git(&["init", "-q"]);
    git(&["add", "Moves.lua", "arm.xml", "arm_lib.lua"]);
    git(&["commit", "-q", "-m", "first"]);
    let run = |broken: bool| {
        let file = folder.path().join("broken");
        drop(std::fs::remove_file(&file));
        if broken {
            folder.file("broken", "");
        }
        assert_eq!(rtf(&folder, &["run", "arm.xml"]).code, Some(i32::from(broken)));
    };
    let pairs = || {
        let flaky = json(&folder, &["flaky"]);
        let test = &flaky["tests"][0];
        [&test["flips"], &test["pairs"], &test["pairs_by_sources"]].map(|it| it.as_u64())
    };
    run(false);
    run(true);
    assert_eq!(pairs(), [Some(1), Some(1), None], "one commit");
    folder.file("Moves.lua", &format!("{DEPENDS}-- better\n"));
    run(false);
    assert_eq!(pairs(), [Some(1), Some(1), None], "other sources");
    run(true);
    assert_eq!(pairs(), [Some(2), Some(2), Some(1)], "equal sources, not committed");
    git(&["commit", "-q", "-a", "-m", "second"]);
    run(false);
    assert_eq!(pairs(), [Some(3), Some(3), Some(2)], "equal sources, then committed");
}

#[test]
fn a_test_that_changes_on_one_commit_is_flaky() {
    let folder = depending();
    // Git does not say whether there are uncommitted changes: this is no whole repository.
    folder.file(".git/HEAD", "ref: refs/heads/main\n");
    folder.file(".git/refs/heads/main", "0123456789abcdef0123456789abcdef01234567\n");
    run_flaky(&folder, &["run", "arm.xml"]);
    assert_snapshot!(shown(&folder, &["flaky"]), @"
    exit code 0
    ----- stdout
    arm/Moves
      2 flips in 2 pairs of comparable results with equal sources: 100 % (34 % … 100 %)
      2 passed, 1 failed
      last problem  [START]  failed: left holds  ([RUN])
    compared if the sources of a test are equal (suite, plug-ins, their modules), without a commit or with uncommitted changes: 3 runs
    ----- stderr
    ");
    let flaky = json(&folder, &["flaky", "-E", "tag(smoke) & suite(=arm)"]);
    assert_eq!((&flaky["tests"][0]["flips"], &flaky["tests"][0]["pairs"]), (&2.into(), &2.into()));
    for other in [["-E", "name(Stops)"], ["--branch", "arm"], ["--since", "2090-01-01"]] {
        let flaky = json(&folder, &[&["flaky"][..], &other[..]].concat());
        assert_eq!(flaky["tests"], serde_json::json!([]), "{other:?}");
    }
    let compared = json(&folder, &["compare", "latest", "branch:main"]);
    assert_eq!(compared["comparison"]["runs_b"], 3);
    let exported = rtf(&folder, &["history", "export", "--format", "csv"]);
    assert_eq!(exported.stdout.lines().count(), 4, "{}", exported.stdout);
}
