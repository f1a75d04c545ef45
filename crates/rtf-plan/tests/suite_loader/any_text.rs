//! The loader never panics, and every label lies within the text.

use proptest::prelude::*;
use rtf_plan::suite::{self, SourceText};

/// Texts that resemble suites.
fn suite_like() -> impl Strategy<Value = String> {
    let piece = prop::sample::select(vec![
        "<suite",
        "<test",
        "<fixture",
        "<hook",
        "</hook>",
        " on='end'",
        "<env",
        "<command>",
        "<ready",
        "</test>",
        "</suite>",
        "</fixture>",
        "</command>",
        " type='process'",
        " timeout='1s'",
        " tcp='a:1'",
        " log='['",
        " name='ä'",
        " value=''",
        ">",
        "/>",
        "<!-- -- -->",
        "<!--",
        "-->",
        "<![CDATA[",
        "]]>",
        "<?xml version='1.0'?>",
        "<!DOCTYPE",
        "&amp;",
        "&x;",
        "A.lua",
        "\n",
        "\r\n",
        " ",
        "\"",
        "'",
        "é",
        "\u{0}",
        " tags='a,b'",
        " depends='x'",
        " xmlns='u'",
        "x:",
        " xmlns:x='u'",
    ]);
    prop::collection::vec(piece, 0..60).prop_map(|pieces| pieces.concat())
}

/// Loads a text and checks that every label lies within it.
fn load_and_check(text: &str) {
    let source = SourceText::new("s.xml", text);
    let mut problems = Vec::new();
    let suite = suite::parse(&source, &mut problems);
    assert!(suite.is_some() || !problems.is_empty());
    for label in problems.iter().flat_map(|problem| &problem.labels) {
        let range = usize::try_from(label.start).unwrap()..usize::try_from(label.end).unwrap();
        assert!(text.get(range).is_some(), "{label:?}");
        assert!(label.line >= 1 && label.column >= 1);
    }
}

proptest! {
    #[test]
    fn no_text_makes_the_loader_panic(text in any::<String>()) {
        load_and_check(&text);
    }

    #[test]
    fn no_text_like_a_suite_makes_the_loader_panic(text in suite_like()) {
        load_and_check(&text);
        load_and_check(&format!("<suite>{text}</suite>"));
    }

    #[test]
    fn no_attribute_value_makes_the_loader_panic(
        name in "timeout|type|param|tags|name|repetition|depends|signal|on|leaks|restart-delay",
        value in "[^<&'\\p{Cc}]*",
    ) {
        load_and_check(&format!("<suite {name}='{value}'><test {name}='{value}'>A</test></suite>"));
        load_and_check(&format!("<suite><fixture type='process'><command>{}</command>\
            <ready log='{value}'/><ready command='{value}'/><ready http='{value}'/>\
            <stop signal='{value}'/></fixture><fixture {name}='{value}'>A</fixture>\
            <hook {name}='{value}'>A</hook><test>A</test></suite>", value.replace("]]>", "")));
    }
}
