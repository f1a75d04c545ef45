//! Measurements that a test prints for CTest or CDash: `<CTestMeasurement …>`.

use std::sync::LazyLock;

use regex::Regex;

/// Something that a test reports in its output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Printed {
    /// A number or text, with its name.
    Value(String, String),
    /// A file, with its name and media type.
    File {
        name: String,
        /// Its path; relative to the working directory.
        path: String,
        /// `image/png`; empty if unknown.
        media_type: String,
    },
    /// `<CTestDetails>`: a text that replaces the result in CDash.
    Details(String),
    /// `<CTestLabel>`
    Label(String),
}

/// `(?s)`, because texts can have several lines. The names of the elements of CTest before 3.21
/// begin with `Dart`.
static ELEMENT: LazyLock<Option<Regex>> = LazyLock::new(|| {
    let element = "(?s)<(CTest|Dart)(MeasurementFile|Measurement|Details|Label)([^>]*)>(.*?)</(CTest|Dart)(MeasurementFile|Measurement|Details|Label)>";
    Regex::new(element).ok()
});

static ATTRIBUTE: LazyLock<Option<Regex>> =
    LazyLock::new(|| Regex::new(r#"([A-Za-z]+)\s*=\s*["']([^"']*)["']"#).ok());

/// The elements in the output of a test.
pub fn find(output: &str) -> Vec<Printed> {
    let Some(element) = ELEMENT.as_ref().filter(|_| output.contains("</")) else {
        return Vec::new();
    };
    element
        .captures_iter(output)
        .map(|found| {
            let attribute = |name: &str| attribute(&found[3], name);
            let value = unescape(found[4].trim());
            match &found[2] {
                "Measurement" => Printed::Value(attribute("name"), value),
                "MeasurementFile" => Printed::File {
                    name: attribute("name"),
                    path: value,
                    media_type: Some(attribute("type"))
                        .filter(|it| it.contains('/') && it != "file/file")
                        .unwrap_or_default(),
                },
                "Details" => Printed::Details(value),
                _ => Printed::Label(value),
            }
        })
        .collect()
}

fn attribute(attributes: &str, name: &str) -> String {
    let found = ATTRIBUTE
        .as_ref()
        .and_then(|regex| regex.captures_iter(attributes).find(|found| &found[1] == name));
    found.map(|found| unescape(&found[2])).unwrap_or_default()
}

fn unescape(text: &str) -> String {
    text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements() {
        let output = "start\n<CTestMeasurement type=\"numeric/double\" name=\"speed\">1.5</CTestMeasurement>\
                      <CTestMeasurementFile type='image/png' name=\"plot\">a/b.png</CTestMeasurementFile>\n\
                      <DartMeasurement name=\"note\" type=\"text/string\">a &lt; b\nc</DartMeasurement>\
                      <CTestDetails>slow</CTestDetails><CTestLabel>nightly</CTestLabel>";
        let expected = [
            Printed::Value("speed".into(), "1.5".into()),
            Printed::File {
                name: "plot".into(),
                path: "a/b.png".into(),
                media_type: "image/png".into(),
            },
            Printed::Value("note".into(), "a < b\nc".into()),
            Printed::Details("slow".into()),
            Printed::Label("nightly".into()),
        ];
        assert_eq!(find(output), expected);
        assert_eq!(find("a < b <CTestMeasurement name=\"x\">1"), []);
    }
}
