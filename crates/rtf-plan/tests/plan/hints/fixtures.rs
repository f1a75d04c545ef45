//! Hints about fixtures: their commands, probes, values and dependencies.

use super::Table;

pub const TABLES: &[Table] = &[
    ("<suite>{}<test>A.lua</test></suite>", FIXTURES),
    ("<suite><fixture type='process' name='sim'>{}</fixture><test>A.lua</test></suite>", COMMANDS),
    (
        "<suite><fixture type='process' name='sim'><command>./sim</command>{}</fixture>\
         <test>A.lua</test></suite>",
        PARTS,
    ),
    (
        "<suite><fixture type='process'><command>./tool</command></fixture><test>A.lua</test>\
         </suite>\n== {}",
        PROGRAMS,
    ),
    ("<suite>{}</suite>\n== Plugin.py\nTestCase, FixtureManager", SUITES),
];

const FIXTURES: &[(&str, &str, &str)] = &[
    (
        "<fixture><command>./sim</command></fixture>",
        "write `type=\"process\"`",
        "<fixture type=\"process\"><command>./sim</command></fixture>",
    ),
    (
        "<fixture type='tap'>sim</fixture>",
        "`type=\"process\"` is a fixture that runs a program",
        "<fixture type=\"process\"><command>./sim</command></fixture>",
    ),
    (
        "<fixture type='process' host='robot:22'><command>sim</command></fixture>",
        "write it like `user@machine` or `ssh://user@machine:2222`",
        "<fixture type='process' host='ssh://user@robot:22'><command>sim</command></fixture>",
    ),
    (
        "<fixture type='process' host='r'><command>sim</command><ready file='up'/></fixture>",
        "use `log`, `tcp` or `http`, or `command=\"ssh …\"`",
        "<fixture type='process' host='r'><command>sim</command><ready log='up'/></fixture>",
    ),
    (
        "<fixture type='process' host='r'><command>sim</command><ready file='up'/></fixture>",
        "use `log`, `tcp` or `http`, or `command=\"ssh …\"`",
        "<fixture type='process' host='r'><command>sim</command><ready command=\"sh -c 'ssh r ls'\"/>\
         </fixture>",
    ),
    (
        "<fixture type='process' host='r'><command>sim</command><provide name='v' file='v'/>\
         </fixture>",
        "use `log`, or `command=\"ssh …\"`",
        "<fixture type='process' host='r'><command>sim</command><provide name='v' log='v=(.*)'/>\
         </fixture>",
    ),
    (
        "<fixture type='process' name='a' depends='b'><command>./sim</command></fixture>\
         <fixture type='process' name='b'><command>./sim</command></fixture>",
        "if `b` needs no other fixture, give it `depends=\"\"`",
        "<fixture type='process' name='a' depends='b'><command>./sim</command></fixture>\
         <fixture type='process' name='b' depends=\"\"><command>./sim</command></fixture>",
    ),
    (
        "<fixture type='process' name='a'><command>./sim</command></fixture>\
         <fixture type='process' depends='ab'><command>./sim</command></fixture>",
        "did you mean `a`?",
        "<fixture type='process' name='a'><command>./sim</command></fixture>\
         <fixture type='process' depends='a'><command>./sim</command></fixture>",
    ),
    (
        "<fixture type='process' name='a'><command>./sim</command><provide name='v' log='(.*)'/>\
         </fixture><fixture type='process' depends=''><command>./sim ${fixture:a.v}</command>\
         </fixture>",
        "add `a` to its `depends`",
        "<fixture type='process' name='a'><command>./sim</command><provide name='v' log='(.*)'/>\
         </fixture><fixture type='process' depends='a'><command>./sim ${fixture:a.v}</command>\
         </fixture>",
    ),
];

const COMMANDS: &[(&str, &str, &str)] = &[
    (
        "<command>./sim | ./read</command>",
        "if you want a shell, write `sh -c '…'`",
        "<command>sh -c './sim | ./read'</command>",
    ),
    (
        "<command>./sim --home $HOME</command>",
        "`rtf` replaces `${port:NAME}`, `${fixture:NAME.VALUE}` and `${param:NAME}`. For a \
         variable, as of `<env>`, write `sh -c '…'`",
        "<command>sh -c './sim --home $HOME'</command>",
    ),
    (
        "<command>source setup.bash &amp;&amp; ./sim</command>",
        "write `bash -c '…'` around it; in XML, `&&` is `&amp;&amp;`",
        "<command>bash -c 'source setup.bash &amp;&amp; ./sim'</command>",
    ),
    (
        "<command>PORT=1 ./sim</command>",
        "set the variable with `<env name=\"PORT\" value=\"1\"/>`",
        "<env name=\"PORT\" value=\"1\"/><command>./sim</command>",
    ),
    (
        "<command>TEXT='\"a&lt;b\"' ./sim</command>",
        "set the variable with `<env name=\"TEXT\" value=\"&quot;a&lt;b&quot;\"/>`",
        "<env name=\"TEXT\" value=\"&quot;a&lt;b&quot;\"/><command>./sim</command>",
    ),
    (
        "<command>./sim ${prot:a}</command>",
        "did you mean `${port:`?",
        "<command>./sim ${port:a}</command>",
    ),
    (
        "<command>./sim ${port:a</command>",
        "`$${port:` stands for these characters",
        "<command>./sim $${port:a</command>",
    ),
    (
        "<command>./sim ${param:a</command>",
        "`$${param:` stands for these characters",
        "<command>./sim $${param:a</command>",
    ),
    (
        "<command>./sim ${param:joint.limit}</command>",
        "a name is letters, digits, `-` and `_`, a letter first",
        "<command>./sim ${param:joint-limit=1}</command>",
    ),
    (
        "<command>./sim ${fixture:port}</command><provide name='port' log='(.*)'/>",
        "write `${fixture:NAME.VALUE}`",
        "<command>./sim</command><provide name='port' log='(.*)'/></fixture>\
         <fixture type='process'><command>./sim ${fixture:sim.port}</command>",
    ),
    (
        "<command>read</command>",
        "use `./read` for the one in the suite's directory",
        "<command>./read</command>",
    ),
];

const PROGRAMS: &[(&str, &str, &str)] = &[
    ("tool", "make it executable with `chmod +x ./tool`", "program tool"),
    (
        "program tool\n#!/bin/sh\r\n",
        "remove them: `sed -i 's/\\r$//' FILE`",
        "program tool\n#!/bin/sh\n",
    ),
    (
        "program tool\n#!/nowhere/sh\n",
        "install it, or correct the first line of the file",
        "program tool\n#!/bin/sh\n",
    ),
];

const PARTS: &[(&str, &str, &str)] = &[
    ("<ready tcp='5000'/>", "write it like `127.0.0.1:5000`", "<ready tcp='127.0.0.1:5000'/>"),
    (
        "<ready http='a:80'/>",
        "write it like `http://127.0.0.1:8080/health`",
        "<ready http='http://127.0.0.1:8080/health'/>",
    ),
    (
        "<ready file='a' tcp='a:1'/>",
        "write a separate `<ready>` for each; all of them must pass",
        "<ready file='a'/><ready tcp='a:1'/>",
    ),
    (
        "<ready log='port ${port:a}'/>",
        "write a pattern for the value: `\\d+`",
        "<ready log='port \\d+'/>",
    ),
    (
        "<ready ros-topic='scan'/>",
        "write all of it, like `/robot/topic`",
        "<ready ros-topic='/robot/topic'/>",
    ),
    (
        "<ready ros-topic='/scan' min-rate='often'/>",
        "messages per second, like `5` or `0.5`",
        "<ready ros-topic='/scan' min-rate='0.5'/>",
    ),
    (
        "<alive http='https://a/up?b=1&amp;c'/>",
        "probe it with `command=\"curl -fsS https://a/up?b=1&amp;c\"`",
        "<alive command=\"curl -fsS https://a/up?b=1&amp;c\"/>",
    ),
    (
        "<stop signal='STOPP'/>",
        "valid are `SIGHUP`, `SIGINT`, `SIGQUIT`, `SIGKILL`, `SIGTERM`, `SIGUSR1`, `SIGUSR2` and the numbers 1 to 31",
        "<stop signal='SIGTERM'/>",
    ),
    (
        "<provide name='port' log='port \\d+'/>",
        "put the value in parentheses: `listening on port (\\d+)`",
        "<provide name='port' log='port (\\d+)'/>",
    ),
    (
        "<provide name='2nd' log='(.*)'/>",
        "a name is a letter, followed by letters, digits, `-` and `_`: at most 32 characters",
        "<provide name='second' log='(.*)'/>",
    ),
    (
        "<reset command='./sim' param='-v'/>",
        "write the arguments after the program, in `command`",
        "<reset command='./sim -v'/>",
    ),
    ("<reset command='./sim'>A.lua</reset>", "remove one of them", "<reset>A.lua</reset>"),
    ("<reset command='./sim'>A.lua</reset>", "remove one of them", "<reset command='./sim'/>"),
];

const SUITES: &[(&str, &str, &str)] = &[
    (
        "<fixture host='robot'>Plugin.py</fixture><test>A.lua</test>",
        "write a `<command>` that is started there",
        "<fixture type='process' host='robot'><command>sim</command></fixture><test>A.lua</test>",
    ),
    (
        "<fixture attach='true'>Plugin.py</fixture><test>A.lua</test>",
        "a plug-in that only watches needs no `attach`: it has a `check`, and no `setup`",
        "<fixture>Plugin.py</fixture><test>A.lua</test>",
    ),
    (
        "<fixture>Plugin.py<provide name='v' log='(.*)'/></fixture><test>A.lua</test>",
        "a plug-in provides its values itself, with `provide(name, value)`",
        "<fixture>Plugin.py<provide name='v'/></fixture><test>A.lua</test>",
    ),
    (
        "<fixture name='f'>Plugin.py</fixture><test param='${fixture:f.v}'>A.lua</test>",
        "declare it with `<provide name=\"v\" …/>`",
        "<fixture name='f'>Plugin.py<provide name=\"v\"/></fixture>\
         <test param='${fixture:f.v}'>A.lua</test>",
    ),
    (
        "<fixture name='f'>Plugin.py<provide name='port'/></fixture>\
         <test param='${fixture:f.prot}'>A.lua</test>",
        "did you mean `port`?",
        "<fixture name='f'>Plugin.py<provide name='port'/></fixture>\
         <test param='${fixture:f.port}'>A.lua</test>",
    ),
    (
        "<env name='V' value='${fixture:f.v}'/><fixture name='f'>Plugin.py<provide name='v'/>\
         </fixture><test>A.lua</test>",
        "write it in the tests and hooks that need it",
        "<fixture name='f'>Plugin.py<provide name='v'/></fixture>\
         <test>A.lua<env name='V' value='${fixture:f.v}'/></test>",
    ),
];
