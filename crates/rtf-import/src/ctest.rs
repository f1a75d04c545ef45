//! The tests of a build directory, as `ctest` lists them.

use std::path::Path;
use std::process::{Command, Stdio};

use serde::{Deserialize, Deserializer};
use serde_json::Value;

use crate::error::ImportError;

/// A test of CTest.
#[derive(Clone, Debug, Deserialize)]
pub struct ListedTest {
    pub name: String,
    /// Program and arguments; empty if the program does not exist.
    #[serde(default)]
    pub command: Vec<String>,
    #[serde(default)]
    properties: Vec<Property>,
}

#[derive(Clone, Debug, Deserialize)]
struct Property {
    name: String,
    #[serde(rename = "value", deserialize_with = "texts")]
    values: Vec<String>,
}

impl ListedTest {
    /// The values of a property; none if it is not set.
    pub fn property(&self, name: &str) -> &[String] {
        let found = self.properties.iter().find(|known| known.name == name);
        found.map_or(&[], |property| &property.values)
    }

    /// The names of its properties.
    pub fn properties(&self) -> impl Iterator<Item = &str> {
        self.properties.iter().map(|property| property.name.as_str())
    }

    /// A test for the tests of this module's users.
    #[cfg(test)]
    pub fn new(name: &str, command: &[&str], properties: &[(&str, &str)]) -> Self {
        let property = |(name, value): &(&str, &str)| Property {
            name: (*name).to_owned(),
            values: value.split(';').map(str::to_owned).collect(),
        };
        Self {
            name: name.to_owned(),
            command: command.iter().map(|word| (*word).to_owned()).collect(),
            properties: properties.iter().map(property).collect(),
        }
    }
}

#[derive(Deserialize)]
struct Document {
    tests: Vec<ListedTest>,
}

/// Lists the tests of a build directory.
pub fn list(build: &Path, config: Option<&str>) -> Result<Vec<ListedTest>, ImportError> {
    if !build.join("CTestTestfile.cmake").is_file() {
        let error = format!("`{}` is no build directory of CMake with tests", build.display());
        return Err(ImportError::new(error).hint(
            "it must contain `CTestTestfile.cmake`: configure a project that calls \
             `enable_testing()`",
        ));
    }
    let mut command = Command::new("ctest");
    command.arg("--show-only=json-v1").current_dir(build).stdin(Stdio::null());
    if let Some(config) = config {
        command.args(["-C", config]);
    }
    let output = command.output().map_err(|error| {
        ImportError::new(format!("`ctest` cannot be started: {error}"))
            .hint("install CMake (Debian: cmake)")
    })?;
    let document: Document = serde_json::from_slice(&output.stdout).map_err(|error| {
        let printed = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        let error = format!("`ctest --show-only=json-v1` printed no list of tests: {error}");
        ImportError::new(error).hint(match printed.as_str() {
            "" => "it needs CMake 3.14 or later".to_owned(),
            printed => format!("it printed: {printed}"),
        })
    })?;
    Ok(document.tests)
}

/// The texts of a value, which may be a list.
fn texts<'de, D: Deserializer<'de>>(input: D) -> Result<Vec<String>, D::Error> {
    fn texts(value: &Value) -> Vec<String> {
        match value {
            Value::Array(values) => values.iter().flat_map(texts).collect(),
            Value::String(text) => vec![text.clone()],
            // CMake prints 600.0 for 600.
            Value::Number(number) => vec![number.to_string().trim_end_matches(".0").to_owned()],
            other => vec![other.to_string()],
        }
    }
    Ok(texts(&Value::deserialize(input)?))
}

/// The name of the project, or of the directory.
pub fn project_name(build: &Path) -> String {
    let project = cache_value(build, "CMAKE_PROJECT_NAME").filter(|name| name != "Project");
    let dir = || build.file_name().unwrap_or_default().to_string_lossy().into_owned();
    project.unwrap_or_else(dir)
}

/// Whether the build directory was configured by a multi-configuration generator.
pub fn has_configurations(build: &Path) -> bool {
    cache_value(build, "CMAKE_CONFIGURATION_TYPES").is_some()
}

/// A value in `CMakeCache.txt`: `NAME:TYPE=VALUE`.
fn cache_value(build: &Path, name: &str) -> Option<String> {
    let cache = std::fs::read_to_string(build.join("CMakeCache.txt")).ok()?;
    let value = |line: &str| {
        let (key, value) = line.split_once('=')?;
        (key.split(':').next() == Some(name) && !value.is_empty()).then(|| value.to_owned())
    };
    cache.lines().find_map(value)
}
