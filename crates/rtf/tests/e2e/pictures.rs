//! `check_picture`, and pictures in `rtf golden accept`.

use rtf_model::{AttemptRecord, MessageKind, TestId, Verdict};

use crate::support::{Folder, nothing_left};

const SCENE: &[u8] = include_bytes!("../../../../conformance/scenarios/picture/scene.png");
const MOVED: &[u8] = include_bytes!("../../../../conformance/scenarios/picture/stored.png");

/// Compares the picture, and overwrites it at once: the runner has a copy.
const LOOK: &str = "function TestCase.setup(args)
  tolerance = tonumber(args[1])
  return true
end
function TestCase.run()
  rtf.check_picture('start', 'screen.png', 'golden/start.png', tolerance)
  io.open('screen.png', 'w'):close()
end
";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("Look.lua", LOOK);
    folder.file("sim.xml", "<suite><test param='${param:tolerance}'> Look.lua </test></suite>");
    folder
}

fn run(folder: &Folder, picture: &[u8], tolerance: &str) -> (AttemptRecord, Option<Verdict>) {
    write(folder, "screen.png", picture);
    folder.rtf(&["run", "sim.xml", "--set", &format!("tolerance={tolerance}")]);
    let journal = folder.journal();
    let attempt = journal.record.tests[0].attempts.last().expect("an attempt").clone();
    assert!(nothing_left(folder));
    (attempt, journal.record.verdict(TestId(0)))
}

fn stdout_of(folder: &Folder, arguments: &[&str]) -> String {
    let finished = folder.rtf(arguments);
    assert_eq!(finished.code, Some(0), "{}", finished.stderr);
    finished.stdout
}

fn write(folder: &Folder, name: &str, bytes: &[u8]) {
    let path = folder.path().join(name);
    std::fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
    std::fs::write(path, bytes).expect("a file");
}

fn attached(attempt: &AttemptRecord) -> Vec<&str> {
    attempt.attachments.iter().map(|it| it.name.as_str()).collect()
}

#[test]
fn an_accepted_picture_is_the_reference_of_later_runs() {
    let folder = folder();
    let (attempt, verdict) = run(&folder, SCENE, "0.01");
    assert_eq!(verdict, Some(Verdict::Error));
    let error = &attempt.messages[0];
    let hint = "picture `start` cannot be compared: there is no reference `golden/start.png`; hint: \
                if the picture is right, store it with `rtf golden accept 20";
    assert!(error.text.starts_with(hint), "{}", error.text);
    assert!(error.location.as_ref().unwrap().to_string().ends_with("Look.lua:6"));

    assert_eq!(
        stdout_of(&folder, &["golden", "accept", "latest", "--dry-run"]),
        "golden/start.png: `start` of sim/Look would be stored\n1 picture would be accepted\n"
    );
    assert!(!folder.path().join("golden").exists());
    assert_eq!(
        stdout_of(&folder, &["golden", "accept", "latest"]),
        "golden/start.png: `start` of sim/Look is stored\n1 picture accepted\n"
    );
    assert_eq!(std::fs::read(folder.path().join("golden/start.png")).unwrap(), SCENE);

    let (attempt, verdict) = run(&folder, SCENE, "0");
    assert_eq!(verdict, Some(Verdict::Passed));
    assert_eq!(attempt.measurements[0].name, "picture/start/difference");
    assert_eq!(attempt.measurements[0].value, Some(0.0));
    assert_eq!(attached(&attempt), ["start"]);
}

#[test]
fn a_difference_is_a_failure_with_the_reference_and_the_difference() {
    let folder = folder();
    write(&folder, "golden/start.png", MOVED);
    let (attempt, verdict) = run(&folder, SCENE, "0.01");
    assert_eq!(verdict, Some(Verdict::Failed));
    let failure = &attempt.failures().next().expect("a failure").text;
    let start = "picture `start` differs from `golden/start.png`: difference 0.";
    assert!(failure.starts_with(start), "{failure}");
    assert!(failure.contains("(tolerance 0.01), most around column "), "{failure}");
    assert_eq!(attached(&attempt), ["start", "start reference", "start difference"]);
    let file = |index: usize| {
        let path = &attempt.attachments[index].path;
        std::fs::read(folder.path().join("rtf-results/latest").join(path)).unwrap()
    };
    assert_eq!((file(0), file(1)), (SCENE.to_vec(), MOVED.to_vec()));
    assert!(file(2).starts_with(b"\x89PNG"));
    let difference = attempt.measurements[0].value.unwrap();

    // Within the tolerance, the reference stays; `--all` replaces it.
    let (_, verdict) = run(&folder, SCENE, &format!("{}", difference + 0.001));
    assert_eq!(verdict, Some(Verdict::Passed));
    assert_eq!(
        stdout_of(&folder, &["golden", "accept", "latest"]),
        "golden/start.png: `start` of sim/Look is within its tolerance\nnothing accepted\n"
    );
    assert_eq!(std::fs::read(folder.path().join("golden/start.png")).unwrap(), MOVED);
    stdout_of(&folder, &["golden", "accept", "latest", "--all"]);
    assert_eq!(std::fs::read(folder.path().join("golden/start.png")).unwrap(), SCENE);
}

#[test]
fn what_cannot_be_compared_is_an_error() {
    let folder = Folder::new();
    folder.file(
        "Look.lua",
        "function TestCase.run()
           rtf.check_picture('a', 'screen.png', '../start.png', 0)
           rtf.check_picture('a', 'screen.png', 'start.png', -1)
           rtf.check_picture('a', 'text.png', 'start.png', 0)
           rtf.check_picture('a', 'screen.png', 'text.png', 0)
           rtf.check_picture('a', 'cut.png', 'start.png', 0)
         end\n",
    );
    folder.file("sim.xml", "<suite><test> Look.lua </test></suite>");
    write(&folder, "screen.png", SCENE);
    write(&folder, "start.png", SCENE);
    write(&folder, "cut.png", &SCENE[..SCENE.len() - 60]);
    folder.file("text.png", "no picture");
    assert_eq!(folder.rtf(&["run", "sim.xml"]).code, Some(1));
    let journal = folder.journal();
    let attempt = journal.record.tests[0].attempts[0].clone();
    let errors = attempt.messages.iter().filter(|it| it.kind == MessageKind::Error);
    let texts: Vec<_> =
        errors.map(|it| it.text.replace("picture `a` cannot be compared: ", "")).collect();
    assert_eq!(
        texts[..4],
        [
            "the reference `../start.png` is not a path below the directory of the suite",
            "the tolerance is -1, expected a number of at least 0",
            "it is neither PNG nor JPEG",
            "the reference `text.png`: it is neither PNG nor JPEG",
        ]
    );
    assert!(texts[4].starts_with("it is damaged: "), "{}", texts[4]);
}

#[test]
fn only_tests_compare_pictures() {
    let folder = Folder::new();
    folder.file(
        "Camera.lua",
        "function FixtureManager.setup()
           rtf.check_picture('a', 'screen.png', 'screen.png', 0)
           return true
         end\n",
    );
    folder.file("Quiet.lua", "function TestCase.run() end\n");
    folder
        .file("sim.xml", "<suite><fixture> Camera.lua </fixture><test> Quiet.lua </test></suite>");
    write(&folder, "screen.png", SCENE);
    let finished = folder.rtf(&["run", "sim.xml"]);
    assert_eq!(finished.code, Some(1));
    let refused = "set-up failed: it compares the picture `a`, which only tests can";
    assert!(finished.stdout.contains(refused), "{}", finished.stdout);
}
