//! `rtf.toml`: the precedence of its values, and the search for it.

use insta::assert_snapshot;
use rtf_model::{MessageKind, Record, Verdict};

use crate::support::{Finished, Folder};

pub const TOLD: &str = "import os\nimport rtf\n\n\nclass Told(rtf.TestCase):\n    def run(self):\n        \
    names = ['ROBOT_IP', 'CAMERA', 'RTF_PARAM_TOLERANCE', 'RTF_PARAM_JOINT_COUNT']\n        \
    told = [self.param, self.environment] + [os.environ.get(name, '-') for name in names]\n        \
    self.report('|'.join(told))\n";

pub const SUITE: &str = "<suite name=\"arm\">\n  <environment>--robot any</environment>\n  \
    <env name=\"ROBOT_IP\" value=\"suite\"/>\n  \
    <test param=\"--within ${param:tolerance}\">Told.py</test>\n  \
    <test name=\"special\" param=\"$${param:x} ${param:n=3}\">Told.py\n    \
    <env name=\"ROBOT_IP\" value=\"test\"/>\n  </test>\n</suite>\n";

const TOML: &str = "default-profile = \"sim\"\nenvironment = \"--robot none\"\n\n[env]\n\
    ROBOT_IP = \"127.0.0.1\"\nCAMERA = \"off\"\n\n[param]\ntolerance = 0.02\njoint-count = 7\n\n\
    [profile.sim]\n\n[profile.real]\nenvironment = \"--robot icub\"\nenv.ROBOT_IP = \"10.0.0.2\"\n\
    param.tolerance = 0.05\n";

pub fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("rtf.toml", TOML).file("tests/arm.xml", SUITE).file("tests/Told.py", TOLD);
    folder
}

pub fn run(folder: &Folder, args: &[&str], variables: &[(&str, &str)]) -> Finished {
    let mut command = folder.command(&[&["run"], args].concat());
    let output = command.envs(variables.iter().copied()).output().expect("rtf runs");
    Finished {
        code: output.status.code(),
        stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

/// What each test reported in the newest run.
fn told(record: &Record) -> Vec<String> {
    let attempts = record.tests.iter().flat_map(|test| &test.attempts);
    let messages = attempts.flat_map(|attempt| &attempt.messages);
    let reports = messages.filter(|message| message.kind == MessageKind::Report);
    reports.map(|message| message.text.clone()).collect()
}

fn told_by(folder: &Folder, args: &[&str], variables: &[(&str, &str)]) -> Vec<String> {
    let finished = run(folder, args, variables);
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    told(&folder.journal().record)
}

#[test]
fn a_profile_goes_over_the_suite_and_the_suite_over_the_file() {
    let folder = folder();
    assert_eq!(
        told_by(&folder, &["tests/arm.xml"], &[]),
        ["--within 0.02|--robot any|suite|off|0.02|7", "${param:x} 3|--robot any|test|off|0.02|7"]
    );
    let real = [
        "--within 0.05|--robot icub|10.0.0.2|off|0.05|7",
        "${param:x} 3|--robot icub|test|off|0.05|7",
    ];
    assert_eq!(told_by(&folder, &["tests", "--profile", "real"], &[]), real);
    assert_eq!(told_by(&folder, &["tests"], &[("RTF_PROFILE", "real")]), real);
}

#[test]
fn the_command_line_goes_over_variables_and_these_over_a_profile() {
    let folder = folder();
    let variable = [("RTF_PARAM_TOLERANCE", "0.3"), ("RTF_PROFILE", "real")];
    let first = |told: Vec<String>| told.into_iter().next().expect("a report");
    let told = first(told_by(&folder, &["tests/arm.xml"], &variable));
    assert_eq!(told, "--within 0.3|--robot icub|10.0.0.2|off|0.3|7");
    let args = ["tests/arm.xml", "--profile", "sim", "--set", "tolerance=0.4"];
    let told = first(told_by(&folder, &args, &variable));
    assert_eq!(told, "--within 0.4|--robot any|suite|off|0.4|7");
}

#[test]
fn plug_ins_that_are_given_directly_have_it_too() {
    let folder = folder();
    let told = told_by(&folder, &["tests/Told.py", "--profile", "real"], &[]);
    assert_eq!(told, ["|--robot icub|10.0.0.2|off|0.05|7"]);
    let told = told_by(&folder, &["tests/Told.py", "--environment", "mine"], &[]);
    assert_eq!(told, ["|mine|127.0.0.1|off|0.02|7"]);
}

#[test]
fn a_rerun_has_the_same_profile_and_parameters() {
    let folder = folder();
    folder.file("tests/Told.py", &format!("{TOLD}        self.fail('no')\n"));
    let args = ["tests/arm.xml::special", "--profile", "real", "--set", "n=4 5"];
    let finished = run(&folder, &args, &[]);
    let rerun = "rerun   rtf run tests/arm.xml::special --profile real --set 'n=4 5'\n";
    assert!(finished.stdout.contains(rerun), "{}", finished.stdout);
    let before = told(&folder.journal().record);
    assert_eq!(before, ["${param:x} 4 5|--robot icub|test|off|0.05|7"]);
    assert_eq!(run(&folder, &["--rerun", "failed"], &[]).code, Some(1));
    assert_eq!(told(&folder.journal().record), before);
}

#[test]
fn limits_are_the_nearest_ones_and_a_profile_stretches_all() {
    let folder = Folder::new();
    folder.file(
        "T.py",
        "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.sleep(0.5)\n",
    );
    let suite =
        "<suite><test name='own' timeout='60s'>T.py</test><test name='default'>T.py</test></suite>";
    let toml = "[timeouts]\nrun = \"100ms\"\ngrace = \"10s\"\n[profile.slow]\ntimeouts.scale = 100\n[profile.own]\ntimeouts.run = 50\n";
    folder.file("s.xml", suite).file("rtf.toml", toml);
    let verdicts = |args: &[&str]| {
        run(&folder, args, &[]);
        let record = folder.journal().record;
        record.tests.iter().map(|test| test.final_verdict()).collect::<Vec<_>>()
    };
    assert_eq!(verdicts(&["s.xml"]), [Verdict::Passed, Verdict::TimedOut]);
    assert_eq!(verdicts(&["s.xml", "--profile", "slow"]), [Verdict::Passed, Verdict::Passed]);
    assert_eq!(verdicts(&["s.xml", "--profile", "own"]), [Verdict::Passed, Verdict::Passed]);
}

#[test]
fn what_concerns_the_run() {
    let folder = folder();
    let toml = "results = \"out/runs\"\nreports = [\"junit=out/junit.xml\"]\nfilter = \"!name(special)\"\n\
        [param]\ntolerance = 1\n[profile.ci]\nresults = \"out/ci\"\nreports = [\"tap=out/r.tap\"]\nfilter = \"all()\"\n";
    folder.file("rtf.toml", toml);
    let exists = |path: &str| folder.path().join(path).exists();
    // Paths begin in the file's folder, wherever the command is given.
    let mut command = folder.command(&["run", "arm.xml"]);
    let output = command.current_dir(folder.path().join("tests")).output().expect("rtf runs");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(exists("out/runs/latest") && exists("out/junit.xml") && !exists("out/r.tap"));
    let shown = folder.rtf(&["show"]);
    assert!(shown.stdout.contains("1 test in 1 suite"), "{}{}", shown.stdout, shown.stderr);
    let finished = run(&folder, &["tests", "--profile", "ci", "--report", "text=here.txt"], &[]);
    assert!(finished.stdout.contains("2 tests in 1 suite"), "{}", finished.stdout);
    assert!(exists("out/ci/latest") && exists("out/r.tap") && exists("here.txt"));
    run(&folder, &["tests", "-E", "name(special)"], &[("RTF_RESULTS", "mine")]);
    assert!(exists("mine/latest"), "a variable goes over the file");
    let finished = run(&folder, &["tests/arm.xml::special", "--results", "typed"], &[]);
    assert_eq!(finished.code, Some(0), "a test that is named is run: {}", finished.stderr);
    assert!(exists("typed/latest"));
}

#[test]
fn how_suites_run_and_repeat_may_be_said_once_for_all() {
    let folder = Folder::new();
    let toml =
        "jobs = 2\nretries = 1\nmax-fail = 1\nlock-timeout = \"3s\"\nflaky-result = \"fail\"\n";
    folder.file("rtf.toml", toml);
    folder.file("F.lua", "TestCase = {}\nfunction TestCase.run() rtf.fail('no') end\n");
    folder.file("s.xml", "<suite><test>F.lua</test><test name='G'>F.lua</test></suite>");
    let finished = folder.rtf(&["run", "s.xml"]);
    assert!(finished.stdout.contains("s/G: 1 test has not passed"), "{}", finished.stdout);
    let record = folder.journal().record;
    let manifest = &record.run.as_ref().expect("a beginning").manifest;
    assert_eq!((manifest.jobs, manifest.retries, manifest.flaky_fails), (Some(2), Some(1), true));
    assert_eq!(record.tests[0].attempts.len(), 2);
    // The command line goes over it.
    folder.rtf(&["run", "s.xml", "--retries", "0", "--max-fail", "9", "--jobs", "1"]);
    let attempts: Vec<_> =
        folder.journal().record.tests.iter().map(|test| test.attempts.len()).collect();
    assert_eq!(attempts, [1, 1]);
    let shown = folder.rtf(&["config", "show", "s.xml"]).stdout;
    let line = |key: &str| {
        let line =
            shown.lines().find(|line| line.starts_with(&format!("{key} ="))).expect("a line");
        line.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    assert_eq!(line("jobs"), "jobs = \"2\" # rtf.toml:1");
    assert_eq!(line("lock-timeout"), "lock-timeout = \"3s\" # rtf.toml:4");
    folder.file("rtf.toml", "jobs = 0\nmax-fail = 1.5\n");
    let wrong = folder.rtf(&["run", "s.xml"]);
    assert_eq!(wrong.code, Some(2));
    for told in
        ["`jobs` has to be a whole number from 1 to 65535", "`max-fail` has to be a whole number"]
    {
        assert!(wrong.stderr.contains(told), "{}", wrong.stderr);
    }
}

#[test]
fn the_nearest_file_counts_up_to_the_root_of_the_repository() {
    let folder = folder();
    folder.file("tests/hand/arm.xml", SUITE).file("tests/hand/Told.py", TOLD);
    folder.file("tests/hand/rtf.toml", "[param]\ntolerance = 9\n[profile.real]\n");
    folder.file("other/.git/HEAD", "").file("other/deep/Told.py", TOLD);
    folder.file("other/deep/s.xml", "<suite><test>Told.py</test></suite>");
    let told = told_by(&folder, &["tests/hand", "tests/arm.xml", "other/deep"], &[]);
    assert_eq!(told[0], "--within 9|--robot any|suite|-|9|-");
    assert_eq!(told[2], "--within 0.02|--robot any|suite|off|0.02|7");
    assert_eq!(told[4], "||-|-|-|-", "a repository of its own");
}

#[test]
fn config_show_tells_where_each_value_comes_from() {
    let folder = folder();
    folder.file("rtf.toml", &format!("{TOML}timeouts.scale = 2.5\n"));
    let args = ["config", "show", "tests/arm.xml", "--profile", "real", "--set", "joint-count=6"];
    assert_snapshot!(folder.shown(&folder.rtf(&args)), @r#"
    exit code 0
    ----- stdout
    # rtf.toml
    profile = "real"                              # --profile or RTF_PROFILE
    environment = "--robot icub"                  # rtf.toml:15, over tests/arm.xml:2, rtf.toml:2
    env.CAMERA = "off"                            # rtf.toml:6
    env.ROBOT_IP = "10.0.0.2"                     # rtf.toml:16, over tests/arm.xml:3, rtf.toml:5
    param.joint-count = "6"                       # --set, over rtf.toml:10
    param.tolerance = "0.05"                      # rtf.toml:17, over rtf.toml:9
    timeouts.load = "[TIME]"                         # built in
    timeouts.setup = "[TIME]"                        # built in
    timeouts.run = "[TIME]"                         # built in
    timeouts.teardown = "[TIME]"                     # built in
    timeouts.slow = "[TIME]"                         # built in
    timeouts.grace = "[TIME]"                         # built in
    timeouts.fixture-setup = "[TIME]"                # built in
    timeouts.fixture-check = "[TIME]"                 # built in
    timeouts.fixture-teardown = "[TIME]"             # built in
    timeouts.hook = "[TIME]"                         # built in
    timeouts.scale = "2.5"                        # rtf.toml:18
    results = "rtf-results"                       # built in
    annotations = "auto"                          # built in
    fork = "auto"                                 # built in
    shutdown-timeout = "[TIME]"                      # built in
    jobs = "1"                                    # built in
    flaky-result = "pass"                         # built in
    order = "file"                                # built in
    history.enabled = "true"                      # built in
    ----- stderr
    "#);
    let mut command = folder.command(&["config", "show"]);
    let output = command.env("RTF_RESULTS", "mine").output().expect("rtf runs");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("profile = \"sim\""), "{text}");
    assert!(text.contains("# rtf.toml:1\n") && text.contains("# RTF_RESULTS\n"), "{text}");
    assert_eq!(folder.rtf(&["config", "show", "nowhere.xml"]).code, Some(2));
}
