//! The suite of each scenario, and the plug-ins in it.

use std::path::{Path, PathBuf};

use super::{Language, folder};
use crate::support::{build_ada, build_cpp_with};

/// The plug-in of the fixture that provides values.
const FIXTURE: &str = "fixtures/simulator";

/// The plug-ins of a language, built if it needs that.
pub struct Plugins<'a> {
    language: &'a Language,
    built: Option<PathBuf>,
}

impl<'a> Plugins<'a> {
    pub fn build(language: &'a Language, scenarios: &[String], flags: &str) -> Self {
        let built = match language.name {
            "cpp" => Some(build_cpp_with(&folder(), "conformance", flags)),
            "ada" => {
                let mut plugins: Vec<String> =
                    scenarios.iter().map(|name| format!("scenarios/{name}")).collect();
                plugins.push(FIXTURE.to_owned());
                Some(build_ada(&folder().join("conformance.gpr"), "PLUGIN", &plugins))
            }
            _ => None,
        };
        Self { language, built }
    }

    /// The plug-in of a directory of `conformance/`.
    fn path(&self, directory: &str) -> PathBuf {
        match &self.built {
            Some(built) if self.language.name == "cpp" => {
                built.join(Path::new(directory).file_name().expect("a name")).with_extension("so")
            }
            Some(built) => built.join(directory).join(self.language.file),
            None => folder().join(directory).join(self.language.file),
        }
    }
}

/// A suite for a scenario: a test that passes, the scenario's test, then one that must
/// not suffer.
pub fn suite(scenario: &str, plugins: &Plugins<'_>, isolation: &str) -> String {
    let test = plugins.path(&format!("scenarios/{scenario}"));
    let pass = plugins.path("scenarios/pass");
    let attributes = format!("type=\"{}\" isolation=\"{isolation}\"", plugins.language.plugin_type);
    let more = test_attributes(scenario);
    let (clock, fixture) = clock_and_fixture(scenario, plugins);
    format!(
        "<suite name=\"{scenario}\"{clock}>\n  {fixture}<environment>--robot sim</environment>\n  \
         <test {attributes} name=\"before\">{1}</test>\n  \
         <test {attributes} name=\"scenario\" {more}>{0}</test>\n  \
         <test {attributes} name=\"after\">{1}</test>\n</suite>\n",
        test.display(),
        pass.display()
    )
}

/// The attributes of a scenario's test.
fn test_attributes(scenario: &str) -> &'static str {
    match scenario {
        "hang" | "interrupted-sleep" => r#"timeout="300ms" grace="500ms""#,
        "context" => r#"param="--joint elbow" repetition="3""#,
        _ => "",
    }
}

/// A clock that is faster than the world, a fixture that provides values, or a signal.
fn clock_and_fixture(scenario: &str, plugins: &Plugins<'_>) -> (&'static str, String) {
    match scenario {
        "simulated-time" => {
            let command = "<command>python3 simulator.py 50</command>";
            (" clock=\"file\"", format!("<fixture type=\"process\">{command}</fixture>\n  "))
        }
        "fixture-value" | "fixture-value-unknown" => {
            let kind = plugins.language.plugin_type;
            let values = ["port", "model", "ready", "limits"]
                .map(|name| format!("<provide name=\"{name}\"/>"))
                .concat();
            let path = plugins.path(FIXTURE);
            let fixture = format!(
                "<fixture type=\"{kind}\" name=\"simulator\"> {}{values}</fixture>\n  ",
                path.display()
            );
            ("", fixture)
        }
        "fault" => ("", super::faults::ELEMENTS.to_owned()),
        "monitor" => {
            let signal = "<signal name=\"level\" unit=\"m\" test=\"sample\"/>\n  ";
            ("", signal.to_owned())
        }
        _ => ("", String::new()),
    }
}
