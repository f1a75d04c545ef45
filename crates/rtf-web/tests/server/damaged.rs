//! A run whose journal is damaged is not green, in the list and by itself.

use rtf_model::Verdict;
use serde_json::json;

use crate::world::{TEST, World, Writer};

fn green_run(world: &World, name: &str) -> std::path::PathBuf {
    let mut run = Writer::new(world.temp.path(), name);
    let journal = run.folder.join("events.jsonl");
    run.plan("arm", &["first"]);
    run.start(TEST);
    run.finish(TEST, Verdict::Passed);
    run.end();
    journal
}

#[test]
fn a_damaged_run_is_not_green_in_the_list_and_by_itself() {
    let (world, _own) = World::new();
    green_run(&world, "sound");
    let journal = green_run(&world, "damaged");
    let text = std::fs::read_to_string(&journal).unwrap();
    let damaged = text.replacen("\"name\":\"first\"", "\"name\":\"thirst\"", 1);
    std::fs::write(&journal, damaged).unwrap();
    let list = world.get("/api/v1/runs").json();
    let listed = |name: &str| {
        let runs = list["runs"].as_array().unwrap();
        runs.iter().find(|run| run["run"] == name).unwrap().clone()
    };
    let sound = listed("sound");
    assert_eq!((&sound["green"], &sound["damages"]), (&json!(true), &json!([])));
    for info in [listed("damaged"), world.get("/api/v1/runs/damaged").json()] {
        let found = (&info["green"], &info["damages"][0]["line"]);
        assert_eq!(found, (&json!(false), &json!(3)), "{info}");
    }
}

/// The journal is cut off after it was read.
#[test]
fn a_journal_that_becomes_shorter_is_damaged() {
    let (world, _own) = World::new();
    let journal = green_run(&world, "cut");
    assert_eq!(world.get("/api/v1/runs/cut").json()["green"], json!(true));
    let text = std::fs::read_to_string(&journal).unwrap();
    std::fs::write(&journal, &text[..text.len() / 2]).unwrap();
    assert_eq!(world.get("/api/v1/runs/cut").json()["green"], json!(false));
}

/// The journal keeps its size, and its check values do not match any more.
#[test]
fn a_journal_that_is_rewritten_in_place_is_damaged() {
    let (world, _own) = World::new();
    let journal = green_run(&world, "rewritten");
    let green = || {
        let list = world.get("/api/v1/runs").json();
        let listed = list["runs"].as_array().unwrap().iter().find(|run| run["run"] == "rewritten");
        let listed = listed.unwrap()["green"].clone();
        (listed, world.get("/api/v1/runs/rewritten").json()["green"].clone())
    };
    assert_eq!(green(), (json!(true), json!(true)));
    let text = std::fs::read_to_string(&journal).unwrap();
    let rewritten = text.replacen("\"name\":\"first\"", "\"name\":\"fifth\"", 1);
    assert_eq!(rewritten.len(), text.len());
    std::fs::write(&journal, rewritten).unwrap();
    // The clock of the file system may be coarse.
    let later = std::time::SystemTime::now() + std::time::Duration::from_secs(1);
    std::fs::File::options().append(true).open(&journal).unwrap().set_modified(later).unwrap();
    assert_eq!(green(), (json!(false), json!(false)));
}
