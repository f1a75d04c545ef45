//! The cases of tests/frameworks/promises.json.

#[cfg(test)]
mod tests {
    #[test]
    fn first() {}

    #[test]
    fn second() {
        let script = std::env::var("PROMISE").unwrap();
        let mut shell = std::process::Command::new("sh");
        assert!(shell.args(["-c", &script]).status().unwrap().success());
    }

    #[test]
    fn third() {}
}
