//! Hints about files of limits and the models of robots.

use super::Table;

const AROUND: &str = "<suite><signals><command>./read</command><signal name='elbow.q' unit='rad'/>\
<signal name='elbow.dq' unit='rad/s'/></signals><envelope file='arm.limits.yaml'/>\
<test>A.lua</test></suite>\n== rtf.toml\n[profile.simulation]\n\
== arm.urdf\n<robot><joint name='elbow' type='revolute'><limit lower='-1' upper='1'/></joint>\
<joint name='wrist' type='revolute'><limit lower='-1' upper='1'/></joint></robot>\n\
== arm.limits.yaml\n{}";

const MODEL: &str = "<suite><signals><command>./read</command><signal name='elbow.q' unit='rad'/>\
</signals><envelope file='arm.limits.yaml'/><test>A.lua</test></suite>\n\
== arm.limits.yaml\nmodel: arm.xml\nsignals: {position: '{joint}.q'}\n== arm.xml\n{}";

const SUITE: &str = "{}\n== a.limits.yaml\nlimits: {far: {signal: q, max: 1}}\n\
== b.limits.yaml\nrobot: b\nlimits: {far: {signal: q, max: 1}}";

pub const TABLES: &[Table] = &[(AROUND, FILES), (MODEL, MODELS), (SUITE, SUITES)];

const FILES: &[(&str, &str, &str)] = &[
    (
        "limits: {}",
        "write limits, or `model` and `signals`",
        "limits: {far: {signal: elbow.q, max: 1}}",
    ),
    (
        "limits: {}",
        "write limits, or `model` and `signals`",
        "model: arm.urdf\nsignals: {position: '{joint}.q'}\nignore: [wrist]",
    ),
    (
        "joints: {elbow: {velocity: {max: 1}}}",
        "write `signal: …`, or `velocity` in `signals`",
        "joints: {elbow: {velocity: {signal: elbow.dq, max: 1}}}",
    ),
    (
        "joints: {elbow: {velocity: {max: 1}}}",
        "write `signal: …`, or `velocity` in `signals`",
        "joints: {elbow: {velocity: {max: 1}}}\nsignals: {velocity: '{joint}.dq'}",
    ),
    (
        "joints: {elbow: {velocity: {signal: elbow.dq}}}",
        "write `max: …`",
        "joints: {elbow: {velocity: {signal: elbow.dq, max: 1}}}",
    ),
    ("limits: {far: {max: 1}}", "write `signal: …`", "limits: {far: {max: 1, signal: elbow.q}}"),
    (
        "limits: {far: {signal: elbow.q}}",
        "write `min: …`, `max: …`, or both",
        "limits: {far: {signal: elbow.q, min: 0, max: 1}}",
    ),
    (
        "limits: {far: {signal: elbw.q, max: 1}}",
        "did you mean `elbow.q`?",
        "limits: {far: {signal: elbow.q, max: 1}}",
    ),
    (
        "limts: {}\nlimits: {far: {signal: elbow.q, max: 1}}",
        "did you mean `limits`?",
        "limits: {far: {signal: elbow.q, max: 1}}",
    ),
    (
        "model: arm.urdf\nsignals: {position: '{joint}.q'}\nignore: [wrist]\njoints: {elbw: {}}",
        "did you mean `elbow`?",
        "model: arm.urdf\nsignals: {position: '{joint}.q'}\nignore: [wrist]\njoints: {elbow: {}}",
    ),
    (
        "model: arm.urdf\nsignals: {position: '{joint}.q'}",
        "declare it with `<signal>` in the suite, or write its joint in `ignore`",
        "model: arm.urdf\nsignals: {position: '{joint}.q'}\nignore: [wrist]",
    ),
    (
        "limits: {far: {signal: elbow.q, max: 1}}\nprofiles: [simulation]",
        "write a part of the file for each profile",
        "limits: {far: {signal: elbow.q, max: 1}}\n\
         profiles: {simulation: {limits: {far: {max: 0.5}}}}",
    ),
    (
        "limits: {far: {signal: elbow.q, max: 1}}\nprofiles: {simulatoin: {factor: 0.5}}",
        "did you mean `simulation`?",
        "limits: {far: {signal: elbow.q, max: 1}}\nprofiles: {simulation: {factor: 0.5}}",
    ),
    (
        "limits: {far: {signal: elbow.q, max: &most 1}}",
        "write the value itself",
        "limits: {far: {signal: elbow.q, max: 1}}",
    ),
    (
        "limits: {far: {signal: elbow.q, max: 1}}\n---\nlimits: {}",
        "a file has one document",
        "limits: {far: {signal: elbow.q, max: 1}}",
    ),
];

const MODELS: &[(&str, &str, &str)] = &[
    (
        "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:include filename='b'/></robot>",
        "expand it: `xacro arm.urdf.xacro > arm.urdf`",
        "<robot><joint name='elbow' type='revolute'><limit lower='-1' upper='1'/></joint></robot>",
    ),
    (
        "<mujoco><worldbody><include file='a.xml'/></worldbody></mujoco>",
        "save the compiled model: `mujoco.mj_saveLastXML(file, model)`",
        "<mujoco><worldbody><joint name='elbow' range='-90 90'/></worldbody></mujoco>",
    ),
];

const SUITES: &[(&str, &str, &str)] = &[
    (
        "<suite><envelope file='a.limits.yaml'/><test>A.lua</test></suite>",
        "declare it with `<signal>` in the suite",
        "<suite><signal name='q'><command>./read</command></signal>\
         <envelope file='a.limits.yaml'/><test>A.lua</test></suite>",
    ),
    (
        "<suite><signal name='q'><command>./read</command></signal><monitor name='far'>q</monitor>\
         <envelope file='a.limits.yaml'/><test>A.lua</test></suite>",
        "give each file another `robot`, which precedes the names",
        "<suite><signal name='q'><command>./read</command></signal><monitor name='far'>q</monitor>\
         <envelope file='b.limits.yaml'/><test>A.lua</test></suite>",
    ),
];
