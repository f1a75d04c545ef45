//! A Fast DDS profile with which new ROS 2 nodes hear running ones soon.
//!
//! A node announces itself before it can receive. A running node answers that announcement at
//! once and only once, so the answer is often lost, and the new node does not know the running
//! one before its next periodic announcement, by default after 3 s. The profile shortens that
//! interval. Announcements of the new node change nothing, however many there are.

use std::io;
use std::path::{Path, PathBuf};

use roxmltree::{Document, Node};

/// The variable that names the profile, and its name before Fast DDS 3.0.
pub const VARIABLE: &str = "FASTDDS_DEFAULT_PROFILES_FILE";
pub const FORMER_VARIABLE: &str = "FASTRTPS_DEFAULT_PROFILES_FILE";

/// The releases of ROS 2 with a Fast DDS before 3.0. Later ones warn about its variable.
pub const FORMER_RELEASES: [&str; 5] = ["foxy", "galactic", "humble", "iron", "jazzy"];

const FILE: &str = "fastdds.xml";

/// The elements in the profile of a participant that contain the interval.
const PATH: [&str; 4] = ["rtps", "builtin", "discovery_config", "leaseAnnouncement"];
const INTERVAL: &str = "<sec>0</sec><nanosec>200000000</nanosec>";
const PARTICIPANT: &str = r#"participant profile_name="rtf" is_default_profile="true""#;

/// Writes the profile into the run's directory, unless another suite has. `user` is the
/// environment in which the run was started. `None` if there cannot be one.
pub fn write_profile(run_dir: &Path, user: impl Fn(&str) -> Option<String>) -> Option<PathBuf> {
    let path = run_dir.join(FILE);
    if path.exists() {
        return Some(path);
    }
    let mut set = [VARIABLE, FORMER_VARIABLE].iter().filter_map(|name| user(name));
    let text = match set.find(|file| !file.is_empty()) {
        // Fast DDS reports a file that it cannot use.
        Some(file) => joined(&std::fs::read_to_string(file).ok()?)?,
        None => {
            let profiles = elements(&["profiles", PARTICIPANT], &elements(&PATH, INTERVAL));
            let root = elements(&[r#"dds xmlns="http://www.eprosima.com""#], &profiles);
            format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{root}\n")
        }
    };
    replace(&path, &text).is_ok().then_some(path)
}

/// Writes a file that suites which start at the same time see either not at all or complete.
fn replace(path: &Path, text: &str) -> io::Result<()> {
    let new = path.with_extension(format!("{}.new", uuid::Uuid::now_v7().simple()));
    std::fs::write(&new, text)?;
    std::fs::rename(&new, path)
}

/// Adds the interval to the profile that Fast DDS uses for participants: the last one that is a
/// default. `None` if the text is not one of profiles.
fn joined(text: &str) -> Option<String> {
    let document = Document::parse(text).ok()?;
    let root = document.root_element();
    let profiles = match root.tag_name().name() {
        "profiles" => root,
        "dds" => match child(root, "profiles") {
            Some(profiles) => profiles,
            None => {
                let inner = elements(&PATH, INTERVAL);
                return Some(append(text, root, &elements(&["profiles", PARTICIPANT], &inner)));
            }
        },
        _ => return None,
    };
    let is_default = |node: &Node<'_, '_>| {
        is_named(*node, "participant") && node.attribute("is_default_profile") == Some("true")
    };
    let Some(mut node) = profiles.children().rfind(is_default) else {
        let inner = elements(&PATH, INTERVAL);
        return Some(append(text, profiles, &elements(&[PARTICIPANT], &inner)));
    };
    for (index, name) in PATH.iter().enumerate() {
        match child(node, name) {
            Some(inner) => node = inner,
            None => return Some(append(text, node, &elements(&PATH[index..], INTERVAL))),
        }
    }
    Some(text.to_owned())
}

/// Whether it is an element of this name, in any namespace: Fast DDS knows none.
fn is_named(node: Node<'_, '_>, name: &str) -> bool {
    node.is_element() && node.tag_name().name() == name
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| is_named(*child, name))
}

/// Nested elements, the outermost first, around a text.
fn elements(tags: &[&str], inner: &str) -> String {
    tags.iter().rev().fold(inner.to_owned(), |inner, tag| {
        let name = tag.split(' ').next().unwrap_or(tag);
        format!("<{tag}>{inner}</{name}>")
    })
}

/// Returns the document with another last child of an element.
fn append(text: &str, node: Node<'_, '_>, inner: &str) -> String {
    let range = node.range();
    let element = &text[range.clone()];
    let (start, end) = match element.strip_suffix("/>") {
        Some(start) => (format!("{start}>"), format!("</{}>", node.tag_name().name())),
        None => {
            let (start, end) = element.split_at(element.rfind("</").unwrap_or(element.len()));
            (start.to_owned(), end.to_owned())
        }
    };
    format!("{}{start}{inner}{end}{}", &text[..range.start], &text[range.end..])
}

#[cfg(test)]
mod tests {
    use super::*;

    const ADDED: &str =
        "<leaseAnnouncement><sec>0</sec><nanosec>200000000</nanosec></leaseAnnouncement>";

    fn user_file(text: &str) -> (tempfile::TempDir, Option<String>) {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("mine.xml");
        std::fs::write(&file, text).unwrap();
        let file = file.to_string_lossy().into_owned();
        let path = write_profile(dir.path(), |name| (name == VARIABLE).then(|| file.clone()));
        let text = path.map(|path| std::fs::read_to_string(path).unwrap());
        (dir, text)
    }

    #[test]
    fn without_a_users_profile_it_is_the_only_one_and_is_written_once() {
        let dir = tempfile::tempdir().unwrap();
        let path = write_profile(dir.path(), |_| None).unwrap();
        assert_eq!(path, dir.path().join("fastdds.xml"));
        insta::assert_snapshot!(std::fs::read_to_string(&path).unwrap(), @r#"
        <?xml version="1.0" encoding="UTF-8"?>
        <dds xmlns="http://www.eprosima.com"><profiles><participant profile_name="rtf" is_default_profile="true"><rtps><builtin><discovery_config><leaseAnnouncement><sec>0</sec><nanosec>200000000</nanosec></leaseAnnouncement></discovery_config></builtin></rtps></participant></profiles></dds>
        "#);
        std::fs::write(&path, "kept").unwrap();
        write_profile(dir.path(), |_| None).unwrap();
        assert_eq!(std::fs::read_to_string(path).unwrap(), "kept");
        assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    }

    /// Fast DDS uses one default profile, the last one: two files are not merged.
    #[test]
    fn the_users_default_profile_gets_the_interval() {
        let own = "<dds xmlns='http://www.eprosima.com'>\n<!-- é --><profiles>\
            <participant profile_name='a' is_default_profile='true'/>\
            <participant profile_name='b' is_default_profile='true'><rtps><name>b</name>\
            <builtin><discovery_config>@</discovery_config></builtin></rtps></participant>\
            <participant profile_name='c'><rtps/></participant></profiles></dds>";
        let (_dir, text) = user_file(&own.replace('@', ""));
        assert_eq!(text.unwrap(), own.replace('@', ADDED));
        for outer in ["<dds>@</dds>", "@"] {
            let own =
                outer.replace('@', "<profiles><participant is_default_profile='true'/></profiles>");
            let (_dir, text) = user_file(&own);
            let path = format!(
                "<rtps><builtin><discovery_config>{ADDED}</discovery_config></builtin></rtps>"
            );
            let expected = own.replace("/></", &format!(">{path}</participant></"));
            assert_eq!(text.unwrap(), expected);
        }
    }

    #[test]
    fn an_interval_of_the_user_is_kept() {
        let own = "<profiles><participant is_default_profile='true'><rtps><builtin><discovery_config>\
            <leaseAnnouncement><sec>1</sec></leaseAnnouncement></discovery_config></builtin></rtps>\
            </participant></profiles>";
        assert_eq!(user_file(own).1.as_deref(), Some(own));
    }

    #[test]
    fn profiles_without_a_default_participant_get_one() {
        for own in [
            "<dds><profiles><publisher profile_name='p'/>@</profiles></dds>",
            "<dds><log/><profiles>@</profiles></dds>",
        ] {
            let (_dir, text) = user_file(&own.replace('@', ""));
            let (before, after) = own.split_once('@').unwrap();
            let text = text.unwrap();
            assert!(
                text.starts_with(&format!("{before}<participant profile_name=\"rtf\"")),
                "{text}"
            );
            assert!(text.ends_with(&format!("</participant>{after}")), "{text}");
        }
        let (_dir, text) = user_file("<dds><log/></dds>");
        assert!(text.unwrap().starts_with("<dds><log/><profiles><participant profile_name"));
    }

    #[test]
    fn a_file_that_is_none_of_fast_dds_is_left_alone() {
        for own in ["", "<dds>", "<CycloneDDS/>"] {
            assert_eq!(user_file(own).1, None, "{own}");
        }
        let dir = tempfile::tempdir().unwrap();
        let missing = dir.path().join("missing.xml").to_string_lossy().into_owned();
        assert_eq!(write_profile(dir.path(), |_| Some(missing.clone())), None);
    }
}
