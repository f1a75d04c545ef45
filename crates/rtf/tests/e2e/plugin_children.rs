//! A plug-in starts processes, in every way in which a program of its language does. Its verdict
//! is its own, and nothing of what the processes do reaches the report.

use rtf_model::{MessageKind, Verdict};

use crate::host_modes::MODES;
use crate::support::{Folder, build_ada, build_cpp, nothing_left, root};

/// How a process is started, and how it ends.
type Ways = &'static [(&'static str, &'static str)];

/// Through the C++ functions of the next one; `popen` is Lua's.
const LUA: &str = r#"
local forks = require("Forks")
TestCase = {}
function TestCase.run()
  local how, more = rtf.param():match("^start (%S+)(.*)$")
  local ended
  if how == "popen" then
    local _, _, code = io.popen("exit 3"):close()
    ended = code
  elseif how == "execute" then
    local _, _, code = os.execute("exit 3")
    ended = code
  else
    ended = forks.start(how)
  end
  if ended == -1 then return end
  rtf.report("ended " .. ended)
  rtf.check(more == "", "it was asked to fail")
end
"#;

const CPP_WAYS: Ways = &[
    ("exit", "3"),
    ("abort", "134"),
    ("return", "0"),
    ("itself", "2"),
    ("spawn", "3"),
    ("system", "3"),
];
const LUA_WAYS: Ways = &[
    ("exit", "3"),
    ("abort", "134"),
    ("return", "0"),
    ("itself", "2"),
    ("popen", "3"),
    ("execute", "3"),
];

const PYTHON: &str = r#"
import multiprocessing
import os
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor

import rtf


def leave(code):
    sys.exit(code)


def triple(number):
    return 3 * number


def own_command():
    with open("/proc/self/cmdline", "rb") as words:
        return words.read().split(b"\0")[:-1]


class T(rtf.TestCase):
    def run(self):
        _, how, *more = self.param.split()
        ended = getattr(self, how)()
        if ended is None:
            return
        self.report(f"ended {ended}")
        self.check(not more, "it was asked to fail")

    def fork(self, in_child):
        child = os.fork()
        if child == 0:
            return in_child()
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        return code if code >= 0 else 128 - code

    def exit(self):
        return self.fork(lambda: sys.exit(3))

    def _exit(self):
        return self.fork(lambda: os._exit(3))

    def abort(self):
        return self.fork(os.abort)

    def returns(self):
        return self.fork(lambda: None)

    def itself(self):
        return subprocess.run(own_command(), executable="/proc/self/exe").returncode

    def interpreter(self):
        command = [sys.executable, "-c", "import rtf, sys; sys.exit(3)"]
        return subprocess.run(command, env=dict(os.environ)).returncode

    def spawn(self):
        child = os.posix_spawn("/bin/sh", ["sh", "-c", "exit 3"], os.environ)
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])

    def system(self):
        return os.waitstatus_to_exitcode(os.system("exit 3"))

    def multiprocessing(self, method):
        context = multiprocessing.get_context(method)
        process = context.Process(target=leave, args=(3,))
        process.start()
        process.join()
        assert process.exitcode == 3, process.exitcode
        with context.Pool(1) as pool:
            assert pool.map(triple, [1, 2]) == [3, 6]
        with ProcessPoolExecutor(1, mp_context=context) as executor:
            return executor.submit(triple, 1).result()

    def mp_spawn(self):
        return self.multiprocessing("spawn")

    def mp_server(self):
        return self.multiprocessing("forkserver")

    def mp_fork(self):
        return self.multiprocessing("fork")
"#;

const PYTHON_WAYS: Ways = &[
    ("exit", "3"),
    ("_exit", "3"),
    ("abort", "134"),
    ("returns", "0"),
    ("itself", "2"),
    ("interpreter", "3"),
    ("spawn", "3"),
    ("system", "3"),
    ("mp_spawn", "3"),
    ("mp_server", "3"),
    ("mp_fork", "3"),
];

const RUBY: &str = r#"
require "rtf"
require "rbconfig"

class T < RTF::TestCase
  def run
    _, how, *more = param.split
    if %w[exit exit! abort return].include?(how)
      child = fork
      return if child.nil? && how == "return"
      Process.kill(:ABRT, Process.pid) || sleep if child.nil? && how == "abort"
      send(how, 3) if child.nil?
    else
      child = start(how)
    end
    status = child ? Process.wait2(child).last : $?
    report("ended #{status.exitstatus || 128 + status.termsig}")
    check(more.empty?, "it was asked to fail")
  end

  def start(how)
    case how
    when "itself" then spawn(*File.read("/proc/self/cmdline").split("\0"))
    when "interpreter" then spawn(ENV.to_h, RbConfig.ruby, "-e", "require 'rtf'; exit 3")
    when "spawn" then spawn("exit 3")
    when "block" then fork { exit 3 }
    when "system" then system("exit 3") && nil
    when "backticks" then `exit 3` && nil
    end
  end
end
"#;

const RUBY_WAYS: Ways = &[
    ("exit", "3"),
    ("exit!", "3"),
    ("abort", "134"),
    ("return", "0"),
    ("block", "3"),
    ("itself", "2"),
    ("interpreter", "3"),
    ("spawn", "3"),
    ("system", "3"),
    ("backticks", "3"),
];

/// The ways of `sdk/ada/tests/children`. `OS_Exit` and `OS_Abort` end a child of `fork`.
const ADA_WAYS: Ways = &[
    ("exit", "3"),
    ("abort", "134"),
    ("return", "0"),
    ("itself", "2"),
    ("spawn", "3"),
    ("non-blocking", "0"),
    ("expect", "3"),
    ("system", "3"),
];

/// Each way twice: in a test that passes, and in one that fails.
fn the_verdict_is_the_plugins_own(plugin: &str, ways: Ways) {
    let cpp = build_cpp(&root().join("crates/rtf/tests/e2e/cpp"), "e2e-cpp").join("Forks.so");
    for mode in MODES {
        let folder = Folder::new();
        folder.file("L.lua", LUA).file("P.py", PYTHON).file("R.rb", RUBY);
        std::fs::copy(&cpp, folder.path().join("Forks.so")).expect("a copy");
        let params = ways.iter().flat_map(|(how, _)| [how.to_string(), format!("{how} fail")]);
        let tests = params.enumerate().map(|(n, param)| {
            let isolation = mode.isolation;
            // Where each leak counts, the processes of a test are grouped.
            let leaks = if n % 2 == 0 { "fail" } else { "report" };
            format!(
                "<test name='t{n}' isolation='{isolation}' leaks='{leaks}' \
                 param='start {param}'>{plugin}</test>\n"
            )
        });
        folder.file("s.xml", &format!("<suite name='s'>{}</suite>", tests.collect::<String>()));
        let finished = folder.rtf(&["run", "--fork", mode.fork, "s.xml"]);
        assert!(nothing_left(&folder));
        let record = folder.journal().record;
        assert_eq!(record.tests.len(), 2 * ways.len(), "{}{}", finished.stdout, finished.stderr);
        for (index, test) in record.tests.iter().enumerate() {
            let (how, ended) = ways[index / 2];
            let attempt = &test.attempts[0];
            let verdict = attempt.finished.as_ref().expect("an end").1.verdict;
            let messages = attempt.messages.iter().filter(|m| m.kind != MessageKind::Check);
            let texts: Vec<&str> = messages.map(|m| m.text.as_str()).collect();
            let ended = format!("ended {ended}");
            let expected: (Verdict, &[&str]) = match index % 2 {
                0 => (Verdict::Passed, &[&ended]),
                _ => (Verdict::Failed, &[&ended, "it was asked to fail"]),
            };
            assert_eq!((verdict, &texts[..]), expected, "{how}, {}", mode.name);
            assert!(attempt.leaked.is_empty(), "{how}, {}: {:?}", mode.name, attempt.leaked);
        }
    }
}

#[test]
fn of_an_ada_plugin() {
    let project = root().canonicalize().expect("a path").join("sdk/ada/tests/tests.gpr");
    let built = build_ada(&project, "PLUGIN", &["children".to_owned()]);
    let plugin = built.join("children/libchildren.so");
    the_verdict_is_the_plugins_own(&plugin.display().to_string(), ADA_WAYS);
}

#[test]
fn of_a_cpp_plugin() {
    the_verdict_is_the_plugins_own("Forks.so", CPP_WAYS);
}

#[test]
fn of_a_lua_plugin() {
    the_verdict_is_the_plugins_own("L.lua", LUA_WAYS);
}

#[test]
fn of_a_python_plugin() {
    the_verdict_is_the_plugins_own("P.py", PYTHON_WAYS);
}

#[test]
fn of_a_ruby_plugin() {
    the_verdict_is_the_plugins_own("R.rb", RUBY_WAYS);
}
