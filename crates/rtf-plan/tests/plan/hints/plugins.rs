//! Hints about tests: their plug-ins and programs, cases, matrices and marks.

use super::Table;

pub const TABLES: &[Table] = &[
    ("<suite><test {}</test></suite>", TESTS),
    ("<suite><test {}>arm_test</test></suite>\n== program arm_test\n", CASES),
    ("<suite>{}</suite>\n== Arm.py\nFixtureManager\n== Move.py\nTestCase\n== None.py\n", KINDS),
    ("{}", SELECTED),
    (
        "<suite><test>A.lua<matrix name='a' values='0 1 2 3'/><matrix name='b' values='0 1 2 3'/>\
         <matrix name='c' values='0 1 2 3'/><matrix name='d' values='0 1 2 3'/>\
         <matrix name='e' values='0 1 2 3'/><matrix name='f' values='0 1 2 3'/>\
         <matrix name='g' values='0 1 2 3'/>{}</test></suite>",
        COMBINATIONS,
    ),
    ("<suite><test>move</test></suite>\n== lib/move.so\n{}", SEARCHED),
];

const TESTS: &[(&str, &str, &str)] = &[
    ("type='lau'>A", "did you mean `lua`?", "type='lua'>A"),
    (">A", "there is `A.lua`; write `type=\"lua\"`", "type=\"lua\">A"),
    ("type='lua'>AA", "did you mean `A`?", "type='lua'>A"),
    (">AB.lua", "did you mean `A.lua`?", ">A.lua"),
    (
        ">lib/Amr.so</test></suite>\n== lib/libArm.so\n",
        "did you mean `lib/Arm.so`?",
        ">lib/Arm.so</test></suite>\n== lib/libArm.so\n",
    ),
    ("type='tap'>reed", "did you mean `read`?", "type='tap'>read"),
    (
        "type='tap'>tool</test></suite>\n== tool\n",
        "make it executable with `chmod +x tool`",
        "type='tap'>tool</test></suite>\n== program tool\n",
    ),
    ("issue='#1'>A.lua", "add `expect=\"failed\"`", "expect=\"failed\" issue='#1'>A.lua"),
    (
        "until='2027-01-31'>A.lua",
        "add `expect=\"failed\"`",
        "expect=\"failed\" until='2027-01-31'>A.lua",
    ),
    ("expect='passed'>A.lua", "without a mark, a test is expected to pass", ">A.lua"),
    ("expect='crash'>A.lua", "did you mean `crashed`?", "expect='crashed'>A.lua"),
    (
        "expect='failed' until='tomorrow'>A.lua",
        "write it like `2027-01-31`",
        "expect='failed' until='2027-01-31'>A.lua",
    ),
    (
        "expect='failed' until='2026-06-30'>A.lua",
        "fix the test, or choose a later `until`",
        "expect='failed' until='2026-12-31'>A.lua",
    ),
    (
        "expect='failed' until='2026-06-30'>A.lua",
        "fix the test, or choose a later `until`",
        ">A.lua",
    ),
    (
        ">A.lua<learn measurement='m' since='May'/>",
        "write it like `2027-01-31` or `2027-01-31T12:00:00Z`",
        ">A.lua<learn measurement='m' since='2027-01-31T12:00:00Z'/>",
    ),
    (
        ">A.lua<learn measurement='m' since='May'/>",
        "write it like `2027-01-31` or `2027-01-31T12:00:00Z`",
        ">A.lua<learn measurement='m' since='2027-01-31'/>",
    ),
    (
        ">A.lua<learn measurement='m' sigma='0'/>",
        "a number above 0, at most 1000",
        ">A.lua<learn measurement='m' sigma='1000'/>",
    ),
    (
        ">A.lua<matrix name='1st' values='1'/>",
        "letters, digits, `-` and `_`, a letter first",
        ">A.lua<matrix name='first' values='1'/>",
    ),
    (
        ">A.lua<matrix name='n' values-from='n.csv'/></test></suite>\n== n.csv\nn\n1\n",
        "the header row of the file names the parameters",
        ">A.lua<matrix values-from='n.csv'/></test></suite>\n== n.csv\nn\n1\n",
    ),
    (
        ">A.lua<matrix name='joint' values='1 2'/><matrix-exclude jiont='1'/>",
        "did you mean `joint`?",
        ">A.lua<matrix name='joint' values='1 2'/><matrix-exclude joint='1'/>",
    ),
    ("case-timeout='1s'>A.lua", "`timeout` limits the whole test", "timeout='1s'>A.lua"),
    ("isolation='case'>A.lua", "each test already has a separate process", ">A.lua"),
    ("fork='main'>A.lua", "`rtf run --fork` chooses how processes of plug-ins start", ">A.lua"),
];

const CASES: &[(&str, &str, &str)] = &[
    (
        "type='gtest' isolation='shared'",
        "all cases of the test run in one process without `isolation`",
        "type='gtest'",
    ),
    (
        "type='gtest' fork='main'",
        "without it, one process runs all cases, and nothing is forked",
        "type='gtest' fork='main' isolation='case'",
    ),
    (
        "type='tap' fork='main'",
        "their types are `gtest`, `catch2`, `doctest`, `boost`",
        "type='boost' fork='main'",
    ),
    (
        "type='program' cases='a'",
        "if the program can select tests, use `param`",
        "type='program' param='a'",
    ),
    (
        "type='program' isolation='case'",
        "if the program can select tests, use `param`",
        "type='program' param='a'",
    ),
    (
        "type='program' case-timeout='1s'",
        "`timeout` limits the whole test",
        "type='program' timeout='1s'",
    ),
    ("type='tap' case-timeout='1s'", "`timeout` limits the whole test", "type='tap' timeout='1s'"),
    ("type='gtest' cases='Amr.*'", "did you mean `Arm.*`?", "type='gtest' cases='Arm.*'"),
    (
        "type='gtest' cases='! \"Arm moves\"'",
        "quote a pattern together with its `!`: `\"!Arm moves\"`",
        "type='gtest' cases='\"!Arm moves\"'",
    ),
];

const KINDS: &[(&str, &str, &str)] = &[
    (
        "<test>Arm.py</test>",
        "in a suite it is written as `<fixture>`",
        "<fixture>Arm.py</fixture><test>A.lua</test>",
    ),
    (
        "<fixture>Move.py</fixture><test>A.lua</test>",
        "in a suite it is written as `<test>`",
        "<test>Move.py</test><test>A.lua</test>",
    ),
    (
        "<hook on='end'>Arm.py</hook><test>A.lua</test>",
        "a hook is a test plug-in that succeeds by passing",
        "<hook on='end'>Move.py</hook><test>A.lua</test>",
    ),
    (
        "<test>None.py</test>",
        "a test is a class that derives from `rtf.TestCase`",
        "<test>Some.py</test></suite>\n== Some.py\nclass Some(rtf.TestCase): …\n",
    ),
];

const SELECTED: &[(&str, &str, &str)] = &[
    (
        "<suite><test cases='first'>A.lua</test></suite>",
        "`rtf run SUITE::TEST/CASE` selects a case of a plug-in",
        "<suite><test>A.lua</test></suite>\n== command line\ns.xml::A/first\n",
    ),
    (
        "<suite><test type='tap'>tool</test></suite>\n== sub/s.xml\n\
         <suite><test type='tap'>my tool</test></suite>\n== sub/my tool\n\
         == command line\nsub/s.xml",
        "make it executable with `chmod +x '[ROOT]/cell/sub/my tool'`",
        "<suite><test type='tap'>tool</test></suite>\n== sub/s.xml\n\
         <suite><test type='tap'>my tool</test></suite>\n== program sub/my tool\n\
         == command line\nsub/s.xml",
    ),
];

const SEARCHED: &[(&str, &str, &str)] = &[(
    "",
    "`RTF_PLUGIN_PATH` adds directories to the search",
    "\n== environment\nRTF_PLUGIN_PATH=lib\n",
)];

const COMBINATIONS: &[(&str, &str, &str)] = &[(
    "",
    "a campaign samples a large space of parameters; in a suite, exclude combinations with \
     `<matrix-exclude>`",
    "<matrix-exclude a='0'/><matrix-exclude a='1'/><matrix-exclude a='2'/>\
     <matrix-exclude b='0'/><matrix-exclude b='1'/><matrix-exclude b='2'/>",
)];
