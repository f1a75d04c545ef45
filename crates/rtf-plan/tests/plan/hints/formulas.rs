//! Hints about the formulas of monitors.

use super::Table;

pub const TABLES: &[Table] = &[
    (
        "<suite><signals><command>./read</command><signal name='q' unit='rad'/><signal name='n'/>\
         <signal name='joint[1]'/><signal name='until'/></signals>\
         <monitor name='m'>{}</monitor><test>A.lua</test></suite>",
        FORMULAS,
    ),
    ("<suite>{}<monitor name='m'>elbow > 5deg</monitor><test>A.lua</test></suite>", UNKNOWN),
];

const FORMULAS: &[(&str, &str, &str)] = &[
    ("n > 1 &amp;&amp; n", "write `and`", "n > 1 and n"),
    ("n > 1 &amp; n", "write `and`", "n > 1 and n"),
    ("n > 1 || n", "write `or`", "n > 1 or n"),
    ("n > 1 | n", "write `or`, or `abs(…)`", "n > 1 or n"),
    ("|n| > 1", "write `or`, or `abs(…)`", "abs(n) > 1"),
    ("!n", "write `not`", "not n"),
    ("~n", "write `not`", "not n"),
    ("n => n > 1", "write `->`", "n -> n > 1"),
    ("n = 1", "write `==`", "n == 1"),
    ("until > 1", "a signal with this name is written in quotes", "\"until\" > 1"),
    ("abs > 1", "write `abs(…)`, or a signal with this name in quotes", "abs(n) > 1"),
    ("always[1s] n", "write `[0, 0.5s]`", "always[0, 0.5s] n"),
    ("always[2s, 1s] n", "exchange the bounds", "always[1s, 2s] n"),
    (
        "eventually[-1s, 0] n",
        "`once`, `historically` and `since` look into the past",
        "once[0, 1s] n",
    ),
    ("always[0, 1h] n", "the units are `s`, `ms`, `us` and `min`", "always[0, 60min] n"),
    ("always[0, n] n", "write `0.5s`, `20ms`, `2min` or `inf`", "always[0, inf] n"),
    ("always[0, 1e9] n", "write `inf` for no bound", "always[0, inf] n"),
    ("rate(rate(n)) > 1", "use the rate of a signal that is a velocity", "rate(n) > 1"),
    ("alwys(n)", "did you mean `always`?", "always(n)"),
    ("joint[1] > 1", "a signal name with brackets is written in quotes", "\"joint[1]\" > 1"),
    ("n + 1", "compare it, for example with `> 0`", "n + 1 > 0"),
    ("n > 1)", "it closes nothing", "n > 1"),
    ("q > 5 deg", "a unit follows its number without a space, for example `5deg`", "q > 5deg"),
    ("n q > 1", "an operator is missing, for example `and`", "n and q > 1"),
    ("n until n until n", "use parentheses to state which belongs together", "(n until n) until n"),
    ("1 &lt; n &lt; 2", "write `1 < x and x < 2`", "1 &lt; n and n &lt; 2"),
    (
        "${param:f=}",
        "write a condition, for example `always(abs(error) < 0.02)`",
        "${param:f=always(abs(n) &lt; 0.02)}",
    ),
];

const UNKNOWN: &[(&str, &str, &str)] = &[
    (
        "",
        "declare it with `<signal>` in the suite",
        "<signal name='elbow' unit='rad'><command>./read</command></signal>",
    ),
    (
        "<signal name='elbw' unit='rad'><command>./read</command></signal>",
        "did you mean `elbw`?",
        "<signal name='elbow' unit='rad'><command>./read</command></signal>",
    ),
];
