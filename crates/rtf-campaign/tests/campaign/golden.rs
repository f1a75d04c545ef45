//! Lists that may never change: a stored campaign has to be repeatable.

use std::path::Path;

use rtf_campaign::EpisodeList;

use crate::read;

#[test]
fn lists_are_the_same_in_every_version() {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/campaign/golden");
    let mut files: Vec<_> = dir.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "xml"));
    assert!(files.len() >= 10, "{files:?}");
    for file in files {
        let (list, problems) = read(&std::fs::read_to_string(&file).unwrap(), &dir);
        assert_eq!(problems, [], "{}", file.display());
        let list = list.unwrap();
        let golden = file.with_extension("jsonl");
        let expected = std::fs::read_to_string(&golden).unwrap_or_default();
        let found = list.to_json_lines();
        assert_eq!(found, expected, "{} has:\n{found}", golden.display());
        assert_eq!(EpisodeList::from_json_lines(&found).unwrap(), list);
    }
}

#[test]
fn a_damaged_list_is_refused_with_its_line() {
    let text = "{\"id\":1,\"seed\":2,\"parameters\":{}}\n{\"id\":2,\"seed\":";
    assert_eq!(EpisodeList::from_json_lines(text).unwrap_err().0, 2);
}
