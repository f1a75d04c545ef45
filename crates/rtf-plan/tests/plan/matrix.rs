//! Matrices are expanded into one test for each combination.

use insta::assert_snapshot;

use crate::bench::{Bench, names};

fn bench() -> Bench {
    let bench = Bench::new();
    bench.file("cell/Move.lua", "");
    bench
}

#[test]
fn each_combination_is_a_test() {
    let bench = bench();
    bench.file(
        "cell/s.xml",
        "<suite><test param='--joint ${param:joint} --at ${param:speed}'>Move.lua
           <env name='PLACE' value='j${param:joint}'/>
           <matrix name='joint' values='0 1'/><matrix name='speed' values='slow,fast'/>
           <matrix-exclude joint='1' speed='fast'/>
         </test><test>Move.lua</test></suite>",
    );
    let plan = bench.plan(&["s.xml"]);
    assert_eq!(
        names(&plan, 0),
        [
            "Move[joint=0,speed=slow]",
            "Move[joint=0,speed=fast]",
            "Move[joint=1,speed=slow]",
            "Move#2"
        ]
    );
    let test = &plan.suites[0].tests[2];
    assert_eq!(test.plugin.args, ["--joint", "1", "--at", "slow"]);
    let env: Vec<_> = test.env.iter().map(|(name, value)| format!("{name}={value}")).collect();
    assert_eq!(env, ["RTF_PARAM_JOINT=1", "RTF_PARAM_SPEED=slow", "PLACE=j1"]);
    let parameters: Vec<_> =
        test.parameters().iter().map(|it| format!("{}={}", it.name, it.value)).collect();
    assert_eq!(
        (parameters.join(" ").as_str(), test.matrix()),
        ("joint=1 speed=slow", Some("Move"))
    );
    assert!(plan.suites[0].tests[3].parameters().is_empty());
}

#[test]
fn a_matrix_takes_precedence_over_a_parameter_of_the_same_name() {
    let mut bench = bench();
    bench.options.config_request.params = vec![("joint".to_owned(), "9".to_owned())];
    let test = "<test param='${param:joint}'>Move.lua<matrix name='joint' values='0'/></test>";
    bench.file(
        "cell/s.xml",
        &format!("<suite>{test}<test param='${{param:joint}}'>Move.lua</test></suite>"),
    );
    let plan = bench.plan(&["s.xml"]);
    let args: Vec<_> = plan.suites[0].tests.iter().map(|test| test.plugin.param.as_str()).collect();
    assert_eq!(args, ["0", "9"]);
}

#[test]
fn a_file_names_its_parameters() {
    let bench = bench();
    bench.file("cell/poses.csv", "pose, x\n\n up,\"0, 5\"\ndown,\n");
    bench.file(
        "cell/s.xml",
        "<suite><test>Move.lua<matrix values-from='poses.csv'/>\
         <matrix name='joint' values='0 1'/></test></suite>",
    );
    let plan = bench.plan(&["s.xml"]);
    assert_eq!(
        names(&plan, 0),
        [
            "Move[pose=up,x=0, 5,joint=0]",
            "Move[pose=up,x=0, 5,joint=1]",
            "Move[pose=down,x=,joint=0]",
            "Move[pose=down,x=,joint=1]"
        ]
    );
}

fn of_matrix(matrix: &str) -> String {
    format!("<suite>\n<test>Move.lua\n{matrix}</test></suite>")
}

#[test]
fn problems_of_a_matrix_have_a_position() {
    let bench = bench();
    let problems = [
        "<matrix name='joint' values=' '/>",
        "<matrix name='joint'/>",
        "<matrix values='1'/>",
        "<matrix name='0' values='1'/>",
        "<matrix name='joint' values='0 1 0'/>",
        "<matrix name='joint' values='${param:x}'/>",
        "<matrix name='joint' values='0'/><matrix name='joint' values='1'/>",
        "<matrix name='a-b' values='0'/><matrix name='a_b' values='1'/>",
        "<matrix name='joint' values='0' step='1'/>",
        "<matrix name='joint' values-from='a.csv'/>",
        "<matrix name='joint' values='0'/><matrix-exclude joitn='0'/>",
        "<matrix name='joint' values='0'/><matrix-exclude/>",
        "<matrix name='joint' values='0'/><matrix-exclude joint='0'/>",
        "<matrix-exclude joint='0'/>",
        "<matrix values-from='none.csv'/>",
    ]
    .map(|matrix| bench.shown(&of_matrix(matrix)));
    assert_snapshot!(problems.concat(), @r#"
    empty-matrix: a `<matrix>` without values
      3:30
    incomplete: `<matrix>` needs the attribute `values`, or `values-from`
      3:1 <matrix
    incomplete: `<matrix>` needs the attribute `name`
      3:1 <matrix
    invalid-value: `name` is not the name of a parameter: `0`
      3:15 0
      hint: letters, digits, `-` and `_`, a letter first
    invalid-value: the value `0` occurs twice
      3:34 0
    invalid-value: a value of a matrix cannot contain a placeholder: `${param:x}`
      3:30 ${param:x}
    duplicate-name: the parameter `joint` occurs twice
      3:48 joint
      3:15 joint the first one
    duplicate-name: the parameters `a-b` and `a_b` would both be in `RTF_PARAM_A_B`
      3:46 a_b
      3:15 a-b the first one
    unknown-attribute: unknown attribute `step`
      3:33 step not known in `<matrix>`
      note: `<matrix>` can have the attributes `name`, `values`, `values-from`
    conflicting-attributes: a `<matrix>` has either `values-from`, or `name` and `values`
      3:15 joint
      hint: the header row of the file names the parameters
    unknown-param: the matrix has no parameter `joitn`
      3:50 joitn
      note: its parameters are `joint`
      hint: did you mean `joint`?
    incomplete: `<matrix-exclude>` needs at least one parameter: `<matrix-exclude joint="0"/>`
      3:34 <matrix-exclude
    empty-matrix: `<matrix-exclude>` excludes every combination of the matrix
      2:1 <test
    without-effect: `<matrix-exclude>` has no effect without `<matrix>`
      3:1 <matrix-exclude
    no-such-file: there is no file `none.csv`
      3:22 none.csv
    "#);
}

#[test]
fn problems_of_a_csv_file_point_into_it() {
    let bench = bench();
    let files = [
        "",
        "pose,x\n",
        "pose,0x\nup,1\n",
        "pose,pose\nup,1\n",
        "pose,x\nup,1\n\ndown\nleft,2,3\n",
        "pose,x\nup,1\nup,1\n",
        "pose,x\nup,\"1\n2\"\n",
    ];
    let shown = files.map(|text| {
        bench.file("cell/p.csv", text);
        bench.shown(&of_matrix("<matrix values-from='p.csv'/>"))
    });
    assert_snapshot!(shown.concat(), @r#"
    empty-matrix: `p.csv` has no row of values below its header
      3:22 p.csv
    empty-matrix: `p.csv` has no row of values below its header
      3:22 p.csv
    invalid-value: `0x` is not the name of a parameter
      1:1 pose,0x
    duplicate-name: the header names the parameter `pose` twice
      1:1 pose,pose
    ragged-csv: a row with 1 value, expected 2
      4:1 down
    ragged-csv: a row with 3 values, expected 2
      5:1 left,2,3
    invalid-value: the same values occur in two rows
      3:1 up,1
      2:1 up,1 the first one
    invalid-value: a value of a matrix contains a control character: "1\n2"
      2:1 up,"1
    "#);
    std::fs::write(bench.root.join("cell/p.csv"), b"pose\n\xff\n").unwrap();
    assert_snapshot!(bench.shown(&of_matrix("<matrix values-from='p.csv'/>")), @"
    encoding: `p.csv` is not encoded in UTF-8
      2:1 � this byte is not UTF-8
      hint: save the file as UTF-8
    ");
}

#[test]
fn too_many_combinations_are_an_error() {
    let bench = bench();
    let values = |count: u32| (0..count).map(|n| n.to_string()).collect::<Vec<_>>().join(" ");
    let matrix = |a: u32, b: u32| {
        let [a, b] = [a, b].map(values);
        of_matrix(&format!("<matrix name='a' values='{a}'/><matrix name='b' values='{b}'/>"))
    };
    bench.file("cell/s.xml", &matrix(100, 100));
    assert_eq!(bench.plan(&["s.xml"]).tests, 10_000);
    assert_snapshot!(bench.shown(&matrix(100, 101)), @"
    matrix-too-large: the matrix has 10100 combinations, more than 10000
      2:1 <test
      hint: a campaign samples a large space of parameters; in a suite, exclude combinations with `<matrix-exclude>`
    ");
    assert_snapshot!(bench.shown(&matrix(5000, 5000)), @"
    matrix-too-large: the matrix has 25000000 combinations before `<matrix-exclude>`, more than 1000000
      2:1 <test
      hint: a campaign samples a large space of parameters
    ");
}

#[test]
fn a_problem_of_the_test_is_reported_once() {
    let bench = bench();
    let suite = "<suite><test param='${param:unknown}'>Mvoe.lua<matrix name='a' values='0 1 2'/></test></suite>";
    assert_snapshot!(bench.shown(suite), @"
    unknown-param: the parameter `unknown` has no value
      1:39 Mvoe.lua needed here
      hint: write it under `[param]` in `rtf.toml`, give `--set unknown=VALUE`, or a default: `${param:unknown=VALUE}`
    no-such-plugin: there is no plug-in `Mvoe.lua` of type `lua`
      1:39 Mvoe.lua
      note: looked for `Mvoe.lua` in
      [ROOT]/cell
      [ROOT]/lib/rtf/plugins
      hint: did you mean `Move.lua`?
    ");
}
