//! The lines of a `.gitignore`.

/// The wanted lines that a file lacks. `build`, `/build` and `build/` ignore the same directory.
pub fn missing(text: &str, wanted: &str) -> Vec<String> {
    let name = |line: &str| line.trim().trim_matches('/').to_owned();
    let known: Vec<_> = text.lines().map(name).collect();
    wanted.lines().filter(|line| !known.contains(&name(line))).map(str::to_owned).collect()
}

/// The text to append to a file for these lines. The file may lack a line break at its end.
pub fn added(text: &str, lines: &[String]) -> String {
    let start = if text.is_empty() || text.ends_with('\n') { "" } else { "\n" };
    let lines: String = lines.iter().map(|line| format!("{line}\n")).collect();
    format!("{start}{lines}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_are_missing() {
        let wanted = "rtf-results/\nbuild/\n";
        assert_eq!(missing("", wanted), ["rtf-results/", "build/"]);
        assert_eq!(missing("/build\n*.pyc\n", wanted), ["rtf-results/"]);
        assert_eq!(missing("build/arm\nrtf-results  \n", wanted), ["build/"]);
        assert!(missing("rtf-results\r\nbuild/\r\n", wanted).is_empty());
    }

    #[test]
    fn a_last_line_without_a_line_break() {
        let lines = ["build/".to_owned()];
        assert_eq!(added("*.pyc", &lines), "\nbuild/\n");
        assert_eq!(added("*.pyc\n", &lines), "build/\n");
        assert_eq!(added("", &lines), "build/\n");
    }
}
