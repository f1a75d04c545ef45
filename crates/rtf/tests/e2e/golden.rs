//! `check_trajectory` and `rtf golden accept`.

use rtf_model::{AttemptRecord, MessageKind, TestId, Verdict};

use crate::support::{Finished, Folder, nothing_left};

/// Moves from 0 to `gain`, and waits `delay` seconds before.
const REACH: &str = "function TestCase.setup(args)
  gain, delay = tonumber(args[1]), tonumber(args[2])
  align, band = args[3], tonumber(args[4])
  return true
end
function TestCase.run()
  for index = 0, 200 do
    local time = index * 0.01
    rtf.sample('q', gain * math.min(1, math.max(0, time - delay)), 'rad', nil, nil, time)
  end
  rtf.check_trajectory('q', 'golden/reach.csv', 0.05, align, band)
  rtf.report('end of the test')
end
";

fn folder(tests: &str) -> Folder {
    let folder = Folder::new();
    folder.file("Reach.lua", REACH);
    folder.file("arm.xml", &format!("<suite requires='robot:icub'>{tests}</suite>"));
    folder
}

fn run(folder: &Folder, param: &str) -> (Finished, AttemptRecord, Option<Verdict>) {
    let finished = folder.rtf(&["run", "arm.xml", "--set", &format!("p={param}")]);
    let journal = folder.journal();
    let attempt = journal.record.tests[0].attempts.last().expect("an attempt").clone();
    assert!(nothing_left(folder));
    (finished, attempt, journal.record.verdict(TestId(0)))
}

fn measured(attempt: &AttemptRecord, name: &str) -> f64 {
    let mut all = attempt.measurements.iter();
    all.find(|it| it.name == name).and_then(|it| it.value).unwrap_or_else(|| panic!("no {name}"))
}

const SUITE: &str = "<test name='reach' param='${param:p}'> Reach.lua </test>";

#[test]
fn an_accepted_trajectory_is_the_reference_of_later_runs() {
    let folder = folder(SUITE);
    let (finished, attempt, verdict) = run(&folder, "1 0.5");
    assert_eq!((finished.code, verdict), (Some(1), Some(Verdict::Error)));
    let error = &attempt.messages[0];
    let hint = "there is no reference `golden/reach.csv`; hint: if the trajectory is right, store it \
                with `rtf golden accept 20";
    assert!(error.text.contains(hint), "{}", error.text);
    assert!(error.location.as_ref().unwrap().to_string().ends_with("Reach.lua:11"));
    // The test continued.
    assert_eq!(attempt.messages.last().unwrap().kind, MessageKind::Report);

    let accepted = folder.rtf(&["golden", "accept", "latest", "arm/reach"]);
    assert_eq!(accepted.code, Some(0), "{}", accepted.stderr);
    assert_eq!(
        accepted.stdout,
        "golden/reach.csv: `q` of arm/reach is stored\n1 trajectory accepted\n"
    );
    let text = std::fs::read_to_string(folder.path().join("golden/reach.csv")).unwrap();
    for line in ["# unit: rad", "# test: arm/reach", "# robot: icub", "# run: ", "# date: 20"] {
        assert!(text.lines().any(|found| found.starts_with(line)), "{line}: {text}");
    }
    assert!(
        text.ends_with("time,value\n0.000,0.0000\n0.500,0.0000\n1.500,1.0000\n2.000,1.0000\n"),
        "{text}"
    );

    let (finished, attempt, verdict) = run(&folder, "1.04 0.5");
    assert_eq!(verdict, Some(Verdict::Passed), "{}", finished.stdout);
    assert!((measured(&attempt, "trajectory/q/worst") - 0.04).abs() < 1e-9);
    assert!(measured(&attempt, "trajectory/q/rms") < 0.04);
    // It fits, so it changes no file.
    let again = folder.rtf(&["golden", "accept", "latest"]);
    assert_eq!(
        again.stdout,
        "golden/reach.csv: `q` of arm/reach is within its tube\nnothing accepted\n"
    );
    let after = std::fs::read_to_string(folder.path().join("golden/reach.csv")).unwrap();
    assert_eq!(after, text);
}

#[test]
fn a_deviation_is_a_failure_at_its_worst_point() {
    let folder = folder(SUITE);
    run(&folder, "1 0.5");
    assert_eq!(folder.rtf(&["golden", "accept", "latest"]).code, Some(0));
    let (_, attempt, verdict) = run(&folder, "1.5 0.5");
    assert_eq!(verdict, Some(Verdict::Failed));
    let failure = attempt.failures().next().expect("a failure");
    let text = "trajectory `q` leaves the tube around `golden/reach.csv`: it is 1.5000 rad, the \
                reference 1.0000 rad at 1.5 s, 0.5000 rad apart (tolerance 0.05, RMS ";
    assert!(failure.text.starts_with(text), "{}", failure.text);
    // The tube, for plots.
    let names: Vec<_> = attempt.series.iter().map(|it| (it.name.as_str(), it.max)).collect();
    let close = |found: Option<f64>, wanted: f64| (found.unwrap_or(f64::NAN) - wanted).abs() < 1e-9;
    assert_eq!(names[1].0, "trajectory/q/low");
    assert_eq!(names[2].0, "trajectory/q/high");
    assert!(close(names[1].1, 0.95) && close(names[2].1, 1.05), "{names:?}");
    // A delay is no deviation within the band.
    let (_, attempt, verdict) = run(&folder, "1 0.7");
    assert_eq!(verdict, Some(Verdict::Failed));
    assert!((measured(&attempt, "trajectory/q/worst") - 0.2).abs() < 1e-9);
    let (finished, attempt, verdict) = run(&folder, "1 0.7 dtw 0.3");
    assert_eq!(verdict, Some(Verdict::Passed), "{}", finished.stdout);
    assert!(measured(&attempt, "trajectory/q/worst") < 0.01);
    let (_, _, verdict) = run(&folder, "1 0.7 dtw 0.1");
    assert_eq!(verdict, Some(Verdict::Failed));
}

#[test]
fn damaged_references_and_wrong_arguments_are_errors() {
    let folder = folder(
        "<test> A.lua </test>
         <test name='reach' param='1 0'> Reach.lua </test>",
    );
    folder.file(
        "A.lua",
        "function TestCase.run()
           rtf.check_trajectory('q', 'golden/reach.csv', 0.1)
           rtf.sample('q', 1, 'deg')
           rtf.check_trajectory('q', '../reach.csv', 0.1)
           rtf.check_trajectory('q', '/etc/passwd', 0.1)
           rtf.check_trajectory('q', 'golden/reach.csv', 0)
           rtf.check_trajectory('q', 'golden/reach.csv', 0.1, 'dtw', -1)
           rtf.check_trajectory('q', 'golden/reach.csv', 0.1)
           rtf.check_trajectory('q', 'golden', 0.1)
         end\n",
    );
    folder.file("golden/reach.csv", "# rtf trajectory 1\n# unit: rad\ntime,value\n0,0\n0,1\n");
    let finished = folder.rtf(&["run", "arm.xml"]);
    assert_eq!(finished.code, Some(1));
    let journal = folder.journal();
    let texts = |test: usize| -> Vec<String> {
        let attempt = journal.record.tests[test].attempts.last().expect("an attempt");
        let errors = attempt.messages.iter().filter(|it| it.kind == MessageKind::Error);
        errors.map(|it| it.text.replace("trajectory `q` cannot be checked: ", "")).collect()
    };
    let damaged =
        "`golden/reach.csv` is not a trajectory: the time 0 s is not after the one before";
    assert_eq!(
        texts(0),
        [
            "the test has not sampled this signal",
            "the reference `../reach.csv` is not a path below the directory of the suite",
            "the reference `/etc/passwd` is not a path below the directory of the suite",
            "the tolerance is 0, expected a number above 0",
            "the band is not a number of seconds",
            damaged,
            "cannot read `golden`: it is a directory, not a file",
        ]
    );
    assert_eq!(texts(1)[0], damaged);
    folder.file("golden/reach.csv", "# rtf trajectory 1\n# unit: rad\ntime,value\n0,0\n");
    folder.rtf(&["run", "arm.xml::A"]);
    let attempt = folder.journal().record.tests[0].attempts[0].clone();
    let unit = "its unit is `deg`, that of the reference `rad`";
    assert!(attempt.messages.iter().any(|it| it.text.ends_with(unit)));
}

#[test]
fn what_cannot_be_accepted_is_refused() {
    let folder = folder(&format!("{SUITE}<test name='again' param='2 0'> Reach.lua </test>"));
    run(&folder, "1 0");
    let refused = |arguments: &[&str], part: &str| {
        let finished = folder.rtf(arguments);
        assert_eq!(finished.code, Some(2), "{}", finished.stdout);
        assert!(finished.stderr.contains(part), "{}", finished.stderr);
    };
    refused(&["golden", "accept", "latest"], "is the reference of arm/reach and of arm/again");
    refused(&["golden", "accept", "latest", "nothing"], "the run has no test `nothing`");
    refused(&["golden", "accept", "none"], "none");
    let dry = folder.rtf(&["golden", "accept", "latest", "again", "--dry-run"]);
    assert!(dry.stdout.contains("would be stored"), "{}", dry.stdout);
    assert!(!folder.path().join("golden").exists());
    folder.file("Quiet.lua", "function TestCase.run() end\n");
    folder.file("arm.xml", "<suite><test> Quiet.lua </test></suite>");
    folder.rtf(&["run", "arm.xml"]);
    refused(&["golden", "accept", "latest"], "has checked a trajectory");
}
