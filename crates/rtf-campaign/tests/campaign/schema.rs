//! The schema and the parser agree.

use std::io::Write as _;
use std::path::Path;
use std::process::Command;

use rtf_plan::suite::SourceText;

use crate::CLAIM;

/// Whether the schema accepts a text.
fn xmllint(text: &str) -> bool {
    let schema = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../spec/campaign.xsd");
    let mut file = tempfile::NamedTempFile::new().unwrap();
    file.write_all(text.as_bytes()).unwrap();
    let output = Command::new("xmllint")
        .args(["--noout", "--nonet", "--schema"])
        .args([&schema, file.path()])
        .output()
        .expect("xmllint, of the package libxml2-utils");
    // 3 and 4: the file is invalid; anything else: the schema or the call is wrong.
    assert!(matches!(output.status.code(), Some(0 | 3 | 4)), "{output:?}");
    output.status.success()
}

fn parser(text: &str) -> bool {
    rtf_campaign::parse(&SourceText::new("campaign.xml", text), &mut Vec::new()).is_some()
}

#[test]
fn both_accept_all_elements_and_attributes() {
    let text = r#"<campaign xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
        xsi:noNamespaceSchemaLocation="campaign.xsd"
        name="grasp" suite="grasp.xml" episodes="10" seed="7" repeats="0" budget="2h">
      <description>All of it</description>
      <parameter name="a" distribution="grid" values="1 2"/>
      <parameter distribution="file" file="poses.csv"/>
      <parameter name="b" distribution="choice" values="x y"/>
      <parameter name="c" distribution="uniform" low="-1e-3" high="0.5"/>
      <parameter name="d" distribution="normal" mean="0" deviation="2"/>
      <parameter name="e" distribution="sobol" low="0" high="1"/>
      <parameter name="f" distribution="latin-hypercube" mean="0" deviation="2"/>
      <parameter name="g" distribution="sobol" values="x y"/>
      <constraint require="a + c &lt;= 3"/>
      <claim require="rate >= 0.95" confidence="0.99"/>
      <stop rule="fixed"/>
    </campaign>"#;
    assert!(xmllint(text) && parser(text));
    let text = r#"<campaign suite="s.xml" episodes="10"><claim require="rate >= 0.95"/>
      <stop rule="sprt" low="0.9" high="0.97" alpha="0.05" beta="0.1"/></campaign>"#;
    assert!(xmllint(text) && parser(text));
    let text = r#"<campaign suite="s.xml" episodes="10">
      <versions parameter="policy" values="act diffusion" blinded="true"/></campaign>"#;
    assert!(xmllint(text) && parser(text));
}

#[test]
fn both_refuse_wrong_values() {
    for wrong in [
        r#"<campaign episodes="10">CLAIM</campaign>"#,
        r#"<campaign suite="s.xml" episodes="0">CLAIM</campaign>"#,
        r#"<campaign suite="s.xml" episodes="10" workers="2">CLAIM</campaign>"#,
        r#"<campaign suite="s.xml" episodes="10">CLAIM<reset/></campaign>"#,
        r#"<campaign suite="s.xml" episodes="10">CLAIM<stop rule="later"/></campaign>"#,
        r#"<campaign suite="s.xml" episodes="10">CLAIM<stop/></campaign>"#,
        r#"<campaign suite="s.xml" episodes="10">CLAIM<constraint/></campaign>"#,
        r#"<campaign suite="s.xml" episodes="10"><claim require="rate > 0.9" confidence="0.9"/></campaign>"#,
        r#"<campaign suite="s.xml" episodes="10"><claim require="rate >= 0.9" confidence="1"/></campaign>"#,
        r#"<campaign suite="s.xml">CLAIM<parameter name="a" distribution="poisson"/></campaign>"#,
        r#"<campaign suite="s.xml">CLAIM<parameter name="1" distribution="grid" values="1"/></campaign>"#,
        r#"<campaign suite="s.xml" episodes="9">CLAIM<parameter name="a" distribution="normal" mean="INF" deviation="1"/></campaign>"#,
        r#"<campaign suite="s.xml" episodes="9">CLAIM<parameter name="a" distribution="normal" mean="0" deviation="0"/></campaign>"#,
        r#"<campaign suite="s.xml" episodes="9"><versions values="old new"/></campaign>"#,
        r#"<campaign suite="s.xml" episodes="9"><versions parameter="p"/></campaign>"#,
        r#"<campaign suite="s.xml" episodes="9"><versions parameter="p" values="old new" blinded="yes"/></campaign>"#,
        r#"<suite/>"#,
    ] {
        let text = wrong.replace("CLAIM", CLAIM);
        assert!(!xmllint(&text), "the schema accepts {text}");
        assert!(!parser(&text), "the parser accepts {text}");
    }
}
