//! `rtf doctor` lists missing programs, with a `PATH` made by the tests.

use std::os::unix::fs::PermissionsExt;
use std::process::Stdio;

use insta::assert_snapshot;
use serde_json::Value;

use crate::support::{Finished, Folder};

/// Stands for a Python whose only module beside its own is `there`.
const PYTHON: &str = "#!/bin/sh
case \"$*\" in
  --version) echo 'Python 3.12.1' ;;
  *rtf.host*--check | *' there') ;;
  *) exit 1 ;;
esac
";

fn machine(programs: &[(&str, &str)]) -> Folder {
    let folder = Folder::new();
    folder.file("bin/README", "all programs of this machine");
    for (name, text) in programs {
        folder.file(&format!("bin/{name}"), text);
        let file = folder.path().join("bin").join(name);
        std::fs::set_permissions(file, PermissionsExt::from_mode(0o755)).expect("a program");
    }
    folder
}

fn doctor(folder: &Folder, args: &[&str]) -> Finished {
    let mut command = folder.command(&["doctor"]);
    command.args(args).env("PATH", folder.path().join("bin"));
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let output = command.output().expect("rtf runs");
    Finished::of(output)
}

#[test]
fn a_machine_without_anything() {
    let folder = machine(&[]);
    let finished = doctor(&folder, &["dll", "python", "stacks", "ssh", "ros2launch"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 1
    ----- stdout
    rtf
      ok       dll             plug-ins in C and C++
                               [BIN]/rtf-host-native
      missing  python          plug-ins in Python, including all fixture managers of rtf
                               plug-ins of type `python` need `python3`, which is missing
                               hint: install Python 3.9 or later (`apt-get install python3`), activate a virtual environment, or set RTF_PYTHON to an interpreter
      missing  stacks          stack dumps of hung native code
                               neither `gdb` nor `eu-stack` is on PATH
                               hint: `apt-get install gdb` or `apt-get install elfutils`
      missing  ssh             fixtures on other machines
                               `ssh` is not on PATH
                               hint: `apt-get install openssh-client`, or set RTF_SSH to another program
    fixtures
      missing  ros2launch      runs a ROS 2 launch file
                               plug-ins of type `python` need `python3`, which is missing
                               hint: see `rtf doctor python`
                               `ros2` is not on PATH
                               hint: install ROS 2 from https://docs.ros.org (on Ubuntu 24.04, for example, add its repository and `apt-get install ros-jazzy-ros-base`), then `. /opt/ros/jazzy/setup.bash` before starting rtf
                               the `python3` on PATH has no module `rclpy` (only for --topic)
                               hint: install ROS 2, or `pip install ros-rclpy ros-rmw-fastrtps-cpp ros-std-msgs`
    ----- stderr
    ");
}

/// Of each fixture manager, by the table that `rtf doctor` reads.
#[test]
fn a_machine_without_middleware_is_told_of_each_program_and_how_it_is_installed() {
    let table = include_str!("../../../../fixtures/needs.json");
    let table: serde_json::Map<String, Value> = serde_json::from_str(table).expect("a table");
    let folder = machine(&[("python3", PYTHON)]);
    for (fixture, entry) in &table {
        let needs = entry["needs"].as_array().expect("needs");
        let told = doctor(&folder, &[fixture]);
        let is_hard = needs.iter().any(|need| need.get("for").is_none());
        assert_eq!(told.code, Some(i32::from(is_hard)), "{fixture}: {}", told.stdout);
        for need in needs {
            let programs = need["programs"].as_array().into_iter().flatten();
            let names =
                programs.chain(need.get("module")).map(|name| name.as_str().expect("a name"));
            for missing in names.chain(need["install"].as_str()) {
                assert!(told.stdout.contains(missing), "{fixture}, {missing}: {}", told.stdout);
            }
        }
    }
}

#[test]
fn what_a_fixture_needs_is_there() {
    let folder = machine(&[("python3", PYTHON), ("ros2", "#!/bin/sh\n"), ("gdb", "#!/bin/sh\n")]);
    // Only some suites need `rclpy`: that it is missing is told, and counts for nothing.
    let finished = doctor(&folder, &["ros2launch", "python", "stacks"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 0
    ----- stdout
    rtf
      ok       python          plug-ins in Python, including all fixture managers of rtf
                               [FOLDER]/bin/python3 (Python 3.12.1)
      ok       stacks          stack dumps of hung native code
                               [FOLDER]/bin/gdb
    fixtures
      ok       ros2launch      runs a ROS 2 launch file
                               [FOLDER]/bin/ros2
                               the `python3` on PATH has no module `rclpy` (only for --topic)
                               hint: install ROS 2, or `pip install ros-rclpy ros-rmw-fastrtps-cpp ros-std-msgs`
    ----- stderr
    ");
}

#[test]
fn a_host_that_does_not_start_is_as_good_as_none() {
    let broken = "#!/bin/sh\necho 'No module named rtf' >&2\nexit 1\n";
    let folder = machine(&[("python3", broken), ("deployer-corba", "#!/bin/sh\n")]);
    let finished = doctor(&folder, &["orocos", "ros2shm"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 1
    ----- stdout
    fixtures
      missing  orocos          runs an OROCOS RTT deployer
                               [FOLDER]/bin/deployer-corba
                               `[FOLDER]/bin/python3` does not start: exit status: 1: No module named rtf
                               hint: see `rtf doctor python`
                               `omniNames` is not on PATH (only for --own-names)
                               hint: `apt-get install omniorb-nameserver`
      missing  ros2shm         removes the shared memory of dead ROS 2 nodes
                               [ROOT]/fixtures
                               `[FOLDER]/bin/python3` does not start: exit status: 1: No module named rtf
                               hint: see `rtf doctor python`
    ----- stderr
    ");
}

#[test]
fn one_json_document() {
    let folder = machine(&[("python3", PYTHON), ("roscore", "#!/bin/sh\n")]);
    let finished = doctor(&folder, &["roscore", "orocos", "--format", "json"]);
    assert_snapshot!(folder.shown(&finished), @r#"
    exit code 1
    ----- stdout
    {
      "rtf": "0.1.0",
      "findings": [
        {
          "name": "orocos",
          "part": "fixture",
          "ok": false,
          "about": "runs an OROCOS RTT deployer",
          "found": [],
          "missing": [
            {
              "what": "none of `deployer-gnulinux`, `deployer-corba` is on PATH",
              "install": "build https://github.com/orocos-toolchain (no distribution packages it), then source its `env.sh` before starting rtf"
            },
            {
              "what": "`omniNames` is not on PATH",
              "install": "`apt-get install omniorb-nameserver`",
              "for": "--own-names"
            }
          ]
        },
        {
          "name": "roscore",
          "part": "fixture",
          "ok": true,
          "about": "runs the ROS 1 master",
          "found": [
            "[FOLDER]/bin/roscore"
          ],
          "missing": []
        }
      ]
    }
    ----- stderr
    "#);
}

/// Without names everything is looked at, and only what every run needs counts.
#[test]
fn everything() {
    let folder = machine(&[]);
    let finished = doctor(&folder, &["--format", "json"]);
    assert_eq!(finished.code, Some(0), "{}", finished.stderr);
    let document: Value = serde_json::from_str(&finished.stdout).expect("JSON");
    let findings = document["findings"].as_array().expect("findings");
    let is_ok = |name: &str| {
        let finding = findings.iter().find(|finding| finding["name"] == name).expect(name);
        finding["ok"] == true
    };
    for name in ["dll", "lua"] {
        assert!(is_ok(name), "{name}");
    }
    for name in ["python", "ruby", "stacks", "ssh", "roslaunch", "ros2launch", "orocos"] {
        assert!(!is_ok(name), "{name}");
    }
    // What there is of these depends on the machine.
    let _ = (is_ok("cgroups"), is_ok("network"));
}

#[test]
fn an_unknown_name() {
    let folder = machine(&[]);
    let finished = doctor(&folder, &["rosluanch"]);
    assert_eq!(finished.code, Some(2));
    assert!(finished.stderr.starts_with("error: unknown name `rosluanch`\nhint: known names are "));
    assert!(finished.stderr.contains(" roslaunch"), "{}", finished.stderr);
}
