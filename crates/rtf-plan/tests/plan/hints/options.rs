//! Hints about the command line, `rtf.toml` and variables of the environment.

use super::Table;

pub const TABLES: &[Table] = &[
    ("<suite name='s'><test name='Grasp' tags='slow'>A.lua</test></suite>\n== {}", FILES),
    ("<suite name='s'><test name='Grasp'>A.lua</test></suite>\n== rtf.toml\n{}", CONFIG),
    (
        "<suite name='s'><test name='Grasp' tags='slow'>A.lua</test></suite>\n\
         == command line\n--filter {}",
        FILTERS,
    ),
    (
        "<suite><test param='--rate ${param:rate}'>A.lua</test></suite>\n\
         == rtf.toml\n[param]\nspeed = 1\n== {}",
        PARAMETERS,
    ),
    ("<suite><test name='arm' type='gtest'>sim</test></suite>\n== command line\n{}", LISTED),
    (
        "\n== a/s.xml\n<suite><test>../A.lua</test></suite>\n\
         == b/s.xml\n<suite><test>../A.lua</test></suite>\n{}",
        TWO,
    ),
    ("<suite><test>A.py</test></suite>\n== A.py\nTestCase\n== environment\nPATH=.\n{}", PYTHON),
];

const FILES: &[(&str, &str, &str)] = &[
    ("command line\ns", "did you mean `s.xml`?", "command line\ns.xml"),
    ("command line\nA", "did you mean `A.lua`?", "command line\nA.lua"),
    ("command line\nA.lua::first", "remove the `::`: `A.lua`", "command line\nA.lua"),
    ("command line\ns.xml::Gasp", "did you mean `Grasp`?", "command line\ns.xml::Grasp"),
    (
        "sub/dir/t.xml\n<suite><test>../../A.lua</test></suite>\n== command line\nsub",
        "`--recursive` also searches subdirectories",
        "sub/dir/t.xml\n<suite><test>../../A.lua</test></suite>\n== command line\nsub\n--recursive",
    ),
    (
        "command line\n--profile simulation",
        "define profiles in an `rtf.toml` next to the suites, or above them",
        "command line\n--profile simulation\n== rtf.toml\n[profile.simulation]\n",
    ),
    (
        "command line\n--profile simulation",
        "define profiles in an `rtf.toml` next to the suites, or above them",
        "command line\n--profile simulation\n== ../rtf.toml\n[profile.simulation]\n",
    ),
    (
        "rtf.toml\n[profile.real]\n== command line\n--profile reel",
        "did you mean `real`?",
        "rtf.toml\n[profile.real]\n== command line\n--profile real",
    ),
    (
        "rtf.toml\n[profile.real]\n[profile.simulation]\n== command line\n--profile test",
        "the profiles are `real`, `simulation`",
        "rtf.toml\n[profile.real]\n[profile.simulation]\n== command line\n--profile simulation",
    ),
];

const CONFIG: &[(&str, &str, &str)] = &[
    ("[timeouts]\nrnu = '1h'", "did you mean `timeouts.run`?", "[timeouts]\nrun = '1h'"),
    ("paralel = 1", "did you mean `parallel`?", "parallel = 1"),
    (
        "default-profile = 'real'",
        "a profile is a table `[profile.NAME]`",
        "default-profile = 'real'\n[profile.real]",
    ),
    (
        "[[quarantine]]\nissue = '#1'",
        "for example `filter = \"name(=Grasp)\"`",
        "[[quarantine]]\nfilter = \"name(=Grasp)\"\nissue = '#1'",
    ),
    (
        "[[quarantine]]\nfilter = 'case(=closes)'",
        "quarantine their test",
        "[[quarantine]]\nfilter = 'name(=Grasp)'",
    ),
    (
        "[[quarantine]]\nfilter = 'all()'\nisue = '#1'",
        "did you mean `issue`?",
        "[[quarantine]]\nfilter = 'all()'\nissue = '#1'",
    ),
];

const FILTERS: &[(&str, &str, &str)] = &[
    ("tga(slow)", "did you mean `tag`?", "tag(slow)"),
    ("tag(slwo)", "did you mean `slow`?", "tag(slow)"),
    ("", "for example `tag(slow)` or `name(/joint.*/)`", "tag(slow)"),
    ("all() & ", "for example `tag(slow)` or `name(/joint.*/)`", "all() & name(/G.*/)"),
    ("case(a) & case(b)", "use `|`", "case(a) | case(b)"),
    ("!case(a)", "select the other cases instead", "case(b)"),
    ("case(/a.*/)", "`case(~text)` selects cases that contain a text", "case(~a)"),
    (
        "case(a)\ns.xml::Grasp/b",
        "name the cases with `::`, or with a `case` filter, not with both",
        "case(a)\ns.xml",
    ),
    (
        "case(a)\ns.xml::Grasp/b",
        "name the cases with `::`, or with a `case` filter, not with both",
        "all()\ns.xml::Grasp/b",
    ),
];

/// The hint of a parameter without a value.
const RATE: &str = "write it under `[param]` in `rtf.toml`, give `--set rate=VALUE`, or a default: \
                    `${param:rate=VALUE}`";

const PARAMETERS: &[(&str, &str, &str)] = &[
    ("rtf.toml\n", RATE, "rtf.toml\n[param]\nrate = 100"),
    ("rtf.toml\n", RATE, "command line\n--set rate=100"),
    (
        "rtf.toml\n",
        RATE,
        "s.xml\n<suite><test param='--rate ${param:rate=100}'>A.lua</test></suite>",
    ),
    (
        "s.xml\n<suite><test param='--speed ${param:sped}'>A.lua</test></suite>",
        "did you mean `${param:speed}`?",
        "s.xml\n<suite><test param='--speed ${param:speed}'>A.lua</test></suite>",
    ),
];

const LISTED: &[(&str, &str, &str)] =
    &[("s.xml::arm/Arm.Mvoes", "did you mean `Arm.Moves`?", "s.xml::arm/Arm.Moves")];

/// The hint of a value that two files set.
const ONE_VALUE: &str = "run the suites one after the other, or set it in one file above both";

const TWO: &[(&str, &str, &str)] = &[
    (
        "== a/rtf.toml\nannotations = 'none'\n== b/rtf.toml\nannotations = 'github'\n== command line\na\nb",
        ONE_VALUE,
        "== rtf.toml\nannotations = 'none'\n== command line\na\nb",
    ),
    (
        "== a/rtf.toml\nannotations = 'none'\n== b/rtf.toml\nannotations = 'github'\n== command line\na\nb",
        ONE_VALUE,
        "== a/rtf.toml\nannotations = 'none'\n== b/rtf.toml\nannotations = 'github'\n== command line\na",
    ),
];

const PYTHON: &[(&str, &str, &str)] =
    &[("", "install it, or select another one in `RTF_PYTHON`", "RTF_PYTHON=./sim\n")];
