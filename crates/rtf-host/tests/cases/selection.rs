//! A test of which only some cases run.

use rtf_host::{CaseEnd, Session, Step, StepEnd};
use serde_json::json;

use crate::script_host::{Script, case, done, in_run, run};

#[test]
fn only_selected_cases_run() {
    let script: Script = in_run!(session, {
        session.plan_cases(["Arm", "Hand", "Head"].map(str::to_owned).to_vec());
        for outer in ["Arm", "Hand", "Head"] {
            case(session, outer, || {
                done(session, "Moves");
                done(session, "Stops");
                CaseEnd::Done
            });
        }
    });
    let (lines, _) = run(script, &json!([{"equals": "Arm/Moves"}, {"equals": "Hand"}]));
    let expected = [
        r#"plan ["Arm","Hand"]"#,
        "start 1 in -: Arm",
        "start 2 in 1: Moves",
        "end 2",
        "end 1",
        "start 3 in -: Hand",
        "start 4 in 3: Moves",
        "end 4",
        "start 5 in 3: Stops",
        "end 5",
        "end 3",
    ];
    assert_eq!(lines, expected);
    let (lines, result) = run(script, &json!([{"contains": "no such case"}]));
    assert_eq!((lines, result), (Vec::new(), json!({"outcome": "passed"})));
}
