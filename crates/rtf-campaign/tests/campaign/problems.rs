//! Each problem has its position, and all are reported at once.

use std::fs;
use std::path::Path;

use crate::{CLAIM, read};

/// The line, the column, the message and the hint of each problem.
fn problems_in(text: &str, dir: &Path) -> String {
    let (list, problems) = read(&text.replace("CLAIM", CLAIM), dir);
    assert!(list.is_none(), "accepted");
    let mut lines = String::new();
    for problem in problems {
        let label = problem.labels.first().expect("a position");
        lines += &format!("{}:{} {}: {}", label.line, label.column, problem.code, problem.message);
        lines += &problem.hint.map(|hint| format!(" ({hint})")).unwrap_or_default();
        lines.push('\n');
    }
    lines
}

fn problems(text: &str) -> String {
    problems_in(text, Path::new("."))
}

#[test]
fn all_problems_of_a_file() {
    insta::assert_snapshot!(problems(r#"<campaign episodes="many" sed="3">
  <parameter name="a" distribution="unifrom" low="0" high="1"/>
  <parameter name="b" distribution="uniform" low="1" high="0"/>
  <parameter name="c" distribution="normal" mean="x" deviation="-1"/>
  <parameter name="d d" distribution="grid" values="1 1"/>
  <parameter name="e" distribution="sobol" low="0" mean="1"/>
  <parameter name="f" distribution="choice" low="0"/>
  <parameter name="g" distribution="latin-hypercube"/>
  <parameter distribution="file" name="h"/>
  <constraint require="a + * b > 1"/>
  <claim require="rate > 0.9" confidence="0.4"/>
  <stop rule="sprt" low="0.9" high="0.8" alpha="0.5"/>
  <stop rule="fixed" alpha="1"/>
</campaign>"#), @r#"
    1:27 unknown-attribute: unknown attribute `sed` (did you mean `seed`?)
    1:1 incomplete: `<campaign>` needs the attribute `suite`
    2:37 invalid-value: `distribution` has to be `grid` or `file` or `choice` or `uniform` or `normal` or `latin-hypercube` or `sobol`: `unifrom` (did you mean `uniform`?)
    3:60 invalid-value: `high` has to be greater than `low`, 1: `0`
    4:51 invalid-value: `mean` is not a number like `0.5` or `1e-3`: `x`
    4:65 invalid-value: `deviation` has to be above 0: `-1`
    5:20 invalid-value: `name` is not the name of a parameter: `d d` (letters, digits, `-` and `_`, a letter first)
    5:55 invalid-value: the value `1` occurs twice
    6:58 conflicting-attributes: a `<parameter>` has one distribution (`low` and `high`, `mean` and `deviation`, or `values`)
    7:45 unknown-attribute: unknown attribute `low`
    7:3 incomplete: `<parameter>` needs the attribute `values`
    8:3 incomplete: `<parameter>` needs the attributes `low` and `high`, `mean` and `deviation`, or `values`
    9:34 unknown-attribute: unknown attribute `name`
    9:3 incomplete: `<parameter>` needs the attribute `file`
    10:28 invalid-value: `require` is not a comparison: no number or parameter at `*` (write it like `payload + 0.5 * reach <= 2` (`<` in XML: `&lt;`))
    11:43 invalid-value: `confidence` has to be above 0.5: `0.4`
    11:19 invalid-value: `require` is not a claim: `rate > 0.9` (write it like `rate >= 0.95`, with a rate between 0 and 1)
    12:49 invalid-value: `alpha` has to be between 0 and 0.5, both excluded: `0.5`
    12:3 incomplete: `<stop>` needs the attribute `beta`
    13:3 repeated-element: `<stop>` twice in one campaign
    13:22 unknown-attribute: unknown attribute `alpha`
    1:21 invalid-value: `episodes` is not a whole number from 1 to 1000000: `many`
    "#);
}

#[test]
fn the_root() {
    insta::assert_snapshot!(problems("<suite/>"), @r#"1:1 not-a-campaign: `campaign.xml` is not a campaign: its first element is `<suite>`"#);
    insta::assert_snapshot!(problems("<campaign suite='s.xml'>"), @r#"1:25 malformed-xml: malformed XML: the file ends before its first element is closed"#);
    insta::assert_snapshot!(problems("<campaign suite='s.xml'/>"), @r#"1:1 incomplete: `<campaign>` needs a `<claim>`: `<claim require="rate >= 0.95" confidence="0.95"/>`"#);
}

#[test]
fn constraints() {
    for (text, expected) in [
        ("a", "it ends too early"),
        ("a >", "it ends too early"),
        ("a > 1 1", "unexpected `1`"),
        ("(a > 1", "a `)` is missing at `>`"),
        ("a = 1", "no comparison at `=`"),
        ("a > 1e", "no number or parameter at `1`"),
        ("a > é", "no number or parameter at `é`"),
    ] {
        let found = problems(&format!(
            "<campaign suite='s.xml' episodes='2'>CLAIM\n<constraint require='{text}'/></campaign>"
        ));
        assert!(found.contains(expected), "{text}: {found}");
        assert!(found.starts_with("2:"), "{found}");
    }
    let deep = format!("{}1{} > 0", "(".repeat(80), ")".repeat(80));
    let text = format!(
        "<campaign suite='s.xml' episodes='2'>CLAIM<constraint require='{deep}'/></campaign>"
    );
    assert!(problems(&text).contains("nested too deeply"));
    // A longer chain once overflowed the stack.
    let long = ["a"; 300_000].join("+") + " > 1";
    let text = format!(
        "<campaign suite='s.xml' episodes='2'>CLAIM<constraint require='{long}'/></campaign>"
    );
    assert!(problems(&text).contains("more than 1000 operations"));
}

#[test]
fn parameters_of_constraints() {
    insta::assert_snapshot!(problems(r#"<campaign suite="s.xml" episodes="4">
  <parameter name="a" distribution="uniform" low="0" high="1"/>
  <parameter name="surface" distribution="choice" values="1 wood"/>
  <constraint require="a-b > surface + c"/>
  CLAIM
</campaign>"#), @r#"
    4:24 unknown-parameter: the campaign has no parameter `a-b` (a `-` after a letter belongs to the name: write `a - b` for a difference)
    4:30 not-a-number: `surface` has the value `wood`, which is not a number
    4:40 unknown-parameter: the campaign has no parameter `c`
    "#);
}

#[test]
fn names_and_sizes() {
    insta::assert_snapshot!(problems(r#"<campaign suite="s.xml" episodes="4">
  <parameter name="a-b" distribution="uniform" low="0" high="1"/>
  <parameter name="a_b" distribution="uniform" low="0" high="1"/>
  <parameter name="a-b" distribution="uniform" low="0" high="1"/>
  CLAIM
</campaign>"#), @r#"
    3:20 duplicate-name: the parameters `a-b` and `a_b` would both be in `RTF_PARAM_A_B`
    4:20 duplicate-name: the parameter `a-b` occurs twice
    "#);
    let values: Vec<String> = (0..1001).map(|value| value.to_string()).collect();
    let grid = |name: &str| {
        format!("<parameter name='{name}' distribution='grid' values='{}'/>", values.join(" "))
    };
    insta::assert_snapshot!(
        problems(&format!("<campaign suite='s.xml'>{}{}CLAIM</campaign>", grid("a"), grid("b"))),
        @r#"1:1 too-many-combinations: the campaign has more than 1000000 combinations (sample some parameters: `distribution="choice"`)"#
    );
    let sobol: String = (0..65)
        .map(|n| format!("<parameter name='p{n}' distribution='sobol' low='0' high='1'/>"))
        .collect();
    let text = format!("<campaign suite='s.xml' episodes='2'>{sobol}CLAIM</campaign>");
    assert!(problems(&text).contains("more than 64 parameters are `sobol`"));
}

#[test]
fn constraints_that_hardly_any_candidate_meets() {
    insta::assert_snapshot!(problems(r#"<campaign suite="s.xml" episodes="2">
  <parameter name="a" distribution="uniform" low="0" high="1"/>
  <constraint require="a > 2"/>
  CLAIM
</campaign>"#), @r#"3:24 narrow-constraints: only 0 of 2000 candidates meet the constraints (choose parameters so that more than one of 1000 meets them)"#);
    insta::assert_snapshot!(problems(r#"<campaign suite="s.xml">
  <parameter name="a" distribution="grid" values="1 2"/>
  <constraint require="a / 0 - a / 0 != 1"/>
  CLAIM
</campaign>"#), @r#"3:24 narrow-constraints: only 0 of 2 candidates meet the constraints (choose parameters so that more than one of 1000 meets them)"#);
}

#[test]
fn rules_that_do_not_fit() {
    insta::assert_snapshot!(problems(r#"<campaign suite="s.xml" episodes="4">
  <parameter name="a" distribution="sobol" low="0" high="1"/>
  <claim require="rate >= 0.8" confidence="0.9"/>
  <stop rule="sprt" low="0.9" high="0.95" alpha="0.05" beta="0.05"/>
</campaign>"#), @r#"
    3:44 conflicting-attributes: `confidence` has no effect with `rule="sprt"` (`alpha` and `beta` are the error rates)
    3:19 invalid-value: the claimed rate is not between `low`, 0.9, and `high`, 0.95
    2:20 dependent-episodes: a sequential stopping rule needs independent episodes (use `choice`, `uniform` or `normal`, or `<stop rule="fixed"/>`)
    "#);
    insta::assert_snapshot!(problems(r#"<campaign suite="s.xml">
  <parameter name="a" distribution="uniform" low="0" high="1"/>
  <claim require="rate >= 0.8"/>
</campaign>"#), @r#"
    3:19 incomplete: the claim needs a confidence (add `confidence="0.95"` to `<claim>`)
    1:1 incomplete: `<campaign>` needs the attribute `episodes`
    "#);
}

#[test]
fn files() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("poses.csv"), "x,y\n1,2\n1\n").unwrap();
    let text = r#"<campaign suite="s.xml">
  <parameter distribution="file" file="poses.csv"/>
  <parameter distribution="file" file="missing.csv"/>
  CLAIM
</campaign>"#;
    insta::assert_snapshot!(problems_in(text, dir.path()), @r#"
    3:1 ragged-csv: a row with 1 value, expected 2
    3:40 no-such-file: there is no file `missing.csv`
    "#);
}

#[test]
fn versions() {
    insta::assert_snapshot!(problems(r#"<campaign suite="s.xml" episodes="4">
  <parameter name="policy" distribution="grid" values="a b"/>
  <versions parameter="po licy" values="act act" blinded="yes"/>
  <claim require="rate >= 0.9" confidence="0.9"/>
  <stop rule="confidence-sequence"/>
  <versions values="old" blinded="true"/>
</campaign>"#), @r#"
    3:24 invalid-value: `parameter` is not the name of a parameter: `po licy` (letters, digits, `-` and `_`, a letter first)
    3:59 invalid-value: `blinded` has to be `true` or `false`: `yes`
    3:45 invalid-value: the value `act` occurs twice
    6:3 repeated-element: `<versions>` twice in one campaign
    6:3 incomplete: `<versions>` needs the attribute `parameter`
    6:21 invalid-value: `values` has only one version: `old` (the first version is compared with the others: `values="old new"`)
    4:3 conflicting-elements: `<claim>` in a campaign with `<versions>` (the comparison of the versions is the result: leave `<claim>` out)
    5:3 conflicting-elements: `<stop>` in a campaign with `<versions>` (versions are compared after a fixed number of blocks: leave `<stop>` out)
    2:20 dependent-episodes: a sequential stopping rule needs independent episodes (use `choice`, `uniform` or `normal`, or `<stop rule="fixed"/>`)
    "#);
    insta::assert_snapshot!(problems(r#"<campaign suite="s.xml" episodes="4">
  <parameter name="po-licy" distribution="choice" values="a b"/>
  <versions parameter="po_licy" values="v1 version2" blinded="false"/>
</campaign>"#), @"3:24 duplicate-name: the parameters `po-licy` and `po_licy` would both be in `RTF_PARAM_PO_LICY`");
    insta::assert_snapshot!(problems(r#"<campaign suite="s.xml" episodes="4">
  <versions parameter="policy" values="v1 version2" blinded="true"/>
</campaign>"#), @"2:40 invalid-value: `values` has a version with fewer than 3 characters: `v1` (it is replaced in everything that is shown, also in other words: choose a longer one, or leave `blinded` out)");
    insta::assert_snapshot!(problems(r#"<campaign suite="s.xml" episodes="500000">
  <versions parameter="policy" values="a b c"/>
</campaign>"#), @"2:3 too-many-trials: 500000 blocks of 3 versions are more than 1000000 trials (choose fewer `episodes`, or fewer versions)");
    insta::assert_snapshot!(problems(r#"<campaign suite="s.xml" episodes="4">
  <constraint require="policy > 1"/>
  <versions parameter="policy" values="1 2"/>
</campaign>"#), @"2:24 unknown-parameter: the campaign has no parameter `policy`");
    insta::assert_snapshot!(problems(r#"<campaign suite="s.xml"><versions parameter="p" values="1 2"/></campaign>"#), @"1:1 incomplete: `<campaign>` needs the attribute `episodes`");
}
