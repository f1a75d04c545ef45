//! Splits a parameter string into arguments, as robot-testing-framework 2.x did.

/// Splits `param` at blanks and double quotes.
///
/// - Only the space character is a blank; a tab or a line break is part of its
///   argument. (XML turns those in an attribute into spaces, except `&#10;`.)
/// - The text between two double quotes is one argument. A quote also ends the
///   argument before it: `a"b c"d` is three arguments, `--from="a b.ini"` is two.
/// - An unclosed quote reaches to the end of the string.
/// - Two quotes on their own (`--name ""`) are an empty argument; 2.x dropped it.
/// - Single quotes, backslashes and `#` are ordinary characters: Windows paths,
///   regular expressions and colours pass unchanged.
#[must_use]
pub fn split_param(param: &str) -> Vec<String> {
    let mut arguments = Vec::new();
    let mut rest = param;
    let mut after_space = true;
    while let Some(first) = rest.chars().next() {
        if first == '"' {
            let body = &rest[1..];
            let (quoted, after) = body.split_once('"').unwrap_or((body, ""));
            let alone = after_space && after.chars().next().is_none_or(|next| next == ' ');
            if !quoted.is_empty() || (alone && body.starts_with('"')) {
                arguments.push(quoted.to_owned());
            }
            rest = after;
            after_space = false;
        } else if first == ' ' {
            rest = rest.trim_start_matches(' ');
            after_space = true;
        } else {
            let end = rest.find(['"', ' ']).unwrap_or(rest.len());
            arguments.push(rest[..end].to_owned());
            rest = &rest[end..];
            after_space = false;
        }
    }
    arguments
}

#[cfg(test)]
mod tests {
    use super::split_param;
    use proptest::prelude::*;

    fn split(param: &str) -> Vec<String> {
        split_param(param)
    }

    #[test]
    fn splits_as_the_predecessor_did() {
        assert_eq!(split("--from a.ini  --n 3 "), ["--from", "a.ini", "--n", "3"]);
        assert_eq!(split(r#"--from "a b.ini""#), ["--from", "a b.ini"]);
        assert_eq!(split(r#"a"b c"d"#), ["a", "b c", "d"]);
        assert_eq!(split(r#"--from="a b.ini""#), ["--from=", "a b.ini"]);
        assert_eq!(split(r#"open "to the end "#), ["open", "to the end "]);
        assert_eq!(split(r#""a""b""#), ["a", "b"]);
        assert_eq!(split("\" \" x\" \"y"), [" ", "x", " ", "y"]);
        assert_eq!(split(""), [""; 0]);
    }

    #[test]
    fn other_white_space_is_part_of_its_argument() {
        assert_eq!(split("a\tb\nc d\re"), ["a\tb\nc", "d\re"]);
        assert_eq!(split("a\u{a0}b \n c"), ["a\u{a0}b", "\n", "c"]);
    }

    /// Defect 8 of the predecessor: at most 128 arguments, written past an array.
    #[test]
    fn any_number_of_arguments() {
        assert_eq!(split(&"x ".repeat(1000)).len(), 1000);
    }

    #[test]
    fn other_special_characters_are_ordinary() {
        let param = r"C:\data\x #ff0000 'a b' $HOME %s \n";
        let expected = [r"C:\data\x", "#ff0000", "'a", "b'", "$HOME", "%s", r"\n"];
        assert_eq!(split(param), expected);
    }

    #[test]
    fn lone_quotes_are_an_empty_argument() {
        assert_eq!(split(r#"--name "" x"#), ["--name", "", "x"]);
        assert_eq!(split(r#"a""b"#), ["a", "b"]);
        assert_eq!(split("a \""), ["a"]);
    }

    proptest! {
        #[test]
        fn quoting_each_argument_gives_it_back(
            arguments in prop::collection::vec("[^\"]*", 0..20),
        ) {
            let quoted: Vec<_> = arguments.iter().map(|a| format!("\"{a}\"")).collect();
            prop_assert_eq!(split_param(&quoted.join(" ")), arguments);
        }

        #[test]
        fn no_character_but_space_and_quote_is_lost(param in any::<String>()) {
            let keep = |c: &char| *c != '"' && *c != ' ';
            let split: String = split_param(&param).concat();
            let kept: String = split.chars().filter(keep).collect();
            prop_assert_eq!(kept, param.chars().filter(keep).collect::<String>());
        }
    }
}
