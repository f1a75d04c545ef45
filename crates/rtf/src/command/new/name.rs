//! The name of a project, spelled as its files need it.

use crate::cli::ProjectKind;

/// The longest name.
const MAX_LENGTH: usize = 64;

/// A name in the spellings of the languages.
#[derive(Debug, PartialEq, Eq)]
pub struct ProjectName {
    /// `ElbowJoint`: classes and plug-ins.
    pub pascal: String,
    /// `elbow_joint`: suites and Ada's files.
    pub snake: String,
    /// `Elbow_Joint`: Ada's packages.
    pub ada: String,
}

impl ProjectName {
    /// Splits a name into words: `elbow-joint`, `elbow_joint` and `ElbowJoint` are the same.
    ///
    /// The templates add `Test` and `Fixture` to the names of plug-ins, so that a name is never
    /// a reserved word: `ElbowTest` is `Elbow` for a test.
    pub fn parse(name: &str, kind: ProjectKind) -> Option<Self> {
        let is_valid =
            name.len() <= MAX_LENGTH && name.starts_with(|c: char| c.is_ascii_alphabetic());
        let parts: Vec<&str> = name.split(['-', '_']).collect();
        let is_word =
            |part: &&str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_alphanumeric());
        if !is_valid || !parts.iter().all(is_word) {
            return None;
        }
        let mut words: Vec<String> = parts.into_iter().flat_map(words).collect();
        let suffix = match kind {
            ProjectKind::Suite => "Suite",
            ProjectKind::Test => "Test",
            ProjectKind::Fixture => "Fixture",
        };
        if words.len() > 1 {
            words.pop_if(|word| word == suffix);
        }
        Some(Self {
            pascal: words.concat(),
            snake: words.join("_").to_lowercase(),
            ada: words.join("_"),
        })
    }
}

/// The words of `ElbowJoint`, each with a capital. `iCub` is one word.
fn words(part: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    for character in part.chars() {
        let ends_word = |word: &String| {
            character.is_ascii_uppercase()
                && word.len() > 1
                && !word.ends_with(|last: char| last.is_ascii_uppercase())
        };
        match words.last_mut() {
            Some(word) if !ends_word(word) => word.push(character),
            _ => words.push(character.to_ascii_uppercase().to_string()),
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spelled(name: &str, kind: ProjectKind) -> Option<[String; 3]> {
        let name = ProjectName::parse(name, kind)?;
        Some([name.pascal, name.snake, name.ada])
    }

    #[test]
    fn spellings() {
        let elbow = ["ElbowJoint", "elbow_joint", "Elbow_Joint"].map(str::to_owned);
        for name in ["elbow-joint", "elbow_joint", "ElbowJoint", "elbowJoint", "ElbowJointTest"] {
            assert_eq!(spelled(name, ProjectKind::Test).as_ref(), Some(&elbow), "{name}");
        }
        for (name, kind, expected) in [
            ("class", ProjectKind::Test, ["Class", "class", "Class"]),
            ("Test", ProjectKind::Test, ["Test", "test", "Test"]),
            ("arm-fixture", ProjectKind::Fixture, ["Arm", "arm", "Arm"]),
            ("arm-fixture", ProjectKind::Test, ["ArmFixture", "arm_fixture", "Arm_Fixture"]),
            ("iCub3Hand", ProjectKind::Suite, ["ICub3Hand", "icub3_hand", "ICub3_Hand"]),
            ("arm_2", ProjectKind::Suite, ["Arm2", "arm_2", "Arm_2"]),
        ] {
            assert_eq!(spelled(name, kind), Some(expected.map(str::to_owned)), "{name}");
        }
    }

    #[test]
    fn invalid_names() {
        let long = "a".repeat(65);
        for name in ["", "2arm", "-arm", "_arm", "arm-", "a--b", "a b", "a/b", "..", "ärm", &long]
        {
            assert_eq!(ProjectName::parse(name, ProjectKind::Test), None, "{name}");
        }
    }
}
