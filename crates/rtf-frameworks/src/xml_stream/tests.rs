use super::*;

/// The events of a document in pieces of this size, and its error.
fn read(document: &[u8], piece: usize) -> (Vec<String>, Option<String>) {
    let (mut stream, mut events) = (XmlStream::default(), Vec::new());
    let error = document.chunks(piece).find_map(|piece| stream.feed(piece, &mut events).err());
    let shown = |event: &XmlEvent| match event {
        XmlEvent::Start { name, attributes } => {
            let shown: Vec<String> =
                attributes.0.iter().map(|(name, value)| format!(" {name}={value}")).collect();
            format!("<{name}{}", shown.concat())
        }
        XmlEvent::End { name, text } => format!("{text}>{name}"),
    };
    (events.iter().map(shown).collect(), error.map(|garbage| garbage.0))
}

const DOCUMENT: &str = "<?xml version=\"1.0\"?>\n<!-- a > comment -->\n<run name='a&gt;\"b>'>\n\
    <case/>a&lt;&#252;<![CDATA[<x>]]]]><![CDATA[>]]>\u{fc} b<case name=\"&#10;\">c</case>d</run>\n";

#[test]
fn a_document_has_the_same_events_in_pieces_of_any_size() {
    let expected = [
        "<run name=a>\"b>",
        "<case",
        ">case",
        "<case name=\n",
        "c>case",
        "\na<\u{fc}<x>]]>\u{fc} bd>run",
    ];
    for piece in 1..=DOCUMENT.len() {
        let (events, error) = read(DOCUMENT.as_bytes(), piece);
        assert_eq!(error, None, "pieces of {piece} bytes");
        let texts: Vec<&str> = events.iter().map(|event| event.trim_start_matches(' ')).collect();
        assert_eq!(texts, expected, "pieces of {piece} bytes");
    }
}

#[test]
fn marks_comments_and_references_do_not_depend_on_the_pieces() {
    let cases: [(&str, &[&str], bool); 5] = [
        ("\u{feff}<run>\u{feff}a</run>", &["<run", "\u{feff}a>run"], true),
        ("<run>b\u{feff}<!-- c -->\u{feff}</run>", &["<run", "b\u{feff}\u{feff}>run"], true),
        ("<run/>\n<!-- c --> <?end?>", &["<run", ">run"], true),
        ("<run/>\u{feff}", &["<run", ">run"], false),
        ("&#10;<run/>", &[], false),
    ];
    for (document, expected, is_good) in cases {
        for piece in 1..=document.len() {
            let (events, error) = read(document.as_bytes(), piece);
            assert_eq!(events, expected, "{document:?} in pieces of {piece}");
            assert_eq!(error.is_none(), is_good, "{document:?} in pieces of {piece}: {error:?}");
        }
    }
}

#[test]
fn an_element_is_reported_as_soon_as_its_tag_is_complete() {
    let (mut stream, mut events) = (XmlStream::default(), Vec::new());
    stream.feed(b"<run><case na", &mut events).expect("good");
    assert_eq!(events.len(), 1);
    stream.feed(b"me='x'>text", &mut events).expect("good");
    assert_eq!(events.len(), 2);
    assert!(!stream.is_complete());
    stream.feed(b"</case></run>", &mut events).expect("good");
    assert_eq!(events.len(), 4);
    assert!(stream.is_complete());
}

#[test]
fn garbage_is_an_error_with_its_line() {
    let cases: [(&str, usize, &str); 9] = [
        ("Hello, arm.\n", 0, "line 1 of the XML report: `Hello, arm.`"),
        ("\n\n  Hello", 0, "line 3 of the XML report: `Hello`"),
        ("<run>\n<case>\n</run>\n", 2, "line 3 of the XML report: `</run>`"),
        ("<run/>\nlate\n", 2, "line 2 of the XML report: `late`"),
        ("<run/>\n<run/>", 2, "line 2 of the XML report: `<run/>`"),
        ("<run>\n &nothing; </run>", 1, "line 2 of the XML report: `&nothing; </run>`"),
        ("<run>\n<case name=3/></run>", 1, "line 2 of the XML report: `<case name=3/></run>`"),
        ("</run>", 0, "line 1 of the XML report: `</run>`"),
        ("<run>\n<>", 1, "line 2 of the XML report: `<>`"),
    ];
    for (document, events, message) in cases {
        for piece in [1, 5, 1000] {
            let (before, error) = read(document.as_bytes(), piece);
            let error = error.unwrap_or_default();
            assert_eq!(before.len(), events, "{document:?} in pieces of {piece}: {error}");
            let start = message.trim_end_matches('`');
            let shown = error.trim_end_matches('`');
            // A piece may end within the bad line.
            assert!(start.starts_with(shown) && shown.contains("report: `"), "{error} {message}");
        }
    }
}

#[test]
fn bytes_that_are_no_utf8_are_replaced() {
    let (events, error) = read(b"<run>\xe9</run>", 3);
    assert_eq!((events[1].as_str(), error), ("\u{fffd}>run", None));
}

#[test]
fn an_endless_text_is_an_error() {
    let (mut stream, mut events) = (XmlStream::default(), Vec::new());
    stream.feed(b"<run>\n", &mut events).expect("good");
    let error = stream.feed(&vec![b'a'; MAX_TOKEN_BYTES + 1], &mut events).unwrap_err();
    assert_eq!(error.0, "line 1: a tag or text is too long");
}
