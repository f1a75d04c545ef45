//! The limits of an MJCF: <https://mujoco.readthedocs.io/en/stable/XMLreference.html>.

use roxmltree::Node;

use super::joint::{ModelJoint, PRISMATIC, REVOLUTE, magnitude, numbers, position, range, report};
use super::limit::Quantity;
use crate::suite::ElementReader;

/// The class without a name.
const MAIN: &str = "main";

/// Elements that copy others.
const COPIES: [&str; 5] = ["include", "attach", "replicate", "composite", "flexcomp"];

/// Reads the joints of a `<mujoco>`.
pub(super) fn read(reader: &mut ElementReader<'_>, root: Node<'_, '_>) -> Vec<ModelJoint> {
    let is_copy = |node: &Node<'_, '_>| COPIES.contains(&node.tag_name().name());
    if let Some(node) = root.descendants().find(is_copy) {
        let message = format!("`<{}>` is not supported in a model", node.tag_name().name());
        let hint = "save the compiled model: `mujoco.mj_saveLastXML(file, model)`";
        report(reader, node, "not-compiled", message, hint);
        return Vec::new();
    }
    let compiler = |name: &str| {
        let compilers = root.children().filter(|node| node.has_tag_name("compiler"));
        compilers.filter_map(|node| node.attribute(name)).next_back()
    };
    let settings = Settings {
        in_degrees: compiler("angle") != Some("radian"),
        autolimits: compiler("autolimits") != Some("false"),
    };
    let mut joints = Vec::new();
    let joint_nodes = root
        .children()
        .filter(|node| node.has_tag_name("worldbody"))
        .flat_map(|world| world.descendants())
        .filter(|node| node.has_tag_name("joint") && node.has_attribute("name"));
    for node in joint_nodes {
        joints.extend(JointReader { root, settings, node }.read(reader));
    }
    joints
}

#[derive(Clone, Copy)]
struct Settings {
    in_degrees: bool,
    autolimits: bool,
}

struct JointReader<'a, 'i> {
    root: Node<'a, 'i>,
    settings: Settings,
    node: Node<'a, 'i>,
}

impl<'a, 'i> JointReader<'a, 'i> {
    fn read(&self, reader: &mut ElementReader<'_>) -> Option<ModelJoint> {
        let kind = self.element("type").and_then(|node| node.attribute("type"));
        let (units, scale) = match kind.unwrap_or("hinge") {
            "hinge" if self.settings.in_degrees => (REVOLUTE, std::f64::consts::PI / 180.0),
            "hinge" => (REVOLUTE, 1.0),
            "slide" => (PRISMATIC, 1.0),
            _ => return None,
        };
        let mut joint = ModelJoint {
            name: self.node.attribute("name")?.to_owned(),
            at: position(reader, self.node),
            limits: Vec::new(),
        };
        if let Some([low, high]) = self.range(reader, "range", "limited") {
            let bounds = range(low * scale, high * scale, units[0]);
            joint.limits.push((Quantity::Position, bounds));
        }
        if let Some([low, high]) = self.range(reader, "actuatorfrcrange", "actuatorfrclimited") {
            let most = low.abs().max(high.abs());
            joint.limits.push((Quantity::Torque, magnitude(most, units[2])));
        }
        Some(joint)
    }

    /// A range that limits the joint.
    fn range(&self, reader: &mut ElementReader<'_>, name: &str, limited: &str) -> Option<[f64; 2]> {
        let is_limited = self.element(limited).and_then(|node| node.attribute(limited));
        let node = self.element(name)?;
        match is_limited.unwrap_or("auto") {
            "true" => {}
            "auto" if self.settings.autolimits => {}
            _ => return None,
        }
        let numbers = numbers(reader, node, name, 2)?;
        match numbers.as_slice() {
            [low, high] if low < high => Some([*low, *high]),
            // The default of MuJoCo, which means no range.
            [low, high] if *low == 0.0 && *high == 0.0 => None,
            _ => {
                let message = format!("`{name}` is empty: its first number is not the lower one");
                report(reader, node, "empty-range", message, "");
                None
            }
        }
    }

    /// The element that sets an attribute of the joint: itself, its class, or one around it.
    fn element(&self, attribute: &str) -> Option<Node<'a, 'i>> {
        if self.node.has_attribute(attribute) {
            return Some(self.node);
        }
        let mut class = self.class()?;
        loop {
            let mut joint = class
                .children()
                .filter(|node| node.has_tag_name("joint") && node.has_attribute(attribute));
            if let Some(found) = joint.next_back() {
                return Some(found);
            }
            class = class.parent().filter(|node| node.has_tag_name("default"))?;
        }
    }

    /// The `<default>` that applies to the joint.
    fn class(&self) -> Option<Node<'a, 'i>> {
        let bodies = self.node.ancestors().skip(1);
        let child_class = bodies.filter_map(|node| node.attribute("childclass")).next();
        let name = self.node.attribute("class").or(child_class).unwrap_or(MAIN);
        let top = self.root.children().filter(|node| node.has_tag_name("default"));
        let mut classes =
            top.flat_map(|node| node.descendants()).filter(|node| node.has_tag_name("default"));
        classes.find(|node| node.attribute("class").unwrap_or(MAIN) == name)
    }
}
