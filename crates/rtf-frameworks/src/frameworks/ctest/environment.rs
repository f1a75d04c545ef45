//! The properties `ENVIRONMENT` and `ENVIRONMENT_MODIFICATION` of a test.

use std::collections::BTreeMap;

/// Changes of environment variables; `None` removes one.
pub type Changes = BTreeMap<String, Option<String>>;

/// Applies both properties to the environment of the process, of which `inherited` returns
/// variables.
///
/// # Errors
/// A modification is not valid; with its text.
pub fn changes(
    assignments: &[String],
    modifications: &[String],
    inherited: impl Fn(&str) -> Option<String>,
) -> Result<Changes, String> {
    let mut changes = Changes::new();
    for assignment in assignments {
        let (name, value) = assignment.split_once('=').unwrap_or((assignment, ""));
        changes.insert(name.to_owned(), Some(value.to_owned()));
    }
    let assigned = changes.clone();
    for text in modifications {
        let parsed = text.split_once('=').map(|(name, change)| {
            let (operation, value) = change.split_once(':').unwrap_or((change, ""));
            (name, operation, value)
        });
        let Some((name, operation, value)) = parsed else {
            return Err(format!(
                "`{text}` in ENVIRONMENT_MODIFICATION is not `NAME=OPERATION:VALUE`"
            ));
        };
        let current = || match changes.get(name) {
            Some(value) => value.clone().unwrap_or_default(),
            None => inherited(name).unwrap_or_default(),
        };
        let joined = |separator: &str, appends: bool| {
            let current = current();
            let separator = if current.is_empty() { "" } else { separator };
            Some(match appends {
                true => format!("{current}{separator}{value}"),
                false => format!("{value}{separator}{current}"),
            })
        };
        let new = match operation {
            "set" => Some(value.to_owned()),
            "unset" => None,
            "reset" => assigned.get(name).cloned().unwrap_or_else(|| inherited(name)),
            "string_append" => joined("", true),
            "string_prepend" => joined("", false),
            "path_list_append" => joined(":", true),
            "path_list_prepend" => joined(":", false),
            "cmake_list_append" => joined(";", true),
            "cmake_list_prepend" => joined(";", false),
            _ => {
                return Err(format!("unknown operation `{operation}` in ENVIRONMENT_MODIFICATION"));
            }
        };
        changes.insert(name.to_owned(), new);
    }
    Ok(changes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_operations() {
        let inherited = |name: &str| match name {
            "PATH" => Some("/bin".to_owned()),
            "HOME" => Some("/root".to_owned()),
            _ => None,
        };
        let assignments = ["A=1".to_owned(), "B=x=y".to_owned()];
        let modifications = [
            "PATH=path_list_prepend:/a",
            "PATH=path_list_append:/b:c",
            "LIST=cmake_list_append:1",
            "LIST=cmake_list_append:2",
            "LIST=cmake_list_prepend:0",
            "TEXT=string_append:b",
            "TEXT=string_prepend:a",
            "A=set:2",
            "A=reset:",
            "HOME=unset:",
            "HOME=reset:",
            "B=unset:",
            "C=set:",
        ]
        .map(str::to_owned);
        let changes = changes(&assignments, &modifications, inherited).unwrap();
        let expected = [
            ("A", Some("1")),
            ("B", None),
            ("C", Some("")),
            ("HOME", Some("/root")),
            ("LIST", Some("0;1;2")),
            ("PATH", Some("/a:/bin:/b:c")),
            ("TEXT", Some("ab")),
        ];
        let expected = expected.map(|(name, value)| (name.to_owned(), value.map(str::to_owned)));
        assert_eq!(changes.into_iter().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn bad_operations() {
        assert!(changes(&[], &["A=prepend:x".to_owned()], |_| None).is_err());
        assert!(changes(&[], &["A".to_owned()], |_| None).is_err());
    }
}
