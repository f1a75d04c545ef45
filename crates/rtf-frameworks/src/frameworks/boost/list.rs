//! Reads the list of cases, a graph in the DOT language: a node for each suite and case, and
//! braces around the nodes in a suite.

use rtf_model::Location;

use crate::case::ListedCase;

/// The cases in a graph; `None` if it is none.
pub(super) fn parse(text: &str) -> Option<Vec<ListedCase>> {
    let graph = text.get(text.find("digraph G {")?..)?;
    let mut cases = Vec::new();
    // The nodes around the present one; the first is the program itself.
    let mut outer: Vec<Node> = Vec::new();
    let mut last: Option<Node> = None;
    let mut lines = graph.lines().skip(1).peekable();
    while let Some(line) = lines.next() {
        match line.trim() {
            "{" => outer.extend(last.take()),
            "}" => {
                outer.pop();
            }
            line => {
                let Some(node) = node(line) else { continue };
                // The next line draws an arrow to it; a suite is followed by a brace.
                let is_suite = lines.clone().find(|line| !line.contains("->")) == Some("{");
                if !is_suite {
                    cases.push(case(&outer, &node));
                }
                last = Some(node);
            }
        }
    }
    Some(cases)
}

#[derive(Clone, Debug)]
struct Node {
    name: String,
    location: Option<Location>,
    labels: Vec<String>,
    is_enabled: bool,
}

/// The node in a line such as
/// `tu2[shape=Mrecord,…,color=green,label="name|file.cpp(161)|labels: @hand"];`.
fn node(line: &str) -> Option<Node> {
    let (attributes, label) = line.split_once(",label=\"")?;
    let label = label.strip_suffix("\"];")?;
    let mut fields = label.split('|');
    let name = fields.next()?.to_owned();
    let location = fields.next().and_then(location);
    let labels = fields.filter_map(|field| field.trim().strip_prefix("labels:"));
    let labels = labels.flat_map(str::split_whitespace).map(|label| label.trim_start_matches('@'));
    let labels = labels.map(str::to_owned).collect();
    Some(Node { name, location, labels, is_enabled: attributes.contains("color=green") })
}

/// The location in `file.cpp(161)`.
fn location(text: &str) -> Option<Location> {
    let (file, line) = text.trim().strip_suffix(')')?.rsplit_once('(')?;
    Some(Location { file: file.to_owned(), line: line.parse().ok()? })
}

fn case(outer: &[Node], node: &Node) -> ListedCase {
    let suites = outer.iter().skip(1);
    let names = suites.clone().map(|suite| suite.name.as_str()).chain([node.name.as_str()]);
    let mut tags: Vec<String> = Vec::new();
    for label in suites.clone().chain([node]).flat_map(|node| &node.labels) {
        if !tags.contains(label) {
            tags.push(label.clone());
        }
    }
    ListedCase {
        name: names.collect::<Vec<_>>().join("/"),
        location: node.location.clone(),
        tags,
        disabled: !node.is_enabled,
        ..ListedCase::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRAPH: &str = r#"digraph G {rankdir=LR;
tu1[shape=ellipse,peripheries=2,fontname=Helvetica,color=green,label="arm"];
{
tu65536[shape=Mrecord,fontname=Helvetica,color=green,label="passes|/a/arm(1).cpp(45)|labels: @slow @arm"];
tu1 -> tu65536;
tu65549[shape=Mrecord,fontname=Helvetica,color=green,label="depends|/a/arm.cpp(125)"];
tu1 -> tu65549;
tu65549 -> tu65536[color=red,style=dotted,constraint=false];
tu2[shape=Mrecord,fontname=Helvetica,color=green,label="gripper|/a/arm.cpp(161)|labels: @hand"];
tu1 -> tu2;
{
tu3[shape=Mrecord,fontname=Helvetica,color=green,label="left|/a/arm.cpp(168)|labels: @hand"];
tu2 -> tu3;
{
tu65557[shape=Mrecord,fontname=Helvetica,color=yellow,label="closes<int, 3>|/a/arm.cpp(169)|expected failures=1|labels: @x"];
tu3 -> tu65557;
}
}
tu65562[shape=Mrecord,fontname=Helvetica,color=green,label="last|/a/arm.cpp(201)"];
tu1 -> tu65562;
}
}
"#;

    #[test]
    fn a_graph_has_suites_labels_locations_and_disabled_cases() {
        let cases = parse(GRAPH).expect("a graph");
        let shown: Vec<String> = cases
            .iter()
            .map(|case| {
                let line = case.location.as_ref().map_or(0, |location| location.line);
                format!("{} {line} {} {}", case.name, case.tags.join(","), case.disabled)
            })
            .collect();
        assert_eq!(
            shown,
            [
                "passes 45 slow,arm false",
                "depends 125  false",
                "gripper/left/closes<int, 3> 169 hand,x true",
                "last 201  false",
            ]
        );
        assert_eq!(cases[0].location.as_ref().map(|it| it.file.as_str()), Some("/a/arm(1).cpp"));
    }

    #[test]
    fn other_text_is_no_list() {
        assert!(parse("Hello, arm.\n").is_none());
        assert!(parse("").is_none());
    }
}
