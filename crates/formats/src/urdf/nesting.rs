//! Which elements stand in which: what is misspelt, or of another language, is not passed over.

use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;

/// What an element holds.
struct Holder {
    name: &'static str,
    read: &'static [&'static str],
    /// What says nothing about the motion: of other programs, or of control.
    extensions: &'static [&'static str],
}

/// Elements that hold others; all others hold none.
const HOLDERS: &[Holder] = &[
    Holder {
        name: "robot",
        read: &["link", "joint", "material"],
        extensions: &[
            "extension",
            "gazebo",
            "transmission",
            "ros2_control",
            "sensor",
            "mujoco",
        ],
    },
    Holder {
        name: "link",
        read: &["inertial", "visual", "collision"],
        extensions: &["contact", "gazebo", "sensor", "self_collision_checking"],
    },
    Holder {
        name: "joint",
        read: &[
            "parent", "child", "origin", "axis", "limit", "dynamics", "mimic",
        ],
        extensions: &["calibration", "safety_controller"],
    },
    Holder {
        name: "inertial",
        read: &["origin", "mass", "inertia"],
        extensions: &[],
    },
    Holder {
        name: "visual",
        read: &["origin", "geometry", "material"],
        extensions: &[],
    },
    Holder {
        name: "collision",
        read: &["origin", "geometry", "material"],
        extensions: &["verbose"],
    },
    Holder {
        name: "material",
        read: &["color", "texture"],
        extensions: &[],
    },
];

/// Notes extensions below an element, and refuses what it does not hold.
pub(super) fn check(element: &Element, report: &mut Report) -> Result<(), FormatError> {
    let holder = HOLDERS.iter().find(|holder| holder.name == element.name);
    let (read, extensions) = holder.map_or((&[][..], &[][..]), |h| (h.read, h.extensions));
    for child in &element.children {
        let name = child.name.as_str();
        // Of which kind a solid is, is seen where it is read.
        if read.contains(&name) || element.name == "geometry" {
            check(child, report)?;
        } else if extensions.contains(&name) {
            report.note(child, "extension", "not read");
        } else {
            let remedy = match name.starts_with("xacro:") {
                true => "expand the file: xacro robot.xacro > robot.urdf",
                false => "correct its spelling if it is misspelt, remove it if it is not needed",
            };
            report.refuse(
                child,
                &format!("such an element in <{}>", element.name),
                remedy,
            )?;
        }
    }
    Ok(())
}
