//! `<campaign>`, the root element.

use roxmltree::Node;
use rtf_model::Diagnostic;
use rtf_plan::suite::schema::{check, text};
use rtf_plan::suite::{ElementReader, SourceText, Span, read_document};

use super::{Campaign, Claim, DeclaredParameter, Goal, StoppingRule, Versions};
use super::{claim, constraint, parameter, schema, stop, versions};

/// The default of `repeats`.
const REPEATS: u32 = 2;

/// Parses the text of a campaign file and adds every problem to `problems`. `None` if there is an
/// error.
#[must_use]
pub fn parse(source: &SourceText, problems: &mut Vec<Diagnostic>) -> Option<Campaign> {
    read_document(source, problems, |reader, root| {
        let before = reader.problems.len();
        let name = root.tag_name();
        if name.name() != "campaign" || name.namespace().is_some() {
            let message = format!(
                "`{}` is not a campaign: its first element is `<{}>`",
                source.name(),
                name.name()
            );
            let label = source.label(ElementReader::tag(root), "`<campaign>` is expected here");
            reader.report(Diagnostic::error("not-a-campaign", message).label(label));
            return None;
        }
        let campaign = read(reader, root)?;
        stop::check_rule(reader, &campaign);
        check_episodes(reader, &campaign);
        (reader.problems.len() == before).then_some(campaign)
    })
}

/// The children of `<campaign>`.
#[derive(Default)]
struct Children {
    description: String,
    parameters: Vec<DeclaredParameter>,
    constraints: Vec<constraint::Constraint>,
    claim: Option<Claim>,
    stop: Option<StoppingRule>,
    versions: Option<Versions>,
    /// The positions of elements that occur once.
    seen: [Option<Span>; 4],
}

fn read(reader: &mut ElementReader<'_>, root: Node<'_, '_>) -> Option<Campaign> {
    check(reader, root, &schema::CAMPAIGN);
    let suite = reader.required(root, "suite", "");
    let mut children = Children::default();
    for node in root.children().filter(Node::is_element) {
        read_child(reader, node, &mut children);
    }
    check_goal(reader, root, &children);
    let versions = children.versions.map(Goal::Versions);
    let claim = children.claim.map(Goal::Claim);
    Some(Campaign {
        span: ElementReader::tag(root),
        name: reader.word(root, "name"),
        episodes: reader.number(root, "episodes", 1),
        seed: reader.number(root, "seed", 0).unwrap_or(0).into(),
        repeats: reader.number(root, "repeats", 0).unwrap_or(REPEATS),
        budget: reader.duration(root, "budget"),
        suite: suite?,
        description: children.description,
        parameters: children.parameters,
        constraints: children.constraints,
        goal: versions.or(claim)?,
        stop: children.stop.unwrap_or_default(),
    })
}

const DESCRIPTION: usize = 0;
const CLAIM: usize = 1;
const STOP: usize = 2;
const VERSIONS: usize = 3;

/// Reports a campaign without a goal, and elements that do not fit it.
fn check_goal(reader: &mut ElementReader<'_>, root: Node<'_, '_>, children: &Children) {
    let seen = &children.seen;
    let Some(versions) = seen[VERSIONS] else {
        if seen[CLAIM].is_none() {
            reader.missing(
                root,
                "a `<claim>`: `<claim require=\"rate >= 0.95\" confidence=\"0.95\"/>`",
            );
        }
        return;
    };
    let hints = [
        (CLAIM, "the comparison of the versions is the result: leave `<claim>` out"),
        (STOP, "versions are compared after a fixed number of blocks: leave `<stop>` out"),
    ];
    for (index, hint) in hints {
        let Some(span) = seen[index] else { continue };
        let name = if index == CLAIM { "claim" } else { "stop" };
        let message = format!("`<{name}>` in a campaign with `<versions>`");
        let problem = reader
            .error("conflicting-elements", span, message)
            .label(reader.source.label(versions, "the versions"));
        reader.report(problem.hint(hint));
    }
}

fn read_child(reader: &mut ElementReader<'_>, node: Node<'_, '_>, children: &mut Children) {
    match node.tag_name().name() {
        "description" => {
            reader.once(node, &mut children.seen[DESCRIPTION]);
            check(reader, node, &text("description"));
            let text = reader.text(node).map(|text| text.value).unwrap_or_default();
            children.description = text.split_whitespace().collect::<Vec<_>>().join(" ");
        }
        "parameter" => children.parameters.extend(parameter::read(reader, node)),
        "constraint" => {
            check(reader, node, &schema::CONSTRAINT);
            children.constraints.extend(constraint::read(reader, node));
        }
        "claim" => {
            reader.once(node, &mut children.seen[CLAIM]);
            children.claim = claim::read(reader, node);
        }
        "stop" => {
            reader.once(node, &mut children.seen[STOP]);
            children.stop = stop::read(reader, node);
        }
        "versions" => {
            reader.once(node, &mut children.seen[VERSIONS]);
            children.versions = versions::read(reader, node);
        }
        _ => {}
    }
}

/// A sampled parameter has any number of values.
fn check_episodes(reader: &mut ElementReader<'_>, campaign: &Campaign) {
    let is_sampled =
        |parameter: &&DeclaredParameter| matches!(parameter, DeclaredParameter::Sampled { .. });
    if campaign.episodes.is_some() {
        return;
    }
    let sampled = campaign.parameters.iter().find(is_sampled);
    if sampled.is_none() && !campaign.parameters.is_empty() {
        return;
    }
    let problem =
        reader.error("incomplete", campaign.span, "`<campaign>` needs the attribute `episodes`");
    let label = |it: &DeclaredParameter| reader.source.label(it.span(), "has any number of values");
    reader.report(sampled.map(label).into_iter().fold(problem, Diagnostic::label));
}
