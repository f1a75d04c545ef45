//! The limits of a URDF: <https://wiki.ros.org/urdf/XML/joint>.

use roxmltree::Node;

use super::joint::{ModelJoint, PRISMATIC, REVOLUTE, magnitude, number, position, range, report};
use super::limit::Quantity;
use crate::suite::ElementReader;

const XACRO: &str = "http://www.ros.org/wiki/xacro";

/// Reads the joints of a `<robot>`.
pub(super) fn read(reader: &mut ElementReader<'_>, root: Node<'_, '_>) -> Vec<ModelJoint> {
    let is_xacro = |node: &Node<'_, '_>| node.tag_name().namespace() == Some(XACRO);
    if let Some(node) = root.descendants().find(is_xacro) {
        let message = format!("`{}` is not expanded", reader.source.name());
        let hint = "expand it: `xacro arm.urdf.xacro > arm.urdf`";
        report(reader, node, "xacro", message, hint);
        return Vec::new();
    }
    let joints = root.children().filter(|node| node.has_tag_name("joint"));
    joints.filter_map(|node| joint(reader, node)).collect()
}

fn joint(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<ModelJoint> {
    let kind = node.attribute("type").unwrap_or_default();
    let units = match kind {
        "revolute" | "continuous" => REVOLUTE,
        "prismatic" => PRISMATIC,
        _ => return None,
    };
    let Some(name) = node.attribute("name") else {
        reader.missing(node, "the attribute `name`");
        return None;
    };
    let element = node.children().find(|child| child.has_tag_name("limit"));
    let mut joint = ModelJoint {
        name: name.to_owned(),
        at: position(reader, element.unwrap_or(node)),
        limits: Vec::new(),
    };
    let Some(element) = element else {
        if kind != "continuous" {
            reader.missing(node, "a `<limit>`");
        }
        return Some(joint);
    };
    if kind != "continuous" {
        let low = number(reader, element, "lower").unwrap_or(0.0);
        let high = number(reader, element, "upper").unwrap_or(0.0);
        if low < high {
            joint.limits.push((Quantity::Position, range(low, high, units[0])));
        } else {
            let message =
                format!("the joint `{name}` cannot move: `lower` is {low}, `upper` {high}");
            report(reader, element, "empty-range", message, "");
        }
    }
    let others =
        [("velocity", Quantity::Velocity, units[1]), ("effort", Quantity::Torque, units[2])];
    for (attribute, quantity, unit) in others {
        // Files without this limit have a zero, because the attribute is required.
        if let Some(most) = number(reader, element, attribute).filter(|most| *most > 0.0) {
            joint.limits.push((quantity, magnitude(most, unit)));
        }
    }
    Some(joint)
}
