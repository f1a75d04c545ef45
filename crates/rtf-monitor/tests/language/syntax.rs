//! Valid and invalid texts.

use std::time::Duration;

use rtf_monitor::{Formula, ParseError};

fn error(text: &str) -> (ParseError, &str) {
    let error = Formula::parse(text).unwrap_err();
    let part = &text[error.range.clone()];
    (error, part)
}

#[test]
fn valid_formulas() {
    for text in [
        "x < 1",
        "always(target_reached -> eventually[0,0.5s](abs(q - goal) < 0.02))",
        "always[0, 10s] x >= -1.5e-3 and not y",
        "a until[100ms, 2min] b or c since[0,inf] d",
        "historically[0,5us] (once (x + 2 * y / 3 != -z)) -> true",
        "rise(moving) -> fall(brake)",
        "min(x, y, 2) == max(abs(x), -y)",
        "rate(x - y) <= 3rad/s",
        "\"worst lag\" < 5deg and 'joint[2]' > .5",
        "arm.q1 < 5%",
        "hold(mode) == 3",
        "eventually[0, 90] (x)",
        "größe < 1µm",
    ] {
        assert!(Formula::parse(text).is_ok(), "{text}: {:?}", Formula::parse(text));
    }
}

#[test]
fn signals_are_listed_once() {
    let formula = Formula::parse("q < 1 and abs(p - q) < hold(\"p\")").unwrap();
    let names: Vec<_> = formula.signals().iter().map(|signal| signal.name.as_str()).collect();
    assert_eq!(names, ["q", "p"]);
    assert_eq!(formula.signals()[1].range, 14..15);
}

#[test]
fn the_horizon_is_the_longest_sum_of_intervals() {
    let horizon = |text: &str| Formula::parse(text).unwrap().horizon();
    assert_eq!(horizon("x < 1"), Some(Duration::ZERO));
    assert_eq!(
        horizon("always[0,1s] (a or eventually[0,500ms] b)"),
        Some(Duration::from_millis(1500))
    );
    assert_eq!(horizon("once[0,1s] (a until[1s,2s] b)"), Some(Duration::from_secs(2)));
    assert_eq!(horizon("always[0,1s] a and historically b"), Some(Duration::from_secs(1)));
    assert_eq!(horizon("always x"), None);
    assert_eq!(horizon("a until[1s,inf] b"), None);
}

#[test]
fn invalid_formulas() {
    let cases = [
        ("", "", "the formula is empty"),
        ("  ", "", "the formula is empty"),
        ("x <", "", "the formula ends too early"),
        ("(x < 1", "(", "the closing `)` is missing"),
        ("x < 1)", ")", "unexpected `)`"),
        ("always[0,1s x", "x", "unexpected `x`, expected `]`"),
        (
            "always[2s,1s] x",
            "[2s,1s]",
            "the first bound of the interval is greater than the second",
        ),
        ("always[-1s,1s] x", "-", "a bound of an interval is not negative"),
        ("always[1s] x", "]", "an interval has two bounds"),
        ("always[0,1parsec] x", "1parsec", "unknown unit of time `parsec`"),
        ("always[0,9999999min] x", "9999999min", "longer than 366 days"),
        ("always[inf,inf] x", "[inf,inf]", "the first bound of an interval is infinite"),
        ("alway(x)", "alway", "unknown function or operator `alway`"),
        ("sqrt(x) < 1", "sqrt", "unknown function or operator `sqrt`"),
        ("abs(x, y) < 1", "abs(x, y)", "`abs` has one argument, found 2"),
        ("min(x) < 1", "min(x)", "`min` has at least two arguments, found 1"),
        ("abs < 1", "abs", "`abs` is a function"),
        ("x + 1", "x + 1", "expected a condition, found a number"),
        ("(x < 1) + 1 < 2", "x < 1", "expected a number, found a condition"),
        ("1 < x < 2", "<", "a comparison has two sides"),
        ("a until b until c", "until", "two `until` or `since` in a row"),
        ("a && b", "&&", "unexpected `&&`"),
        ("x = 1", "=", "unexpected `=`"),
        ("x < 1 y", "y", "unexpected `y`"),
        (
            "rate(rate(x)) < 1",
            "rate(x)",
            "the rate of `hold` or `rate` is zero between the samples",
        ),
        ("hold(x + 1) < 1", "x + 1", "`hold` has the name of a signal as its argument"),
        ("rise(x and once y)", "x and once y", "`rise` has no temporal operator inside"),
        ("x < 1e999", "1e999", "this number is too large or malformed"),
        ("x < 1.2.3", "1.2.", "malformed number"),
        ("'x < 1", "'", "the closing `'` is missing"),
        ("'' < 1", "''", "the name of a signal is empty"),
        ("x < €", "€", "unexpected `€`"),
        ("and x", "and", "unexpected `and`"),
    ];
    for (text, part, message) in cases {
        let (error, found) = error(text);
        assert_eq!((found, error.message.as_str()), (part, message), "{text}");
    }
}

#[test]
fn hints() {
    let hint = |text: &str| error(text).0.hint.unwrap_or_default();
    assert_eq!(hint("alway(x)"), "did you mean `always`?");
    assert_eq!(hint("a || b"), "write `or`");
    assert_eq!(hint("1 < x < 2"), "write `1 < x and x < 2`");
    assert_eq!(hint("always[2s,1s] x"), "exchange the bounds");
    let unit = "a unit follows its number without a space, for example `5deg`";
    assert_eq!(hint("x < 5 deg"), unit);
    assert_eq!(hint("always[0, 1 s] x"), unit);
}

#[test]
fn limits() {
    let message = |text: &str| error(text).0.message;
    assert!(message(&"x".repeat(10_000_000)).contains("more than 65536"));
    assert_eq!(message(&"(".repeat(10_000)), "nested more than 64 levels deep");
    assert_eq!(message(&"not ".repeat(10_000)), "nested more than 64 levels deep");
    assert_eq!(message(&format!("{}x < 1", "-".repeat(10_000))), "nested more than 64 levels deep");
    assert_eq!(message(&"x->".repeat(10_000)), "nested more than 64 levels deep");
    let sum = format!("{}x < 1", "x+".repeat(10_000));
    assert!(message(&sum).contains("more than 1000 operators"));
    let deep = format!("{}x < 1{}", "(".repeat(60), ")".repeat(60));
    assert!(Formula::parse(&deep).is_ok());
    let long = format!("{}x < 1", "x+".repeat(490));
    assert!(Formula::parse(&long).is_ok());
}

#[test]
fn any_text_is_parsed_or_rejected() {
    let parts = [
        "always", "[0,1s]", "(", ")", "x", "<", "1", "not", "and", "until", "-", ",", "é", "5deg",
        "'", "rate", "[",
    ];
    let mut state = 1_u64;
    for _ in 0..20_000 {
        let mut text = String::new();
        for _ in 0..12 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            text += parts[(state >> 33) as usize % parts.len()];
            text += if state >> 63 == 0 { " " } else { "" };
        }
        if let Err(error) = Formula::parse(&text) {
            assert!(text.get(error.range.clone()).is_some(), "{text}: {error:?}");
        }
    }
}
