//! Hints about the XML, `<suite>`, and the elements and values of all others.

use super::Table;

pub const TABLES: &[Table] = &[
    ("{}", FILES),
    ("<suite {}><test>A.lua</test></suite>", ATTRIBUTES),
    ("<suite>{}<test>A.lua</test></suite>", ELEMENTS),
    (
        "<suite isolate='network'><fault name='f' kind='network' {}/><test>A.lua</test></suite>",
        NETWORK,
    ),
];

const FILES: &[(&str, &str, &str)] = &[
    (
        "<suite><test slots='4'>A.lua</test><test name='b'>A.lua</test></suite>",
        "give the other tests a suite of their own",
        "<suite><test slots='4'>A.lua</test></suite>\n== t.xml\n\
         <suite name='t'><test>A.lua</test></suite>\n== command line\ns.xml\nt.xml",
    ),
    (
        "<suite timeout='9s'><test slots='4'>A.lua</test></suite>",
        "`timeout` of the test is the limit of each episode",
        "<suite><test slots='4' timeout='9s'>A.lua</test></suite>",
    ),
    (
        "<suite clock='ros'><fixture name='sim' type='process'><command>./sim</command></fixture>\
         <test slots='4' timeout='9s'>A.lua</test></suite>",
        "`max-time` limits an episode in simulated time",
        "<suite><fixture name='sim' type='process'><command>./sim</command></fixture>\
         <test slots='4' max-time='9s'>A.lua</test></suite>",
    ),
    (
        "<!DOCTYPE suite><suite><test>A.lua</test></suite>",
        "remove the `<!DOCTYPE …>`",
        "<suite><test>A.lua</test></suite>",
    ),
    (
        "<suite><!-- fast -- slow --><test>A.lua</test></suite>",
        "remove the dashes: other programs refuse the file",
        "<suite><!-- fast slow --><test>A.lua</test></suite>",
    ),
    (
        "<suite><test>A.lua</test></suite><suite><test>A.lua</test></suite>",
        "an XML file has one element that contains all others: for several suites, write several \
         files",
        "<suite><test>A.lua</test></suite>\n== t.xml\n<suite><test>A.lua</test></suite>\n\
         == command line\ns.xml\nt.xml",
    ),
    (
        "<suite><signal name='q'><command>./read</command></signal>\
         <monitor name='m'>0 <q and q > 0</monitor><test>A.lua</test></suite>",
        "a `<` that begins no element is written `&lt;`",
        "<suite><signal name='q'><command>./read</command></signal>\
         <monitor name='m'>0 &lt;q and q > 0</monitor><test>A.lua</test></suite>",
    ),
    (
        "<suite><test name=a>A.lua</test></suite>",
        "an attribute has a value in quotes: `name=\"value\"`",
        "<suite><test name=\"a\">A.lua</test></suite>",
    ),
    (
        "<suite><test critical>A.lua</test></suite>",
        "an attribute has a value in quotes: `name=\"value\"`",
        "<suite><test critical=\"true\">A.lua</test></suite>",
    ),
    (
        "<suite name='a'requires='b'><test>A.lua</test></suite>",
        "a blank separates attributes; a quote in a value is written `&quot;` or `&apos;`",
        "<suite name='a' requires='b'><test>A.lua</test></suite>",
    ),
    (
        "<suite name='Ann's'><test>A.lua</test></suite>",
        "a blank separates attributes; a quote in a value is written `&quot;` or `&apos;`",
        "<suite name='Ann&apos;s'><test>A.lua</test></suite>",
    ),
    (
        "<?xml version='1.0' encoding='latin1'?><suite name='é'><test>A.lua</test></suite>",
        "save the file as UTF-8 and write `encoding=\"UTF-8\"`",
        "<?xml version='1.0' encoding=\"UTF-8\"?><suite name='é'><test>A.lua</test></suite>",
    ),
    (
        "<suite><test name='a'>A.lua</test><test name='a'>A.lua</test></suite>",
        "give one of them another `name`",
        "<suite><test name='b'>A.lua</test><test name='a'>A.lua</test></suite>",
    ),
    (
        "<suite><test>A.lua<hook on='end'><command>./sim</command></hook></test></suite>",
        "`<hook>` is written directly in `<suite>`",
        "<suite><test>A.lua</test><hook on='end'><command>./sim</command></hook></suite>",
    ),
    (
        "<suite><test>A.py</test></suite>\n== A.py\nTestCase\n== rtf.py\n",
        "give your module another name, or put the suite into another directory",
        "<suite><test>A.py</test></suite>\n== A.py\nTestCase\n== arm.py\n",
    ),
    (
        "<suite><test>A.py</test></suite>\n== A.py\nTestCase\n== rtf.py\n",
        "give your module another name, or put the suite into another directory",
        "<suite><test>../A.py</test></suite>\n== ../A.py\nTestCase\n== ../rtf.py\n",
    ),
    (
        "<suite><fault name='f' kind='network' delay='1s'/><test>A.lua</test></suite>",
        "write `isolate=\"network\"` in `<suite>`",
        "<suite isolate=\"network\"><fault name='f' kind='network' delay='1s'/><test>A.lua</test>\
         </suite>",
    ),
    (
        "<suite><signal name='q' file='r.mcap' topic='level'/><test>A.lua</test></suite>\n\
         == r.mcap\n",
        "write a topic, and the field of a message or the position in a bottle: `/level`, \
         `/joint_states.position[elbow]`, `/arm/state:o[3]`",
        "<suite><signal name='q' file='r.mcap' topic='/level'/><test>A.lua</test></suite>\n\
         == r.mcap\n",
    ),
];

const ATTRIBUTES: &[(&str, &str, &str)] = &[
    ("tset-timeout='1s'", "did you mean `test-timeout`?", "test-timeout='1s'"),
    ("clock='rso'", "did you mean `ros`?", "clock='ros'"),
    (
        "clock-backstop='3'",
        "`clock` is `ros`, `ros2`, `yarp` or `file` in a suite that needs one",
        "clock-backstop='3' clock='file'",
    ),
    (
        "test-timeout='soon'",
        "write it like `250ms`, `1.5s`, `2min` or `1h 30m`; a bare number is seconds",
        "test-timeout='1h 30m'",
    ),
    (
        "test-timeout='soon'",
        "write it like `250ms`, `1.5s`, `2min` or `1h 30m`; a bare number is seconds",
        "test-timeout='2'",
    ),
    ("requires='gpu/x'", "with `gpu/2`, two suites at a time can use a `gpu`", "requires='gpu/2'"),
    (
        "requires='robot@icub'",
        "letters, digits, `_`, `-`, `.` and `:`, for example `robot:icub`",
        "requires='robot:icub'",
    ),
];

const ELEMENTS: &[(&str, &str, &str)] = &[
    ("<tset>A.lua</tset>", "did you mean `test`?", "<test>A.lua</test>"),
    (
        "<hook on=''><command>./sim</command></hook>",
        "the triggers are `failure`, `collapse`, `timeout`, `interrupt`, `fixture-broken`, `end`",
        "<hook on='fixture-broken'><command>./sim</command></hook>",
    ),
    (
        "<hook on='fialure'><command>./sim</command></hook>",
        "did you mean `failure`?",
        "<hook on='failure'><command>./sim</command></hook>",
    ),
    (
        "<hook on='end'>A.lua<command>./sim</command></hook>",
        "write two hooks; both are run",
        "<hook on='end'>A.lua</hook><hook on='end'><command>./sim</command></hook>",
    ),
    (
        "<hook type='lua' on='end'><command>./sim</command></hook>",
        "a program has no type; remove the attribute",
        "<hook on='end'><command>./sim</command></hook>",
    ),
    (
        "<hook param='--fast' on='end'><command>./sim</command></hook>",
        "write the arguments after the program, in `<command>`",
        "<hook on='end'><command>./sim --fast</command></hook>",
    ),
    (
        "<hook type='process' on='end'>sim</hook>",
        "a program is written as `<command>`, without a `type`",
        "<hook on='end'><command>./sim</command></hook>",
    ),
    (
        "<hook type='tap' on='end'>sim</hook>",
        "write a program as `<command>`, without a `type`",
        "<hook on='end'><command>./sim</command></hook>",
    ),
    (
        "<signal name='q' ros2='/odom'/>",
        "write a topic and a field: `/joint_states.position[elbow]`, `/odom.twist.twist.linear.x`",
        "<signal name='q' ros2='/odom.twist.twist.linear.x'/>",
    ),
    (
        "<signal name='q' yarp='/imu:o'/>",
        "write a port and the position of a value in its bottle: `/arm/state:o[3]`, `/imu:o[0][2]`",
        "<signal name='q' yarp='/imu:o[0][2]'/>",
    ),
    (
        "<signal name='the \"q\"'><command>./read</command></signal>",
        "a name has no quotes and no control characters",
        "<signal name='the q'><command>./read</command></signal>",
    ),
    (
        "<fixture type='process' name='faults'><command>./sim</command></fixture>\
         <fault name='f' kind='memory' size='1GB'/>",
        "give the fixture another `name`",
        "<fixture type='process' name='sim'><command>./sim</command></fixture>\
         <fault name='f' kind='memory' size='1GB'/>",
    ),
    (
        "<fault name='f' kind='memory' size='1 gigabyte'/>",
        "write it like `500MB`, `2GiB` or `64KiB`",
        "<fault name='f' kind='memory' size='2GiB'/>",
    ),
    (
        "<fault name='f' kind='memory' size='1GB' at='3s..1s'/>",
        "write it like `250ms` or `2s`, or `1s..3s` for a random time",
        "<fault name='f' kind='memory' size='1GB' at='1s..3s'/>",
    ),
];

const NETWORK: &[(&str, &str, &str)] = &[
    ("rate='fast'", "write it like `500kbit` or `10Mbit`, per second", "rate='10Mbit'"),
    (
        "delay='1ms' port='camera'",
        "write `8080` or `${port:camera}`",
        "delay='1ms' port='${port:camera}'",
    ),
    ("delay='1ms' port='camera'", "write `8080` or `${port:camera}`", "delay='1ms' port='8080'"),
];
