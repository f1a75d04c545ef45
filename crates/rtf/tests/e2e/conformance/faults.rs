//! The faults of a scenario, which its test injects.

use rtf_model::FaultRecord;
use serde_json::Value;

use super::mismatch;

/// Replaces the file `tick` all the time, with a count.
pub const CAMERA: &str = "import itertools, os, time\n\
for number in itertools.count(1):\n    \
with open('tick.new', 'w') as file: file.write(str(number))\n    \
os.rename('tick.new', 'tick')\n    \
time.sleep(0.002)\n";

/// The fixture with the camera, and the fault that the test injects.
pub const ELEMENTS: &str = "<fixture type=\"process\" name=\"camera\"><command>python3 camera.py</command>\
<ready file=\"tick\"/></fixture>\n  <fault name=\"drop\" kind=\"stop\" fixture=\"camera\"/>\n  ";

/// Each line with `fault` is a fault, in this order; there are no others, and all were removed.
pub fn compare(scenario: &str, expected: &[Value], found: &[FaultRecord]) -> Vec<String> {
    let expected: Vec<&Value> = expected.iter().filter(|it| it.get("fault").is_some()).collect();
    let mut problems = Vec::new();
    if expected.len() != found.len() {
        problems.push(format!("{scenario}: expected {} faults, got {found:#?}", expected.len()));
    }
    for (expected, record) in expected.iter().zip(found) {
        let mut line = serde_json::to_value(&record.fault).expect("a fault");
        line["fault"] = line["name"].take();
        let problem = mismatch(expected, &line);
        problems.extend(problem.map(|problem| format!("{scenario}: {problem} in {line}")));
        if record.removed.is_none() {
            problems.push(format!("{scenario}: the fault {line} was not removed"));
        }
    }
    problems
}
